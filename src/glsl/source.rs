//! The texts of the shaders, and how one becomes SPIR-V. The build script compiles with this file all that stands in `shaders/`; the
//! program compiles with it a method in a file of its user's.
//!
//! An entry point is a `.comp`, `.vert` or `.frag` file. `#include "path"` is relative to `shaders/`. Two folders are virtual:
//! `generated/` holds the text of `src/glsl`, and `selected/` stands for a choice that makes one permutation per candidate:
//!
//! | include | candidates: every file of |
//! |---|---|
//! | `selected/brdf.glsl` | `brdf/` |
//! | `selected/method.glsl` | `shade/method/`, and one for each name in a `#pragma methods` line |
//! | `selected/diffuse.glsl` | `shade/diffuse/` |
//! | `selected/lobe.glsl` | `shade/lobe/` |
//! | `selected/map_layout.glsl` | `map_layout/` |
//!
//! A permutation is named `<entry>[:<candidate>]...`, candidates in the order in which their includes are met, stems with `-` for `_`.

use super::constants::FILE_PREFIX;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::Path;

/// Where the candidates of each `selected/` include live.
const SELECTIONS: [(&str, &str); 5] = [
    ("selected/brdf.glsl", "brdf"),
    ("selected/method.glsl", "shade/method"),
    ("selected/diffuse.glsl", "shade/diffuse"),
    ("selected/lobe.glsl", "shade/lobe"),
    ("selected/map_layout.glsl", "map_layout"),
];

/// The include that stands for the specular method.
pub const METHOD_INCLUDE: &str = "selected/method.glsl";

/// The folder of the entry points of the report's page.
pub const PAGE_FOLDER: &str = "page/";

/// What comes first in a text for it.
const ES_PRELUDE: &str = "page/es.glsl";

/// What a text is written for.
#[derive(Clone, Copy, PartialEq)]
pub enum Language {
    Vulkan,
    /// GLSL ES 3.00.
    Es,
}

/// The file that stands behind each `selected/` include in one permutation.
pub type Choice = BTreeMap<String, String>;

/// Shader texts by path.
pub struct Sources(pub BTreeMap<String, String>);

impl Sources {
    /// Paths of all entry points, sorted.
    pub fn entries(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str).filter(|path| stage(path).is_some())
    }

    fn text(&self, path: &str) -> Result<&str, String> {
        self.0.get(path).map(String::as_str).ok_or_else(|| format!("there is no {path} to include"))
    }

    /// Every permutation of an entry point with what is chosen already: its name, and the whole choice.
    pub fn permutations(&self, entry: &str, chosen: &Choice) -> Result<Vec<(String, Choice)>, String> {
        let (mut done, mut open) = (Vec::new(), vec![(entry.to_string(), chosen.clone())]);
        while let Some((name, choice)) = open.pop() {
            let Some(include) = self.first_unresolved(entry, &choice)? else {
                done.push((name, choice));
                continue;
            };
            let (_, folder) = SELECTIONS
                .iter()
                .find(|(known, _)| *known == include)
                .ok_or_else(|| format!("{entry}: {include} is not one of {SELECTIONS:?}"))?;
            for stem in self.stems(folder) {
                let mut choice = choice.clone();
                choice.insert(include.clone(), format!("{folder}/{stem}.glsl"));
                open.push((format!("{name}:{}", stem.replace('_', "-")), choice));
            }
        }
        done.sort();
        Ok(done)
    }

    /// Sorted stems of the `.glsl` files of a folder.
    fn stems(&self, folder: &str) -> impl Iterator<Item = &str> {
        self.0.keys().filter_map(move |path| path.strip_prefix(folder)?.strip_prefix('/')?.strip_suffix(".glsl"))
    }

    /// The first `selected/` include that is reached from `entry` and that `choice` leaves open.
    fn first_unresolved(&self, entry: &str, choice: &Choice) -> Result<Option<String>, String> {
        let (mut seen, mut open) = (BTreeSet::new(), vec![entry.to_string()]);
        while let Some(path) = open.pop() {
            let path = choice.get(&path).cloned().unwrap_or(path);
            if path.starts_with("selected/") {
                return Ok(Some(path));
            }
            if seen.insert(path.clone()) {
                for (index, line) in self.text(&path)?.lines().enumerate().collect::<Vec<_>>().into_iter().rev() {
                    let Some(include) = included(line) else { continue };
                    if !include.starts_with("selected/") {
                        self.text(include).map_err(|e| format!("{}:{}: {e}", shown(&path), index + 1))?;
                    }
                    open.push(include.to_string());
                }
            }
        }
        Ok(None)
    }

    /// One text with every include in place, line numbers kept by `#line` where the language has it with file names.
    pub fn expand(&self, entry: &str, choice: &Choice, language: Language) -> Result<String, String> {
        let (version, first) = match language {
            Language::Vulkan => ("#version 460\n#extension GL_GOOGLE_cpp_style_line_directive : require\n", None),
            Language::Es => ("#version 300 es\n", Some(ES_PRELUDE)),
        };
        let mut text = Expanded { text: version.to_string(), has_lines: language == Language::Vulkan };
        let mut done = BTreeSet::new();
        for path in first.into_iter().chain([entry]) {
            self.append(path, choice, &mut done, &mut text)?;
        }
        Ok(text.text)
    }

    fn append(
        &self,
        path: &str,
        choice: &Choice,
        done: &mut BTreeSet<String>,
        expanded: &mut Expanded,
    ) -> Result<(), String> {
        let path = choice.get(path).map_or(path, String::as_str);
        if !done.insert(path.to_string()) {
            return Ok(()); // each file once, as its include guard says
        }
        expanded.line(1, path);
        for (index, line) in self.text(path)?.lines().enumerate() {
            if let Some(include) = included(line) {
                self.append(include, choice, done, expanded)?;
                expanded.line(index + 2, path);
            } else if line.starts_with("#version") || line.starts_with("#extension GL_GOOGLE_include") {
                expanded.text.push('\n'); // every text gets its version above
            } else {
                expanded.text.push_str(line);
                expanded.text.push('\n');
            }
        }
        Ok(())
    }
}

