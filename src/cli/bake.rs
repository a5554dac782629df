//! `splitsum bake`: what the precompute passes make, as files.

use super::run::open_device;
use super::{Failure, print};
use clap::Args;
use splitsum::brdf::MODELS;
use splitsum::environment::{Environment, LoadOptions};
use splitsum::pipeline::BakeRequest;
use splitsum::runner::RenderFault;
use splitsum::runner::axis::{AXES, BRDF, Part, Point};
use splitsum::runner::value::Value;
use splitsum::spelling::suggestion;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Writes prefiltered mips and DFG table of each BRDF model (EXR), SH9 (JSON) and irradiance map (EXR).
#[derive(Args, Debug)]
#[command(
    allow_negative_numbers = true,
    after_help = "bake.json names the mapping, the axes and the units of every file.\n\n\
    Examples:\n  splitsum bake builtin:sky --out baked\n  \
    splitsum bake studio.hdr --out baked --set prefilter_size=512x256 --set prefilter_level_count=6 --set brdf=ggx"
)]
pub struct Arguments {
    /// builtin:NAME, or an .hdr or .exr file.
    environment: String,
    /// Folder of the files; it is made when missing.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// A size, sample count or format of the tables, masking=NAME, or brdf=NAME for one model only; `splitsum list axes` names them.
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = setting)]
    settings: Vec<(usize, Value)>,
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
    for (index, (axis, value)) in arguments.settings.iter().enumerate() {
        if arguments.settings[..index].iter().any(|(earlier, _)| earlier == axis) {
            return Err(Failure::input(format!("--set {}: stands twice; expected one value", AXES[*axis].name)));
        }
        point[*axis] = value.clone();
    }
    let has_model = arguments.settings.iter().any(|(axis, _)| *axis == BRDF);
    let settings = point.settings();
    settings.precompute.validate().map_err(|error| Failure::input(format!("--set: {error}")))?;
    let mut pipeline = open_device(arguments.device).map_err(Failure::opening)?;
    std::fs::create_dir_all(&arguments.out)
        .map_err(|error| Failure::input(format!("--out: {} cannot be made: {error}", arguments.out.display())))?;
    let request = BakeRequest {
        environment: Arc::new(environment),
        precompute: settings.precompute,
        brdfs: if has_model { vec![settings.brdf] } else { MODELS.to_vec() },
        masking_shadowing: settings.masking_shadowing,
    };
    let files =
        pipeline.bake(&request, &arguments.out).map_err(|error| Failure::rendering(RenderFault::from(error)))?;
    for path in files {
        print(&format!("{}\n", path.display()))?;
    }
    Ok(())
}

/// `name=value` of an axis that the tables cost by.
fn setting(text: &str) -> Result<(usize, Value), String> {
    let (name, value) = text.split_once('=').ok_or_else(|| format!("{text:?} is not NAME=VALUE"))?;
    let axes = || AXES.iter().enumerate().filter(|(_, axis)| axis.tables_cost && axis.part != Part::Method);
    let found = axes().find(|(_, axis)| axis.name == name).ok_or_else(|| {
        let known: Vec<&str> = axes().map(|(_, axis)| axis.name).collect();
        format!("{name:?} is no setting of the tables{}; they are {}", suggestion(name, &known), known.join(", "))
    })?;
    Ok((found.0, found.1.kind.parse_text(value)?))
}
