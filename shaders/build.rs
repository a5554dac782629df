//! Compiles every shader to SPIR-V and writes what Rust and GLSL share as GLSL text.
//!
//! An entry point is a `.comp`, `.vert` or `.frag` file. `#include "path"` is relative to `shaders/`. Two folders are virtual:
//! `generated/` holds the text of `src/glsl`, and `selected/` stands for a choice that makes one permutation per candidate:
//!
//! | include | candidates: every file of |
//! |---|---|
//! | `selected/brdf.glsl` | `brdf/` |
//! | `selected/method.glsl` | `shade/method/` |
//! | `selected/diffuse.glsl` | `shade/diffuse/` |
//! | `selected/lobe.glsl` | `shade/lobe/` |
//! | `selected/map_layout.glsl` | `map_layout/` |
//!
//! The entry points in `page/` are for the report's page: they include the same libraries, but become GLSL ES 3.00 texts, one for
//! each permutation, which the page's own compiler takes.
//!
//! A permutation is named `<entry>[:<candidate>]...`, candidates in the order in which their includes are met, stems with `-` for `_`.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

#[path = "../src/glsl/constants.rs"]
mod constants;
#[path = "../src/glsl/layout.rs"]
#[allow(dead_code)] // the structs themselves are for the crate; only their description is read here
mod layout;

/// Where the candidates of each `selected/` include live.
const SELECTIONS: [(&str, &str); 5] = [
    ("selected/brdf.glsl", "brdf"),
    ("selected/method.glsl", "shade/method"),
    ("selected/diffuse.glsl", "shade/diffuse"),
    ("selected/lobe.glsl", "shade/lobe"),
    ("selected/map_layout.glsl", "map_layout"),
];

/// Files and folders of `src` whose code makes no number that the device returns: what is done with its results, and the f64
/// twins. Kept tables and references outlive a change of these, and of nothing else.
const HOST_EXCLUDED: [&str; 17] = [
    "main.rs",
    "cli",
    "cost",
    "ladder",
    "pipeline/ladder.rs",
    "study",
    "view",
    "runner",
    "oracle",
    "slips",
    "metrics",
    "table",
    "tonemap",
    "shade/method",
    "shade/diffuse",
    "shade/twin.rs",
    "shade/reference.rs",
];

/// The folder of the page's entry points.
const PAGE_FOLDER: &str = "page/";
/// What comes first in each of them.
const ES_PRELUDE: &str = "page/es.glsl";

fn main() {
    println!("cargo::rerun-if-changed=shaders");
    println!("cargo::rerun-if-changed=src/glsl");
    println!("cargo::rerun-if-changed=Cargo.lock");
    if let Err(message) = build() {
        // A panic would bury the compiler's file:line:message under a backtrace.
        for line in message.lines() {
            println!("cargo::error={line}");
        }
        std::process::exit(1);
    }
}

fn build() -> Result<(), String> {
    let root = PathBuf::from("shaders");
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or("OUT_DIR is not set")?);
    let mut sources = Sources { root: root.clone(), texts: BTreeMap::new() };
    sources.texts.insert("generated/constants.glsl".into(), constants_text());
    sources.texts.insert("generated/layout.glsl".into(), layout_text());

    let compiler = glslang::Compiler::acquire().ok_or("glslang does not initialise")?;
    let (page_entries, device_entries): (Vec<_>, Vec<_>) =
        entries(&root)?.into_iter().partition(|entry| entry.starts_with(PAGE_FOLDER));
    page_shaders(&mut sources, compiler, &page_entries, &out)?;
    let mut table = String::from("pub static SHADERS: &[(&str, &[u8])] = &[\n");
    for entry in device_entries {
        for (name, choice) in sources.permutations(&entry)? {
            let text = sources.expand(&entry, &choice, Language::Vulkan)?;
            let spirv = compile(compiler, &entry, &text).map_err(|log| format!("{name}: {log}"))?;
            let file = out.join(format!("{}.spv", name.replace(['/', ':', '.'], "_")));
            let bytes: Vec<u8> = spirv.iter().flat_map(|word| word.to_ne_bytes()).collect();
            fs::write(&file, bytes).map_err(|e| format!("{}: {e}", file.display()))?;
            writeln!(table, "    ({name:?}, include_bytes!({:?})),", file.display().to_string())
                .expect("a String takes all");
        }
    }
    table.push_str("];\n");
    table.push_str(&host_text()?);
    fs::write(out.join("shaders.rs"), table).map_err(|e| format!("shaders.rs: {e}"))
}

