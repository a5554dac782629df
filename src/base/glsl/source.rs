//! The texts of the shaders, and their compilation to SPIR-V. The build script compiles all of
//! `shaders/` with this file; the program compiles methods in files of the user.
//!
//! An entry point is a `.comp`, `.vert` or `.frag` file. `#include "path"` is relative to
//! `shaders/`; each file is included once. Two folders are virtual: `generated/` holds the text of
//! `src/base/glsl`; `selected/` is a choice, with one permutation per candidate:
//!
//! | include | candidates: every file of |
//! |---|---|
//! | `selected/brdf.glsl` | `brdf/` |
//! | `selected/method.glsl` | `shade/method/`, and one for each name in a `#pragma methods` line |
//! | `selected/diffuse.glsl` | `shade/diffuse/` |
//! | `selected/lobe.glsl` | `shade/lobe/` |
//! | `selected/map_layout.glsl` | `map_layout/` |
//!
//! A permutation is named `<entry>[:<candidate>]...`, in the order of the includes, stems with `-`
//! for `_`.

use super::constants::FILE_PREFIX;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::Path;
use std::{fs, io};

/// Folders of the candidates of each `selected/` include.
const SELECTIONS: [(&str, &str); 5] = [
    ("selected/brdf.glsl", "brdf"),
    ("selected/method.glsl", "shade/method"),
    ("selected/diffuse.glsl", "shade/diffuse"),
    ("selected/lobe.glsl", "shade/lobe"),
    ("selected/map_layout.glsl", "map_layout"),
];

/// The include of the specular method.
pub const METHOD_INCLUDE: &str = "selected/method.glsl";

/// Entry points of the report's page.
pub const PAGE_FOLDER: &str = "page/";

/// Included first in the program's own texts for Vulkan. Not beside a file of the user: its
/// macros would collide with the user's (engines define `textureLod`).
const VULKAN_PRELUDE: &str = "lib/device_limits.glsl";

/// Included first in texts for GLSL ES.
const ES_PRELUDE: &str = "page/es.glsl";

#[derive(Clone, Copy, PartialEq)]
pub enum Language {
    Vulkan,
    /// GLSL ES 3.00, of the report's page.
    Es,
}

/// The file behind each `selected/` include in one permutation.
pub type Choice = BTreeMap<String, String>;

pub struct Sources(pub BTreeMap<String, String>);

/// A shader before its compilation.
pub struct ExpandedShader {
    /// Of the permutation.
    pub name: String,
    /// The text with all includes.
    pub text: String,
    entry: String,
}

impl ExpandedShader {
    /// Compiles a text for Vulkan to SPIR-V; the error is the compiler's log.
    pub fn compile(&self) -> Result<Vec<u32>, String> {
        compile(&self.entry, &self.text)
    }
}

/// Most entries of a folder of shaders and of the folders in it: a folder of something else ends
/// soon.
const ENTRY_COUNT_MAX: usize = 10_000;
/// Largest shader, bytes.
const TEXT_BYTES_MAX: u64 = 1 << 20;

impl Sources {
    /// Reads every shader below `root` by its relative path, and adds the methods of `#pragma
    /// methods` lines. Links and hidden files, such as the locks of editors, are skipped.
    pub fn read(root: &Path) -> Result<Self, String> {
        let mut texts = BTreeMap::new();
        let mut folders = vec![root.to_path_buf()];
        let mut entry_count = 0;
        while let Some(folder) = folders.pop() {
            let fault = |e: io::Error| format!("{}: {e}", folder.display());
            for entry in fs::read_dir(&folder).map_err(fault)? {
                entry_count += 1;
                if entry_count > ENTRY_COUNT_MAX {
                    return Err(format!(
                        "more than {ENTRY_COUNT_MAX} files; expected a folder of shaders"
                    ));
                }
                let entry = entry.map_err(fault)?;
                let path = entry.path();
                let kind = entry.file_type().map_err(fault)?;
                let name = path.strip_prefix(root).unwrap_or(&path).to_string_lossy();
                if entry.file_name().to_string_lossy().starts_with('.') {
                    continue;
                } else if kind.is_dir() {
                    folders.push(path);
                } else if kind.is_file() && (stage(&name).is_some() || name.ends_with(".glsl")) {
                    texts.insert(name.replace('\\', "/"), read_text(&path)?);
                }
            }
        }
        let methods: Vec<_> = texts
            .iter()
            .flat_map(|(path, text)| methods_of(path, text))
            .collect();
        texts.extend(methods);
        Ok(Self(texts))
    }

