//! The score of SH, by the irradiance of its coefficients.

use super::cause::{Cause, GainSlip, ShForm, ShSlip, ShWindow, Turn, TurnAxis, Unknown};
use super::directions::Directions;
use super::fit::Gain;
use super::light;
use super::sample::{TURN_STEPS_Y, least_turn};
use super::slip::BETTER;
use super::texel::ChannelOrder;
use super::verdict::{Quality, Verdict};
use super::{EXPLAINED, Errors, GOOD, Truth, errors};
use crate::bake::convention::Axes;
use crate::bake::sh::{Coefficients, prescaled};
use crate::base::math::equirect_quadrature::EquirectQuadrature;
use crate::base::math::spherical_harmonics::{COSINE_LOBE, COUNT, DEGREE, basis, irradiance};
use crate::instrument::environment::Environment;
use crate::instrument::environment::layout::LAYOUTS;
use crate::instrument::precompute::sh9::reference::{Sh9, project_bilinear, turned};
use glam::{DQuat, DVec3};
use std::f64::consts::PI;

/// Side of the cube of compared directions, texels.
const SIDE: u32 = 16;
/// Share of the squared coefficients that another light may leave.
const SAME_LIGHT: f64 = 1e-3;
/// Share of the error below which a rest is rounding.
const LEAST: f64 = 1e-6;
/// Most slips that are tried at once.
const SLIPS_MAX: usize = 2;
/// Largest relative difference of a factor on a degree and a known one.
const FACTOR_APART: f64 = 0.02;
/// Largest relative difference of the mean under a window against ringing.
const MEAN_APART: f64 = 0.05;
/// Largest factor of a degree that is missing, and relative difference of one that is not.
const DEGREE_APART: f64 = 0.005;

/// A form of coefficients in a file.
struct Form {
    /// `None` for ours.
    slip: Option<ShForm>,
    /// The file's index of each coefficient of ours.
    order: [usize; COUNT],
    /// Sign of coefficients of odd m.
    odd_sign: f64,
}

const PLAIN: [usize; COUNT] = [0, 1, 2, 3, 4, 5, 6, 7, 8];
static FORMS: [Form; 7] = [
    Form {
        slip: None,
        order: PLAIN,
        odd_sign: 1.0,
    },
    Form {
        slip: Some(ShForm::CondonShortley),
        order: PLAIN,
        odd_sign: -1.0,
    },
    Form {
        slip: Some(ShForm::Unscaled),
        order: PLAIN,
        odd_sign: 1.0,
    },
    Form {
        slip: Some(ShForm::Planar),
        order: PLAIN,
        odd_sign: 1.0,
    },
    Form {
        slip: Some(ShForm::Descending),
        order: [0, 3, 2, 1, 8, 7, 6, 5, 4],
        odd_sign: 1.0,
    },
    Form {
        slip: Some(ShForm::Xyz),
        order: [0, 2, 3, 1, 4, 5, 6, 7, 8],
        odd_sign: 1.0,
    },
    Form {
        slip: Some(ShForm::Xzy),
        order: [0, 3, 2, 1, 4, 5, 6, 7, 8],
        odd_sign: 1.0,
    },
];

impl Form {
    /// Reads coefficients of a file in this form.
    fn read(&self, found: &Coefficients) -> Sh9 {
        let constants = prescaled();
        std::array::from_fn(|k| {
            if self.slip == Some(ShForm::Planar) {
                let number =
                    |index: usize| found.radiance[index / 3][index % 3] * found.factors[index / 3];
                let channels = DVec3::new(number(k), number(COUNT + k), number(2 * COUNT + k));
                return channels / found.factors[k];
            }
            let source = self.order[k];
            // Every second one has an odd m.
            let sign = if k % 2 == 1 { self.odd_sign } else { 1.0 };
            let factor = if self.slip == Some(ShForm::Unscaled) {
                constants[k] * PI / COSINE_LOBE[DEGREE[k]]
            } else {
                1.0
            };
            let rescaled = found.factors[source] / found.factors[k];
            factor * sign * found.radiance[source] * rescaled
        })
    }
}

/// The score of nine coefficients.
#[derive(Clone, Debug)]
pub struct ShScore {
    /// Errors of the irradiance, against the exact coefficients up to degree 2.
    pub errors: Errors,
    /// Largest error of a coefficient over the largest coefficient.
    pub max_error: f64,
    pub verdict: Verdict,
}

