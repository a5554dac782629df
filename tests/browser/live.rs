//! The live view: its pixels against the renderer's, its controls, its link.

use super::{Quiet, assert_clean, report};
use crate::chromium::{self, Page};
use glam::DVec3;
use serde_json::{Value, json};
use splitsum::brdf::MODELS;
use splitsum::environment::{Environment, LoadOptions};
use splitsum::experiment::{Plan, RenderFault, Renderer, RunOptions, run};
use splitsum::gpu::GpuError;
use splitsum::metrics::{Comparison, metric};
use splitsum::pipeline::{Options, Pipeline, PipelineError, RenderRequest};
use splitsum::report::images::Choice;
use splitsum::report::{ReportOptions, write};
use splitsum::scene::{Camera, MaterialOverride, Projection, Scene};
use splitsum::shade::{diffuse_by_name, method_by_name};
use splitsum::table::colormap::{OFF_MASK_COLOR, RELATIVE_ERROR, SIGNED_ERROR};
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
    let report = write(&ReportOptions { images: Choice::None, ..ReportOptions::of_run(&options.dir) }).unwrap().path;
    page.resize(1200, 800, "light");
    Some(Bench { page, pipeline, plan, report, _dir: dir })
}

/// Waits until the view is at rest with every sample.
fn rest(page: &mut Page) {
    page.wait("document.querySelector('.live-stage canvas')?.dataset.ready === '1'");
}

