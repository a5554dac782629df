//! The pixels of the live view against the renderer's: spheres, a mesh, layers, and the reference.

use crate::chromium::{self, Page};
use crate::fake::Silent;
use crate::fixture::{assert_clean, page_of};
use crate::gltf_files::mesh;
use crate::live::{linear, open, rest};
use serde::Serialize;
use serde_json::json;
use splitsum::base::names::Listed;
use splitsum::experiment::Plan;
use splitsum::instrument::brdf::MODELS;
use splitsum::instrument::environment::{Environment, LoadOptions, Placement};
use splitsum::instrument::gpu::GpuError;
use splitsum::instrument::metrics::{Comparison, Metric};
use splitsum::instrument::pipeline::{Frame, Options, Pipeline, PipelineError, RenderRequest};
use splitsum::instrument::scene::{Camera, CameraKind, MaterialOverride, Orbit, Projection, Scene};
use splitsum::instrument::shade::bend::Bend;
use splitsum::instrument::shade::{Diffuse, Method};
use splitsum::instrument::tonemap::ToneCurve;
use splitsum::report::COMPANIONS;
use splitsum::report::page::images::Choice;
use splitsum::run::{RenderFault, Renderer, RunOptions, run};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// A smooth sky with a Gaussian sun, and an edge between two radiances; one exceeds half floats.
const ENVIRONMENTS: [&str; 2] = [
    "tests/golden/env_analytic.exr",
    "builtin:cap:radiance=200000,ambient=50000,half_angle_deg=40",
];
const PREFILTER_SAMPLES: u32 = 32;
/// The run's own rotation, level bias and brightness, which its live view starts with.
const ORIENTATIONS: [u32; 2] = [0, 9];
const ROTATION: f64 = 35.0;
const BIAS: f64 = 0.5;
const BRIGHTNESS: f32 = 2.5;
/// Exact spheres with their own materials, and triangles with tangents and with every layer.
const SCENES: [&str; 3] = ["sphere", "spheres", "sheet.gltf"];
const BEND: &str = "unity";
/// Sides of the run's images; the camera knows their aspect.
const RUN_SIZE: [u32; 2] = [16, 16];

const METRIC: &str = "relmse";
const REFERENCE_SAMPLES: u32 = 1024;
/// Largest change of the error by the noise of both references.
const REFERENCE_SHARE: f64 = 0.1;

/// Largest change of the root of relMSE between two methods by half floats: the sum of both
/// methods' changes.
const PAIR_ERROR: f64 = 3.2 / 2048.0;

/// Opens a device; returns `None` and prints a line without one.
pub fn pipeline() -> Option<Pipeline> {
    match Pipeline::new(Options::default()) {
        Err(PipelineError::Gpu(error @ (GpuError::NoLoader(_) | GpuError::NoDevice))) => {
            eprintln!("skipped: {error}");
            None
        }
        pipeline => Some(pipeline.unwrap()),
    }
}

