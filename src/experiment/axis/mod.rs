//! Axes (sweepable parameters) and points (one value for each axis). A new axis is one entry in
//! `list.rs`, `layers.rs`, `frames.rs` or `tables.rs`.

mod frames;
mod id;
mod layers;
mod list;
pub mod named;
mod plain;
mod point;
mod settings;
mod tables;

pub use crate::instrument::shade::REFERENCE;
pub use frames::{BLUR, is_blurred, motion_fault};
pub use id::{Axes, AxisId, PerAxis};
pub use list::*;
pub use named::{Named, Spelling};
pub use point::{Point, Points};
pub use settings::{Reference, Setter, Settings, Terms, View};
pub use tables::*;

use super::value::{Kind, Value};
use crate::instrument::brdf::Compensation;
use crate::instrument::environment::layout::MapLayout;
use crate::instrument::shade::frames::Frames;
use crate::instrument::shade::{Diffuse, Method};

/// The role of an axis: which things its values distinguish.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Scene and light. The reference has the same value.
    Case,
    /// Ways to compute a term.
    Method,
    Count,
    /// Equally good sets of points.
    Luck,
    /// Settings of a method.
    Parameter,
    /// Settings of the tables.
    Table,
    /// Tone curves. They never cause a new render.
    Display,
}

impl Part {
    pub fn heading(self) -> &'static str {
        match self {
            Self::Case => "Scene and light",
            Self::Method | Self::Count | Self::Parameter | Self::Luck => "Method",
            Self::Table => "Tables",
            Self::Display => "Tone curve, of a .png",
        }
    }
}

/// Where a contact sheet shows the values of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sheet {
    /// One sheet for each value.
    Page,
    Column,
    Row,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symbol {
    None,
    /// `alpha 0.25`.
    Before(&'static str),
    /// `5 lv` in labels, `5 levels` in sentences.
    After(&'static str, &'static str),
}

impl Symbol {
    /// Labels a value: `alpha 0.25`, `5 lv`, `ggx`.
    pub fn label(self, value: &str) -> String {
        match self {
            Self::None => value.to_owned(),
            Self::Before(word) => format!("{word} {value}"),
            Self::After(word, _) => format!("{value} {word}"),
        }
    }

    /// Writes a value for a sentence: `5 levels`.
    pub fn in_sentence(self, value: &str) -> String {
        match self {
            Self::After(_, words) => format!("{value} {words}"),
            _ => self.label(value),
        }
    }
}

#[derive(Clone, Copy)]
pub struct Axis {
    /// Name in files, on the command line and in tables.
    pub name: &'static str,
    /// Label of its control, with the unit; empty if the name in words does.
    pub label: &'static str,
    pub about: &'static str,
    /// Plural: "environments"; empty if the name in words takes an s.
    pub plural: &'static str,
    pub symbol: Symbol,
    pub kind: Kind,
    pub part: Part,
    pub sheet: Sheet,
    /// Whether the time of a frame depends on it; false for `alpha`, since all widths run the same
    /// instructions.
    pub frames_cost: bool,
    /// Whether the time to make the tables depends on it. An environment counts by its size alone.
    pub tables_cost: bool,
    /// Whether frames that differ in it are timed in the same rounds.
    pub is_compared: bool,
    pub needs_memory: bool,
    /// Tables whose texels depend on it.
    pub feeds: &'static [PrecomputedTable],
    /// Whether it may be set outside `[axes]` in an experiment file.
    pub is_key: bool,
    /// Whether it describes a layer over the base. Tables have it only if the experiment names it.
    pub is_layer: bool,
    /// The layer without which it means nothing.
    pub layer: Option<Layer>,
    /// The flag of `render`, if it differs from the name.
    pub flag: Option<&'static str>,
    pub spelling: Option<Spelling>,
    pub default: fn() -> Value,
    /// The default, if it depends on the layout.
    pub unset: Option<fn(&MapLayout) -> Value>,
    /// Whether it changes the image at this point. If not, its values collapse into one cell.
    pub used: fn(&Used) -> bool,
    /// The value of the reference for this value of a cell. Tables always have their default.
    pub reference: fn(&Reference, &Value) -> Value,
    pub set: Setter,
}

/// A layer or a sequence of frames: what the axes of its details need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    Anisotropy,
    Coat,
    Sheen,
    /// A sequence of at least two frames.
    Frames,
    /// Direct lights, of the experiment or of a scene's file.
    Lights,
}

impl Layer {
    /// The axis that turns it on: `coat` for `coat_alpha`.
    pub fn axis(self) -> AxisId {
        match self {
            Self::Anisotropy => ANISOTROPY,
            Self::Coat => COAT,
            Self::Sheen => SHEEN_COLOR,
            Self::Frames => FRAMES,
            Self::Lights => LIGHT_INTENSITY,
        }
    }

    pub fn name(self) -> &'static str {
        AXES[self.axis()].name
    }

    /// Whether an axis turns the layer on or describes it.
    pub fn has(self, axis: AxisId) -> bool {
        self.axis() == axis || AXES[axis].layer == Some(self)
    }
}

/// Facts that decide which parameters change an image.
pub struct Used {
    pub method: &'static Method,
    pub diffuse: &'static Diffuse,
    pub compensation: Compensation,
    pub has_diffuse_surface: bool,
    pub has_dielectric: bool,
    /// Whether a surface may have a coat.
    pub has_coat: bool,
    pub has_sheen: bool,
    /// Whether a surface may have an occlusion map.
    pub has_occlusion: bool,
    /// Whether a lobe may have two widths.
    pub has_anisotropy: bool,
    /// Of an image that ends a sequence, the sequence.
    pub frames: Option<Frames>,
    pub has_sampled_tables: bool,
    /// Whether splitsum makes the prefiltered map.
    pub makes_prefiltered: bool,
    /// Whether splitsum makes the DFG table.
    pub makes_dfg: bool,
}

impl Used {
    /// Whether the irradiance map reaches the pixels.
    fn uses_irradiance_map(&self) -> bool {
        self.has_sheen || self.has_diffuse_surface && self.diffuse.uses_irradiance_map
    }

    /// Whether the program's own prefiltered map reaches the pixels.
    fn shows_computed_prefiltered(&self) -> bool {
        (self.method.uses_prefiltered() || self.has_sheen) && self.makes_prefiltered
    }

    /// Whether the program's own DFG table reaches the pixels.
    fn shows_computed_dfg(&self) -> bool {
        self.needs_dfg() && self.makes_dfg
    }

    /// Whether a DFG table reaches the pixels.
    fn needs_dfg(&self) -> bool {
        if self.has_diffuse_surface {
            return self.method.needs_dfg(self.compensation, self.diffuse);
        }
        let is_compensated = self.compensation != Compensation::None && !self.method.is_none();
        self.method.uses_dfg || is_compensated
    }
}

impl Axis {
    /// Whether another value means another linear image.
    pub fn changes_radiance(&self) -> bool {
        self.part != Part::Display
    }
}

/// Whether `[precompute]` may set the axis.
pub fn is_precompute(axis: &Axis) -> bool {
    axis.part == Part::Table
}
