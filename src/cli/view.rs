//! `splitsum view`.

use super::Failure;
use super::flags::{AxisFlags, ViewFlags};
use super::shared::{load_file_method, scene};
use clap::Args;
use splitsum::base::names::Listed;
use splitsum::experiment::axis::{
    ALPHA, AXES, AxisId, DFG_TABLE, ENVIRONMENT, METALLIC, METHOD, PREFILTERED, Point, REFERENCE,
    SAMPLES, SCENE, SIZE,
};
use splitsum::experiment::value::Value;
use splitsum::instrument::pipeline::Options;
use splitsum::instrument::scene::{is_design, scene_extensions};
use splitsum::instrument::shade::FILE_PREFIX;
use splitsum::instrument::shade::reference_pass::pair_count;
use splitsum::view::{HOME, Paint, Picture, State, WindowOptions, Windowed, has_materials, open};
use std::path::PathBuf;

/// Open a window with two methods side by side, and a reference that refines.
#[derive(Args, Debug)]
#[command(
    allow_negative_numbers = true,
    after_help = after_help(),
    mut_arg("camera", |arg| arg.default_value("perspective")),
    mut_arg("background", |arg| arg.hide(true)),
)]
pub struct Arguments {
    /// Save states in DIR.
    #[arg(long, value_name = "DIR", default_value = ".")]
    out: PathBuf,
    /// Leave the environment out of the picture.
    #[arg(long)]
    no_background: bool,
    /// Choose the method of the right half.
    #[arg(
        long,
        value_name = "NAME",
        value_parser = |text: &str| AXES[METHOD].kind.parse_text(text),
    )]
    right: Option<Value>,
    /// Stop the reference at N samples per pixel [default: 4096].
    #[arg(long, value_name = "N", value_parser = parse_samples)]
    reference_samples: Option<u32>,
    /// Use the validation layer; its messages make the exit code 1.
    #[arg(long, hide = true)]
    validation: bool,
    /// Paint the window by a swapchain of the device or on the CPU: auto, swapchain, cpu.
    #[arg(
        long,
        value_name = "HOW",
        default_value = Paint::Auto.name(),
        value_parser = |name: &str| Paint::parse(name).copied(),
    )]
    paint: Paint,
    #[command(flatten)]
    view: ViewFlags,
    #[command(flatten)]
    axes: AxisFlags,
}

fn after_help() -> String {
    let [method, scene, environment] = FIRST.map(|(_, name)| name);
    let pictures = Picture::names();
    format!(
        "Defaults here: --method {method}, --right {REFERENCE}, --scene {scene}, --environment \
         {environment}, a metal of roughness 0.25 (unless \
        the model has its own materials), the size of the window. The window uses the program's \
        own tables.\n\n\
        Pictures (toolbar): {}, a half for each method; errors are against the reference.\n\n\
        Mouse: drag the line to compare the halves, drag elsewhere to turn the camera, shift+drag \
        to turn the light, wheel to zoom. Keys: \
        space shows the other half; d the left half alone; e error; s signed error; p linear \
        values under the pointer; \
        [ ] exposure; + - 0 and arrows the camera; shift+arrows the light; 1 to 9 the left method; \
        f the whole screen; ctrl+S saves.\n\n\
        Open an environment (.hdr, .exr, ...) or a model ({}) with the buttons Open, or drop it on the \
        window. Saving makes a folder view-N \
        with the picture, linear images, and the `view` and `render` commands.\n\n\
        Exit codes: 2 no display or bad input; 75 the device or the window was lost.\n\n\
        Examples:\n  splitsum view --environment studio.hdr --scene teapot.obj\n  sh \
        view-1/view.sh",
        pictures.join(", "),
        scene_extensions(),
    )
}

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let state = state(arguments);
    load_file_method(state.point[METHOD].text())?;
    load_file_method(state.right.text())?;
    if let Some(axis) = [PREFILTERED, DFG_TABLE]
        .into_iter()
        .find(|axis| state.point[*axis].to_string().starts_with(FILE_PREFIX))
    {
        let name = AXES[axis].name;
        return Err(Failure::input(format!(
            "--{name}: the window uses its own tables; `splitsum render` takes files"
        )));
    }
    // Bad input is reported before a window opens.
    let settings = state.point.settings();
    arguments.view.inputs.environment(&settings.environment)?;
    let scene = scene(&settings.scene).map_err(Failure::input)?;
    super::warn_of_input(&scene.name, &scene.warnings);
    arguments.view.check(&scene)?;
    if !arguments.out.is_dir() {
        return Err(Failure::input(format!(
            "--out: there is no folder {}",
            arguments.out.display()
        )));
    }
    let load = arguments.view.inputs.options();
    let options = Options {
        device: arguments.view.device.choice(),
        validation: arguments.validation,
        ..Options::default()
    };
    #[cfg(target_os = "linux")]
    if let Some(why) = missing_library() {
        return Err(Failure::input(why));
    }
    let options = WindowOptions {
        device: options,
        load,
        out: arguments.out.clone(),
        paint: arguments.paint,
        warn: |line| super::warn("view", line),
    };
    match open(state, options) {
        Windowed::Closed => Ok(()),
        Windowed::NoDisplay(why) => Err(Failure::input(why)),
        Windowed::Lost(why) => Err(Failure::passing(why)),
        Windowed::Failed(why) => Err(Failure::failed(why)),
    }
}

