//! Colour channels of a file.

use crate::base::pixels::file::Fault;
use ::exr::meta::header::Header;
use std::collections::{HashMap, HashSet};

pub(super) struct Layer {
    pub part: usize,
    /// Prefix of the channels, else the name of the part.
    name: Option<String>,
    /// Whether the channels have no prefix.
    is_plain: bool,
    /// Indices in the header's list; at least one is set.
    pub rgb: [Option<usize>; 3],
    pub alpha: Option<usize>,
}

/// Lists every layer with colour, part by part, unprefixed channels first.
fn layers(headers: &[Header]) -> Vec<Layer> {
    let mut layers = Vec::new();
    for (part, header) in headers
        .iter()
        .enumerate()
        .filter(|(_, header)| !header.deep)
    {
        let names: Vec<String> = header
            .channels
            .list
            .iter()
            .map(|channel| channel.name.to_string())
            .collect();
        let mut prefixes = vec![""];
        let mut seen = HashSet::from([""]);
        let ends = names
            .iter()
            .filter_map(|name| name.rfind('.').map(|dot| &name[..=dot]));
        prefixes.extend(ends.filter(|prefix| seen.insert(prefix)));
        let index: HashMap<&str, usize> = names
            .iter()
            .enumerate()
            .map(|(i, n)| (n.as_str(), i))
            .collect();
        for prefix in prefixes {
            let find = |channel: &str| index.get(format!("{prefix}{channel}").as_str()).copied();
            let rgb = ["R", "G", "B"].map(find);
            if rgb.iter().any(Option::is_some) {
                let part_name = header
                    .own_attributes
                    .layer_name
                    .as_ref()
                    .map(ToString::to_string);
                let name = if prefix.is_empty() {
                    part_name
                } else {
                    Some(prefix.trim_end_matches('.').to_owned())
                };
                layers.push(Layer {
                    part,
                    name,
                    is_plain: prefix.is_empty(),
                    rgb,
                    alpha: find("A"),
                });
            }
        }
    }
    layers
}

/// Chooses the layer; warns if there were others.
pub(super) fn choose(
    headers: &[Header],
    name: Option<&str>,
) -> Result<(Layer, Option<String>), Fault> {
    let mut layers = layers(headers);
    let names = |layers: &[Layer]| {
        layers
            .iter()
            .filter_map(|layer| layer.name.clone())
            .collect::<Vec<_>>()
            .join(", ")
    };
    if let Some(name) = name {
        let found = layers
            .iter()
            .position(|layer| layer.name.as_deref() == Some(name));
        let place = || {
            format!(
                " in layer {name:?} (layers with colour: {})",
                names(&layers)
            )
        };
        let index = found.ok_or_else(|| no_colour(headers, &place()))?;
        return Ok((layers.swap_remove(index), None));
    }
    if layers.is_empty() {
        return Err(no_colour(headers, ""));
    }
    let chosen = layers.remove(0);
    let place = match (headers.len(), &chosen.name) {
        // Unprefixed channels are a file's image by convention.
        (1, _) if chosen.is_plain || layers.is_empty() => return Ok((chosen, None)),
        (1, name) => format!(
            "Only layer {:?} is used",
            name.as_deref().unwrap_or_default()
        ),
        (count, _) => format!("Only part {} of {count} is used", chosen.part + 1),
    };
    let warning = match names(&layers) {
        others if others.is_empty() => format!("{place}."),
        others => format!("{place}; FILE#NAME reads another ({others})."),
    };
    Ok((chosen, Some(warning)))
}

/// Reports a file or layer without R, G and B.
fn no_colour(headers: &[Header], place: &str) -> Fault {
    let all = || {
        headers
            .iter()
            .flat_map(|header| &header.channels.list)
            .map(|channel| channel.name.to_string())
    };
    let is_luminance = all().any(|name| name == "Y");
    let deep = if headers.iter().any(|header| header.deep) {
        " (deep parts are not read)"
    } else {
        ""
    };
    let convert = if is_luminance {
        "; convert the image to RGB"
    } else {
        ""
    };
    let what = format!(
        "has the channels {}{deep}",
        all().collect::<Vec<_>>().join(", ")
    );
    Fault::new(what, format!("R, G, B channels{place}{convert}"))
}
