//! Parameters that an experiment can sweep, and points: one value for each. Adding one is one entry of [`AXES`] in `list.rs`.
//!
//! Long because an axis, a point and its settings are one vocabulary.

mod list;
pub mod named;

pub use crate::shade::REFERENCE;
use crate::spelling::Listed;
pub use list::*;
pub use named::{Named, Spelling};

use super::value::{Kind, Value};
use crate::bakes::given::{Given, OWN};
use crate::brdf::Compensation;
use crate::cost::child::Job;
use crate::environment::Environment;
use crate::environment::layout::{LAYOUTS, MapLayout};
use crate::pipeline::RenderRequest;
use crate::precompute::PrefilterBy;
use crate::precompute::dfg::DfgAxes;
use crate::scene::{Camera, CameraKind, Light, MaterialOverride, Orbit, Scene};
use crate::shade::pass::specular_shader;
use crate::shade::{DIFFUSE, Diffuse, METHODS, Method, NONE, Shading};
use crate::spelling::listed;
use crate::tonemap::ToneCurve;
use std::ops::{Index, IndexMut};
use std::sync::Arc;

/// The settings of one point. The rest of a request (camera, lights, seed) is the same for all points.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Width and height of the image.
    pub size: [u32; 2],
    /// `builtin:NAME` or a path.
    pub environment: String,
    /// Radiance above 2 to this power is cut off, in the reference too.
    pub environment_clip_log2: Option<f64>,
    /// A scene's name or a path.
    pub scene: String,
    pub material: MaterialOverride,
    pub shading: Shading,
    /// `own` or a file, of the prefiltered map and of the DFG table.
    pub prefiltered: String,
    pub dfg: String,
    pub curve: ToneCurve,
}

/// The part of a request that all points of an experiment share.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    pub camera: CameraKind,
    pub orbit: Orbit,
    pub background: bool,
    pub antialias: bool,
    pub lights: Vec<Light>,
    pub seed: u32,
    /// Samples of a reference diffuse term beside another method; the reference method itself takes `samples`.
    pub reference_samples: u32,
    /// Stops a reference earlier, once the relative standard error of each term is at most this.
    pub reference_error: Option<f64>,
}

impl Settings {
    fn dfg_axes(&self) -> DfgAxes {
        if self.dfg == OWN { DfgAxes::default() } else { DfgAxes::Centres }
    }

    /// The specular pass, to be compiled for a GPU that is not here.
    pub fn specular_job(&self) -> Job {
        let mut shading = self.shading;
        shading.precompute.dfg_axes = self.dfg_axes();
        Job::new(specular_shader(shading.precompute.layout, shading.method, shading.brdf), &shading.constants())
    }

    /// The request: `scene` with the settings' material, framed by the view's camera, with the tables that are `given`.
    pub fn request(self, environment: &Arc<Environment>, scene: &Scene, view: &View, given: Given) -> RenderRequest {
        let mut shading = self.shading;
        let precompute = &mut shading.precompute;
        if let Some(map) = &given.prefiltered {
            precompute.layout = map.layout;
            precompute.prefilter_size = [map.side; 2];
            precompute.irradiance_size = [precompute.irradiance_size[1]; 2];
            precompute.prefilter_level_count = map.levels.len() as u32;
            precompute.level_mapping = map.mapping;
        }
        precompute.dfg_size = given.dfg.as_ref().map_or(precompute.dfg_size, |table| table.side);
        precompute.dfg_axes = self.dfg_axes();
        let scene = Arc::new(scene.apply(&self.material));
        RenderRequest {
            environment: environment.clone(),
            camera: Camera::for_scene(view.camera, &scene, self.size).orbited(view.orbit, &scene),
            scene,
            size: self.size,
            shading,
            reference_samples: if shading.method.is_integrated() { shading.samples } else { view.reference_samples },
            reference_error: view.reference_error,
            lights: view.lights.clone(),
            background: view.background,
            antialias: view.antialias,
            given,
            seed: view.seed,
        }
    }
}

