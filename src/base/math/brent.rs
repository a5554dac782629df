//! A minimum of a function of one variable.

/// Narrows an interval by the golden section until it is `tolerance` wide, and returns its middle: a
/// minimum of a function that falls and then rises there.
pub fn minimum(f: impl Fn(f64) -> f64, [lo, hi]: [f64; 2], tolerance: f64) -> f64 {
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut lo, mut hi) = (lo, hi);
    let mut inner = [hi - ratio * (hi - lo), lo + ratio * (hi - lo)];
    let mut values = inner.map(&f);
    while hi - lo > tolerance {
        if values[0] < values[1] {
            hi = inner[1];
            inner = [hi - ratio * (hi - lo), inner[0]];
            values = [f(inner[0]), values[0]];
        } else {
            lo = inner[0];
            inner = [inner[1], lo + ratio * (hi - lo)];
            values = [values[1], f(inner[1])];
        }
    }
    0.5 * (lo + hi)
}