/// The host's code around the shaders: names of its files, and one hash of them and of the versions of all crates.
fn host_text() -> Result<String, String> {
    let (mut found, mut open) = (Vec::new(), vec![PathBuf::from("src")]);
    while let Some(folder) = open.pop() {
        for path in files(&folder).map_err(|e| format!("{}: {e}", folder.display()))? {
            let name = path.strip_prefix("src").map_err(|e| e.to_string())?.to_string_lossy().replace('\\', "/");
            if HOST_EXCLUDED.contains(&name.as_str()) {
                continue;
            } else if path.is_dir() {
                open.push(path);
            } else {
                println!("cargo::rerun-if-changed={}", path.display());
                found.push((name, fs::read(&path).map_err(|e| format!("{}: {e}", path.display()))?));
            }
        }
    }
    found.sort();
    let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
    let mut text =
        format!("/// Files of src that results of the device hang on.\npub static HOST_FILES: &[&str] = &{names:?};\n");
    let lock = fs::read("Cargo.lock").unwrap_or_default();
    found.push(("Cargo.lock".into(), lock));
    let mut hasher = blake3::Hasher::new();
    for (name, bytes) in &found {
        hasher.update(name.as_bytes()).update(&(bytes.len() as u64).to_le_bytes()).update(bytes);
    }
    writeln!(
        text,
        "/// One hash of them and of Cargo.lock.\npub static HOST_HASH: &str = {:?};",
        hasher.finalize().to_hex().as_str()
    )
    .expect("a String takes all");
    Ok(text)
}

/// Writes `page_shaders.rs`: the text of every permutation of the page's entry points, checked as GLSL ES 3.00.
fn page_shaders(
    sources: &mut Sources,
    compiler: &'static glslang::Compiler,
    entries: &[String],
    out: &Path,
) -> Result<(), String> {
    let mut table = String::from("pub static PAGE_SHADERS: &[(&str, &str)] = &[\n");
    for entry in entries {
        for (name, choice) in sources.permutations(entry)? {
            let text = sources.expand(entry, &choice, Language::Es)?;
            parse(compiler, entry, &text, Language::Es).map_err(|log| format!("{name}: {log}"))?;
            let file = out.join(format!("{}.es", name.replace(['/', ':', '.'], "_")));
            fs::write(&file, text).map_err(|e| format!("{}: {e}", file.display()))?;
            let name = name.trim_start_matches(PAGE_FOLDER).replace(".frag", "");
            writeln!(table, "    ({name:?}, include_str!({:?})),", file.display().to_string())
                .expect("a String takes all");
        }
    }
    table.push_str("];\n");
    fs::write(out.join("page_shaders.rs"), table).map_err(|e| format!("page_shaders.rs: {e}"))
}

/// What a text is written for.
#[derive(Clone, Copy, PartialEq)]
enum Language {
    Vulkan,
    /// GLSL ES 3.00.
    Es,
}

/// The file that stands behind each `selected/` include in one permutation.
type Choice = BTreeMap<String, String>;

/// Shader texts by path, read once.
struct Sources {
    root: PathBuf,
    texts: BTreeMap<String, String>,
}

impl Sources {
    fn text(&mut self, path: &str) -> Result<String, String> {
        if let Some(text) = self.texts.get(path) {
            return Ok(text.clone());
        }
        let text = fs::read_to_string(self.root.join(path)).map_err(|e| format!("shaders/{path}: {e}"))?;
        self.texts.insert(path.into(), text.clone());
        Ok(text)
    }

    /// Every permutation of an entry point.
    fn permutations(&mut self, entry: &str) -> Result<Vec<(String, Choice)>, String> {
        let (mut done, mut open) = (Vec::new(), vec![(entry.to_string(), Choice::new())]);
        while let Some((name, choice)) = open.pop() {
            let Some(include) = self.first_unresolved(entry, &choice)? else {
                done.push((name, choice));
                continue;
            };
            let (_, folder) = SELECTIONS
                .iter()
                .find(|(known, _)| *known == include)
                .ok_or_else(|| format!("shaders/{entry}: {include} is not one of {SELECTIONS:?}"))?;
            for stem in stems(&self.root.join(folder))? {
                let mut choice = choice.clone();
                choice.insert(include.clone(), format!("{folder}/{stem}.glsl"));
                open.push((format!("{name}:{}", stem.replace('_', "-")), choice));
            }
        }
        done.sort();
        Ok(done)
    }