/// The method and sample count that an experiment measures against.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    pub method: String,
    pub samples: u32,
    /// Stops earlier, once the relative standard error of each term is at most this (`shade::reference_pass::Convergence`).
    pub relative_error: Option<f64>,
    pub terms: Terms,
}

/// Which terms the reference of a cell has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Terms {
    /// Those of the cell: a cell without a specular (or diffuse) term is judged on what it has.
    #[default]
    Cell,
    /// Specular and diffuse always: a cell without a term is judged on what it leaves out, too.
    All,
}

listed!(Terms, "choice of terms", { "cell": Cell, "all": All });

impl Reference {
    fn leaves_out(&self, value: &Value) -> bool {
        value.text() == NONE && self.terms == Terms::Cell
    }
}

impl Default for Reference {
    fn default() -> Self {
        Self { method: REFERENCE.to_owned(), samples: 4096, relative_error: None, terms: Terms::default() }
    }
}

/// The role of an axis: the thing that its values tell apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Cases: what is seen, in which light. The reference takes the same value.
    Case,
    /// Ways to compute a term.
    Method,
    /// Samples a pixel.
    Count,
    /// Equally good sets of points.
    Luck,
    /// Settings of a method.
    Parameter,
    /// Settings of the tables that a method looks up.
    Table,
    /// Tone curves. They never cause a new render.
    Display,
}

impl Part {
    /// The heading above controls of its axes.
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
    /// One sheet each.
    Page,
    Column,
    Row,
}

/// The word beside a value in labels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symbol {
    /// The value tells itself.
    None,
    /// `alpha 0.25`.
    Before(&'static str),
    /// `5 lv` in labels, `5 levels` in sentences.
    After(&'static str, &'static str),
}

impl Symbol {
    /// A value with the word: `alpha 0.25`, `5 lv`, `ggx`.
    pub fn label(self, value: &str) -> String {
        match self {
            Self::None => value.to_owned(),
            Self::Before(word) if word.ends_with('^') => format!("{word}{value}"),
            Self::Before(word) => format!("{word} {value}"),
            Self::After(word, _) => format!("{value} {word}"),
        }
    }

    /// A value with the words of a sentence: `5 levels`.
    pub fn said(self, value: &str) -> String {
        match self {
            Self::After(_, words) => format!("{value} {words}"),
            _ => self.label(value),
        }
    }
}

/// One sweepable parameter.
pub struct Axis {
    /// Name in files, on the command line and in tables.
    pub name: &'static str,
    /// One phrase for `splitsum list axes` and the help of `render`.
    pub about: &'static str,
    /// Word for several values: "environments".
    pub plural: &'static str,
    /// Word beside a value in labels.
    pub symbol: Symbol,
    pub kind: Kind,
    /// Its role.
    pub part: Part,
    /// Where contact sheets show its values.
    pub sheet: Sheet,
    /// Whether the time of a frame depends on it. `alpha` is no such axis: all widths run the same instructions.
    pub frames_cost: bool,
    /// Whether the time of making the tables depends on it. That of an environment does through its size alone.
    pub tables_cost: bool,
    /// Whether frames that differ in it are timed in the same rounds, to be compared.
    pub is_compared: bool,
    /// Whether the memory of a frame depends on it.
    pub needs_memory: bool,
    /// The tables whose texels depend on it, by name.
    pub feeds: &'static [&'static str],
    /// Whether it may also stand beside `[axes]` in an experiment file, with one value.
    pub is_key: bool,
    /// The flag of `render`, where it is not the name.
    pub flag: Option<&'static str>,
    /// A second name for the same thing.
    pub spelling: Option<Spelling>,
    /// The value where the experiment sets none.
    pub default: fn() -> Value,
    /// The value where none is set, if it depends on the layout.
    pub unset: Option<fn(&MapLayout) -> Value>,
    /// Whether the parameter changes the image at this point; where not, its values collapse into one cell.
    pub used: fn(&Used) -> bool,
    /// The value that the reference of a point with this value takes. Where it looks up a table, that is the default one.
    pub reference: fn(&Reference, &Value) -> Value,
    /// Writes a set value into the settings.
    pub apply: fn(&mut Settings, &Value),
}

