//! The content of `live.json`: packed tables and scenes.

use super::model::{LiveModel, models};
use crate::base::glsl::constants::LEVELS_MAX;
use crate::base::names::Listed;
use crate::base::pixels::{HALF_MAX, Pixels, RgbImage, packed};
use crate::experiment::axis::{AxisId, BRDF, ENVIRONMENT, Named, Point, Settings};
use crate::experiment::plan::Plan;
use crate::experiment::value::Value;
use crate::instrument::pipeline::{LightTables, RenderRequest};
use crate::instrument::precompute::taps::TapCount;
use crate::instrument::shade::Method;
use crate::run::images::short_text;
use crate::run::{RenderFault, Renderer};
use indexmap::{IndexMap, IndexSet};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::hash::Hash;

/// Name of the record in the folder of a run.
pub const LIVE_FILE: &str = "live.json";
/// Most environments that are kept.
const ENVIRONMENT_COUNT: usize = 4;
/// Larger levels of an environment are left out: this size is as sharp as a screen.
const ENVIRONMENT_TEXELS: u32 = 1 << 19;

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct LiveRecord {
    pub environments: Vec<LiveEnvironment>,
    pub lobes: Vec<LiveLobe>,
    /// Environments of the run that are not kept.
    pub left_out: usize,
    pub models: Vec<LiveModel>,
    #[serde(default)]
    pub methods: Vec<LiveShader>,
    /// Whether the run has direct lights, which the view does not draw.
    #[serde(default)]
    pub has_lights: bool,
    /// Whether a scene has maps of occlusion, which the view does not read.
    #[serde(default)]
    pub has_occlusion: bool,
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct LiveShader {
    pub name: String,
    pub text: String,
    pub is_sampled: bool,
}

/// An image as half floats (see [`packed`]).
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct PackedImage {
    pub size: [u32; 2],
    pub base64: String,
}

/// An environment and its tables. Packed radiance and `sh9` are divided by `scale`.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct LiveEnvironment {
    pub label: String,
    /// Power of two; 1 unless the radiance exceeds the range of half floats.
    pub scale: f32,
    pub mean_luminance: f64,
    pub layout: String,
    /// b of `precompute::prefilter::LevelMapping`.
    pub level_bend: f64,
    /// The roughness of each level if they are listed, zeros behind; else zeros.
    #[serde(default)]
    pub level_roughnesses: [f32; LEVELS_MAX as usize],
    /// The faces of a level are below each other.
    pub levels: Vec<PackedImage>,
    /// Radiance coefficients in the order of `shaders/lib/sh.glsl`.
    pub sh9: Vec<[f32; 3]>,
    pub prefiltered: Vec<LivePrefiltered>,
}

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct LivePrefiltered {
    pub brdf: String,
    pub levels: Vec<PackedImage>,
}

/// The DFG table of one model and masking: scale of f0 in R, addend in G.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct LiveLobe {
    pub brdf: String,
    pub masking: String,
    pub dfg: PackedImage,
    /// One of `DFG_AXES_*`.
    pub dfg_axes: u32,
    /// Whether it may have two widths.
    pub is_stretchable: bool,
    /// Tables of taps by their samplers, of every method of the run and of `split-sum-one`.
    pub tap_tables: BTreeMap<String, PackedImage>,
}

/// A point of the plan and the request of its first cell.
struct Case {
    point: Point,
    request: RenderRequest,
}

/// Computes the tables of every model in the first environments of a plan.
pub fn record(plan: &Plan, renderer: &mut dyn Renderer) -> Result<LiveRecord, RenderFault> {
    let methods = distinct(plan, &[], |settings| settings.shading.method.name);
    let tap_counts = tap_counts(&methods);
    let environments = distinct(plan, &[], |settings| settings.environment.clone());
    let lobes = distinct(plan, &[BRDF], |settings| {
        (
            settings.shading.brdf.name(),
            settings.shading.masking_shadowing.name(),
        )
    });
    let mut record = LiveRecord {
        environments: Vec::new(),
        lobes: Vec::new(),
        left_out: 0,
        models: models(plan),
        has_lights: plan.has_lights(),
        has_occlusion: plan.has_occlusion(),
        methods: methods
            .iter()
            .filter_map(|case| LiveShader::of_file(case.request.shading.method))
            .collect(),
    };
    for environment in environments.iter().take(ENVIRONMENT_COUNT) {
        record.add_environment(environment, &lobes, &tap_counts, renderer)?;
    }
    record.left_out = environments.len() - record.environments.len();
    Ok(record)
}

/// The tap tables that the methods of a run and `split-sum-one` read, each once.
fn tap_counts(methods: &[Case]) -> Vec<TapCount> {
    let read_by_methods = methods
        .iter()
        .filter_map(|case| case.request.shading.method.tap_table);
    let distinct: IndexSet<TapCount> = std::iter::once(TapCount::One)
        .chain(read_by_methods)
        .collect();
    distinct.into_iter().collect()
}

impl LiveShader {
    /// The shader of a method that a user wrote; `None` for methods of the program.
    fn of_file(method: &Method) -> Option<Self> {
        Some(Self {
            name: method.name.to_owned(),
            text: method.text?.to_owned(),
            is_sampled: method.uses_samples,
        })
    }
}