    /// The first `selected/` include that is reached from `entry` and that `choice` leaves open.
    fn first_unresolved(&mut self, entry: &str, choice: &Choice) -> Result<Option<String>, String> {
        let (mut seen, mut open) = (BTreeSet::new(), vec![entry.to_string()]);
        while let Some(path) = open.pop() {
            let path = choice.get(&path).cloned().unwrap_or(path);
            if path.starts_with("selected/") {
                return Ok(Some(path));
            }
            if seen.insert(path.clone()) {
                let text = self.text(&path)?;
                open.extend(text.lines().rev().filter_map(included).map(str::to_string));
            }
        }
        Ok(None)
    }

    /// One text with every include in place, line numbers kept by `#line` where the language has it with file names.
    fn expand(&mut self, entry: &str, choice: &Choice, language: Language) -> Result<String, String> {
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
        &mut self,
        path: &str,
        choice: &Choice,
        done: &mut BTreeSet<String>,
        expanded: &mut Expanded,
    ) -> Result<(), String> {
        let path = choice.get(path).map_or(path, String::as_str).to_string();
        if !done.insert(path.clone()) {
            return Ok(()); // each file once, as its include guard says
        }
        expanded.line(1, &path);
        for (index, line) in self.text(&path)?.lines().enumerate() {
            if let Some(include) = included(line) {
                self.append(include, choice, done, expanded)?;
                expanded.line(index + 2, &path);
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
            writeln!(self.text, "#line {number} \"shaders/{path}\"").expect("a String takes all");
        }
    }
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

fn compile(compiler: &'static glslang::Compiler, entry: &str, text: &str) -> Result<Vec<u32>, String> {
    let (shader, stage) = parse(compiler, entry, text, Language::Vulkan)?;
    let mut program = compiler.create_program();
    program.add_shader(&shader);
    program.compile(stage).map_err(|e| e.to_string())
}

/// Reads and checks a text.
fn parse(
    compiler: &'static glslang::Compiler,
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
    Ok((compiler.create_shader(input).map_err(|e| e.to_string())?, stage))
}

fn constants_text() -> String {
    let mut text = String::from("// Written by shaders/build.rs from src/glsl/constants.rs.\n");
    for (name, value) in constants::ALL {
        match value {
            constants::Value::Float(x) => writeln!(text, "const float {name} = {x:e};"),
            constants::Value::Uint(x) => writeln!(text, "const uint {name} = {x}u;"),
        }
        .expect("a String takes all");
    }
    text
}

fn layout_text() -> String {
    let mut text = String::from("// Written by shaders/build.rs from src/glsl/layout.rs.\n");
    for shared in layout::ALL {
        writeln!(text, "struct {} {{", shared.name).expect("a String takes all");
        for member in shared.members {
            writeln!(text, "    {} {};", member.ty, member.name).expect("a String takes all");
        }
        text.push_str("};\n");
    }
    text
}

/// Sorted stems of the `.glsl` files of a folder.
fn stems(folder: &Path) -> Result<Vec<String>, String> {
    let mut stems: Vec<String> = files(folder)
        .map_err(|e| format!("{}: {e}", folder.display()))?
        .iter()
        .filter(|path| path.extension().is_some_and(|e| e == "glsl"))
        .filter_map(|path| Some(path.file_stem()?.to_str()?.to_string()))
        .collect();
    stems.sort();
    Ok(stems)
}

/// Paths of all entry points below `root`, relative to it, sorted.
fn entries(root: &Path) -> Result<Vec<String>, String> {
    let mut found = Vec::new();
    let mut open = vec![root.to_path_buf()];
    while let Some(folder) = open.pop() {
        for path in files(&folder).map_err(|e| format!("{}: {e}", folder.display()))? {
            if path.is_dir() {
                open.push(path);
            } else if let Some(name) = path.strip_prefix(root).ok().and_then(Path::to_str)
                && stage(name).is_some()
            {
                found.push(name.to_string());
            }
        }
    }
    found.sort();
    Ok(found)
}

fn files(folder: &Path) -> io::Result<Vec<PathBuf>> {
    fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect()
}
