//! The page: the template, with styles, modules and data written into it.
//!
//! Everything from a run is data. Text in markup is escaped by the template engine; the rest stands in JSON script elements
//! whose `<` is written as `\u003c`, so that no name can end the element. A content security policy in the page forbids every
//! request, so that what is promised (one offline file) is also enforced.

use super::images::ImageSet;
use super::joined::Fact;
use super::live::Light;
use crate::study::answers::words::Answer;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use minijinja::value::{Serde, Value};
use minijinja::{AutoEscape, Environment, context};
use serde::Serialize;

/// Style sheet of the page.
const STYLE: &str = include_str!("../../../assets/report/report.css");
const TEMPLATE: &str = include_str!("../../../assets/report/report.html");

/// The page's shaders by name, which the build script wrote from the renderer's libraries (`shaders/page`).
mod shaders {
    include!(concat!(env!("OUT_DIR"), "/page_shaders.rs"));
}

/// The modules of the page by the name they import each other under. An import map points each to its text.
const MODULES: [(&str, &str); 31] = [
    ("report/main", include_str!("../../../assets/report/main.js")),
    ("report/data", include_str!("../../../assets/report/data.js")),
    ("report/state", include_str!("../../../assets/report/state.js")),
    ("report/dom", include_str!("../../../assets/report/dom.js")),
    ("report/color", include_str!("../../../assets/report/color.js")),
    ("report/cases", include_str!("../../../assets/report/cases.js")),
    ("report/answer", include_str!("../../../assets/report/answer.js")),
    ("report/break-even", include_str!("../../../assets/report/break-even.js")),
    ("report/effects", include_str!("../../../assets/report/effects.js")),
    ("report/visibility", include_str!("../../../assets/report/visibility.js")),
    ("report/times", include_str!("../../../assets/report/times.js")),
    ("report/chart", include_str!("../../../assets/report/chart.js")),
    ("report/labels", include_str!("../../../assets/report/labels.js")),
    ("report/energy", include_str!("../../../assets/report/energy.js")),
    ("report/standalone", include_str!("../../../assets/report/standalone.js")),
    ("report/maps", include_str!("../../../assets/report/maps.js")),
    ("report/plots", include_str!("../../../assets/report/plots.js")),
    ("report/profile", include_str!("../../../assets/report/profile.js")),
    ("report/program", include_str!("../../../assets/report/program.js")),
    ("report/stage", include_str!("../../../assets/report/stage.js")),
    ("report/surface", include_str!("../../../assets/report/surface.js")),
    ("report/legend", include_str!("../../../assets/report/legend.js")),
    ("report/viewer-input", include_str!("../../../assets/report/viewer-input.js")),
    ("report/viewer", include_str!("../../../assets/report/viewer.js")),
    ("report/live", include_str!("../../../assets/report/live.js")),
    ("report/live-render", include_str!("../../../assets/report/live-render.js")),
    ("report/live-scene", include_str!("../../../assets/report/live-scene.js")),
    ("report/grid", include_str!("../../../assets/report/grid.js")),
    ("report/filter", include_str!("../../../assets/report/filter.js")),
    ("report/tables", include_str!("../../../assets/report/tables.js")),
    ("report/run", include_str!("../../../assets/report/run.js")),
];

/// What the page shows without its scripts.
#[derive(Debug, Serialize)]
pub struct Static {
    pub name: String,
    pub question: String,
    /// What stands above joined runs.
    pub heading: String,
    /// Every run, in the order in which they were joined.
    pub runs: Vec<Told>,
    /// What tells joined runs apart.
    pub facts: Vec<Fact>,
    /// Which of them repeat another one, one sentence each.
    pub repeats: Vec<String>,
}

/// A run in words.
#[derive(Debug, Serialize)]
pub struct Told {
    pub label: String,
    pub question: String,
    pub answer: Answer,
    pub warnings: Vec<String>,
    /// Whether times of it come from a CPU driver.
    pub is_cpu: bool,
    pub device: String,
    /// When it ran, `2026-11-21 18:07 UTC`.
    pub date: String,
}

/// Renders the page. `model` is what the scripts read; `tables` are CSV files by element id; `light` is what the live view reads.
pub fn render(
    fixed: &Static,
    model: &serde_json::Value,
    tables: &[(String, &str)],
    images: &ImageSet,
    light: &Light,
) -> Result<String, minijinja::Error> {
    let mut environment = Environment::new();
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    environment.add_filter("whole_units", whole_units);
    environment.add_template("report", TEMPLATE)?;
    let imports: serde_json::Map<String, serde_json::Value> = MODULES
        .iter()
        .map(|(name, text)| {
            (name.to_string(), format!("data:text/javascript;base64,{}", BASE64_STANDARD.encode(text)).into())
        })
        .collect();
    let shaders: serde_json::Map<String, serde_json::Value> =
        shaders::PAGE_SHADERS.iter().map(|(name, text)| (name.to_string(), (*text).into())).collect();
    let element = |id: &str, text: &str| Value::from_pairs([("id", Value::from(id)), ("text", safe(text.to_owned()))]);
    let tables: Vec<Value> =
        tables.iter().map(|(id, text)| element(id, &in_script(&serde_json::json!(text)))).collect();
    let payloads: Vec<Value> =
        images.payloads.iter().enumerate().map(|(i, text)| element(&format!("pixels-{i}"), text)).collect();
    environment.get_template("report")?.render(context! {
        fixed => Serde(fixed),
        style => safe(STYLE.to_owned()),
        imports => safe(in_script(&serde_json::json!({ "imports": imports }))),
        model => safe(in_script(model)),
        shaders => safe(in_script(&serde_json::json!(shaders))),
        light => safe(in_script(&serde_json::json!(light))),
        tables,
        payloads,
    })
}

/// Text in which no line ends between a number and its sign, before or behind it.
fn whole_units(text: &str) -> String {
    text.replace(" %", "\u{a0}%").replace("± ", "±\u{a0}")
}

fn safe(text: String) -> Value {
    Value::from_safe_string(text)
}

/// JSON that can stand in a script element: it holds no `<`, so it cannot close the element or open a comment.
pub fn in_script(value: &serde_json::Value) -> String {
    value.to_string().replace('<', "\\u003c")
}
