//! Why an environment cannot be used.

use crate::pixels::PixelsError;
use std::path::PathBuf;

/// The f32 sum of the squares of a million such values is still finite; the sun in cd/m² is 2e9.
pub(super) const MAX_RADIANCE: f32 = 1e15;

/// An environment that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum EnvironmentError {
    #[error("environment {spec}: no such file{}{hint}", path.as_ref().map(|p| format!(" {}", p.display())).unwrap_or_default())]
    Missing { spec: String, path: Option<PathBuf>, hint: String },
    #[error("environment {spec}: the extension is {extension:?}; expected one of {expected}")]
    UnknownFormat { spec: String, extension: String, expected: String },
    #[error("environment {0}")]
    Unreadable(#[from] PixelsError),
    #[error("environment {spec}: there is no builtin {name:?}; {hint}")]
    UnknownBuiltin { spec: String, name: String, hint: String },
    #[error("environment {spec}: builtin {builtin} has no parameter {name:?}; {hint}")]
    UnknownParameter { spec: String, builtin: &'static str, name: String, hint: String },
    #[error("environment {spec}: {parameter} is {value:?}; expected {expected}")]
    BadValue { spec: String, parameter: String, value: String, expected: String },
    #[error(
        "environment {spec}: {found}; expected finite values of at least 0 (or ask for --clamp-invalid, which sets these to 0)"
    )]
    InvalidTexels { spec: String, found: String },
    #[error(
        "environment {spec}: the largest value is {peak:e}, at column {x}, row {y}; expected at most {MAX_RADIANCE:e}, above which sums of squares overflow (scale the file)"
    )]
    TooBright { spec: String, peak: f32, x: usize, y: usize },
}
