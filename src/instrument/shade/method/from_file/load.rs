//! Reads a method's file and compiles it for the device.

use super::super::Method;
use super::{FUNCTION, absent, keep, of_names_read, wgsl};
use crate::base::files::read_given;
use crate::base::glsl::constants::FILE_PREFIX;
use crate::base::glsl::source::{Choice, Language, METHOD_INCLUDE, compile, first_error};
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
    let source = Source::read(&path, function)?;
    let mut sources = shader_sources();
    let file = format!("{FILE_PREFIX}{}", path.display());
    let mut choice = Choice::from([(METHOD_INCLUDE.to_owned(), file.clone())]);
    let mut hashed = source.text.clone();
    if let Some(call) = source.call(&file) {
        hashed += &call;
        sources.0.insert(CALL.to_owned(), call);
        choice.insert(METHOD_INCLUDE.to_owned(), CALL.to_owned());
    }
    sources.0.insert(file, source.text.clone());
    let hash = blake3::hash(hashed.as_bytes()).to_hex();
    let stem = format!("{FILE_PREFIX}{}", &hash[..HASH_LENGTH]);
    let mut reads = BTreeSet::new();
    for (permutation, choice) in sources.permutations(ENTRY, &choice)? {
        let code = sources
            .expand(ENTRY, &choice, Language::Vulkan)
            .and_then(|text| compile(ENTRY, &text))
            .map_err(|log| user_error(&log, &path, &source.expected()))?;
        let shader = shader_name(&permutation, &stem);
        add_shader(shader.clone(), &code);
        reads.append(&mut names_read(&shader, FUNCTION).map_err(|e| fault(e.to_string()))?);
    }
    let method = Method {
        text: Some(Box::leak(source.text.into_boxed_str())),
        ..absent(name.to_owned())
    };
    Ok(keep(of_names_read(method, &reads, stem)))
}

#[derive(Clone, Copy, PartialEq)]
enum SourceLanguage {
    Glsl,
    Wgsl,
}

/// A file with a method.
struct Source<'a> {
    language: SourceLanguage,
    /// The function that computes the radiance.
    function: &'a str,
    /// In GLSL.
    text: String,
}

impl<'a> Source<'a> {
    fn read(path: &Path, function: &'a str) -> Result<Self, String> {
        let fault = |what: String| format!("{}: {what}", path.display());
        let bytes = read_given(path, FILE_BYTES_MAX).map_err(|e| fault(e.to_string()))?;
        let text = String::from_utf8(bytes).map_err(|_| fault("not UTF-8 text".into()))?;
        let is_wgsl = path
            .extension()
            .is_some_and(|extension| extension.eq_ignore_ascii_case("wgsl"));
        Ok(if is_wgsl {
            Self {
                language: SourceLanguage::Wgsl,
                function,
                text: wgsl::to_glsl(&text, function, path)?,
            }
        } else {
            Self {
                language: SourceLanguage::Glsl,
                function,
                text,
            }
        })
    }

    /// Whether the function takes the surface that the pass has.
    fn takes_surface(&self) -> bool {
        self.language == SourceLanguage::Glsl && self.function == FUNCTION
    }

    /// Returns the text that defines [`FUNCTION`] by a call of another function of `file`; `None`
    /// if the file defines it.
    fn call(&self, file: &str) -> Option<String> {
        let called = match self.language {
            SourceLanguage::Wgsl => wgsl::FUNCTION,
            SourceLanguage::Glsl => self.function,
        };
        (!self.takes_surface()).then(|| {
            format!(
                "#include \"{file}\"\n#include \"lib/prefilter_mapping.glsl\"\n\
                 vec3 {FUNCTION}(Surface s) {{ return {called}(s.n, s.v, \
                 perceptual_roughness_from_alpha(s.alpha), s.f0); }}"
            )
        })
    }

    /// Returns the declaration that the file must define.
    fn expected(&self) -> String {
        let function = self.function;
        match self.language {
            SourceLanguage::Wgsl => format!(
                "fn {function}(n: vec3f, v: vec3f, perceptual_roughness: f32, f0: vec3f) -> vec3f"
            ),
            SourceLanguage::Glsl if self.takes_surface() => format!("vec3 {function}(Surface s)"),
            SourceLanguage::Glsl => {
                format!("vec3 {function}(vec3 n, vec3 v, float perceptual_roughness, vec3 f0)")
            }
        }
    }
}

/// Inserts the method's name into a permutation's name: after the layout, before the model.
pub fn shader_name(permutation: &str, stem: &str) -> String {
    let mut parts: Vec<&str> = permutation.split(':').collect();
    parts.insert(2, stem);
    parts.join(":")
}

/// Returns the first error of a compiler's log, as `PATH:LINE: message`. Errors in the pass around
/// the file count as errors of the file.
fn user_error(log: &str, path: &Path, expected: &str) -> String {
    let first = first_error(log);
    if first.starts_with("shaders/") {
        format!(
            "{}: expected a definition of `{expected}`, and no `main`",
            path.display()
        )
    } else if first.contains("redefinition") {
        format!("{first} (a name of splitsum's shaders: rename yours)")
    } else {
        first.to_owned()
    }
}
