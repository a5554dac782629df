//! Statements of maps in MTL files: options and a file.

/// Keywords of normal maps by Blender; other writers put heights there.
pub(super) const BUMP_MAPS: [&str; 3] = ["map_Bump", "map_bump", "bump"];

/// An option in front of a file.
struct MapOption {
    name: &'static str,
    /// Most values that follow; of numbers, as many as there are.
    value_count: usize,
    has_numbers: bool,
    /// The values without an effect, which each value is one of.
    neutral: &'static [&'static str],
}

const fn words(name: &'static str, neutral: &'static [&'static str]) -> MapOption {
    MapOption {
        name,
        value_count: 1,
        has_numbers: false,
        neutral,
    }
}

const fn numbers(
    name: &'static str,
    value_count: usize,
    neutral: &'static [&'static str],
) -> MapOption {
    MapOption {
        name,
        value_count,
        has_numbers: true,
        neutral,
    }
}

/// The options of Wavefront's description of MTL files, "Options for texture map statements".
const OPTIONS: [MapOption; 13] = [
    words("-blendu", &["on"]),
    words("-blendv", &["on"]),
    words("-cc", &["off"]),
    words("-clamp", &["off"]),
    words("-imfchan", &[]),
    words("-type", &[]),
    numbers("-bm", 1, &["1"]),
    numbers("-boost", 1, &["0"]),
    numbers("-mm", 2, &[]),
    numbers("-o", 3, &["0"]),
    numbers("-s", 3, &["1"]),
    numbers("-t", 3, &["0"]),
    numbers("-texres", 1, &[]),
];

/// The values of a map's statement.
pub(super) struct MapText<'t> {
    /// The name of the file, which may contain blanks.
    pub(super) file: &'t str,
    /// `-bm`, the scale of a normal map.
    pub(super) scale: f32,
}

/// The next word of a text, and the text behind it.
struct Split<'t> {
    word: &'t str,
    rest: &'t str,
}

fn split(text: &str) -> Split<'_> {
    let text = text.trim_start();
    let end = text.find(char::is_whitespace).unwrap_or(text.len());
    let (word, rest) = text.split_at(end);
    Split {
        word,
        rest: rest.trim_start(),
    }
}

impl MapOption {
    fn takes(&self, word: &str) -> bool {
        !word.is_empty() && (!self.has_numbers || word.parse::<f32>().is_ok())
    }

    /// Whether a value has no effect.
    fn is_neutral(&self, value: &str) -> bool {
        let number = |text: &str| text.parse::<f32>().ok();
        self.neutral.iter().any(|neutral| {
            value.eq_ignore_ascii_case(neutral)
                || self.has_numbers && number(value) == number(neutral)
        })
    }
}

impl<'t> MapText<'t> {
    /// Splits options from the file; warns about options that are not read.
    pub(super) fn parse(
        text: &'t str,
        keyword: &str,
        material: &str,
        warnings: &mut Vec<String>,
    ) -> Self {
        let reads_scale = keyword == "norm" || BUMP_MAPS.contains(&keyword);
        let mut rest = text;
        let mut scale = 1.0;
        let mut unread: Vec<&str> = Vec::new();
        loop {
            let Split { word, rest: after } = split(rest);
            let Some(option) = OPTIONS.iter().find(|option| option.name == word) else {
                break;
            };
            rest = after;
            let mut values = Vec::new();
            while values.len() < option.value_count {
                let Split { word, rest: after } = split(rest);
                // The last word is the file.
                if after.is_empty() || !option.takes(word) {
                    break;
                }
                values.push(word);
                rest = after;
            }
            let stated = values.first().and_then(|value| value.parse().ok());
            match stated.filter(|_| reads_scale && option.name == "-bm") {
                Some(stated) => scale = stated,
                None if values.iter().all(|value| option.is_neutral(value)) => {}
                None => {
                    unread.push(word);
                    unread.extend(values);
                }
            }
        }
        if !unread.is_empty() {
            warnings.push(format!(
                "material \"{material}\": the options {} of {keyword} are not read",
                unread.join(" ")
            ));
        }
        Self { file: rest, scale }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &'static str, keyword: &str) -> (MapText<'static>, Vec<String>) {
        let mut warnings = Vec::new();
        let text = MapText::parse(text, keyword, "m", &mut warnings);
        (text, warnings)
    }

    #[test]
    fn files_may_have_blanks_behind_options() {
        for text in [
            "my map.png",
            "-s 1 1 1 my map.png",
            "-clamp off -o 0 my map.png",
        ] {
            let (found, warnings) = parsed(text, "map_Kd");
            assert_eq!(found.file, "my map.png");
            assert!(warnings.is_empty(), "{text}: {warnings:?}");
        }
        let (found, warnings) = parsed("-s 2 2 -clamp on maps 3.png", "map_Kd");
        assert_eq!(found.file, "maps 3.png");
        assert!(
            warnings[0].contains("the options -s 2 2 -clamp on"),
            "{warnings:?}"
        );
        let (found, warnings) = parsed("-bm 0.5 a b.png", "norm");
        assert_eq!((found.file, found.scale), ("a b.png", 0.5));
        assert!(warnings.is_empty());
        // Other words are part of the name.
        assert_eq!(parsed("-old map.png", "map_Kd").0.file, "-old map.png");
    }
}
