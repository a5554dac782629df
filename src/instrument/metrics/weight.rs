//! Weights of views: how much each n·v counts in a score of the scene `design`, which shows every
//! n·v equally often.

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

/// A number over the pixels in a range of n·v.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    pub n_dot_v: [f64; 2],
    /// How much the part counts; 0 if it only shows how the number changes with n·v.
    pub weight: f64,
    pub value: f64,
    /// RGB mean of the reference over the part, if known.
    pub reference_mean: Option<f64>,
}

impl Metric {
    /// Computes the score of the whole from the scores of its parts, ascending by n·v; `None` if
    /// they do not determine it. If `is_tilted`, views within a part count by their n·v, else
    /// alike.
    pub fn pooled(&self, parts: &[Part], is_tilted: bool) -> Option<f64> {
        let mean = |number: fn(&Part) -> Option<f64>| mean(parts, is_tilted, number);
        match self.pooling {
            Pooling::Mean => mean(|part| Some(part.value)),
            Pooling::RootMean => mean(|part| Some(part.value * part.value)).map(f64::sqrt),
            Pooling::OverReference => Some(
                mean(|part| Some(part.value * part.reference_mean?))?
                    / mean(|part| part.reference_mean)?,
            ),
            Pooling::None => None,
        }
    }

    /// Computes the noise floor of the whole from the floors of its parts. The noise of parts is
    /// independent.
    pub fn pooled_floor(&self, parts: &[Part], is_tilted: bool) -> Option<f64> {
        if self.pooling != Pooling::OverReference {
            return self.pooled(parts, is_tilted);
        }
        let total: f64 = parts.iter().map(|part| part.weight).sum();
        let square =
            |part: &Part| Some(part.weight / total * (part.value * part.reference_mean?).powi(2));
        Some(
            mean(parts, is_tilted, square)?.sqrt()
                / mean(parts, is_tilted, |part| part.reference_mean)?,
        )
    }
}

/// Weighted mean of a number of each part; `None` if one lacks it or the parts weigh nothing.
///
/// With the density 2 μ the mean over a part of width h about μ is `m + h²/(12 μ) s`, m the plain
/// mean and s the slope of the number: exact for a polynomial of degree 2, since the slope is of
/// the parabola through three neighbours.
fn mean(parts: &[Part], is_tilted: bool, number: impl Fn(&Part) -> Option<f64>) -> Option<f64> {
    let numbers = parts.iter().map(number).collect::<Option<Vec<f64>>>()?;
    let centre = |part: &Part| 0.5 * (part.n_dot_v[0] + part.n_dot_v[1]);
    let points: Vec<[f64; 2]> = parts
        .iter()
        .zip(&numbers)
        .map(|(part, number)| [centre(part), *number])
        .collect();
    let tilted = |(i, part): (usize, &Part)| {
        let width = part.n_dot_v[1] - part.n_dot_v[0];
        let tilt = if is_tilted {
            width * width / (12.0 * centre(part)) * slope(&points, i)
        } else {
            0.0
        };
        part.weight * (numbers[i] + tilt)
    };
    let total: f64 = parts.iter().map(|part| part.weight).sum();
    Some(parts.iter().enumerate().map(tilted).sum::<f64>() / total).filter(|mean| mean.is_finite())
}

/// Slope at point i of the parabola through it and its neighbours, or the two nearest points at an
/// end; 0 below three points.
fn slope(points: &[[f64; 2]], i: usize) -> f64 {
    if points.len() < 3 {
        return 0.0;
    }
    let first = i.clamp(1, points.len() - 2) - 1;
    let [[x0, y0], [x1, y1], [x2, y2]] = [0, 1, 2].map(|k| points[first + k]);
    let below = (y1 - y0) / (x1 - x0);
    let above = (y2 - y1) / (x2 - x1);
    let bend = (above - below) / (x2 - x0);
    below + bend * (2.0 * points[i][0] - x0 - x1)
}
