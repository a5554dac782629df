//! A folder of shaders in place of the program's own: an edit of a shader shows without a build.
//!
//! Only shaders whose expanded text differs from the program's are compiled. Plans and caches hash
//! the code in use, so no result of an edited shader passes for the program's. The names of all
//! shaders must be the program's: its lists of models and methods, and what a pass may choose, are
//! part of the build.

use super::{SHADER_TEXTS, SHADERS};
use crate::base::glsl::source::{ExpandedShader, Language, Sources, first_error};
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::OnceLock;

/// Texts that the build script writes from `src/base/glsl`. They are not in the folder.
const GENERATED_FOLDER: &str = "generated/";

type Named<T> = (&'static str, T);

/// What replaces the program's shaders.
struct Replacement {
    /// SPIR-V by the name of the permutation, in the order of [`SHADERS`].
    shaders: Vec<Named<&'static [u8]>>,
    /// Texts by path.
    texts: Vec<Named<&'static str>>,
    is_edited: bool,
}

static REPLACEMENT: OnceLock<Replacement> = OnceLock::new();

pub(super) fn in_use() -> &'static [Named<&'static [u8]>] {
    REPLACEMENT
        .get()
        .map_or(SHADERS, |replacement| &replacement.shaders)
}

pub(super) fn texts_in_use() -> &'static [Named<&'static str>] {
    REPLACEMENT
        .get()
        .map_or(SHADER_TEXTS, |replacement| &replacement.texts)
}

/// Whether shaders that are not the program's are in use.
pub fn has_edited_shaders() -> bool {
    REPLACEMENT
        .get()
        .is_some_and(|replacement| replacement.is_edited)
}

/// Shaders of a folder that is laid out as `shaders/`, before their compilation.
pub struct EditedShaders {
    texts: BTreeMap<String, String>,
    /// For Vulkan, with another text than the program's.
    edited: Vec<ExpandedShader>,
    /// As `edited`, of the report's page, where the browser compiles them.
    edited_page: Vec<ExpandedShader>,
    all_count: usize,
}

impl EditedShaders {
    /// Reads and expands the shaders of a folder. The error names the file that cannot be read, or
    /// the shader that the program lacks.
    pub fn read(folder: &Path) -> Result<Self, String> {
        let expected = "expected a folder such as shaders/ of a checkout";
        if !folder.is_dir() {
            return Err(format!("there is no such folder; {expected}"));
        }
        let built = super::shader_sources();
        let mut sources = Sources::read(folder)?;
        if sources.entries().next().is_none() {
            return Err(format!("contains no shaders; {expected}"));
        }
        for (path, text) in &built.0 {
            if path.starts_with(GENERATED_FOLDER) {
                sources.0.insert(path.clone(), text.clone());
            }
        }
        let mut all_count = 0;
        let mut edited_of = |language| {
            let built = built.shaders(language)?;
            all_count += built.len();
            edited(built, sources.shaders(language)?)
        };
        let [edited, edited_page] = [edited_of(Language::Vulkan)?, edited_of(Language::Es)?];
        Ok(Self {
            texts: sources.0,
            edited,
            edited_page,
            all_count,
        })
    }

    /// Returns the number of shaders that are not the program's.
    pub fn edited_count(&self) -> usize {
        self.edited.len() + self.edited_page.len()
    }

    /// Returns the number of all shaders.
    pub fn all_count(&self) -> usize {
        self.all_count
    }

    /// Compiles the edited shaders and uses all for the rest of the process. Comes before any use
    /// of a shader. The error is the compiler's first, with file and line.
    pub fn put_to_use(self) -> Result<(), String> {
        let is_edited = self.edited_count() > 0;
        let compiled: BTreeMap<&str, Vec<u32>> = self
            .edited
            .par_iter()
            .map(|shader| {
                let fault = |log: String| format!("{}: {}", shader.name, first_error(&log));
                let code = shader.compile().map_err(fault)?;
                Ok((shader.name.as_str(), code))
            })
            .collect::<Result<_, String>>()?;
        let shaders = SHADERS.iter().map(|(name, code)| {
            let edited = compiled.get(name).map(|code| leaked_bytes(code));
            (*name, edited.unwrap_or(code))
        });
        let replacement = Replacement {
            shaders: shaders.collect(),
            texts: self
                .texts
                .into_iter()
                .map(|(path, text)| (&*path.leak(), &*text.leak()))
                .collect(),
            is_edited,
        };
        REPLACEMENT
            .set(replacement)
            .map_err(|_| "another folder of shaders is in use".to_owned())
    }
}

/// Returns the shaders whose text is not the program's; an error unless both have the same names.
fn edited(
    built: Vec<ExpandedShader>,
    found: Vec<ExpandedShader>,
) -> Result<Vec<ExpandedShader>, String> {
    let mut built: BTreeMap<String, String> = built
        .into_iter()
        .map(|shader| (shader.name, shader.text))
        .collect();
    let mut edited = Vec::new();
    let needs_build = "a new, removed or renamed file, and another choice of `selected/` includes, \
                       need a build";
    for shader in found {
        match built.remove(&shader.name) {
            None => return Err(format!("{}: a new shader; {needs_build}", shader.name)),
            Some(text) if text != shader.text => edited.push(shader),
            Some(_) => {}
        }
    }
    match built.into_keys().next() {
        Some(name) => Err(format!("{name} is missing; {needs_build}")),
        None => Ok(edited),
    }
}

/// Shaders in use live as long as the process.
fn leaked_bytes(code: &[u32]) -> &'static [u8] {
    bytemuck::cast_slice(code).to_vec().leak()
}
