//! What the passes of an experiment cost by the model, as the folder of its run keeps it.

use super::child::{CompileFault, Job, available};
use super::family::{FAMILIES, FRAME, Family, Texel};
use super::model::{Bound, Pass, passes};
use crate::pixels::{PixelsError, write_atomically};
use crate::precompute::PrecomputeSettings;
use serde::{Deserialize, Serialize};
use std::io::Write as _;
use std::path::Path;

/// The file in the folder of a run.
pub const COSTS_FILE: &str = "model_costs.json";

/// The texels of the maps.
pub const TEXEL: Texel = Texel::Rgba16f;

/// What a compiler made of the passes of an experiment.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct CostRecord {
    /// That compiled.
    pub driver: String,
    pub passes: Vec<RecordedPass>,
}

/// A pass on one family.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct RecordedPass {
    pub family: String,
    pub shader: String,
    pub constants: Vec<u32>,
    pub pass: Pass,
}

impl CostRecord {
    /// Compiles these jobs for every family that the driver has. `program` is this program's file.
    pub fn compiled(program: &Path, jobs: &[Job]) -> Result<Self, CompileFault> {
        let mut record = Self::default();
        for (family, compiler) in available(program)? {
            record.driver = compiler.driver;
            record.passes.extend(jobs.iter().zip(passes(program, family, jobs)?).map(|(job, pass)| RecordedPass {
                family: family.name.to_owned(),
                shader: job.shader.clone(),
                constants: job.constants.clone(),
                pass,
            }));
        }
        Ok(record)
    }

    /// Writes [`COSTS_FILE`] into a folder.
    pub fn write(&self, dir: &Path) -> Result<(), PixelsError> {
        let text = serde_json::to_string(self).expect("texts and numbers");
        write_atomically(&dir.join(COSTS_FILE), |file| file.write_all(text.as_bytes()))
    }

    /// The families with passes.
    pub fn families(&self) -> impl Iterator<Item = &'static Family> {
        FAMILIES.iter().filter(|family| self.passes.iter().any(|own| own.family == family.name))
    }

    /// The pass of a job.
    pub fn pass(&self, family: &Family, job: &Job) -> Option<&Pass> {
        let is_it = |own: &&RecordedPass| {
            own.family == family.name && own.shader == job.shader && own.constants == job.constants
        };
        self.passes.iter().find(is_it).map(|own| &own.pass)
    }

    /// Cycles a pixel of a pass without samples, with its share of a prefiltered map that is made by samples once in so many
    /// frames of [`FRAME`].
    pub fn with_tables(
        &self,
        family: &Family,
        [shading, prefilter]: [&Job; 2],
        settings: &PrecomputeSettings,
        frames: f64,
    ) -> Option<Bound> {
        let shading = self.pass(family, shading)?.cycles(family, TEXEL, 1);
        let prefilter = self.pass(family, prefilter)?;
        let pixels = frames * f64::from(FRAME[0]) * f64::from(FRAME[1]);
        let [width, height] = settings.prefilter_size.map(f64::from);
        let texels = f64::from(settings.layout.face_count) * width * height;
        let level = |k: u32| {
            // Level 0 is a mirror: one lookup a texel.
            let samples = if k == 0 { 1 } else { settings.prefilter_sample_count };
            let (cycles, share) = (prefilter.cycles(family, TEXEL, samples), texels * 0.25_f64.powi(k as i32) / pixels);
            Bound { least: share * cycles.least, most: share * cycles.most }
        };
        let sum = |all: Bound, own: Bound| Bound { least: all.least + own.least, most: all.most + own.most };
        Some((0..settings.prefilter_level_count).map(level).fold(shading, sum))
    }
}
