//! Checks of values together: combinations, sizes, exclusions.

use super::axis::{
    ALBEDO, ALPHA, ANISOTROPY, AXES, Axis, AxisId, COAT, COMPENSATION, DFG_TABLE, FRAMES, METALLIC,
    METHOD, MOTION, Named, PREFILTER_SIZE, PREFILTERED, Point, SAMPLES, SCENE, SHEEN_COLOR, SIZE,
    motion_fault,
};
use super::config::{Config, Placed, Sweep};
use super::fault::{Faults, Place};
use super::inputs::Inputs;
use super::value::Value;
use crate::base::names::{Listed, expected, suggestion};
use crate::instrument::pipeline::{BUFFER_BYTES_MAX, image_buffer_bytes};
use crate::instrument::precompute::prefilter::harmonic;
use crate::instrument::scene::is_design;
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
                &config.place_of(ANISOTROPY, &point),
                format!("anisotropy: {what}"),
            );
        }
        if let Some(fault) = motion_fault(&point, config.antialias) {
            faults.add(&config.place_of(MOTION, &point), format!("motion: {fault}"));
        }
        if let Err(error) = point
            .method()
            .tables(point.settings().shading.precompute)
            .validate()
        {
            let partners = AxisId::find(error.field)
                .into_iter()
                .chain([PREFILTER_SIZE]);
            let place = partners
                .map(|axis| config.place_of(axis, &point))
                .find(|place| *place != Place::Default);
            faults.add(&place.unwrap_or(Place::Default), error.to_string());
        }
    }
}

/// Reports the first axis of frames if no method can have several.
pub fn check_frames(config: &Config, faults: &mut Faults) {
    let samples =
        |method: &Value| Method::by_name(method.text()).is_none_or(|method| method.uses_point_set);
    let frames = AXES[FRAMES].name;
    let is_of_frames = |axis: &Axis| axis.name == frames || axis.layer() == Some(frames);
    let is_default = |sweep: &Sweep| {
        sweep
            .values
            .iter()
            .all(|placed| placed.value == (AXES[sweep.axis].default)())
    };
    let is_asked = |sweep: &&Sweep| is_of_frames(&AXES[sweep.axis]) && !is_default(sweep);
    let asked = config
        .axes
        .iter()
        .find(is_asked)
        .filter(|_| !config.values(METHOD).any(|(method, _)| samples(method)));
    if let Some(sweep) = asked {
        let text = "no method of the experiment samples, and an image without samples is its own \
                    history; add a sampling method";
        faults.add(
            &sweep.values[0].place,
            format!("{}: {text}", AXES[sweep.axis].name),
        );
    }
}

pub fn sizes(config: &Config) -> Vec<(Place, [u32; 2])> {
    config
        .values(SIZE)
        .map(|(value, place)| (place.clone(), value.pair()))
        .collect()
}

/// Reports sizes that no device can hold.
pub fn check_sizes(config: &Config, faults: &mut Faults) {
    for (place, [width, height]) in sizes(config) {
        if image_buffer_bytes([width, height]) > BUFFER_BYTES_MAX {
            let pixels = BUFFER_BYTES_MAX / image_buffer_bytes([1, 1]);
            let text = format!(
                "size: {width}x{height} has {} pixels; at most {pixels} fit into the largest \
                 buffer of Vulkan",
                u64::from(width) * u64::from(height)
            );
            faults.add(&place, text);
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
        faults.add(&config.place_of(SIZE, point), text);
    }
    let is_given = |axis: &AxisId| {
        AXES[*axis]
            .kind
            .path_in(&point[*axis].to_string())
            .is_some()
    };
    let is_other = |axis: &AxisId| is_given(axis) || *axis == COMPENSATION && !point.is_own(*axis);
    for axis in [PREFILTERED, DFG_TABLE, COMPENSATION]
        .into_iter()
        .filter(is_other)
    {
        let (name, value, usual) = (AXES[axis].name, &point[axis], (AXES[axis].default)());
        let usual = if is_given(&axis) {
            "own".to_owned()
        } else {
            usual.to_string()
        };
        let text = format!("{name}: [ladder] has no steps for {value}; expected {usual}");
        faults.add(&config.place_of(axis, point), text);
    }
    for axis in [COAT, ANISOTROPY, SHEEN_COLOR]
        .into_iter()
        .filter(|axis| has_layer(point, *axis))
    {
        let text = format!(
            "{}: [ladder] has no steps for {}; expected 0",
            AXES[axis].name, point[axis]
        );
        faults.add(&config.place_of(axis, point), text);
    }
    let alpha = f64::from(point.settings().material.alpha.unwrap_or(1.0));
    if alpha < harmonic::ALPHA_MIN {
        let place = config.place_of(ALPHA, point);
        let text = format!(
            "alpha: {} is too narrow for [ladder]; expected at least {:.4}",
            point[ALPHA],
            harmonic::ALPHA_MIN
        );
        faults.add(&place, text);
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
            &config.place_of(axis, point),
            format!("samples of method {}: {error}", point.method().name),
        );
    }
    let is_judged_by = judge.method().is_integrated() || judge.diffuse().is_integrated();
    if (is_judged_by || point.diffuse().is_integrated() && !is_method)
        && let Err(error) = pair_count(config.reference.samples)
    {
        faults.add(
            &config.reference_samples_place,
            format!("reference.samples: {error}"),
        );
    }
}

