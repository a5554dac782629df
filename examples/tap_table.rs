//! Looks up where the split sum should look: direction, level and weight of the taps of a GGX
//! surface.

use splitsum::instrument::brdf::{Ggx, MaskingShadowing};
use splitsum::instrument::precompute::dfg::reference::dfg;
use splitsum::instrument::precompute::prefilter::{Kernel, LEVEL_MAPPINGS};
use splitsum::instrument::precompute::taps::{Chain, TapCount, TapTable, dielectric_share};

fn main() {
    let masking = MaskingShadowing::Correlated;
    let alpha = 0.25;
    let f0 = 0.04;
    let chain = Chain::new(Kernel::cosine(&Ggx), &LEVEL_MAPPINGS[0], 6);
    let table = TapTable::fit(&chain, &Ggx, masking, TapCount::Two);
    for degrees in [10.0_f64, 45.0, 80.0] {
        let n_dot_v = degrees.to_radians().cos();
        let pair = dfg(&Ggx, masking, n_dot_v, alpha);
        let dielectric = dielectric_share(f0, [pair.f0_scale, pair.f90_scale]);
        println!("seen at {degrees} degrees, from the normal (0) to the mirror direction (1):");
        for [position, level, weight] in table.taps(n_dot_v, alpha, dielectric) {
            println!("    look up at {position:.2}, level {level:.2}, with weight {weight:.2}");
        }
    }
}