/// Scores coefficients; `axes` are the axes of the bake's maps.
pub fn score(truth: &Truth, found: &Coefficients, axes: Axes) -> ShScore {
    let exact = projected(truth.environment);
    let radiance = turned(&found.radiance, |world| axes.to_file(world));
    let directions = Directions::new(&LAYOUTS[0], Axes::SAME, [SIDE; 2]);
    let found_irradiance = irradiance_over_pi(&directions, &radiance);
    let exact_irradiance = irradiance_over_pi(&directions, &exact);
    let errors = errors(
        &directions,
        &found_irradiance,
        &exact_irradiance,
        truth.epsilon(),
        1.0,
    );
    let verdict = if errors.relmse <= GOOD {
        Verdict::Good(Quality::Map)
    } else {
        Verdict::from_causes(causes(truth, found, &radiance, &exact, axes))
    };
    ShScore {
        errors,
        max_error: max_error(&radiance, &exact),
        verdict,
    }
}

fn projected(light: &Environment) -> Sh9 {
    let image = &light.image;
    let texel = |x, y| image.get(x, y);
    project_bilinear(&EquirectQuadrature::new(image.width, image.height, texel))
}

fn irradiance_over_pi(directions: &Directions, sh: &Sh9) -> Vec<DVec3> {
    let normals = directions.world.iter();
    normals.map(|normal| irradiance(sh, *normal) / PI).collect()
}

/// Returns the largest error of a coefficient over the largest coefficient.
fn max_error(found: &Sh9, exact: &Sh9) -> f64 {
    let largest = exact
        .iter()
        .map(|value| value.abs().max_element())
        .fold(0.0, f64::max);
    let largest_error = found
        .iter()
        .zip(exact)
        .map(|(found, exact)| (*found - *exact).abs().max_element())
        .fold(0.0, f64::max);
    largest_error / largest.max(f64::MIN_POSITIVE)
}

/// Names another light, else slips of the form, else a turn.
fn causes(
    truth: &Truth,
    found: &Coefficients,
    radiance: &Sh9,
    exact: &Sh9,
    axes: Axes,
) -> Vec<Cause> {
    if let Some(cause) = other_light(truth, radiance) {
        return vec![cause];
    }
    let slips = form_slips(found, radiance, exact, axes);
    if !slips.is_empty() {
        return slips;
    }
    let unknown = Cause::Unknown(Unknown::NoSlip);
    vec![turn_about_y(radiance, exact).unwrap_or(unknown)]
}

/// Finds another light with these coefficients, up to a gain.
fn other_light(truth: &Truth, radiance: &Sh9) -> Option<Cause> {
    let mean = radiance[0] * basis(DVec3::Y)[0];
    let summed = light::summed(truth.environment)
        .into_iter()
        .filter(|source| source.divisor.is_none());
    light::sources(truth.environment, mean, &[1.0])
        .into_iter()
        .chain(summed)
        .find(|source| is_multiple(radiance, &projected(&source.light)))
        .map(|source| Cause::Source(source.slip))
}

fn is_multiple(found: &Sh9, other: &Sh9) -> bool {
    let mut product = 0.0;
    let mut square = 0.0;
    for (found, other) in found.iter().zip(other) {
        product += found.dot(*other);
        square += other.length_squared();
    }
    let gain = product / square;
    let left = squared_distance(found, &other.map(|value| gain * value));
    left <= SAME_LIGHT * squared_distance(found, &[DVec3::ZERO; COUNT])
}

fn squared_distance(a: &Sh9, b: &Sh9) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (*a - *b).length_squared())
        .sum()
}

/// Finds the turn about y that explains the coefficients.
fn turn_about_y(found: &Sh9, exact: &Sh9) -> Option<Cause> {
    let left = |degrees: f64| {
        let turn = DQuat::from_rotation_y(-degrees.to_radians());
        squared_distance(&turned(found, |world| turn * world), exact)
    };
    let degrees = least_turn(TURN_STEPS_Y, left);
    let is_turn = left(degrees) <= SAME_LIGHT * squared_distance(found, exact);
    let axis = TurnAxis::Y;
    is_turn.then_some(Cause::Turn(Turn { axis, degrees }))
}

