//! The texels of a level that are compared, and what they would be by each slip of the bake.

use super::directions::{Directions, Grid};
use super::exact::{exact, mirror};
use super::light::Lit;
use super::lobe::{OF_IRRADIANCE, OF_RADIANCE};
use super::{Cause, Truth, errors, fit, has_width};
use crate::base::math::equirect::uv_from_direction;
use crate::base::math::harmonics::SmoothMap;
use crate::instrument::brdf::MODELS;
use crate::instrument::environment::Environment;
use crate::instrument::precompute::prefilter::{Kernel, WEIGHTS, harmonic};
use glam::{DQuat, DVec2, DVec3};

/// Approximate number of texels that are compared.
const TEXELS: usize = 864;
/// Step of the turns that are tried, degrees: any about y, up to 45 about x and z. Then bisections
/// around the best.
const TURN_STEP: f64 = 5.0;
const TURNS_REFINED: u32 = 8;
/// Points per side of a mirror level's texel.
const MIRROR_POINTS: u32 = 3;
/// Smallest turn that is a slip, degrees.
const TURN_MIN: f64 = 0.5;

/// Returns the median ratio of a level and its integral: a gain, if only lamps were cut.
pub fn usual_gain(truth: &Truth, directions: &Directions, found: &[DVec3], alpha: f64) -> f64 {
    let chosen = directions.grid(TEXELS);
    let right = exact(truth, truth.kernel, &directions.only(&chosen), alpha);
    let ratio = |(index, right): (&usize, &DVec3)| {
        found[*index].element_sum() / right.element_sum().max(1e-12)
    };
    let mut ratios: Vec<f64> = chosen.iter().zip(&right).map(ratio).collect();
    ratios.sort_by(f64::total_cmp);
    ratios[ratios.len() / 2].max(1e-12)
}

fn nearest(environment: &Environment, world: DVec3) -> DVec3 {
    let image = &environment.image;
    let at = uv_from_direction(world) * DVec2::new(image.width.into(), image.height.into());
    let [x, y] = [
        at.x as u32 % image.width,
        (at.y as u32).min(image.height - 1),
    ];
    DVec3::from_array(image.get(x, y).map(f64::from))
}

/// Finds the turn of least error, degrees: in steps to both sides, then by bisections around the
/// best.
pub fn least_turn(steps: i32, error: impl Fn(f64) -> f64) -> f64 {
    let scored = |degrees: f64| (degrees, error(degrees));
    let nearer = |a: (f64, f64), b: (f64, f64)| if b.1 < a.1 { b } else { a };
    let mut best = (-steps..=steps)
        .map(|k| scored(TURN_STEP * f64::from(k)))
        .fold((0.0, f64::INFINITY), nearer);
    let mut step = 0.5 * TURN_STEP;
    for _ in 0..TURNS_REFINED {
        best = nearer(nearer(best, scored(best.0 - step)), scored(best.0 + step));
        step *= 0.5;
    }
    (best.0 + 180.0).rem_euclid(360.0) - 180.0
}

pub fn turn_in_words(degrees: f64, axis: &str) -> String {
    let offset = if axis == "y" {
        format!(": lat-long offset {:.3}", degrees / 360.0)
    } else {
        String::new()
    };
    format!("turned by {degrees:.0}° about {axis}{offset}")
}

