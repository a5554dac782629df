//! The data of the page's scripts: axes with their values in words, and every cell as one row.

use super::images::{DESIGN, ImageSet};
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
use crate::run::columns::FAILED;
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
    /// Index of [`AXES`]; `None` for the axis of runs.
    fn index(&self) -> Option<AxisId> {
        self.named.map(|named| named.axis)
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
    let role = if runs.len() > 1 {
        Role::Variant
    } else {
        Role::Fixed
    };
    let (values, words) = (labels.clone(), labels.clone());
    let of_runs = PageAxis {
        name: RUN_AXIS,
        role,
        values,
        labels,
        words,
        named: None,
        is_constant: true,
    };
    let names = runs.first().map(|run| Names::of(run.finished));
    let axes = names
        .iter()
        .flat_map(|names| AXES.ids().filter_map(|index| page_axis(runs, names, index)));
    std::iter::once(of_runs).chain(axes).collect()
}

fn page_axis(runs: &[PageRun], names: &Names, index: AxisId) -> Option<PageAxis> {
    let cells = runs.iter().flat_map(|run| &run.finished.cells);
    let found = cells
        .clone()
        .map(|cell| &cell.point.0[index])
        .filter(|value| **value != Value::Unset);
    // Distinct by text, by which a cell's value is looked up.
    let mut distinct: IndexMap<String, &Value> = IndexMap::new();
    for value in found {
        distinct
            .entry(names.shown(index, value).to_string())
            .or_insert(value);
    }
    let (seen, distinct): (Vec<String>, Vec<&Value>) = distinct.into_iter().unzip();
    let role = match (distinct.len(), AXES[index].part) {
        (0, _) => return None,
        (1, _) => Role::Fixed,
        (_, Part::Case) => Role::Scene,
        (_, Part::Display) => Role::Display,
        _ => Role::Variant,
    };
    let labels = match index {
        METHOD => seen
            .iter()
            .map(|name| {
                Method::by_name(name)
                    .map_or(name.as_str(), |own| own.title)
                    .to_owned()
            })
            .collect(),
        _ => labels(names, index, &distinct),
    };
    let words = match index {
        METHOD => labels.clone(),
        _ => distinct
            .iter()
            .zip(&labels)
            .map(|(value, label)| word(names, index, value, label))
            .collect(),
    };
    let is_constant = role == Role::Fixed
        && cells
            .clone()
            .all(|cell| cell.point.0[index] != Value::Unset);
    let (name, named) = (names.name(index), Some(names.named(index)));
    Some(PageAxis {
        name,
        role,
        values: seen,
        labels,
        words,
        named,
        is_constant,
    })
}

/// Short texts, whole if two would be equal.
fn labels(names: &Names, index: AxisId, values: &[&Value]) -> Vec<String> {
    let labels: Vec<String> = values
        .iter()
        .map(|value| names.short(index, value))
        .collect();
    let is_double = |label: &String| labels.iter().filter(|other| *other == label).count() > 1;
    let whole = |(value, label): (&&Value, &String)| {
        if is_double(label) {
            value.to_string()
        } else {
            label.clone()
        }
    };
    values.iter().zip(&labels).map(whole).collect()
}

/// A value with its name: "5 lv", "alpha 0.25 (roughness 0.5)", "bias 1 (filament)".
fn word(names: &Names, index: AxisId, value: &Value, short: &str) -> String {
    let word = names
        .heading(index, value)
        .replace(&names.short(index, value), short);
    number_name(index, value).map_or_else(|| word.clone(), |name| format!("{word} ({name})"))
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
        .filter(|axis| axis.index() == Some(SCENE))
        .flat_map(|axis| &axis.values);
    scenes.filter(|name| is_design(name)).collect()
}

/// The common values that are not defaults: "size 128x128, diffuse none".
pub fn shared(axes: &[PageAxis]) -> String {
    let says = |axis: &&PageAxis| {
        let Some(index) = axis.index().filter(|_| axis.role == Role::Fixed) else {
            return false;
        };
        index == SIZE || (AXES[index].default)().to_string() != axis.values[0]
    };
    let word = |axis: &PageAxis| {
        let word = format!("{} {}", axis.name.replace('_', " "), axis.labels[0]);
        if !designs(std::slice::from_ref(axis)).is_empty() {
            format!("{word} ({DESIGN})")
        } else {
            word
        }
    };
    axes.iter()
        .filter(says)
        .map(word)
        .collect::<Vec<_>>()
        .join(", ")
}

pub fn columns(axes: &[PageAxis], metrics: &[&'static Metric]) -> Vec<&'static str> {
    let own = [
        "run",
        "cell",
        "image",
        "reference",
        "verdict",
        "noise_floor",
    ];
    let axes = axes
        .iter()
        .filter(|axis| !axis.is_constant)
        .map(|axis| axis.name);
    own.into_iter()
        .chain(axes)
        .chain(metrics.iter().map(|metric| metric.name))
        .collect()
}

/// Rows are made while they are written, to save memory.
pub struct Model<'a> {
    pub runs: Vec<Json>,
    pub cells_of: &'a [PageRun<'a>],
    pub axes: &'a [PageAxis],
    pub metrics: &'a [&'static Metric],
    pub headline: &'static Metric,
    pub answers: Vec<Json>,
    pub images: &'a ImageSet,
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
        let all = self.0.cells_of.iter().enumerate();
        let cells = all.flat_map(|(run, page_run)| {
            page_run.finished.cells.iter().map(move |cell| (run, cell))
        });
        serializer.collect_seq(cells.map(|(run, cell)| self.0.row(run, cell)))
    }
}

impl Model<'_> {
    fn row(&self, run: usize, cell: &FinishedCell) -> Vec<Json> {
        let Self {
            axes,
            metrics,
            headline,
            images,
            ..
        } = *self;
        let image = |file: &String| images.index.get(&(run, file.clone())).copied();
        let [own, reference] = [0, 1].map(|i| {
            cell.images
                .as_ref()
                .and_then(|files| image([&files.radiance, &files.reference][i]))
        });
        let floor = cell.noise_floors.get(headline.name);
        let verdict = match (score(cell, headline), floor) {
            _ if cell.scores.is_none() => FAILED,
            (Some(score), Some(floor)) => verdict(headline, score, floor).name(),
            _ => NO_FLOOR,
        };
        let own = [
            json!(run),
            json!(cell.id),
            json!(own),
            json!(reference),
            json!(verdict),
            number(floor),
        ];
        let place = |axis: &PageAxis| {
            let text = axis.text(cell).filter(|_| !axis.is_constant)?;
            Some(axis.values.iter().position(|value| *value == text))
        };
        let places = axes.iter().filter_map(place).map(|place| json!(place));
        let scores = metrics.iter().map(|metric| number(score(cell, metric)));
        own.into_iter().chain(places).chain(scores).collect()
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

pub fn field(cell: &Cell) -> Json {
    match cell {
        Cell::Text(text) => json!(text),
        Cell::Number(value) => number(Some(*value)),
        Cell::Integer(value) => json!(value),
        Cell::Missing => Json::Null,
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
