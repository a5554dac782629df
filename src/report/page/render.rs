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
/// A font: a subset under the SIL Open Font License.
struct Font {
    family: &'static str,
    weight: u32,
    woff2: &'static [u8],
}

impl Font {
    fn css(&self) -> String {
        let Self { family, weight, .. } = self;
        let base64 = BASE64_STANDARD.encode(self.woff2);
        format!(
            "@font-face{{font-family:\"Splitsum \
             {family}\";font-weight:{weight};src:url(data:font/woff2;base64,{base64})}}\n"
        )
    }
}

const FONTS: [Font; 3] = [
    Font {
        family: "Sans",
        weight: 400,
        woff2: include_bytes!("../../../assets/report/fonts/text-regular.woff2"),
    },
    Font {
        family: "Sans",
        weight: 500,
        woff2: include_bytes!("../../../assets/report/fonts/text-medium.woff2"),
    },
    Font {
        family: "Mono",
        weight: 400,
        woff2: include_bytes!("../../../assets/report/fonts/code-regular.woff2"),
    },
];
/// The part of views with a canvas.
const STAGE: &str = include_str!("../../../assets/report/stage.html");

/// Modules by import name, for an import map.
macro_rules! modules {
    ($($name:literal),+ $(,)?) => {
        &[$((
            concat!("report/", $name),
            include_str!(concat!("../../../assets/report/", $name, ".js")),
        )),+]
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
    "intermediates",
    "viewer-input",
    "viewer",
    "live",
    "live-render",
    "live-scene",
    "place",
    "grid",
];

/// Where the template has the model, which is written directly to save memory.
const MODEL: &str = "{{ model }}";

/// Writes the page. `page` is for the template, `model` for the scripts, `payloads` are texels,
/// `light` is for the Live view.
pub fn render(
    writer: &mut impl Write,
    page: &impl Serialize,
    model: &impl Serialize,
    payloads: Vec<String>,
    light: &Light,
) -> std::io::Result<()> {
    let (before, behind) = TEMPLATE
        .split_once(MODEL)
        .expect("the template holds the model");
    let mut environment = Environment::new();
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    environment.add_filter("whole_units", whole_units);
    for (name, text) in [("before", before), ("behind", behind), ("stage", STAGE)] {
        environment.add_template(name, text).map_err(Error::other)?;
    }
    let context = context! {
        page => Serde(page),
        style => safe(style()),
        imports => safe(in_script(&json!({ "imports": imports() }))),
        shaders => safe(in_script(&json!(shaders(light)))),
        light => safe(in_script(&json!(light))),
        payloads => payloads.into_iter().map(safe).collect::<Vec<_>>(),
    };
    let write_part = |name: &str, writer: &mut dyn Write| {
        environment
            .get_template(name)
            .and_then(|template| template.render_captured_to(&context, writer).map(drop))
            .map_err(Error::other)
    };
    write_part("before", writer)?;
    serde_json::to_writer(Script(&mut *writer), model)?;
    write_part("behind", writer)
}

/// The modules as data URLs, by import name.
fn imports() -> BTreeMap<&'static str, String> {
    MODULES
        .iter()
        .map(|(name, text)| {
            let base64 = BASE64_STANDARD.encode(text);
            (*name, format!("data:text/javascript;base64,{base64}"))
        })
        .collect()
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
    let methods = light.methods.iter().map(|method| method.name.as_str());
    let wanted: BTreeSet<&str> = layouts
        .chain(models)
        .chain(methods)
        .chain([Method::SHEEN_LOOKUP.name])
        .collect();
    let is_wanted = |name: &str| name.split(':').skip(1).all(|part| wanted.contains(part));
    let mut shaders = BTreeMap::new();
    for entry in sources.entries() {
        if !entry.starts_with(PAGE_FOLDER) {
            continue;
        }
        let permutations = sources
            .permutations(entry, &Choice::new())
            .expect("every file that a shader includes is there");
        for (name, choice) in permutations {
            if is_wanted(&name) {
                let text = sources
                    .expand(entry, &choice, Language::Es)
                    .expect("its permutation was found");
                shaders.insert(page_name(&name), text);
            }
        }
    }
    shaders.extend(light.shaders.clone());
    shaders
}

/// The style of all pages, with its fonts.
pub fn style() -> String {
    FONTS.iter().map(Font::css).collect::<String>() + STYLE
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
        for (index, part) in bytes.split(|byte| *byte == b'<').enumerate() {
            if index > 0 {
                self.0.write_all(b"\\u003c")?;
            }
            self.0.write_all(part)?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.0.flush()
    }
}
