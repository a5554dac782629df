//! The validated experiment: every cell with its id, work shared between cells, and exclusions.

use super::axis::{
    AXES, AxisId, BLUR, DFG_TABLE, ENVIRONMENT, FRAMES, METHOD, PREFILTERED, Point, SCENE, SIZE,
    View, is_blurred,
};
use super::checks;
use super::config::Config;
use super::fault::{ConfigError, Faults, Place};
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
/// Hex digits of an id: 64 bits, so a million cells collide with probability 3e-8.
const ID_LENGTH: usize = 16;
/// Gives a reference under test other points than the reference that judges it.
const UNDER_TEST: u32 = 0x5eed_7e57;

/// One row of the results.
#[derive(Clone, Debug)]
pub struct Cell {
    /// Hash of everything that determines the cell's scores.
    pub id: String,
    /// Collapsed ([`Point::collapsed`]).
    pub point: Point,
    /// Id of the radiance image, which cells that differ only in the tone curve share.
    pub radiance: String,
    /// Id of the reference's radiance image.
    pub reference: String,
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

/// Cells that share a reference, in running order.
#[derive(Debug)]
pub struct ReferenceGroup<'p> {
    pub id: &'p str,
    /// Id of each radiance, and the cells that share it.
    pub radiances: Vec<(&'p str, Vec<&'p Cell>)>,
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
        (config.file_dir, config.set_dir) = (file_dir.map(PathBuf::from), set_dir.to_owned());
        let is_read = faults.is_empty();
        let inputs = Inputs::load(&config, options, &mut faults);
        if is_read {
            check(&config, &mut faults);
        }
        let combinations = config.combination_count();
        let excluding: usize = config
            .exclusions
            .iter()
            .flat_map(|e| &e.conditions)
            .map(|(_, values)| values.len())
            .sum();
        if combinations > COMBINATIONS_MAX {
            faults.add(
                &Place::File(0),
                format!("axes: {combinations} combinations; at most {COMBINATIONS_MAX}"),
            );
        } else if combinations.saturating_mul(excluding as u64) > COMPARISONS_MAX {
            let text = format!(
                "exclude: {combinations} combinations times {excluding} excluded values; the \
                 product may be at most {COMPARISONS_MAX}"
            );
            faults.add(&config.exclusions[0].place, text);
        } else {
            checks::check_combinations(&config, &mut faults);
        }
        checks::check_frames(&config, &mut faults);
        checks::check_sizes(&config, &mut faults);
        checks::check_exclusions(&config, &mut faults);
        faults.into_result()?;
        Ok(Self::expanded(config, inputs))
    }

    /// Groups cells so that each reference and radiance is rendered once and only one reference is
    /// in memory.
    pub fn groups(&self) -> Vec<ReferenceGroup<'_>> {
        let mut groups: Vec<ReferenceGroup> = Vec::new();
        let mut group_of: BTreeMap<&str, usize> = BTreeMap::new();
        let mut radiance_of: BTreeMap<(usize, &str), usize> = BTreeMap::new();
        for cell in &self.cells {
            let group = *group_of.entry(&cell.reference).or_insert_with(|| {
                groups.push(ReferenceGroup {
                    id: &cell.reference,
                    radiances: Vec::new(),
                });
                groups.len() - 1
            });
            let radiances = &mut groups[group].radiances;
            let radiance = *radiance_of
                .entry((group, &cell.radiance))
                .or_insert_with(|| {
                    radiances.push((&cell.radiance, Vec::new()));
                    radiances.len() - 1
                });
            radiances[radiance].1.push(cell);
        }
        groups
    }

    /// Returns the point of the reference that judges a cell.
    pub fn reference_point(&self, point: &Point) -> Point {
        point.reference(&self.config.reference)
    }

    /// Lists name and value of every axis of a cell, in column order.
    pub fn columns_of<'c>(&self, cell: &'c Cell) -> Vec<(&'static str, &'c Value)> {
        self.columns
            .iter()
            .map(|&axis| (AXES[axis].name, &cell.point.0[axis]))
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

    /// Builds the request of a cell's point.
    pub fn request(&self, point: &Point) -> RenderRequest {
        let request = self.seeded_request(point, self.cell_seed(point));
        RenderRequest {
            reference_error: self.cell_error(point),
            ..request
        }
    }

    /// Builds the request of a reference's point ([`Plan::reference_point`]).
    pub fn reference_request(&self, point: &Point) -> RenderRequest {
        self.seeded_request(point, self.config.seed)
    }

    fn seeded_request(&self, point: &Point, seed: u32) -> RenderRequest {
        let settings = point.settings();
        let environment = self.inputs.environment(&settings.environment).clone();
        let scene = self.inputs.scene(&settings.scene);
        let view = View {
            camera: self.config.camera,
            orbit: self.config.orbit,
            background: self.config.background,
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
        let mut seen = HashSet::new();
        let points = self
            .cells
            .iter()
            .flat_map(|cell| [cell.point.clone(), self.reference_point(&cell.point)]);
        let key = |point: &Point| {
            let sizes = AXES
                .iter()
                .zip(&point.0)
                .filter(|(axis, _)| axis.needs_memory);
            sizes.map(|(_, value)| value.clone()).collect::<Vec<_>>()
        };
        points.filter(|point| seen.insert(key(point))).collect()
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
        let is_idle = |count: &usize| *count == 0 && self.config.overrides.is_empty();
        for (exclusion, _) in self
            .config
            .exclusions
            .iter()
            .zip(&self.excluded)
            .filter(|(_, count)| is_idle(count))
        {
            warnings.add(
                &exclusion.place,
                format!("the exclusion {:?} matches no combination", exclusion.why),
            );
        }
        let points = || self.cells.iter().map(|cell| &cell.point);
        let idle = checks::idle_sweeps(&self.config, points()).into_iter();
        for (place, text) in idle.chain(checks::black_metals(&self.config, &self.inputs, points()))
        {
            warnings.add(&place, text);
        }
        let mut sequences = points()
            .filter(|point| ![Value::Unset, Value::Count(1)].contains(&point[FRAMES]))
            .peekable();
        if sequences.peek().is_some()
            && sequences.all(|point| is_blurred(point) || !point.method().uses_lod_bias)
        {
            warnings.add(&Place::File(0), BLUR);
        }
        if !self.config.orbit.is_still() && self.inputs.scenes().any(|scene| scene.is_design) {
            warnings.add(&Place::File(0), "orbit: has no effect on the scene design");
        }
        if self.config.background && self.inputs.scenes().all(|scene| scene.is_design) {
            warnings.add(&Place::File(0), "background: the scene design has none");
        }
        for (place, [width, height]) in checks::sizes(&self.config) {
            let bytes = image_buffer_bytes([width, height]);
            if bytes > BUFFER_BYTES_EVERYWHERE {
                let text = format!(
                    "size: {width}x{height} needs a buffer of {} MiB; some devices allow only {}",
                    bytes >> 20,
                    BUFFER_BYTES_EVERYWHERE >> 20
                );
                warnings.add(&place, text);
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
        let mut seen = HashSet::new();
        let mut cells = Vec::new();
        for point in plan.config.combinations() {
            if let Some(index) = plan.config.exclusion_of(&point) {
                plan.excluded[index] += 1;
                continue;
            }
            let judge = plan.reference_point(&point);
            let reference = plan.radiance_id(
                &judge,
                plan.config.seed,
                plan.config.reference.relative_error,
            );
            let point = point.collapsed();
            let radiance =
                plan.radiance_id(&point, plan.cell_seed(&point), plan.cell_error(&point));
            let id = cell_id(&radiance, &reference, &point, plan.ladder_of(&point));
            if seen.insert(id.clone()) {
                cells.push(Cell {
                    id,
                    point,
                    radiance,
                    reference,
                });
            } else {
                plan.collapsed += 1;
            }
        }
        plan.cells = cells;
        let mut identity = vec![
            format!("name={}", plan.config.name),
            format!("timing={:?}", plan.config.timing),
        ];
        identity.extend(plan.cells.iter().map(|cell| cell.id.clone()));
        plan.hash = hash_lines(&identity);
        plan
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

    /// Hashes inputs by content, so a renamed file keeps its cells and a changed one does not.
    fn radiance_id(&self, point: &Point, seed: u32, relative_error: Option<f64>) -> String {
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
        if !config.orbit.is_still() {
            lines.push(format!("orbit={:?}", config.orbit));
        }
        let [is_specular, is_diffuse] = [
            point.method().is_integrated(),
            point.diffuse().is_integrated(),
        ];
        if is_diffuse && !is_specular {
            lines.push(format!("reference_samples={}", config.reference.samples));
        }
        if let (Some(error), true) = (relative_error, is_specular || is_diffuse) {
            lines.push(format!("reference_error={error}"));
        }
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
        hash_lines(&lines)
    }
}

fn cell_id(radiance: &str, reference: &str, point: &Point, ladder: Option<u32>) -> String {
    let mut lines = vec![
        format!("radiance={radiance}"),
        format!("reference={reference}"),
    ];
    lines.extend(ladder.map(|samples| format!("ladder={samples}")));
    let display = AXES
        .iter()
        .zip(&point.0)
        .filter(|(axis, _)| !axis.changes_radiance());
    lines.extend(display.map(|(axis, value)| format!("{}={value}", axis.name)));
    hash_lines(&lines)
}

fn hash_lines(lines: &[String]) -> String {
    blake3::hash(lines.join("\n").as_bytes()).to_hex()[..ID_LENGTH].to_owned()
}
