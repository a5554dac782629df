//! Limits of real hardware that shaders emulate on a driver without them, for tests: a GPU is
//! rarely at hand, and a number that its limits move must be known before one is.
//!
//! The environment variable `SPLITSUM_TEST_LIMITS` holds names of [`LIMITS`] separated by commas.
//! `shaders/lib/device_limits.glsl` has what each does. The device's name of its driver then ends in
//! them, so that no cache and no comparison takes these results for the driver's own.

use super::{DeviceInfo, GpuError};
use crate::base::glsl::constants as code;
use crate::base::glsl::specialization;

const VARIABLE: &str = "SPLITSUM_TEST_LIMITS";

/// The limits by name, each a bit of the specialization constant `emulated_limits`.
pub const LIMITS: [(&str, u32); 10] = [
    ("texel-weights", code::EMULATE_TEXEL_WEIGHTS),
    ("texel-weights-down", code::EMULATE_TEXEL_WEIGHTS_DOWN),
    ("level-fractions", code::EMULATE_LEVEL_FRACTIONS),
    ("cube-seams", code::EMULATE_CUBE_SEAMS),
    ("cube-corners", code::EMULATE_CUBE_CORNERS),
    ("half-lookups", code::EMULATE_HALF_LOOKUPS),
    ("elementary", code::EMULATE_ELEMENTARY),
    ("vertex-grid", code::EMULATE_VERTEX_GRID),
    ("undefined-memory", code::EMULATE_UNDEFINED_MEMORY),
    ("small-buffers", code::EMULATE_SMALL_BUFFERS),
];
/// What `undefined-memory` writes: a NaN as f32 and as half.
const UNDEFINED_WORD: u32 = u32::MAX;
/// The largest storage buffer of `small-buffers`, bytes: more than the tables of a small picture.
const SMALL_BUFFER_BYTES: u32 = 4 << 20;

/// The limits that a device emulates, as bits; 0 emulates none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Emulation(u32);

impl Emulation {
    /// Reads the limits from the environment variable; none if it is not set.
    pub(super) fn from_environment() -> Result<Self, GpuError> {
        let text = std::env::var(VARIABLE).unwrap_or_default();
        let mut bits = 0;
        for word in text.split(',').filter(|word| !word.is_empty()) {
            let known = LIMITS.iter().find(|(name, _)| *name == word);
            bits |= known
                .ok_or_else(|| GpuError::UnknownTestLimit {
                    variable: VARIABLE,
                    word: word.to_owned(),
                })?
                .1;
        }
        Ok(Self(bits))
    }

    /// Returns a device with these limits. Its driver's name ends in them.
    pub(super) fn limited(self, info: DeviceInfo) -> DeviceInfo {
        let names: Vec<&str> = LIMITS
            .iter()
            .filter(|(_, bit)| self.0 & bit != 0)
            .map(|(name, _)| *name)
            .collect();
        if names.is_empty() {
            return info;
        }
        let coarse = code::EMULATE_TEXEL_WEIGHTS | code::EMULATE_TEXEL_WEIGHTS_DOWN;
        let has_coarse_weights = self.0 & coarse != 0;
        DeviceInfo {
            has_exact_filter: info.has_exact_filter && !has_coarse_weights,
            driver: format!("{}, emulating {}", info.driver, names.join(" ")),
            ..info
        }
    }

    /// Returns the word that new images and buffers hold; none if their memory stays as it comes.
    pub(super) fn undefined_word(self) -> Option<u32> {
        (self.0 & code::EMULATE_UNDEFINED_MEMORY != 0).then_some(UNDEFINED_WORD)
    }

    /// Returns the largest storage buffer, bytes, of a device whose own largest is this.
    pub(super) fn max_storage_bytes(self, of_device: u32) -> u32 {
        if self.0 & code::EMULATE_SMALL_BUFFERS != 0 {
            of_device.min(SMALL_BUFFER_BYTES)
        } else {
            of_device
        }
    }

    /// Returns the specialization constants of a pipeline, 0, 1, ..., with the limits of this
    /// device; unchanged if it emulates none.
    pub(super) fn added_to(self, constants: &[u32]) -> Vec<u32> {
        let mut constants = constants.to_vec();
        if self.0 != 0 {
            let defaults = specialization::Specialization::default().words();
            let given = constants.len().min(defaults.len());
            constants.extend_from_slice(&defaults[given..]);
            constants[specialization::EMULATED_LIMITS_ID] = self.0;
        }
        constants
    }
}