    /// Expands every permutation of the entry points of a language.
    pub fn shaders(&self, language: Language) -> Result<Vec<ExpandedShader>, String> {
        let mut shaders = Vec::new();
        let is_es = language == Language::Es;
        for entry in self
            .entries()
            .filter(|entry| entry.starts_with(PAGE_FOLDER) == is_es)
        {
            for (name, choice) in self.permutations(entry, &Choice::new())? {
                shaders.push(ExpandedShader {
                    name,
                    text: self.expand(entry, &choice, language)?,
                    entry: entry.to_owned(),
                });
            }
        }
        Ok(shaders)
    }

    /// Lists the paths of all entry points, sorted.
    pub fn entries(&self) -> impl Iterator<Item = &str> {
        self.0
            .keys()
            .map(String::as_str)
            .filter(|path| stage(path).is_some())
    }

    fn text(&self, path: &str) -> Result<&str, String> {
        self.0
            .get(path)
            .map(String::as_str)
            .ok_or_else(|| format!("there is no {path} to include"))
    }

    /// Lists the permutations of an entry point that extend a choice: name and whole choice.
    pub fn permutations(
        &self,
        entry: &str,
        chosen: &Choice,
    ) -> Result<Vec<(String, Choice)>, String> {
        let mut done = Vec::new();
        let mut open = vec![(entry.to_string(), chosen.clone())];
        while let Some((name, choice)) = open.pop() {
            let Some(include) = self.first_unresolved(entry, &choice)? else {
                done.push((name, choice));
                continue;
            };
            let (_, folder) = SELECTIONS
                .iter()
                .find(|(known, _)| *known == include)
                .ok_or_else(|| {
                    let known = SELECTIONS.map(|(known, _)| known).join(", ");
                    format!("{entry}: there is no {include}; expected {known}")
                })?;
            for stem in self.stems(folder) {
                let mut choice = choice.clone();
                choice.insert(include.clone(), format!("{folder}/{stem}.glsl"));
                open.push((format!("{name}:{}", stem.replace('_', "-")), choice));
            }
        }
        done.sort();
        Ok(done)
    }

    /// Lists the stems of a folder's `.glsl` files, sorted.
    fn stems(&self, folder: &str) -> impl Iterator<Item = &str> {
        self.0.keys().filter_map(move |path| {
            path.strip_prefix(folder)?
                .strip_prefix('/')?
                .strip_suffix(".glsl")
        })
    }

    /// Finds the first `selected/` include reached from `entry` that `choice` leaves open.
    fn first_unresolved(&self, entry: &str, choice: &Choice) -> Result<Option<String>, String> {
        let mut visited = BTreeSet::new();
        let mut open = vec![entry.to_string()];
        while let Some(path) = open.pop() {
            let path = choice.get(&path).cloned().unwrap_or(path);
            if path.starts_with("selected/") {
                return Ok(Some(path));
            }
            if visited.insert(path.clone()) {
                for (index, line) in self
                    .text(&path)?
                    .lines()
                    .enumerate()
                    .collect::<Vec<_>>()
                    .into_iter()
                    .rev()
                {
                    let Some(include) = included(line) else {
                        continue;
                    };
                    if !include.starts_with("selected/") {
                        self.text(include)
                            .map_err(|e| format!("{}:{}: {e}", shown(&path), index + 1))?;
                    }
                    open.push(include.to_string());
                }
            }
        }
        Ok(None)
    }

    /// Expands all includes into one text. `#line` keeps line numbers if the language supports file
    /// names in it.
    pub fn expand(
        &self,
        entry: &str,
        choice: &Choice,
        language: Language,
    ) -> Result<String, String> {
        let version = match language {
            Language::Vulkan => {
                "#version 460\n#extension GL_GOOGLE_cpp_style_line_directive : require\n"
            }
            Language::Es => "#version 300 es\n",
        };
        let has_user_file = self.0.keys().any(|path| path.starts_with(FILE_PREFIX));
        let prelude = match language {
            Language::Vulkan => (!has_user_file).then_some(VULKAN_PRELUDE),
            Language::Es => Some(ES_PRELUDE),
        };
        let has_lines = language == Language::Vulkan;
        let mut expansion = Expansion {
            sources: self,
            choice,
            has_lines,
            done: BTreeSet::new(),
            text: version.to_string(),
        };
        for path in prelude.into_iter().chain([entry]) {
            expansion.append(path)?;
        }
        Ok(expansion.text)
    }
}

fn read_text(path: &Path) -> Result<String, String> {
    let fault = |what: String| format!("{}: {what}", path.display());
    let bytes = fs::metadata(path).map_err(|e| fault(e.to_string()))?.len();
    if bytes > TEXT_BYTES_MAX {
        return Err(fault(format!(
            "{bytes} bytes; expected at most {TEXT_BYTES_MAX}"
        )));
    }
    let bytes = fs::read(path).map_err(|e| fault(e.to_string()))?;
    String::from_utf8(bytes).map_err(|_| fault("not UTF-8 text".to_owned()))
}

