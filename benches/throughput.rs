//! `cargo bench`: what the passes cost in CPU-seconds of this process, so that a software driver's
//! figures can be compared between machines with other loads. On a GPU these are the host's costs
//! only; `splitsum run experiments/timing.toml` times the device.
//!
//! `cargo bench --bench throughput -- NAME...` runs only the named sections: `sampled`, `tables`,
//! `reference`, `convergence`; `--record` runs all but the last, and adds a row with a figure of
//! each to benches/record.md.

use splitsum::base::names::Listed;
use splitsum::instrument::brdf::{Brdf, MODELS};
use splitsum::instrument::environment::layout::MapLayout;
use splitsum::instrument::environment::{Environment, LoadOptions};
use splitsum::instrument::metrics::{Comparison, HEADLINE, Metric};
use splitsum::instrument::pipeline::{Frame, Options, Pipeline, RenderRequest};
use splitsum::instrument::precompute::PrefilterBy;
use splitsum::instrument::scene::{CameraKind, MaterialOverride, Scene};
use splitsum::instrument::shade::{Method, Shading};
use splitsum::instrument::tonemap::ToneCurve;
use splitsum::run::provenance::now_utc;
use std::io::Write as _;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;

/// Clock ticks a second of /proc/self/stat on Linux.
const TICKS: f64 = 100.0;
/// Least CPU-seconds that one figure is taken over: fifty ticks.
const SECONDS_MIN: f64 = 0.5;

/// User and system time of every thread of this process so far, seconds.
fn cpu_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").expect("the bench reads /proc/self/stat");
    let fields: Vec<&str> = text
        .rsplit(')')
        .next()
        .unwrap_or("")
        .split_whitespace()
        .collect();
    let ticks = |index: usize| fields[index].parse::<f64>().expect("a count of ticks");
    (ticks(11) + ticks(12)) / TICKS
}

/// CPU-seconds of `work`.
fn cost<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let before = cpu_seconds();
    let result = work();
    (cpu_seconds() - before, result)
}

/// A sphere of albedo 0 and f0 1 under a builtin environment.
fn request(
    brdf: &'static dyn Brdf,
    method: &str,
    alpha: f32,
    size: u32,
    environment: &str,
    environment_size: [u32; 2],
) -> RenderRequest {
    let options = LoadOptions {
        builtin_size: environment_size,
        ..LoadOptions::default()
    };
    let environment =
        Environment::load(environment, Path::new("."), &options).expect("a builtin environment");
    let sphere = Scene::load("sphere", Path::new(".")).expect("a builtin scene");
    let lobe = MaterialOverride {
        alpha: Some(alpha),
        f0: Some([1.0; 3]),
        albedo: Some([0.0; 3]),
        ..MaterialOverride::default()
    };
    RenderRequest {
        shading: Shading {
            method: Method::listed(method),
            brdf,
            samples: 40,
            ..Shading::default()
        },
        reference_samples: 4096,
        ..RenderRequest::plain(
            Arc::new(environment),
            sphere.apply(&lobe),
            CameraKind::Ortho,
            [size; 2],
        )
    }
}

/// CPU-seconds of the specular pass of one frame. What is not shading (g-buffer, tone curve, their
/// submissions) costs the same without a specular term and is taken off. Compiling pipelines,
/// making tables and reading images back are not counted.
fn shading_seconds(pipeline: &mut Pipeline, request: &RenderRequest) -> f64 {
    let nothing = request.shaded(|s| s.method = Method::listed("none"));
    let mut seconds = |request: &RenderRequest| {
        let mut rounds = 1;
        pipeline.time(request, 0, 1).expect("compiled pipelines");
        loop {
            let (seconds, _) = cost(|| pipeline.time(request, 0, rounds).expect("times"));
            if seconds >= SECONDS_MIN {
                return seconds / f64::from(rounds);
            }
            rounds = (f64::from(rounds)
                * (1.2 * SECONDS_MIN / seconds.max(1.0 / TICKS)).clamp(1.5, 50.0))
                as u32;
        }
    };
    seconds(request) - seconds(&nothing)
}

