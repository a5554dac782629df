//! Compiles every shader to SPIR-V and writes what Rust and GLSL share as GLSL text.
//!
//! An entry point is a `.comp`, `.vert` or `.frag` file. `#include "path"` is relative to `shaders/`. Two folders are virtual:
//! `generated/` holds the text of `src/glsl`, and `selected/` stands for a choice that makes one permutation per candidate:
//!
//! | include | candidates |
//! |---|---|
//! | `selected/brdf.glsl` | every file of `brdf/` |
//! | `selected/method.glsl` | every file of `shade/method/` |
//! | `selected/diffuse.glsl` | every file of `shade/diffuse/` |
//! | `selected/lobe.glsl` | `lib/specular_lobe.glsl` with every file of `brdf/`, and `lib/lambert.glsl` |
//!
//! A permutation is named `<entry>[:<method>][:<diffuse>][:<brdf or lambert>]`, stems with `-` for `_`.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

#[path = "../src/glsl/constants.rs"]
mod constants;
#[path = "../src/glsl/layout.rs"]
#[allow(dead_code)] // the structs themselves are for the crate; only their description is read here
mod layout;

const LAMBERT: &str = "lambert";

fn main() {
    println!("cargo::rerun-if-changed=shaders");
    println!("cargo::rerun-if-changed=src/glsl");
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

    let candidates = Candidates {
        brdf: stems(&root.join("brdf"))?,
        method: stems(&root.join("shade/method"))?,
        diffuse: stems(&root.join("shade/diffuse"))?,
    };
    let compiler = glslang::Compiler::acquire().ok_or("glslang does not initialise")?;
    let mut table = String::from("pub static SHADERS: &[(&str, &[u8])] = &[\n");
    for entry in entries(&root)? {
        for (name, choice) in candidates.permutations(&entry, &sources.selections(&entry)?) {
            let text = sources.expand(&entry, &choice)?;
            let spirv = compile(compiler, &entry, &text).map_err(|log| format!("{name}: {log}"))?;
            let file = out.join(format!("{}.spv", name.replace(['/', ':', '.'], "_")));
            let bytes: Vec<u8> = spirv.iter().flat_map(|word| word.to_ne_bytes()).collect();
            fs::write(&file, bytes).map_err(|e| format!("{}: {e}", file.display()))?;
            writeln!(table, "    ({name:?}, include_bytes!({:?})),", file.display().to_string())
                .expect("a String takes all");
        }
    }
    table.push_str("];\n");
    for (list, stems) in
        [("BRDF_STEMS", &candidates.brdf), ("METHOD_STEMS", &candidates.method), ("DIFFUSE_STEMS", &candidates.diffuse)]
    {
        let names: Vec<String> = stems.iter().map(|stem| stem.replace('_', "-")).collect();
        writeln!(
            table,
            "/// Shader files that stand behind a list of names.\npub static {list}: &[&str] = &{names:?};"
        )
        .expect("a String takes all");
    }
    fs::write(out.join("shaders.rs"), table).map_err(|e| format!("shaders.rs: {e}"))
}

/// What stands behind each `selected/` include in one permutation.
#[derive(Clone, Default)]
struct Choice {
    files: BTreeMap<&'static str, String>,
}

struct Candidates {
    brdf: Vec<String>,
    method: Vec<String>,
    diffuse: Vec<String>,
}

