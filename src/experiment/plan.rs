//! The validated experiment: every cell with its id, what it shares with others, and what was left out.

use super::axis::{AXES, DFG_TABLE, ENVIRONMENT, METHOD, PREFILTERED, Point, SCENE, SIZE, View};
use super::checks;
use super::config::{Config, Exclusion};
use super::fault::{ConfigError, Faults, Place};
use super::inputs::Inputs;
use super::sweeps::COMBINATIONS_MAX;
use super::value::Value;
use crate::environment::LoadOptions;
use crate::ladder;
use crate::pipeline::{BUFFER_BYTES_EVERYWHERE, RenderRequest, image_buffer_bytes};
use crate::spelling::Listed;
use crate::spelling::short_number;
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::{Path, PathBuf};

/// Counts up whenever the meaning of a cell changes, so that old records are not taken for new ones.
pub const SCHEMA_VERSION: u32 = 1;
/// Above this many comparisons of combinations with values of exclusions, too: a few seconds.
const COMPARISONS_MAX: u64 = 200_000_000;
/// Hex digits of an id: 64 bits, so that a million cells collide with probability 3e-8.
const ID_LENGTH: usize = 16;
/// Turns the seed of the judging reference into that of a reference under test.
const UNDER_TEST: u32 = 0x5eed_7e57;

/// One row of the results.
#[derive(Clone, Debug)]
pub struct Cell {
    /// Hash of everything that determines the cell's scores; never of its position.
    pub id: String,
    /// Unused parameters are unset.
    pub point: Point,
    /// Id of the radiance image: cells that differ in the tone curve only share it.
    pub radiance: String,
    /// Id of the radiance image of the reference.
    pub reference: String,
}

/// A checked experiment. Later code trusts it.
#[derive(Debug)]
pub struct Plan {
    pub config: Config,
    pub inputs: Inputs,
    /// Axis indices in column order: those of the file, then the rest.
    pub columns: Vec<usize>,
    /// In the order of the axes, the last one fastest.
    pub cells: Vec<Cell>,
    /// Combinations each exclusion left out, in the order of the file.
    pub excluded: Vec<usize>,
    /// Combinations that equal an earlier one because they differ in unused parameters only.
    pub collapsed: usize,
    /// The name of each environment in tables.
    pub environment_names: BTreeMap<String, String>,
    /// Hash over name, cells and timing: two plans with the same hash are the same experiment.
    pub hash: String,
}

/// Cells that share a reference, in running order.
#[derive(Debug)]
pub struct ReferenceGroup<'p> {
    /// Id of the reference's radiance.
    pub id: &'p str,
    /// Each with the id of its radiance and the cells that share it.
    pub radiances: Vec<(&'p str, Vec<&'p Cell>)>,
}

/// An experiment's text and what it hangs on.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// The file that the text stands for.
    pub path: &'a Path,
    pub text: &'a str,
    /// The texts of `--set`.
    pub overrides: &'a [String],
    /// The folder that paths in the text are relative to, where not that of the file.
    pub file_dir: Option<&'a Path>,
    /// The folder that paths in `overrides` are relative to; the current one when empty.
    pub set_dir: &'a Path,
}

impl Plan {
    /// Checks and expands an experiment whose text stands for the file at `path`; `overrides` are the texts of `--set`.
    pub fn from_text(path: &Path, text: &str, overrides: &[String]) -> Result<Self, ConfigError> {
        let source = Source { path, text, overrides, file_dir: None, set_dir: Path::new("") };
        Self::from_source(&source, &LoadOptions::default())
    }

    /// Checks and expands an experiment, with a say in what environments may hold.
    pub fn from_source(source: &Source, options: &LoadOptions) -> Result<Self, ConfigError> {
        let Source { path, text, overrides, file_dir, set_dir } = *source;
        let mut faults = Faults::new(path, text);
        let mut config = Config::parse(path, text, overrides, &mut faults);
        (config.file_dir, config.set_dir) = (file_dir.map(PathBuf::from), set_dir.to_owned());
        let inputs = Inputs::load(&config, options, &mut faults);
        let combinations = config.combination_count();
        let excluding: usize =
            config.exclusions.iter().flat_map(|e| &e.conditions).map(|(_, values)| values.len()).sum();
        if combinations > COMBINATIONS_MAX {
            faults.add(&Place::File(0), format!("axes: {combinations} combinations; at most {COMBINATIONS_MAX}"));
        } else if combinations.saturating_mul(excluding as u64) > COMPARISONS_MAX {
            let text = format!(
                "exclude: {combinations} combinations and {excluding} values of exclusions; their product may be {COMPARISONS_MAX} at most"
            );
            faults.add(&config.exclusions[0].place, text);
        } else {
            checks::check_combinations(&config, &mut faults);
        }
        checks::check_sizes(&config, &mut faults);
        checks::check_lights(&config, &inputs, &mut faults);
        checks::check_exclusions(&config, &mut faults);
        faults.into_result()?;
        Ok(expand(config, inputs))
    }