/// The first of some figures, all of which are taken.
fn first(figures: impl Iterator<Item = f64>) -> Option<f64> {
    figures.reduce(|first, _| first)
}

/// The metric `relmse` under the light of a request.
fn relmse(test: &Frame, truth: &Frame, request: &RenderRequest) -> f64 {
    let curve = ToneCurve::default();
    let comparison = Comparison::new(
        &test.radiance,
        &truth.radiance,
        &truth.mask,
        curve,
        request.epsilon(),
    );
    comparison
        .expect("images of one size")
        .evaluate(&[Metric::listed(HEADLINE)])[0]
        .1
}

/// Million samples a CPU-second, GGX.
fn sampled(pipeline: &mut Pipeline) -> Option<f64> {
    first(MODELS.iter().map(|&brdf| {
        let request = request(brdf, "sampled", 0.2, 512, "builtin:studio", [1024, 512]);
        let mask = pipeline.render(&request).expect("a frame").mask;
        let pixels: f64 = mask.data.iter().map(|&hit| f64::from(hit)).sum();
        let speed = pixels * 40.0 / shading_seconds(pipeline, &request) / 1e6;
        println!(
            "sampled, {}, N = 40, 512x512: {speed:.1} million samples a CPU-second",
            brdf.name()
        );
        speed
    }))
}

/// CPU-seconds of the tables of GGX by the first way to prefilter.
fn tables(pipeline: &mut Pipeline) -> Option<f64> {
    let ways = MODELS
        .iter()
        .flat_map(|brdf| PrefilterBy::all().map(move |by| (brdf, by)));
    first(ways.map(|(&brdf, prefilter)| {
        let mut request = request(brdf, "split-sum", 0.2, 16, "builtin:studio", [1024, 512]);
        request.shading.precompute.layout = MapLayout::listed("equirect");
        request.shading.precompute.prefilter_size = [1024, 512];
        request.shading.precompute.prefilter = *prefilter;
        request.shading.precompute.dfg_size = 256;
        pipeline
            .time_precompute(&request, 0, 1)
            .expect("compiled pipelines");
        let (seconds, samples) = cost(|| pipeline.time_precompute(&request, 0, 2).expect("times"));
        // A pass for each level.
        let samples_of = |name: &str| {
            samples
                .passes
                .iter()
                .filter(|(pass, _)| pass.starts_with(name))
                .collect::<Vec<_>>()
        };
        let ms = |name: &str| {
            assert!(
                !samples_of(name).is_empty(),
                "no pass is called {name}: {:?}",
                samples.passes
            );
            samples_of(name).iter().map(|(_, ms)| ms[1]).sum::<f64>()
        };
        println!(
            "tables, {}, {prefilter:?}: {:.3} CPU-seconds (pass times: prefilter of 1024x512, 5 \
             levels {:.0} ms; DFG 256x256 {:.0} ms)",
            brdf.name(),
            seconds / 2.0,
            ms("prefilter"),
            ms("dfg")
        );
        seconds / 2.0
    }))
}

/// CPU-seconds of GGX.
fn reference(pipeline: &mut Pipeline) -> Option<f64> {
    first(MODELS.iter().map(|&brdf| {
        let request = request(brdf, "reference", 0.2, 128, "builtin:studio", [512, 256]);
        let seconds = shading_seconds(pipeline, &request);
        println!(
            "reference, {}, 128x128 x 4096 samples: {seconds:.2} CPU-seconds",
            brdf.name()
        );
        seconds
    }))
}

