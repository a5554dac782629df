//! Direct lights: directional, point and spot lights without size and without shadows.
//!
//! A light shows nothing but the irradiance `E` of a surface that faces it, from one direction l.
//! A surface of BRDF f reflects `f(v, l) n·l E` of it:
//!
//! | kind | `color` | `E` at distance d |
//! |---|---|---|
//! | directional | irradiance of a facing surface | `color` |
//! | point | radiant intensity | `color w(d) / d²` |
//! | spot | radiant intensity on the axis | `color w(d) c(θ) / d²` |
//!
//! with the window `w(d) = max(1 - (d / range)⁴, 0)`, 1 without a range, and the falloff `c(θ) =
//! saturate((cos θ - cos outer) / (cos inner - cos outer))²` at the angle θ from the axis: the
//! recommended forms of \[KhrLights18\]. Its code for the falloff has 0.001 as the least difference
//! of the cosines, which dims spots narrower than 2.6 degrees; here their axis keeps its intensity.

use crate::base::names::listed;
use glam::{DMat3, DVec3};
use std::f64::consts::PI;

/// Squared distance below which a point light is not nearer: on the light itself the irradiance
/// would be infinite.
pub const DISTANCE2_MIN: f64 = 1e-12;
const _: () = assert!(DISTANCE2_MIN as f32 == crate::base::glsl::constants::LIGHT_DISTANCE2_MIN);

/// Widest half angle of a spot, radians.
pub const OUTER_MAX: f64 = 0.5 * PI;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightKind {
    Directional,
    Point,
    Spot,
}

listed!(LightKind, "kind of light", {
    "directional": Directional,
    "point": Point,
    "spot": Spot,
});

/// Unit of a light's colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightUnit {
    /// The unit of the environment's radiance, times steradian.
    #[default]
    Absolute,
    /// Multiples of the mean irradiance of the environment, π times its mean luminance over the
    /// sphere, scale included.
    Map,
}

listed!(LightUnit, "light unit", { "absolute": Absolute, "map": Map });

/// Where a light is and where it shines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Emitter {
    Directional {
        /// Unit vector along which the light travels.
        direction: DVec3,
    },
    Point {
        position: DVec3,
    },
    Spot {
        position: DVec3,
        /// Unit vector along the axis, away from the light.
        direction: DVec3,
        cone: Cone,
    },
}

/// Half angles of a spot in radians, `0 <= inner < outer <= π/2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Up to this angle the intensity is whole.
    pub inner: f64,
    /// From this angle on it is 0.
    pub outer: f64,
}

impl Default for Cone {
    /// The defaults of glTF.
    fn default() -> Self {
        Self {
            inner: 0.0,
            outer: 0.25 * PI,
        }
    }
}

impl Cone {
    /// Returns `1 - cos outer` and `1 / (cos inner - cos outer)`. The falloff is `saturate((a - t)
    /// b)²` with `t = 1 - cos θ`, which keeps its digits for narrow cones.
    pub fn falloff_terms(self) -> [f64; 2] {
        let versine = |angle: f64| 2.0 * (0.5 * angle).sin().powi(2);
        let outer = versine(self.outer);
        [outer, 1.0 / (outer - versine(self.inner))]
    }
}

/// A light without size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    pub emitter: Emitter,
    /// Linear RGB: irradiance of a directional light, intensity of the others.
    pub color: [f32; 3],
    pub unit: LightUnit,
    /// Distance at which the light of a point or a spot ends.
    pub range: Option<f64>,
}

/// The light that reaches a position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// Unit vector to the light.
    pub l: DVec3,
    /// Irradiance of a surface that faces the light, linear RGB.
    pub irradiance: DVec3,
}

impl Light {
    /// A directional light of that irradiance, in absolute units. `direction` is the unit vector
    /// along which it travels.
    pub fn directional(direction: DVec3, color: [f32; 3]) -> Self {
        Self {
            emitter: Emitter::Directional { direction },
            color,
            unit: LightUnit::Absolute,
            range: None,
        }
    }