/// Facts that decide which parameters change an image.
pub struct Used {
    pub method: &'static Method,
    pub diffuse: &'static Diffuse,
    pub compensation: Compensation,
    pub has_lights: bool,
    /// Whether any surface may scatter diffuse light.
    pub has_diffuse_surface: bool,
    /// Whether any surface may be a dielectric.
    pub has_dielectric: bool,
    /// Whether the filtered tables are made of samples.
    pub has_sampled_tables: bool,
    /// Whether the prefiltered map and the DFG table are our own.
    pub has_own: [bool; 2],
}

impl Used {
    /// Whether the irradiance map reaches the pixels.
    fn uses_irradiance_map(&self) -> bool {
        self.has_diffuse_surface && self.diffuse.uses_irradiance_map
    }

    /// Whether a prefiltered map of our own reaches the pixels.
    fn makes_prefiltered(&self) -> bool {
        self.method.uses_prefiltered() && self.has_own[0]
    }

    /// Whether a DFG table of our own reaches the pixels.
    fn makes_dfg(&self) -> bool {
        self.needs_dfg() && self.has_own[1]
    }

    /// Whether the DFG table reaches the pixels.
    fn needs_dfg(&self) -> bool {
        match self.has_diffuse_surface {
            true => self.method.needs_dfg(self.compensation, self.diffuse, self.has_lights),
            false => self.method.uses_dfg || (self.compensation != Compensation::None && !self.method.is_none()),
        }
    }
}

impl Axis {
    /// Whether another value means another linear image.
    pub fn changes_radiance(&self) -> bool {
        self.part != Part::Display
    }
}

/// Axes that `[precompute]` may set for all cells at once.
pub fn is_precompute(axis: &Axis) -> bool {
    axis.part == Part::Table
}

/// The index in [`AXES`] of the axis of that name.
pub fn index_of(name: &str) -> Option<usize> {
    AXES.iter().position(|axis| axis.name == name)
}

/// The axis of a name that the program itself wrote.
pub fn by_name(name: &str) -> &'static Axis {
    &AXES[index_of(name).unwrap_or_else(|| panic!("{name} is not an axis"))]
}

fn method(name: &str) -> &'static Method {
    Method::listed(name)
}

fn diffuse(name: &str) -> &'static Diffuse {
    Diffuse::listed(name)
}

/// One value for every axis, in the order of [`AXES`].
#[derive(Clone, Debug, PartialEq)]
pub struct Point(pub Vec<Value>);

impl Index<usize> for Point {
    type Output = Value;

    fn index(&self, axis: usize) -> &Value {
        &self.0[axis]
    }
}

impl IndexMut<usize> for Point {
    fn index_mut(&mut self, axis: usize) -> &mut Value {
        &mut self.0[axis]
    }
}

impl Default for Point {
    fn default() -> Self {
        Self(AXES.iter().map(|axis| (axis.default)()).collect())
    }
}

impl Point {
    pub fn get(&self, name: &str) -> &Value {
        &self[index_of(name).unwrap_or_else(|| panic!("{name} is not an axis"))]
    }

