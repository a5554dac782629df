//! The texels of a level that are compared, and what they would be by each slip of the bake.

use super::cause::{Cause, CutSlip, Mips, Scale, Turn, TurnAxis};
use super::directions::{Directions, TexelGrid};
use super::exact::{exact, mirror};
use super::light::{Lit, OtherLights};
use super::lobe::Lobe;
use super::{Truth, errors, fit, has_width};
use crate::base::glsl::constants::PREFILTER_WEIGHT_NONE;
use crate::base::math::equirect::uv_from_direction;
use crate::base::math::harmonics::SmoothMap;
use crate::instrument::brdf::MODELS;
use crate::instrument::environment::Environment;
use crate::instrument::precompute::prefilter::{Kernel, WEIGHTS, harmonic};
use glam::{DQuat, DVec2, DVec3};

/// Approximate number of texels that are compared.
const TEXELS: usize = 864;
/// Step of the turns that are tried, degrees.
const TURN_STEP: f64 = 5.0;
/// Steps to both sides: any turn about y, up to 45 degrees about x and z.
pub const TURN_STEPS_Y: i32 = 36;
const TURN_STEPS_XZ: i32 = 9;
/// Bisections around the best turn.
const TURNS_REFINED: u32 = 8;
/// Points per side of a mirror level's texel.
const MIRROR_POINTS: u32 = 3;
/// Smallest turn that is a slip, degrees.
const TURN_MIN: f64 = 0.5;
/// Smallest exact value that a ratio is taken of.
const EXACT_MIN: f64 = 1e-12;

/// Returns the median ratio of a level and its integral: a gain, if only lamps were cut.
pub fn usual_gain(truth: &Truth, directions: &Directions, found: &[DVec3], alpha: f64) -> f64 {
    let chosen = directions.grid(TEXELS);
    let right = exact(truth, truth.kernel, &directions.only(&chosen), alpha);
    let ratio = |(index, right): (&usize, &DVec3)| {
        found[*index].element_sum() / right.element_sum().max(EXACT_MIN)
    };
    let mut ratios: Vec<f64> = chosen.iter().zip(&right).map(ratio).collect();
    ratios.sort_by(f64::total_cmp);
    ratios[ratios.len() / 2].max(EXACT_MIN)
}

/// A way to look the environment up once a texel.
#[derive(Clone, Copy)]
struct Lookup {
    mips: Mips,
    /// Added to the position in pixels before it is floored; `None` to interpolate.
    shift: Option<DVec2>,
}

const fn rounded(x: f64, y: f64) -> Lookup {
    Lookup {
        mips: Mips::OneLookupRounded,
        shift: Some(DVec2::new(x, y)),
    }
}

/// Rounded rows may be counted from the bottom.
const LOOKUPS: [Lookup; 6] = [
    Lookup {
        mips: Mips::OneLookup,
        shift: None,
    },
    Lookup {
        mips: Mips::OneLookup,
        shift: Some(DVec2::ZERO),
    },
    rounded(0.5, 0.5),
    rounded(0.5, -0.5),
    rounded(-0.5, 0.5),
    rounded(-0.5, -0.5),
];

impl Lookup {
    fn value(self, environment: &Environment, world: DVec3) -> DVec3 {
        let Some(shift) = self.shift else {
            return environment.radiance(world);
        };
        let image = &environment.image;
        let size = DVec2::new(image.width.into(), image.height.into());
        let pixel = (uv_from_direction(world) * size + shift).floor();
        let x = pixel.x.rem_euclid(size.x) as u32;
        let y = pixel.y.clamp(0.0, size.y - 1.0) as u32;
        DVec3::from_array(image.get(x, y).map(f64::from))
    }
}

#[derive(Clone, Copy)]
struct ScoredTurn {
    degrees: f64,
    error: f64,
}

