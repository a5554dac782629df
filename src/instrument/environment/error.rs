//! Errors of environments.

use crate::base::pixels::PixelsError;

/// The f32 sum of the squares of a million such values is still finite; the sun in cd/m² is 2e9.
pub(super) const MAX_RADIANCE: f32 = 1e15;

/// The page that says which programs write such files, and the way around.
pub const GUIDE: &str = "docs/bringing-maps.md";

#[derive(Debug, thiserror::Error)]
pub enum EnvironmentError {
    #[error("environment {0} ({GUIDE})")]
    Unreadable(#[from] PixelsError),
    #[error(
        "environment {spec}: {found}; expected finite values of at least 0 (--clamp-invalid sets \
         +infinity to the largest finite value, all others to 0; {GUIDE})"
    )]
    InvalidTexels { spec: String, found: String },
    /// A whole image that is not a map of radiance; `what` includes the expected one.
    #[error("environment {spec}: {what} ({GUIDE})")]
    NotRadiance { spec: String, what: String },
    /// Any other problem; `what` includes the expected value.
    #[error("environment {spec}: {what}")]
    Unusable { spec: String, what: String },
}

pub(super) fn unusable(spec: &str, what: String) -> EnvironmentError {
    EnvironmentError::Unusable {
        spec: spec.to_owned(),
        what,
    }
}

pub(super) fn not_radiance(spec: &str, what: String) -> EnvironmentError {
    EnvironmentError::NotRadiance {
        spec: spec.to_owned(),
        what,
    }
}
