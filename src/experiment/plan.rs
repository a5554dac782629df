//! The validated experiment: every cell with its id, work shared between cells, and exclusions.
//!
//! Long because the cells, what they share and the requests that render them come from one expansion.

use super::axis::{
    AXES, AxisId, BLUR, DFG_TABLE, ENVIRONMENT, FRAMES, METHOD, PREFILTERED, Point, Points, SCENE,
    SIZE, View, is_blurred,
};
use super::checks;
use super::config::{Config, UNSCORED};
use super::fault::{ConfigError, Faults, Location};
use super::id::Id;
use super::inputs::Inputs;
use super::sweeps::COMBINATIONS_MAX;
use super::value::Value;
use crate::base::names::Listed;
use crate::base::numbers::short_number;
use crate::instrument::environment::LoadOptions;
use crate::instrument::pipeline::{BUFFER_BYTES_EVERYWHERE, RenderRequest, image_buffer_bytes};
use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};

/// Counts up if the meaning of a cell changes, so that old records are not reused.
pub const SCHEMA_VERSION: u32 = 1;
/// Largest product of combinations and excluded values: a few seconds.
const COMPARISONS_MAX: u64 = 200_000_000;
/// Gives a reference under test other points than the reference that judges it.
const UNDER_TEST: u32 = 0x5eed_7e57;

/// One row of the results.
#[derive(Clone, Debug)]
pub struct Cell {
    /// Hash of everything that determines the cell's scores.
    pub id: Id,
    /// Collapsed ([`Point::collapsed`]).
    pub point: Point,
    /// Id of the radiance image, which cells that differ only in the tone curve share.
    pub radiance: Id,
    /// Id of the reference's radiance image; `None` if the experiment has no references.
    pub reference: Option<Id>,
}

#[derive(Debug)]
pub struct Plan {
    pub config: Config,
    pub inputs: Inputs,
    /// Indices of axes in column order: axes of the file, then the rest.
    pub columns: Vec<AxisId>,
    /// In the order of the axes, the last one fastest.
    pub cells: Vec<Cell>,
    /// Combinations that each exclusion left out.
    pub excluded: Vec<usize>,
    /// Combinations that differ from an earlier one only in unused parameters.
    pub collapsed: usize,
    /// Name of each environment in tables.
    pub environment_names: BTreeMap<String, String>,
    /// Hash of name, cells and timing.
    pub hash: String,
}

/// Cells that share a reference, in running order. Without references, cells that share an image.
#[derive(Debug)]
pub struct ReferenceGroup<'p> {
    /// Id of the reference's radiance image.
    pub reference: Option<Id>,
    pub radiances: Vec<RadianceGroup<'p>>,
}

/// Cells that share an image before its tone curve.
#[derive(Debug)]
pub struct RadianceGroup<'p> {
    pub id: Id,
    pub cells: Vec<&'p Cell>,
}

impl<'p> ReferenceGroup<'p> {
    pub fn cells(&self) -> impl Iterator<Item = &'p Cell> + Clone {
        self.radiances
            .iter()
            .flat_map(|radiance| radiance.cells.iter().copied())
    }
}

/// An experiment's text and where its paths start.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    pub path: &'a Path,
    pub text: &'a str,
    pub overrides: &'a [String],
    /// Folder of paths in the text, if it is not the file's folder.
    pub file_dir: Option<&'a Path>,
    /// Folder of paths in `overrides`; the current one if empty.
    pub set_dir: &'a Path,
    /// Checks the questions, if every value can be read.
    pub check: Check,
}

pub type Check = fn(&Config, &mut Faults);

impl<'a> Source<'a> {
    /// A text whose paths start at the file's folder and at the current one, with unchecked
    /// questions.
    pub fn new(path: &'a Path, text: &'a str, overrides: &'a [String]) -> Self {
        Self {
            path,
            text,
            overrides,
            file_dir: None,
            set_dir: Path::new(""),
            check: |_, _| {},
        }
    }
}

impl Plan {
    /// Checks and expands the experiment at `path` with `--set` texts.
    pub fn from_text(path: &Path, text: &str, overrides: &[String]) -> Result<Self, ConfigError> {
        Self::from_source(&Source::new(path, text, overrides), &LoadOptions::default())
    }

