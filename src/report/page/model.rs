//! The data of the page's scripts: axes with their values in words, and every cell as one row.

use super::images::{DESIGN, ImageSet};
use super::intermediates::PageIntermediates;
use super::page_run::{PageRun, score};
use crate::base::csv::Cell;
use crate::base::names::Listed;
use crate::draw::colormap::{
    NAN_COLOR, OFF_MASK_COLOR, Palette, RELATIVE_ERROR, Range, SIGNED_ERROR,
};
use crate::experiment::axis::{AXES, AxisId, METHOD, Named, Part, SCENE, SIZE};
use crate::experiment::value::{Kind, Value};
use crate::instrument::metrics::{METRICS, Metric, verdict};
use crate::instrument::scene::is_design;
use crate::instrument::shade::{METHODS, Method};
use crate::run::columns::{FAILED, UNSCORED};
use crate::run::store::FailureRecord;
use crate::study::finished::FinishedCell;
use crate::study::names::Names;
use indexmap::IndexMap;
use serde::ser::{Serialize, SerializeMap, Serializer};
use serde_json::{Value as Json, json};
use std::collections::BTreeMap;

const RUN_AXIS: &str = "run";
const NO_FLOOR: &str = "no-noise-floor";

/// The role of an axis on the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Role {
    /// One value only.
    Fixed,
    /// Cells with different values have different references.
    Scene,
    /// Different images with one reference.
    Variant,
    /// Tone curve: one linear image.
    Display,
}

#[derive(Clone, Debug, serde::Serialize)]
pub struct PageAxis {
    pub name: &'static str,
    pub role: Role,
    /// Values as in files, in the order of the cells.
    pub values: Vec<String>,
    /// Short values.
    pub labels: Vec<String>,
    /// Values with their names: "alpha 0.25 (roughness 0.5)".
    pub words: Vec<String>,
    /// As the first run names it; `None` for the axis of runs.
    #[serde(skip)]
    pub named: Option<Named>,
    /// Whether all cells have the same value, so that rows need no column.
    #[serde(skip)]
    pub is_constant: bool,
}

impl PageAxis {
    /// `None` for the axis of runs.
    fn axis(&self) -> Option<AxisId> {
        self.named.map(|named| named.axis)
    }

    /// The index of a value, as in [`Self::values`].
    pub fn index_of(&self, text: &str) -> Option<usize> {
        self.values.iter().position(|value| value == text)
    }

    /// A cell's value, as in [`Self::values`].
    pub fn text(&self, cell: &FinishedCell) -> Option<String> {
        self.named
            .map(|named| named.shown(&cell.point[named.axis]).to_string())
    }
}

/// The axis of runs, then the axes that some cell uses.
pub fn axes(runs: &[PageRun]) -> Vec<PageAxis> {
    let labels: Vec<String> = runs.iter().map(|run| run.label.clone()).collect();
    let mut axes = vec![PageAxis {
        name: RUN_AXIS,
        role: if runs.len() > 1 {
            Role::Variant
        } else {
            Role::Fixed
        },
        values: labels.clone(),
        words: labels.clone(),
        labels,
        named: None,
        is_constant: true,
    }];
    if let Some(first) = runs.first() {
        let names = Names::new(first.finished);
        axes.extend(AXES.ids().filter_map(|axis| page_axis(runs, &names, axis)));
    }
    axes
}

/// An axis with the values of all cells; `None` if no cell has one.
fn page_axis(runs: &[PageRun], names: &Names, axis: AxisId) -> Option<PageAxis> {
    let mut is_everywhere = true;
    // Distinct by text, by which a cell's value is looked up.
    let mut distinct: IndexMap<String, &Value> = IndexMap::new();
    for cell in runs.iter().flat_map(|run| &run.finished.cells) {
        let value = &cell.point[axis];
        if *value == Value::Unset {
            is_everywhere = false;
            continue;
        }
        distinct
            .entry(names.shown(axis, value).to_string())
            .or_insert(value);
    }
    if distinct.is_empty() {
        return None;
    }
    let role = if distinct.len() == 1 {
        Role::Fixed
    } else {
        match AXES[axis].part {
            Part::Case => Role::Scene,
            Part::Display => Role::Display,
            _ => Role::Variant,
        }
    };
    let (texts, values): (Vec<String>, Vec<&Value>) = distinct.into_iter().unzip();
    let labels: Vec<String>;
    let words: Vec<String>;
    if axis == METHOD {
        labels = texts.iter().map(|name| method_title(name)).collect();
        words = labels.clone();
    } else {
        labels = short_labels(names, axis, &values);
        words = values
            .iter()
            .zip(&labels)
            .map(|(value, label)| value_with_name(names, axis, value, label))
            .collect();
    }
    Some(PageAxis {
        name: names.name(axis),
        role,
        values: texts,
        labels,
        words,
        named: Some(names.named(axis)),
        is_constant: role == Role::Fixed && is_everywhere,
    })
}

