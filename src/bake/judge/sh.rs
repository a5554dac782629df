//! The score of SH, by the irradiance of its coefficients.

use super::directions::Directions;
use super::fit;
use super::level::{DOUBT, GOOD_WORDS};
use super::light::{self, Source};
use super::sample::{least_turn, turn_in_words};
use super::slip::BETTER;
use super::texel::{Change, ORDERS};
use super::{Cause, EXPLAINED, Errors, GOOD, Truth, errors, words};
use crate::bake::convention::Axes;
use crate::bake::sh::{Coefficients, prescaled, turned};
use crate::base::math::equirect_quadrature::EquirectQuadrature;
use crate::base::math::spherical_harmonics::{COSINE_LOBE, COUNT, DEGREE, basis, irradiance};
use crate::instrument::environment::Environment;
use crate::instrument::environment::layout::LAYOUTS;
use crate::instrument::precompute::sh9::reference::{Sh9, project_bilinear};
use glam::{DQuat, DVec3};
use std::f64::consts::PI;

const SIDE: u32 = 16;
/// Share of the squared coefficients that another light may leave.
const SAME_LIGHT: f64 = 1e-3;
/// Share of the error below which a rest is rounding.
const LEAST: f64 = 1e-6;

const PLAIN: [usize; COUNT] = [0, 1, 2, 3, 4, 5, 6, 7, 8];
/// A form without the constants of the basis, as of cmgen's `--sh-irradiance`.
const UNSCALED: &str = "not pre-scaled by the factors of the basis";
/// A form of nine numbers a channel, one channel after the other.
const PLANAR: &str = "numbers of one channel after the other; expected triples";
/// The orders of other programs: the file's number of each coefficient of ours, and the sign of odd
/// m.
static FORMS: &[(&str, [usize; COUNT], f64)] = &[
    ("", PLAIN, 1.0),
    (
        "odd m have the other sign, as by Condon and Shortley",
        PLAIN,
        -1.0,
    ),
    (UNSCALED, PLAIN, 1.0),
    (PLANAR, PLAIN, 1.0),
    (
        "each degree is in the order m = l to -l",
        [0, 3, 2, 1, 8, 7, 6, 5, 4],
        1.0,
    ),
    (
        "degree 1 is in the order x, y, z; expected y, z, x",
        [0, 2, 3, 1, 4, 5, 6, 7, 8],
        1.0,
    ),
    (
        "degree 1 is in the order x, z, y; expected y, z, x",
        [0, 3, 2, 1, 4, 5, 6, 7, 8],
        1.0,
    ),
];

#[derive(Clone, Debug)]
pub struct ShScore {
    /// Errors of the irradiance, against the exact coefficients up to degree 2.
    pub errors: Errors,
    /// Largest error of a coefficient over the largest coefficient.
    pub max_error: f64,
    /// What the verdict names; empty if the part is good.
    pub causes: Vec<Cause>,
    pub verdict: String,
}