    pub fn from_source(source: &Source, options: &LoadOptions) -> Result<Self, ConfigError> {
        let Source {
            path,
            text,
            overrides,
            file_dir,
            set_dir,
            check,
        } = *source;
        let mut faults = Faults::new(path, text);
        let mut config = Config::parse(path, text, overrides, &mut faults);
        config.file_dir = file_dir.map(PathBuf::from);
        config.set_dir = set_dir.to_owned();
        let is_read = faults.is_empty();
        let inputs = Inputs::load(&config, options, &mut faults);
        if is_read {
            check(&config, &mut faults);
        }
        let combinations = config.combination_count();
        let excluding: usize = config
            .exclusions
            .iter()
            .flat_map(|exclusion| &exclusion.conditions)
            .map(|condition| condition.values.len())
            .sum();
        if combinations > COMBINATIONS_MAX {
            faults.add(
                &Location::File(0),
                format!("axes: {combinations} combinations; at most {COMBINATIONS_MAX}"),
            );
        } else if combinations.saturating_mul(excluding as u64) > COMPARISONS_MAX {
            let text = format!(
                "exclude: {combinations} combinations times {excluding} excluded values; the \
                 product may be at most {COMPARISONS_MAX}"
            );
            faults.add(&config.exclusions[0].location, text);
        } else {
            checks::check_combinations(&config, &mut faults);
        }
        checks::check_unscored(&config, &mut faults);
        checks::check_recovery(&config, &mut faults);
        checks::check_frames(&config, &mut faults);
        checks::check_lights(&config, &inputs, &mut faults);
        checks::check_sizes(&config, &mut faults);
        checks::check_exclusions(&config, &mut faults);
        faults.into_result()?;
        Ok(Self::expanded(config, inputs))
    }

