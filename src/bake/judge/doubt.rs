//! Doubts of a whole bake: its axes or its light do not fit.

use super::faces::FaceTurn;
use super::guess::AxesFit;
use crate::bake::convention::Axes;
use crate::bake::parts::{Map, TexelOrder};
use crate::base::pixels::RgbImage;

/// A map of a bake whose axes are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapPart {
    Prefiltered,
    Irradiance,
}

/// A map, and every orientation with its correlation, best first.
#[derive(Clone, Debug)]
pub struct RankedAxes {
    pub map: MapPart,
    pub ranking: Vec<AxesFit>,
}

/// Why the axes or the light of a map seem wrong.
#[derive(Clone, Debug, PartialEq)]
pub enum Doubt {
    /// The map seems to be a bake of another light; its best axes.
    OtherLight(AxesFit),
    /// The light fits if the file's texels are in another order.
    Order(TexelOrder),
    /// The light fits if every face is turned back, by these axes.
    TurnedFaces {
        turn: FaceTurn,
        best: AxesFit,
        /// Whether the axes differ from the used ones.
        has_other_axes: bool,
    },
    Axes(AxesDoubt),
}

/// Other axes that fit far better.
#[derive(Clone, Debug, PartialEq)]
pub struct AxesDoubt {
    pub best: AxesFit,
    pub used: AxesFit,
    /// Further axes that fit as well as the best.
    pub alike: Vec<Axes>,
    /// Turn about y from the used axes to the best, degrees, if it is one.
    pub turn: Option<f64>,
}

impl Doubt {
    /// Returns the axes that fit; `None` for another map.
    pub fn axes(&self) -> Option<Axes> {
        match self {
            Self::Axes(doubt) => Some(doubt.best.axes),
            Self::TurnedFaces { best, .. } => Some(best.axes),
            Self::OtherLight(_) | Self::Order(_) => None,
        }
    }
}

/// Texels in another order than assumed, which explains why the light does not fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Arrangement {
    Order(TexelOrder),
    /// Every face is turned; the axes that then fit.
    TurnedFaces {
        turn: FaceTurn,
        best: AxesFit,
    },
}

impl Arrangement {
    /// Returns the map as it should have been read.
    pub fn undone(&self, map: &Map) -> Map {
        match self {
            Self::Order(order) => map.reordered(*order),
            Self::TurnedFaces { turn, .. } => turned_back(map, *turn),
        }
    }
}

/// Undoes a turn of every face.
pub fn turned_back(map: &Map, turn: FaceTurn) -> Map {
    let face = |face: &RgbImage| turn.undone(face);
    Map {
        layout: map.layout,
        levels: map
            .levels
            .iter()
            .map(|faces| faces.iter().map(face).collect())
            .collect(),
    }
}

/// A doubt of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    pub map: MapPart,
    pub doubt: Doubt,
}
