//! What the renderer shows: images of the halves and the reference, and how far it is.

use super::picture::Picture;
use super::state::{Image, Side};
use super::texels::Texels;
use crate::instrument::pipeline::{DeviceInfo, Frame};
use std::sync::Arc;

/// An image with its picture.
#[derive(Clone)]
pub struct Shot {
    pub image: Image,
    /// `None` while only the picture was made.
    pub frame: Option<Arc<Frame>>,
    pub picture: Texels,
    pub kind: Picture,
    /// Why the half has no picture of this kind, in words.
    pub fault: Option<String>,
    /// The state that it belongs to.
    pub generation: u64,
    /// Divisor of the state's resolution.
    pub scale: u32,
    /// The headline metric, once there is a reference.
    pub score: Option<f64>,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub enum Status {
    #[default]
    Busy,
    Done,
    /// The state cannot be shown; the previous picture stays.
    Refused(String),
    /// The renderer ended, but a new process may work.
    Lost(String),
    Failed(String),
}

#[derive(Clone, Default)]
pub struct Shown {
    pub generation: u64,
    pub halves: [Option<Shot>; 2],
    pub truth: Option<Shot>,
    pub status: Status,
    pub device: Option<DeviceInfo>,
}

impl Shown {
    pub fn side(&self, side: Side) -> Option<&Shot> {
        self.halves[side as usize].as_ref()
    }

    /// Returns the size of the picture: the finer half's; `None` before the first one.
    pub fn size(&self) -> Option<[u32; 2]> {
        let finest = self.halves.iter().flatten().min_by_key(|shot| shot.scale)?;
        Some(finest.picture.size())
    }
}
