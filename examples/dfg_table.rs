//! Integrates a DFG table of GGX as engines lay it out, looks it up and compares with the integral.

use splitsum::instrument::brdf::{Ggx, MaskingShadowing, alpha_from_perceptual_roughness};
use splitsum::instrument::precompute::dfg::DfgAxes;
use splitsum::instrument::precompute::dfg::reference::{dfg, table};

fn main() {
    let masking = MaskingShadowing::Correlated;
    let axes = DfgAxes::Centres;
    // 32 x 32 texels of (A, B), each within a relative error of 1e-4.
    let table = table(&Ggx, masking, axes, 32, 1e-4);
    for roughness in [0.1, 0.5, 0.9] {
        let n_dot_v = 0.6;
        let alpha = alpha_from_perceptual_roughness(roughness);
        let found = axes.lookup(&table, n_dot_v, alpha);
        let exact = dfg(&Ggx, masking, n_dot_v, alpha);
        println!(
            "roughness {roughness}: A = {:.4} ({:.4} exact), B = {:.4} ({:.4} exact)",
            found.x, exact.f0_scale, found.y, exact.f90_scale
        );
    }
}
