//! The pixels of the live view against the renderer's.

use crate::chromium::{self, Page};
use crate::fixture::{Quiet, assert_clean, page_of};
use crate::live::{linear, open, rest};
use glam::DVec3;
use serde_json::json;
use splitsum::brdf::MODELS;
use splitsum::environment::{Environment, LoadOptions};
use splitsum::gpu::GpuError;
use splitsum::metrics::{Comparison, metric};
use splitsum::pipeline::{Options, Pipeline, PipelineError, RenderRequest};
use splitsum::runner::{Plan, RenderFault, Renderer, RunOptions, run};
use splitsum::scene::{Camera, MaterialOverride, Projection, Scene};
use splitsum::shade::{diffuse_by_name, method_by_name};
use splitsum::study::page::images::Choice;
use splitsum::tonemap::ToneCurve;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// A smooth sky with a Gaussian sun, and an edge between radiances of which one is beyond the half floats.
const ENVIRONMENTS: [&str; 2] =
    ["tests/golden/env_analytic.exr", "builtin:cap:radiance=200000,ambient=50000,half_angle_deg=40"];
const PREFILTER_SAMPLES: u32 = 32;
/// The run's own turn and level bias, with which its live view begins.
const ROTATION: f64 = 35.0;
const BIAS: f64 = 0.5;

/// A device; `None` (with a line) where there is none.
fn pipeline() -> Option<Pipeline> {
    match Pipeline::new(Options::default()) {
        Err(PipelineError::Gpu(error @ (GpuError::NoLoader(_) | GpuError::NoDevice))) => {
            eprintln!("skipped: {error}");
            None
        }
        pipeline => Some(pipeline.unwrap()),
    }
}