    /// Groups cells so that each reference and radiance is rendered once and only one reference is
    /// in memory.
    pub fn groups(&self) -> Vec<ReferenceGroup<'_>> {
        let mut groups: Vec<ReferenceGroup> = Vec::new();
        let mut group_of: BTreeMap<Id, usize> = BTreeMap::new();
        let mut radiance_of: BTreeMap<(usize, Id), usize> = BTreeMap::new();
        for cell in &self.cells {
            let reference = cell.reference;
            let shared = reference.unwrap_or(cell.radiance);
            let group = *group_of.entry(shared).or_insert_with(|| {
                groups.push(ReferenceGroup {
                    reference,
                    radiances: Vec::new(),
                });
                groups.len() - 1
            });
            let radiances = &mut groups[group].radiances;
            let radiance = *radiance_of
                .entry((group, cell.radiance))
                .or_insert_with(|| {
                    radiances.push(RadianceGroup {
                        id: cell.radiance,
                        cells: Vec::new(),
                    });
                    radiances.len() - 1
                });
            radiances[radiance].cells.push(cell);
        }
        for radiance in groups.iter_mut().flat_map(|group| &mut group.radiances) {
            radiance.cells.shrink_to_fit();
        }
        groups
    }

    /// Returns the point of the reference that would judge a cell.
    pub fn reference_point(&self, point: &Point) -> Point {
        point.reference(&self.config.reference)
    }

    /// Returns the point of the reference that judges a cell; `None` without references.
    pub fn judge_of(&self, cell: &Cell) -> Option<Point> {
        cell.reference.map(|_| self.reference_point(&cell.point))
    }

    /// Lists name and value of every axis of a cell, in column order.
    pub fn columns_of<'c>(&self, cell: &'c Cell) -> Vec<(&'static str, &'c Value)> {
        self.columns
            .iter()
            .map(|&axis| (AXES[axis].name, &cell.point[axis]))
            .collect()
    }

    /// Labels a cell by its values on swept axes: `alpha=0.25 samples=4`.
    pub fn label(&self, cell: &Cell) -> String {
        let words = self
            .swept()
            .map(|axis| (self.config.named(axis), &cell.point[axis]));
        let set = words.filter(|(_, value)| **value != Value::Unset);
        let words = set.map(|(named, value)| {
            let value = named.shown(value).to_string();
            format!("{}={}", named.name(), short_number(&value))
        });
        words.collect::<Vec<_>>().join(" ")
    }

    /// Returns a cell's value as tables print it: environments by their short names.
    pub fn shown(&self, cell: &Cell, axis: AxisId) -> Value {
        let name = match &cell.point[axis] {
            Value::Text(text) if axis == ENVIRONMENT => self.environment_names.get(text.as_str()),
            _ => None,
        };
        name.map_or_else(
            || cell.point[axis].clone(),
            |name| Value::from(name.as_str()),
        )
    }

    /// Whether direct lights of the experiment or of a scene's file light some cell.
    pub fn has_lights(&self) -> bool {
        let mut scenes = self.inputs.scenes();
        !self.config.lights.is_empty() || scenes.any(|scene| !scene.lights.is_empty())
    }

    pub fn has_occlusion(&self) -> bool {
        self.inputs.scenes().any(|scene| scene.has_occlusion())
    }

    /// Builds the request of a cell's point.
    pub fn request(&self, point: &Point) -> RenderRequest {
        let request = self.seeded_request(point, self.cell_seed(point));
        RenderRequest {
            reference_error: self.cell_error(point),
            ..request
        }
    }

    /// Builds the request of a reference's point ([`Plan::reference_point`]) with all samples.
    pub fn reference_request(&self, point: &Point) -> RenderRequest {
        self.seeded_request(point, self.config.seed)
    }

    /// Builds the request of a reference's point with `samples` a pixel, one of
    /// [`Reference::rounds`](super::axis::Reference::rounds). An experiment with this count as its
    /// `samples` makes the same one.
    pub fn reference_round(&self, point: &Point, samples: u32) -> RenderRequest {
        let mut request = self.reference_request(point);
        request.reference_samples = samples;
        if request.shading.method.is_integrated() {
            request.shading.samples = samples;
        }
        request
    }

    /// Builds the request of a reference's point with the fewest samples that it may have: if a cache
    /// lacks it, it lacks the others.
    pub fn least_reference(&self, point: &Point) -> RenderRequest {
        self.reference_round(point, self.reference_counts(point)[0])
    }

    /// Lists the sample counts that the reference of a point may have, ascending. There is one for
    /// exact references and for images without a reference term.
    pub fn reference_counts(&self, point: &Point) -> Vec<u32> {
        let reference = &self.config.reference;
        let has_noise = point.method().is_integrated() || point.diffuse().is_integrated();
        match reference.noise_share().filter(|_| has_noise) {
            Some(_) => reference.rounds(),
            None => vec![reference.samples],
        }
    }

    fn seeded_request(&self, point: &Point, seed: u32) -> RenderRequest {
        let settings = point.settings();
        let environment = self.inputs.environment(&settings.environment).clone();
        let scene = self.inputs.scene(&settings.scene);
        let view = View {
            camera: self.config.camera,
            orbit: self.config.orbit,
            background: self.config.background,
            lights: self.config.lights.clone(),
            antialias: self.config.antialias,
            seed,
            reference_samples: self.config.reference.samples,
            reference_error: self.config.reference.relative_error,
        };
        let given = self.inputs.given(&settings);
        settings.request(&environment, scene, &view, given)
    }

    /// Returns one point for each combination of sizes and inputs, references included.
    pub fn points_by_size(&self) -> Vec<Point> {
        let mut known = HashSet::new();
        let points = self
            .cells
            .iter()
            .flat_map(|cell| [Some(cell.point.clone()), self.judge_of(cell)])
            .flatten();
        let key = |point: &Point| {
            let sizes = AXES
                .iter()
                .zip(point.values())
                .filter(|(axis, _)| axis.needs_memory);
            sizes.map(|(_, value)| value.clone()).collect::<Vec<_>>()
        };
        points.filter(|point| known.insert(key(point))).collect()
    }

    /// Returns the samples for the steps of a point's error; only some terms have steps, and only
    /// on the scene `design`.
    pub fn ladder_of(&self, point: &Point) -> Option<u32> {
        let has_steps = point.method().has_ladder;
        self.config
            .ladder
            .filter(|_| has_steps && self.inputs.scene(point[SCENE].text()).is_design)
    }

    pub fn size_of(&self, cell: &Cell) -> [u32; 2] {
        cell.point[SIZE].pair()
    }

    /// Lists the axes of the file with more than one value.
    pub fn swept(&self) -> impl Iterator<Item = AxisId> + '_ {
        self.config
            .axes
            .iter()
            .filter(|sweep| sweep.values.len() > 1)
            .map(|sweep| sweep.axis)
    }

    /// Lists likely mistakes with their places: idle exclusions and sweeps, black metals, ignored
    /// keys, very large images.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Faults::new(&self.config.path, &self.config.text);
        // `--set` may have removed the values that an exclusion matches.
        let may_be_idle = !self.config.overrides.is_empty();
        for (exclusion, count) in self.config.exclusions.iter().zip(&self.excluded) {
            if *count == 0 && !may_be_idle {
                warnings.add(
                    &exclusion.location,
                    format!("the exclusion {:?} matches no combination", exclusion.why),
                );
            }
        }
        let points = || self.cells.iter().map(|cell| &cell.point);
        let idle = checks::idle_sweeps(&self.config, points()).into_iter();
        let black = checks::black_metals(&self.config, &self.inputs, points());
        for (location, text) in idle.chain(black) {
            warnings.add(&location, text);
        }
        let mut sequences = points()
            .filter(|point| ![Value::Unset, Value::Count(1)].contains(&point[FRAMES]))
            .peekable();
        if sequences.peek().is_some()
            && sequences.all(|point| is_blurred(point) || !point.method().uses_lod_bias)
        {
            warnings.add(&Location::File(0), BLUR);
        }
        if !self.config.orbit.is_still() && self.inputs.scenes().any(|scene| scene.is_design) {
            let text = "orbit: has no effect on the scene design";
            warnings.add(&Location::File(0), text);
        }
        if self.config.background && self.inputs.scenes().all(|scene| scene.is_design) {
            warnings.add(&Location::File(0), "background: the scene design has none");
        }
        for (location, [width, height]) in checks::sizes(&self.config) {
            let bytes = image_buffer_bytes([width, height]);
            if bytes > BUFFER_BYTES_EVERYWHERE {
                let text = format!(
                    "size: {width}x{height} needs a buffer of {} MiB; some devices allow only {}",
                    bytes >> 20,
                    BUFFER_BYTES_EVERYWHERE >> 20
                );
                warnings.add(&location, text);
            }
        }
        warnings
            .into_result()
            .err()
            .map_or_else(Vec::new, |error| error.lines())
    }

    fn expanded(config: Config, inputs: Inputs) -> Self {
        let mut columns: Vec<AxisId> = config.axes.iter().map(|sweep| sweep.axis).collect();
        columns.extend(
            AXES.ids()
                .filter(|&axis| !AXES[axis].is_layer && config.sweep(axis).is_none()),
        );
        let mut plan = Self {
            columns,
            cells: Vec::new(),
            excluded: vec![0; config.exclusions.len()],
            collapsed: 0,
            environment_names: config.environment_names(),
            hash: String::new(),
            config,
            inputs,
        };
        let mut known = HashSet::new();
        let mut points = Points::default();
        let mut cells = Vec::new();
        for point in plan.config.combinations() {
            if let Some(index) = plan.config.exclusion_of(&point) {
                plan.excluded[index] += 1;
                continue;
            }
            let reference = plan.config.is_scored.then(|| {
                plan.radiance_id(
                    &plan.reference_point(&point),
                    plan.config.seed,
                    plan.reference_stop(),
                )
            });
            let point = point.collapsed();
            let stop = plan.cell_error(&point).map(stop_at_error);
            let radiance = plan.radiance_id(&point, plan.cell_seed(&point), stop);
            let id = cell_id(radiance, reference, &point, plan.ladder_of(&point));
            if known.insert(id) {
                cells.push(Cell {
                    id,
                    point: points.shared(&point),
                    radiance,
                    reference,
                });
            } else {
                plan.collapsed += 1;
            }
        }
        plan.cells = cells;
        plan.hash = plan.identity().to_string();
        plan
    }

    /// Returns the hash of what a run of the plan measures: its cells, and what is done with them.
    fn identity(&self) -> Id {
        let mut lines = vec![
            format!("name={}", self.config.name),
            format!("timing={:?}", self.config.timing),
        ];
        if let Some(losses) = &self.config.recovery {
            lines.push(format!("recovery={losses:?}"));
        }
        lines.extend(self.cells.iter().map(|cell| cell.id.to_string()));
        Id::of_lines(&lines)
    }

    /// Returns the seed of a cell. A reference under test must not share points with the reference
    /// that judges it.
    fn cell_seed(&self, point: &Point) -> u32 {
        if point.method().is_integrated() {
            self.config.seed ^ UNDER_TEST
        } else {
            self.config.seed
        }
    }

    /// Returns the target error of a cell's references. A reference under test draws exactly the
    /// samples of its row.
    fn cell_error(&self, point: &Point) -> Option<f64> {
        self.config
            .reference
            .relative_error
            .filter(|_| !point.method().is_integrated())
    }

    /// Returns the rule by which references stop before their last sample, for their ids.
    fn reference_stop(&self) -> Option<String> {
        let reference = &self.config.reference;
        let by_share = reference
            .noise_share()
            .map(|share| format!("noise_share={share}"));
        reference.relative_error.map(stop_at_error).or(by_share)
    }

    /// Hashes inputs by content, so a renamed file keeps its cells and a changed one does not. `stop`
    /// is the rule by which reference terms stop early.
    fn radiance_id(&self, point: &Point, seed: u32, stop: Option<String>) -> Id {
        let Self { config, inputs, .. } = self;
        let mut lines = vec![
            format!("schema={SCHEMA_VERSION}"),
            format!("shaders={}", crate::instrument::gpu::build_hash()),
            format!("seed={seed}"),
            format!("camera={}", config.camera.name()),
            format!("background={}", config.background),
        ];
        if config.antialias && !inputs.scene(point[SCENE].text()).is_design {
            lines.push("antialias=true".to_owned());
        }
        if !config.lights.is_empty() {
            lines.push(format!("lights={:?}", config.lights));
        }
        if !config.orbit.is_still() {
            lines.push(format!("orbit={:?}", config.orbit));
        }
        let is_specular_exact = point.method().is_integrated();
        let is_diffuse_exact = point.diffuse().is_integrated();
        if is_diffuse_exact && !is_specular_exact {
            lines.push(format!("reference_samples={}", config.reference.samples));
        }
        lines.extend(stop.filter(|_| is_specular_exact || is_diffuse_exact));
        let given = inputs.given(&point.settings());
        for (id, axis) in AXES.entries().filter(|(_, axis)| axis.changes_radiance()) {
            let value = &point[id];
            // Layers came later: without one, ids are what they were.
            if axis.is_layer && [&Value::Unset, &(axis.default)()].contains(&value) {
                continue;
            }
            let content = match id {
                ENVIRONMENT => inputs.environment(value.text()).hash.clone(),
                SCENE => inputs.scene(value.text()).hash.clone(),
                METHOD => point
                    .method()
                    .shader
                    .unwrap_or(point.method().name)
                    .to_owned(),
                PREFILTERED => given
                    .prefiltered
                    .as_ref()
                    .map_or(value.to_string(), |map| map.hash.clone()),
                DFG_TABLE => given
                    .dfg
                    .as_ref()
                    .map_or(value.to_string(), |table| table.hash.clone()),
                _ => value.to_string(),
            };
            lines.push(format!("{}={content}", axis.name));
        }
        Id::of_lines(&lines)
    }
}

/// The rule of references that stop at a relative error, for ids.
fn stop_at_error(error: f64) -> String {
    format!("reference_error={error}")
}

fn cell_id(radiance: Id, reference: Option<Id>, point: &Point, ladder: Option<u32>) -> Id {
    let reference = reference.map_or_else(|| UNSCORED.to_owned(), |id| id.to_string());
    let mut lines = vec![
        format!("radiance={radiance}"),
        format!("reference={reference}"),
    ];
    lines.extend(ladder.map(|samples| format!("ladder={samples}")));
    let display = AXES
        .iter()
        .zip(point.values())
        .filter(|(axis, _)| !axis.changes_radiance());
    lines.extend(display.map(|(axis, value)| format!("{}={value}", axis.name)));
    Id::of_lines(&lines)
}
