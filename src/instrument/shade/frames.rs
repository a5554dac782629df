//! Sequences of frames: how they add up, move and get their points.

use crate::base::math::sequence::FramePoints;
use crate::base::names::listed;

/// How frames add up. Each frame has the weight q of the next one; weights sum to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Accumulation {
    /// The mean of all frames: q = 1.
    #[default]
    Mean,
    /// The exponential moving average: q = 1 - `ema_factor`.
    Ema,
}

listed!(Accumulation, "accumulation", { "mean": Mean, "ema": Ema });

/// What moves between two frames. The last frame has the pose of an image alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Motion {
    #[default]
    Still,
    /// The light turns about +y.
    Light,
    /// The camera orbits the scene about +y.
    Orbit,
}

listed!(Motion, "motion", { "still": Still, "light": Light, "orbit": Orbit });

/// What a pixel does with its history.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum History {
    #[default]
    Plain,
    /// Clamps the history to the range of the 3x3 pixels of the frame first.
    Clamp,
    /// Divides radiance by the split sum under light of radiance 1, f0 A + B, and multiplies the
    /// result.
    Demodulated,
    /// Accumulates the difference from the split sum, and adds the split sum of the last frame.
    ControlVariate,
    /// Finds the history where the previous frame saw the same light reflected, not the same
    /// surface.
    Reflected,
}

listed!(History, "history", {
    "plain": Plain,
    "clamp": Clamp,
    "demodulated": Demodulated,
    "control-variate": ControlVariate,
    "reflected": Reflected,
});

/// A sequence of frames that ends with an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frames {
    /// 1 for an image alone.
    pub count: u32,
    pub accumulation: Accumulation,
    /// Weight of the newest frame in a long exponential moving average, in (0, 1].
    pub ema_factor: f64,
    pub motion: Motion,
    /// Turn of the light or the camera from a frame to the next, degrees.
    pub motion_deg: f64,
    pub points: FramePoints,
    pub history: History,
}

impl Default for Frames {
    fn default() -> Self {
        Self {
            count: 1,
            accumulation: Accumulation::default(),
            ema_factor: 0.1,
            motion: Motion::default(),
            motion_deg: 1.0,
            points: FramePoints::default(),
            history: History::default(),
        }
    }
}

impl Frames {
    /// Returns the weight of a frame over the weight of the next one.
    pub fn kept(&self) -> f64 {
        match self.accumulation {
            Accumulation::Mean => 1.0,
            Accumulation::Ema => 1.0 - self.ema_factor,
        }
    }
}
