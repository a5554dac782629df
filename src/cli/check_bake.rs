//! `splitsum check-bake`: how wrong a bake is.

use super::shared::{InputFlags, preset};
use super::{Failure, print, print_data, progress};
use clap::Args;
use splitsum::bake::Stated;
use splitsum::bake::convention::{Axes, PRESETS, Preset, TableAxes, TableChannels};
use splitsum::bake::judge::{GOOD, Judged, Judging, Limits, as_json};
use splitsum::bake::source::{Reading, read};
use splitsum::base::names::Listed;
use splitsum::draw::markdown::{Align, MarkdownTable};
use splitsum::instrument::brdf::{Brdf, MaskingShadowing};
use splitsum::instrument::environment::layout::MapLayout;
use splitsum::instrument::precompute::prefilter::{LevelMapping, Weight};

/// Score tables baked by any tool against exact integrals, level by level.
#[derive(Args, Debug)]
#[command(
    allow_negative_numbers = true,
    after_help = "FILES belong to one bake: .ktx2, .ktx or .dds cubes, a folder of faces \
                  (m0_px.exr, m0_nx.exr, ...), lat-long .exr or .hdr \
    levels in order, a folder of `splitsum bake`, a square .png, .exr, .dds or .ktx2 DFG table, \
    and SH as .txt or .json. Name ambiguous files: \
    irradiance=FILE, specular=FILE, dfg=FILE, sh=FILE.\n\n\
    A good level is within 3 % rms (relmse 0.001). For a larger error the verdict names the slip \
    that explains it: a width, a gain, other axes, \
    swapped or turned faces, channels, an encoding, a cut, another weight, missing levels. Level \
    0, the mirror, is compared with the environment \
    averaged over each texel.\n\n\
    Exit codes: 0 if every limit holds, 1 if a --fail limit is exceeded, 2 for wrong input.\n\n\
    Examples:\n  splitsum check-bake studio_ibl.ktx studio_sh.txt --environment studio.hdr \
    --preset cmgen\n  \
    splitsum check-bake specular.ktx2 lut_ggx.png --environment studio.hdr --preset khronos\n  \
    splitsum check-bake baked --environment studio.hdr --json --fail-on-wrong"
)]
pub struct Arguments {
    /// Check the files and folders of one bake.
    #[arg(required = true, value_name = "FILES")]
    files: Vec<String>,
    /// Compare with the baked map: builtin:NAME, .hdr or .exr; not for a DFG table.
    #[arg(long, value_name = "MAP")]
    environment: Option<String>,
    /// Use the conventions of a tool, or of a FILE.toml; the flags below override them.
    #[arg(long, value_name = "NAME", long_help = presets_help(), value_parser = preset)]
    preset: Option<&'static Preset>,
    /// Set the file's axes for the world's x, y and z, such as -x+y+z (y is up).
    #[arg(long, value_parser = Axes::parse, allow_hyphen_values = true)]
    axes: Option<Axes>,
    /// Set the roughness of each level (`splitsum list level-mappings`).
    #[arg(long, value_name = "NAME", value_parser = LevelMapping::parse)]
    level_mapping: Option<&'static LevelMapping>,
    /// Set the width alpha of each level, such as 0,0.0625,0.25,1.
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = alpha)]
    alphas: Option<Vec<f64>>,
    /// Set the radiance of a texel of 1.
    #[arg(long, value_name = "X", value_parser = positive)]
    scale: Option<f64>,
    /// Set irradiance/pi of a texel of 1: 0.31831 if the map holds irradiance.
    #[arg(long, value_name = "X", value_parser = positive)]
    irradiance_scale: Option<f64>,
    /// Set the table's directions: n·v (n) and roughness (r), as in n+r+ or r-n+.
    #[arg(long, value_name = "NAME", value_parser = TableAxes::parse)]
    table_axes: Option<&'static TableAxes>,
    /// Set the table's channels: scale-bias, bias-scale or bias-albedo.
    #[arg(long, value_name = "NAME", value_parser = TableChannels::parse)]
    table_channels: Option<&'static TableChannels>,
    /// Set the DFG table's masking-shadowing.
    #[arg(long, value_name = "NAME", value_parser = MaskingShadowing::parse)]
    masking: Option<&'static MaskingShadowing>,
    /// Set the map's weight (`splitsum list prefilter-weights`).
    #[arg(long, value_name = "NAME", value_parser = Weight::parse)]
    weight: Option<&'static Weight>,
    /// Set the baked model.
    #[arg(long, value_name = "NAME", default_value = "ggx", value_parser = <dyn Brdf>::parse)]
    brdf: &'static dyn Brdf,
    /// Set the layout of images that are neither lat-long nor six faces in a column.
    #[arg(long, value_name = "NAME", value_parser = MapLayout::parse)]
    layout: Option<&'static MapLayout>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    limits: Limits,
    #[command(flatten)]
    inputs: InputFlags,
}