    /// Returns the light that reaches a position; the unit must be absolute.
    pub fn at(&self, place: DVec3) -> Arrival {
        let color = DVec3::from_array(self.color.map(f64::from));
        let position = match self.emitter {
            Emitter::Directional { direction } => {
                return Arrival {
                    l: -direction,
                    irradiance: color,
                };
            }
            Emitter::Point { position } | Emitter::Spot { position, .. } => position,
        };
        let to_light = position - place;
        let distance2 = to_light.length_squared().max(DISTANCE2_MIN);
        let l = to_light / distance2.sqrt();
        let falloff = match self.emitter {
            Emitter::Spot {
                direction, cone, ..
            } => {
                let [outer, scale] = cone.falloff_terms();
                let versine = 0.5 * (direction + l).length_squared();
                ((outer - versine) * scale).clamp(0.0, 1.0).powi(2)
            }
            _ => 1.0,
        };
        let window = self.range.map_or(1.0, |range| {
            (1.0 - (distance2 / (range * range)).powi(2)).clamp(0.0, 1.0)
        });
        Arrival {
            l,
            irradiance: color * (falloff * window / distance2),
        }
    }

    /// Returns numbers that differ between different lights, for hashes.
    pub(super) fn numbers(&self) -> Vec<f64> {
        let Self {
            emitter,
            color,
            unit,
            range,
        } = *self;
        let [position, direction, cone] = match emitter {
            Emitter::Directional { direction } => [DVec3::ZERO, direction, DVec3::ZERO],
            Emitter::Point { position } => [position, DVec3::ZERO, DVec3::X],
            Emitter::Spot {
                position,
                direction,
                cone: Cone { inner, outer },
            } => [position, direction, DVec3::new(2.0, inner, outer)],
        };
        let place = [position, direction, cone].map(|part| part.to_array());
        let rest = [range.unwrap_or(-1.0), f64::from(unit as u8)];
        [&place.concat()[..], &color.map(f64::from), &rest].concat()
    }

    pub fn is_dark(&self) -> bool {
        self.color == [0.0; 3]
    }

    /// Whether it has a position: then it means nothing in the scene `design`.
    pub fn has_position(&self) -> bool {
        !matches!(self.emitter, Emitter::Directional { .. })
    }

    /// Returns the light with its colour scaled, turned about the y axis through the origin,
    /// counter-clockwise from above; `map_irradiance` replaces the unit `map`.
    pub fn changed(&self, change: &LightChange) -> Self {
        let turn = DMat3::from_rotation_y(change.turn_deg.to_radians());
        let unit = match self.unit {
            LightUnit::Absolute => 1.0,
            LightUnit::Map => change.map_irradiance,
        };
        let scale = (unit * change.intensity) as f32;
        // A turn by 0 keeps every bit.
        let emitter = if change.turn_deg == 0.0 {
            self.emitter
        } else {
            self.emitter.turned(turn)
        };
        Self {
            emitter,
            color: self.color.map(|channel| channel * scale),
            unit: LightUnit::Absolute,
            ..*self
        }
    }
}

impl Emitter {
    fn turned(self, turn: DMat3) -> Self {
        match self {
            Self::Directional { direction } => Self::Directional {
                direction: turn * direction,
            },
            Self::Point { position } => Self::Point {
                position: turn * position,
            },
            Self::Spot {
                position,
                direction,
                cone,
            } => Self::Spot {
                position: turn * position,
                direction: turn * direction,
                cone,
            },
        }
    }
}

/// What a setting changes in every light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightChange {
    /// Multiplies the colours.
    pub intensity: f64,
    /// Turns the lights about the y axis.
    pub turn_deg: f64,
    /// Mean irradiance of the environment.
    pub map_irradiance: f64,
}
