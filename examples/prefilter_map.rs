//! Prefilters a map for an engine and saves it: `cargo run --example prefilter_map -- [MAP]
//! [ENGINE] [FOLDER]`.

use splitsum::bake::convention::Preset;
use splitsum::bake::make::{Making, make};
use splitsum::base::names::Listed;
use splitsum::instrument::environment::Environment;
use std::{env, error::Error, path::Path};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().collect();
    let argument = |index: usize, default| arguments.get(index).map_or(default, String::as_str);
    let environment = Environment::open(argument(1, "builtin:sky"))?;
    let preset = Preset::parse(argument(2, "bevy"))?;
    let making = Making::new(preset, &environment, 64);
    making.check()?;
    let baked = make(&making, Path::new(argument(3, "baked")))?;
    for level in &baked.levels {
        println!(
            "{}: {} texels a side, alpha {:.3}, relMSE {:.1e}",
            level.part, level.side, level.alpha, level.relmse
        );
    }
    baked
        .files
        .iter()
        .for_each(|file| println!("{}", file.display()));
    Ok(())
}