/// Scores coefficients; `axes` are the axes of the bake's maps.
pub fn score(truth: &Truth, found: &Coefficients, axes: Axes) -> ShScore {
    let quadrature = |light: &Environment| {
        let image = &light.image;
        EquirectQuadrature::new(image.width, image.height, |x, y| image.get(x, y))
    };
    let exact = project_bilinear(&quadrature(truth.environment));
    let directions = Directions::new(&LAYOUTS[0], Axes::SAME, [SIDE; 2]);
    let of = |sh: &Sh9| -> Vec<DVec3> {
        directions
            .world
            .iter()
            .map(|normal| irradiance(sh, *normal) / PI)
            .collect()
    };
    let own = turned(&found.radiance, |world| axes.to_file(world));
    let errors = errors(&directions, &of(&own), &of(&exact), truth.epsilon(), 1.0);
    let largest = exact
        .iter()
        .map(|value| value.abs().max_element())
        .fold(0.0, f64::max);
    let largest_error = own
        .iter()
        .zip(&exact)
        .map(|(own, exact)| (*own - *exact).abs().max_element());
    let max_error = largest_error.fold(0.0, f64::max) / largest.max(f64::MIN_POSITIVE);
    let causes = if errors.relmse <= GOOD {
        Vec::new()
    } else {
        causes(found, &own, &exact, axes)
    };
    // Other light, up to a gain.
    let off = |exact: &Sh9, gain: f64| -> f64 {
        own.iter()
            .zip(exact)
            .map(|(a, b)| (*a - gain * *b).length_squared())
            .sum()
    };
    let fits = |source: &Source| {
        let other = project_bilinear(&quadrature(&source.light));
        let [product, square] = own.iter().zip(&other).fold([0.0; 2], |[p, s], (a, b)| {
            [p + a.dot(*b), s + b.length_squared()]
        });
        off(&other, product / square) <= SAME_LIGHT * off(&[DVec3::ZERO; COUNT], 0.0)
    };
    let mean = own[0] * basis(DVec3::Y)[0];
    let lights = || {
        let summed = light::summed(truth.environment)
            .into_iter()
            .filter(|source| source.whole.is_none());
        light::sources(truth.environment, mean, &[1.0])
            .into_iter()
            .chain(summed)
    };
    let other = (errors.relmse > GOOD)
        .then(|| lights().find(fits))
        .flatten()
        .map(|source| source.cause);
    let turn = || {
        let about_y = |degrees: f64| {
            turned(&own, |world| {
                DQuat::from_rotation_y(-degrees.to_radians()) * world
            })
        };
        let left = |degrees: f64| {
            about_y(degrees)
                .iter()
                .zip(&exact)
                .map(|(a, b)| (*a - *b).length_squared())
                .sum()
        };
        let degrees = least_turn(36, left);
        let is_turn = left(degrees) <= SAME_LIGHT * off(&exact, 1.0);
        is_turn.then(|| Cause {
            kind: "turn",
            words: turn_in_words(degrees, "y"),
        })
    };
    let other = other.or_else(|| {
        causes
            .iter()
            .any(|cause| cause.kind == "unknown")
            .then(turn)
            .flatten()
    });
    let causes = other.map_or(causes, |cause| vec![cause]);
    let verdict = if errors.relmse <= GOOD {
        GOOD_WORDS.to_owned()
    } else {
        words(&causes)
    };
    ShScore {
        errors,
        max_error,
        causes,
        verdict,
    }
}