/// Reports excluded values that their axis does not have.
pub fn check_exclusions(config: &Config, faults: &mut Faults) {
    // Values that could not be read have their own faults.
    let is_read = |axis: AxisId| {
        config
            .axes
            .iter()
            .all(|s| s.axis != axis || s.values.len() == s.written && s.written > 0)
    };
    let conditions = config
        .exclusions
        .iter()
        .flat_map(|exclusion| &exclusion.conditions);
    for (axis, values) in conditions.filter(|(axis, _)| is_read(*axis)) {
        let known = values_of(config, *axis);
        for Placed { value, place } in values
            .iter()
            .filter(|placed| !known.contains(&&placed.value))
        {
            faults.add(place, off_axis(config.named(*axis), value, &known));
        }
    }
}

/// Lists swept axes that no cell uses, or that reach no pixel.
pub fn idle_sweeps<'p>(
    config: &Config,
    points: impl Iterator<Item = &'p Point> + Clone,
) -> Vec<(Place, String)> {
    let is_unused = |axis: AxisId| points.clone().all(|point| point[axis] == Value::Unset);
    let is_idle = |axis: AxisId| {
        points
            .clone()
            .all(|point| point.of_pixels()[axis] == Value::Unset)
    };
    let describe = |sweep: &Sweep| {
        let (Axis { name, about, .. }, count) = (&AXES[sweep.axis], sweep.values.len());
        let text = if !is_unused(sweep.axis) {
            format!(
                "{name}: its {count} values give the same image: every surface is a metal or black"
            )
        } else {
            let user = match AXES[sweep.axis].layer() {
                Some("coat") => "surface has a coat",
                Some("sheen_color") => "surface has sheen",
                Some("frames") => "sampling method has several frames",
                Some(_) => "surface is anisotropic",
                None => "method of the experiment uses it",
            };
            format!("{name}: its {count} values give one cell: no {user} ({about})")
        };
        (sweep.values[0].place.clone(), text)
    };
    config
        .axes
        .iter()
        .filter(|sweep| sweep.values.len() > 1 && is_idle(sweep.axis))
        .map(describe)
        .collect()
}

/// Lists cells whose metals are black because their albedo, which a metal reflects, is 0.
pub fn black_metals<'p>(
    config: &Config,
    inputs: &Inputs,
    points: impl Iterator<Item = &'p Point>,
) -> IndexSet<(Place, String)> {
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
            (config.place_of(ALBEDO, point), text)
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
    let placed = || sweeps.iter().flat_map(|sweep| &sweep.values);
    let mut known: IndexSet<&Value> = placed().map(|placed| &placed.value).collect();
    // An axis that only `--set` sweeps had this value in the file.
    if config.set_aside.iter().all(|sweep| sweep.axis != axis)
        && placed().all(|placed| matches!(placed.place, Place::Set(_)))
    {
        known.insert(&config.base.0[axis]);
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
