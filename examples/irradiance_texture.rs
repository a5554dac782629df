//! Writes source document 0's picture of a map beside its irradiance from nine coefficients:
//!
//! ```sh
//! cargo run --release --example irradiance_texture [FILE]     # default: document-irradiance.png
//! ```

use splitsum::base::pixels::{Pixels, Rgb8Image, png};
use splitsum::instrument::environment::{Environment, LoadOptions};
use splitsum::instrument::precompute::exact_quadrature;
use splitsum::instrument::precompute::sh9::TEXTURE_SIZE;
use splitsum::instrument::precompute::sh9::reference::{project_bilinear, texture};
use splitsum::instrument::tonemap::ToneCurve;
use std::error::Error;
use std::path::Path;

/// Columns between both pictures.
const GAP: u32 = 8;

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1);
    let file = file.unwrap_or_else(|| "document-irradiance.png".to_owned());
    let options = LoadOptions::default();
    let environment = Environment::load("builtin:studio", Path::new(""), &options)?;
    let map = &environment.image;
    let irradiance = texture(&project_bilinear(&exact_quadrature(map)));
    let [width, height] = TEXTURE_SIZE;
    let curve = ToneCurve::default();
    let picture: Rgb8Image = Pixels::from_fn(2 * width + GAP, height, |x, y| {
        if x < width {
            curve.apply_rgb8(map.get(x * map.width / width, y * map.height / height))
        } else if x < width + GAP {
            [255; 3]
        } else {
            curve.apply_rgb8(irradiance.get(x - width - GAP, y).as_vec3().to_array())
        }
    });
    png::write_rgb8(Path::new(&file), &picture)?;
    println!("{file}");
    Ok(())
}
