//! Statements of maps in MTL files: options and a file.

/// Keywords of normal maps by Blender; other writers put heights there.
pub(super) const BUMP_MAPS: [&str; 3] = ["map_Bump", "map_bump", "bump"];

/// The values of a map's statement.
pub(super) struct MapText<'t> {
    pub(super) file: &'t str,
    /// `-bm`, the scale of a normal map.
    pub(super) scale: f32,
}

impl<'t> MapText<'t> {
    /// Splits options from the file; warns about options that are not read.
    pub(super) fn parse(
        text: &'t str,
        keyword: &str,
        material: &str,
        warnings: &mut Vec<String>,
    ) -> Self {
        // File names may contain blanks, but not after options.
        let split = text.rsplit_once(char::is_whitespace);
        let Some((options, file)) = split.filter(|_| text.starts_with('-')) else {
            return Self {
                file: text,
                scale: 1.0,
            };
        };
        let words: Vec<&str> = options.split_whitespace().collect();
        let reads_scale = keyword == "norm" || BUMP_MAPS.contains(&keyword);
        let scale_at = words
            .iter()
            .position(|word| *word == "-bm")
            .filter(|_| reads_scale);
        let stated = scale_at.and_then(|at| words.get(at + 1)?.parse().ok());
        let rest: Vec<&str> = match (scale_at, stated) {
            (Some(at), Some(_)) => [&words[..at], &words[at + 2..]].concat(),
            _ => words,
        };
        if !rest.is_empty() {
            warnings.push(format!(
                "material \"{material}\": the options {} of {keyword} are not read",
                rest.join(" ")
            ));
        }
        Self {
            file,
            scale: stated.unwrap_or(1.0),
        }
    }
}