    /// Cells grouped so that each reference and each radiance is rendered once and only one reference is held at a time.
    pub fn groups(&self) -> Vec<ReferenceGroup<'_>> {
        let mut groups: Vec<ReferenceGroup> = Vec::new();
        let mut group_of: BTreeMap<&str, usize> = BTreeMap::new();
        let mut radiance_of: BTreeMap<(usize, &str), usize> = BTreeMap::new();
        for cell in &self.cells {
            let group = *group_of.entry(&cell.reference).or_insert_with(|| {
                groups.push(ReferenceGroup { id: &cell.reference, radiances: Vec::new() });
                groups.len() - 1
            });
            let radiances = &mut groups[group].radiances;
            let radiance = *radiance_of.entry((group, &cell.radiance)).or_insert_with(|| {
                radiances.push((&cell.radiance, Vec::new()));
                radiances.len() - 1
            });
            radiances[radiance].1.push(cell);
        }
        groups
    }

    /// The point of the reference that judges a cell of this point.
    pub fn reference_point(&self, point: &Point) -> Point {
        point.reference(&self.config.reference, !self.config.lights.is_empty())
    }

    /// Name and value of every axis of a cell, in column order.
    pub fn columns_of<'c>(&self, cell: &'c Cell) -> Vec<(&'static str, &'c Value)> {
        self.columns.iter().map(|&axis| (AXES[axis].name, &cell.point.0[axis])).collect()
    }

    /// A label that tells the cell from the others: its values on the axes with more than one value, as `name=value` words for people.
    pub fn label(&self, cell: &Cell) -> String {
        let words = self.swept().map(|axis| (self.config.named(axis), &cell.point[axis]));
        let set = words.filter(|(_, value)| **value != Value::Unset);
        let words = set.map(|(named, value)| {
            let value = named.shown(value).to_string();
            format!("{}={}", named.name(), short_number(&value))
        });
        words.collect::<Vec<_>>().join(" ")
    }

    /// A cell's value on an axis as tables show it: of a file that is an environment, its short name.
    pub fn shown(&self, cell: &Cell, axis: usize) -> Value {
        let name = match &cell.point[axis] {
            Value::Text(text) if axis == ENVIRONMENT => self.environment_names.get(text.as_str()),
            _ => None,
        };
        name.map_or_else(|| cell.point[axis].clone(), |name| Value::from(name.as_str()))
    }

    /// The request for the point of a cell: the scene with the point's material, framed by the experiment's camera.
    pub fn request(&self, point: &Point) -> RenderRequest {
        let request = self.seeded_request(point, cell_seed(&self.config, point));
        RenderRequest { reference_error: cell_error(&self.config, point), ..request }
    }

    /// The request for the point of a reference ([`Plan::reference_point`]).
    pub fn reference_request(&self, point: &Point) -> RenderRequest {
        self.seeded_request(point, self.config.seed)
    }

    fn seeded_request(&self, point: &Point, seed: u32) -> RenderRequest {
        let settings = point.settings();
        let environment = self.inputs.clipped(&settings.environment, settings.environment_clip_log2);
        let scene = self.inputs.scene(&settings.scene);
        let view = View {
            camera: self.config.camera,
            orbit: self.config.orbit,
            background: self.config.background,
            antialias: self.config.antialias,
            lights: self.config.lights.clone(),
            seed,
            reference_samples: self.config.reference.samples,
            reference_error: self.config.reference.relative_error,
        };
        let given = self.inputs.given(&settings);
        settings.request(&environment, scene, &view, given)
    }

    /// Points of which each needs memory of its own size: the cells and their references that differ in a size or an input.
    pub fn points_by_size(&self) -> Vec<Point> {
        let mut seen = HashSet::new();
        let points = self.cells.iter().flat_map(|cell| [cell.point.clone(), self.reference_point(&cell.point)]);
        let key = |point: &Point| {
            let sizes = AXES.iter().zip(&point.0).filter(|(axis, _)| axis.needs_memory);
            sizes.map(|(_, value)| value.clone()).collect::<Vec<_>>()
        };
        points.filter(|point| seen.insert(key(point))).collect()
    }

    /// How often the image of a point is rendered again with further point sets.
    pub fn repeats_of(&self, point: &Point) -> Option<u32> {
        repeats_of(&self.config, point)
    }

    /// Samples by which the steps of a point's error are drawn, where they are asked for.
    pub fn ladder_of(&self, point: &Point) -> Option<u32> {
        ladder_of(&self.config, &self.inputs, point)
    }

    /// Width and height of a cell's images.
    pub fn size_of(&self, cell: &Cell) -> [u32; 2] {
        cell.point[SIZE].pair()
    }

    /// The axes of the file with more than one value, in its order.
    pub fn swept(&self) -> impl Iterator<Item = usize> + '_ {
        self.config.axes.iter().filter(|sweep| sweep.values.len() > 1).map(|sweep| sweep.axis)
    }

    /// Warnings, each with its place: exclusions that leave nothing out, usually a slip in the file, values of exclusions that
    /// their axis does not have beside some that it has, and images that some
    /// devices refuse.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Faults::new(&self.config.path, &self.config.text);
        for exclusion in self.idle_exclusions() {
            warnings.add(&exclusion.place, format!("the exclusion {:?} matches no combination", exclusion.why));
        }
        for (place, text) in checks::idle_sweeps(&self.config, self.cells.iter().map(|cell| &cell.point)) {
            warnings.add(&place, text);
        }
        for (place, text) in checks::idle_values(&self.config) {
            warnings.add(&place, text);
        }
        for (place, text) in checks::black_metals(&self.config, &self.inputs, self.cells.iter().map(|cell| &cell.point))
        {
            warnings.add(&place, text);
        }
        if !self.config.orbit.is_still() && self.inputs.scenes().any(|scene| scene.is_design) {
            warnings.add(&Place::File(0), "orbit: the scene design has a camera of its own, which does not turn");
        }
        if self.config.background && self.inputs.scenes().all(|scene| scene.is_design) {
            warnings.add(
                &Place::File(0),
                "background: the scene design shows none: each pixel is an experiment of its own",
            );
        }
        for (place, [width, height]) in checks::sizes(&self.config) {
            let bytes = image_buffer_bytes([width, height]);
            if bytes > BUFFER_BYTES_EVERYWHERE {
                let text = format!(
                    "size: {width}x{height} needs a buffer of {} MiB; some devices have no more than {}",
                    bytes >> 20,
                    BUFFER_BYTES_EVERYWHERE >> 20
                );
                warnings.add(&place, text);
            }
        }
        warnings.into_result().err().map_or_else(Vec::new, |error| error.lines())
    }

    /// Exclusions that leave nothing out of the file as it is written: `--set` may have taken away what they match.
    fn idle_exclusions(&self) -> Vec<&Exclusion> {
        let config = &self.config;
        let mut idle: BTreeSet<usize> = (0..self.excluded.len()).filter(|&index| self.excluded[index] == 0).collect();
        if !idle.is_empty() && !config.overrides.is_empty() {
            let whole = Config::parse(&config.path, &config.text, &[], &mut Faults::new(&config.path, &config.text));
            if whole.combination_count() <= COMBINATIONS_MAX {
                let used: BTreeSet<usize> =
                    whole.combinations().filter_map(|point| whole.exclusion_of(&point)).collect();
                idle.retain(|index| !used.contains(index));
            }
        }
        idle.into_iter().map(|index| &config.exclusions[index]).collect()
    }
}

