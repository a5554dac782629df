//! Turns the values of a point into settings of the renderer.

use crate::base::names::listed;
use crate::experiment::value::Value;
use crate::instrument::environment::Environment;
use crate::instrument::gpu::ShaderVariant;
use crate::instrument::metrics::{NOISE_SHARE, NoiseUse};
use crate::instrument::pipeline::{Illumination, RenderRequest};
use crate::instrument::precompute::dfg::DfgAxes;
use crate::instrument::precompute::given::{Given, OWN};
use crate::instrument::scene::{
    Camera, CameraKind, Light, LightChange, MaterialOverride, Orbit, Scene,
};
use crate::instrument::shade::pass::specular_shader;
use crate::instrument::shade::reference_pass::PILOT_SAMPLES;
use crate::instrument::shade::{NONE, REFERENCE, Shading};
use crate::instrument::tonemap::ToneCurve;
use std::f64::consts::PI;
use std::sync::Arc;

/// The settings of one point. All points share the rest of a request (camera, seed).
#[derive(Clone, Debug)]
pub struct Settings {
    /// Width and height of the image, pixels.
    pub size: [u32; 2],
    /// `builtin:NAME` or a path.
    pub environment: String,
    /// A scene's name or a path.
    pub scene: String,
    pub material: MaterialOverride,
    /// Multiplies the colours of all direct lights.
    pub light_intensity: f64,
    /// Turns all direct lights about the y axis.
    pub light_turn_deg: f64,
    pub shading: Shading,
    /// `own` or a file.
    pub prefiltered: String,
    pub dfg: String,
    pub curve: ToneCurve,
}

/// How the value of an axis enters the settings, by the kind of its values.
#[derive(Clone, Copy)]
pub enum Setter {
    /// Another part of a request has it.
    Nothing,
    Number(fn(&mut Settings, f64)),
    Count(fn(&mut Settings, u32)),
    /// Linear RGB.
    Color(fn(&mut Settings, [f32; 3])),
    Pair(fn(&mut Settings, [u32; 2])),
    /// A listed name or the name of an input.
    Name(fn(&mut Settings, &str)),
}

impl Setter {
    /// Sets a value; an unset one changes nothing.
    ///
    /// # Panics
    ///
    /// If the axis parses values of another kind.
    pub fn apply(self, settings: &mut Settings, value: &Value) {
        match (self, value) {
            (Self::Nothing, _) | (_, Value::Unset) => {}
            (Self::Number(set), Value::Number(number)) => set(settings, *number),
            (Self::Count(set), Value::Count(count)) => set(settings, *count),
            (Self::Color(set), Value::Color(color)) => set(settings, *color),
            (Self::Pair(set), Value::Pair(pair)) => set(settings, *pair),
            (Self::Name(set), Value::Text(name)) => set(settings, name),
            _ => panic!("{value:?} is not of the kind that its axis sets"),
        }
    }
}

/// The part of a request that all points of an experiment share.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    pub camera: CameraKind,
    pub orbit: Orbit,
    pub background: bool,
    pub antialias: bool,
    /// Besides the lights of the scene's file.
    pub lights: Vec<Light>,
    pub seed: u32,
    /// Samples of a reference diffuse term if the specular method is not a reference.
    pub reference_samples: u32,
    /// Stops a reference earlier: largest relative standard error of each term.
    pub reference_error: Option<f64>,
}

impl Settings {
    fn dfg_axes(&self) -> DfgAxes {
        if self.dfg == OWN {
            DfgAxes::default()
        } else {
            DfgAxes::Centres
        }
    }

    /// Returns the shader of the specular pass, to compile it without a request.
    pub fn specular_variant(&self) -> ShaderVariant {
        let mut shading = self.shading;
        shading.precompute.dfg_axes = self.dfg_axes();
        ShaderVariant::new(
            specular_shader(shading.precompute.layout, shading.method, shading.brdf),
            &shading.specialization().words(),
        )
    }

    /// Builds the request: `scene` with the settings' material and the `given` tables.
    pub fn request(
        self,
        environment: &Arc<Environment>,
        scene: &Scene,
        view: &View,
        given: Given,
    ) -> RenderRequest {
        let scene = Arc::new(scene.apply(&self.material));
        let camera = Camera::for_scene(view.camera, &scene, self.size).orbited(view.orbit, &scene);
        self.request_from(camera, environment, scene, view, given)
    }