impl LiveRecord {
    /// Adds an environment with its prefiltered map of each model, and the lobes that no earlier
    /// environment added.
    fn add_environment(
        &mut self,
        case: &Case,
        lobes: &[Case],
        tap_counts: &[TapCount],
        renderer: &mut dyn Renderer,
    ) -> Result<(), RenderFault> {
        let mut added: Option<LiveEnvironment> = None;
        for lobe in lobes {
            let shading = &lobe.request.shading;
            let brdf = shading.brdf.name();
            let has_lobe = self.has_lobe(brdf, shading.masking_shadowing.name());
            let has_map = added
                .as_ref()
                .is_some_and(|environment| environment.has_map(brdf));
            if has_lobe && has_map {
                continue;
            }
            let request = case.request.shaded(|s| {
                s.brdf = shading.brdf;
                s.masking_shadowing = shading.masking_shadowing;
            });
            let missing_taps = if has_lobe { &[] } else { tap_counts };
            let tables = renderer.light_tables(&request, ENVIRONMENT_TEXELS, missing_taps)?;
            if !has_lobe {
                self.lobes
                    .push(LiveLobe::new(&request, &tables, tap_counts));
            }
            let environment = added.get_or_insert_with(|| LiveEnvironment::new(case, &tables));
            if !has_map {
                environment.prefiltered.push(LivePrefiltered {
                    brdf: brdf.to_owned(),
                    levels: pack_all(&tables.prefiltered, environment.scale),
                });
            }
        }
        self.environments.extend(added);
        Ok(())
    }

    fn has_lobe(&self, brdf: &str, masking: &str) -> bool {
        self.lobes
            .iter()
            .any(|lobe| lobe.brdf == brdf && lobe.masking == masking)
    }
}

impl LiveEnvironment {
    /// An environment without prefiltered maps. `tables` are the tables of any model in it.
    fn new(case: &Case, tables: &LightTables) -> Self {
        let radiance = tables
            .environment
            .iter()
            .chain(&tables.prefiltered)
            .flat_map(|level| level.data.iter().flatten());
        let scale = half_scale(radiance.fold(0.0, |largest: f32, x| largest.max(*x)));
        Self {
            label: short_text(Named::primary(ENVIRONMENT), &case.point),
            scale,
            mean_luminance: case.request.environment.luminance.mean,
            layout: tables.layout.name.to_owned(),
            level_bend: tables.level_mapping.bend(),
            level_roughnesses: tables.level_mapping.device_list(),
            levels: pack_all(&tables.environment, scale),
            sh9: tables.sh9.iter().map(|c| c.map(|x| x / scale)).collect(),
            prefiltered: Vec::new(),
        }
    }

    fn has_map(&self, brdf: &str) -> bool {
        self.prefiltered.iter().any(|map| map.brdf == brdf)
    }
}

impl LiveLobe {
    fn new(request: &RenderRequest, tables: &LightTables, tap_counts: &[TapCount]) -> Self {
        let shading = &request.shading;
        let stretch_fault = shading
            .widths
            .fault(shading.brdf, shading.masking_shadowing);
        Self {
            brdf: shading.brdf.name().to_owned(),
            masking: shading.masking_shadowing.name().to_owned(),
            dfg: pack(&tables.dfg.map(|[scale, addend]| [scale, addend, 0.0]), 1.0),
            dfg_axes: tables.dfg_axes as u32,
            is_stretchable: stretch_fault.is_none(),
            tap_tables: tap_counts
                .iter()
                .zip(&tables.tap_tables)
                .map(|(count, table)| (count.sampler().to_owned(), pack(table, 1.0)))
                .collect(),
        }
    }
}

/// The first case for every value of `key`, among the cells that use all of `axes`.
fn distinct<K: Eq + Hash>(plan: &Plan, axes: &[AxisId], key: impl Fn(&Settings) -> K) -> Vec<Case> {
    let mut cases: IndexMap<K, Case> = IndexMap::new();
    let uses_axes = |point: &Point| axes.iter().all(|&axis| point[axis] != Value::Unset);
    for cell in plan.cells.iter().filter(|cell| uses_axes(&cell.point)) {
        // Only for the first: a request copies its scene.
        let first = || Case {
            point: cell.point.clone(),
            request: plan.request(&cell.point),
        };
        cases
            .entry(key(&cell.point.settings()))
            .or_insert_with(first);
    }
    cases.into_values().collect()
}

/// The smallest power of two, at least 1, that brings `largest` into the range of half floats.
pub fn half_scale(largest: f32) -> f32 {
    (largest / HALF_MAX).max(1.0).log2().ceil().exp2()
}

fn pack_all(levels: &[RgbImage], scale: f32) -> Vec<PackedImage> {
    levels.par_iter().map(|level| pack(level, scale)).collect()
}

fn pack<const N: usize>(image: &Pixels<[f32; N]>, scale: f32) -> PackedImage {
    let divided = Pixels::new(
        image.width,
        image.height,
        image.data.iter().map(|t| t.map(|x| x / scale)).collect(),
    );
    PackedImage {
        size: [image.width, image.height],
        base64: packed::texels(&divided).base64,
    }
}