fn expand(config: Config, inputs: Inputs) -> Plan {
    let mut columns: Vec<usize> = config.axes.iter().map(|sweep| sweep.axis).collect();
    columns.extend((0..AXES.len()).filter(|axis| !config.axes.iter().any(|sweep| sweep.axis == *axis)));
    let mut excluded = vec![0; config.exclusions.len()];
    let mut collapsed = 0;
    let mut seen = HashSet::new();
    let mut cells = Vec::new();
    for point in config.combinations() {
        if let Some(index) = config.exclusion_of(&point) {
            excluded[index] += 1;
            continue;
        }
        let has_lights = !config.lights.is_empty();
        let judge = point.reference(&config.reference, has_lights);
        let reference = radiance_id(&config, &inputs, &judge, config.seed, config.reference.relative_error);
        let point = point.collapsed(has_lights);
        let radiance = radiance_id(&config, &inputs, &point, cell_seed(&config, &point), cell_error(&config, &point));
        let ladder = ladder_of(&config, &inputs, &point);
        let id = cell_id(&radiance, &reference, &point, repeats_of(&config, &point), ladder);
        if seen.insert(id.clone()) {
            cells.push(Cell { id, point, radiance, reference });
        } else {
            collapsed += 1;
        }
    }
    let mut identity = vec![format!("name={}", config.name), format!("timing={:?}", config.timing)];
    identity.extend(cells.iter().map(|cell| cell.id.clone()));
    let hash = hash_lines(&identity);
    let environment_names = config.environment_names();
    Plan { config, inputs, columns, cells, excluded, collapsed, environment_names, hash }
}

