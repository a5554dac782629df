//! Every parameter that an experiment can sweep. Adding an axis is one entry of [`AXES`].

use super::value::{Kind, Range, Value};
use crate::brdf::{self, MaskingShadowing};
use crate::environment::Environment;
use crate::pipeline::RenderRequest;
use crate::precompute::PrecomputeSettings;
use crate::scene::{Camera, CameraKind, Light, MaterialOverride, Scene};
use crate::shade::{DIFFUSE, Diffuse, METHODS, Method, diffuse_by_name, method_by_name};
use crate::tonemap::ToneCurve;
use std::sync::Arc;

/// What one point of an experiment sets; the rest of a request (scene files, camera, lights) is the same for all points.
#[derive(Clone, Debug)]
pub struct Settings {
    /// `builtin:NAME` or a path.
    pub environment: String,
    pub environment_rotation_deg: f64,
    pub environment_scale: f32,
    /// A scene's name or a path.
    pub scene: String,
    pub material: MaterialOverride,
    pub brdf: &'static dyn brdf::Brdf,
    pub masking_shadowing: MaskingShadowing,
    pub method: &'static Method,
    pub diffuse: &'static Diffuse,
    pub samples: u32,
    /// Which set of points a sampled method takes; see `precompute::points`.
    pub point_set: u32,
    pub lod_bias: f32,
    pub precompute: PrecomputeSettings,
    pub curve: ToneCurve,
}

/// What every point of an experiment shares.
#[derive(Clone, Debug)]
pub struct View {
    pub size: [u32; 2],
    pub camera: CameraKind,
    pub background: bool,
    pub lights: Vec<Light>,
    pub seed: u32,
    /// Samples of a reference diffuse term beside another method; the reference method itself takes `samples`.
    pub reference_samples: u32,
    /// Stops a reference earlier, once the relative standard error of each term is at most this.
    pub reference_error: Option<f64>,
}

impl Settings {
    /// What to render: `scene` with the settings' material, framed by the view's camera.
    pub fn request(self, environment: &Arc<Environment>, scene: &Scene, view: &View) -> RenderRequest {
        let scene = Arc::new(scene.apply(&self.material));
        RenderRequest {
            environment: environment.clone(),
            environment_rotation_deg: self.environment_rotation_deg,
            environment_scale: self.environment_scale,
            camera: Camera::for_scene(view.camera, &scene, view.size),
            scene,
            size: view.size,
            point_set: self.point_set,
            reference_error: view.reference_error,
            reference_samples: if self.method.name == REFERENCE { self.samples } else { view.reference_samples },
            method: self.method,
            diffuse: self.diffuse,
            brdf: self.brdf,
            masking_shadowing: self.masking_shadowing,
            samples: self.samples,
            lod_bias: self.lod_bias,
            lights: view.lights.clone(),
            background: view.background,
            precompute: self.precompute,
            seed: view.seed,
        }
    }
}

/// Name of the unbiased method, specular and diffuse.
pub const REFERENCE: &str = "reference";

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

impl Terms {
    /// Every variant with its name.
    pub const ALL: &[(&str, Self)] = &[("cell", Self::Cell), ("all", Self::All)];
}

impl Reference {
    fn leaves_out(&self, value: &Value) -> bool {
        value.text() == "none" && self.terms == Terms::Cell
    }
}

impl Default for Reference {
    fn default() -> Self {
        Self { method: REFERENCE.to_owned(), samples: 4096, relative_error: None, terms: Terms::default() }
    }
}

/// One sweepable parameter.
pub struct Axis {
    /// Name in files, on the command line and in tables.
    pub name: &'static str,
    /// One phrase for `splitsum list axes`.
    pub about: &'static str,
    pub kind: Kind,
    /// False for parameters of the tone curve: they never cause a new render.
    pub changes_radiance: bool,
    /// The value where the experiment sets none.
    pub default: fn() -> Value,
    /// Whether the parameter changes the image at this point; where not, its values collapse into one cell.
    pub used: fn(&Used) -> bool,
    /// The value that the reference of a point with this value takes.
    pub reference: fn(&Reference, &Value) -> Value,
    /// Writes a set value into the settings.
    pub apply: fn(&mut Settings, &Value),
}