/// Finds the turn of least error, degrees: in steps to both sides, then by bisections around the
/// best.
pub fn least_turn(steps: i32, error: impl Fn(f64) -> f64) -> f64 {
    let scored = |degrees: f64| ScoredTurn {
        degrees,
        error: error(degrees),
    };
    let better = |a: ScoredTurn, b: ScoredTurn| if b.error < a.error { b } else { a };
    let mut best = ScoredTurn {
        degrees: 0.0,
        error: f64::INFINITY,
    };
    for step in -steps..=steps {
        best = better(best, scored(TURN_STEP * f64::from(step)));
    }
    let mut step = 0.5 * TURN_STEP;
    for _ in 0..TURNS_REFINED {
        let below = scored(best.degrees - step);
        let above = scored(best.degrees + step);
        best = better(better(best, below), above);
        step *= 0.5;
    }
    (best.degrees + 180.0).rem_euclid(360.0) - 180.0
}

/// A level as its file has it.
#[derive(Clone, Copy)]
pub struct Level<'t, 'd> {
    pub truth: &'t Truth<'t>,
    pub kernel: Kernel,
    /// The right map; `None` for a mirror.
    pub map: Option<&'d SmoothMap>,
    pub lights: &'d OtherLights<'t>,
    pub directions: &'d Directions,
    pub found: &'d [DVec3],
    pub alpha: f64,
    /// Widths of the levels before it.
    pub alphas_before: &'d [f64],
    pub scale: Scale,
    /// Mean of all texels over the exact mean.
    pub mean_ratio: f64,
    /// A cut that texels at one maximum prove.
    pub proven_cut: Option<CutSlip>,
    /// Whether it may have been filtered from level 0, where something is wrong.
    pub may_inherit: bool,
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
    pub fn one(cause: Cause, values: Vec<DVec3>) -> Self {
        Self {
            causes: vec![cause],
            values,
        }
    }

    /// Adds a slip that changes each texel by itself.
    pub fn with(&self, cause: Cause, change: impl Fn(DVec3) -> DVec3) -> Self {
        Self {
            causes: [&self.causes[..], &[cause]].concat(),
            values: self.values.iter().map(|value| change(*value)).collect(),
        }
    }
}

/// The compared texels of a level.
pub struct Sample<'a, 't> {
    pub level: &'a Level<'t, 'a>,
    pub directions: Directions,
    pub found: Vec<DVec3>,
    /// Largest value of the level.
    pub most: f64,
}

impl<'a, 't> Sample<'a, 't> {
    pub fn new(level: &'a Level<'t, 'a>) -> Self {
        let chosen = level.directions.grid(TEXELS);
        let most = level
            .found
            .iter()
            .map(|texel| texel.max_element())
            .fold(0.0, f64::max);
        Self {
            level,
            directions: level.directions.only(&chosen),
            found: fit::picked(level.found, &chosen),
            most,
        }
    }

    /// Keeps one of `step` texels.
    pub fn every(&self, step: usize) -> Sample<'_, 't> {
        let chosen: Vec<usize> = (0..self.found.len()).step_by(step).collect();
        Sample {
            level: self.level,
            directions: self.directions.only(&chosen),
            found: fit::picked(&self.found, &chosen),
            most: self.most,
        }
    }

    /// Returns the right texels at these directions, turned.
    pub fn right(&self, directions: &Directions, turn: DQuat) -> Vec<DVec3> {
        let light = self.level.truth.environment;
        match self.level.map {
            Some(map) => directions
                .world
                .iter()
                .map(|world| map.value(turn * *world))
                .collect(),
            None if turn == DQuat::IDENTITY => mirror(light, directions),
            None => directions.means(MIRROR_POINTS, |world| light.radiance(turn * world)),
        }
    }

    /// Returns the right texels by a light and a kernel.
    fn right_by(&self, truth: &Truth, kernel: Kernel) -> Vec<DVec3> {
        exact(truth, kernel, &self.directions, self.level.alpha)
    }

    /// Returns the relMSE of slipped texels.
    pub fn relmse(&self, slipped: &[DVec3]) -> f64 {
        let epsilon = self.level.truth.epsilon();
        errors(&self.directions, &self.found, slipped, epsilon, 1.0).relmse
    }

    /// Returns what the file's rounding makes of values.
    pub fn stored(&self, values: &[DVec3]) -> Vec<DVec3> {
        self.level.truth.stored(values, self.level.scale.value)
    }