/// The seed of a cell. Where the reference is itself the method under test it has other points than the reference that judges it, or its
/// error would be too small: none at all at equal counts.
fn cell_seed(config: &Config, point: &Point) -> u32 {
    if point.method().is_integrated() { config.seed ^ UNDER_TEST } else { config.seed }
}

/// When the reference terms of a cell stop. Where the reference is itself the method under test it draws the samples that its row names,
/// whatever the one that judges it may save.
fn cell_error(config: &Config, point: &Point) -> Option<f64> {
    config.reference.relative_error.filter(|_| !point.method().is_integrated())
}

/// Inputs count by their content, so that a renamed file keeps its cells and a changed one loses them.
fn radiance_id(config: &Config, inputs: &Inputs, point: &Point, seed: u32, relative_error: Option<f64>) -> String {
    let mut lines = vec![
        format!("schema={SCHEMA_VERSION}"),
        format!("shaders={}", crate::gpu::build_hash()),
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
    let [is_specular, is_diffuse] = [point.method().is_integrated(), point.diffuse().is_integrated()];
    if is_diffuse && !is_specular {
        lines.push(format!("reference_samples={}", config.reference.samples));
    }
    if let (Some(error), true) = (relative_error, is_specular || is_diffuse) {
        lines.push(format!("reference_error={error}"));
    }
    lines.extend(config.lights.iter().map(|light| format!("light={light:?}")));
    let given = inputs.given(&point.settings());
    for (index, axis) in AXES.iter().enumerate().filter(|(_, axis)| axis.changes_radiance()) {
        let (name, value) = (axis.name, &point[index]);
        lines.push(match index {
            ENVIRONMENT => format!("{name}={}", inputs.environment(value.text()).hash),
            SCENE => format!("{name}={}", inputs.scene(value.text()).hash),
            METHOD => format!("{name}={}", point.method().shader.unwrap_or(point.method().name)),
            PREFILTERED => {
                format!("{name}={}", given.prefiltered.as_ref().map_or(value.to_string(), |map| map.hash.clone()))
            }
            DFG_TABLE => format!("{name}={}", given.dfg.as_ref().map_or(value.to_string(), |table| table.hash.clone())),
            _ => format!("{name}={value}"),
        });
    }
    hash_lines(&lines)
}

/// Only methods that draw points vary with them.
fn repeats_of(config: &Config, point: &Point) -> Option<u32> {
    config.repeats.filter(|_| point.settings().shading.method.uses_point_set)
}

/// Some terms have steps, on the scene whose frames tell all views alike.
fn ladder_of(config: &Config, inputs: &Inputs, point: &Point) -> Option<u32> {
    let has_steps = ladder::ladder_of(point.method(), point.diffuse()).is_some();
    config.ladder.filter(|_| has_steps && inputs.scene(point[SCENE].text()).is_design)
}

fn cell_id(radiance: &str, reference: &str, point: &Point, repeats: Option<u32>, ladder: Option<u32>) -> String {
    let mut lines = vec![format!("radiance={radiance}"), format!("reference={reference}")];
    lines.extend(repeats.map(|repeats| format!("repeats={repeats}")));
    lines.extend(ladder.map(|samples| format!("ladder={samples}")));
    let display = AXES.iter().zip(&point.0).filter(|(axis, _)| !axis.changes_radiance());
    lines.extend(display.map(|(axis, value)| format!("{}={value}", axis.name)));
    hash_lines(&lines)
}

fn hash_lines(lines: &[String]) -> String {
    blake3::hash(lines.join("\n").as_bytes()).to_hex()[..ID_LENGTH].to_owned()
}
