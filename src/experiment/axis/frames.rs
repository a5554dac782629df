//! The axes of sequences of frames. Methods without points have sequences of one frame.

use super::layers::LAYER;
use super::plain::{first, one_of, valued};
use super::{Axis, Layer, MOTION, Part, Point, SCENE, Setter, Sheet, Symbol};
use crate::base::math::sequence::FramePoints;
use crate::base::names::Listed;
use crate::experiment::value::{Kind, Range, Value};
use crate::instrument::scene::is_design;
use crate::instrument::shade::frames::{Accumulation, Frames, History, Motion};

const FRAME: Axis = Axis {
    part: Part::Parameter,
    used: |used| used.frames.is_some(),
    layer: Some(Layer::Frames),
    ..LAYER
};

const FRAMES_MAX: u32 = 4096;

/// The first is the count, without which the others mean nothing.
pub(super) const FRAME_AXES: &[Axis] = &[
    Axis {
        name: "frames",
        about: "frames of a sequence, which add up to the image; `samples` is for each",
        plural: "frame counts",
        symbol: Symbol::After("frames", "frames"),
        layer: None,
        sheet: Sheet::Column,
        used: |used| used.method.uses_point_set,
        reference: |_, _| Value::Count(1),
        set: Setter::Count(|settings, count| settings.shading.frames.count = count),
        ..valued(
            Kind::Count {
                min: 1,
                max: FRAMES_MAX,
            },
            || Value::Count(1),
            FRAME,
        )
    },
    Axis {
        name: "accumulation",
        about: "how frames add up: mean, or exponential moving average (ema)",
        set: Setter::Name(|settings, name| {
            settings.shading.frames.accumulation = *Accumulation::listed(name)
        }),
        ..one_of::<Accumulation>(FRAME)
    },
    Axis {
        name: "ema_factor",
        label: "Newest frame",
        about: "weight of the newest frame in a long exponential moving average (`ema`)",
        symbol: Symbol::Before("factor"),
        used: |used| {
            used.frames
                .is_some_and(|frames| frames.accumulation == Accumulation::Ema)
        },
        set: Setter::Number(|settings, number| settings.shading.frames.ema_factor = number),
        ..valued(
            Kind::Number(Range::above(0.0, 1.0)),
            || Value::Number(Frames::default().ema_factor),
            FRAME,
        )
    },
    Axis {
        name: "motion",
        about: "what turns from frame to frame; the last frame has the pose of an image alone",
        set: Setter::Name(|settings, name| settings.shading.frames.motion = *Motion::listed(name)),
        ..one_of::<Motion>(FRAME)
    },
    Axis {
        name: "motion_deg",
        label: "Turn a frame (°)",
        about: "turn of the light or the camera about +y per frame, degrees",
        plural: "speeds",
        symbol: Symbol::After("deg a frame", "degrees a frame"),
        used: |used| {
            used.frames
                .is_some_and(|frames| frames.motion != Motion::Still)
        },
        set: Setter::Number(|settings, number| settings.shading.frames.motion_deg = number),
        ..valued(
            Kind::Number(Range::closed(-360.0, 360.0)),
            || Value::Number(Frames::default().motion_deg),
            FRAME,
        )
    },
    Axis {
        name: "frame_points",
        about: "points of each pixel and frame: scrambled (owen), continued (r2, least error in a \
                still view), or shifted by blue noise (blue)",
        plural: "kinds of frame points",
        symbol: Symbol::After("frame points", "frame points"),
        set: Setter::Name(|settings, name| {
            settings.shading.frames.points = *FramePoints::listed(name)
        }),
        ..one_of::<FramePoints>(FRAME)
    },
    Axis {
        name: "history",
        about: "what a pixel does with its history; docs/frames.md",
        plural: "histories",
        symbol: Symbol::After("history", "history"),
        set: Setter::Name(|settings, name| {
            settings.shading.frames.history = *History::listed(name)
        }),
        ..one_of::<History>(FRAME)
    },
];

/// Returns why a point cannot move, if it cannot.
pub fn motion_fault(point: &Point, is_antialiased: bool) -> Option<String> {
    let motion = &point[MOTION];
    let is_moving = ![&Value::Unset, &first::<Motion>()].contains(&motion);
    if is_moving && is_design(point[SCENE].text()) {
        return Some(format!(
            "{motion} on the scene design, whose pixels are unrelated views: none has a history at \
             another pixel; \
             expected still, or another scene"
        ));
    }
    let is_mixed = is_antialiased && point.settings().shading.frames.motion == Motion::Orbit;
    is_mixed.then(|| {
        "orbit with antialiasing: edges would mix before they add up; expected one of them"
            .to_owned()
    })
}

/// Whether each frame of a sequence is as blurred as its own samples alone.
pub fn is_blurred(point: &Point) -> bool {
    let shading = point.settings().shading;
    shading.frames.count > 1 && shading.method.uses_lod_bias && shading.lod_bias >= 0.0
}

/// What to do about it.
pub const BLUR: &str = "lod_bias: each frame is blurred as by its own samples alone; -0.5 \
                        log2(frames) sharpens it (docs/frames.md)";
