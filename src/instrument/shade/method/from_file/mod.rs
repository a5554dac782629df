//! Methods in files of the user: GLSL that defines `vec3 specular_radiance(Surface s)` like the
//! files of `shaders/shade/method/`, compiled when it is named.
//!
//! It may include the same files (`lib/split_sum.glsl`, `lib/filtering.glsl`, `selected/brdf.glsl`,
//! ...). The bindings that it reads determine which parameters it depends on.

#[cfg(feature = "gpu")]
mod load;
#[cfg(feature = "gpu")]
mod wgsl;

#[cfg(feature = "gpu")]
pub use load::{load, load_function, shader_name};

use super::Method;
use crate::base::glsl::constants::FILE_PREFIX;
use crate::instrument::precompute::taps::TapCount;
use crate::instrument::shade::twin::Twin;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{PoisonError, RwLock};

/// The function that the file must define.
pub const FUNCTION: &str = "specular_radiance";

/// Methods by name: `file:PATH`.
static LOADED: RwLock<BTreeMap<String, &'static Method>> = RwLock::new(BTreeMap::new());

/// Returns the method `file:PATH` as loaded last. If it was never loaded or does not compile,
/// returns one that gives nothing: a name in a finished run may outlive its file.
pub fn loaded(name: &str) -> Option<&'static Method> {
    name.strip_prefix(FILE_PREFIX)?;
    // A panic cannot leave the map half-changed: entries are added in one step.
    let known = LOADED
        .read()
        .unwrap_or_else(PoisonError::into_inner)
        .get(name)
        .copied();
    Some(known.unwrap_or_else(|| keep(absent(name.to_owned()))))
}

fn absent(name: String) -> Method {
    let title = std::path::Path::new(name.trim_start_matches(FILE_PREFIX))
        .file_stem()
        .unwrap_or_default();
    let title = format!("{} (file)", title.to_string_lossy());
    Method::plain(
        Box::leak(name.into_boxed_str()),
        Box::leak(title.into_boxed_str()),
        "a method in a file",
        Twin::Estimator(|_, _, _| DVec3::ZERO),
    )
}

/// Derives the flags of a method from the names that its shader reads.
pub fn of_names_read(method: Method, reads: &BTreeSet<String>, stem: String) -> Method {
    let reads = |name: &str| reads.contains(name);
    Method {
        shader: Some(Box::leak(stem.into_boxed_str())),
        uses_samples: reads("sample_count"),
        uses_point_set: reads("Points"),
        uses_lod_bias: reads("lod_bias"),
        // Not counted: more than one lookup counts as one.
        lookups: reads("prefiltered").into(),
        uses_dfg: reads("dfg"),
        tap_table: TapCount::ALL
            .into_iter()
            .find(|count| reads(count.sampler())),
        ..method
    }
}

fn keep(method: Method) -> &'static Method {
    let mut loaded = LOADED.write().unwrap_or_else(PoisonError::into_inner);
    let method: &'static Method = Box::leak(Box::new(method));
    loaded.insert(method.name.to_owned(), method);
    method
}