/// CPU-seconds to a relative mean square error: both are measured for counts that double, against
/// many more samples with other points, and interpolated. The last column stops by itself, by its
/// own estimate of the error, and pays for finding its count.
fn convergence(pipeline: &mut Pipeline) -> Option<f64> {
    const TARGETS: [f64; 3] = [1e-2, 1e-3, 1e-4];
    const COUNT_MAX: u32 = 8192;
    println!(
        "reference, GGX, 128x128, CPU-seconds to relMSE {TARGETS:?} (samples a pixel); stopped by \
         itself at 1e-3"
    );
    for environment in ["builtin:studio", "builtin:sky", "builtin:checker"] {
        for alpha in [0.05, 0.2, 0.5] {
            let base = request(MODELS[0], "reference", alpha, 128, environment, [512, 256]);
            let request_of = |samples, seed| RenderRequest {
                reference_samples: samples,
                seed,
                ..base.clone()
            };
            let mut render =
                |request: &RenderRequest| -> Frame { pipeline.render(request).expect("a frame") };
            let truth = render(&request_of(4 * COUNT_MAX, 2));
            let error = |frame: &Frame| relmse(frame, &truth, &base);
            let counts: Vec<u32> = (5..)
                .map(|k| 1 << k)
                .take_while(|count| *count <= COUNT_MAX)
                .collect();
            let errors: Vec<f64> = counts
                .iter()
                .map(|&count| error(&render(&request_of(count, 1))))
                .collect();
            let mut cells = Vec::new();
            for target in TARGETS {
                let Some(next) = errors.iter().position(|error| *error <= target) else {
                    cells.push(format!("> {COUNT_MAX} samples"));
                    continue;
                };
                let count = if next == 0 {
                    f64::from(counts[0])
                } else {
                    let slope = (errors[next] / errors[next - 1]).log2();
                    f64::from(counts[next - 1])
                        * ((target / errors[next - 1]).log2() / slope).exp2()
                };
                // The reference draws whole scrambles.
                let drawn = (count / 8.0).round().max(1.0) as u32 * 8;
                let seconds = shading_seconds(pipeline, &request_of(drawn, 1));
                let least = if next == 0 { "< " } else { "" };
                cells.push(format!("{least}{seconds:.3} ({drawn})"));
            }
            let stopping = RenderRequest {
                reference_error: Some(TARGETS[1].sqrt()),
                ..request_of(1 << 16, 1)
            };
            let frame = pipeline.render(&stopping).expect("a frame");
            let found = relmse(&frame, &truth, &base);
            let seconds = shading_seconds(pipeline, &stopping);
            println!(
                "{environment:16} alpha {alpha:<5} {:45} {seconds:.3} at {found:.1e}",
                cells.join("  ")
            );
        }
    }
    None
}

/// What one section of the bench runs. Returns the figure that is kept, if any.
type Section = fn(&mut Pipeline) -> Option<f64>;

/// Adds a row to benches/record.md: when, of which commit, on what, and the figure of each section.
fn record(device: &str, figures: &[f64]) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let git = Command::new("git")
        .arg("-C")
        .arg(folder)
        .args(["describe", "--always", "--dirty", "--abbrev=12"])
        .output();
    let commit = git
        .map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned())
        .unwrap_or_default();
    let cells: Vec<String> = figures
        .iter()
        .map(|figure| format!("{figure:.3}"))
        .collect();
    let row = format!(
        "| {} | {commit} | {device} | {} |\n",
        &now_utc()[..10],
        cells.join(" | ")
    );
    let mut file = std::fs::OpenOptions::new()
        .append(true)
        .open(folder.join("benches/record.md"))
        .expect("benches/record.md");
    file.write_all(row.as_bytes()).expect("a place to write");
    print!("{row}");
}

fn main() {
    let mut pipeline = match Pipeline::new(Options::default()) {
        Ok(pipeline) => pipeline,
        Err(error) => return println!("skipped: {error}"),
    };
    let device = pipeline.device().clone();
    println!(
        "{} ({}), {}",
        device.name, device.device_type, device.driver
    );
    let sections: [(&str, Section); 4] = [
        ("sampled", sampled),
        ("tables", tables),
        ("reference", reference),
        ("convergence", convergence),
    ];
    // Cargo itself adds `--bench`.
    let arguments: Vec<String> = std::env::args()
        .skip(1)
        .filter(|argument| argument != "--bench")
        .collect();
    let is_kept = arguments.iter().any(|argument| argument == "--record");
    let wanted = |name: &str| {
        is_kept && name != "convergence"
            || arguments.is_empty()
            || arguments.iter().any(|wanted| wanted == name)
    };
    let run = sections.iter().filter(|(name, _)| wanted(name));
    let figures: Vec<f64> = run
        .filter_map(|(_, section)| section(&mut pipeline))
        .collect();
    if is_kept {
        record(&device.name, &figures);
    }
}
