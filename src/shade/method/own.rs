//! A method in a file of its user's: GLSL that defines `vec3 specular_radiance(Surface s)` as the files of `shaders/shade/method/` do,
//! compiled when it is named.
//!
//! It may include all that they may (`lib/split_sum.glsl`, `lib/filtering.glsl`, `selected/brdf.glsl`, ...). What it reads of the
//! bindings says on which parameters it depends.

use super::Method;
use crate::files::read_given;
use crate::glsl::source::{Choice, FILE_PREFIX, Language, METHOD_INCLUDE, compile};
use crate::gpu::{add_shader, names_read, shader_sources};
use crate::shade::twin::Twin;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::{PoisonError, RwLock};

/// Largest file, bytes.
const FILE_BYTES_MAX: u64 = 1 << 20;
/// The pass that calls it.
const ENTRY: &str = "shade/specular.comp";
/// What it defines.
pub const FUNCTION: &str = "specular_radiance";
/// Digits of the hash that stands for the text.
const HASH_LENGTH: usize = 16;

/// Methods by the names that they were asked for by: `file:PATH`.
static LOADED: RwLock<BTreeMap<String, &'static Method>> = RwLock::new(BTreeMap::new());

/// The method `file:PATH` of that name, as it was loaded last. Where it was not, or does not compile, one that gives nothing stands for it:
/// a name in a finished run may outlive its file.
pub fn loaded(name: &str) -> Option<&'static Method> {
    name.strip_prefix(FILE_PREFIX)?;
    // A map is whole after a panic: entries are added in one step.
    let known = LOADED.read().unwrap_or_else(PoisonError::into_inner).get(name).copied();
    Some(known.unwrap_or_else(|| keep(absent(name.to_owned()))))
}

/// Reads and compiles the method of the name `file:PATH`, the path relative to `dir`, for every model and layout.
///
/// Fails with `PATH:LINE: what the compiler says`.
pub fn load(name: &str, dir: &Path) -> Result<&'static Method, String> {
    let path = dir.join(name.strip_prefix(FILE_PREFIX).unwrap_or(name));
    let fault = |what: String| format!("{}: {what}", path.display());
    let bytes = read_given(&path, FILE_BYTES_MAX).map_err(|e| fault(e.to_string()))?;
    let text = String::from_utf8(bytes).map_err(|_| fault("it is no UTF-8 text".into()))?;
    let stem = format!("{FILE_PREFIX}{}", &blake3::hash(text.as_bytes()).to_hex()[..HASH_LENGTH]);

    let mut sources = shader_sources();
    let own = format!("{FILE_PREFIX}{}", path.display());
    sources.0.insert(own.clone(), text);
    let choice = Choice::from([(METHOD_INCLUDE.to_owned(), own)]);
    let mut reads = BTreeSet::new();
    for (permutation, choice) in sources.permutations(ENTRY, &choice)? {
        let code = sources.expand(ENTRY, &choice, Language::Vulkan).and_then(|text| compile(ENTRY, &text));
        let shader = shader_name(&permutation, &stem);
        add_shader(shader.clone(), &code.map_err(|log| first_error(&log, &path))?);
        reads.append(&mut names_read(&shader, FUNCTION).map_err(|e| fault(e.to_string()))?);
    }
    Ok(keep(of_names_read(absent(name.to_owned()), &reads, stem)))
}

/// The permutation's name with that of the method at its place: behind the layout, before the model.
fn shader_name(permutation: &str, stem: &str) -> String {
    let mut parts: Vec<&str> = permutation.split(':').collect();
    parts.insert(2, stem);
    parts.join(":")
}

/// A method that gives nothing.
fn absent(name: String) -> Method {
    let name = Box::leak(name.into_boxed_str());
    Method::plain(name, "a method in a file", Twin::Estimator(|_, _, _| DVec3::ZERO))
}

/// What a shader reads says on which parameters its method depends.
pub fn of_names_read(method: Method, reads: &BTreeSet<String>, stem: String) -> Method {
    let reads = |name: &str| reads.contains(name);
    Method {
        shader: Some(Box::leak(stem.into_boxed_str())),
        uses_samples: reads("sample_count"),
        uses_point_set: reads("Points"),
        uses_lod_bias: reads("lod_bias"),
        // How often is not counted: a method that looks the map up more than once is told as one that does so once.
        lookups: reads("prefiltered").into(),
        uses_dfg: reads("dfg"),
        uses_lobe_shapes: reads("lobe_shapes"),
        ..method
    }
}

fn keep(method: Method) -> &'static Method {
    let mut loaded = LOADED.write().unwrap_or_else(PoisonError::into_inner);
    let method: &'static Method = Box::leak(Box::new(method));
    loaded.insert(method.name.to_owned(), method);
    method
}

/// The first fault of a compiler's log, as `PATH:LINE: what`. One in the pass around the method has its cause in what the file defines.
fn first_error(log: &str, path: &Path) -> String {
    let first = log.lines().find_map(|line| line.trim().strip_prefix("ERROR: ")).unwrap_or_else(|| log.trim());
    match first.starts_with("shaders/") {
        true => format!("{}: expected `vec3 {FUNCTION}(Surface s)` and no main ({first})", path.display()),
        false => first.to_owned(),
    }
}