/// A text that grows.
struct Expanded {
    text: String,
    /// Whether the language takes `#line` with a file's name.
    has_lines: bool,
}

impl Expanded {
    /// Says which line of which file follows.
    fn line(&mut self, number: usize, path: &str) {
        if self.has_lines {
            writeln!(self.text, "#line {number} \"{}\"", shown(path)).expect("a String takes all");
        }
    }
}

/// A path as messages have it.
fn shown(path: &str) -> String {
    path.strip_prefix(FILE_PREFIX).map_or_else(|| format!("shaders/{path}"), str::to_owned)
}

/// The path of an `#include "path"` line.
fn included(line: &str) -> Option<&str> {
    line.trim_start().strip_prefix("#include")?.trim().strip_prefix('"')?.strip_suffix('"')
}

fn stage(entry: &str) -> Option<glslang::ShaderStage> {
    match Path::new(entry).extension()?.to_str()? {
        "comp" => Some(glslang::ShaderStage::Compute),
        "vert" => Some(glslang::ShaderStage::Vertex),
        "frag" => Some(glslang::ShaderStage::Fragment),
        _ => None,
    }
}

/// The compiler, which a process starts once.
pub fn compiler() -> Result<&'static glslang::Compiler, String> {
    glslang::Compiler::acquire().ok_or_else(|| "glslang does not initialise".into())
}

/// SPIR-V of an expanded text; its error names file and line.
pub fn compile(entry: &str, text: &str) -> Result<Vec<u32>, String> {
    let (shader, stage) = parse(entry, text, Language::Vulkan)?;
    let mut program = compiler()?.create_program();
    program.add_shader(&shader);
    program.compile(stage).map_err(|e| e.to_string())
}

/// Reads and checks a text.
pub fn parse(
    entry: &str,
    text: &str,
    language: Language,
) -> Result<(glslang::Shader<'static>, glslang::ShaderStage), String> {
    let stage = stage(entry).ok_or("not a shader entry point")?;
    let (target, version_profile) = match language {
        Language::Vulkan => {
            let (version, spirv_version) = (glslang::VulkanVersion::Vulkan1_3, glslang::SpirvVersion::SPIRV1_6);
            (glslang::Target::Vulkan { version, spirv_version }, None)
        }
        Language::Es => (glslang::Target::None(None), Some((300, glslang::GlslProfile::ES))),
    };
    let options = glslang::CompilerOptions {
        source_language: glslang::SourceLanguage::GLSL,
        target,
        version_profile,
        messages: glslang::ShaderMessage::DEFAULT,
    };
    let source = glslang::ShaderSource::from(text);
    let input = glslang::ShaderInput::new(&source, stage, &options, None::<&[(&str, Option<&str>)]>, None)
        .map_err(|e| e.to_string())?;
    Ok((compiler()?.create_shader(input).map_err(|e| e.to_string())?, stage))
}