/// Makes a file of `shade/method/` for each method in a file's `#pragma methods` line: it defines
/// the name in capitals.
fn methods_of(path: &str, text: &str) -> Vec<(String, String)> {
    let names = text
        .lines()
        .filter_map(|line| line.strip_prefix("#pragma methods "))
        .flat_map(str::split_whitespace);
    let stems = names.map(|name| name.replace('-', "_"));
    stems
        .map(|stem| {
            let text = format!("#define {}\n#include \"{path}\"\n", stem.to_uppercase());
            (format!("shade/method/{stem}.glsl"), text)
        })
        .collect()
}

struct Expansion<'a> {
    sources: &'a Sources,
    choice: &'a Choice,
    /// Whether the language supports `#line` with a file name.
    has_lines: bool,
    /// Files that are in the text.
    done: BTreeSet<String>,
    text: String,
}

impl Expansion<'_> {
    fn append(&mut self, path: &str) -> Result<(), String> {
        let path = self.choice.get(path).map_or(path, String::as_str);
        if !self.done.insert(path.to_string()) {
            return Ok(());
        }
        self.line(1, path);
        for (index, line) in self.sources.text(path)?.lines().enumerate() {
            if let Some(include) = included(line) {
                self.append(include)?;
                self.line(index + 2, path);
            } else if line.starts_with("#version")
                || line.starts_with("#extension GL_GOOGLE_include")
            {
                self.text.push('\n'); // `expand` writes both
            } else {
                self.text.push_str(line);
                self.text.push('\n');
            }
        }
        Ok(())
    }

    /// Marks the line and file that follow.
    fn line(&mut self, number: usize, path: &str) {
        if self.has_lines {
            writeln!(self.text, "#line {number} \"{}\"", shown(path)).expect("a String takes all");
        }
    }
}

fn shown(path: &str) -> String {
    path.strip_prefix(FILE_PREFIX)
        .map_or_else(|| format!("shaders/{path}"), str::to_owned)
}

fn included(line: &str) -> Option<&str> {
    line.trim_start()
        .strip_prefix("#include")?
        .trim()
        .strip_prefix('"')?
        .strip_suffix('"')
}

fn stage(entry: &str) -> Option<glslang::ShaderStage> {
    match Path::new(entry).extension()?.to_str()? {
        "comp" => Some(glslang::ShaderStage::Compute),
        "vert" => Some(glslang::ShaderStage::Vertex),
        "frag" => Some(glslang::ShaderStage::Fragment),
        _ => None,
    }
}

/// Returns the compiler, which is started once per process.
pub fn compiler() -> Result<&'static glslang::Compiler, String> {
    glslang::Compiler::acquire().ok_or_else(|| "glslang does not initialise".into())
}

/// Compiles an expanded text to SPIR-V; the error names file and line.
pub fn compile(entry: &str, text: &str) -> Result<Vec<u32>, String> {
    let (shader, stage) = parse(entry, text, Language::Vulkan)?;
    let mut program = compiler()?.create_program();
    program.add_shader(&shader);
    program.compile(stage).map_err(|e| e.to_string())
}

/// Returns the first error of a compiler's log: `FILE:LINE: message`.
pub fn first_error(log: &str) -> &str {
    log.lines()
        .find_map(|line| {
            let (_, error) = line.split_once("ERROR: ")?;
            Some(error.trim())
        })
        .unwrap_or_else(|| log.trim())
}

pub fn parse(
    entry: &str,
    text: &str,
    language: Language,
) -> Result<(glslang::Shader<'static>, glslang::ShaderStage), String> {
    let stage = stage(entry).ok_or("not a shader entry point")?;
    let (target, version_profile) = match language {
        Language::Vulkan => (
            glslang::Target::Vulkan {
                version: glslang::VulkanVersion::Vulkan1_3,
                spirv_version: glslang::SpirvVersion::SPIRV1_6,
            },
            None,
        ),
        Language::Es => (
            glslang::Target::None(None),
            Some((300, glslang::GlslProfile::ES)),
        ),
    };
    let options = glslang::CompilerOptions {
        source_language: glslang::SourceLanguage::GLSL,
        target,
        version_profile,
        messages: glslang::ShaderMessage::DEFAULT,
    };
    let source = glslang::ShaderSource::from(text);
    let input = glslang::ShaderInput::new(
        &source,
        stage,
        &options,
        None::<&[(&str, Option<&str>)]>,
        None,
    )
    .map_err(|e| e.to_string())?;
    Ok((
        compiler()?
            .create_shader(input)
            .map_err(|e| e.to_string())?,
        stage,
    ))
}
