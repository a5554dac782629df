//! Compiles every shader to SPIR-V and writes the definitions shared with Rust (see
//! `src/base/glsl/source.rs`) as GLSL.
//!
//! Entry points in `page/` are the report's and include the same libraries; the program writes them
//! as GLSL ES 3.00.

use source::{Language, Sources};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

#[path = "../src/base/glsl/constants.rs"]
mod constants;
#[path = "../src/base/glsl/layout.rs"]
#[allow(
    dead_code,
    reason = "the structs are for the crate; only their description is read here"
)]
mod layout;
#[path = "../src/base/glsl/source.rs"]
#[allow(dead_code, reason = "methods in files need it, in the crate")]
mod source;
#[path = "../src/base/glsl/specialization.rs"]
#[allow(
    dead_code,
    reason = "the struct is for the crate; only its description is read here"
)]
mod specialization;

/// Folders of `src` that results of the device depend on. Tables and references on disk stay valid
/// while nothing in them changes.
const HOST_FOLDERS: [&str; 2] = ["base", "instrument"];

/// The parts of these folders that work on finished images, and the f64 twins.
const HOST_EXCLUDED: [&str; 11] = [
    "instrument/ladder",
    "instrument/metrics",
    "instrument/pipeline/frames.rs",
    "instrument/pipeline/ladder.rs",
    "instrument/pipeline/reprojection.rs",
    "instrument/shade/diffuse",
    "instrument/shade/lights.rs",
    "instrument/shade/method",
    "instrument/shade/reference.rs",
    "instrument/shade/twin.rs",
    "instrument/tonemap",
];

pub fn main() {
    println!("cargo::rerun-if-changed=shaders");
    println!("cargo::rerun-if-changed=src/base/glsl");
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
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or("OUT_DIR is not set")?);
    let mut sources = Sources::read(Path::new("shaders"))?;
    sources
        .0
        .insert("generated/constants.glsl".into(), constants_text());
    sources
        .0
        .insert("generated/layout.glsl".into(), layout_text());
    sources.0.extend(specialization_texts());

    let mut table = String::from("pub static SHADERS: &[(&str, &[u8])] = &[\n");
    for shader in sources.shaders(Language::Vulkan)? {
        let name = &shader.name;
        let spirv = shader.compile().map_err(|log| format!("{name}: {log}"))?;
        let file = out.join(format!("{}.spv", name.replace(['/', ':', '.'], "_")));
        let bytes: Vec<u8> = spirv.iter().flat_map(|word| word.to_ne_bytes()).collect();
        fs::write(&file, bytes).map_err(|e| format!("{}: {e}", file.display()))?;
        writeln!(
            table,
            "    ({name:?}, include_bytes!({:?})),",
            file.display().to_string()
        )
        .expect("a String takes all");
    }
    table.push_str(
        "];\n/// The text of every shader by its path.\npub static SHADER_TEXTS: \
                    &[(&str, &str)] = &[\n",
    );
    for (path, text) in &sources.0 {
        writeln!(table, "    ({path:?}, {text:?}),").expect("a String takes all");
    }
    table.push_str("];\n");
    table.push_str(&host_text()?);
    fs::write(out.join("shaders.rs"), table).map_err(|e| format!("shaders.rs: {e}"))
}

