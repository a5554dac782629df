//! Integrates one pixel exactly, with error bounds.

use glam::DVec3;
use splitsum::instrument::brdf::{Ggx, MaskingShadowing};
use splitsum::instrument::environment::Environment;
use splitsum::instrument::precompute::exact_quadrature;
use splitsum::instrument::shade::reference::{Surface, TOLERANCE, integrate};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let light = exact_quadrature(&Environment::open("builtin:studio")?.image);
    let n = DVec3::Y;
    let v = DVec3::new(0.6, 0.8, 0.0);
    let f0 = DVec3::splat(0.04);
    let surface = Surface::new(&Ggx, MaskingShadowing::Separable, 0.3, f0, [n, v]);
    let pixel = integrate(&light, &surface, TOLERANCE);
    for (term, radiance) in [("specular", pixel.specular), ("diffuse", pixel.diffuse)] {
        println!(
            "{term}: {:.6} within {:.1e}",
            radiance.value,
            radiance.error.max_element()
        );
    }
    Ok(())
}