impl Candidates {
    fn permutations(&self, entry: &str, selections: &BTreeSet<String>) -> Vec<(String, Choice)> {
        let mut all = vec![(entry.to_string(), Choice::default())];
        let mut cross = |key: &'static str, options: Vec<(String, Vec<(&'static str, String)>)>| {
            if selections.contains(key) {
                all = all
                    .iter()
                    .flat_map(|(name, choice)| {
                        options.iter().map(move |(stem, files)| {
                            let mut choice = choice.clone();
                            choice.files.extend(files.iter().cloned());
                            (format!("{name}:{}", stem.replace('_', "-")), choice)
                        })
                    })
                    .collect();
            }
        };
        let brdf = |stem: &String| ("selected/brdf.glsl", format!("brdf/{stem}.glsl"));
        cross(
            "selected/method.glsl",
            self.method
                .iter()
                .map(|s| (s.clone(), vec![("selected/method.glsl", format!("shade/method/{s}.glsl"))]))
                .collect(),
        );
        cross(
            "selected/diffuse.glsl",
            self.diffuse
                .iter()
                .map(|s| (s.clone(), vec![("selected/diffuse.glsl", format!("shade/diffuse/{s}.glsl"))]))
                .collect(),
        );
        if selections.contains("selected/lobe.glsl") {
            let specular =
                |s: &String| (s.clone(), vec![("selected/lobe.glsl", "lib/specular_lobe.glsl".to_string()), brdf(s)]);
            let lambert = (LAMBERT.to_string(), vec![("selected/lobe.glsl", "lib/lambert.glsl".to_string())]);
            cross("selected/lobe.glsl", self.brdf.iter().map(specular).chain([lambert]).collect());
        } else {
            cross("selected/brdf.glsl", self.brdf.iter().map(|s| (s.clone(), vec![brdf(s)])).collect());
        }
        all
    }
}

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

    /// Every `selected/` include reached without passing through another one.
    fn selections(&mut self, entry: &str) -> Result<BTreeSet<String>, String> {
        let mut found = BTreeSet::new();
        let (mut seen, mut open) = (BTreeSet::new(), vec![entry.to_string()]);
        while let Some(path) = open.pop() {
            if path.starts_with("selected/") {
                found.insert(path);
            } else if seen.insert(path.clone()) {
                open.extend(self.text(&path)?.lines().filter_map(included).map(str::to_string));
            }
        }
        Ok(found)
    }

    /// One text with every include in place, line numbers kept by `#line`.
    fn expand(&mut self, entry: &str, choice: &Choice) -> Result<String, String> {
        let mut text = String::from("#version 460\n#extension GL_GOOGLE_cpp_style_line_directive : require\n");
        let mut done = BTreeSet::new();
        self.append(entry, choice, &mut done, &mut text)?;
        Ok(text)
    }

    fn append(
        &mut self,
        path: &str,
        choice: &Choice,
        done: &mut BTreeSet<String>,
        text: &mut String,
    ) -> Result<(), String> {
        let path = choice.files.get(path).map_or(path, String::as_str).to_string();
        if path.starts_with("selected/") {
            return Err(format!("{path} is not a known selection"));
        }
        if !done.insert(path.clone()) {
            return Ok(()); // each file once, as its include guard says
        }
        writeln!(text, "#line 1 \"shaders/{path}\"").expect("a String takes all");
        for (index, line) in self.text(&path)?.lines().enumerate() {
            if let Some(include) = included(line) {
                self.append(include, choice, done, text)?;
                writeln!(text, "#line {} \"shaders/{path}\"", index + 2).expect("a String takes all");
            } else if line.starts_with("#version") || line.starts_with("#extension GL_GOOGLE_include") {
                text.push('\n'); // every text gets its version above
            } else {
                text.push_str(line);
                text.push('\n');
            }
        }
        Ok(())
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
    let stage = stage(entry).ok_or("not a shader entry point")?;
    let options = glslang::CompilerOptions {
        source_language: glslang::SourceLanguage::GLSL,
        target: glslang::Target::Vulkan {
            version: glslang::VulkanVersion::Vulkan1_3,
            spirv_version: glslang::SpirvVersion::SPIRV1_6,
        },
        version_profile: None,
        messages: glslang::ShaderMessage::DEFAULT,
    };
    let source = glslang::ShaderSource::from(text);
    let input = glslang::ShaderInput::new(&source, stage, &options, None::<&[(&str, Option<&str>)]>, None)
        .map_err(|e| e.to_string())?;
    let shader = compiler.create_shader(input).map_err(|e| e.to_string())?;
    let mut program = compiler.create_program();
    program.add_shader(&shader);
    program.compile(stage).map_err(|e| e.to_string())
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
