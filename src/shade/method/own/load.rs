//! Reads a method's file and compiles it for the device.

use super::super::Method;
use super::{FUNCTION, absent, keep, of_names_read};
use crate::files::read_given;
use crate::glsl::constants::FILE_PREFIX;
use crate::glsl::source::{Choice, Language, METHOD_INCLUDE, compile};
use crate::gpu::{add_shader, names_read, shader_sources};
use std::collections::BTreeSet;
use std::path::Path;

/// Largest file, bytes.
const FILE_BYTES_MAX: u64 = 1 << 20;
/// The pass that calls the method.
const ENTRY: &str = "shade/specular.comp";
/// Hex digits of the text's hash in a shader's name.
const HASH_LENGTH: usize = 16;

/// Reads and compiles the method `file:PATH` for every model and layout; the path is relative to `dir`.
///
/// The error is `PATH:LINE: message of the compiler`.
pub fn load(name: &str, dir: &Path) -> Result<&'static Method, String> {
    let path = dir.join(name.strip_prefix(FILE_PREFIX).unwrap_or(name));
    let fault = |what: String| format!("{}: {what}", path.display());
    let bytes = read_given(&path, FILE_BYTES_MAX).map_err(|e| fault(e.to_string()))?;
    let text = String::from_utf8(bytes).map_err(|_| fault("not UTF-8 text".into()))?;
    let stem = format!("{FILE_PREFIX}{}", &blake3::hash(text.as_bytes()).to_hex()[..HASH_LENGTH]);

    let mut sources = shader_sources();
    let own = format!("{FILE_PREFIX}{}", path.display());
    sources.0.insert(own.clone(), text.clone());
    let choice = Choice::from([(METHOD_INCLUDE.to_owned(), own)]);
    let mut reads = BTreeSet::new();
    for (permutation, choice) in sources.permutations(ENTRY, &choice)? {
        let code = sources.expand(ENTRY, &choice, Language::Vulkan).and_then(|text| compile(ENTRY, &text));
        let shader = shader_name(&permutation, &stem);
        add_shader(shader.clone(), &code.map_err(|log| first_error(&log, &path))?);
        reads.append(&mut names_read(&shader, FUNCTION).map_err(|e| fault(e.to_string()))?);
    }
    let method = Method { text: Some(Box::leak(text.into_boxed_str())), ..absent(name.to_owned()) };
    Ok(keep(of_names_read(method, &reads, stem)))
}

/// Inserts the method's name into a permutation's name: after the layout, before the model.
pub fn shader_name(permutation: &str, stem: &str) -> String {
    let mut parts: Vec<&str> = permutation.split(':').collect();
    parts.insert(2, stem);
    parts.join(":")
}

/// Returns the first error of a compiler's log, as `PATH:LINE: message`. Errors in the pass around the file count as errors of the file.
fn first_error(log: &str, path: &Path) -> String {
    let first = log.lines().find_map(|line| line.trim().strip_prefix("ERROR: ")).unwrap_or_else(|| log.trim());
    if !first.starts_with("shaders/") {
        return first.to_owned();
    }
    let what = first.splitn(3, ':').last().unwrap_or_default().trim();
    format!("{}: expected a definition of `vec3 {FUNCTION}(Surface s)` and no main: {what}", path.display())
}