    pub fn is_irradiance(&self) -> bool {
        self.level.kernel.brdf.name() != self.level.truth.kernel.brdf.name()
    }

    /// Levels of a light by other weights and models, with a cause of the light; for irradiance,
    /// the mean over the hemisphere.
    fn by_others(&self, truth: &Truth, light_cause: Option<&Cause>) -> Vec<Slipped> {
        if !has_width(self.level.alpha) {
            return Vec::new();
        }
        let other_kernels = if self.is_irradiance() {
            self.unweighted_irradiance()
        } else {
            self.other_kernels()
        };
        other_kernels
            .into_iter()
            .map(|(cause, kernel)| Slipped {
                causes: light_cause.cloned().into_iter().chain([cause]).collect(),
                values: self.right_by(truth, kernel),
            })
            .collect()
    }

    fn unweighted_irradiance(&self) -> Vec<(Cause, Kernel)> {
        let Kernel { brdf, masking, .. } = self.level.kernel;
        WEIGHTS
            .iter()
            .filter(|weight| weight.code == PREFILTER_WEIGHT_NONE)
            .map(|weight| (Cause::NoCosine, Kernel::new(brdf, weight, masking)))
            .collect()
    }

    fn other_kernels(&self) -> Vec<(Cause, Kernel)> {
        let Kernel {
            brdf,
            weight,
            masking,
        } = self.level.kernel;
        let weights = WEIGHTS
            .iter()
            .filter(|other| **other != *weight)
            .map(|other| (Cause::Weight(other), Kernel::new(brdf, other, masking)));
        let models = MODELS
            .iter()
            .filter(|other| other.name() != brdf.name())
            .map(|other| {
                let kernel = Kernel::new(*other, weight, masking);
                (Cause::Model(other.name()), kernel)
            });
        weights.chain(models).collect()
    }

    /// Levels by another kernel, and the map itself at the level's size.
    pub fn kernels(&self, right: &Slipped) -> Vec<Slipped> {
        let truth = self.level.truth;
        if !has_width(self.level.alpha) {
            return self.single_lookups();
        }
        let mut all = self.by_others(truth, None);
        all.extend(self.lobes());
        if !self.is_irradiance() {
            let plain = mirror(truth.environment, &self.directions);
            all.push(Slipped::one(Cause::Mips(Mips::OfEnvironment), plain));
        }
        all.extend(self.added_blurs());
        all.extend(self.coarse_mips(&right.values));
        all.extend(self.faces_alone());
        all
    }

    /// Mirror levels of one lookup a texel: interpolated, nearest or rounded, at centres or
    /// corners.
    fn single_lookups(&self) -> Vec<Slipped> {
        let environment = self.level.truth.environment;
        let looked_up = |directions: &Directions, lookup: Lookup| -> Slipped {
            let world = directions.world.iter();
            let values = world.map(|world| lookup.value(environment, *world));
            Slipped::one(Cause::Mips(lookup.mips), values.collect())
        };
        let mut all = LOOKUPS
            .map(|lookup| looked_up(&self.directions, lookup))
            .to_vec();
        for grid in TexelGrid::CORNERS {
            let directions = self.directions.on(grid);
            all.extend(LOOKUPS.iter().map(|lookup| {
                let mut slipped = looked_up(&directions, *lookup);
                slipped.causes.push(Cause::Grid(grid));
                slipped
            }));
        }
        all
    }

    fn lobes(&self) -> Vec<Slipped> {
        let Level { kernel, alpha, .. } = *self.level;
        let degree = self
            .level
            .truth
            .harmonics
            .degree()
            .min(harmonic::degree(alpha));
        let lobes = if self.is_irradiance() {
            Lobe::OF_IRRADIANCE
        } else {
            Lobe::OF_RADIANCE
        };
        let slipped = |lobe: &Lobe| {
            let ratio = |cos| lobe.ratio(&kernel, alpha, cos);
            let factors = harmonic::factors_of(kernel.brdf, alpha, degree, ratio);
            Slipped::one(Cause::Lobe(*lobe), self.convolved(&factors))
        };
        lobes.iter().map(slipped).collect()
    }

