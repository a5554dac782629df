//! The native part of the Python package `splitsum`, whose interface is in `package/splitsum`.
//!
//! Arguments are checked there, except for the checks that the library makes. All work is done
//! without the GIL.

mod arrays;
mod scores;
mod tables;

#[pyo3::pymodule]
mod _native {
    #[pymodule_export]
    use super::arrays::{read_exr, write_exr};
    #[pymodule_export]
    use super::scores::{check_bake, integrate, kind_columns, relmse};
    #[pymodule_export]
    use super::tables::{
        dfg_table, fit_taps, level_alphas, level_bend, level_factors, lobes, lookup_taps,
        prefilter, taps,
    };
    #[pymodule_export]
    const ALPHA_MIN: f64 = splitsum::oracle::ALPHA_MIN;
    /// The narrowest lobe and the smallest n·v that the renderer shades.
    #[pymodule_export]
    const SHADED_ALPHA_MIN: f64 = splitsum::base::glsl::constants::ALPHA_MIN as f64;
    #[pymodule_export]
    const SHADED_COSINE_MIN: f64 = splitsum::base::glsl::constants::COSINE_MIN as f64;
    /// The F0 of the second half of a table of taps; the first half has 1.
    #[pymodule_export]
    const DIELECTRIC_F0: f64 = splitsum::instrument::precompute::taps::F0[1];
}