/// The title of a method; its name if this program does not know it.
fn method_title(name: &str) -> String {
    Method::by_name(name)
        .map_or(name, |method| method.title)
        .to_owned()
}

/// Short texts, whole if two would be equal.
fn short_labels(names: &Names, axis: AxisId, values: &[&Value]) -> Vec<String> {
    let short: Vec<String> = values
        .iter()
        .map(|value| names.short(axis, value))
        .collect();
    let is_double = |label: &String| short.iter().filter(|other| *other == label).count() > 1;
    values
        .iter()
        .zip(&short)
        .map(|(value, label)| {
            if is_double(label) {
                value.to_string()
            } else {
                label.clone()
            }
        })
        .collect()
}

/// A value with its name: "5 lv", "alpha 0.25 (roughness 0.5)", "bias 1 (filament)".
fn value_with_name(names: &Names, axis: AxisId, value: &Value, label: &str) -> String {
    let words = names
        .heading(axis, value)
        .replace(&names.short(axis, value), label);
    match number_name(axis, value) {
        Some(name) => format!("{words} ({name})"),
        None => words,
    }
}

/// The name of a number, such as the engine of a level bias; 0 has none.
fn number_name(index: AxisId, value: &Value) -> Option<String> {
    let (Kind::NumberOrName { named, .. }, Value::Number(number)) = (&AXES[index].kind, value)
    else {
        return None;
    };
    let known = named()
        .into_iter()
        .find(|(_, known)| known == number && *known != 0.0)?;
    Some(known.0.to_owned())
}

/// The scenes that are not pictures.
fn designs(axes: &[PageAxis]) -> Vec<&String> {
    let scenes = axes
        .iter()
        .filter(|axis| axis.axis() == Some(SCENE))
        .flat_map(|axis| &axis.values);
    scenes.filter(|name| is_design(name)).collect()
}

/// The common values that are not defaults: "size 128x128, diffuse none".
pub fn shared(axes: &[PageAxis]) -> String {
    let mut words = Vec::new();
    for page_axis in axes.iter().filter(|axis| axis.role == Role::Fixed) {
        let Some(axis) = page_axis.axis() else {
            continue;
        };
        let is_default = (AXES[axis].default)().to_string() == page_axis.values[0];
        if is_default && axis != SIZE {
            continue;
        }
        let name = page_axis.name.replace('_', " ");
        let label = &page_axis.labels[0];
        words.push(if designs(std::slice::from_ref(page_axis)).is_empty() {
            format!("{name} {label}")
        } else {
            format!("{name} {label} ({DESIGN})")
        });
    }
    words.join(", ")
}

/// The columns of [`Model::row`] besides axes and metrics.
const ROW_COLUMNS: [&str; 7] = [
    "run",
    "cell",
    "image",
    "reference",
    "intermediates",
    "verdict",
    "noise_floor",
];

pub fn columns(axes: &[PageAxis], metrics: &[&'static Metric]) -> Vec<&'static str> {
    let axes = axes
        .iter()
        .filter(|axis| !axis.is_constant)
        .map(|axis| axis.name);
    ROW_COLUMNS
        .into_iter()
        .chain(axes)
        .chain(metrics.iter().map(|metric| metric.name))
        .collect()
}

/// A run, for the scripts.
#[derive(serde::Serialize)]
pub struct ScriptRun<'a> {
    pub failures: &'a [FailureRecord],
    pub label: &'a str,
    pub link: Option<&'a str>,
    pub name: &'a str,
    pub shared: &'a str,
    pub sheets: &'a [[String; 2]],
}

/// The table of an answer, for the scripts.
#[derive(serde::Serialize)]
pub struct ScriptTable<'a> {
    pub columns: &'a [String],
    /// Of the question.
    pub name: &'static str,
    /// Of the whole table.
    pub row_count: usize,
    /// All rows, or the first.
    pub rows: ScriptRows<'a>,
    pub run: usize,
}

/// The rows of a table as JSON, made while they are written, to save memory.
pub struct ScriptRows<'a>(pub &'a [Vec<Cell>]);

impl Serialize for ScriptRows<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let fields = |row: &Vec<Cell>| row.iter().map(field).collect::<Vec<Json>>();
        serializer.collect_seq(self.0.iter().map(fields))
    }
}

/// Rows are made while they are written, to save memory.
pub struct Model<'a> {
    pub runs: Vec<ScriptRun<'a>>,
    pub page_runs: &'a [PageRun<'a>],
    pub axes: &'a [PageAxis],
    pub metrics: &'a [&'static Metric],
    pub headline: &'static Metric,
    pub answers: Vec<ScriptTable<'a>>,
    pub images: &'a ImageSet,
    pub intermediates: &'a PageIntermediates,
}

