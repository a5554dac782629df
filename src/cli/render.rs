//! `splitsum render`: one image.

use super::flags::{AxisFlag, AxisFlags, ViewFlags};
use super::shared::{check_out, load_file_method, scene};
use super::{Failure, log, print, progress};
use clap::Args;
use splitsum::bake::given;
use splitsum::base::pixels::{exr, png};
use splitsum::experiment::axis::{
    AXES, BLUR, FRAMES, Layer, METHOD, Point, Reference, SAMPLES, Settings, View, is_blurred,
    motion_fault,
};
use splitsum::experiment::value::{Kind, Range, Value};
use splitsum::instrument::environment::Environment;
use splitsum::instrument::pipeline::{Frame, Pipeline, PipelineError, RenderRequest, Selection};
use splitsum::instrument::scene::Scene;
use splitsum::instrument::shade::reference_pass::pair_count;
use splitsum::instrument::tonemap::ToneCurve;
use splitsum::run::{RenderFault, write_radiance};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Render one image: linear EXR (A is the mask) or tone-mapped PNG.
#[derive(Args, Debug)]
#[command(
    allow_negative_numbers = true,
    after_help = "A reference draws 4096 samples per pixel by default.\n\n\
    Examples:\n  splitsum render --method split-sum --alpha 0.25 --f0 1,1,1 --albedo 0,0,0 --out \
    split-sum.exr\n  \
    splitsum render --method reference --samples 4096 --alpha 0.25 --f0 1,1,1 --albedo 0,0,0 --out \
    reference.exr\n  \
    splitsum render --environment studio.hdr --scene teapot.obj --camera perspective --background \
    --size 800x600 --out teapot.png\n  \
    splitsum render --environment studio.hdr --method split-sum --show prefiltered --out levels.png\n\n\
    --show writes what the image is made of: position, normal, albedo, f0, alpha, metallic, \
    occlusion (by pixel), irradiance (over pi), prefiltered (every level; prefiltered-2: one) and \
    dfg (A and B; n.v to the right, roughness downwards). An EXR has the values; A is 0 where there \
    is none. A PNG has positions within their extent, normals as 0.5 n + 0.5, albedo and F0 as \
    sRGB, radiance by the tone curve, and the rest from 0 to 1, linear."
)]
pub struct Arguments {
    /// Write the image to FILE, .exr or .png.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Stop the reference early, at this relative standard error.
    #[arg(
        long,
        value_name = "E",
        value_parser = |text: &str| Kind::Number(Range::above(0.0, 1.0)).parse_text(text),
    )]
    relative_error: Option<Value>,
    /// Write what lies between the scene and the image: position, normal, albedo, f0, alpha,
    /// metallic, occlusion, irradiance, prefiltered (or one level: prefiltered-2) or dfg.
    #[arg(long, value_name = "NAME", value_parser = Selection::parse)]
    show: Option<Selection>,
    /// Antialias edges; pixels on them leave the mask.
    #[arg(long)]
    antialias: bool,
    #[command(flatten)]
    view: ViewFlags,
    #[command(flatten)]
    axes: AxisFlags,
}

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    check_out("--out", &arguments.out, &["exr", "png"], inputs(arguments))?;
    let is_linear = arguments
        .out
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("exr"));
    let point = point(arguments)?;
    check_used(arguments, &point, is_linear)?;
    let settings = point.settings();
    settings
        .shading
        .precompute
        .validate()
        .map_err(Failure::input)?;
    let (environment, scene) = loaded(arguments, &settings)?;
    check_lights(arguments, &scene)?;
    let view = View {
        reference_error: arguments.relative_error.as_ref().map(Value::number),
        reference_samples: reference_samples(arguments),
        antialias: arguments.antialias,
        ..arguments.view.view()
    };
    let curve = settings.curve;
    let given =
        given::load(&settings.prefiltered, &settings.dfg, Path::new("")).map_err(Failure::input)?;
    let request = settings.request(&environment, &scene, &view, given);
    if let Some(fault) = arguments.show.and_then(|show| show.fault(&request)) {
        return Err(Failure::input(format!("--show: {fault}")));
    }
    progress::doing("rendering");
    let mut pipeline = arguments.view.device.open().map_err(Failure::opening)?;
    let out = Output {
        path: &arguments.out,
        is_linear,
        curve,
    };
    match arguments.show {
        Some(selection) => out.intermediate(&mut pipeline, &request, selection)?,
        None => out.image(&mut pipeline, &request)?,
    }
    print(&format!("{}\n", arguments.out.display()))
}

/// A file to write.
struct Output<'a> {
    path: &'a Path,
    /// An EXR; else a PNG.
    is_linear: bool,
    curve: ToneCurve,
}

impl Output<'_> {
    fn image(&self, pipeline: &mut Pipeline, request: &RenderRequest) -> Result<(), Failure> {
        let frame = pipeline.render(request).map_err(fault)?;
        log_convergence(&frame);
        if self.is_linear {
            write_radiance(self.path, &frame).map_err(Failure::failed)
        } else {
            let (picture, _) = pipeline
                .tonemap(&frame.radiance, self.curve)
                .map_err(fault)?;
            png::write_rgb8(self.path, &picture).map_err(Failure::failed)
        }
    }

    fn intermediate(
        &self,
        pipeline: &mut Pipeline,
        request: &RenderRequest,
        selection: Selection,
    ) -> Result<(), Failure> {
        let image = pipeline.intermediate(request, selection).map_err(fault)?;
        if self.is_linear {
            exr::write_rgba(self.path, &image.values, &image.mask, &[]).map_err(Failure::failed)
        } else {
            let picture = image.picture(pipeline, self.curve, [0; 3]).map_err(fault)?;
            png::write_rgb8(self.path, &picture).map_err(Failure::failed)
        }
    }
}

