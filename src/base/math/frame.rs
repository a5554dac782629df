//! Orthonormal frames about a normal, without branches and without a singular direction \[Duff17\].

use glam::{DQuat, DVec3};

/// Returns the tangent of spheres and queries: east about +y, at the poles +x, turned
/// counter-clockwise about `n` by an angle in radians.
pub fn east(n: DVec3, turn: f64) -> DVec3 {
    let horizontal = DVec3::new(n.z, 0.0, -n.x);
    DQuat::from_axis_angle(n, turn) * horizontal.try_normalize().unwrap_or(DVec3::X)
}

/// A right-handed orthonormal frame; `n` is the local +z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Unit vectors; tangent x bitangent is n.
    pub tangent: DVec3,
    pub bitangent: DVec3,
    pub n: DVec3,
}

impl Frame {
    /// Makes the frame of the unit vector `n` \[Duff17\]. It jumps only where `n.z` changes sign.
    pub fn from_normal(n: DVec3) -> Self {
        let sign = 1f64.copysign(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        Self {
            tangent: DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
            bitangent: DVec3::new(b, sign + n.y * n.y * a, -n.y),
            n,
        }
    }

    /// Makes the frame whose x axis is `tangent`, a unit vector orthogonal to `n`.
    pub fn from_tangent(n: DVec3, tangent: DVec3) -> Self {
        Self {
            tangent,
            bitangent: n.cross(tangent),
            n,
        }
    }

    pub fn to_world(&self, local: DVec3) -> DVec3 {
        self.tangent * local.x + self.bitangent * local.y + self.n * local.z
    }

    pub fn to_local(&self, world: DVec3) -> DVec3 {
        DVec3::new(
            self.tangent.dot(world),
            self.bitangent.dot(world),
            self.n.dot(world),
        )
    }
}