/// What decides which parameters change an image.
pub struct Used {
    pub method: &'static Method,
    pub diffuse: &'static Diffuse,
    pub has_lights: bool,
}

/// Sample counts of precompute passes stop here: more only costs time.
const PRECOMPUTE_SAMPLES_MAX: u32 = 1 << 20;
/// Sides of precomputed tables stop at the size every Vulkan device supports.
const SIDE_MAX: u32 = 4096;

/// What most axes share; entries override what differs.
const PLAIN: Axis = Axis {
    name: "",
    about: "",
    kind: Kind::Input,
    changes_radiance: true,
    default: || Value::Unset,
    used: |_| true,
    reference: |_, value| value.clone(),
    apply: |_, _| {},
};

/// Every axis, in the order of the columns that an experiment does not name itself.
pub static AXES: &[Axis] = &[
    Axis {
        name: "environment",
        about: "the light: a builtin formula or an .hdr or .exr file",
        default: || Value::Text("builtin:sky".to_owned()),
        apply: |s, v| s.environment = v.text().to_owned(),
        ..PLAIN
    },
    Axis {
        name: "scene",
        about: "sphere, spheres, plane or an .obj file",
        default: || Value::Text("sphere".to_owned()),
        apply: |s, v| s.scene = v.text().to_owned(),
        ..PLAIN
    },
    Axis {
        name: "brdf",
        about: "microfacet model",
        kind: Kind::Name { what: "BRDF model", names: || brdf::MODELS.iter().map(|m| m.name()).collect() },
        default: || Value::Text("ggx".to_owned()),
        apply: |s, v| s.brdf = brdf::by_name(v.text()).expect("the plan checked the model's name"),
        ..PLAIN
    },
    Axis {
        name: "method",
        about: "how the specular term is computed",
        kind: Kind::Name { what: "method", names: || METHODS.iter().map(|m| m.name).collect() },
        default: || Value::Text("sampled".to_owned()),
        reference: |r, v| if r.leaves_out(v) { v.clone() } else { Value::Text(r.method.clone()) },
        apply: |s, v| s.method = method(v.text()),
        ..PLAIN
    },
    Axis {
        name: "diffuse",
        about: "how the diffuse term is computed",
        kind: Kind::Name { what: "diffuse method", names: || DIFFUSE.iter().map(|d| d.name).collect() },
        default: || Value::Text("sh9".to_owned()),
        reference: |r, v| if r.leaves_out(v) { v.clone() } else { Value::Text(REFERENCE.to_owned()) },
        apply: |s, v| s.diffuse = diffuse(v.text()),
        ..PLAIN
    },
    Axis {
        name: "samples",
        about: "samples a pixel; methods that draw none have one cell, with an empty field",
        kind: Kind::Count { min: 1, max: 1 << 24 },
        default: || Value::Count(40),
        used: |u| u.method.uses_samples,
        reference: |r, _| Value::Count(r.samples),
        apply: |s, v| s.samples = v.count(),
        ..PLAIN
    },
    Axis {
        name: "point_set",
        about: "set of sample points: 0 plain Hammersley, k its k-th shift on the torus",
        kind: Kind::Count { min: 0, max: 1 << 20 },
        default: || Value::Count(0),
        used: |u| u.method.uses_point_set,
        apply: |s, v| s.point_set = v.count(),
        ..PLAIN
    },
    Axis {
        name: "alpha",
        about: "microfacet width of every material",
        kind: Kind::Number(Range::above(0.0, 1.0)),
        apply: |s, v| s.material.alpha = Some(v.number() as f32),
        ..PLAIN
    },
    Axis {
        name: "f0",
        about: "reflectance at normal incidence of every dielectric",
        kind: Kind::Color(Range::closed(0.0, 1.0)),
        apply: |s, v| s.material.f0 = Some(v.color()),
        ..PLAIN
    },
    Axis {
        name: "albedo",
        about: "albedo of every material",
        kind: Kind::Color(Range::closed(0.0, 1.0)),
        apply: |s, v| s.material.albedo = Some(v.color()),
        ..PLAIN
    },
    Axis {
        name: "metallic",
        about: "0 dielectric, 1 metal",
        kind: Kind::Number(Range::closed(0.0, 1.0)),
        apply: |s, v| s.material.metallic = Some(v.number() as f32),
        ..PLAIN
    },
    Axis {
        name: "exposure",
        about: "factor before the tone curve",
        kind: Kind::Number(Range::above(0.0, 1e9)),
        changes_radiance: false,
        default: || Value::Number(1.0),
        apply: |s, v| s.curve.exposure = v.number() as f32,
        ..PLAIN
    },
    Axis {
        name: "contrast",
        about: "exponent of the tone curve times 2.2",
        kind: Kind::Number(Range::above(0.0, 100.0)),
        changes_radiance: false,
        default: || Value::Number(1.0),
        apply: |s, v| s.curve.contrast = v.number() as f32,
        ..PLAIN
    },
    Axis {
        name: "environment_rotation_deg",
        about: "turns the environment about +y",
        kind: Kind::Number(Range::closed(-360.0, 360.0)),
        default: || Value::Number(0.0),
        apply: |s, v| s.environment_rotation_deg = v.number(),
        ..PLAIN
    },
    Axis {
        name: "environment_scale",
        about: "multiplies the environment's radiance",
        kind: Kind::Number(Range::above(0.0, 1e9)),
        default: || Value::Number(1.0),
        apply: |s, v| s.environment_scale = v.number() as f32,
        ..PLAIN
    },
    Axis {
        name: "masking",
        about: "masking-shadowing; the same in a cell and its reference",
        kind: Kind::Name {
            what: "masking-shadowing",
            names: || MaskingShadowing::ALL.iter().map(|(name, _)| *name).collect(),
        },
        default: || Value::Text("separable".to_owned()),
        apply: |s, v| {
            let named = MaskingShadowing::ALL.iter().find(|(name, _)| *name == v.text());
            s.masking_shadowing = named.expect("the plan checked the masking's name").1;
        },
        ..PLAIN
    },
    Axis {
        name: "lod_bias",
        about: "added to the mip level of filtered samples",
        used: |u| u.method.uses_lod_bias,
        kind: Kind::Number(Range::closed(-16.0, 16.0)),
        default: || Value::Number(0.0),
        reference: |_, _| Value::Number(0.0),
        apply: |s, v| s.lod_bias = v.number() as f32,
        ..PLAIN
    },
    Axis {
        name: "prefilter_size",
        about: "width and height of the prefiltered map's first level",
        used: |u| u.method.uses_prefiltered,
        kind: Kind::Pair { min: 8, max: SIDE_MAX },
        default: || Value::Pair(PrecomputeSettings::default().prefilter_size),
        reference: |_, _| Value::Pair(PrecomputeSettings::default().prefilter_size),
        apply: |s, v| s.precompute.prefilter_size = v.pair(),
        ..PLAIN
    },
    Axis {
        name: "prefilter_level_count",
        about: "levels of the prefiltered map",
        used: |u| u.method.uses_prefiltered,
        kind: Kind::Count { min: 2, max: 12 },
        default: || Value::Count(PrecomputeSettings::default().prefilter_level_count),
        reference: |_, _| Value::Count(PrecomputeSettings::default().prefilter_level_count),
        apply: |s, v| s.precompute.prefilter_level_count = v.count(),
        ..PLAIN
    },
    Axis {
        name: "prefilter_sample_count",
        about: "samples a texel of the prefiltered map",
        used: |u| u.method.uses_prefiltered,
        kind: Kind::Count { min: 1, max: PRECOMPUTE_SAMPLES_MAX },
        default: || Value::Count(PrecomputeSettings::default().prefilter_sample_count),
        reference: |_, _| Value::Count(PrecomputeSettings::default().prefilter_sample_count),
        apply: |s, v| s.precompute.prefilter_sample_count = v.count(),
        ..PLAIN
    },
    Axis {
        name: "dfg_size",
        about: "side of the DFG table",
        used: |u| u.method.needs_dfg(u.diffuse, u.has_lights),
        kind: Kind::Count { min: 2, max: SIDE_MAX },
        default: || Value::Count(PrecomputeSettings::default().dfg_size),
        reference: |_, _| Value::Count(PrecomputeSettings::default().dfg_size),
        apply: |s, v| s.precompute.dfg_size = v.count(),
        ..PLAIN
    },
    Axis {
        name: "dfg_sample_count",
        about: "samples a texel of the DFG table",
        used: |u| u.method.needs_dfg(u.diffuse, u.has_lights),
        kind: Kind::Count { min: 1, max: PRECOMPUTE_SAMPLES_MAX },
        default: || Value::Count(PrecomputeSettings::default().dfg_sample_count),
        reference: |_, _| Value::Count(PrecomputeSettings::default().dfg_sample_count),
        apply: |s, v| s.precompute.dfg_sample_count = v.count(),
        ..PLAIN
    },
    Axis {
        name: "irradiance_size",
        about: "width and height of the irradiance map",
        used: |u| u.diffuse.uses_irradiance_map,
        kind: Kind::Pair { min: 2, max: SIDE_MAX },
        default: || Value::Pair(PrecomputeSettings::default().irradiance_size),
        reference: |_, _| Value::Pair(PrecomputeSettings::default().irradiance_size),
        apply: |s, v| s.precompute.irradiance_size = v.pair(),
        ..PLAIN
    },
    Axis {
        name: "irradiance_sample_count",
        about: "azimuth and polar samples a texel of the irradiance map",
        used: |u| u.diffuse.uses_irradiance_map,
        kind: Kind::Pair { min: 1, max: SIDE_MAX },
        default: || Value::Pair(PrecomputeSettings::default().irradiance_sample_count),
        reference: |_, _| Value::Pair(PrecomputeSettings::default().irradiance_sample_count),
        apply: |s, v| s.precompute.irradiance_sample_count = v.pair(),
        ..PLAIN
    },
];