/// The plan of a small run in both environments.
fn plan() -> Plan {
    let text = format!(
        "name = \"live\"\nsize = [16, 16]\nreference = {{ samples = 32 }}\n[axes]\nenvironment = {}\nbrdf = [\"ggx\", \"phong\"]\n\
         alpha = [0.25]\nf0 = [1]\nalbedo = [0]\nmethod = [\"sampled\", \"split-sum\"]\nsamples = [12]\ndiffuse = [\"none\"]\n\
         masking = [\"correlated\"]\nprefilter_sample_count = [{PREFILTER_SAMPLES}]\n\
         environment_rotation_deg = [{ROTATION}]\nlod_bias = [{BIAS}]\n",
        json!(ENVIRONMENTS)
    );
    Plan::from_text(Path::new("live.toml"), &text, &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// The page of a run on the device.
struct Bench {
    page: Page,
    pipeline: Pipeline,
    plan: Plan,
    report: PathBuf,
    _dir: tempfile::TempDir,
}

fn bench() -> Option<Bench> {
    let mut page = chromium::open()?;
    let (Some(first), Some(pipeline)) = (pipeline(), pipeline()) else { return None };
    let dir = tempfile::tempdir().unwrap();
    let (plan, stop) = (plan(), AtomicBool::new(false));
    let options = RunOptions {
        dir: dir.path().join("run"),
        stop: &stop,
        command_line: Vec::new(),
        fail_fast: true,
        trace: false,
    };
    let mut first = Some(first);
    let mut make = || -> Result<Box<dyn Renderer>, RenderFault> { Ok(Box::new(first.take().unwrap())) };
    run(&plan, &mut make, &options, &mut Quiet).unwrap_or_else(|error| panic!("{error}"));
    let report = page_of(&options.dir, Choice::None);
    page.resize(1200, 800, "light");
    Some(Bench { page, pipeline, plan, report, _dir: dir })
}

/// Settings as the page's scripts name them, and what the renderer is asked for.
#[derive(Clone, Copy, Debug)]
struct Setting {
    environment: usize,
    brdf: &'static str,
    object: &'static str,
    albedo: [f32; 3],
    metallic: f32,
    f0: f32,
    roughness: f32,
    diffuse: bool,
    brightness: f32,
    samples: u32,
    filtered: bool,
    yaw: f64,
    pitch: f64,
    distance: f64,
    rotation: f64,
    bias: f32,
}

impl Setting {
    const FIRST: Self = Self {
        environment: 0,
        brdf: "ggx",
        object: "sphere",
        albedo: [0.9, 0.5, 0.2],
        metallic: 0.0,
        f0: 0.04,
        roughness: 0.5,
        diffuse: true,
        brightness: 1.0,
        samples: 12,
        filtered: true,
        yaw: 0.0,
        pitch: 0.0,
        distance: 1.0,
        rotation: 0.0,
        bias: 0.0,
    };

    fn script(&self) -> String {
        let Self { environment, brdf, object, albedo, metallic, f0, roughness, .. } = self;
        let Self { diffuse, brightness, samples, filtered, yaw, pitch, distance, rotation, bias, .. } = self;
        let values = json!({ "environment": environment, "brdf": brdf, "object": object, "albedo": albedo, "metallic": metallic,
            "f0": f0, "roughness": roughness, "diffuse": diffuse, "brightness": brightness, "samples": samples,
            "filtered": filtered, "yaw": yaw, "pitch": pitch, "distance": distance, "rotation": rotation, "bias": bias,
            "mode": "error" });
        format!("live.set({values})")
    }

    /// The camera on its way about the origin.
    fn camera(&self, size: [u32; 2]) -> Camera {
        let (sin_yaw, cos_yaw) = self.yaw.to_radians().sin_cos();
        let (sin_pitch, cos_pitch) = self.pitch.to_radians().sin_cos();
        let toward = DVec3::new(sin_yaw * cos_pitch, sin_pitch, cos_yaw * cos_pitch);
        let right = DVec3::new(cos_yaw, 0.0, -sin_yaw);
        let half = (16f64).to_radians().tan() * (f64::from(size[1]) / f64::from(size[0])).max(1.0);
        Camera {
            eye: toward * (4.0 * self.distance),
            right,
            up: toward.cross(right),
            forward: -toward,
            projection: Projection::Perspective { fov_deg: 2.0 * half.atan().to_degrees() },
            near: 0.05,
            far: 20.0,
        }
    }

    fn request(&self, plan: &Plan, method: &str, size: [u32; 2]) -> RenderRequest {
        let of_run = plan.request(&plan.cells[0].point);
        let environment =
            Environment::load(ENVIRONMENTS[self.environment], Path::new(""), &LoadOptions::default()).unwrap();
        let alpha = self.roughness * self.roughness;
        let surface = MaterialOverride {
            albedo: Some(self.albedo),
            metallic: Some(self.metallic),
            alpha: Some(alpha.max(1e-3)),
            f0: Some([self.f0; 3]),
        };
        let scene = Scene::load(self.object, Path::new("")).unwrap().apply(&surface);
        let method = match method {
            "split" => "split-sum",
            _ if self.filtered => "sampled",
            _ => "sampled-unfiltered",
        };
        RenderRequest {
            environment: Arc::new(environment),
            environment_scale: self.brightness,
            environment_rotation_deg: self.rotation,
            lod_bias: self.bias,
            camera: self.camera(size),
            scene: Arc::new(scene),
            size,
            method: method_by_name(method).unwrap(),
            diffuse: diffuse_by_name(if self.diffuse { "sh9" } else { "none" }).unwrap(),
            brdf: *MODELS.iter().find(|model| model.name() == self.brdf).unwrap(),
            samples: self.samples,
            background: true,
            ..of_run
        }
    }
}

/// Whether the page may differ from the renderer by `error`, relative: its maps are half floats (11 significant bits), one of them for
/// the sampled methods, the prefiltered map and the DFG table for the split sum.
fn is_storage_error(method: &str, error: f64) -> bool {
    const HALF: f64 = 1.0 / 2048.0;
    error <= if method == "split" { 2.0 * HALF } else { 1.2 * HALF }
}

#[test]
fn pixels_are_those_of_the_renderer() {
    let Some(Bench { mut page, mut pipeline, plan, report, _dir }) = bench() else { return };
    let size = [90, 70];
    open(&mut page, &report, "#live", size);
    assert_eq!(page.eval("live.tables.environments.map((e) => e.scale)"), json!([1, 4]));
    let begins = page.eval("[live.settings.rotation, live.settings.bias]");
    assert_eq!([&begins[0], &begins[1]].map(|x| x.as_f64()), [Some(ROTATION), Some(BIAS)]);
    let settings = [
        Setting::FIRST,
        Setting { metallic: 1.0, roughness: 0.2, yaw: 130.0, pitch: 25.0, ..Setting::FIRST },
        Setting { brdf: "phong", metallic: 0.5, roughness: 0.8, yaw: -60.0, brightness: 2.5, ..Setting::FIRST },
        Setting {
            environment: 1,
            f0: 1.0,
            diffuse: false,
            roughness: 1.0,
            samples: 64,
            distance: 1.5,
            ..Setting::FIRST
        },
        Setting { environment: 1, roughness: 0.0, metallic: 1.0, filtered: false, samples: 1, ..Setting::FIRST },
        Setting { object: "plane", roughness: 0.6, pitch: 20.0, yaw: 15.0, ..Setting::FIRST },
        // Another turn and another level, in every term: background, diffuse, prefiltered, sampled.
        Setting { rotation: 70.0, metallic: 0.5, roughness: 0.4, yaw: 20.0, ..Setting::FIRST },
        Setting { bias: 1.5, metallic: 1.0, roughness: 0.6, ..Setting::FIRST },
        Setting { rotation: -115.0, bias: -2.0, object: "plane", pitch: 30.0, roughness: 0.8, ..Setting::FIRST },
        // More than a frame takes.
        Setting { samples: 1024, brdf: "phong", metallic: 1.0, roughness: 0.7, ..Setting::FIRST },
    ];
    for setting in settings {
        page.eval(&format!("{}.then(() => null)", setting.script()));
        rest(&mut page);
        let mask = page.eval("Array.from(live.render.mask())");
        let mut truths = Vec::new();
        for method in ["split", "sampled"] {
            let truth = pipeline.render(&setting.request(&plan, method, size)).unwrap();
            let shown = linear(&mut page, method);
            assert_eq!(shown.len(), truth.radiance.data.len());
            let is_same = |i: &usize| mask[*i].as_f64() == Some(f64::from(truth.mask.data[*i]));
            let alike: Vec<usize> = (0..shown.len()).filter(is_same).collect();
            // The plane is cast, not rasterised, and the outline of the sphere rounds otherwise.
            assert!(
                shown.len() - alike.len() <= 5,
                "{setting:?}: {} pixels of another surface",
                shown.len() - alike.len()
            );
            for i in alike {
                for (a, b) in shown[i].iter().zip(truth.radiance.data[i].map(f64::from)) {
                    let error = (a - b).abs() / b.max(1e-3);
                    assert!(
                        is_storage_error(method, error),
                        "{setting:?}, {method}, pixel {i}: {a} for {b} ({error:.1e})"
                    );
                }
            }
            truths.push(truth);
        }
        // The page's number is the metric of the renderer's own images, and far above what storage makes of it.
        let comparison =
            Comparison::new(&truths[0].radiance, &truths[1].radiance, &truths[1].mask, ToneCurve::default()).unwrap();
        let wanted = comparison.evaluate(&[metric("relmse_eps1e-2").unwrap()])[0].1;
        let shown: f64 = page.eval("live.canvas.dataset.relmse").as_str().unwrap().parse().unwrap();
        assert!((shown - wanted).abs() < 0.02 * wanted + 1e-6, "{setting:?}: relMSE {shown} for {wanted}");
        assert!(wanted > 2e-6, "{setting:?}: the methods do not differ, so the test cannot fail: {wanted}");
    }
    // A page without the finest level reads the others as the renderer does.
    page.eval(
        "(() => { const e = live.tables.environments[0]; e.levels.shift(); e.first_level += 1; live.render.chains.clear(); })()",
    );
    let setting = Setting { metallic: 1.0, roughness: 0.8, ..Setting::FIRST };
    page.eval(&format!("{}.then(() => null)", setting.script()));
    rest(&mut page);
    let truth = pipeline.render(&setting.request(&plan, "sampled", size)).unwrap();
    let shown = linear(&mut page, "sampled");
    let mask = page.eval("Array.from(live.render.mask())");
    for i in (0..shown.len()).filter(|&i| mask[i].as_f64() == Some(1.0) && truth.mask.data[i] == 1.0) {
        for (a, b) in shown[i].iter().zip(truth.radiance.data[i].map(f64::from)) {
            assert!(is_storage_error("sampled", (a - b).abs() / b.max(1e-3)), "pixel {i}: {a} for {b}");
        }
    }
    for (width, height, scheme) in [(1440, 900, "light"), (390, 1500, "dark")] {
        page.resize(width, height, scheme);
        page.go(&report, "#live?n=12&mode=sampled&albedo=0.9,0.5,0.2&roughness=0.25");
        rest(&mut page);
        page.screenshot(&format!("live-device-{width}-{scheme}"));
    }
    assert_clean(&page);
}
