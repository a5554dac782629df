//! The tone curve: `c = (e L / (e L + 1))^(contrast / 2.2)` per channel [source document 0, with the corrections of docs].

pub mod pass;

/// Parameters of the tone curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToneCurve {
    /// `e`, > 0.
    pub exposure: f32,
    /// Exponent over 2.2; > 1 darkens.
    pub contrast: f32,
}

impl Default for ToneCurve {
    fn default() -> Self {
        Self { exposure: 1.0, contrast: 1.0 }
    }
}