/// Names a library that winit loads and panics without.
#[cfg(target_os = "linux")]
fn missing_library() -> Option<String> {
    let is_set = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let is_x11 = is_set("DISPLAY") && !is_set("WAYLAND_DISPLAY") && !is_set("WAYLAND_SOCKET");
    let (library, package) = if xkbcommon_dl::xkbcommon_option().is_none() {
        ("libxkbcommon", "libxkbcommon0")
    } else if is_x11 && xkbcommon_dl::x11::xkbcommon_x11_option().is_none() {
        ("libxkbcommon-x11", "libxkbcommon-x11-0")
    } else {
        return None;
    };
    Some(format!(
        "the window needs the library {library}: install the package {package} (its name on Debian \
         and Ubuntu)"
    ))
}

fn parse_samples(text: &str) -> Result<u32, String> {
    let count = AXES[SAMPLES].kind.parse_text(text)?.count();
    pair_count(count)
        .map(|_| count)
        .map_err(|fault| fault.to_string())
}

fn state(arguments: &Arguments) -> State {
    let is_given = |axis: AxisId| arguments.axes.get(axis).is_some();
    let mut point: Point = arguments.axes.point();
    let mut firsts = FIRST.to_vec();
    if !is_given(SCENE) || !has_materials(point[SCENE].text()) {
        firsts.extend([(METALLIC, "1"), (ALPHA, "0.0625")]);
    }
    for (axis, text) in firsts.into_iter().filter(|(axis, _)| !is_given(*axis)) {
        point[axis] = AXES[axis].kind.parse_text(text).expect("a valid default");
    }
    let mut view = arguments.view.view();
    view.reference_samples = arguments
        .reference_samples
        .unwrap_or(view.reference_samples);
    if !is_design(point[SCENE].text()) {
        view.background = !arguments.no_background;
        view.orbit = arguments.view.orbit.unwrap_or(HOME);
    }
    let state = State::new(point, view);
    let right = arguments.right.clone().unwrap_or(state.right.clone());
    State {
        right,
        fill: !is_given(SIZE),
        ..state
    }
}

/// The first state: the textbook split sum and the reference, on a metal under a studio.
const FIRST: [(AxisId, &str); 3] = [
    (METHOD, "split-sum"),
    (SCENE, "shader-ball"),
    (ENVIRONMENT, "builtin:studio"),
];
