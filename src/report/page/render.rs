//! Writes the page: the template with styles, modules and data.
//!
//! The template engine escapes text in markup, figures escape their own; all other data is in JSON
//! script elements whose `<` is written as `\u003c`, so that no name can end the element. A content
//! security policy forbids every request.

use super::live::{Light, page_name};
use crate::base::glsl::source::{Choice, Language, PAGE_FOLDER};
use crate::instrument::gpu::shader_sources;
use crate::instrument::shade::Method;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use minijinja::value::{Serde, Value};
use minijinja::{AutoEscape, Environment, context};
use serde::Serialize;
use serde_json::{Value as Json, json};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{Error, Write};

const STYLE: &str = include_str!("../../../assets/report/report.css");
const TEMPLATE: &str = include_str!("../../../assets/report/report.html");
/// Family, weight and file of the fonts: subsets under the SIL Open Font License.
const FONTS: [(&str, u32, &[u8]); 3] = [
    (
        "Sans",
        400,
        include_bytes!("../../../assets/report/fonts/text-regular.woff2"),
    ),
    (
        "Sans",
        500,
        include_bytes!("../../../assets/report/fonts/text-medium.woff2"),
    ),
    (
        "Mono",
        400,
        include_bytes!("../../../assets/report/fonts/code-regular.woff2"),
    ),
];
/// The part of views with a canvas.
const STAGE: &str = include_str!("../../../assets/report/stage.html");

/// Modules by import name, for an import map.
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

/// The place of the model in the template, which is written directly to save memory.
const MODEL: &str = "{{ model }}";

/// Writes the page. `page` is for the template, `model` for the scripts, `payloads` are texels,
/// `light` is for the Live view.
pub fn render(
    writer: &mut impl Write,
    page: &Json,
    model: &impl Serialize,
    payloads: Vec<String>,
    light: &Light,
) -> std::io::Result<()> {
    let mut environment = Environment::new();
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    environment.add_filter("whole_units", whole_units);
    let (before, behind) = TEMPLATE
        .split_once(MODEL)
        .expect("the template holds the model");
    let parts = [("before", before), ("behind", behind), ("stage", STAGE)];
    parts
        .into_iter()
        .try_for_each(|(name, text)| environment.add_template(name, text))
        .map_err(Error::other)?;
    let import = |text: &str| {
        format!(
            "data:text/javascript;base64,{}",
            BASE64_STANDARD.encode(text)
        )
    };
    let imports: BTreeMap<&str, String> = MODULES
        .iter()
        .map(|(name, text)| (*name, import(text)))
        .collect();
    let context = context! {
        page => Serde(page),
        style => safe(style()),
        imports => safe(in_script(&json!({ "imports": imports }))),
        shaders => safe(in_script(&json!(shaders(light)))),
        light => safe(in_script(&json!(light))),
        payloads => payloads.into_iter().map(safe).collect::<Vec<_>>(),
    };
    let part = |name: &str, writer: &mut dyn Write| {
        let template = environment.get_template(name);
        template
            .and_then(|template| template.render_captured_to(&context, writer).map(drop))
            .map_err(Error::other)
    };
    part("before", writer)?;
    serde_json::to_writer(Script(&mut *writer), model)?;
    part("behind", writer)
}

/// The page's shaders (GLSL ES 3.00) by name, such as `specular:cube:sampled:ggx`, as far as
/// `light` needs them.
pub fn shaders(light: &Light) -> BTreeMap<String, String> {
    let sources = shader_sources();
    let layouts = light
        .environments
        .iter()
        .map(|environment| environment.layout.as_str());
    let models = light.lobes.iter().map(|lobe| lobe.brdf.as_str());
    let methods = light
        .methods
        .iter()
        .map(|method| method.name.as_str())
        .chain([Method::SHEEN_LOOKUP.name]);
    let wanted: BTreeSet<&str> = layouts.chain(models).chain(methods).collect();
    let entries = sources
        .entries()
        .filter(|entry| entry.starts_with(PAGE_FOLDER));
    let all = entries.flat_map(|entry| {
        let named = sources
            .permutations(entry, &Choice::new())
            .expect("every file that a shader includes is there");
        named
            .into_iter()
            .map(move |(name, choice)| (entry, name, choice))
    });
    let is_wanted = |name: &str| name.split(':').skip(1).all(|part| wanted.contains(part));
    all.filter(|(_, name, _)| is_wanted(name))
        .map(|(entry, name, choice)| {
            let text = sources
                .expand(entry, &choice, Language::Es)
                .expect("its permutation was found");
            (page_name(&name), text)
        })
        .chain(light.shaders.clone())
        .collect()
}

/// The style of all pages, with its fonts.
pub fn style() -> String {
    FONTS.map(font).concat() + STYLE
}

fn font((family, weight, bytes): (&str, u32, &[u8])) -> String {
    let base64 = BASE64_STANDARD.encode(bytes);
    format!(
        "@font-face{{font-family:\"Splitsum \
         {family}\";font-weight:{weight};src:url(data:font/woff2;base64,{base64})}}\n"
    )
}

/// Prevents line breaks between a number and its sign.
fn whole_units(text: String) -> String {
    text.replace(" %", "\u{a0}%").replace("± ", "±\u{a0}")
}

fn safe(text: String) -> Value {
    Value::from_safe_string(text)
}

/// JSON without `<`, safe in a script element.
pub fn in_script(value: &Json) -> String {
    let mut text = Vec::new();
    serde_json::to_writer(Script(&mut text), value).expect("memory takes all JSON");
    String::from_utf8(text).expect("JSON is UTF-8")
}

/// Writes JSON without `<`.
struct Script<W>(W);

impl<W: Write> Write for Script<W> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        for (place, part) in bytes.split(|byte| *byte == b'<').enumerate() {
            self.0.write_all(if place > 0 { b"\\u003c" } else { b"" })?;
            self.0.write_all(part)?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.0.flush()
    }
}
