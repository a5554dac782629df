//! Devices for tests, probes, and the requests and images that several tests share.

use glam::DVec3;
use splitsum::base::glsl::constants::GROUP_LINEAR;
use splitsum::base::glsl::layout::{ProbeParams, SharedStruct};
use splitsum::base::names::Listed;
use splitsum::base::pixels::{Pixels, RgbImage, exr};
use splitsum::instrument::environment::Environment;
use splitsum::instrument::environment::layout::LAYOUTS;
use splitsum::instrument::gpu::{Bind, Buffer, Gpu, GpuError, Image, Options};
use splitsum::instrument::pipeline::{Frame, Pipeline, RenderRequest};
use splitsum::instrument::precompute::PrecomputeSettings;
use splitsum::instrument::scene::{CameraKind, MaterialOverride, Scene};
use splitsum::instrument::shade::Method;
use std::cell::Cell;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// A quiet NaN: no pass may read it before it has written.
pub const POISON: u32 = 0x7fc0_dead;

/// Opens a device, with the validation layer unless it is missing or turned off. Returns `None` and
/// prints a line without a device.
fn open(is_interactive: bool) -> Option<Gpu> {
    let required = std::env::var("GOLDEN").is_ok_and(|value| value == "require");
    let validation = std::env::var("SPLITSUM_VALIDATION").map_or(true, |value| value != "0");
    let options = Options {
        is_interactive,
        ..Options::default()
    };
    let opened = match Gpu::new(Options {
        validation,
        ..options
    }) {
        Err(GpuError::NoValidationLayer) if !required => {
            eprintln!("not validated: {}", GpuError::NoValidationLayer);
            Gpu::new(options)
        }
        opened => opened,
    };
    match opened {
        Err(error @ (GpuError::NoLoader(_) | GpuError::NoDevice)) if !required => {
            eprintln!("skipped: {error}");
            None
        }
        opened => Some(opened.unwrap()),
    }
}

/// The device that tests use one after the other. Each test finds the compiled pipelines and the
/// memory contents of earlier tests.
fn shared() -> Option<Gpu> {
    static SHARED: OnceLock<Option<Gpu>> = OnceLock::new();
    SHARED.get_or_init(|| open(false)).clone()
}

/// Runs `test` with a device; fails on any new message of the validation layer.
fn watched(gpu: &Gpu, test: impl FnOnce()) {
    let before = gpu.validation_messages().len();
    test();
    assert_eq!(gpu.validation_messages()[before..], Vec::<String>::new());
}

/// The turn of a thread. Validation layer 1.3.239 keeps its devices in a table without a lock: a
/// call on one device can crash while another thread opens or closes another one (docs/testing.md).
/// So one test at a time has devices; it may have several.
struct Turn {
    guard: Option<MutexGuard<'static, ()>>,
}

static TURN: Mutex<()> = Mutex::new(());

thread_local! {
    static HAS_TURN: Cell<bool> = const { Cell::new(false) };
}

impl Turn {
    fn wait() -> Self {
        let had = HAS_TURN.replace(true);
        // A failed test returned its devices as well.
        Self {
            guard: (!had).then(|| TURN.lock().unwrap_or_else(PoisonError::into_inner)),
        }
    }
}

impl Drop for Turn {
    fn drop(&mut self) {
        HAS_TURN.set(self.guard.is_none());
    }
}

/// Whether the device of this turn filters cubes across their edges.
static HAS_CUBES: AtomicBool = AtomicBool::new(true);

/// Default tables, in the first layout that the device filters.
pub fn usual_tables() -> PrecomputeSettings {
    let is_cube_fit = HAS_CUBES.load(Ordering::Relaxed);
    let layout = LAYOUTS
        .iter()
        .find(|layout| is_cube_fit || layout.face_count == 1)
        .unwrap();
    let (prefilter_size, irradiance_size) = (layout.prefilter_size, layout.irradiance_size);
    PrecomputeSettings {
        layout,
        prefilter_size,
        irradiance_size,
        ..PrecomputeSettings::default()
    }
}

/// Runs `test` on the shared device; fails on any message of the validation layer.
pub fn with_gpu(test: impl FnOnce(&Gpu)) {
    let _turn = Turn::wait();
    let Some(gpu) = shared() else { return };
    HAS_CUBES.store(gpu.info().has_seamless_cubes, Ordering::Relaxed);
    watched(&gpu, || test(&gpu));
}

