//! The SPIR-V that the build script made, by permutation name.

use super::GpuError;
use std::sync::LazyLock;

include!(concat!(env!("OUT_DIR"), "/shaders.rs"));

/// SPIR-V words of the permutation `name` (see `shaders/build.rs`).
pub(super) fn spirv(name: &str) -> Result<Vec<u32>, GpuError> {
    let (_, bytes) = SHADERS.iter().find(|(known, _)| *known == name).ok_or_else(|| GpuError::NoShader(name.into()))?;
    Ok(bytes.chunks_exact(4).map(|word| u32::from_ne_bytes([word[0], word[1], word[2], word[3]])).collect())
}

/// Whether the build made this permutation; a method that does not use the BRDF has none for each model.
pub fn has_shader(name: &str) -> bool {
    SHADERS.iter().any(|(known, _)| *known == name)
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