fn presets_help() -> String {
    let lines: Vec<String> = PRESETS
        .iter()
        .map(|preset| format!("  {}: {}", preset.name, preset.about))
        .collect();
    let default = format!("[default: {} unless the files state one]", PRESETS[0].name);
    format!(
        "Use the conventions of a tool, or of a FILE.toml (docs/bakes.md) {default}:\n{}",
        lines.join("\n")
    )
}

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    progress::phase("reading the bake");
    let reading = Reading {
        layout: arguments.layout,
        brdf: arguments.brdf.name(),
    };
    let bake = read(&arguments.files, reading).map_err(Failure::input)?;
    let has_map = bake.specular.is_some() || bake.irradiance.is_some() || bake.sh.is_some();
    check_limits(
        &arguments.limits,
        [has_map, bake.specular.is_some(), bake.dfg.is_some()],
    )?;
    // The light does not reach a DFG table.
    let light = match &arguments.environment {
        Some(light) => light,
        None if has_map => {
            return Err(Failure::input(
                "--environment: maps and SH need the map that they were baked from",
            ));
        }
        None => "builtin:constant",
    };
    let stated = &bake.stated;
    let own = || {
        stated
            .preset
            .as_deref()
            .map_or(Ok(&PRESETS[0]), Preset::parse)
    };
    let unknown = |fault| {
        Failure::input(format!(
            "bake.json: {fault}; give your own as --preset FILE.toml"
        ))
    };
    let preset = arguments.preset.map_or_else(own, Ok).map_err(unknown)?;
    let judging = judging(arguments, preset, stated)?;
    let environment = arguments.inputs.environment(light)?;
    let judged = judging
        .judge(&environment, &bake, progress::phase)
        .map_err(Failure::input)?;
    if arguments.json {
        let scores = as_json(light, preset.name, &arguments.limits, &judged);
        print_data(&(serde_json::to_string_pretty(&scores).map_err(Failure::failed)? + "\n"))?;
    } else {
        print(&as_text(&judged))?;
    }
    let failures = arguments.limits.failures(&judged);
    if failures.is_empty() {
        Ok(())
    } else {
        Err(Failure::failed(wrapped(&failures.join("\n"))))
    }
}

/// Refuses limits of which none applies to a part of the bake.
fn check_limits(limits: &Limits, has: [bool; 3]) -> Result<(), Failure> {
    let asked = [
        limits.fail_above,
        limits.fail_between_above,
        limits.fail_table_above,
    ]
    .map(|limit| limit.is_some());
    if asked.contains(&true) && asked.iter().zip(has).all(|(asked, has)| !(*asked && has)) {
        return Err(Failure::input(
            "nothing to judge: --fail-above is for maps and SH, --fail-between-above for levels, \
             --fail-table-above for a DFG table",
        ));
    }
    Ok(())
}

/// Applies the preset, the files' statements and the flags, in this order.
fn judging(
    arguments: &Arguments,
    preset: &'static Preset,
    stated: &Stated,
) -> Result<Judging, Failure> {
    let mut convention = Judging::by(preset, stated)
        .map_err(Failure::input)?
        .convention;
    if let Some(mapping) = arguments.level_mapping {
        (convention.mapping, convention.alphas) = (mapping, None);
    }
    convention.alphas = arguments.alphas.clone().or(convention.alphas);
    convention.masking = arguments.masking.copied().unwrap_or(convention.masking);
    convention.table_axes = arguments.table_axes.unwrap_or(convention.table_axes);
    convention.table_channels = arguments
        .table_channels
        .unwrap_or(convention.table_channels);
    convention.weight = arguments.weight.unwrap_or(convention.weight);
    convention.axes = arguments.axes.unwrap_or(convention.axes);
    convention.scale = arguments.scale.unwrap_or(convention.scale);
    convention.irradiance_scale = arguments
        .irradiance_scale
        .unwrap_or(convention.irradiance_scale);
    Ok(Judging {
        brdf: arguments.brdf,
        convention,
    })
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text
        .parse::<f64>()
        .ok()
        .filter(|x| x.is_finite() && *x > 0.0);
    number.ok_or_else(|| format!("{text} is not a finite number above 0"))
}

