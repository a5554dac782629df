//! Words of causes in the whole bake: its axes, its light, its widths.

use super::cause::{ChainSlip, MappingSlip, WidthLaw};
use super::clause::{Clause, joined};
use super::doubt::{AxesDoubt, Doubt, MapPart, Warning};
use crate::bake::parts::TexelOrder;
use std::fmt;

impl fmt::Display for MapPart {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Prefiltered => "prefiltered map",
            Self::Irradiance => "irradiance map",
        })
    }
}

impl fmt::Display for TexelOrder {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&joined(&order_clauses(*self)))
    }
}

fn order_clauses(order: TexelOrder) -> Vec<Clause> {
    let texts = match order {
        TexelOrder::ByLevel => [
            "its data are level by level, as in KTX",
            "a DDS file has all levels of a face before the next face",
        ],
        TexelOrder::ByFace => [
            "its data are face by face, as in DDS",
            "a KTX file has all faces of a level before the next level",
        ],
    };
    texts.map(Clause::new).to_vec()
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&joined(&doubt_clauses(self)))
    }
}

pub fn doubt_clauses(doubt: &Doubt) -> Vec<Clause> {
    match doubt {
        Doubt::Order(order) => order_clauses(*order),
        Doubt::TurnedFaces {
            turn,
            best,
            has_other_axes,
        } => {
            let text = format!("every face is {turn}");
            let axes = || {
                let axes = best.axes;
                Clause::detailed(format!("axes {axes} fit then"), format!("--axes={axes}"))
            };
            std::iter::once(Clause::new(text))
                .chain(has_other_axes.then(axes))
                .collect()
        }
        Doubt::OtherLight(best) => vec![Clause::detailed(
            "seems to be a bake of another map",
            format!(
                "its best axes, {}, have correlation {:.2}",
                best.axes, best.correlation
            ),
        )],
        Doubt::Axes(AxesDoubt {
            best, used, turn, ..
        }) => {
            let flag = format!("--axes={}", best.axes);
            let text = match turn {
                Some(degrees) => format!("turned by {degrees}° about y"),
                None => format!("axes {} fit far better than {}", best.axes, used.axes),
            };
            vec![Clause::detailed(text, flag)]
        }
    }
}

impl Warning {
    /// Returns the doubt with correlations and a hint.
    pub fn details(&self) -> String {
        let mut text = self.doubt.to_string();
        if let Doubt::Axes(AxesDoubt {
            best, used, alike, ..
        }) = &self.doubt
        {
            text += &format!(
                "; correlation {:.4}, not {:.4}",
                best.correlation, used.correlation
            );
            if !alike.is_empty() {
                let alike: Vec<String> = alike.iter().map(ToString::to_string).collect();
                text += &format!("; as good: {}", alike.join(", "));
            }
        }
        if self.map == MapPart::Irradiance {
            text += "; if it is the map itself, name it specular=FILE";
        }
        text
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}: {}", self.map, self.doubt)
    }
}

impl fmt::Display for ChainSlip {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&joined(&chain_clauses(self)))
    }
}

pub fn chain_clauses(slip: &ChainSlip) -> Vec<Clause> {
    match slip {
        ChainSlip::Mapping(slip) => mapping_clauses(*slip),
        ChainSlip::Law { law, alphas } => {
            let text = law_words(*law);
            let alphas: Vec<String> = alphas.iter().map(|alpha| format!("{alpha:.4}")).collect();
            vec![Clause::detailed(
                text,
                format!("--alphas {}", alphas.join(",")),
            )]
        }
    }
}

fn law_words(law: WidthLaw) -> String {
    let text = match law {
        WidthLaw::NextLevel => "each level has the width of the next one",
        WidthLaw::LevelBefore => "each level has the width of the one before it",
        WidthLaw::SquaredTwice => "roughness is squared twice",
        WidthLaw::NotSquared => "roughness is not squared",
        WidthLaw::EveryLevel => "the mapping covers every level of the file",
        WidthLaw::OverCount => "level k is made for roughness k/n, and read at k/(n - 1)",
        WidthLaw::OverHalfCount => {
            "level k is made for roughness k/(n - 1/2), and read at k/(n - 1)"
        }
        WidthLaw::RoughnessTimes(factor) => {
            return format!("each level is made for {factor:.2} times its roughness");
        }
    };
    text.to_owned()
}

fn mapping_clauses(slip: MappingSlip) -> Vec<Clause> {
    let missing = |side: &str, count: usize| {
        let text = match count {
            0 => return None,
            1 => format!("the {side} of {} levels is missing", slip.level_count),
            _ => format!(
                "the {side} {count} of {} levels are missing",
                slip.level_count
            ),
        };
        Some(Clause::new(text))
    };
    let mapping = slip
        .mapping
        .map(|mapping| Clause::new(format!("widths of --level-mapping {}", mapping.name)));
    let first = missing("first", slip.first_missing);
    let last = missing("last", slip.last_missing);
    mapping.into_iter().chain(first).chain(last).collect()
}
