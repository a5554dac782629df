//! Checks of values together: combinations, sizes, exclusions.

use super::axis::{
    ALBEDO, ALPHA, ANISOTROPY, AXES, AxisId, COAT, COMPENSATION, DFG_TABLE, F0, FRAMES, FRESNEL,
    Layer, METALLIC, METALLIC_MIX, METHOD, MOTION, Named, PREFILTER_SIZE, PREFILTERED, Point,
    SAMPLES, SCENE, SHEEN_COLOR, SIZE, motion_fault,
};
use super::config::{Condition, Config, Located, Sweep, UNSCORED};
use super::fault::{Faults, Location};
use super::inputs::Inputs;
use super::value::Value;
use crate::base::names::{Listed, expected, suggestion};
use crate::instrument::pipeline::{BUFFER_BYTES_MAX, image_buffer_bytes};
use crate::instrument::precompute::given::OWN;
use crate::instrument::precompute::prefilter::harmonic;
use crate::instrument::scene::{Light, is_design};
use crate::instrument::shade::Method;
use crate::instrument::shade::reference_pass::pair_count;
use indexmap::IndexSet;

/// Reports values that are valid alone but not together.
pub fn check_combinations(config: &Config, faults: &mut Faults) {
    for point in config
        .combinations()
        .filter(|point| config.exclusion_of(point).is_none())
    {
        let judge = point.reference(&config.reference);
        let point = point.collapsed();
        check_reference_counts(config, &point, &judge, faults);
        check_ladder(config, &point, faults);
        let shading = point.settings().shading;
        if has_layer(&point, ANISOTROPY)
            && let Some(what) = shading
                .widths
                .fault(shading.brdf, shading.masking_shadowing)
        {
            faults.add(
                &config.location_of(ANISOTROPY, &point),
                format!("anisotropy: {what}"),
            );
        }
        if let Some(what) = shading.metallic_mix.fault(shading.compensation) {
            faults.add(
                &config.location_of(METALLIC_MIX, &point),
                format!(
                    "metallic_mix: brdf does not support {what}; expected compensation = \"none\""
                ),
            );
        }
        if let Some(fault) = motion_fault(&point, config.antialias) {
            faults.add(
                &config.location_of(MOTION, &point),
                format!("motion: {fault}"),
            );
        }
        if let Err(error) = point
            .method()
            .tables(point.settings().shading.precompute)
            .validate()
        {
            let partners = AxisId::find(error.field)
                .into_iter()
                .chain([PREFILTER_SIZE]);
            let location = partners
                .map(|axis| config.location_of(axis, &point))
                .find(|location| *location != Location::Default);
            faults.add(&location.unwrap_or(Location::Default), error.to_string());
        }
    }
}

/// Reports the first axis of frames if no method can have several.
pub fn check_frames(config: &Config, faults: &mut Faults) {
    // Methods in files are not loaded yet.
    let may_sample =
        |method: &Value| Method::by_name(method.text()).is_none_or(|method| method.uses_point_set);
    if config.values(METHOD).any(|(method, _)| may_sample(method)) {
        return;
    }
    let first = config.axes.iter().find(|sweep| sweeps_frames(sweep));
    if let Some(sweep) = first {
        let text = "no method of the experiment samples, and an image without samples is its own \
                    history; add a sampling method";
        faults.add(
            &sweep.values[0].location,
            format!("{}: {text}", AXES[sweep.axis].name),
        );
    }
}

/// Whether an axis of frames has a value other than its default.
fn sweeps_frames(sweep: &Sweep) -> bool {
    let axis = &AXES[sweep.axis];
    let is_of_frames = sweep.axis == FRAMES || axis.layer == Some(Layer::Frames);
    let default = (axis.default)();
    is_of_frames && sweep.values.iter().any(|located| located.value != default)
}

/// Reports lights where they mean nothing, and axes of lights without any.
pub fn check_lights(config: &Config, inputs: &Inputs, faults: &mut Faults) {
    let is_placed = config.lights.iter().any(Light::has_position);
    if is_placed && inputs.scenes().any(|scene| scene.is_design) {
        let text = "lights: surfaces of the scene design have no position; expected directional \
                    lights";
        faults.add(&config.lights_location, text);
    }
    if !config.lights.is_empty() && config.ladder.is_some() {
        let text = "lights: [ladder] divides errors under the environment; remove one of them";
        faults.add(&config.lights_location, text);
    }
    if !config.lights.is_empty() || inputs.scenes().any(|scene| scene.has_lights()) {
        return;
    }
    for sweep in &config.axes {
        let axis = &AXES[sweep.axis];
        let is_set = |located: &Located| located.value != (axis.default)();
        if Layer::Lights.has(sweep.axis)
            && let Some(located) = sweep.values.iter().find(|located| is_set(located))
        {
            let text = format!("{}: the experiment has no light; add [[lights]]", axis.name);
            faults.add(&located.location, text);
        }
    }
}

pub fn sizes(config: &Config) -> Vec<(Location, [u32; 2])> {
    config
        .values(SIZE)
        .map(|(value, location)| (location.clone(), value.pair()))
        .collect()
}

