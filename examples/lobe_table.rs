//! Looks up where the split sum should look: the direction and the width of the lobe of a GGX surface.

use glam::DVec3;
use splitsum::brdf::{Ggx, MaskingShadowing};
use splitsum::precompute::dfg::reference::dfg;
use splitsum::precompute::lobe_shape::{LobeTable, Objective};
use splitsum::precompute::prefilter::Kernel;

fn main() {
    let (masking, alpha, f0) = (MaskingShadowing::Separable, 0.5, 0.04);
    let table = LobeTable::new(Kernel::cosine(&Ggx), masking);
    let n = DVec3::Y;
    for degrees in [10.0_f64, 45.0, 80.0] {
        let v = DVec3::new(degrees.to_radians().sin(), degrees.to_radians().cos(), 0.0);
        // The share of what f0 reflects that has Schlick's weight.
        let pair = dfg(&Ggx, masking, n.dot(v), alpha);
        let share = pair.f90_scale / (f0 * pair.f0_scale + pair.f90_scale);
        let tilt = table.direction([n, v], alpha, share).dot(n).acos().to_degrees();
        let width = table.width(n.dot(v), alpha, share, Objective::Relative);
        println!("seen at {degrees} degrees: look up at {tilt:.1} degrees with alpha {width:.3}");
    }
}
