//! The data of the Live view: the tables of [`LIVE_FILE`], as far as they fit, and other inputs of
//! its shaders.

use super::page_run::PageRun;
use crate::base::files::read_regular;
use crate::base::glsl::constants;
use crate::base::glsl::source::{Choice, Language, METHOD_INCLUDE, PAGE_FOLDER, parse};
use crate::base::names::Listed;
use crate::experiment::axis::ENVIRONMENT_ORIENTATION;
use crate::experiment::value::Value;
use crate::instrument::brdf::MaskingShadowing;
use crate::instrument::environment::orientation;
use crate::instrument::gpu::shader_sources;
use crate::instrument::precompute::taps::TapCount;
use crate::instrument::scene::camera::PERSPECTIVE_FOV_DEG;
use crate::instrument::shade::bend::Bend;
use crate::instrument::shade::{METHODS, Method, Shading, from_file};
use crate::report::live::model::LiveModel;
use crate::report::live::record::{LIVE_FILE, LiveEnvironment, LiveLobe, LiveRecord, LiveShader};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Most bytes of base64 of the tables of a page.
pub const BUDGET_BYTES: usize = 4 << 20;
/// Texels below which an environment is not reduced to keep another one.
const ENVIRONMENT_TEXELS_MIN: u32 = 1 << 15;
const NO_LIGHTS: &str = "The direct lights of the run are not part of this view: it shows its \
                         scenes under the environment alone.";
const NO_OCCLUSION: &str = "Maps of occlusion are not part of this view: crevices are brighter \
                            than in the run.";
const FILE_BYTES_MAX: u64 = 64 << 20;

#[derive(Debug, Serialize)]
pub struct Light {
    pub environments: Vec<LiveEnvironment>,
    pub lobes: Vec<LiveLobe>,
    pub methods: Vec<LiveMethod>,
    /// The orientations of the runs' cells, else 0.
    pub orientations: Vec<Orientation>,
    /// Names of the maskings in the order of the shaders' constants.
    pub masking_names: Vec<&'static str>,
    /// Constants of the shaders, by name.
    pub codes: BTreeMap<&'static str, u32>,
    /// The constant of every bend, by name.
    pub bends: BTreeMap<&'static str, u32>,
    /// At least one, if there are environments.
    pub models: Vec<LiveModel>,
    /// Vertical field of view of the background of an orthographic camera.
    pub fov_deg: f64,
    pub alpha_min: f32,
    /// Missing parts and why, one sentence each.
    pub notes: Vec<String>,
    /// Of methods in files, by name.
    #[serde(skip)]
    pub shaders: BTreeMap<String, String>,
}

#[derive(Debug, Serialize)]
pub struct LiveMethod {
    pub name: String,
    pub title: String,
    pub is_sampled: bool,
    pub uses_bend: bool,
}

impl LiveMethod {
    fn new(name: &str, is_sampled: bool) -> Self {
        let method = Method::listed(name);
        Self {
            name: name.to_owned(),
            title: method.title.to_owned(),
            is_sampled,
            uses_bend: method.uses_bend,
        }
    }

    fn listed(method: &Method) -> Self {
        Self::new(method.name, method.uses_samples)
    }

    /// Split sums with tables in a record, in the order of the list.
    fn split_sums(record: Option<&LiveRecord>) -> Vec<Self> {
        let has_table = |count: TapCount| {
            record.is_some_and(|record| {
                record
                    .lobes
                    .iter()
                    .all(|lobe| lobe.tap_tables.contains_key(count.sampler()))
            })
        };
        METHODS
            .iter()
            .filter(|method| method.uses_prefiltered() && method.uses_dfg)
            .filter(|method| method.tap_table.is_none_or(has_table))
            .map(Self::listed)
            .collect()
    }

    /// Methods that filter their samples, in the order of the list.
    fn sampled() -> Vec<Self> {
        METHODS
            .iter()
            .filter(|method| method.uses_samples && method.uses_lod_bias)
            .map(Self::listed)
            .collect()
    }
}