fn fault(error: PipelineError) -> Failure {
    Failure::rendering(RenderFault::from(error))
}

/// Loads environment and scene, with the faults of both, and prints their warnings.
fn loaded(
    arguments: &Arguments,
    settings: &Settings,
) -> Result<(Arc<Environment>, Scene), Failure> {
    let options = arguments.view.inputs.options();
    let environment = Environment::load(&settings.environment, Path::new(""), &options);
    let (environment, scene) = match (environment, scene(&settings.scene)) {
        (Ok(environment), Ok(scene)) => (environment, scene),
        (environment, scene) => {
            let faults = [environment.err().map(|e| e.to_string()), scene.err()];
            let faults: Vec<String> = faults.into_iter().flatten().collect();
            return Err(Failure::input(faults.join("\n")));
        }
    };
    arguments.view.check(&scene)?;
    super::warn_of_input(&environment.name, &environment.warnings);
    super::warn_of_input(&scene.name, &scene.warnings);
    Ok((Arc::new(environment), scene))
}

/// Refuses flags that change lights if there are none.
fn check_lights(arguments: &Arguments, scene: &Scene) -> Result<(), Failure> {
    if scene.has_lights() || !arguments.view.lights.is_empty() {
        return Ok(());
    }
    let mut axes = arguments.axes.iter();
    let idle = axes.find(|given| Layer::Lights.has(given.axis));
    match idle {
        Some(AxisFlag { flag, .. }) => Err(Failure::input(format!(
            "--{flag}: has no effect without --light or a scene with lights; leave it out"
        ))),
        None => Ok(()),
    }
}

/// Prints where each reference term of an image stopped.
fn log_convergence(frame: &Frame) {
    for term in &frame.convergences {
        let met = if term.is_met {
            ""
        } else {
            ", above --relative-error"
        };
        log(&format!(
            "{}: {} samples per pixel, relative standard error {:.3e}{met}",
            term.term, term.sample_count, term.relative_error
        ));
    }
}

/// Returns the files that the command reads.
fn inputs(arguments: &Arguments) -> impl Iterator<Item = PathBuf> {
    arguments.axes.iter().filter_map(|given| {
        let text = given.value.to_string();
        AXES[given.axis].kind.path_in(&text).map(PathBuf::from)
    })
}

/// Builds the point and compiles a method in a file. The reference has its own default sample
/// count.
fn point(arguments: &Arguments) -> Result<Point, Failure> {
    let mut point = arguments.axes.point();
    load_file_method(point[METHOD].text())?;
    if arguments.axes.get(SAMPLES).is_none() && point.method().is_integrated() {
        point[SAMPLES] = Value::Count(Reference::default().samples);
    }
    Ok(point)
}

/// Refuses flags without effect.
fn check_used(arguments: &Arguments, point: &Point, is_linear: bool) -> Result<(), Failure> {
    let collapsed = point.collapsed();
    let method = point.method().name;
    let diffuse = point.diffuse().name;
    let has_reference_term = point.method().is_integrated() || point.diffuse().is_integrated();
    let mut faults = Vec::new();
    for AxisFlag { flag, axis, .. } in arguments.axes.iter() {
        let is_reference_count = *axis == SAMPLES && has_reference_term;
        if collapsed[*axis] == Value::Unset && !is_reference_count {
            let without = format!("with method {method} and diffuse {diffuse}");
            let is_absent =
                |value: &Value| [Value::Unset, Value::Count(1)].contains(value) || value.is_zero();
            let why = match AXES[*axis].layer {
                Some(Layer::Frames) if is_absent(&collapsed[FRAMES]) => {
                    "without --frames of at least 2".to_owned()
                }
                Some(Layer::Frames) => {
                    "with the other options of frames (docs/frames.md)".to_owned()
                }
                Some(layer) if is_absent(&collapsed[layer.axis()]) => {
                    format!("without --{}", layer.name().replace('_', "-"))
                }
                _ if ["pixel_points", "sequence"].contains(&AXES[*axis].name)
                    && !is_absent(&collapsed[FRAMES]) =>
                {
                    "with --frames and these --frame-points".to_owned()
                }
                _ => without,
            };
            faults.push(format!("--{flag}: has no effect {why}; leave it out"));
        } else if !AXES[*axis].changes_radiance() && is_linear {
            faults.push(format!(
                "--{flag}: has no effect on an .exr, which is linear; expected --out FILE.png"
            ));
        }
    }
    if arguments.relative_error.is_some() && !has_reference_term {
        faults.push(format!(
            "--relative-error: has no effect: method {method} with diffuse {diffuse} has no \
             reference term"
        ));
    }
    faults.extend(
        motion_fault(&collapsed, arguments.antialias).map(|fault| format!("--motion: {fault}")),
    );
    if has_reference_term && let Err(error) = pair_count(reference_samples(arguments)) {
        faults.push(format!("--samples: {error}"));
    }
    if faults.is_empty() && is_blurred(&collapsed) {
        super::log(&format!("warning: {BLUR}"));
    }
    if faults.is_empty() {
        Ok(())
    } else {
        Err(Failure::input(faults.join("\n")))
    }
}

/// Returns the reference's samples per pixel, whichever term it computes.
fn reference_samples(arguments: &Arguments) -> u32 {
    arguments
        .axes
        .get(SAMPLES)
        .map_or(Reference::default().samples, Value::count)
}
