//! What the passes of an experiment cost by the model, as the folder of its run keeps it.

use super::child::{CompileFault, available};
use super::family::{FAMILIES, Family, Texel};
use super::model::{Bound, FRAME, Pass, job, passes, prefilter_job};
use crate::brdf::Brdf;
use crate::environment::layout::MapLayout;
use crate::pixels::{PixelsError, write_atomically};
use crate::precompute::PrecomputeSettings;
use crate::shade::Method;
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
    /// Empty for the pass that makes a level of the prefiltered map.
    pub method: String,
    pub brdf: String,
    pub layout: String,
    pub pass: Pass,
}

impl CostRecord {
    /// Compiles the specular passes of these methods, models and layouts, and the prefilter of each, for every family that the driver has.
    /// `program` is this program's file.
    pub fn compiled(
        program: &Path,
        wanted: &[(&'static Method, &'static dyn Brdf, &'static MapLayout)],
    ) -> Result<Self, CompileFault> {
        let mut asked: Vec<([&str; 3], _)> = Vec::new();
        for (method, brdf, layout) in wanted {
            let names = [method.name, brdf.name(), layout.name];
            for (names, job) in
                [(names, job(layout, method, *brdf)), (["", names[1], names[2]], prefilter_job(layout, *brdf))]
            {
                if asked.iter().all(|(known, _)| *known != names) {
                    asked.push((names, job));
                }
            }
        }
        let jobs: Vec<_> = asked.iter().map(|(_, job)| job.clone()).collect();
        let mut record = Self::default();
        for (family, compiler) in available(program)? {
            record.driver = compiler.driver;
            let made = passes(program, family, &jobs)?;
            record.passes.extend(asked.iter().zip(made).map(|((names, _), pass)| {
                let [method, brdf, layout] = names.map(str::to_owned);
                RecordedPass { family: family.name.to_owned(), method, brdf, layout, pass }
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

    /// The pass of a method; of the prefilter for none.
    pub fn pass(&self, family: &Family, method: &str, brdf: &str, layout: &str) -> Option<&Pass> {
        let named = |own: &&RecordedPass| {
            [&own.family, &own.method, &own.brdf, &own.layout] == [family.name, method, brdf, layout]
        };
        self.passes.iter().find(named).map(|own| &own.pass)
    }

    /// Cycles a pixel of a method without samples, with its share of a prefiltered map that is made by samples once in so many
    /// frames of [`FRAME`].
    pub fn with_tables(
        &self,
        family: &Family,
        [method, brdf]: [&str; 2],
        settings: &PrecomputeSettings,
        frames: f64,
    ) -> Option<Bound> {
        let layout = settings.layout.name;
        let shading = self.pass(family, method, brdf, layout)?.cycles(family, TEXEL, 1);
        let prefilter = self.pass(family, "", brdf, layout)?;
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
