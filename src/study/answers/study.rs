//! The rows of one or more runs as one table, with the part that each axis plays.

use super::run_folder::RunFolder;
use crate::metrics::BiasVariance;
use crate::runner::axis::{AXES, Point, Reference, by_name, index_of};
use crate::runner::environments::{LUMINANCE_COLUMNS, RANGE_COLUMN};
use crate::runner::images::short_value;
use crate::runner::tables::{DISPLAY_HEADLINE, HEADLINE};
use crate::runner::timing::{FRAME, TimingRecord, summarize};
use crate::runner::value::Value;
use crate::table::markdown::significant;
use serde::Serialize;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

/// What an axis tells apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Role {
    /// One value only.
    Fixed,
    /// Rows with different values have different references.
    Scene,
    /// Ways to make the image of one reference.
    Variant,
    /// Tone curve: the linear image is the same.
    Display,
}

/// An axis of the joined table.
#[derive(Clone, Debug, Serialize)]
pub struct StudyAxis {
    pub name: String,
    pub role: Role,
    /// Distinct values in row order; an unset value is empty.
    pub values: Vec<String>,
}

/// One cell of a run.
#[derive(Clone, Debug)]
pub struct Row {
    pub run: usize,
    pub cell: String,
    /// Other cells with the same pixels, which this row stands for; see [`Study::distinct`].
    pub copies: Vec<String>,
    /// Values by axis index.
    pub axes: Vec<String>,
    /// The headline metric; `None` for a failed cell.
    pub error: Option<f64>,
    pub noise_floor: Option<f64>,
    pub verdict: String,
    /// The display metric: what a viewer notices.
    pub display_error: Option<f64>,
    /// Energy of the image over that of the reference, minus 1, with the standard error that the reference's noise gives it.
    pub bias: Option<f64>,
    pub bias_noise: Option<f64>,
    /// Whether more samples could remove less than half of the error: bias² is more than the variance, where both were estimated.
    pub is_mostly_bias: Option<bool>,
    /// The headline metric by `n_dot_v`; empty for a run that has no such table.
    pub bins: Vec<Bin>,
    /// Mean and peak luminance of the environment as it was clipped, as written, where the run knows them.
    pub light: Option<[String; 2]>,
    /// Dynamic range of the environment, stops (log2 of peak over mean luminance), where the run knows it.
    pub range_stops: Option<f64>,
    pub frame_ms: Option<FrameTime>,
}

impl Row {
    /// Whether the reference's own noise is far below the error.
    pub fn is_resolved(&self) -> bool {
        ["resolved", "no-noise-floor"].contains(&self.verdict.as_str())
    }
}

/// The headline error over the pixels with `n_dot_v` in [`lo`, `hi`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bin {
    pub lo: f64,
    pub hi: f64,
    pub pixel_count: f64,
    pub error: f64,
    /// As that of the row; NaN where the run does not know it.
    pub bias: f64,
}

/// Time of a frame over the rounds, ms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FrameTime {
    pub median: f64,
    pub p05: f64,
    pub p95: f64,
    /// 95 % interval of the median; NaN (in JSON null) below six rounds.
    pub interval: [f64; 2],
    pub n: usize,
    /// Whether it comes from a CPU driver, which says nothing about a GPU.
    pub is_cpu: bool,
}

/// Joined runs.
#[derive(Debug)]
pub struct Study {
    pub axes: Vec<StudyAxis>,
    pub rows: Vec<Row>,
    /// Values by axis index of the combinations that the experiments leave out, with those unset that cannot reach the pixels.
    pub excluded: Vec<Vec<String>>,
}

/// The axis that tells joined runs apart.
pub const RUN_AXIS: &str = "run";
/// Axes that tell no case apart: how an image is made, and which set of points it happens to use.
const NOT_CASE: [&str; 3] = ["method", "samples", "point_set"];

impl Study {
    /// Joins runs; `labels` name them, one each.
    pub fn new(runs: &[RunFolder], labels: &[String]) -> Self {
        let mut names: Vec<String> = vec![RUN_AXIS.to_owned()];
        for run in runs {
            let columns = run.errors.columns.iter().filter(|name| AXES.iter().any(|axis| axis.name == *name));
            let new: Vec<String> = columns.filter(|name| !names.contains(name)).cloned().collect();
            names.extend(new);
        }
        let rows: Vec<Row> = (0..runs.len()).flat_map(|run| rows_of(&runs[run], run, &labels[run], &names)).collect();
        let excluded = (0..runs.len()).flat_map(|run| excluded_of(&runs[run], &labels[run], &names)).collect();
        Self { axes: axes_of(&names, &rows), rows, excluded }
    }

