//! Descriptions of compute shaders to compile, which one process can send to another.

use super::added_shader;
use serde::{Deserialize, Serialize};

/// A compute shader with values of its specialization constants.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ShaderVariant {
    /// Name of the permutation.
    pub shader: String,
    /// Values by `constant_id`.
    pub constants: Vec<u32>,
    /// SPIR-V of a method in a file, which another process does not have.
    pub code: Option<Vec<u32>>,
}

impl ShaderVariant {
    pub fn new(shader: String, constants: &[u32]) -> Self {
        let code = added_shader(&shader);
        Self {
            shader,
            constants: constants.to_vec(),
            code,
        }
    }
}