/// The same with every pass, and no cached results of another test.
pub fn with_pipeline(test: impl FnOnce(&mut Pipeline)) {
    with_submissions(false, test);
}

/// The same, or on a device with the short submissions of an interactive program.
pub fn with_submissions(is_interactive: bool, test: impl FnOnce(&mut Pipeline)) {
    let _turn = Turn::wait();
    let Some(gpu) = (if is_interactive { open(true) } else { shared() }) else {
        return;
    };
    HAS_CUBES.store(gpu.info().has_seamless_cubes, Ordering::Relaxed);
    watched(&gpu, || test(&mut Pipeline::on(gpu.clone()).unwrap()));
}

/// The largest error of the shared device's bilinear lookups, relative to the contrast of their
/// texels: GPUs weigh texels by some 8 bits (0.005 on an H200), lavapipe in f32. Measured on the
/// background of a map with single white texels.
pub fn filter_error() -> f64 {
    static ERROR: OnceLock<f64> = OnceLock::new();
    let dots = RgbImage::from_fn(16, 8, |x, y| {
        [f32::from(u8::from(x % 3 == 0 && y % 3 == 0)); 3]
    });
    let environment = Arc::new(Environment::from_image("dots", dots));
    let size = [64, 48];
    let plain = request(
        &environment,
        lobe_sphere(0.5),
        CameraKind::Perspective,
        size,
    );
    let own = RenderRequest {
        background: true,
        ..plain.shaded(|s| s.method = Method::listed("none"))
    };
    with_pipeline(|pipeline| {
        ERROR.get_or_init(|| {
            let frame = pipeline.render(&own).unwrap();
            let pixels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
            let off = pixels
                .filter(|(x, y)| frame.mask.get(*x, *y) == 0.0)
                .map(|(x, y)| {
                    let (_, direction) = own.camera.ray(x, y, size);
                    (f64::from(frame.radiance.get(x, y)[0]) - environment.radiance(direction).x)
                        .abs()
                });
            off.fold(0.0, f64::max)
        });
    });
    let error = ERROR.get().copied().unwrap_or(0.0);
    assert!(error < 1.0 / 128.0, "weights of fewer than 7 bits: {error}");
    error
}

/// Inputs and outputs of a probe shader: vec4s per item.
pub struct Probe<'a> {
    /// Permutation, `probe/x.comp[:model]`.
    pub shader: &'a str,
    /// Specialization constants.
    pub constants: &'a [u32],
    pub inputs: usize,
    pub outputs: usize,
    /// Bindings after inputs and outputs.
    pub rest: &'a [Bind<'a>],
}

impl Default for Probe<'_> {
    fn default() -> Self {
        Self {
            shader: "",
            constants: &[],
            inputs: 1,
            outputs: 1,
            rest: &[],
        }
    }
}

impl Probe<'_> {
    /// The outputs of every item. The output buffer starts as NaN, so an item that the shader skips
    /// cannot pass.
    pub fn run(&self, gpu: &Gpu, inputs: &[[f32; 4]]) -> Vec<Vec<[f64; 4]>> {
        assert_eq!(
            inputs.len() % self.inputs,
            0,
            "{}: inputs an item",
            self.shader
        );
        let count = inputs.len() / self.inputs;
        let input = gpu.buffer_from("probe inputs", inputs).unwrap();
        let output = gpu
            .buffer("probe outputs", (16 * count * self.outputs) as u64)
            .unwrap();
        let push = ProbeParams {
            count: count as u32,
        }
        .to_bytes();
        let binds = [&[Bind::Read(&input), Bind::Write(&output)], self.rest].concat();
        let mut recorder = gpu.record(self.shader).unwrap();
        recorder.fill(&output, POISON);
        let groups = [(count as u32).div_ceil(GROUP_LINEAR), 1, 1];
        recorder
            .dispatch(self.shader, self.constants, &binds, &push, groups)
            .unwrap();
        recorder.submit().unwrap();
        let texels: Vec<[f32; 4]> = gpu.read_buffer(&output).unwrap();
        let wide = |texel: &[f32; 4]| texel.map(f64::from);
        texels
            .chunks_exact(self.outputs)
            .map(|item| item.iter().map(wide).collect())
            .collect()
    }
}

pub fn xyz(v: [f64; 4]) -> DVec3 {
    DVec3::new(v[0], v[1], v[2])
}

/// A probe's input: a vector and one more number.
pub fn vec4(v: DVec3, w: f64) -> [f32; 4] {
    v.extend(w).as_vec4().to_array()
}