fn alpha(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|x| (0.0..=1.0).contains(x));
    number.ok_or_else(|| format!("{text} is outside [0, 1]"))
}

fn as_text(judged: &Judged) -> String {
    let mut text = String::new();
    for (what, fits) in &judged.axes {
        if let Some(doubt) = judged.doubt(what, fits) {
            super::log(&wrapped(&format!(
                "warning: {what}: {}{}",
                doubt.words, doubt.more
            )));
        }
    }
    let levels = judged
        .levels
        .iter()
        .enumerate()
        .map(|(k, score)| (k.to_string(), score));
    let maps: Vec<_> = levels
        .chain(
            judged
                .irradiance
                .iter()
                .map(|score| ("irradiance".to_owned(), score)),
        )
        .collect();
    if !maps.is_empty() {
        let columns =
            ["size", "alpha", "rms %", "between texels", "bias %"].map(|name| (name, Align::Right));
        let mut table = MarkdownTable::new(&[&[("level", Align::Left)], &columns[..]].concat());
        let rms = |relmse: f64| format!("{:.2}", 100.0 * relmse.sqrt());
        for (name, score) in &maps {
            table.row(&[
                name.clone(),
                format!("{}x{}", score.size[0], score.size[1]),
                format!("{:.4}", score.alpha),
                rms(score.errors.relmse),
                score.between.map_or_else(String::new, rms),
                format!("{:+.2}", 100.0 * score.errors.bias_rel),
            ]);
        }
        text += &format!("{table}");
    }
    let worst = maps
        .iter()
        .max_by(|(_, a), (_, b)| a.errors.relmse.total_cmp(&b.errors.relmse));
    if let Some((name, score)) = worst.filter(|(_, score)| score.errors.relmse > GOOD) {
        let worst = &score.worst;
        let ([x, y, z], [face, column, row]) = (worst.direction.to_array(), worst.texel);
        let [found, exact] = [worst.found, worst.exact].map(|rgb| rgb.element_sum() / 3.0);
        text += &format!(
            "Worst direction, level {name}: ({x:.2}, {y:.2}, {z:.2}), face {face}, texel \
             {column},{row}: \
             {found:.3}, exact {exact:.3}\n"
        );
    }
    if let Some(dfg) = &judged.dfg {
        text += &format!(
            "DFG table: max error {:.2e}, rms {:.1e}, worst at n·v {:.3}, roughness {:.3}\n",
            dfg.max_error, dfg.rms, dfg.worst.x, dfg.worst.y
        );
    }
    if let Some(sh) = &judged.sh {
        let [rms, bias] = [sh.errors.relmse.sqrt(), sh.errors.bias_rel].map(|x| 100.0 * x);
        text += &format!("SH: {rms:.2} % rms in irradiance, bias {bias:+.2} %\n");
    }
    for (name, verdict) in judged.parts() {
        text += &format!("{name}: {verdict}\n");
    }
    wrapped(&text) + &shortened(&format!("Verdict: {}", judged.verdict())) + "\n"
}

const WIDTH: usize = 100;

fn wrapped(text: &str) -> String {
    let (mut broken, mut column) = (String::new(), 0);
    for word in text.split_inclusive([' ', '\n']) {
        if column > 0 && column + word.trim_end().chars().count() > WIDTH {
            (broken, column) = (broken.trim_end().to_owned() + "\n    ", 4);
        }
        broken += word;
        column = if word.ends_with('\n') {
            0
        } else {
            column + word.chars().count()
        };
    }
    broken
}

/// Leaves out the last clauses of a verdict until it fits a line, first what is left if the causes
/// are fixed.
fn shortened(verdict: &str) -> String {
    let clauses: Vec<&str> = verdict.split("; ").collect();
    let is_cause = |clause: &&str| !clause.ends_with("if fixed");
    let more = |count: usize| {
        if clauses[count..].iter().any(is_cause) {
            "; ..."
        } else {
            ""
        }
    };
    let kept = |count: usize| clauses[..count].join("; ") + more(count);
    let narrow = (1..=clauses.len())
        .rev()
        .map(kept)
        .find(|line| line.chars().count() <= WIDTH);
    // The flag of a long list is in a line above.
    let cause = clauses[0]
        .rsplit_once(": ")
        .map_or(clauses[0], |(cause, _)| cause);
    narrow.unwrap_or_else(|| cause.to_owned() + "; ...")
}
