//! The orientation of an environment in the world.

use crate::base::math::sequence::R3;
use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::TAU;

/// The rotations of an environment, in the order in which they are applied.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Placement {
    /// Rotates the map: 0 keeps the file's orientation, k > 0 is [`orientation`] k.
    pub orientation: u32,
    /// Then rotates it in the world about +y, counter-clockwise seen from above, degrees.
    pub rotation_deg: f64,
}

impl Placement {
    pub const ORIENTATION_MAX: u32 = 4095;

    /// Returns the rotation from world directions to the map's frame.
    pub fn environment_from_world(self) -> DMat3 {
        (DMat3::from_rotation_y(self.rotation_deg.to_radians()) * orientation(self.orientation))
            .transpose()
    }
}

/// Returns rotation k of a fixed set that fills SO(3) evenly, in whole or in part: point k of R3
/// \[Roberts18\] as a uniform quaternion \[Shoemake92\]. 0 is the identity.
pub fn orientation(k: u32) -> DMat3 {
    if k == 0 {
        return DMat3::IDENTITY;
    }
    let u = (DVec3::splat(0.5) + f64::from(k) * R3).fract();
    let [(sin_1, cos_1), (sin_2, cos_2)] = [u.y, u.z].map(|turns| (TAU * turns).sin_cos());
    let [r_1, r_2] = [(1.0 - u.x).sqrt(), u.x.sqrt()];
    DMat3::from_quat(
        DQuat::from_xyzw(r_1 * sin_1, r_1 * cos_1, r_2 * sin_2, r_2 * cos_2).normalize(),
    )
}
