//! A folder of shaders in place of the program's own: an edit of a shader shows without a build.
//!
//! Only shaders whose expanded text differs from the program's are compiled. Plans, caches and
//! provenance hash the code in use, so no result of an edited shader passes for the program's.

use super::{SHADER_TEXTS, SHADERS};
use crate::base::glsl::source::{ExpandedShader, Sources, first_error};
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::OnceLock;

/// Texts that the build script writes from `src/base/glsl`. They are not in the folder.
const GENERATED_FOLDER: &str = "generated/";

type Named<T> = (&'static str, T);

/// What replaces the program's shaders.
struct Replacement {
    /// SPIR-V by the name of the permutation.
    shaders: Vec<Named<&'static [u8]>>,
    /// Texts by path.
    texts: Vec<Named<&'static str>>,
    counts: EditedShaders,
}

/// How many shaders of a folder are not the program's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EditedShaders {
    pub compiled_count: usize,
    pub all_count: usize,
}

static REPLACEMENT: OnceLock<Replacement> = OnceLock::new();

pub(super) fn in_use() -> &'static [Named<&'static [u8]>] {
    REPLACEMENT.get().map_or(SHADERS, |edited| &edited.shaders)
}

pub(super) fn texts_in_use() -> &'static [Named<&'static str>] {
    REPLACEMENT
        .get()
        .map_or(SHADER_TEXTS, |edited| &edited.texts)
}

/// Uses the shaders of `folder`, which is laid out as `shaders/`, for the rest of the process. Only
/// the first call has an effect. The error is the compiler's, with file and line, or names the file
/// that cannot be read.
pub fn use_edited_shaders(folder: &Path) -> Result<EditedShaders, String> {
    if let Some(edited) = REPLACEMENT.get() {
        return Ok(edited.counts);
    }
    let edited = Replacement::read(folder)?;
    Ok(REPLACEMENT.get_or_init(|| edited).counts)
}

/// Whether shaders that are not the program's are in use.
pub fn has_edited_shaders() -> bool {
    REPLACEMENT
        .get()
        .is_some_and(|edited| edited.counts.compiled_count > 0)
}

impl Replacement {
    fn read(folder: &Path) -> Result<Self, String> {
        let built = super::shader_sources();
        let built_texts: BTreeMap<String, String> = built
            .shaders()?
            .into_iter()
            .map(|shader| (shader.name, shader.text))
            .collect();
        let generated = built
            .0
            .into_iter()
            .filter(|(path, _)| path.starts_with(GENERATED_FOLDER));
        let mut sources = Sources::read(folder)?;
        if sources.entries().next().is_none() {
            return Err(format!(
                "{}: no shaders; expected a folder such as shaders/ of a checkout",
                folder.display()
            ));
        }
        sources.0.extend(generated);
        let edited: Vec<ExpandedShader> = sources
            .shaders()?
            .into_iter()
            .filter(|shader| built_texts.get(&shader.name) != Some(&shader.text))
            .collect();
        let compiled_count = edited.len();
        let compiled: Vec<Vec<u32>> = edited
            .par_iter()
            .map(|shader| {
                let fault = |log: String| format!("{}: {}", shader.name, first_error(&log));
                shader.compile().map_err(fault)
            })
            .collect::<Result<_, _>>()?;
        let mut shaders: BTreeMap<&'static str, &'static [u8]> = SHADERS.iter().copied().collect();
        for (shader, code) in edited.into_iter().zip(compiled) {
            shaders.insert(shader.name.leak(), leaked_bytes(&code));
        }
        let counts = EditedShaders {
            compiled_count,
            all_count: shaders.len(),
        };
        Ok(Self {
            shaders: shaders.into_iter().collect(),
            texts: sources
                .0
                .into_iter()
                .map(|(path, text)| (&*path.leak(), &*text.leak()))
                .collect(),
            counts,
        })
    }
}

/// Shaders in use live as long as the process.
fn leaked_bytes(code: &[u32]) -> &'static [u8] {
    bytemuck::cast_slice(code).to_vec().leak()
}
