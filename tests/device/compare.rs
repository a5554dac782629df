//! Comparison of device numbers with f64 ones.

use glam::DVec3;

/// Allowed difference: `|actual - expected| <= relative |expected| + floor`.
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    pub relative: f64,
    pub floor: f64,
}

/// A relative tolerance; the floor only covers numbers that f32 cannot hold.
pub const fn relative(relative: f64) -> Tolerance {
    Tolerance {
        relative,
        floor: 1e-37,
    }
}

pub const fn absolute(floor: f64) -> Tolerance {
    Tolerance {
        relative: 0.0,
        floor,
    }
}

/// The worst of many comparisons: a failure shows the case with the largest difference, not the
/// first.
pub struct Worst {
    name: String,
    tolerance: Tolerance,
    count: usize,
    /// Difference over the allowed difference.
    ratio: f64,
    case: String,
}

impl Worst {
    pub fn new(name: impl Into<String>, tolerance: Tolerance) -> Self {
        Self {
            name: name.into(),
            tolerance,
            count: 0,
            ratio: 0.0,
            case: String::new(),
        }
    }

    /// Compares one number; `case` describes the inputs.
    pub fn add(&mut self, actual: f64, expected: f64, case: impl Fn() -> String) {
        self.add_within(actual, expected, 0.0, case);
    }

    pub fn add_within(&mut self, actual: f64, expected: f64, more: f64, case: impl Fn() -> String) {
        let allowed = self.tolerance.relative * expected.abs() + self.tolerance.floor + more;
        let ratio = (actual - expected).abs() / allowed;
        self.count += 1;
        // NaN is worse than everything.
        if ratio.is_nan() || ratio > self.ratio {
            self.ratio = if ratio.is_nan() { f64::INFINITY } else { ratio };
            self.case = format!("{actual:e} against {expected:e} at {}", case());
        }
    }

    /// Compares a vector by the length of its difference, relative to the length of the expected
    /// one.
    pub fn add_vector(&mut self, actual: DVec3, expected: DVec3, case: impl Fn() -> String) {
        let length = expected.length();
        let difference = (actual - expected).length();
        self.add(length + difference, length, || {
            format!("{actual} against {expected}, {}", case())
        });
    }

    pub fn add_rgb(&mut self, actual: DVec3, expected: DVec3, case: impl Fn() -> String) {
        for c in 0..3 {
            self.add(actual[c], expected[c], || {
                format!("channel {c}, {}", case())
            });
        }
    }

    /// Fails if a comparison exceeds its tolerance, or if there was no comparison.
    pub fn check(self) {
        let Self {
            name,
            tolerance,
            count,
            ratio,
            case,
        } = self;
        assert!(count > 0, "{name}: nothing was compared");
        println!("{name}: {count} compared, worst {ratio:.3} of {tolerance:?}: {case}");
        assert!(
            ratio <= 1.0,
            "{name}: {ratio:.3} times {tolerance:?}: {case}"
        );
    }
}