    /// The rows with each distinct image once: an axis is unset in a row whose pixels it cannot reach ([`Point::of_pixels`]), a clip of the
    /// light that cuts off what another one does is written as that one, and of rows that are then equal the first one that has a score
    /// stands for all.
    pub fn distinct(&self) -> Self {
        let names: Vec<String> = self.axes.iter().map(|axis| axis.name.clone()).collect();
        let [environment, clip] = RANGE_AXES.map(|name| self.axis(name));
        let mut clips: BTreeMap<(usize, &str, &[String; 2]), &str> = BTreeMap::new();
        let mut rows: Vec<Row> = Vec::new();
        let mut places: BTreeMap<(usize, Vec<String>), usize> = BTreeMap::new();
        for row in &self.rows {
            let mut own = Row { axes: reaching_pixels(&names, &row.axes), ..row.clone() };
            if let (Some(clip), Some(light)) = (clip, &row.light) {
                let environment = environment.map_or("", |axis| row.axes[axis].as_str());
                let first = clips.entry((row.run, environment, light)).or_insert(&row.axes[clip]);
                own.axes[clip] = first.to_string();
            }
            match places.get(&(own.run, own.axes.clone())) {
                None => {
                    places.insert((own.run, own.axes.clone()), rows.len());
                    rows.push(own);
                }
                Some(&place) => {
                    let known = &mut rows[place];
                    if known.error.is_none() && own.error.is_some() {
                        std::mem::swap(known, &mut own);
                        known.copies = std::mem::take(&mut own.copies);
                    }
                    known.copies.push(own.cell);
                }
            }
        }
        Self { axes: axes_of(&names, &rows), rows, excluded: self.excluded.clone() }
    }

    /// Cells that a row with the same pixels stands for.
    pub fn copy_count(&self) -> usize {
        self.rows.iter().map(|row| row.copies.len()).sum()
    }

    /// The row of a cell, its own or one with the same pixels.
    pub fn row(&self, run: usize, cell: &str) -> Option<&Row> {
        self.rows.iter().find(|row| row.run == run && (row.cell == cell || row.copies.iter().any(|copy| copy == cell)))
    }

    /// The index of an axis.
    pub fn axis(&self, name: &str) -> Option<usize> {
        self.axes.iter().position(|axis| axis.name == name)
    }

    /// Swept axes of the tone curve.
    pub fn display_axes(&self) -> Vec<usize> {
        (0..self.axes.len()).filter(|&index| self.axes[index].role == Role::Display).collect()
    }

    /// Rows without their copies that differ in the tone curve only and share their linear errors: the first of each.
    pub fn images(&self) -> Vec<&Row> {
        let display = self.display_axes();
        let mut seen = BTreeSet::new();
        let is_new = |row: &&Row| {
            let axes = row.axes.iter().enumerate().filter(|(index, _)| !display.contains(index));
            seen.insert((row.run, row.error.is_some(), axes.map(|(_, value)| value.clone()).collect::<Vec<_>>()))
        };
        self.rows.iter().filter(is_new).collect()
    }

    /// How the image of a row is made: "sampled 16", "split-sum"; where no row has a specular term, the diffuse method.
    pub fn method_label(&self, row: &Row) -> String {
        if self.axis("method").is_some_and(|axis| self.axes[axis].values == ["none"]) {
            return self.value(row, "diffuse").to_owned();
        }
        format!("{} {}", self.value(row, "method"), self.value(row, "samples")).trim_end().to_owned()
    }

    /// The value of a row on an axis; empty when the axis is unknown or unset.
    pub fn value<'r>(&self, row: &'r Row, name: &str) -> &'r str {
        self.axis(name).map_or("", |index| &row.axes[index])
    }

    /// Swept axes that tell cases apart: all but method, samples, point sets and the tone curve.
    pub fn case_axes(&self) -> Vec<usize> {
        let is_case = |axis: &StudyAxis| {
            matches!(axis.role, Role::Scene | Role::Variant) && !NOT_CASE.contains(&axis.name.as_str())
        };
        (0..self.axes.len()).filter(|&index| is_case(&self.axes[index])).collect()
    }
}

/// The combinations that a run's frozen experiment leaves out, each once.
fn excluded_of(folder: &RunFolder, label: &str, names: &[String]) -> BTreeSet<Vec<String>> {
    let text = |point: &Point| {
        let value = |name: &String| match index_of(name) {
            _ if name == RUN_AXIS => label.to_owned(),
            Some(axis) => point.0[axis].to_string(),
            None => String::new(),
        };
        names.iter().map(value).collect()
    };
    let Some(config) = &folder.config else { return BTreeSet::new() };
    let has_lights = !config.lights.is_empty();
    config.excluded_points().map(|(_, point)| text(&point.of_pixels(has_lights))).collect()
}

