//! The inverse of the error function.

use statrs::function::erf::{erf_inv, erfc_inv};

/// Returns the x with `erf x = y`, for y in (-1, 1). `complement` is `(1 - y)(1 + y)`, which keeps the digits of a tail.
pub fn erf_inverse(y: f64, complement: f64) -> f64 {
    // erfc |x| = complement / (1 + |y|).
    if y.abs() < 0.5 { erf_inv(y) } else { erfc_inv(complement / (1.0 + y.abs())).copysign(y) }
}