/// Opens the view with a stage of `size` and makes it reachable as `live`.
fn open(page: &mut Page, report: &Path, hash: &str, size: [u32; 2]) {
    page.go(report, hash);
    page.eval(&format!(
        "import('report/live').then((module) => {{ window.live = module.liveView(); \
         document.querySelector('.live-stage').style.cssText = 'width: {}px; height: {}px; min-height: 0'; }})",
        size[0], size[1]
    ));
    page.wait(&format!("live.canvas.width === {} && live.canvas.height === {}", size[0], size[1]));
    rest(page);
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

/// Linear RGBA of the page.
fn linear(page: &mut Page, method: &str) -> Vec<[f64; 3]> {
    let values = page.eval(&format!("Array.from(live.render.linear('{method}'))"));
    let values: Vec<f64> = values.as_array().unwrap().iter().map(|x| x.as_f64().unwrap_or(f64::NAN)).collect();
    values.chunks_exact(4).map(|texel| [texel[0], texel[1], texel[2]]).collect()
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

/// Bytes of a pixel of the canvas, drawn in the same task; row 0 is the top.
fn drawn(page: &mut Page, mode: &str, x: u32, y: u32) -> [u8; 3] {
    let script = format!(
        "(() => {{ const gl = live.render.gl, out = new Uint8Array(4); live.render.drawResult('{mode}', false); \
         gl.readPixels({x}, live.canvas.height - 1 - {y}, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, out); return [...out]; }})()"
    );
    let bytes = page.eval(&script);
    std::array::from_fn(|c| bytes[c].as_u64().unwrap() as u8)
}

fn near(a: [u8; 3], b: [u8; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= 2)
}

#[test]
fn keys_sliders_and_the_link_of_the_live_view() {
    let Some((mut page, report, _dir)) = report(Choice::None) else { return };
    page.resize(1200, 800, "light");
    let size = [80, 60];
    open(&mut page, &report, "#live?object=sphere&pitch=0&yaw=0", size);
    let value = |page: &mut Page, script: &str| page.eval(script).as_f64().unwrap();
    let slide = |page: &mut Page, name: &str, value: f64| {
        page.eval(&format!(
            "(() => {{ const e = document.getElementById('live-{name}'); e.value = {value}; e.dispatchEvent(new Event('input')); }})()"
        ));
        rest(page);
    };
    // Constant light of radiance 1 and a lobe that reflects f0 whole: a metal of this albedo shows it as its radiance.
    for (name, at) in [("red", 0.9), ("green", 0.5), ("blue", 0.1), ("brightness", 2.0), ("metallic", 1.0)] {
        slide(&mut page, name, at);
    }
    let middle = (size[1] / 2 * size[0] + size[0] / 2) as usize;
    let shown = linear(&mut page, "split")[middle];
    assert!(shown.iter().zip([1.8, 1.0, 0.2]).all(|(a, b)| (a - b).abs() < 2e-3), "{shown:?}");
    slide(&mut page, "exposure", 1.0);
    slide(&mut page, "contrast", 2.0);
    let curve = ToneCurve { exposure: 2.0, contrast: 2.0 };
    let bytes = drawn(&mut page, "split", size[0] / 2, size[1] / 2);
    assert!(near(bytes, curve.apply_rgb8(shown.map(|x| x as f32))), "{bytes:?}");

    // Roughness and alpha, as the project defines them.
    slide(&mut page, "roughness", 0.5);
    assert_eq!(page.text("output[for=live-roughness]"), "0.5 · α 0.25");

    // Errors have the project's colours.
    page.key("3");
    rest(&mut page);
    assert_eq!(page.eval("document.querySelectorAll('.live .ramp-ticks span').length"), json!(4));
    let [test, truth] = ["split", "sampled"].map(|method| linear(&mut page, method)[middle]);
    let relative: [f64; 3] = std::array::from_fn(|c| (test[c] - truth[c]) / (truth[c].powi(2) + 1e-2).sqrt());
    let error = (relative.iter().map(|e| e * e).sum::<f64>() / 3.0).sqrt();
    assert!(error > 1e-2, "{test:?} {truth:?}");
    let bytes = drawn(&mut page, "error", size[0] / 2, size[1] / 2);
    assert!(near(bytes, RELATIVE_ERROR.color(error)), "{bytes:?} {error}");
    let bytes = drawn(&mut page, "signed", size[0] / 2, size[1] / 2);
    let signed = relative.iter().sum::<f64>() / 3.0;
    assert!(near(bytes, SIGNED_ERROR.color(signed)), "{bytes:?} {signed}");
    assert_eq!(drawn(&mut page, "error", 1, 1), OFF_MASK_COLOR);

    // Any first part of the samples is an estimate of the whole.
    slide(&mut page, "samples", 9.0);
    let whole = linear(&mut page, "sampled")[middle][1];
    let told = page.eval(
        "(() => { live.render.restart(); live.render.drawBase(); live.render.drawSamples(8); live.describe(); return live.badge.textContent; })()",
    );
    assert_eq!(told, json!("split sum against 8 of 64 samples a pixel"));
    let part = linear(&mut page, "sampled")[middle][1];
    assert_eq!(page.eval("live.settings.samples"), json!(64));
    let share = page.eval("live.render.done");
    assert_eq!(share, json!(8));
    assert!((part - whole).abs() < 0.15 * whole, "{part} of 8 for {whole} of 64");

    // Keys turn, flip and hold.
    page.eval("live.canvas.focus()");
    for key in ["ArrowRight", "ArrowRight", "ArrowUp"] {
        page.key(key);
    }
    assert_eq!((value(&mut page, "live.settings.yaw"), value(&mut page, "live.settings.pitch")), (10.0, 5.0));
    for (key, mode) in [("1", "split"), ("4", "signed"), ("2", "sampled")] {
        page.key(key);
        page.wait(&format!("live.canvas.dataset.mode === '{mode}'"));
    }
    page.press(" ");
    page.wait("live.canvas.dataset.mode === 'split'");
    page.release(" ");
    page.wait("live.canvas.dataset.mode === 'sampled'");
    page.click(".live [aria-label=Nearer]");
    page.eval("document.querySelector('.live .pickers select:last-of-type')");
    rest(&mut page);

    // A drag turns.
    let before = value(&mut page, "live.settings.yaw");
    page.eval(
        "(() => { const c = live.canvas, b = c.getBoundingClientRect(); const at = (type, x) => c.dispatchEvent(new PointerEvent(type, \
         { pointerId: 1, clientX: b.left + x, clientY: b.top + 9, buttons: 1, bubbles: true })); \
         c.setPointerCapture = () => {}; at('pointerdown', 10); at('pointermove', 50); at('pointerup', 50); })()",
    );
    let turned = value(&mut page, "live.settings.yaw");
    assert!((turned - (before - 90.0)).abs() < 1e-9, "40 of 80 pixels are a quarter turn: {before} to {turned}");
    rest(&mut page);

    // The address restores everything.
    let settings = page.eval("JSON.stringify(live.settings)");
    page.wait("location.hash.includes('yaw=-80')");
    let hash = page.eval("location.hash").as_str().unwrap().to_owned();
    assert!(hash.contains("mode=sampled") && hash.contains("roughness=0.5"), "{hash}");
    open(&mut page, &report, &hash, size);
    let rounded = |text: &Value| {
        let value: Value = serde_json::from_str(text.as_str().unwrap()).unwrap();
        value
            .as_object()
            .unwrap()
            .iter()
            .map(|(k, v)| match v.as_f64() {
                Some(x) => (k.clone(), json!((x * 100.0).round() / 100.0)),
                None => (k.clone(), v.clone()),
            })
            .collect::<serde_json::Map<_, _>>()
    };
    assert_eq!(rounded(&page.eval("JSON.stringify(live.settings)")), rounded(&settings));

    // Everything has a name for a screen reader.
    let unnamed = page.eval(
        "[...document.querySelectorAll('.live input, .live select')].filter((e) => !e.labels?.[0]?.textContent.trim() && !e.getAttribute('aria-label')).length \
         + [...document.querySelectorAll('.live button')].filter((b) => !b.textContent.trim() && !b.getAttribute('aria-label')).length \
         + (document.querySelector('.live canvas').getAttribute('aria-label').includes('roughness') ? 0 : 1)",
    );
    assert_eq!(unnamed, json!(0));
    assert_clean(&page);
}

#[test]
fn without_float_targets_or_tables_the_live_view_says_so() {
    let Some((mut page, report, _dir)) = report(Choice::None) else { return };
    let blocked = "const get = WebGL2RenderingContext.prototype.getExtension; WebGL2RenderingContext.prototype.getExtension = \
                   function (name) { return name === 'EXT_color_buffer_float' ? null : get.call(this, name); };";
    page.before_load(blocked);
    page.go(&report, "#live");
    let text = page.text("#view-live");
    assert!(text.contains("EXT_color_buffer_float") && text.contains("needs"), "{text}");

    std::fs::remove_file(report.with_file_name("live.json")).unwrap();
    let dir = report.parent().unwrap();
    let written = write(&ReportOptions { images: Choice::None, ..ReportOptions::of_run(dir) }).unwrap();
    page.go(&written.path, "#live");
    assert!(page.text("#view-live").contains("has no live.json"));
    assert_clean(&page);
}