/// Reports sizes that no device can hold.
pub fn check_sizes(config: &Config, faults: &mut Faults) {
    for (location, [width, height]) in sizes(config) {
        if image_buffer_bytes([width, height]) > BUFFER_BYTES_MAX {
            let pixels = BUFFER_BYTES_MAX / image_buffer_bytes([1, 1]);
            let text = format!(
                "size: {width}x{height} has {} pixels; at most {pixels} fit into the largest \
                 buffer of Vulkan",
                u64::from(width) * u64::from(height)
            );
            faults.add(&location, text);
        }
    }
}

fn has_layer(point: &Point, axis: AxisId) -> bool {
    point[axis] != Value::Unset && !point[axis].is_zero()
}

/// Fewer pixels leave a band of n·v without views.
const LADDER_PIXELS_MIN: u32 = 64;

fn check_ladder(config: &Config, point: &Point, faults: &mut Faults) {
    if !point.method().has_ladder || config.ladder.is_none() || !is_design(point[SCENE].text()) {
        return;
    }
    let [width, height] = point[SIZE].pair();
    if width * height < LADDER_PIXELS_MIN {
        let text = format!(
            "size: {width}x{height} has {} pixels; [ladder] needs at least {LADDER_PIXELS_MIN}",
            width * height
        );
        faults.add(&config.location_of(SIZE, point), text);
    }
    for axis in [PREFILTERED, DFG_TABLE, COMPENSATION, FRESNEL] {
        let value = &point[axis];
        let is_file = AXES[axis].kind.path_in(&value.to_string()).is_some();
        let expected = if is_file {
            OWN.to_owned()
        } else if [COMPENSATION, FRESNEL].contains(&axis) && !point.is_computed(axis) {
            (AXES[axis].default)().to_string()
        } else {
            continue;
        };
        let name = AXES[axis].name;
        let text = format!("{name}: [ladder] has no steps for {value}; expected {expected}");
        faults.add(&config.location_of(axis, point), text);
    }
    for axis in [COAT, ANISOTROPY, SHEEN_COLOR] {
        if has_layer(point, axis) {
            let text = format!(
                "{}: [ladder] has no steps for {}; expected 0",
                AXES[axis].name, point[axis]
            );
            faults.add(&config.location_of(axis, point), text);
        }
    }
    let alpha = f64::from(point.settings().material.alpha.unwrap_or(1.0));
    if alpha < harmonic::ALPHA_MIN {
        let text = format!(
            "alpha: {} is too narrow for [ladder]; expected at least {:.4}",
            point[ALPHA],
            harmonic::ALPHA_MIN
        );
        faults.add(&config.location_of(ALPHA, point), text);
    }
}

/// Reports sample counts that the reference would not draw exactly.
fn check_reference_counts(config: &Config, point: &Point, judge: &Point, faults: &mut Faults) {
    let is_method = point.method().is_integrated();
    if is_method && let Err(error) = pair_count(point[SAMPLES].count()) {
        let axis = if point[SAMPLES] == (AXES[SAMPLES].default)() {
            METHOD
        } else {
            SAMPLES
        };
        faults.add(
            &config.location_of(axis, point),
            format!("samples of method {}: {error}", point.method().name),
        );
    }
    let is_judged_by =
        config.is_scored && (judge.method().is_integrated() || judge.diffuse().is_integrated());
    if (is_judged_by || point.diffuse().is_integrated() && !is_method)
        && let Err(error) = pair_count(config.reference.samples)
    {
        faults.add(
            &config.reference_samples_location,
            format!("reference.samples: {error}"),
        );
    }
}

/// Reports sections that need scores in an experiment without.
pub fn check_unscored(config: &Config, faults: &mut Faults) {
    if config.ladder.is_some() && !config.is_scored {
        let text = format!(
            "[ladder] divides errors, and reference = {UNSCORED:?} measures none; remove one of them"
        );
        faults.add(&Location::File(0), text);
    }
}

/// Fewest widths of a grid whose best one has neighbours.
const GRID_WIDTHS_MIN: usize = 3;

/// Reports what `[recovery]` lacks: photos by the reference, another method, and its images over a
/// grid of widths at two values of F0.
pub fn check_recovery(config: &Config, faults: &mut Faults) {
    if config.recovery.is_none() {
        return;
    }
    let count = |axis: AxisId| config.sweep(axis).map_or(1, |sweep| sweep.values.len());
    let is_reference =
        |value: &Value| Method::by_name(value.text()).is_some_and(|method| method.is_reference());
    let methods = config.sweep(METHOD).map_or(&[][..], |sweep| &sweep.values);
    let references = methods
        .iter()
        .filter(|placed| is_reference(&placed.value))
        .count();
    let lack = if config.is_scored {
        format!("reference = {UNSCORED:?}: its photos are cells of the method reference")
    } else if references == 0 || references == methods.len() {
        "reference in the axis method, for photos, and a method that recovers materials".to_owned()
    } else if count(ALPHA) < GRID_WIDTHS_MIN {
        format!("at least {GRID_WIDTHS_MIN} widths in the axis alpha or perceptual_roughness")
    } else if count(F0).max(count(ALBEDO)) < 2 {
        "two values in the axis f0, or for metals in the axis albedo".to_owned()
    } else {
        return;
    };
    faults.add(&Location::File(0), format!("[recovery] needs {lack}"));
}