/// Axes that `[precompute]` may set for all cells at once.
pub fn is_precompute(axis: &Axis) -> bool {
    ["prefilter_", "dfg_", "irradiance_"].iter().any(|prefix| axis.name.starts_with(prefix))
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
    method_by_name(name).expect("the plan checked the method's name")
}

fn diffuse(name: &str) -> &'static Diffuse {
    diffuse_by_name(name).expect("the plan checked the diffuse method's name")
}

/// One value for every axis, in the order of [`AXES`].
#[derive(Clone, Debug, PartialEq)]
pub struct Point(pub Vec<Value>);

impl Default for Point {
    fn default() -> Self {
        Self(AXES.iter().map(|axis| (axis.default)()).collect())
    }
}

impl Point {
    /// The value of the axis of that name.
    pub fn get(&self, name: &str) -> &Value {
        &self.0[index_of(name).unwrap_or_else(|| panic!("{name} is not an axis"))]
    }

    /// Sets the axis of that name.
    pub fn set(&mut self, name: &str, value: Value) {
        let index = index_of(name).unwrap_or_else(|| panic!("{name} is not an axis"));
        self.0[index] = value;
    }

    /// The point with every unused parameter unset, so that points with the same image are equal.
    pub fn collapsed(&self, has_lights: bool) -> Self {
        let (method, diffuse) = (method(self.get("method").text()), diffuse(self.get("diffuse").text()));
        let used = Used { method, diffuse, has_lights };
        let values = AXES.iter().zip(&self.0);
        Self(values.map(|(axis, value)| if (axis.used)(&used) { value.clone() } else { Value::Unset }).collect())
    }

    /// The point of this point's reference, collapsed.
    pub fn reference(&self, reference: &Reference, has_lights: bool) -> Self {
        let values = AXES.iter().zip(&self.0).map(|(axis, value)| (axis.reference)(reference, value));
        Self(values.collect()).collapsed(has_lights)
    }

    /// What the point means to the renderer.
    pub fn settings(&self) -> Settings {
        let mut settings = Settings {
            environment: String::new(),
            environment_rotation_deg: 0.0,
            environment_scale: 1.0,
            scene: String::new(),
            material: MaterialOverride::default(),
            brdf: brdf::MODELS[0],
            masking_shadowing: MaskingShadowing::default(),
            method: &METHODS[0],
            diffuse: &DIFFUSE[0],
            samples: 1,
            point_set: 0,
            lod_bias: 0.0,
            precompute: PrecomputeSettings::default(),
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