/// The name of a shader in the page: `specular:cube:sampled:ggx`. All but meshes have only fragment
/// shaders.
pub fn page_name(permutation: &str) -> String {
    permutation
        .trim_start_matches(PAGE_FOLDER)
        .replace(".frag", "")
}

/// The page's shaders of a method in a file, by name; the error is the compiler's.
fn shaders_of_file(method: &LiveShader) -> Result<BTreeMap<String, String>, String> {
    let mut sources = shader_sources();
    sources.0.insert(method.name.clone(), method.text.clone());
    let entry = format!("{PAGE_FOLDER}specular.frag");
    let choice = Choice::from([(METHOD_INCLUDE.to_owned(), method.name.clone())]);
    let mut shaders = BTreeMap::new();
    for (permutation, choice) in sources.permutations(&entry, &choice)? {
        let text = sources.expand(&entry, &choice, Language::Es)?;
        parse(&entry, &text, Language::Es)?;
        let name = page_name(&from_file::shader_name(&permutation, &method.name));
        shaders.insert(name, text);
    }
    Ok(shaders)
}

/// An `environment_orientation` and the columns of its rotation matrix.
#[derive(Debug, Serialize)]
pub struct Orientation {
    pub k: u32,
    pub columns: [[f64; 3]; 3],
}

impl Orientation {
    fn all(runs: &[PageRun]) -> Vec<Self> {
        let mut orientations: BTreeSet<u32> = BTreeSet::new();
        for cell in runs.iter().flat_map(|run| &run.finished.cells) {
            if let Value::Count(k) = cell.point[ENVIRONMENT_ORIENTATION] {
                orientations.insert(k);
            }
        }
        if orientations.is_empty() {
            orientations.insert(0);
        }
        orientations
            .into_iter()
            .map(|k| Self {
                k,
                columns: orientation(k).to_cols_array_2d(),
            })
            .collect()
    }
}

/// The constants of anisotropy and layers: of each the first among the runs' cells that is not the
/// default.
fn codes(runs: &[PageRun]) -> BTreeMap<&'static str, u32> {
    let shadings: Vec<Shading> = runs
        .iter()
        .flat_map(|run| &run.finished.cells)
        .map(|cell| cell.point.settings().shading)
        .collect();
    let first = |code: fn(&Shading) -> u32| {
        let default = code(&Shading::default());
        let mut codes = shadings.iter().map(code);
        codes.find(|code| *code != default).unwrap_or(default)
    };
    BTreeMap::from([
        ("ANISOTROPY", first(|shading| shading.widths as u32)),
        (
            "SHEEN_LOOKUP",
            first(|shading| shading.sheen_lookup.plain().code()),
        ),
        (
            "SHEEN_VISIBILITY",
            first(|shading| shading.sheen_visibility as u32),
        ),
        (
            "coat_layering",
            first(|shading| shading.coat_layering as u32),
        ),
    ])
}

