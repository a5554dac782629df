//! Colour channels of a file.

use crate::base::pixels::file::Fault;
use ::exr::meta::header::Header;
use std::collections::{HashMap, HashSet};

/// A set of colour channels.
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

/// The layer to read.
pub(super) struct Choice {
    pub layer: Layer,
    /// Names the layers that are left out.
    pub warning: Option<String>,
}

/// Lists every layer with colour: the picture first, then part by part, unprefixed channels first.
fn layers(headers: &[Header]) -> Vec<Layer> {
    let mut layers: Vec<Layer> = headers
        .iter()
        .enumerate()
        .filter(|(_, header)| !header.deep)
        .flat_map(|(part, header)| layers_of_part(part, header))
        .collect();
    let is_only_part = headers.len() == 1;
    layers.sort_by_key(|layer| layer.rank(is_only_part));
    layers
}

/// Names that renderers give to the picture among its passes.
const PICTURES: [&str; 5] = ["beauty", "combined", "rgba", "rgb", "composite"];
/// Start of the names of identity mattes, whose numbers identify objects.
const MATTE: &str = "crypto";

/// What a layer is likely to hold, the picture first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Rank {
    Picture,
    Plain,
    Pass,
    Matte,
}

impl Layer {
    /// Unprefixed channels are a file's picture by convention, unless its parts have names.
    fn rank(&self, is_only_part: bool) -> Rank {
        if self.is_plain && (is_only_part || self.name.is_none()) {
            return Rank::Picture;
        }
        let last_word = self
            .name
            .as_deref()
            .and_then(|name| name.rsplit('.').next())
            .unwrap_or_default()
            .to_lowercase();
        if PICTURES.contains(&last_word.as_str()) {
            Rank::Picture
        } else if last_word.starts_with(MATTE) {
            Rank::Matte
        } else if self.is_plain {
            Rank::Plain
        } else {
            Rank::Pass
        }
    }
}

fn layers_of_part(part: usize, header: &Header) -> Vec<Layer> {
    let names: Vec<String> = header
        .channels
        .list
        .iter()
        .map(|channel| channel.name.to_string())
        .collect();
    let indices: HashMap<&str, usize> = names
        .iter()
        .enumerate()
        .map(|(i, name)| (name.as_str(), i))
        .collect();
    let layer = |prefix: &str| {
        let index = |channel: &str| {
            let small = channel.to_lowercase();
            [channel, &small]
                .iter()
                .find_map(|name| indices.get(format!("{prefix}{name}").as_str()).copied())
        };
        let mut rgb = ["R", "G", "B"].map(index);
        if rgb.iter().all(Option::is_none) {
            // Luminance alone is a grey image. With chroma it is another code of colours, and with
            // X it is a position or CIE XYZ.
            let is_part = ["RY", "BY", "X"].iter().any(|name| index(name).is_some());
            let luminance = index("Y").filter(|_| !is_part)?;
            rgb = [Some(luminance); 3];
        }
        let is_plain = prefix.is_empty();
        let name = if is_plain {
            let part_name = header.own_attributes.layer_name.as_ref();
            part_name.map(ToString::to_string)
        } else {
            Some(prefix.trim_end_matches('.').to_owned())
        };
        Some(Layer {
            part,
            name,
            is_plain,
            rgb,
            alpha: index("A"),
        })
    };
    prefixes(&names).into_iter().filter_map(layer).collect()
}

/// Lists the prefixes of channels, each with its dot, in order of first use; the empty one first.
fn prefixes(names: &[String]) -> Vec<&str> {
    let mut known = HashSet::new();
    let dotted = names
        .iter()
        .filter_map(|name| name.rfind('.').map(|dot| &name[..=dot]));
    std::iter::once("")
        .chain(dotted)
        .filter(|prefix| known.insert(*prefix))
        .collect()
}

/// Joins the names of layers.
fn joined_names(layers: &[Layer]) -> String {
    let names: Vec<&str> = layers
        .iter()
        .filter_map(|layer| layer.name.as_deref())
        .collect();
    names.join(", ")
}

/// Chooses the layer of a name, or the first; warns if the file has others.
pub(super) fn choose(headers: &[Header], name: Option<&str>) -> Result<Choice, Fault> {
    let mut layers = layers(headers);
    if let Some(name) = name {
        let index = layers
            .iter()
            .position(|layer| layer.name.as_deref() == Some(name));
        let index = index.ok_or_else(|| {
            let all = joined_names(&layers);
            no_colour(
                headers,
                &format!(" in layer {name:?} (layers with colour: {all})"),
            )
        })?;
        return Ok(Choice {
            layer: layers.swap_remove(index),
            warning: None,
        });
    }
    if layers.is_empty() {
        return Err(no_colour(headers, ""));
    }
    let layer = layers.remove(0);
    let warning = others_left_out(headers.len(), &layer, &layers);
    Ok(Choice { layer, warning })
}

/// Returns a warning if a file of `part_count` parts has other images than the chosen layer.
fn others_left_out(part_count: usize, chosen: &Layer, others: &[Layer]) -> Option<String> {
    let subject = if part_count == 1 {
        // Unprefixed channels are a file's image by convention.
        if chosen.is_plain || others.is_empty() {
            return None;
        }
        format!("layer {:?}", chosen.name.as_deref().unwrap_or_default())
    } else {
        format!("part {} of {part_count}", chosen.part + 1)
    };
    let others = joined_names(others);
    Some(if others.is_empty() {
        format!("Only {subject} is used.")
    } else {
        format!("Only {subject} is used; FILE#NAME reads another ({others}).")
    })
}

/// Reports a file or layer without R, G and B; `scope` names the layer.
fn no_colour(headers: &[Header], scope: &str) -> Fault {
    let names: Vec<String> = headers
        .iter()
        .flat_map(|header| &header.channels.list)
        .map(|channel| channel.name.to_string())
        .collect();
    let deep = if headers.iter().any(|header| header.deep) {
        " (deep parts are not read)"
    } else {
        ""
    };
    let convert = if names.iter().any(|name| name == "Y") {
        "; convert the image to RGB"
    } else {
        ""
    };
    Fault::new(
        format!("has the channels {}{deep}", names.join(", ")),
        format!("R, G, B channels{scope}{convert}"),
    )
}