fn axes_of(names: &[String], rows: &[Row]) -> Vec<StudyAxis> {
    let axis = |(index, name): (usize, &String)| {
        let mut seen = BTreeSet::new();
        let values: Vec<String> =
            rows.iter().map(|row| &row.axes[index]).filter(|value| seen.insert(*value)).cloned().collect();
        StudyAxis { name: name.clone(), role: role(name, &values), values }
    };
    names.iter().enumerate().map(axis).collect()
}

/// The values with those unset that cannot reach the pixels. Names that this program does not know are left as they are.
fn reaching_pixels(names: &[String], values: &[String]) -> Vec<String> {
    let mut point = Point::default();
    for (name, text) in names.iter().zip(values).filter(|(_, text)| !text.is_empty()) {
        let Some(index) = index_of(name) else { continue };
        match AXES[index].kind.parse_text(text) {
            Ok(value) => point.0[index] = value,
            // Without its method or surface nothing is known of what reaches the pixels.
            Err(_) if ["method", "diffuse", "albedo", "metallic"].contains(&name.as_str()) => return values.to_vec(),
            Err(_) => {}
        }
    }
    // Whether there are lights is told by the cells: what only lights use is unset already where there are none.
    let reaching = point.of_pixels(true);
    let reaches =
        |name: &str| index_of(name).is_none_or(|i| point.0[i] == Value::Unset || reaching.0[i] != Value::Unset);
    names.iter().zip(values).map(|(name, text)| if reaches(name) { text.clone() } else { String::new() }).collect()
}

fn rows_of(folder: &RunFolder, run: usize, label: &str, names: &[String]) -> Vec<Row> {
    let table = &folder.errors;
    let place = |name: &str| table.columns.iter().position(|column| column == name);
    let places: Vec<Option<usize>> = names.iter().map(|name| place(name)).collect();
    let [cell, error, floor, verdict, display] =
        ["cell", HEADLINE, &format!("{HEADLINE}_noise_floor"), "verdict", DISPLAY_HEADLINE].map(place);
    let [variance, bias_square] = BiasVariance::RELATIVE_NAMES.map(place);
    let [bias, bias_noise] = [BIAS, &format!("{BIAS}_noise_floor")].map(place);
    let mut bins = bins_by_cell(folder);
    let lights = lights(folder);
    let text = |fields: &[String], column: Option<usize>| column.map_or_else(String::new, |c| fields[c].clone());
    let number = |fields: &[String], column| text(fields, column).parse::<f64>().ok();
    let row = |fields: &Vec<String>| {
        let axes: Vec<String> = names
            .iter()
            .zip(&places)
            .map(|(name, place)| if name == RUN_AXIS { label.to_owned() } else { text(fields, *place) })
            .collect();
        Row {
            run,
            cell: text(fields, cell),
            error: text(fields, error).parse().ok(),
            noise_floor: text(fields, floor).parse().ok(),
            verdict: text(fields, verdict),
            display_error: text(fields, display).parse().ok(),
            bias: text(fields, bias).parse().ok(),
            bias_noise: text(fields, bias_noise).parse().ok(),
            is_mostly_bias: number(fields, bias_square).zip(number(fields, variance)).map(|(bias, noise)| bias > noise),
            bins: bins.remove(&text(fields, cell)).unwrap_or_default(),
            copies: Vec::new(),
            light: lights.get(&RANGE_AXES.map(|name| text(fields, place(name)))).map(|light| light.luminance.clone()),
            range_stops: lights
                .get(&RANGE_AXES.map(|name| text(fields, place(name))))
                .and_then(|light| light.range_stops),
            frame_ms: frame_time(&folder.timings, names, &axes, &text(fields, cell)),
            axes,
        }
    };
    table.rows.iter().map(row).collect()
}

fn bins_by_cell(folder: &RunFolder) -> BTreeMap<String, Vec<Bin>> {
    let mut by_cell: BTreeMap<String, Vec<Bin>> = BTreeMap::new();
    let Some(table) = &folder.bins else { return by_cell };
    let columns = ["cell", "n_dot_v_from", "n_dot_v_to", "pixel_count", HEADLINE].map(|name| table.column(name).ok());
    let [Some(cell), Some(lo), Some(hi), Some(count), Some(error)] = columns else { return by_cell };
    let bias = table.column(BIAS).ok();
    for row in &table.rows {
        let bias = bias.and_then(|column| row[column].parse().ok()).unwrap_or(f64::NAN);
        if let [Ok(lo), Ok(hi), Ok(pixel_count), Ok(error)] = [lo, hi, count, error].map(|column| row[column].parse()) {
            by_cell.entry(row[cell].clone()).or_default().push(Bin { lo, hi, pixel_count, error, bias });
        }
    }
    by_cell
}

