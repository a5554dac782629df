//! What values must be together: combinations, sizes, lights in their scenes, and exclusions against the axes they speak of.

use super::axis::{AXES, Point, REFERENCE};
use super::config::{Config, Sweep};
use super::fault::{Faults, Place};
use super::inputs::Inputs;
use super::plan::{base_dir, product};
use super::value::Kind;
use crate::environment::{Environment, LoadOptions};
use crate::pipeline::{BUFFER_BYTES_MAX, image_buffer_bytes};
use crate::scene::Scene;
use crate::shade::reference_pass::ScramblePlan;
use crate::spelling::suggestion;
use std::collections::{HashMap, HashSet};

/// Values that are right one by one but not together.
pub fn check_combinations(config: &Config, faults: &mut Faults) {
    for point in product(config).filter(|point| config.exclusion_of(point).is_none()) {
        let has_lights = !config.lights.is_empty();
        let judge = point.reference(&config.reference, has_lights);
        let point = point.collapsed(has_lights);
        check_reference_counts(config, &point, &judge, faults);
        if let Err(error) = point.settings().precompute.validate() {
            let partners = [error.field(), "prefilter_size"];
            let place =
                partners.iter().map(|name| config.place_of(name, &point)).find(|place| *place != Place::Default);
            faults.add(&place.unwrap_or(Place::Default), error.to_string());
        }
    }
}

/// Every size of the images, with its place.
pub fn sizes(config: &Config) -> Vec<(Place, [u32; 2])> {
    match config.axes.iter().find(|sweep| AXES[sweep.axis].name == "size") {
        Some(sweep) => sweep.values.iter().map(|placed| (placed.place.clone(), placed.value.pair())).collect(),
        None => vec![(config.base_place("size").clone(), config.base.get("size").pair())],
    }
}

/// Sizes that no device can hold.
pub fn check_sizes(config: &Config, faults: &mut Faults) {
    for (place, [width, height]) in sizes(config) {
        if image_buffer_bytes([width, height]) > BUFFER_BYTES_MAX {
            let pixels = BUFFER_BYTES_MAX / image_buffer_bytes([1, 1]);
            let text = format!(
                "size: {width}x{height} has {} pixels; at most {pixels} fit into the largest buffer of Vulkan",
                u64::from(width) * u64::from(height)
            );
            faults.add(&place, text);
        }
    }
}

/// A row must not name another number of samples than the reference draws.
fn check_reference_counts(config: &Config, point: &Point, judge: &Point, faults: &mut Faults) {
    let has_term = |point: &Point, term: &str| point.get(term).text() == REFERENCE;
    let is_method = has_term(point, "method");
    if is_method && let Err(error) = ScramblePlan::exact(point.get("samples").count()) {
        faults.add(&config.place_of("samples", point), format!("samples of method {REFERENCE}: {error}"));
    }
    let is_judged_by = has_term(judge, "method") || has_term(judge, "diffuse");
    if (is_judged_by || has_term(point, "diffuse") && !is_method)
        && let Err(error) = ScramblePlan::exact(config.reference.samples)
    {
        faults.add(&config.reference_samples_place, format!("reference.samples: {error}"));
    }
}

/// Lights that cannot stand in one of the scenes.
pub fn check_lights(config: &Config, inputs: &Inputs, faults: &mut Faults) {
    for (light, place) in config.lights.iter().zip(&config.light_places) {
        for fault in inputs.scenes().filter_map(|scene| light.fault_in(scene)) {
            faults.add(place, format!("lights: {fault}"));
        }
    }
}

/// Environments and scenes that exclusions name. One that no axis has may be left from an earlier sweep; one that is no input either is a
/// slip, whose exclusion would leave nothing out. Values that only `--set` took away are those of the file.
pub fn check_exclusions(config: &Config, options: &LoadOptions, faults: &mut Faults) {
    let conditions = config.exclusions.iter().flat_map(|exclusion| &exclusion.conditions);
    let mut found: HashMap<(usize, &str), bool> = HashMap::new();
    for (axis, values) in conditions.filter(|(axis, _)| matches!(AXES[*axis].kind, Kind::Input)) {
        let name = AXES[*axis].name;
        let mut known: Vec<&str> = vec![config.base.0[*axis].text()];
        let sweeps: Vec<&Sweep> =
            config.axes.iter().chain(&config.set_aside).filter(|sweep| sweep.axis == *axis).collect();
        if !sweeps.is_empty() {
            known = sweeps.iter().flat_map(|sweep| &sweep.values).map(|placed| placed.value.text()).collect();
        }
        let is_known: HashSet<&str> = known.iter().copied().collect();
        for placed in values {
            let (value, dir) = (placed.value.text(), base_dir(config, &placed.place));
            let is_input = || match name {
                "scene" => Scene::load(value, dir).is_ok(),
                _ => Environment::load(value, dir, options).is_ok(),
            };
            // Each is loaded once, however many exclusions name it.
            if !is_known.contains(value) && !*found.entry((*axis, value)).or_insert_with(is_input) {
                faults.add_with(&placed.place, |_| {
                    let near = suggestion(value, &known);
                    format!("exclude.{name}: the axis has no value {value:?}{near}; it has {}", known.join(", "))
                });
            }
        }
    }
}