/// Names the form, the axes, the order of channels or the factors that leave least; at most two of
/// them. Empty if none leaves little.
fn form_slips(found: &Coefficients, radiance: &Sh9, exact: &Sh9, axes: Axes) -> Vec<Cause> {
    let unchanged = windowed_distance(radiance, exact, [1.0; 3]);
    let mut best = BestForm {
        unchanged,
        cost: f64::INFINITY,
        causes: Vec::new(),
    };
    // Ours first: signs of odd m are also a half turn about z.
    let others = Axes::all().filter(|other| *other != axes);
    for other_axes in [axes].into_iter().chain(others) {
        for form in &FORMS {
            let turned = turned(&form.read(found), |world| other_axes.to_file(world));
            for order in [ChannelOrder::RIGHT].into_iter().chain(ChannelOrder::WRONG) {
                // The change is put into what is right.
                let right = exact.map(|value| order.apply(value));
                let form = form.slip.map(|slip| Cause::Sh(ShSlip::Form(slip)));
                let axes = (other_axes != axes).then_some(Cause::Sh(ShSlip::Axes(other_axes)));
                let channels = (order != ChannelOrder::RIGHT).then_some(Cause::Channels(order));
                let causes: Vec<Cause> = [form, axes, channels].into_iter().flatten().collect();
                best.add(windowed_distance(&turned, &right, [1.0; 3]), &causes);
                let window = window(&turned, &right);
                if let Some(factors) = factors(window) {
                    let left = windowed_distance(&turned, &right, window);
                    best.add(left, &[&causes[..], &[factors]].concat());
                }
            }
        }
    }
    best.causes
}

/// The slips of least cost.
struct BestForm {
    /// Squared distance without slips.
    unchanged: f64,
    cost: f64,
    causes: Vec<Cause>,
}

impl BestForm {
    /// Compares slips that leave a squared distance. Each further slip must leave far less.
    fn add(&mut self, left: f64, causes: &[Cause]) {
        let share = (left / self.unchanged).max(LEAST);
        let cost = share * (1.0 / BETTER).powi(causes.len() as i32);
        if (1..=SLIPS_MAX).contains(&causes.len())
            && left <= EXPLAINED * self.unchanged
            && cost < self.cost
        {
            self.cost = cost;
            self.causes = causes.to_vec();
        }
    }
}

/// Returns the squared distance to `right` with a factor on each degree.
fn windowed_distance(values: &Sh9, right: &Sh9, window: [f64; 3]) -> f64 {
    let square = |((value, right), degree): ((&DVec3, &DVec3), usize)| {
        (*value - *right * window[degree]).length_squared()
    };
    values.iter().zip(right).zip(DEGREE).map(square).sum()
}

/// Names the factors of the degrees; `None` if they are unknown.
fn factors(window: [f64; 3]) -> Option<Cause> {
    let gain = window[0];
    let degree_1 = window[1] / gain;
    let degree_2 = window[2] / gain;
    let are_near = |expected_1: f64, expected_2: f64| {
        (degree_1 / expected_1 - 1.0).abs() < FACTOR_APART
            && (degree_2 / expected_2 - 1.0).abs() < FACTOR_APART
    };
    if are_near(1.0, 1.0) {
        return Some(Cause::Gain(GainSlip::Sh(Gain::new(gain))));
    }
    if are_near(1.5, 4.0) {
        return Some(Cause::Sh(ShSlip::NoCosine));
    }
    if are_near(2.0 / 3.0, 0.25) {
        return Some(Cause::Sh(ShSlip::CosineTwice));
    }
    if (gain - 1.0).abs() >= MEAN_APART || gain.is_nan() {
        return None;
    }
    let is_degree_2_missing =
        (0.0..DEGREE_APART).contains(&degree_2) && (degree_1 - 1.0).abs() < DEGREE_APART;
    let window = if is_degree_2_missing {
        ShWindow::NoDegree2
    } else if degree_1.max(degree_2) > 1.0 + FACTOR_APART || degree_1.min(degree_2) < 0.0 {
        ShWindow::Other([degree_1, degree_2])
    } else {
        ShWindow::Falling([degree_1, degree_2])
    };
    Some(Cause::Sh(ShSlip::Window(window)))
}

/// Fits a factor to each degree of the exact coefficients.
fn window(found: &Sh9, exact: &Sh9) -> [f64; 3] {
    let mut products = [0.0; 3];
    let mut squares = [f64::MIN_POSITIVE; 3];
    for ((found, exact), degree) in found.iter().zip(exact).zip(DEGREE) {
        products[degree] += found.dot(*exact);
        squares[degree] += exact.length_squared();
    }
    std::array::from_fn(|degree| products[degree] / squares[degree])
}

impl ShScore {
    /// Removes factors from the verdict because the axes or the light do not fit.
    pub fn doubt(&mut self) {
        let names_axes = self.verdict.causes().iter().any(Cause::is_axes);
        if self.errors.relmse > GOOD && !names_axes {
            self.verdict = Verdict::from_causes(vec![Cause::Unknown(Unknown::Doubt)]);
        }
    }
}