fn write_sheet(dir: &Path) {
    let positions = [
        -1.0, -1.0, 0.0, 1.0, -1.0, 0.3, 1.0, 1.0, -0.2, -1.0, 1.0, 0.1,
    ];
    // Octahedral numbers hold this normal exactly.
    let normals = [0.0, 0.0, 1.0].repeat(4);
    let tangents = [
        0.6, 0.8, 0.0, -1.0, 0.8, 0.0, -0.6, -1.0, 0.96, 0.28, 0.0, -1.0, 0.0, 1.0, 0.0, -1.0,
    ];
    let extensions = json!({
        "KHR_materials_anisotropy": { "anisotropyStrength": 0.7, "anisotropyRotation": 0.4 },
        "KHR_materials_clearcoat": { "clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.4 },
        "KHR_materials_sheen": { "sheenColorFactor": [0.3, 0.5, 0.1], "sheenRoughnessFactor": 0.6 },
    });
    let attributes = [
        ("POSITION", 3, &positions[..]),
        ("NORMAL", 3, &normals),
        ("TANGENT", 4, &tangents),
    ];
    let mut model = mesh(&attributes, &[0, 1, 2, 0, 2, 3]);
    model["materials"] = json!([{ "doubleSided": true, "extensions": extensions }]);
    std::fs::write(dir.join(SCENES[2]), model.to_string()).unwrap();
}

/// The plan of a small run in both environments. Its maps are octahedral, because the shader
/// filters them. The browser's device filters cubes with weights of so few bits that pixels move by
/// 0.5 %.
fn plan(dir: &Path) -> Plan {
    let environments = ENVIRONMENTS
        .map(|name| name.replace("tests/", concat!(env!("CARGO_MANIFEST_DIR"), "/tests/")));
    let text = format!(
        "name = \"live\"\nsize = {RUN_SIZE:?}\ncamera = \"perspective\"\nreference = {{ samples = \
         32 }}\n[axes]\n\
         environment = {}\nscene = {}\nbrdf = [\"ggx\", \"phong\"]\nmethod = \
         [\"sampled\", \"split-sum\", \"split-sum-two\", \"split-sum-four\"]\nsamples = [12]\n\
         diffuse = [\"none\"]\nmasking = [\"correlated\"]\nlayout = \
         [\"octahedral\"]\nprefilter_size = [[160, 160]]\nprefilter = \
         [\"sampled\"]\nprefilter_sample_count = [{PREFILTER_SAMPLES}]\nlevel_mapping = \
         [\"unity\"]\n\
         environment_orientation = {ORIENTATIONS:?}\nenvironment_rotation_deg = \
         [{ROTATION}]\nlod_bias = [{BIAS}]\nenvironment_scale = [{BRIGHTNESS}]\n",
        json!(environments),
        json!(SCENES)
    );
    Plan::from_text(&dir.join("live.toml"), &text, &[]).unwrap_or_else(|error| panic!("{error}"))
}

struct Bench {
    page: Page,
    pipeline: Pipeline,
    plan: Plan,
    report: PathBuf,
    dir: tempfile::TempDir,
}

fn bench() -> Option<Bench> {
    let mut page = chromium::open()?;
    let (Some(first), Some(pipeline)) = (pipeline(), pipeline()) else {
        return None;
    };
    let dir = tempfile::tempdir().unwrap();
    write_sheet(dir.path());
    let (plan, stop) = (plan(dir.path()), AtomicBool::new(false));
    let options = RunOptions {
        fail_fast: true,
        companions: COMPANIONS,
        ..RunOptions::new(&dir.path().join("run"), &stop)
    };
    let mut first = Some(first);
    let mut make =
        || -> Result<Box<dyn Renderer>, RenderFault> { Ok(Box::new(first.take().unwrap())) };
    run(&plan, &mut make, &options, &mut Silent).unwrap_or_else(|error| panic!("{error}"));
    let report = page_of(&options.dir, Choice::None);
    page.resize(1200, 800, "light");
    Some(Bench {
        page,
        pipeline,
        plan,
        report,
        dir,
    })
}

/// Settings as the page's scripts name them, and the same request to the renderer.
#[derive(Clone, Copy, Debug, Serialize)]
struct Setting {
    env: usize,
    model: usize,
    lobe: usize,
    #[serde(flatten)]
    surface: Surface,
    diffuse: bool,
    n: u32,
    yaw: f64,
    pitch: f64,
    distance: f64,
    /// Index of `ORIENTATIONS`.
    orientation: usize,
    turn: f64,
}

/// `None` keeps the scene's own value.
#[derive(Clone, Copy, Debug, Default, Serialize)]
struct Surface {
    albedo: Option<[f32; 3]>,
    metallic: Option<f32>,
    f0: Option<f32>,
    roughness: Option<f32>,
    anisotropy: Option<f32>,
    /// Degrees.
    anisotropy_turn: Option<f32>,
    coat: Option<f32>,
    coat_roughness: Option<f32>,
    sheen: Option<[f32; 3]>,
    sheen_roughness: Option<f32>,
}

impl Surface {
    fn at(metallic: f32, roughness: f32) -> Self {
        let (metallic, roughness) = (Some(metallic), Some(roughness));
        Self {
            albedo: Some([0.9, 0.5, 0.2]),
            metallic,
            f0: Some(0.04),
            roughness,
            ..Self::default()
        }
    }
}

impl Setting {
    fn first() -> Self {
        let (surface, [yaw, pitch, turn]) = (Surface::at(0.0, 0.5), [0.0; 3]);
        Self {
            env: 0,
            model: 0,
            lobe: 0,
            surface,
            diffuse: true,
            n: 12,
            yaw,
            pitch,
            distance: 1.0,
            orientation: 0,
            turn,
        }
    }

    fn script(&self) -> String {
        let mut values = json!(self);
        (values["method"], values["against"], values["mode"]) =
            ("sampled".into(), "split-sum".into(), "error".into());
        values["bend"] = BEND.into();
        format!("live.set({values}).then(() => null)")
    }

    /// The run's camera, turned about the middle of the scene.
    fn camera(&self, scene: &Scene, size: [u32; 2]) -> Camera {
        let camera = Camera::for_scene(CameraKind::Perspective, scene, RUN_SIZE);
        // A tall image fits the width. Distance widens the view.
        let half = self.distance
            * camera.extent(1.0)[1]
            * (f64::from(size[1]) / f64::from(size[0])).max(1.0);
        let projection = Projection::Perspective {
            fov_deg: 2.0 * half.atan().to_degrees(),
        };
        let orbit = Orbit {
            yaw_deg: self.yaw,
            pitch_deg: self.pitch,
            distance: 1.0,
        };
        Camera {
            projection,
            ..camera.orbited(orbit, scene)
        }
    }

    fn request(
        &self,
        dir: &Path,
        plan: &Plan,
        method: &str,
        samples: u32,
        size: [u32; 2],
    ) -> RenderRequest {
        let of_run = plan.request(&plan.cells[0].point);
        let environment = Environment::load(
            ENVIRONMENTS[self.env],
            Path::new(""),
            &LoadOptions::default(),
        )
        .unwrap();
        let scene = Scene::load(SCENES[self.model], dir).unwrap();
        let Surface {
            albedo,
            metallic,
            f0,
            anisotropy,
            coat,
            sheen: sheen_color,
            ..
        } = self.surface;
        let alpha =
            |roughness: Option<f32>| roughness.map(|roughness| (roughness * roughness).max(1e-3));
        let surface = MaterialOverride {
            alpha: alpha(self.surface.roughness),
            f0: f0.map(|f0| [f0; 3]),
            anisotropy_turn: self.surface.anisotropy_turn.map(f32::to_radians),
            coat_alpha: alpha(self.surface.coat_roughness),
            sheen_alpha: alpha(self.surface.sheen_roughness),
            ..MaterialOverride {
                albedo,
                metallic,
                anisotropy,
                coat,
                sheen_color,
                ..MaterialOverride::default()
            }
        };
        RenderRequest {
            environment: Arc::new(environment),
            camera: self.camera(&scene, size),
            scene: Arc::new(scene.apply(&surface)),
            size,
            reference_samples: samples,
            background: true,
            ..of_run.shaded(|s| {
                s.placement = Placement {
                    orientation: ORIENTATIONS[self.orientation],
                    rotation_deg: self.turn,
                };
                s.method = Method::listed(method);
                s.diffuse = Diffuse::listed(if self.diffuse { "sh9" } else { "none" });
                s.brdf = *MODELS
                    .iter()
                    .find(|model| model.name() == ["ggx", "phong"][self.lobe])
                    .unwrap();
                s.samples = samples;
                s.bend = Bend::listed(BEND);
            })
        }
    }
}

/// Relative difference that the page may have from the renderer. Its maps are half floats (11
/// significant bits): one map for sampled methods, the prefiltered map and the DFG table for the
/// split sum, and places, levels and weights of taps.
fn is_storage_error(method: &str, error: f64) -> bool {
    const HALF: f64 = 1.0 / 2048.0;
    let method = Method::listed(method);
    let halves = match (method.tap_table, method.lookups) {
        // Half floats move a tap by up to 1.5e-3.
        (Some(_), _) => 8.0,
        (None, 0) => 1.2,
        (None, _) => 2.0,
    };
    error <= HALF * halves
}

#[test]
fn pixels_and_errors_equal_the_renderers() {
    let Some(Bench {
        mut page,
        mut pipeline,
        plan,
        report,
        dir,
    }) = bench()
    else {
        return;
    };
    let size = [32, 24];
    open(&mut page, &report, "#live", size);
    assert_eq!(
        page.eval("live.tables.environments.map((e) => e.scale)"),
        json!([1, 4])
    );
    let begins =
        page.eval("[live.settings.turn, live.render.view.bias, live.render.view.brightness]");
    let begins: Vec<f64> = begins
        .as_array()
        .unwrap()
        .iter()
        .map(|x| x.as_f64().unwrap())
        .collect();
    assert_eq!(begins, [ROTATION, BIAS, f64::from(BRIGHTNESS)]);
    let first = Setting::first();
    let brushed = Surface {
        anisotropy: Some(0.8),
        anisotropy_turn: Some(30.0),
        ..Surface::at(1.0, 0.4)
    };
    let cloth = Surface {
        sheen: Some([0.7, 0.4, 0.1]),
        sheen_roughness: Some(0.5),
        ..first.surface
    };
    let settings = [
        first,
        Setting {
            surface: Surface::at(1.0, 0.2),
            yaw: 130.0,
            pitch: 25.0,
            ..first
        },
        Setting {
            lobe: 1,
            surface: Surface::at(0.5, 0.8),
            yaw: -60.0,
            orientation: 1,
            turn: 70.0,
            ..first
        },
        Setting {
            env: 1,
            surface: Surface::at(1.0, 1.0),
            diffuse: false,
            n: 64,
            distance: 1.5,
            orientation: 1,
            turn: -115.0,
            ..first
        },
        // More samples than a frame takes, on the scene's own materials.
        Setting {
            model: 1,
            surface: Surface::default(),
            n: 1024,
            yaw: 15.0,
            ..first
        },
        // Triangles.
        Setting {
            model: 2,
            surface: Surface::at(0.0, 0.6),
            pitch: 20.0,
            yaw: 15.0,
            ..first
        },
        Setting {
            surface: brushed,
            ..first
        },
        Setting {
            model: 1,
            surface: Surface {
                coat: Some(0.8),
                coat_roughness: Some(0.3),
                ..first.surface
            },
            ..first
        },
        Setting {
            surface: cloth,
            n: 1024,
            ..first
        },
    ];
    let methods = page.eval("live.tables.methods.map((method) => method.name)");
    let methods: Vec<&str> = methods
        .as_array()
        .unwrap()
        .iter()
        .map(|name| name.as_str().unwrap())
        .collect();
    for setting in settings {
        page.eval(&setting.script());
        rest(&mut page);
        let mut render = |method, samples| {
            pipeline
                .render(&setting.request(dir.path(), &plan, method, samples, size))
                .unwrap()
        };
        let mut frames = Vec::new();
        for method in &methods {
            let truth = render(method, setting.n);
            let shown = linear(&mut page, method);
            assert_eq!(shown.len(), truth.radiance.data.len());
            let is_same = |i: &usize| shown[*i][3] == f64::from(truth.mask.data[*i]);
            let alike: Vec<usize> = (0..shown.len()).filter(is_same).collect();
            // Outlines round differently, and edges of triangles lie between 16-bit positions.
            let others = shown.len() - alike.len();
            assert!(
                others <= 5,
                "{setting:?}: {others} pixels of another surface"
            );
            // The background shows the environment of the tables.
            for i in alike.into_iter().filter(|&i| truth.mask.data[i] == 1.0) {
                for (a, b) in shown[i].iter().zip(truth.radiance.data[i].map(f64::from)) {
                    let error = (a - b).abs() / b.max(1e-3);
                    assert!(
                        is_storage_error(method, error),
                        "{setting:?}, {method}, pixel {i}: {a} for {b} ({error:.1e})"
                    );
                }
            }
            frames.push(truth);
        }
        // The page's numbers equal the metric: one method against another, and the split sum
        // against the renderer's reference.
        let number = |page: &mut Page, name: &str| {
            page.eval(&format!("Number(live.canvas.dataset.{name})"))
                .as_f64()
                .unwrap()
        };
        let relmse = |test: &Frame, truth: &Frame| {
            let epsilon = setting
                .request(dir.path(), &plan, "split-sum", 1, size)
                .epsilon();
            let (test, curve) = (&test.radiance, ToneCurve::default());
            let comparison =
                Comparison::new(test, &truth.radiance, &truth.mask, curve, epsilon).unwrap();
            comparison.evaluate(&[Metric::listed(METRIC)])[0].1
        };
        let frame_of =
            |name: &str| &frames[methods.iter().position(|method| *method == name).unwrap()];
        let split = frame_of("split-sum");
        let (shown, wanted) = (
            number(&mut page, "relmse"),
            relmse(frame_of("sampled"), split),
        );
        assert!(
            (shown.sqrt() - wanted.sqrt()).abs() < PAIR_ERROR,
            "{setting:?}: {shown} for {wanted}"
        );
        page.eval("live.set({ method: 'split-sum', against: 'reference' })");
        rest(&mut page);
        let wanted = relmse(split, &render("reference", REFERENCE_SAMPLES));
        let [shown, noise] = ["relmse", "noise"].map(|name| number(&mut page, name));
        let count = page.eval("live.render.done.reference");
        println!(
            "{setting:?}: relMSE {shown:.3e} for {wanted:.3e}, noise {noise:.1e} after {count}"
        );
        assert!(
            (shown - wanted).abs() < REFERENCE_SHARE * wanted + 1e-6,
            "{setting:?}: {shown} for {wanted}"
        );
    }
    assert_clean(&page);
}
