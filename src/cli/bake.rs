//! `splitsum bake`: what the precompute passes make, as files.

use super::run::open_device;
use super::{Failure, print};
use clap::Args;
use splitsum::brdf::MODELS;
use splitsum::environment::{Environment, LoadOptions};
use splitsum::pipeline::BakeRequest;
use splitsum::runner::RenderFault;
use splitsum::runner::axis::{self, AXES, Point, is_precompute};
use splitsum::runner::value::Value;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Writes prefiltered mips and DFG table of each BRDF model (EXR), SH9 (JSON) and irradiance map (EXR).
#[derive(Args, Debug)]
#[command(
    allow_negative_numbers = true,
    after_help = "bake.json names the mapping, the axes and the units of every file.\n\n\
    Examples:\n  splitsum bake builtin:sky --out baked\n  \
    splitsum bake studio.hdr --out baked --set prefilter_size=512x256 --set prefilter_level_count=6"
)]
pub struct Arguments {
    /// builtin:NAME, or an .hdr or .exr file.
    environment: String,
    /// Folder of the files; it is made when missing.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// A setting of the precompute passes (`splitsum list axes` names them), or masking=NAME.
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = setting)]
    settings: Vec<(&'static str, Value)>,
    /// Sets NaN, infinite and negative texels of the environment to 0, with a warning, instead of refusing them.
    #[arg(long)]
    clamp_invalid: bool,
    /// Index of the device, as `splitsum devices` lists them.
    #[arg(long, value_name = "N")]
    device: Option<usize>,
}

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let options = LoadOptions { clamp_invalid: arguments.clamp_invalid, ..LoadOptions::default() };
    let environment = Environment::load(&arguments.environment, Path::new(""), &options).map_err(Failure::input)?;
    environment.warnings.iter().for_each(|warning| super::warn(&environment.name, warning));
    let mut point = Point::default();
    for (index, (name, value)) in arguments.settings.iter().enumerate() {
        if arguments.settings[..index].iter().any(|(earlier, _)| earlier == name) {
            return Err(Failure::BadInput(format!("--set {name}: stands twice; expected one value")));
        }
        point[axis::index_of(name).expect("the parser found it")] = value.clone();
    }
    let settings = point.settings();
    settings.precompute.validate().map_err(|error| Failure::BadInput(format!("--set: {error}")))?;
    let mut pipeline = open_device(arguments.device).map_err(Failure::opening)?;
    std::fs::create_dir_all(&arguments.out)
        .map_err(|error| Failure::BadInput(format!("--out: {} cannot be made: {error}", arguments.out.display())))?;
    let request = BakeRequest {
        environment: Arc::new(environment),
        precompute: settings.precompute,
        brdfs: MODELS.to_vec(),
        masking_shadowing: settings.masking_shadowing,
    };
    let files =
        pipeline.bake(&request, &arguments.out).map_err(|error| Failure::rendering(RenderFault::from(error)))?;
    for path in files {
        print(&format!("{}\n", path.display()))?;
    }
    Ok(())
}

/// `name=value` of an axis that belongs to the precompute passes.
fn setting(text: &str) -> Result<(&'static str, Value), String> {
    let (name, value) = text.split_once('=').ok_or_else(|| format!("{text:?} is not NAME=VALUE"))?;
    let mut axes = AXES.iter().filter(|axis| is_precompute(axis) || axis.name == "masking");
    let axis = axes.clone().find(|axis| axis.name == name).ok_or_else(|| {
        let known: Vec<&str> = axes.by_ref().map(|axis| axis.name).collect();
        format!("{name:?} is not a setting of the precompute passes; they are {}", known.join(", "))
    })?;
    Ok((axis.name, axis.kind.parse_text(value)?))
}