/// Names the form, the axes, the order of channels or the factors that leave least; at most two of
/// them.
fn causes(found: &Coefficients, own: &Sh9, exact: &Sh9, axes: Axes) -> Vec<Cause> {
    let off = |values: &Sh9, right: &Sh9, window: [f64; 3]| -> f64 {
        let square = |((own, right), l): ((&DVec3, &DVec3), usize)| {
            (*own - *right * window[l]).length_squared()
        };
        values.iter().zip(right).zip(DEGREE).map(square).sum()
    };
    let scaled = prescaled();
    let as_it_is = off(own, exact, [1.0; 3]);
    let mut best = (f64::INFINITY, Vec::new());
    // Ours first: signs of odd m are also a half turn about z.
    for other in [axes]
        .into_iter()
        .chain(Axes::all().filter(|other| *other != axes))
    {
        for (form, order, odd) in FORMS {
            let radiance = std::array::from_fn(|k| {
                // Every second one has an odd m.
                let (from, sign) = (order[k], if k % 2 == 1 { *odd } else { 1.0 });
                let factor = if *form == UNSCALED {
                    scaled[k] * PI / COSINE_LOBE[DEGREE[k]]
                } else {
                    1.0
                };
                if *form == PLANAR {
                    let number = |at: usize| found.radiance[at / 3][at % 3] * found.factors[at / 3];
                    return DVec3::new(number(k), number(COUNT + k), number(2 * COUNT + k))
                        / found.factors[k];
                }
                factor * sign * found.radiance[from] * (found.factors[from] / found.factors[k])
            });
            let turned = turned(&radiance, |world| other.to_file(world));
            for (channels, change) in [("R, G, B", (|x| x) as Change)].iter().chain(ORDERS) {
                // The change is put into what is right.
                let right = exact.map(change);
                let mut causes = Vec::new();
                let mut add = |kind, is_so: bool, words: String| {
                    is_so.then(|| causes.push(Cause { kind, words }))
                };
                add("order", !form.is_empty(), (*form).to_owned());
                add(
                    "axes",
                    other != axes,
                    format!("axes {other} fit: --axes={other}"),
                );
                add(
                    "channels",
                    *channels != "R, G, B",
                    format!("channels in the order {channels}"),
                );
                let window = window(&turned, &right);
                let with_window = factors(window).map(|factors| {
                    (
                        off(&turned, &right, window),
                        causes.iter().cloned().chain([factors]).collect::<Vec<_>>(),
                    )
                });
                for (left, causes) in [(off(&turned, &right, [1.0; 3]), causes)]
                    .into_iter()
                    .chain(with_window)
                {
                    // Each further cause must leave far less.
                    let cost =
                        (left / as_it_is).max(LEAST) * (1.0 / BETTER).powi(causes.len() as i32);
                    if (1..=2).contains(&causes.len())
                        && left <= EXPLAINED * as_it_is
                        && cost < best.0
                    {
                        best = (cost, causes);
                    }
                }
            }
        }
    }
    let unknown = || {
        vec![Cause {
            kind: "unknown",
            words: "no known slip explains it".to_owned(),
        }]
    };
    if best.1.is_empty() { unknown() } else { best.1 }
}

fn factors(window: [f64; 3]) -> Option<Cause> {
    let [one, two] = [window[1] / window[0], window[2] / window[0]];
    let is = |a: f64, b: f64| (one / a - 1.0).abs() < 0.02 && (two / b - 1.0).abs() < 0.02;
    let (gain, _) = fit::gain_in_words(window[0]);
    Some(match () {
        () if is(1.0, 1.0) => Cause {
            kind: "gain",
            words: gain,
        },
        () if is(1.5, 4.0) => Cause {
            kind: "cosine",
            words: "radiance: not convolved with the cosine".to_owned(),
        },
        () if is(2.0 / 3.0, 0.25) => Cause {
            kind: "cosine",
            words: "convolved with the cosine once too often".to_owned(),
        },
        () if (window[0] - 1.0).abs() < 0.05 => {
            let words = match two {
                0.0..0.005 if (one - 1.0).abs() < 0.005 => "degree 2 is missing".to_owned(),
                _ if one.max(two) > 1.02 || one.min(two) < 0.0 => {
                    format!("degrees 1 and 2 times {one:.2} and {two:.2}")
                }
                _ => format!(
                    "windowed against ringing: degree 1 times {one:.2}, degree 2 times {two:.2}"
                ),
            };
            Cause {
                kind: "window",
                words,
            }
        }
        () => return None,
    })
}

impl ShScore {
    /// Removes factors from the verdict because the axes or the light do not fit.
    pub fn doubt(&mut self) {
        if self.errors.relmse > GOOD && self.causes.iter().all(|cause| cause.kind != "axes") {
            self.verdict = DOUBT.to_owned();
            self.causes = vec![Cause {
                kind: "unknown",
                words: DOUBT.to_owned(),
            }];
        }
    }
}

/// Fits a factor to each degree of the exact coefficients.
fn window(own: &Sh9, exact: &Sh9) -> [f64; 3] {
    let (mut products, mut squares) = ([0.0; 3], [f64::MIN_POSITIVE; 3]);
    for ((own, exact), l) in own.iter().zip(exact).zip(DEGREE) {
        products[l] += own.dot(*exact);
        squares[l] += exact.length_squared();
    }
    std::array::from_fn(|l| products[l] / squares[l])
}
