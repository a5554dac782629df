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
    use super::tables::{dfg_table, fit_taps, level_alphas, lobes, lookup_taps, prefilter, taps};
    #[pymodule_export]
    const ALPHA_MIN: f64 = splitsum::oracle::ALPHA_MIN;
}