/// Reports excluded values that their axis does not have.
pub fn check_exclusions(config: &Config, faults: &mut Faults) {
    // Values that could not be read have their own faults.
    let is_read = |axis: AxisId| {
        config
            .axes
            .iter()
            .filter(|sweep| sweep.axis == axis)
            .all(|sweep| sweep.values.len() == sweep.written && sweep.written > 0)
    };
    let conditions = config
        .exclusions
        .iter()
        .flat_map(|exclusion| &exclusion.conditions);
    for Condition { axis, values } in conditions.filter(|condition| is_read(condition.axis)) {
        let known = values_of(config, *axis);
        for Located { value, location } in values {
            if !known.contains(&value) {
                faults.add(location, off_axis(config.named(*axis), value, &known));
            }
        }
    }
}

/// Lists swept axes that no cell uses, or that reach no pixel.
pub fn idle_sweeps<'p>(
    config: &Config,
    points: impl Iterator<Item = &'p Point> + Clone,
) -> Vec<(Location, String)> {
    let mut idle = Vec::new();
    for sweep in config.axes.iter().filter(|sweep| sweep.values.len() > 1) {
        let axis = sweep.axis;
        let mut all = points.clone();
        if !all.all(|point| point.of_pixels()[axis] == Value::Unset) {
            continue;
        }
        let name = AXES[axis].name;
        let count = sweep.values.len();
        let mut all = points.clone();
        let text = if all.all(|point| point[axis] == Value::Unset) {
            let about = AXES[axis].about;
            let user = user_in_words(AXES[axis].layer);
            format!("{name}: its {count} values give one cell: no {user} ({about})")
        } else {
            format!(
                "{name}: its {count} values give the same image: every surface is a metal or black"
            )
        };
        idle.push((sweep.values[0].location.clone(), text));
    }
    idle
}

/// What would use an axis of a layer, after "no".
fn user_in_words(layer: Option<Layer>) -> &'static str {
    match layer {
        Some(Layer::Coat) => "surface has a coat",
        Some(Layer::Sheen) => "surface has sheen",
        Some(Layer::Frames) => "sampling method has several frames",
        Some(Layer::Anisotropy) => "surface is anisotropic",
        Some(Layer::Lights) => "light",
        None => "method of the experiment uses it",
    }
}

/// Lists cells whose metals are black because their albedo, which a metal reflects, is 0.
pub fn black_metals<'p>(
    config: &Config,
    inputs: &Inputs,
    points: impl Iterator<Item = &'p Point>,
) -> IndexSet<(Location, String)> {
    let black = Value::Color([0.0; 3]);
    let describe = |point: &Point| {
        let scene = inputs.scene(point[SCENE].text());
        let is_black = point[ALBEDO] == black
            && point[METALLIC] == Value::Unset
            && scene
                .materials
                .iter()
                .any(|material| material.metallic > 0.0);
        let name = &scene.name;
        is_black.then(|| {
            let text = format!(
                "albedo: 0 makes the metals of {name} black; metallic = [0] makes them dielectrics"
            );
            (config.location_of(ALBEDO, point), text)
        })
    };
    points.filter_map(describe).collect()
}

/// Returns the values of an axis in the file and by `--set`, or its one fixed value.
fn values_of(config: &Config, axis: AxisId) -> Vec<&Value> {
    let sweeps: Vec<&Sweep> = config
        .axes
        .iter()
        .chain(&config.set_aside)
        .filter(|sweep| sweep.axis == axis)
        .collect();
    let located = || sweeps.iter().flat_map(|sweep| &sweep.values);
    let mut known: IndexSet<&Value> = located().map(|located| &located.value).collect();
    // An axis that only `--set` sweeps had this value in the file.
    if config.set_aside.iter().all(|sweep| sweep.axis != axis)
        && located().all(|located| matches!(located.location, Location::Set(_)))
    {
        known.insert(&config.base[axis]);
    }
    known.into_iter().collect()
}

fn off_axis(named: Named, value: &Value, known: &[&Value]) -> String {
    let shown = |value: &Value| shown(&named.shown(value));
    let names: Vec<String> = known.iter().map(|value| shown(value)).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let (wrong, near) = match value {
        Value::Text(text) => (format!("{text:?}"), suggestion(text, &names)),
        _ => (shown(value), String::new()),
    };
    let hint = if near.is_empty() {
        format!("; expected {}", expected(&names, None))
    } else {
        near
    };
    format!(
        "exclude.{}: the axis has no value {wrong}{hint}",
        named.name()
    )
}

fn shown(value: &Value) -> String {
    if *value == Value::Unset {
        "none".to_owned()
    } else {
        value.to_string()
    }
}