    /// The level as filtered from the level before it by its whole width, and that one likewise.
    fn added_blurs(&self) -> Option<Slipped> {
        let Level {
            truth,
            kernel,
            alpha,
            alphas_before,
            ..
        } = *self.level;
        let degree = truth.harmonics.degree();
        let mut before = alphas_before
            .iter()
            .filter(|alpha| has_width(**alpha))
            .peekable();
        before.peek()?;
        let mut factors = truth.factors(kernel, alpha, degree);
        for alpha in before {
            let blur = truth.factors(kernel, *alpha, degree);
            factors = factors.into_iter().zip(blur).map(|(a, b)| a * b).collect();
        }
        Some(Slipped::one(Cause::BlursAddUp, self.convolved(&factors)))
    }

    fn convolved(&self, factors: &[f64]) -> Vec<DVec3> {
        let map = self.level.truth.harmonics.convolved(factors);
        let world = self.directions.world.iter();
        world.map(|world| map.value(*world)).collect()
    }

    /// Texels that are taken to lie elsewhere in their face.
    pub fn grids(&self) -> Vec<Slipped> {
        if self.directions.size.contains(&1) {
            return Vec::new();
        }
        let grids = TexelGrid::CORNERS
            .into_iter()
            .chain([TexelGrid::EdgeToEdge]);
        grids
            .map(|grid| {
                let values = self.right(&self.directions.on(grid), DQuat::IDENTITY);
                Slipped::one(Cause::Grid(grid), values)
            })
            .collect()
    }

    /// Levels of other sources.
    pub fn of_sources(&self, sources: &[Lit]) -> Vec<Slipped> {
        let slipped = |source: &Lit| {
            let mut values = self.right_by(&source.truth, self.level.kernel);
            if let Some(divisor) = &source.divisor {
                let divisors = self.right_by(divisor, self.level.kernel);
                for (value, divisor) in values.iter_mut().zip(divisors) {
                    *value /= divisor;
                }
            }
            Slipped::one(Cause::Source(source.slip), values)
        };
        sources.iter().map(slipped).collect()
    }

    /// Levels of the likeliest other source by other kernels. Each further source takes a second.
    pub fn likeliest_source_by_others(&self) -> Vec<Slipped> {
        self.level
            .lights
            .changed
            .first()
            .map_or(Vec::new(), |source| {
                self.by_others(&source.truth, Some(&Cause::Source(source.slip)))
            })
    }

    /// Turns that are not quarters; about y, the offset of a lat-long map.
    pub fn turns(&self) -> Vec<Slipped> {
        TurnAxis::ALL
            .into_iter()
            .filter_map(|axis| self.turn(axis))
            .collect()
    }

    fn turn(&self, axis: TurnAxis) -> Option<Slipped> {
        let turned = |degrees: f64| {
            let turn = DQuat::from_axis_angle(axis.vector(), degrees.to_radians());
            self.right(&self.directions, turn)
        };
        let error = |degrees: f64| {
            let values = turned(degrees);
            let gain = self.gain(&values);
            let gained: Vec<DVec3> = values.iter().map(|value| gain * *value).collect();
            self.relmse(&gained)
        };
        let steps = if axis == TurnAxis::Y {
            TURN_STEPS_Y
        } else {
            TURN_STEPS_XZ
        };
        let degrees = least_turn(steps, error);
        let cause = Cause::Turn(Turn { axis, degrees });
        (degrees.abs() >= TURN_MIN).then(|| Slipped::one(cause, turned(degrees)))
    }

    /// Sums texels and channels by solid angle.
    pub fn sum(&self, texels: &[DVec3]) -> f64 {
        texels
            .iter()
            .zip(&self.directions.weights)
            .map(|(texel, weight)| weight * texel.element_sum())
            .sum()
    }

    /// Returns the gain of least error of the level over these values.
    pub fn gain(&self, values: &[DVec3]) -> f64 {
        let epsilon = self.level.truth.epsilon();
        fit::gain(&self.directions, &self.found, values, epsilon)
    }
}
