//! The live view of a page: which of the tables that the run left in [`LIVE_FILE`] fit, and what else its shaders need.
//!
//! The tables go into the page as the run packed them. Where they are too large, the finest level of an environment goes first: the page
//! then reads one level coarser wherever the renderer would have read the finest one.

use super::told::Told;
use crate::files::read_regular;
use crate::glsl::constants;
use crate::math::sequence::SEQUENCES;
use crate::precompute::points;
use crate::runner::live::{LIVE_FILE, LiveEnvironment, LiveLobe, LiveRecord};
use crate::runner::value::Value;
use crate::scene::camera::{PERSPECTIVE_FOV_DEG, PERSPECTIVE_SPHERE_DISTANCE};
use crate::scene::material::{DEFAULT_ALBEDO, DEFAULT_F0};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde::Serialize;

/// Bytes of base64 that the tables of a page may take.
pub const BUDGET_BYTES: usize = 4 << 20;
/// An environment is not reduced further for the sake of another one.
const ENVIRONMENT_WIDTH_MIN: u32 = 256;
/// A larger file is none that a run wrote: the tables of its few environments are far smaller.
const FILE_BYTES_MAX: u64 = 64 << 20;
/// Sample counts that the page offers, besides those of the run.
const SAMPLE_COUNTS: [u32; 15] = [1, 2, 4, 5, 8, 16, 30, 32, 40, 64, 100, 128, 256, 512, 1024];

/// What the live view reads.
#[derive(Debug, Serialize)]
pub struct Light {
    pub environments: Vec<LiveEnvironment>,
    pub lobes: Vec<LiveLobe>,
    /// Names of the maskings in the order of the shaders' constants.
    pub masking_names: Vec<&'static str>,
    pub points: Vec<PointTable>,
    pub camera: CameraDefaults,
    pub material: MaterialDefaults,
    /// The floor of alpha.
    pub alpha_min: f32,
    /// What is missing and why, one sentence each.
    pub notes: Vec<String>,
}

/// The sample points of one count: vec4s of little-endian f32, base64.
#[derive(Debug, Serialize)]
pub struct PointTable {
    pub count: u32,
    pub base64: String,
}

/// The renderer's automatic camera of a sphere of radius 1.
#[derive(Debug, Serialize)]
pub struct CameraDefaults {
    pub fov_deg: f64,
    pub distance: f64,
}

/// The renderer's default surface.
#[derive(Debug, Serialize)]
pub struct MaterialDefaults {
    pub albedo: f32,
    pub f0: f32,
}

impl Light {
    /// The tables of the first run that has any, within `budget` bytes.
    pub fn collect(runs: &[Told], budget: usize) -> Self {
        let mut notes = Vec::new();
        let record = runs.iter().find_map(|run| match read(run) {
            Ok(record) => {
                if record.is_some() && runs.len() > 1 {
                    notes.push(format!("Light and tables are those of {}.", run.finished.dir.display()));
                }
                record
            }
            Err(note) => {
                notes.push(note);
                None
            }
        });
        let counts = runs.iter().flat_map(sample_counts).chain(SAMPLE_COUNTS);
        let mut light = Self {
            environments: Vec::new(),
            lobes: Vec::new(),
            masking_names: crate::brdf::MaskingShadowing::ALL.iter().map(|(name, _)| *name).collect(),
            points: point_tables(counts),
            camera: CameraDefaults { fov_deg: PERSPECTIVE_FOV_DEG, distance: PERSPECTIVE_SPHERE_DISTANCE },
            material: MaterialDefaults { albedo: DEFAULT_ALBEDO, f0: DEFAULT_F0 },
            alpha_min: constants::ALPHA_MIN,
            notes,
        };
        match record {
            Some(record) => light.fit(record, budget),
            None => light.notes.push(format!(
                "The folder of the run has no {LIVE_FILE}: it was stopped before its end, or made by an older version."
            )),
        }
        light
    }

    /// Takes the record's tables, and drops the finest levels of the largest environments, then whole environments, until all fits.
    fn fit(&mut self, record: LiveRecord, budget: usize) {
        (self.environments, self.lobes) = (record.environments, record.lobes);
        let mut left_out = record.left_out;
        while self.bytes() > budget {
            let reducible = self.environments.iter_mut().filter(|e| e.levels[0].size[0] > ENVIRONMENT_WIDTH_MIN);
            if let Some(largest) = reducible.max_by_key(|e| e.levels[0].base64.len()) {
                largest.levels.remove(0);
                largest.first_level += 1;
            } else if self.environments.len() > 1 {
                self.environments.pop();
                left_out += 1;
            } else {
                break;
            }
        }
        if left_out > 0 {
            self.notes.push(format!("{left_out} more environments of the run are not in this view."));
        }
    }

    /// Bytes of all tables.
    fn bytes(&self) -> usize {
        let maps = self.environments.iter().flat_map(|e| {
            let prefiltered = e.prefiltered.iter().flat_map(|map| &map.levels);
            e.levels.iter().chain(prefiltered)
        });
        maps.chain(self.lobes.iter().map(|lobe| &lobe.dfg)).map(|image| image.base64.len()).sum()
    }
}

/// The record of a run; `None` when it has none.
fn read(run: &Told) -> Result<Option<LiveRecord>, String> {
    let path = run.finished.dir.join(LIVE_FILE);
    let text = match read_regular(&path, FILE_BYTES_MAX) {
        Ok(text) => text,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(format!("{}: {error}", path.display())),
    };
    let record: LiveRecord = serde_json::from_slice(&text)
        .map_err(|error| format!("{}: {error}; expected a file that `splitsum run` wrote", path.display()))?;
    // A chain without levels has nothing to show.
    let is_whole = |e: &LiveEnvironment| !e.levels.is_empty() && !e.prefiltered.is_empty();
    let has_tables = !record.lobes.is_empty() && !record.environments.is_empty();
    if !has_tables || !record.environments.iter().all(is_whole) {
        return Err(format!("{}: has an environment or model without tables", path.display()));
    }
    Ok(Some(record))
}

/// The sample counts of a run's cells that the page can take.
fn sample_counts(run: &Told) -> Vec<u32> {
    let most = SAMPLE_COUNTS[SAMPLE_COUNTS.len() - 1];
    let counts = run.finished.cells.iter().filter_map(|cell| match cell.point.get("samples") {
        Value::Count(count) => Some(*count),
        _ => None,
    });
    counts.filter(|count| (1..=most).contains(count)).collect()
}

/// The renderer's own point sets, by count.
fn point_tables(counts: impl Iterator<Item = u32>) -> Vec<PointTable> {
    let mut counts: Vec<u32> = counts.collect();
    counts.sort_unstable();
    counts.dedup();
    let bytes = |count| {
        points::table(count, &SEQUENCES[0], 0).iter().flatten().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>()
    };
    counts.into_iter().map(|count| PointTable { count, base64: BASE64_STANDARD.encode(bytes(count)) }).collect()
}