    /// The specular method.
    pub fn method(&self) -> &'static Method {
        method(self[METHOD].text())
    }

    /// The diffuse method.
    pub fn diffuse(&self) -> &'static Diffuse {
        diffuse(self[DIFFUSE_METHOD].text())
    }

    /// The layout of its filtered maps; the default one where it has none.
    fn layout(&self) -> &'static MapLayout {
        let name = (self[LAYOUT] != Value::Unset).then(|| self[LAYOUT].text());
        name.map_or(&LAYOUTS[0], |name| MapLayout::listed(name))
    }

    /// The value of an axis where none is set, in the point's layout.
    pub fn default_of(&self, axis: usize) -> Value {
        AXES[axis].unset.map_or_else(AXES[axis].default, |of_layout| of_layout(self.layout()))
    }

    /// The point with every unused parameter unset, so that points with the same work are equal. Cells are told apart by this: what a
    /// method computes and a black surface then multiplies by zero still costs time, and can fail.
    pub fn collapsed(&self, has_lights: bool) -> Self {
        self.where_used(has_lights, true, true)
    }

    /// The point with every parameter unset that cannot reach the pixels, so that points with the same image are equal: beyond
    /// [`Point::collapsed`], the diffuse term's of black and metal surfaces, and the reflectance of dielectrics where there are none.
    pub fn of_pixels(&self, has_lights: bool) -> Self {
        let is_metal = self[METALLIC] == Value::Number(1.0);
        let is_black = self[ALBEDO] == Value::Color([0.0; 3]);
        self.where_used(has_lights, !(is_metal || is_black), !is_metal)
    }

    fn where_used(&self, has_lights: bool, has_diffuse_surface: bool, has_dielectric: bool) -> Self {
        let (method, diffuse) = (self.method(), self.diffuse());
        let is_sampled = || self[PREFILTER_BY].to_string() != PrefilterBy::Harmonic.name();
        let has_sampled_tables = method.prefilter.map_or_else(is_sampled, |by| by != PrefilterBy::Harmonic);
        let has_own = [PREFILTERED, DFG_TABLE].map(|axis| AXES[axis].kind.path_in(&self[axis].to_string()).is_none());
        let compensation = self.settings().shading.compensation;
        // Light of several scatterings is diffuse on any surface.
        let has_diffuse_surface = has_diffuse_surface || compensation.is_diffuse();
        let used = Used {
            method,
            diffuse,
            compensation,
            has_lights,
            has_diffuse_surface,
            has_dielectric,
            has_sampled_tables,
            has_own,
        };
        let value = |(axis, value): (&Axis, &Value)| match (axis.used)(&used) {
            false => Value::Unset,
            true if *value == Value::Unset => axis.unset.map_or(Value::Unset, |of_layout| of_layout(self.layout())),
            true => value.clone(),
        };
        Self(AXES.iter().zip(&self.0).map(value).collect())
    }

    /// Whether that table, of [`PREFILTERED`] or [`DFG_TABLE`], is our own.
    pub fn is_own(&self, axis: usize) -> bool {
        [Value::Unset, (AXES[axis].default)()].contains(&self[axis])
    }

    /// The point of this point's reference, collapsed.
    pub fn reference(&self, reference: &Reference, has_lights: bool) -> Self {
        let values = AXES.iter().zip(&self.0).map(|(axis, value)| match axis.part {
            Part::Table => (axis.default)(),
            _ => (axis.reference)(reference, value),
        });
        Self(values.collect()).collapsed(has_lights)
    }

    /// The settings that the point stands for.
    pub fn settings(&self) -> Settings {
        let mut settings = Settings {
            size: [1, 1],
            environment: String::new(),
            environment_clip_log2: None,
            scene: String::new(),
            material: MaterialOverride::default(),
            shading: Shading { method: &METHODS[0], diffuse: &DIFFUSE[0], samples: 1, ..Shading::default() },
            prefiltered: OWN.to_owned(),
            dfg: OWN.to_owned(),
            curve: ToneCurve::default(),
        };
        for (axis, value) in AXES.iter().zip(&self.0) {
            if *value != Value::Unset {
                (axis.apply)(&mut settings, value);
            }
        }
        settings
    }
}
