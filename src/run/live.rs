//! `live.json`: packed tables and scenes for the live view of the report.

use super::images::short_text;
use super::live_model::{LiveModel, models};
use super::renderer::{RenderFault, Renderer};
use crate::base::names::Listed;
use crate::base::pixels::{HALF_MAX, Pixels, RgbImage, packed};
use crate::experiment::axis::{AxisId, BRDF, ENVIRONMENT, Named, Point, Settings};
use crate::experiment::plan::Plan;
use crate::experiment::value::Value;
use crate::instrument::pipeline::{LightTables, RenderRequest};
use crate::instrument::precompute::taps::TapCount;
use crate::instrument::shade::{Method, Shading};
use indexmap::{IndexMap, IndexSet};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::hash::Hash;

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

/// Computes the tables of every model in the first environments of a plan.
pub fn record(plan: &Plan, renderer: &mut dyn Renderer) -> Result<LiveRecord, RenderFault> {
    let methods = distinct(plan, &[], |settings| settings.shading.method.name);
    let shader = |(_, request): &(Point, RenderRequest)| {
        let Method {
            name,
            text,
            uses_samples: is_sampled,
            ..
        } = *request.shading.method;
        Some(LiveShader {
            name: name.to_owned(),
            text: text?.to_owned(),
            is_sampled,
        })
    };
    let of_methods = methods
        .iter()
        .filter_map(|(_, request)| request.shading.method.tap_table);
    let counts: IndexSet<TapCount> = [TapCount::One].into_iter().chain(of_methods).collect();
    let counts: Vec<TapCount> = counts.into_iter().collect();
    let methods = methods.iter().filter_map(shader).collect();
    let mut record = LiveRecord {
        environments: Vec::new(),
        lobes: Vec::new(),
        left_out: 0,
        models: models(plan),
        methods,
    };
    let environments = distinct(plan, &[], |settings| settings.environment.clone());
    let lobes = distinct(plan, &[BRDF], |settings| {
        (
            settings.shading.brdf.name(),
            settings.shading.masking_shadowing.name(),
        )
    });
    for (point, request) in environments.iter().take(ENVIRONMENT_COUNT) {
        let mut environment: Option<LiveEnvironment> = None;
        for (_, of_lobe) in &lobes {
            let (brdf, masking) = (
                of_lobe.shading.brdf.name().to_owned(),
                of_lobe.shading.masking_shadowing.name(),
            );
            let has_lobe = record
                .lobes
                .iter()
                .any(|lobe| (&lobe.brdf, lobe.masking.as_str()) == (&brdf, masking));
            let is_kept = environment
                .as_ref()
                .is_some_and(|e| e.prefiltered.iter().any(|map| map.brdf == brdf));
            if has_lobe && is_kept {
                continue;
            }
            let Shading {
                brdf: model,
                masking_shadowing,
                ..
            } = of_lobe.shading;
            let counts: &[TapCount] = if has_lobe { &[] } else { &counts };
            let wanted =
                request.shaded(|s| (s.brdf, s.masking_shadowing) = (model, masking_shadowing));
            let tables = renderer.light_tables(&wanted, ENVIRONMENT_TEXELS, counts)?;
            if !has_lobe {
                let packed = |(count, table): (&TapCount, &Pixels<[f32; 4]>)| {
                    (count.sampler().to_owned(), pack(table, 1.0))
                };
                let dfg = pack(&tables.dfg.map(|[a, b]| [a, b, 0.0]), 1.0);
                let (masking, dfg_axes) = (masking.to_owned(), tables.dfg_axes as u32);
                let tap_tables = counts.iter().zip(&tables.tap_tables).map(packed).collect();
                let is_stretchable = wanted
                    .shading
                    .widths
                    .fault(model, masking_shadowing)
                    .is_none();
                record.lobes.push(LiveLobe {
                    brdf: brdf.clone(),
                    masking,
                    dfg,
                    dfg_axes,
                    is_stretchable,
                    tap_tables,
                });
            }
            let environment =
                environment.get_or_insert_with(|| of_environment(point, request, &tables));
            if !is_kept {
                let levels = pack_all(&tables.prefiltered, environment.scale);
                environment
                    .prefiltered
                    .push(LivePrefiltered { brdf, levels });
            }
        }
        record.environments.extend(environment);
    }
    record.left_out = environments.len() - record.environments.len();
    Ok(record)
}

/// Point and request of the first cell for every value of `key`, among cells that use all of
/// `axes`.
fn distinct<K: Eq + Hash>(
    plan: &Plan,
    axes: &[AxisId],
    key: impl Fn(&Settings) -> K,
) -> Vec<(Point, RenderRequest)> {
    let mut found: IndexMap<K, (Point, RenderRequest)> = IndexMap::new();
    for cell in plan
        .cells
        .iter()
        .filter(|cell| axes.iter().all(|&axis| cell.point[axis] != Value::Unset))
    {
        // A request takes a copy of its scene.
        let first = || (cell.point.clone(), plan.request(&cell.point));
        found
            .entry(key(&cell.point.settings()))
            .or_insert_with(first);
    }
    found.into_values().collect()
}

fn of_environment(point: &Point, request: &RenderRequest, tables: &LightTables) -> LiveEnvironment {
    let largest = tables
        .environment
        .iter()
        .chain(&tables.prefiltered)
        .flat_map(|level| level.data.iter().flatten());
    let scale = half_scale(largest.fold(0.0, |a: f32, b| a.max(*b)));
    LiveEnvironment {
        label: short_text(Named::own(ENVIRONMENT), point),
        scale,
        mean_luminance: request.environment.luminance.mean,
        layout: tables.layout.name.to_owned(),
        level_bend: tables.level_mapping.bend,
        levels: pack_all(&tables.environment, scale),
        sh9: tables.sh9.iter().map(|c| c.map(|x| x / scale)).collect(),
        prefiltered: Vec::new(),
    }
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
