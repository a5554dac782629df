//! Reads a method's file and compiles it for the device.

use super::super::Method;
use super::{FUNCTION, absent, keep, of_names_read, wgsl};
use crate::base::files::read_given;
use crate::base::glsl::constants::FILE_PREFIX;
use crate::base::glsl::source::{Choice, Language, METHOD_INCLUDE, compile};
use crate::instrument::gpu::{add_shader, names_read, shader_sources};
use std::collections::BTreeSet;
use std::path::Path;

const FILE_BYTES_MAX: u64 = 1 << 20;
/// The pass that calls the method.
const ENTRY: &str = "shade/specular.comp";
/// The text that calls a function without `Surface`, beside `shaders/`.
const CALL: &str = "call.glsl";
/// Hex digits of the text's hash in a shader's name.
const HASH_LENGTH: usize = 16;

/// Reads and compiles the method `file:PATH` for every model and layout; the path is relative to
/// `dir`.
///
/// The error is `PATH:LINE: message of the compiler`.
pub fn load(name: &str, dir: &Path) -> Result<&'static Method, String> {
    load_function(name, dir, FUNCTION)
}

/// Does the same with another function of the file. In WGSL any function, in GLSL any but
/// [`FUNCTION`], takes n, v, perceptual roughness and f0.
pub fn load_function(name: &str, dir: &Path, function: &str) -> Result<&'static Method, String> {
    let path = dir.join(name.strip_prefix(FILE_PREFIX).unwrap_or(name));
    let fault = |what: String| format!("{}: {what}", path.display());
    let bytes = read_given(&path, FILE_BYTES_MAX).map_err(|e| fault(e.to_string()))?;
    let mut text = String::from_utf8(bytes).map_err(|_| fault("not UTF-8 text".into()))?;
    let is_wgsl = path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("wgsl"));
    if is_wgsl {
        text = wgsl::to_glsl(&text, function, &path)?;
    }
    let (mut sources, own) = (shader_sources(), format!("{FILE_PREFIX}{}", path.display()));
    let mut choice = Choice::from([(METHOD_INCLUDE.to_owned(), own.clone())]);
    let (mut hashed, mut expected) = (text.clone(), format!("vec3 {function}(Surface s)"));
    if is_wgsl || function != FUNCTION {
        let called = if is_wgsl { wgsl::FUNCTION } else { function };
        let call = format!(
            "#include \"{own}\"\n#include \"lib/prefilter_mapping.glsl\"\n\
            vec3 {FUNCTION}(Surface s) {{ return {called}(s.n, s.v, \
            perceptual_roughness_from_alpha(s.alpha), s.f0); }}"
        );
        expected = match is_wgsl {
            true => format!(
                "fn {function}(n: vec3f, v: vec3f, perceptual_roughness: f32, f0: vec3f) -> vec3f"
            ),
            false => {
                format!("vec3 {function}(vec3 n, vec3 v, float perceptual_roughness, vec3 f0)")
            }
        };
        hashed += &call;
        sources.0.insert(CALL.to_owned(), call);
        choice.insert(METHOD_INCLUDE.to_owned(), CALL.to_owned());
    }
    sources.0.insert(own, text.clone());
    let stem = format!(
        "{FILE_PREFIX}{}",
        &blake3::hash(hashed.as_bytes()).to_hex()[..HASH_LENGTH]
    );
    let mut reads = BTreeSet::new();
    for (permutation, choice) in sources.permutations(ENTRY, &choice)? {
        let code = sources
            .expand(ENTRY, &choice, Language::Vulkan)
            .and_then(|text| compile(ENTRY, &text));
        let shader = shader_name(&permutation, &stem);
        add_shader(
            shader.clone(),
            &code.map_err(|log| first_error(&log, &path, &expected))?,
        );
        reads.append(&mut names_read(&shader, FUNCTION).map_err(|e| fault(e.to_string()))?);
    }
    let method = Method {
        text: Some(Box::leak(text.into_boxed_str())),
        ..absent(name.to_owned())
    };
    Ok(keep(of_names_read(method, &reads, stem)))
}

/// Inserts the method's name into a permutation's name: after the layout, before the model.
pub fn shader_name(permutation: &str, stem: &str) -> String {
    let mut parts: Vec<&str> = permutation.split(':').collect();
    parts.insert(2, stem);
    parts.join(":")
}

/// Returns the first error of a compiler's log, as `PATH:LINE: message`. Errors in the pass around
/// the file count as errors of the file.
fn first_error(log: &str, path: &Path, expected: &str) -> String {
    let first = log
        .lines()
        .find_map(|line| line.trim().strip_prefix("ERROR: "))
        .unwrap_or_else(|| log.trim());
    match first.starts_with("shaders/") {
        true => format!(
            "{}: expected a definition of `{expected}`, and no `main`",
            path.display()
        ),
        false if first.contains("redefinition") => {
            format!("{first} (a name of splitsum's shaders: rename yours)")
        }
        false => first.to_owned(),
    }
}