impl Serialize for Model<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let metric = |metric: &&Metric| json!({ "name": metric.name, "formula": metric.formula });
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("headline", self.headline.name)?;
        map.serialize_entry("runs", &self.runs)?;
        map.serialize_entry("axes", self.axes)?;
        map.serialize_entry(
            "metrics",
            &self.metrics.iter().map(metric).collect::<Vec<_>>(),
        )?;
        map.serialize_entry("columns", &columns(self.axes, self.metrics))?;
        map.serialize_entry("rows", &Rows(self))?;
        map.serialize_entry("answers", &self.answers)?;
        map.serialize_entry("images", &self.images.images)?;
        map.serialize_entry("image_notes", &self.images.notes)?;
        map.serialize_entry("intermediates", self.intermediates)?;
        map.serialize_entry("designs", &designs(self.axes))?;
        map.serialize_entry(
            "roles",
            &METHODS
                .iter()
                .map(|method| (method.name, method.role()))
                .collect::<BTreeMap<_, _>>(),
        )?;
        map.serialize_entry("colors", &colors())?;
        map.end()
    }
}

/// Every cell of every run. A value on an axis is an index into the axis' values.
struct Rows<'a>(&'a Model<'a>);

impl Serialize for Rows<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let runs = self.0.page_runs.iter().enumerate();
        let cells =
            runs.flat_map(|(run, page_run)| page_run.finished.cells.iter().map(move |c| (run, c)));
        serializer.collect_seq(cells.map(|(run, cell)| self.0.row(run, cell)))
    }
}

impl Model<'_> {
    /// A cell, under [`columns`].
    fn row(&self, run: usize, cell: &FinishedCell) -> Vec<Json> {
        let image_index = |file: &String| self.images.index.get(&(run, file.clone())).copied();
        let files = cell.images.as_ref();
        let image = files.and_then(|files| image_index(&files.radiance));
        let reference = files.and_then(|files| image_index(files.reference.as_ref()?));
        let floor = cell.noise_floors.get(self.headline.name);
        let mut row = vec![
            json!(run),
            json!(*cell.id),
            json!(image),
            json!(reference),
            json!(self.intermediates.set_of(run, &cell.id)),
            json!(self.verdict(run, cell, floor)),
            number(floor),
        ];
        for axis in self.axes.iter().filter(|axis| !axis.is_constant) {
            if let Some(text) = axis.text(cell) {
                row.push(json!(axis.index_of(&text)));
            }
        }
        row.extend(
            self.metrics
                .iter()
                .map(|metric| number(score(cell, metric))),
        );
        row
    }

    /// Whether the error of a cell exceeds its noise floor, in a word.
    fn verdict(&self, run: usize, cell: &FinishedCell, floor: Option<f64>) -> &'static str {
        if cell.is_failed {
            return FAILED;
        }
        if cell.scores.is_none() {
            return UNSCORED;
        }
        match (score(cell, self.headline), floor) {
            (Some(score), Some(floor)) => {
                let noise_use = self.page_runs[run].finished.noise_use();
                verdict(self.headline, score, floor, noise_use).name()
            }
            _ => NO_FLOOR,
        }
    }
}

/// JSON has no infinity: it is written by name.
fn number(value: Option<f64>) -> Json {
    match value {
        None => Json::Null,
        Some(value) if value.is_finite() => json!(value),
        Some(value) => json!(value.to_string().to_lowercase()),
    }
}

fn field(cell: &Cell) -> Json {
    match cell {
        Cell::Number(value) => number(Some(*value)),
        Cell::Integer(value) => json!(value),
        Cell::Text(_) | Cell::Quantity(_) | Cell::Named(_) | Cell::Missing => json!(cell.text()),
    }
}

/// Metrics with a score of some cell.
pub fn metrics(runs: &[PageRun]) -> Vec<&'static Metric> {
    let cells = runs.iter().flat_map(|run| &run.finished.cells);
    METRICS
        .iter()
        .copied()
        .filter(|metric| cells.clone().any(|cell| score(cell, metric).is_some()))
        .collect()
}

pub fn colors() -> Json {
    let table = |palette: Palette| {
        (0..256)
            .map(|i| palette.color(f64::from(i) / 255.0))
            .collect::<Vec<_>>()
    };
    let range = |range: Range| match range {
        Range::Linear { lo, hi } | Range::Log { lo, hi } => [lo, hi],
    };
    json!({
        "magma": table(Palette::Magma),
        "blue_red": table(Palette::BlueRed),
        "relative": range(RELATIVE_ERROR.range),
        "signed": range(SIGNED_ERROR.range),
        "relative_ticks": RELATIVE_ERROR.ticks(),
        "signed_ticks": SIGNED_ERROR.ticks(),
        "nan": NAN_COLOR,
        "off_mask": OFF_MASK_COLOR,
    })
}