/// The f64 value of the f32 that a probe gets.
pub fn rounded(x: f64) -> f64 {
    f64::from(x as f32)
}

/// The f64 value of the f32 vector that a probe gets.
pub fn rounded3(v: DVec3) -> DVec3 {
    v.as_vec3().as_dvec3()
}

/// `tests/golden/env_analytic.exr`: a smooth sky with a Gaussian sun, 512 x 256.
pub fn golden_environment() -> Arc<Environment> {
    let image = exr::read(Path::new("tests/golden/env_analytic.exr"))
        .unwrap()
        .rgb;
    Arc::new(Environment::from_image("golden", image))
}

pub fn constant_environment(radiance: [f32; 3]) -> Arc<Environment> {
    Arc::new(Environment::from_image(
        "constant",
        RgbImage::filled(64, 32, radiance),
    ))
}

pub fn scene(name: &str, materials: MaterialOverride) -> Scene {
    Scene::load(name, Path::new(".")).unwrap().apply(&materials)
}

/// The unit sphere, F = 1 and no diffuse albedo: the pure lobe.
pub fn lobe_sphere(alpha: f64) -> Scene {
    let black = Some([0.0; 3]);
    scene(
        "sphere",
        MaterialOverride {
            alpha: Some(alpha as f32),
            f0: Some([1.0; 3]),
            albedo: black,
            ..MaterialOverride::default()
        },
    )
}

/// `request` with four seeds and a quarter of the reference's samples each, as one frame. Four
/// scrambles of one seed know a pixel's error with three degrees of freedom, so one pixel in a
/// hundred is off by six standard errors; with twelve degrees it is one in 16,000.
pub fn render_by_seeds(pipeline: &mut Pipeline, request: &RenderRequest) -> Frame {
    if !request.has_reference_term() {
        return pipeline.render(request).unwrap();
    }
    let frames: Vec<Frame> = (0..4)
        .map(|k| {
            let (seed, reference_samples) = (request.seed + k, request.reference_samples / 4);
            pipeline
                .render(&RenderRequest {
                    seed,
                    reference_samples,
                    ..request.clone()
                })
                .unwrap()
        })
        .collect();
    let mean = |of: &dyn Fn(&Frame, usize, usize) -> f32| {
        let image = &frames[0].radiance;
        let values = (0..image.data.len())
            .map(|i| {
                std::array::from_fn(|c| {
                    frames.iter().map(|frame| of(frame, i, c)).sum::<f32>() / 4.0
                })
            })
            .collect();
        RgbImage::new(image.width, image.height, values)
    };
    let radiance = mean(&|frame, i, c| frame.radiance.data[i][c]);
    let squares = mean(&|frame, i, c| frame.standard_error.as_ref().unwrap().data[i][c].powi(2));
    let standard_error = Some(squares.map(|square| square.map(|x| (x / 4.0).sqrt())));
    Frame {
        radiance,
        standard_error,
        ..frames[0].clone()
    }
}

/// A request for `scene` under `environment`: GGX, split sum, no diffuse term.
pub fn request(
    environment: &Arc<Environment>,
    scene: Scene,
    kind: CameraKind,
    size: [u32; 2],
) -> RenderRequest {
    RenderRequest::plain(environment.clone(), scene, kind, size)
        .shaded(|s| s.precompute = usual_tables())
}

pub fn read_level(gpu: &Gpu, image: &Image, mip: u32) -> Pixels<DVec3> {
    let [width, height] = image.mip_size(mip);
    let texels = gpu.read_image(image, mip).unwrap();
    Pixels::new(
        width,
        height,
        texels
            .iter()
            .map(|&texel| xyz(texel.map(f64::from)))
            .collect(),
    )
}

pub fn poisoned_buffer(gpu: &Gpu, name: &str, size: u64) -> Buffer {
    let buffer = gpu.buffer(name, size).unwrap();
    poison(gpu, &buffer);
    buffer
}

pub fn poison(gpu: &Gpu, buffer: &Buffer) {
    let mut recorder = gpu.record("poison").unwrap();
    recorder.fill(buffer, POISON);
    recorder.submit().unwrap();
}

/// Fills every level of an image with NaNs.
pub fn poison_image(gpu: &Gpu, image: &Image) {
    for mip in 0..image.mip_count() {
        let [width, height] = image.mip_size(mip);
        let texels =
            vec![[f32::from_bits(POISON); 4]; (width * height * image.face_count()) as usize];
        gpu.write_image(image, mip, &texels).unwrap();
    }
}
