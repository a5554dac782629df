//! `cargo bench`: what the passes cost in CPU-seconds of this process, so that a software driver's figures can be compared between
//! machines with other loads. On a GPU these are the host's costs only; `splitsum run experiments/timing.toml` times the device.

use splitsum::brdf::{Brdf, MODELS};
use splitsum::environment::{Environment, LoadOptions};
use splitsum::pipeline::{Options, Pipeline, RenderRequest};
use splitsum::pixels::RgbImage;
use splitsum::precompute::PrecomputeSettings;
use splitsum::scene::{Camera, CameraKind, MaterialOverride, Scene};
use splitsum::shade::{diffuse_by_name, method_by_name};
use std::path::Path;
use std::sync::Arc;

/// Clock ticks a second of /proc/self/stat on Linux.
const TICKS: f64 = 100.0;

/// User and system time of this process so far, seconds.
fn cpu_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").expect("the bench reads /proc/self/stat");
    let fields: Vec<&str> = text.rsplit(')').next().unwrap_or("").split_whitespace().collect();
    let ticks = |index: usize| fields[index].parse::<f64>().expect("a count of ticks");
    (ticks(11) + ticks(12)) / TICKS
}

/// CPU-seconds of `work`.
fn cost<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let before = cpu_seconds();
    let result = work();
    (cpu_seconds() - before, result)
}

fn request(brdf: &'static dyn Brdf, method: &str, size: u32, environment_size: [u32; 2]) -> RenderRequest {
    let options = LoadOptions { builtin_size: environment_size, ..LoadOptions::default() };
    let environment = Environment::load("builtin:studio", Path::new("."), &options).expect("a builtin environment");
    let sphere = Scene::load("sphere", Path::new(".")).expect("a builtin scene");
    let lobe = MaterialOverride { alpha: Some(0.2), f0: Some([1.0; 3]), albedo: Some([0.0; 3]), metallic: None };
    let scene = sphere.apply(&lobe);
    let size = [size; 2];
    RenderRequest {
        environment: Arc::new(environment),
        environment_rotation_deg: 0.0,
        environment_scale: 1.0,
        camera: Camera::for_scene(CameraKind::Ortho, &scene, size),
        scene: Arc::new(scene),
        size,
        method: method_by_name(method).expect("a listed method"),
        diffuse: diffuse_by_name("none").expect("a listed method"),
        brdf,
        masking_shadowing: Default::default(),
        samples: 40,
        sequence: &splitsum::math::sequence::SEQUENCES[0],
        point_set: 0,
        reference_samples: 4096,
        reference_error: None,
        lod_bias: 0.0,
        lights: Vec::new(),
        background: false,
        precompute: PrecomputeSettings::default(),
        seed: 1,
    }
}

fn relmse(test: &RgbImage, reference: &RgbImage, mask: &[f32]) -> f64 {
    let hit = test.data.iter().zip(&reference.data).zip(mask).filter(|(_, hit)| **hit > 0.0);
    let squares = hit
        .flat_map(|((t, r), _)| (0..3).map(move |c| f64::from(t[c] - r[c]).powi(2) / (f64::from(r[c]).powi(2) + 1e-2)));
    let (count, sum) = squares.fold((0u32, 0.0), |(count, sum), x| (count + 1, sum + x));
    sum / f64::from(count)
}

fn main() {
    let mut pipeline = match Pipeline::new(Options::default()) {
        Ok(pipeline) => pipeline,
        Err(error) => return println!("skipped: {error}"),
    };
    let device = pipeline.device().clone();
    println!("{} ({}), {}", device.name, device.device_type, device.driver);

    for &brdf in MODELS {
        let request = request(brdf, "sampled", 512, [1024, 512]);
        let mask = pipeline.render(&request).expect("a frame").mask;
        let pixels: f64 = mask.data.iter().map(|&hit| f64::from(hit)).sum();
        const ROUNDS: u32 = 10;
        let mut cost_of = |request: &RenderRequest| {
            pipeline.render(request).expect("compiled pipelines");
            cost(|| pipeline.time(request, 0, ROUNDS).expect("times")).0
        };
        // What is not shading (g-buffer, tone curve, submissions) costs the same without a specular term.
        let nothing = RenderRequest { method: method_by_name("none").expect("a listed method"), ..request.clone() };
        let seconds = cost_of(&request) - cost_of(&nothing);
        let samples = pixels * 40.0 * f64::from(ROUNDS);
        println!(
            "sampled, {}, N = 40, 512x512: {:.1} million samples a CPU-second",
            brdf.name(),
            samples / seconds / 1e6
        );
    }
    for &brdf in MODELS {
        let mut request = request(brdf, "split-sum", 16, [1024, 512]);
        request.precompute.prefilter_size = [1024, 512];
        request.precompute.dfg_size = 256;
        pipeline.time_precompute(&request, 0, 1).expect("compiled pipelines");
        let (seconds, samples) = cost(|| pipeline.time_precompute(&request, 0, 2).expect("times"));
        let ms = |name: &str| samples.passes.iter().find(|(pass, _)| *pass == name).map_or(f64::NAN, |(_, ms)| ms[1]);
        println!(
            "tables, {}: {:.2} CPU-seconds (device time: prefilter of 1024x512, 5 levels, 256 samples {:.0} ms; DFG 256x256 {:.0} ms)",
            brdf.name(),
            seconds / 2.0,
            ms("prefilter"),
            ms("dfg")
        );
    }
    for &brdf in MODELS {
        let mut request = request(brdf, "reference", 128, [512, 256]);
        request.reference_samples = 64;
        pipeline.render(&request).expect("compiled pipelines");
        request.reference_samples = 4096;
        let (seconds, _) = cost(|| pipeline.render(&request).expect("a frame"));
        println!("reference, {}, 128x128 x 4096 samples: {seconds:.2} CPU-seconds", brdf.name());
        request.reference_samples = 65_536;
        request.seed = 2;
        let truth = pipeline.render(&request).expect("a frame");
        request.seed = 1;
        for target in [1e-2f64, 1e-3, 1e-4] {
            request.reference_error = Some(target.sqrt());
            let (seconds, frame) = cost(|| pipeline.render(&request).expect("a frame"));
            let found = relmse(&frame.radiance, &truth.radiance, &truth.mask.data);
            println!("  to relMSE {target:.0e}: {seconds:.2} CPU-seconds, {found:.1e} reached");
        }
    }
}