    /// Builds the request for a camera and a scene that has the settings' material.
    pub fn request_from(
        self,
        camera: Camera,
        environment: &Arc<Environment>,
        scene: Arc<Scene>,
        view: &View,
        given: Given,
    ) -> RenderRequest {
        let scene = self.lit(scene, environment, &view.lights);
        let mut shading = self.shading;
        let precompute = &mut shading.precompute;
        if let Some(map) = &given.prefiltered {
            precompute.layout = map.layout;
            precompute.prefilter_size = [map.side; 2];
            precompute.irradiance_size = [precompute.irradiance_size[1]; 2];
            precompute.prefilter_level_count = map.levels.len() as u32;
            precompute.level_mapping = map.mapping;
        }
        precompute.dfg_size = given
            .dfg
            .as_ref()
            .map_or(precompute.dfg_size, |table| table.side);
        precompute.dfg_axes = self.dfg_axes();
        RenderRequest {
            environment: environment.clone(),
            camera,
            scene,
            size: self.size,
            shading,
            reference_samples: if shading.method.is_integrated() {
                shading.samples
            } else {
                view.reference_samples
            },
            reference_error: view.reference_error,
            background: view.background,
            antialias: view.antialias,
            given,
            seed: view.seed,
            illumination: Illumination::Environment,
        }
    }

    /// Returns a scene under its own lights and `more`, as the settings change them; lights of no
    /// intensity are left out.
    fn lit(&self, scene: Arc<Scene>, environment: &Environment, more: &[Light]) -> Arc<Scene> {
        if scene.lights.is_empty() && more.is_empty() {
            return scene;
        }
        let scale = f64::from(self.shading.environment_scale);
        let change = LightChange {
            intensity: self.light_intensity,
            turn_deg: self.light_turn_deg,
            map_irradiance: PI * environment.luminance.mean * scale,
        };
        let lights = scene.lights.iter().chain(more);
        let lights = lights
            .map(|light| light.changed(&change))
            .filter(|light| !light.is_dark());
        Arc::new(scene.lit_by(lights.collect()))
    }
}

/// The image that an experiment compares with.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    pub method: String,
    /// Samples a pixel: at most this many if it stops earlier.
    pub samples: u32,
    /// Stops earlier: largest relative standard error of each term
    /// (`shade::reference_pass::Convergence`).
    pub relative_error: Option<f64>,
    /// Stops earlier, as the experiment says: see [`Reference::noise_share`].
    pub stated_noise_share: Option<f64>,
    pub terms: Terms,
}

/// The factor of the samples from one round of a reference to the next.
const ROUND_FACTOR: u32 = 2;

/// Terms of a cell's reference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Terms {
    #[default]
    Cell,
    /// Always specular and diffuse, so the score of a cell includes a term that it lacks.
    All,
}

listed!(Terms, "choice of terms", { "cell": Cell, "all": All });

impl Reference {
    /// Returns the largest noise of a reference over the error of each image that it judges, both
    /// as mean squares ([`crate::instrument::metrics::Metric::noise_share`]); `None` for exact
    /// references, which take all their samples or stop at a relative error.
    pub fn noise_share(&self) -> Option<f64> {
        let default = if self.relative_error.is_some() {
            0.0
        } else {
            NOISE_SHARE
        };
        Some(self.stated_noise_share.unwrap_or(default)).filter(|share| *share > 0.0)
    }

    /// What answers do with the noise floors.
    pub fn noise_use(&self) -> NoiseUse {
        NoiseUse::of_share(self.noise_share())
    }

    /// Lists the sample counts of a reference that is as exact as its images need: 64, 128,
    /// 256 ..., at last all its samples.
    pub fn rounds(&self) -> Vec<u32> {
        let mut rounds: Vec<u32> =
            std::iter::successors(Some(PILOT_SAMPLES), |count| count.checked_mul(ROUND_FACTOR))
                .take_while(|count| *count < self.samples)
                .collect();
        rounds.push(self.samples);
        rounds
    }

    pub(super) fn leaves_out(&self, value: &Value) -> bool {
        value.text() == NONE && self.terms == Terms::Cell
    }
}

impl Default for Reference {
    fn default() -> Self {
        Self {
            method: REFERENCE.to_owned(),
            samples: 4096,
            relative_error: None,
            stated_noise_share: None,
            terms: Terms::default(),
        }
    }
}
