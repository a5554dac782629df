//! `splitsum bake`: precomputed tables as files.

use super::completed::listed;
use super::shared::{InputFlags, preset};
use super::{Failure, print, progress};
use clap::Args;
use splitsum::bake::container::Texel;
use splitsum::bake::convention::Preset;
use splitsum::bake::make::{self, Baked, LastBetween, Making};
use splitsum::bake::plain::{Baking, SETTINGS};
use splitsum::base::names::{Listed, not_listed, not_one_of};
use splitsum::experiment::axis::named::LISTED_AXES;
use splitsum::experiment::axis::{
    AXES, AxisId, BRDF, DFG_SIZE, IRRADIANCE_SIZE, MASKING, PREFILTER_LEVEL_COUNT, PREFILTER_SIZE,
    PREFILTER_WEIGHT, Point, Settings,
};
use splitsum::experiment::value::Value;
use splitsum::instrument::brdf::MODELS;
use splitsum::instrument::environment::Environment;
use std::path::PathBuf;

/// Write the prefiltered map, DFG table, taps, SH9 and irradiance map as files.
#[derive(Args, Debug)]
#[command(
    allow_negative_numbers = true,
    after_help = "bake.json states the mapping, axes and units of every file.\n\n\
    Examples:\n  splitsum bake builtin:sky --out baked\n  \
    splitsum bake studio.hdr --out baked --set prefilter_size=256x256 --set \
    prefilter_level_count=6 --set brdf=ggx\n  \
    splitsum bake studio.hdr --for bevy --out assets/studio"
)]
pub struct Arguments {
    /// Bake builtin:NAME, or an .hdr or .exr file.
    environment: String,
    /// Write the files to DIR.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Set a size, level_mapping, masking, brdf or another axis of tables (`splitsum list axes`).
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = setting)]
    settings: Vec<(AxisId, Value)>,
    #[command(flatten)]
    inputs: InputFlags,
    /// Write an engine's files instead.
    #[arg(long = "for", value_name = "ENGINE", long_help = engines_help(), value_parser = parse_engine)]
    engine: Option<&'static Preset>,
    /// Set the pixel format of --for's cubes: rgba16f, rgba32f, rgb9e5, ...
    #[arg(
        long,
        value_name = "NAME",
        requires = "engine",
        value_parser = listed::<Texel>(),
        hide_possible_values = true,
    )]
    format: Option<&'static Texel>,
    /// Fail if the pixel format cuts or rounds a level so that a warning names it.
    #[arg(long, requires = "engine")]
    fail_on_loss: bool,
}

fn parse_engine(text: &str) -> Result<&'static Preset, String> {
    let engines: Vec<&str> = Preset::engines()
        .map(|preset| preset.product().engine)
        .collect();
    let is_file = text.ends_with(".toml");
    let found = if is_file {
        Some(preset(text)?)
    } else {
        Preset::by_name(text)
    };
    found.filter(|preset| preset.has_product()).ok_or_else(|| {
        if is_file {
            "it has no [product]".to_owned()
        } else {
            not_one_of("engine", text, &engines, "")
        }
    })
}

fn engines_help() -> String {
    let line =
        |preset: &Preset| format!("  {}: {}", preset.product().engine, preset.product().about);
    let lines: Vec<String> = Preset::engines().map(line).collect();
    format!("Write an engine's files instead:\n{}", lines.join("\n"))
}

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    progress::phase("reading the map");
    let environment = arguments.inputs.environment(&arguments.environment)?;
    let mut point = Point::default();
    for (index, (axis, value)) in arguments.settings.iter().enumerate() {
        if arguments.settings[..index]
            .iter()
            .any(|(earlier, _)| earlier == axis)
        {
            return Err(Failure::input(format!(
                "--set {}: is set twice; expected one value",
                AXES[*axis].name
            )));
        }
        point[*axis] = value.clone();
    }
    let has_model = arguments.settings.iter().any(|(axis, _)| *axis == BRDF);
    let settings = point.settings();
    if let Some(preset) = arguments.engine {
        return execute_for(preset, arguments, &environment, &settings);
    }
    let baking = Baking {
        environment: &environment,
        settings: settings.shading.precompute,
        brdfs: if has_model {
            &[settings.shading.brdf]
        } else {
            MODELS
        },
        masking: settings.shading.masking_shadowing,
    };
    baking.check().map_err(Failure::input)?;
    progress::phase("baking");
    for path in baking.bake(&arguments.out).map_err(Failure::input)? {
        print(&format!("{}\n", path.display()))?;
    }
    Ok(())
}

/// Axes that `--for` leaves to the user.
const ENGINE_AXES: [AxisId; 7] = [
    BRDF,
    MASKING,
    PREFILTER_WEIGHT,
    PREFILTER_SIZE,
    PREFILTER_LEVEL_COUNT,
    IRRADIANCE_SIZE,
    DFG_SIZE,
];