impl Light {
    /// The tables of the first run that has some, within `budget` bytes.
    pub fn collect(runs: &[PageRun], budget: usize) -> Self {
        let mut notes = Vec::new();
        let record = first_record(runs, &mut notes);
        if record.as_ref().is_some_and(|record| record.has_lights) {
            notes.push(NO_LIGHTS.to_owned());
        }
        if record.as_ref().is_some_and(|record| record.has_occlusion) {
            notes.push(NO_OCCLUSION.to_owned());
        }
        let mut methods = LiveMethod::split_sums(record.as_ref());
        let mut shaders = BTreeMap::new();
        for method in record.iter().flat_map(|record| &record.methods) {
            match shaders_of_file(method) {
                Ok(texts) => {
                    methods.push(LiveMethod::new(&method.name, method.is_sampled));
                    shaders.extend(texts);
                }
                Err(log) => notes.push(format!(
                    "{} does not compile for a browser: {}",
                    method.name,
                    log.trim()
                )),
            }
        }
        // The reference is the last method that takes samples.
        methods.extend(LiveMethod::sampled());
        let mut light = Self {
            environments: Vec::new(),
            lobes: Vec::new(),
            methods,
            shaders,
            orientations: Orientation::all(runs),
            masking_names: MaskingShadowing::names(),
            codes: codes(runs),
            bends: Bend::all().map(|bend| (bend.name, bend.code())).collect(),
            models: Vec::new(),
            fov_deg: PERSPECTIVE_FOV_DEG,
            alpha_min: constants::ALPHA_MIN,
            notes,
        };
        match record {
            Some(record) => light.fit(record, budget),
            None => light.notes.push(format!(
                "The folder of the run has no {LIVE_FILE}: the run was stopped early, or made by \
                 an older version."
            )),
        }
        light
    }

    /// Takes the tables; drops the finest levels of the largest environments, then whole
    /// environments, until all fits.
    fn fit(&mut self, record: LiveRecord, budget: usize) {
        self.environments = record.environments;
        self.lobes = record.lobes;
        self.models = record.models;
        self.notes.extend(
            self.models
                .iter()
                .map(|model| model.note.clone())
                .filter(|note| !note.is_empty()),
        );
        let mut left_out = record.left_out;
        while self.bytes() > budget {
            let reducible = self
                .environments
                .iter_mut()
                .filter(|e| e.levels[0].size.iter().product::<u32>() > ENVIRONMENT_TEXELS_MIN);
            if let Some(largest) = reducible.max_by_key(|e| e.levels[0].base64.len()) {
                largest.levels.remove(0);
            } else if self.environments.len() > 1 {
                self.environments.pop();
                left_out += 1;
            } else {
                break;
            }
        }
        if left_out > 0 {
            self.notes.push(format!(
                "{left_out} more environments of the run are not in this view."
            ));
        }
    }

    fn bytes(&self) -> usize {
        let maps = self.environments.iter().flat_map(|e| {
            e.levels
                .iter()
                .chain(e.prefiltered.iter().flat_map(|map| &map.levels))
        });
        let lobe_tables = self
            .lobes
            .iter()
            .flat_map(|lobe| lobe.tap_tables.values().chain([&lobe.dfg]));
        maps.chain(lobe_tables)
            .map(|image| image.base64.len())
            .sum()
    }
}

/// The record of the first run that has one.
fn first_record(runs: &[PageRun], notes: &mut Vec<String>) -> Option<LiveRecord> {
    for run in runs {
        match read(run) {
            Ok(Some(record)) => {
                if runs.len() > 1 {
                    notes.push(format!(
                        "Light and tables come from {}.",
                        run.finished.dir.display()
                    ));
                }
                return Some(record);
            }
            Ok(None) => {}
            Err(note) => notes.push(note),
        }
    }
    None
}

/// The record of a run; `None` if it has none.
fn read(run: &PageRun) -> Result<Option<LiveRecord>, String> {
    let path = run.finished.dir.join(LIVE_FILE);
    let text = match read_regular(&path, FILE_BYTES_MAX) {
        Ok(text) => text,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(format!("{}: {error}", path.display())),
    };
    let record: LiveRecord = serde_json::from_slice(&text).map_err(|error| {
        format!(
            "{}: {error}; delete it and run the experiment again",
            path.display()
        )
    })?;
    let is_whole = |e: &LiveEnvironment| !e.levels.is_empty() && !e.prefiltered.is_empty();
    if record.lobes.is_empty()
        || record.environments.is_empty()
        || record.models.is_empty()
        || !record.environments.iter().all(is_whole)
    {
        return Err(format!(
            "{}: lacks tables or models; delete it and run the experiment again",
            path.display()
        ));
    }
    Ok(Some(record))
}