/// The metric of energy.
const BIAS: &str = "bias_rel";

/// The axes that a dynamic range hangs on.
const RANGE_AXES: [&str; 2] = ["environment", "environment_clip_log2"];

/// What `environments.csv` says of one environment and clip.
struct Light {
    /// Mean and peak, as written.
    luminance: [String; 2],
    range_stops: Option<f64>,
}

fn lights(folder: &RunFolder) -> BTreeMap<[String; 2], Light> {
    let Some(table) = &folder.environments else { return BTreeMap::new() };
    let names = [RANGE_AXES[0], RANGE_AXES[1], LUMINANCE_COLUMNS[0], LUMINANCE_COLUMNS[1], RANGE_COLUMN];
    let [Some(name), Some(clip), Some(mean), Some(peak), Some(stops)] = names.map(|name| table.column(name).ok())
    else {
        return BTreeMap::new();
    };
    let light = |row: &Vec<String>| Light {
        luminance: [row[mean].clone(), row[peak].clone()],
        range_stops: row[stops].parse().ok(),
    };
    table.rows.iter().map(|row| ([row[name].clone(), row[clip].clone()], light(row))).collect()
}

/// Digits of a number that is written for people; files of numbers have all.
const SHORT_DIGITS: usize = 4;

/// A value as people say it: builtins without their prefix, files without folder and extension, long numbers rounded.
pub fn short<'v>(axis: &str, value: &'v str) -> Cow<'v, str> {
    let digits = value.trim_start_matches(['-', '0', '.']).len();
    match value.parse::<f64>() {
        Ok(number) if value.contains('.') && digits > SHORT_DIGITS + 1 => {
            return significant(number, SHORT_DIGITS).into();
        }
        _ => {}
    }
    if AXES.iter().all(|known| known.name != axis) { value.into() } else { short_value(by_name(axis), value) }
}

/// The name of a number, where its axis has names for some: that of an engine's level bias.
pub fn preset(axis: &str, value: &str) -> Option<&'static str> {
    AXES.iter().find(|known| known.name == axis)?.kind.name_of(value)
}

/// The timed configuration that a row belongs to: the axes that a record names are all the row's.
fn frame_time(timings: &[TimingRecord], names: &[String], axes: &[String], cell: &str) -> Option<FrameTime> {
    let own: BTreeMap<&str, &str> = names.iter().map(String::as_str).zip(axes.iter().map(String::as_str)).collect();
    let fits = |record: &&TimingRecord| {
        let named = record.axes.iter().filter(|(_, value)| !value.is_empty());
        record.phase == FRAME && named.into_iter().all(|(name, value)| own.get(name.as_str()) == Some(&value.as_str()))
    };
    let mut fitting = timings.iter().filter(fits);
    let first = fitting.next()?;
    let record = if first.cell == cell { first } else { fitting.find(|record| record.cell == cell).unwrap_or(first) };
    let s = summarize(&record.sums_ms());
    s.median.is_finite().then(|| FrameTime {
        median: s.median,
        p05: s.p05,
        p95: s.p95,
        interval: s.interval,
        n: s.n,
        is_cpu: record.device_type == "cpu",
    })
}

fn role(name: &str, values: &[String]) -> Role {
    // Unset is not a value: a method that does not use the axis leaves it empty.
    if values.iter().filter(|value| !value.is_empty()).count() < 2 && name != "method" {
        return Role::Fixed;
    }
    if AXES.iter().any(|axis| axis.name == name && !axis.changes_radiance()) {
        return Role::Display;
    }
    if ["method", "samples", "point_set", RUN_AXIS].contains(&name) {
        return Role::Variant;
    }
    // An axis whose values all have one reference is a way to make the image of that reference.
    let axis = AXES.iter().find(|axis| axis.name == name);
    let references: Vec<_> = axis
        .into_iter()
        .flat_map(|axis| {
            values.iter().filter_map(|value| axis.kind.parse_text(value).ok()).map(move |value| (axis, value))
        })
        .map(|(axis, value)| (axis.reference)(&Reference::default(), &value))
        .collect();
    let are_distinct = references.iter().enumerate().all(|(i, one)| !references[..i].contains(one));
    if !are_distinct {
        return Role::Variant;
    }
    Role::Scene
}