fn execute_for(
    preset: &'static Preset,
    arguments: &Arguments,
    environment: &Environment,
    settings: &Settings,
) -> Result<(), Failure> {
    check_axes(preset, arguments)?;
    let making = making(preset, arguments, environment, settings)?;
    making.check().map_err(Failure::input)?;
    progress::phase("baking");
    let baked = make::make(&making, &arguments.out).map_err(Failure::input)?;
    report(&baked)?;
    let lossy: Vec<String> = baked
        .levels
        .iter()
        .filter_map(|level| Some(format!("{}: {}", level.part, level.loss?)))
        .collect();
    if arguments.fail_on_loss && !lossy.is_empty() {
        return Err(Failure::failed(lossy.join("\n")));
    }
    Ok(())
}

/// Refuses axes that the engine determines.
fn check_axes(preset: &Preset, arguments: &Arguments) -> Result<(), Failure> {
    for (axis, _) in &arguments.settings {
        if !ENGINE_AXES.contains(axis) {
            let expected = ENGINE_AXES.map(|axis| AXES[axis].name).join(", ");
            return Err(Failure::input(format!(
                "--set {}: --for {} determines it; expected {expected}",
                AXES[*axis].name,
                preset.product().engine
            )));
        }
    }
    Ok(())
}

/// Applies the flags to an engine's defaults.
fn making<'e>(
    preset: &'static Preset,
    arguments: &Arguments,
    environment: &'e Environment,
    settings: &Settings,
) -> Result<Making<'e>, Failure> {
    let value = |axis: AxisId| {
        let mut set = arguments.settings.iter();
        set.find(|(known, _)| *known == axis)
            .map(|(_, value)| value)
    };
    let square = |axis: AxisId, default: u32| match value(axis).map(Value::pair) {
        None => Ok(default),
        Some([width, height]) if width == height => Ok(width),
        Some([width, height]) => Err(Failure::input(format!(
            "--set {}={width}x{height}: faces are square",
            AXES[axis].name
        ))),
    };
    let side = square(PREFILTER_SIZE, preset.side())?;
    let mut making = Making::new(preset, environment, side);
    making.brdf = settings.shading.brdf;
    if value(MASKING).is_some() {
        making.masking = settings.shading.masking_shadowing;
    }
    if value(PREFILTER_WEIGHT).is_some() {
        making.weight = settings.shading.precompute.prefilter_weight;
    }
    making.texel = arguments.format.unwrap_or(making.texel);
    making.irradiance_side = square(IRRADIANCE_SIZE, making.irradiance_side)?;
    making.table_side = value(DFG_SIZE).map_or(making.table_side, Value::count);
    making.level_count = value(PREFILTER_LEVEL_COUNT).map_or(making.level_count, Value::count);
    Ok(making)
}

/// Smallest bias of a level that the summary mentions.
const BIAS_MENTIONED: f64 = 1e-3;

/// Prints the files and how exact they are.
fn report(baked: &Baked) -> Result<(), Failure> {
    for path in &baked.files {
        print(&format!("{}\n", path.display()))?;
    }
    for level in &baked.levels {
        if let Some(loss) = &level.loss {
            super::warn(&level.part.to_string(), &loss.to_string());
        }
    }
    let LastBetween {
        relmse: between,
        advice,
    } = &baked.last_between;
    if let Some(advice) = advice {
        super::warn(
            "last level",
            &format!("relmse {between:.1e} between its texels: {advice}"),
        );
    }
    let worst = baked
        .levels
        .iter()
        .map(|level| level.relmse)
        .fold(0.0, f64::max);
    let bias = baked
        .levels
        .iter()
        .map(|level| level.bias_rel.abs())
        .fold(0.0, f64::max);
    let light = if bias > BIAS_MENTIONED {
        format!(" and {:.2} % of its light", 100.0 * bias)
    } else {
        String::new()
    };
    let table = match baked.table_error {
        None => String::new(),
        Some(0.0) => ", the table is exact".to_owned(),
        Some(error) => format!(", the table is within {error:.0e}"),
    };
    print(&format!(
        "As written, every level is within relmse {worst:.1e}{light} of its integral; lookups \
         between the texels of the last level are within {between:.1e}{table}.\n"
    ))
}

/// Parses `name=value` of an axis that changes the tables.
fn setting(text: &str) -> Result<(AxisId, Value), String> {
    let (name, value) = text
        .split_once('=')
        .ok_or_else(|| format!("{text:?} is not NAME=VALUE"))?;
    let axis = AxisId::find(name);
    let axis =
        axis.ok_or_else(|| not_listed("setting of a bake", name, SETTINGS, "", Some(LISTED_AXES)))?;
    if !SETTINGS.contains(&name) {
        return Err(format!("{name} does not change a bake; leave it out"));
    }
    Ok((axis, AXES[axis].kind.parse_text(value)?))
}
