//! The file: the template, with styles, modules and data written into it.
//!
//! Everything from a run is data. Text in markup is escaped by the template engine, figures by their own writer; the rest stands in JSON
//! script elements whose `<` is written as `\u003c`, so that no name can end the element. A content security policy in the page forbids
//! every request, so that what is promised (one offline file) is also enforced.

use super::images::ImageSet;
use super::lead::Pictures;
use super::live::Light;
use super::sections::Section;
use super::told::Fact;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use minijinja::value::{Serde, Value};
use minijinja::{AutoEscape, Environment, context};
use serde::Serialize;
use serde_json::Value as Json;

/// Style sheet of the page.
const STYLE: &str = include_str!("../../../assets/report/report.css");
const TEMPLATE: &str = include_str!("../../../assets/report/report.html");
/// What it holds of the views that draw in a canvas.
const STAGE: &str = include_str!("../../../assets/report/stage.html");

/// The page's shaders by name, which the build script wrote from the renderer's libraries (`shaders/page`).
mod shaders {
    include!(concat!(env!("OUT_DIR"), "/page_shaders.rs"));
}

/// Lists modules of the page by the names under which they import each other. An import map points each to its text.
macro_rules! modules {
    ($($name:literal),+ $(,)?) => {
        &[$((concat!("report/", $name), include_str!(concat!("../../../assets/report/", $name, ".js")))),+]
    };
}

const MODULES: &[(&str, &str)] = modules![
    "main",
    "data",
    "state",
    "dom",
    "answer",
    "tables",
    "program",
    "stage",
    "surface",
    "legend",
    "viewer-input",
    "viewer",
    "live",
    "live-render",
    "live-scene",
    "place",
    "grid",
];

/// What the page shows without its scripts.
#[derive(Debug, Serialize)]
pub struct Page {
    pub name: String,
    /// What the runs ask.
    pub heading: String,
    /// The metric of the page's errors.
    pub metric: &'static str,
    /// What tells joined runs apart.
    pub facts: Vec<Fact>,
    /// Which runs repeat another one, one sentence each.
    pub repeats: Vec<String>,
    pub metrics: Json,
    pub program_version: &'static str,
    pub runs: Vec<Run>,
}

/// A run in words.
#[derive(Debug, Serialize)]
pub struct Run {
    pub label: String,
    pub anchor: String,
    pub index: usize,
    pub question: String,
    pub device: String,
    pub date: String,
    pub warnings: Vec<String>,
    pub cpu_warning: Option<String>,
    /// What all its cells share.
    pub shared: String,
    /// Index of the section for the first screen.
    pub lead: Option<usize>,
    pub pictures: Option<Pictures>,
    pub sections: Vec<Section>,
    pub provenance: Vec<(&'static str, Vec<(String, String)>)>,
    pub failures: Json,
    pub excluded: Json,
    pub input_warnings: Json,
    /// Contact sheets: title and link.
    pub sheets: Vec<[String; 2]>,
    pub experiment: String,
    /// The whole provenance as text.
    pub whole: String,
}

/// Renders the page. `model` is what the scripts read; `light` is what the live view reads.
pub fn render(page: &Page, model: &Json, images: &ImageSet, light: &Light) -> Result<String, minijinja::Error> {
    let mut environment = Environment::new();
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    environment.add_filter("whole_units", whole_units);
    environment.add_filter("pieces", pieces);
    environment.add_template("report", TEMPLATE)?;
    environment.add_template("stage", STAGE)?;
    let imports: serde_json::Map<String, Json> = MODULES
        .iter()
        .map(|(name, text)| {
            (name.to_string(), format!("data:text/javascript;base64,{}", BASE64_STANDARD.encode(text)).into())
        })
        .collect();
    let shaders: serde_json::Map<String, Json> =
        shaders::PAGE_SHADERS.iter().map(|(name, text)| (name.to_string(), (*text).into())).collect();
    let payload = |(i, text): (usize, &String)| {
        Value::from_pairs([("id", Value::from(format!("pixels-{i}"))), ("text", safe(text.clone()))])
    };
    environment.get_template("report")?.render(context! {
        page => Serde(page),
        style => safe(STYLE.to_owned()),
        imports => safe(in_script(&serde_json::json!({ "imports": imports }))),
        model => safe(in_script(model)),
        shaders => safe(in_script(&serde_json::json!(shaders))),
        light => safe(in_script(&serde_json::json!(light))),
        payloads => images.payloads.iter().enumerate().map(payload).collect::<Vec<_>>(),
    })
}

/// A sentence in parts: strong between `**`, code between backticks.
fn pieces(text: String) -> Vec<Value> {
    let piece = |text: &str, is_strong: bool, is_code: bool| {
        Value::from_pairs([("text", Value::from(text)), ("is_strong", is_strong.into()), ("is_code", is_code.into())])
    };
    let strong = text.split("**").enumerate();
    let codes =
        strong.flat_map(|(i, part)| part.split('`').enumerate().map(move |(j, part)| (part, i % 2 == 1, j % 2 == 1)));
    codes
        .filter(|(part, ..)| !part.is_empty())
        .map(|(part, is_strong, is_code)| piece(part, is_strong, is_code))
        .collect()
}

/// Text in which no line ends between a number and its sign, before or behind it.
fn whole_units(text: String) -> String {
    text.replace(" %", "\u{a0}%").replace("± ", "±\u{a0}")
}

fn safe(text: String) -> Value {
    Value::from_safe_string(text)
}

/// JSON that can stand in a script element: it holds no `<`, so it cannot close the element or open a comment.
pub fn in_script(value: &Json) -> String {
    value.to_string().replace('<', "\\u003c")
}
