//! What everything else is written in. Each module imports only from those above it.

/// Constants and structs that Rust and GLSL share, and the texts of shaders.
pub mod glsl;

/// Names that users type: lists of choices, and suggestions for misspelt ones.
pub mod names;

/// Rounding, and numbers as text.
pub mod numbers;

/// Directions, quadrature, harmonics, sequences, special functions; in f64.
pub mod math;

/// Primaries, luminance and transfer functions.
pub mod color;

/// Reading within limits, and writing that leaves no half-written file.
pub mod files;

/// Images in memory, and their files: OpenEXR, Radiance, PNG.
pub mod pixels;

/// Tables of numbers and texts as CSV.
pub mod csv;
