//! Weights of views: how much each n·v counts in a score of the scene `design`, which shows every n·v equally often.

use super::Metric;

/// A density of n·v.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Weight {
    /// 2 n·v, as a sphere under an orthographic camera shows it.
    #[default]
    Picture,
    Uniform,
    /// The measured density of a rendered scene.
    Scene(String),
}

impl Weight {
    /// The weights that need no scene.
    pub const NAMES: [&'static str; 2] = ["picture", "uniform"];

    /// The weight of that name; any other name is of a scene.
    pub fn of_name(name: &str) -> Self {
        match name {
            "picture" => Self::Picture,
            "uniform" => Self::Uniform,
            scene => Self::Scene(scene.to_owned()),
        }
    }

    /// Name in files, on the command line and in tables.
    pub fn name(&self) -> &str {
        match self {
            Self::Picture => Self::NAMES[0],
            Self::Uniform => Self::NAMES[1],
            Self::Scene(scene) => scene,
        }
    }
}

/// How scores of parts of an image make the score of the whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pooling {
    /// A mean over pixels.
    Mean,
    /// The root of a mean over pixels.
    RootMean,
    /// A sum over pixels, divided by the sum of the reference.
    OverReference,
    /// The parts do not determine it.
    None,
}

/// A number of one part of an image.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// How much the part counts.
    pub weight: f64,
    pub value: f64,
    /// RGB mean of the reference over the part, if known.
    pub reference_mean: Option<f64>,
}

impl Metric {
    /// Computes the score of the whole from the scores of its parts; `None` if they do not determine it.
    pub fn pooled(&self, parts: &[Part]) -> Option<f64> {
        match self.pooling {
            Pooling::Mean => mean(parts, |part| Some(part.value)),
            Pooling::RootMean => mean(parts, |part| Some(part.value * part.value)).map(f64::sqrt),
            Pooling::OverReference => {
                let difference = mean(parts, |part| Some(part.value * part.reference_mean?))?;
                Some(difference / mean(parts, |part| part.reference_mean)?)
            }
            Pooling::None => None,
        }
    }

    /// Computes the noise floor of the whole from the floors of its parts. The noise of parts is independent.
    pub fn pooled_floor(&self, parts: &[Part]) -> Option<f64> {
        if self.pooling != Pooling::OverReference {
            return self.pooled(parts);
        }
        let total: f64 = parts.iter().map(|part| part.weight).sum();
        let variance = mean(parts, |part| Some(part.weight / total * (part.value * part.reference_mean?).powi(2)))?;
        Some(variance.sqrt() / mean(parts, |part| part.reference_mean)?)
    }
}

/// Weighted mean of a number of each part; `None` if one lacks it or the parts weigh nothing.
fn mean(parts: &[Part], number: impl Fn(&Part) -> Option<f64>) -> Option<f64> {
    let total: f64 = parts.iter().map(|part| part.weight).sum();
    let sum = parts.iter().map(|part| Some(part.weight * number(part)?)).sum::<Option<f64>>()?;
    Some(sum / total).filter(|mean| mean.is_finite())
}