/// Writes the names of the host's files around the shaders, and one hash of them and of the
/// versions of all crates.
fn host_text() -> Result<String, String> {
    let mut found = Vec::new();
    let mut open: Vec<PathBuf> = HOST_FOLDERS
        .map(|folder| Path::new("src").join(folder))
        .to_vec();
    while let Some(folder) = open.pop() {
        for path in files(&folder).map_err(|e| format!("{}: {e}", folder.display()))? {
            let name = path
                .strip_prefix("src")
                .map_err(|e| e.to_string())?
                .to_string_lossy()
                .replace('\\', "/");
            // Unit tests change no result.
            let is_test = path.file_name().is_some_and(|file| file == "tests.rs");
            if is_test || HOST_EXCLUDED.contains(&name.as_str()) {
                continue;
            } else if path.is_dir() {
                open.push(path);
            } else {
                println!("cargo::rerun-if-changed={}", path.display());
                found.push((
                    name,
                    fs::read(&path).map_err(|e| format!("{}: {e}", path.display()))?,
                ));
            }
        }
    }
    found.sort();
    let names: Vec<&str> = found.iter().map(|(name, _)| name.as_str()).collect();
    let mut text = format!(
        "/// Files of src that results of the device depend on.\npub static HOST_FILES: &[&str] = \
         &{names:?};\n"
    );
    let lock = fs::read("Cargo.lock").unwrap_or_default();
    found.push(("Cargo.lock".into(), lock));
    let mut hasher = blake3::Hasher::new();
    for (name, bytes) in &found {
        hasher
            .update(name.as_bytes())
            .update(&(bytes.len() as u64).to_le_bytes())
            .update(bytes);
    }
    writeln!(
        text,
        "/// One hash of them and of Cargo.lock.\npub static HOST_HASH: &str = {:?};",
        hasher.finalize().to_hex().as_str()
    )
    .expect("a String takes all");
    Ok(text)
}

fn constants_text() -> String {
    let mut text =
        String::from("// Written by shaders/compile.rs from src/base/glsl/constants.rs.\n");
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
    let mut text = String::from("// Written by shaders/compile.rs from src/base/glsl/layout.rs.\n");
    for layout::Struct { name, members } in layout::ALL {
        writeln!(text, "struct {name} {{").expect("a String takes all");
        for layout::Member { ty, name } in *members {
            writeln!(text, "    {ty} {name};").expect("a String takes all");
        }
        text.push_str("};\n");
    }
    text
}

/// Returns the path and the text of the declaration of each specialization constant.
fn specialization_texts() -> impl Iterator<Item = (String, String)> {
    let mut next_id = 0;
    specialization::ALL.iter().map(move |constant| {
        let path = format!("generated/specialization/{}.glsl", constant.name);
        let text = specialization_text(constant, next_id);
        next_id += constant.word_count;
        (path, text)
    })
}

/// Declares a specialization constant whose first word has the id `first_id`. Vulkan has none of an
/// array: each element is a constant of its own.
fn specialization_text(
    constant: &specialization::SpecializationConstant,
    first_id: usize,
) -> String {
    let name = constant.name.to_uppercase();
    let (ty, default) = match constant.default {
        constants::Value::Float(x) => ("float", format!("{x:e}")),
        constants::Value::Uint(x) => ("uint", format!("{x}u")),
    };
    let declared = |id: usize, name: &str| {
        format!("layout(constant_id = {id}) const {ty} {name} = {default};\n")
    };
    let count = constant.word_count;
    let (size, constants) = if constant.is_array {
        let elements: Vec<String> = (0..count).map(|i| format!("{name}_{i}")).collect();
        let words = elements.iter().enumerate();
        let declarations: String = words
            .map(|(i, name)| declared(first_id + i, name))
            .collect();
        let list = elements.join(", ");
        // Not `const`: GLSL takes an array of specialization constants for a variable.
        let array = format!("{ty} {name}[{count}] = {ty}[{count}]({list});\n");
        (format!("[{count}]"), declarations + &array)
    } else {
        (String::new(), declared(first_id, &name))
    };
    format!(
        "// Written by shaders/compile.rs from src/base/glsl/specialization.rs.\n\
         #ifdef GL_ES\n\
         uniform {ty} {name}{size};\n\
         #else\n\
         {constants}\
         #endif\n"
    )
}

fn files(folder: &Path) -> io::Result<Vec<PathBuf>> {
    fs::read_dir(folder)?
        .map(|entry| Ok(entry?.path()))
        .collect()
}
