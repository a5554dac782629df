//! The SPIR-V that the build script made, by permutation name.

use super::GpuError;
use std::sync::LazyLock;

include!(concat!(env!("OUT_DIR"), "/shaders.rs"));

/// SPIR-V words of the permutation `name` (see `shaders/build.rs`).
pub(super) fn spirv(name: &str) -> Result<Vec<u32>, GpuError> {
    let code = code_of(name).ok_or_else(|| GpuError::NoShader(name.into()))?;
    Ok(bytemuck::pod_collect_to_vec(code))
}

fn code_of(name: &str) -> Option<&'static [u8]> {
    SHADERS.iter().find(|(known, _)| *known == name).map(|(_, code)| *code)
}

/// Whether the build made this permutation; a method that does not use the BRDF has none for each model.
pub fn has_shader(name: &str) -> bool {
    code_of(name).is_some()
}

/// Hash of what these permutations run; `spirv` gives the code of each.
pub fn code_hash<'a>(shaders: &[String], spirv: impl Fn(&str) -> &'a [u8]) -> String {
    let mut hasher = blake3::Hasher::new();
    for name in shaders {
        let code = spirv(name);
        // The lengths keep one shader's end from passing for the next one's beginning.
        hasher.update(&(name.len() as u64).to_le_bytes()).update(name.as_bytes());
        hasher.update(&(code.len() as u64).to_le_bytes()).update(code);
    }
    hasher.finalize().to_hex().to_string()
}

/// SPIR-V of the permutation `name`, which the build made.
pub fn shader_code(name: &str) -> &'static [u8] {
    code_of(name).unwrap_or_else(|| panic!("there is no shader {name}"))
}

/// Names of all permutations.
pub fn shader_names() -> impl Iterator<Item = &'static str> {
    SHADERS.iter().map(|(name, _)| *name)
}

/// One hash of all shaders: changes whenever any of them does.
pub fn build_hash() -> &'static str {
    // A plan asks for it with every cell.
    static HASH: LazyLock<String> = LazyLock::new(|| {
        let mut hasher = blake3::Hasher::new();
        for (name, bytes) in SHADERS {
            hasher.update(name.as_bytes());
            hasher.update(bytes);
        }
        hasher.finalize().to_hex().to_string()
    });
    &HASH
}