/// A level as its file has it.
#[derive(Clone, Copy)]
pub struct Level<'t, 'd> {
    pub truth: &'t Truth<'t>,
    pub kernel: Kernel,
    /// Return truths of other sources: with the same mean, and other sums.
    pub sources: &'t dyn Fn(usize) -> &'t [Lit<'t>],
    pub directions: &'d Directions,
    pub found: &'d [DVec3],
    pub alpha: f64,
    /// Widths of the levels before it.
    pub before: &'t [f64],
    /// The flag that scales the file, and its value.
    pub scale: (&'static str, f64),
    /// Whether only the first slips are tried.
    pub is_lost: bool,
}

/// Values that a file with some slips would have.
#[derive(Clone)]
pub struct Slipped {
    pub causes: Vec<Cause>,
    pub values: Vec<DVec3>,
}

impl Slipped {
    fn one(kind: &'static str, words: String, values: Vec<DVec3>) -> Self {
        Self {
            causes: vec![Cause { kind, words }],
            values,
        }
    }

    pub fn with(&self, kind: &'static str, words: String, change: impl Fn(DVec3) -> DVec3) -> Self {
        let causes = [&self.causes[..], &[Cause { kind, words }]].concat();
        Self {
            causes,
            values: self.values.iter().map(|x| change(*x)).collect(),
        }
    }
}

pub struct Sample<'a, 't> {
    pub level: &'a Level<'t, 'a>,
    pub directions: Directions,
    pub found: Vec<DVec3>,
    /// The right map; `None` for a mirror.
    map: Option<SmoothMap>,
    /// Largest value of the level.
    pub most: f64,
}

impl<'a, 't> Sample<'a, 't> {
    pub fn new(level: &'a Level<'t, 'a>) -> Self {
        let chosen = level.directions.grid(TEXELS);
        let found = chosen.iter().map(|index| level.found[*index]).collect();
        let most = level
            .found
            .iter()
            .map(|texel| texel.max_element())
            .fold(0.0, f64::max);
        let map =
            has_width(level.alpha).then(|| level.truth.prefiltered_by(level.kernel, level.alpha));
        Self {
            level,
            directions: level.directions.only(&chosen),
            found,
            map,
            most,
        }
    }

    /// The right texels at these directions, turned.
    pub fn right(&self, directions: &Directions, turn: DQuat) -> Vec<DVec3> {
        let light = self.level.truth.environment;
        match &self.map {
            Some(map) => directions
                .world
                .iter()
                .map(|world| map.value(turn * *world))
                .collect(),
            None if turn == DQuat::IDENTITY => mirror(light, directions),
            None => directions.means(MIRROR_POINTS, |world| light.radiance(turn * world)),
        }
    }

    /// The right texels by a light and a kernel.
    pub fn of(&self, truth: &Truth, kernel: Kernel) -> Vec<DVec3> {
        exact(truth, kernel, &self.directions, self.level.alpha)
    }

    pub fn off(&self, found: &[DVec3], slipped: &[DVec3]) -> f64 {
        errors(
            &self.directions,
            found,
            slipped,
            self.level.truth.epsilon(),
            1.0,
        )
        .relmse
    }

    fn is_irradiance(&self) -> bool {
        self.level.kernel.brdf.name() != self.level.truth.kernel.brdf.name()
    }

    /// Levels of a light, with its causes, by other weights and models; for irradiance, the mean
    /// over the hemisphere.
    fn by_others(&self, truth: &Truth, causes: &[Cause]) -> Vec<Slipped> {
        let Kernel {
            brdf,
            weight,
            masking,
        } = self.level.kernel;
        if !has_width(self.level.alpha) {
            return Vec::new();
        }
        let of = |cause: Cause, kernel| Slipped {
            causes: [causes, &[cause]].concat(),
            values: self.of(truth, kernel),
        };
        let is_irradiance = self.is_irradiance();
        let others = WEIGHTS.iter().filter(|other| other.name != weight.name);
        let weights = others
            .filter(|other| !is_irradiance || other.name == "none")
            .map(|other| {
                let words = match other.name {
                    "none" if is_irradiance => "not weighted by the cosine".to_owned(),
                    "none" => "not weighted by n·l: --weight none".to_owned(),
                    "cosine" => "weighted by n·l: --weight cosine".to_owned(),
                    name => format!("weighted by G1 of l: --weight {name}"),
                };
                of(
                    Cause {
                        kind: "weight",
                        words,
                    },
                    Kernel::new(brdf, other, masking),
                )
            });
        let models = MODELS
            .iter()
            .filter(|other| !is_irradiance && other.name() != brdf.name())
            .map(|other| {
                let words = format!("of another model: --brdf {}", other.name());
                of(
                    Cause {
                        kind: "model",
                        words,
                    },
                    Kernel::new(*other, weight, masking),
                )
            });
        weights.chain(models).collect()
    }

    /// Levels by another kernel, and the map itself at the level's size.
    pub fn kernels(&self) -> Vec<Slipped> {
        let Level {
            truth,
            kernel,
            alpha,
            before,
            ..
        } = *self.level;
        let world = self.directions.world.iter();
        if !has_width(alpha) {
            let linear = world
                .clone()
                .map(|world| truth.environment.radiance(*world))
                .collect();
            let values = [
                linear,
                world
                    .map(|world| nearest(truth.environment, *world))
                    .collect(),
            ];
            let words = "one lookup a texel, not the mean over it";
            return values
                .map(|values| Slipped::one("mips", words.to_owned(), values))
                .to_vec();
        }
        let by = |words: &str, factors: &[f64]| {
            let map = truth.harmonics.convolved(factors);
            Slipped::one(
                "lobe",
                words.to_owned(),
                world.clone().map(|world| map.value(*world)).collect(),
            )
        };
        let degree = truth.harmonics.degree();
        let lobes = if self.is_irradiance() {
            OF_IRRADIANCE
        } else {
            OF_RADIANCE
        };
        let lobes = lobes.iter().map(|(words, weight)| {
            let most = degree.min(harmonic::degree(alpha));
            by(
                words,
                &harmonic::factors_of(kernel.brdf, alpha, most, |cos| weight(&kernel, alpha, cos)),
            )
        });
        let mut all: Vec<Slipped> = self
            .by_others(truth, &[])
            .into_iter()
            .chain(lobes)
            .collect();
        if !self.is_irradiance() {
            let plain = mirror(truth.environment, &self.directions);
            all.push(Slipped::one(
                "mips",
                "plain mips: not prefiltered".to_owned(),
                plain,
            ));
        }
        let before: Vec<f64> = before
            .iter()
            .copied()
            .filter(|alpha| has_width(*alpha))
            .collect();
        if !before.is_empty() {
            let own = truth.factors(kernel, alpha, degree);
            let times = |a: Vec<f64>, b: f64| -> Vec<f64> {
                a.into_iter()
                    .zip(truth.factors(kernel, b, degree))
                    .map(|(a, b)| a * b)
                    .collect()
            };
            let words = "filtered from the level before it by its whole width: blurs add up";
            all.push(by(words, &before.into_iter().fold(own, times)));
        }
        all
    }

    /// Texels that are taken to lie elsewhere in their face.
    pub fn grids(&self) -> Vec<Slipped> {
        let grids = [
            (
                "texels at their corners, i/n; expected centres, (i + 0.5)/n",
                -0.5,
                false,
            ),
            (
                "texels at their corners, (i + 1)/n; expected centres, (i + 0.5)/n",
                0.5,
                false,
            ),
            (
                "texels at i/(n - 1), from edge to edge; expected centres, (i + 0.5)/n",
                0.0,
                true,
            ),
        ];
        let is_fine = self.directions.size.into_iter().all(|side| side > 1);
        let on = |(words, shift, is_stretched): &(&str, f64, bool)| {
            let directions = self.directions.on(Grid {
                shift: *shift,
                is_stretched: *is_stretched,
            });
            Slipped::one(
                "shift",
                (*words).to_owned(),
                self.right(&directions, DQuat::IDENTITY),
            )
        };
        if is_fine {
            grids.iter().map(on).collect()
        } else {
            Vec::new()
        }
    }

    pub fn sources(&self, kind: usize) -> Vec<Slipped> {
        let of = |source: &Lit| {
            let mut values = self.of(&source.truth, self.level.kernel);
            if let Some(whole) = &source.whole {
                let whole = self.of(whole, self.level.kernel);
                values
                    .iter_mut()
                    .zip(whole)
                    .for_each(|(value, whole)| *value /= whole);
            }
            Slipped {
                causes: vec![source.cause.clone()],
                values,
            }
        };
        (self.level.sources)(kind).iter().map(of).collect()
    }

    /// Levels of the likeliest other source by other kernels. Each further source takes a second.
    pub fn sources_by_others(&self) -> Vec<Slipped> {
        let by_others =
            |source: &Lit| self.by_others(&source.truth, std::slice::from_ref(&source.cause));
        (self.level.sources)(0)
            .first()
            .map_or(Vec::new(), by_others)
    }

    /// Turns that are not quarters; about y, the offset of a lat-long map.
    pub fn turns(&self) -> Vec<Slipped> {
        ["x", "y", "z"]
            .into_iter()
            .zip(DVec3::AXES)
            .filter_map(|(name, axis)| self.turn(name, axis))
            .collect()
    }

    fn turn(&self, name: &str, axis: DVec3) -> Option<Slipped> {
        let turned = |degrees: f64| {
            self.right(
                &self.directions,
                DQuat::from_axis_angle(axis, degrees.to_radians()),
            )
        };
        let error = |degrees: f64| {
            let values: Vec<DVec3> = turned(degrees);
            let gain = self.gain(&values);
            self.off(
                &self.found,
                &values.iter().map(|x| gain * *x).collect::<Vec<_>>(),
            )
        };
        let degrees = least_turn(if name == "y" { 36 } else { 9 }, error);
        (degrees.abs() >= TURN_MIN)
            .then(|| Slipped::one("turn", turn_in_words(degrees, name), turned(degrees)))
    }

    pub fn sum(&self, texels: &[DVec3]) -> f64 {
        texels
            .iter()
            .zip(&self.directions.weights)
            .map(|(x, weight)| weight * x.element_sum())
            .sum()
    }

    pub fn gain(&self, values: &[DVec3]) -> f64 {
        fit::gain(
            &self.directions,
            &self.found,
            values,
            self.level.truth.epsilon(),
        )
    }
}
