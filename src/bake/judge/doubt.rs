//! Doubts of a whole bake: its axes or its light do not fit.

use super::guess::AxesFit;
use crate::bake::convention::Axes;
use crate::bake::parts::TexelOrder;

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
    pub fits: Vec<AxesFit>,
}

/// Why the axes or the light of a map seem wrong.
#[derive(Clone, Debug, PartialEq)]
pub enum Doubt {
    /// The map seems to be a bake of another light; its best axes.
    OtherLight(AxesFit),
    /// The light fits if the file's texels are in another order.
    Order(TexelOrder),
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
            Self::OtherLight(_) | Self::Order(_) => None,
        }
    }
}

/// A doubt of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    pub map: MapPart,
    pub doubt: Doubt,
}
