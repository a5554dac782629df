//! A method in a file of its user's: GLSL that defines `vec3 specular_radiance(Surface s)` as the files of `shaders/shade/method/` do,
//! compiled when it is named.
//!
//! It may include all that they may (`lib/split_sum.glsl`, `lib/filtering.glsl`, `selected/brdf.glsl`, ...). What it reads of the
//! bindings says on which parameters it depends.

#[cfg(feature = "gpu")]
mod load;

#[cfg(feature = "gpu")]
pub use load::load;

use super::Method;
use crate::glsl::constants::FILE_PREFIX;
use crate::shade::twin::Twin;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{PoisonError, RwLock};

/// The function that the file defines.
pub const FUNCTION: &str = "specular_radiance";

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
