//! Judges the tables of a bake: `cargo run --example judge_bake -- MAP FILES...`; without
//! arguments, its own bake.

use splitsum::bake::convention::Preset;
use splitsum::bake::judge::Judging;
use splitsum::bake::make::{Making, make};
use splitsum::bake::source::{Reading, read};
use splitsum::base::names::Listed;
use splitsum::instrument::environment::Environment;
use std::{env, error::Error};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = env::args().skip(1);
    let environment = Environment::open(&arguments.next().unwrap_or("builtin:sky".into()))?;
    let mut files: Vec<String> = arguments.collect();
    let folder = tempfile::tempdir()?;
    if files.is_empty() {
        files.push(folder.path().display().to_string());
        make(
            &Making::new(Preset::listed("bevy"), &environment, 32),
            folder.path(),
        )?;
    }
    let bake = read(&files, Reading::default())?;
    let judged = Judging::stated(&bake.stated)?.judge(&environment, &bake, |_| ())?;
    judged
        .levels
        .iter()
        .enumerate()
        .for_each(|(k, level)| println!("level {k}: {}", level.verdict));
    judged
        .dfg
        .iter()
        .for_each(|table| println!("DFG table: {}", table.verdict));
    Ok(())
}
