//! `splitsum check-bake`: how wrong a bake is.

use super::completed::listed;
use super::shared::{InputFlags, preset};
use super::{Failure, print, print_data, progress};
use clap::Args;
use splitsum::bake::convention::{ALPHA_MAX, Axes, PRESETS, Preset, TableAxes, TableChannels};
use splitsum::bake::judge::level::LevelScore;
use splitsum::bake::judge::{Clause, GOOD, Judged, Judging, Limits, Part, as_json, joined};
use splitsum::bake::source::{Reading, read};
use splitsum::bake::{Bake, Stated};
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
    #[arg(
        long,
        value_name = "NAME",
        value_parser = listed::<LevelMapping>(),
        hide_possible_values = true,
    )]
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
    #[arg(
        long,
        value_name = "NAME",
        value_parser = listed::<TableChannels>(),
        hide_possible_values = true,
    )]
    table_channels: Option<&'static TableChannels>,
    /// Set the DFG table's masking-shadowing.
    #[arg(
        long,
        value_name = "NAME",
        value_parser = listed::<MaskingShadowing>(),
        hide_possible_values = true,
    )]
    masking: Option<&'static MaskingShadowing>,
    /// Set the map's weight (`splitsum list prefilter-weights`).
    #[arg(
        long,
        value_name = "NAME",
        value_parser = listed::<Weight>(),
        hide_possible_values = true,
    )]
    weight: Option<&'static Weight>,
    /// Set the baked model.
    #[arg(
        long,
        value_name = "NAME",
        default_value = "ggx",
        value_parser = listed::<dyn Brdf>(),
        hide_possible_values = true,
    )]
    brdf: &'static dyn Brdf,
    /// Set the layout of images that are neither lat-long nor six faces in a column.
    #[arg(
        long,
        value_name = "NAME",
        value_parser = listed::<MapLayout>(),
        hide_possible_values = true,
    )]
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
        byte_color: arguments
            .preset
            .and_then(|preset| preset.convention().byte_color),
    };
    let bake = read(&arguments.files, reading).map_err(Failure::input)?;
    for warning in &bake.warnings {
        let name = warning.path.display().to_string();
        super::warn(&name, &super::with_guide(&warning.text));
    }
    let has_map = has_map(&bake);
    check_limits(&arguments.limits, &bake)?;
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
    let preset = match arguments.preset {
        Some(preset) => preset,
        None => stated_preset(&bake.stated)?,
    };
    let judging = judging(arguments, preset, &bake.stated)?;
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

fn has_map(bake: &Bake) -> bool {
    bake.specular.is_some() || bake.irradiance.is_some() || bake.sh.is_some()
}

/// Returns the preset that the files state, else the default.
fn stated_preset(stated: &Stated) -> Result<&'static Preset, Failure> {
    let Some(name) = &stated.preset else {
        return Ok(&PRESETS[0]);
    };
    Preset::parse(name).map_err(|fault| {
        Failure::input(format!(
            "bake.json: {fault}; give your own as --preset FILE.toml"
        ))
    })
}

/// Refuses limits of which none applies to a part of the bake.
fn check_limits(limits: &Limits, bake: &Bake) -> Result<(), Failure> {
    let limits_and_parts = [
        (limits.fail_above.is_some(), has_map(bake)),
        (limits.fail_between_above.is_some(), bake.specular.is_some()),
        (limits.fail_table_above.is_some(), bake.dfg.is_some()),
    ];
    let has_limit = limits_and_parts.iter().any(|(is_set, _)| *is_set);
    let applies = limits_and_parts
        .iter()
        .any(|(is_set, has_part)| *is_set && *has_part);
    if has_limit && !applies {
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
        convention.mapping = mapping;
        convention.alphas = None;
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
    let widths = 0.0..=ALPHA_MAX;
    let number = text.parse::<f64>().ok().filter(|x| widths.contains(x));
    number.ok_or_else(|| format!("{text} is outside [0, {ALPHA_MAX}]"))
}

fn as_text(judged: &Judged) -> String {
    for warning in judged.warnings() {
        let text = format!("warning: {}: {}", warning.map, warning.details());
        super::log(&wrapped(&text));
    }
    let mut text = maps_as_text(judged);
    if let Some(dfg) = &judged.dfg {
        text += &format!(
            "DFG table: max error {:.2e}, rms {:.1e}, worst at n·v {:.3}, roughness {:.3}\n",
            dfg.max_error, dfg.rms, dfg.worst.x, dfg.worst.y
        );
    }
    if let Some(sh) = &judged.sh {
        text += &format!(
            "SH: {:.2} % rms in irradiance, bias {:+.2} %\n",
            100.0 * sh.errors.relmse.sqrt(),
            100.0 * sh.errors.bias_rel
        );
    }
    for part in judged.parts() {
        text += &format!("{part}\n");
    }
    wrapped(&text) + &shortened(judged.verdict_clauses()) + "\n"
}

/// A row of the table of maps.
struct MapRow<'j> {
    name: String,
    score: &'j LevelScore,
}

/// Writes a table of levels and irradiance, and the worst direction if one is not good.
fn maps_as_text(judged: &Judged) -> String {
    let levels = judged
        .levels
        .iter()
        .enumerate()
        .map(|(level, score)| MapRow {
            name: level.to_string(),
            score,
        });
    let irradiance = judged.irradiance.iter().map(|score| MapRow {
        name: Part::Irradiance.to_string(),
        score,
    });
    let rows: Vec<MapRow> = levels.chain(irradiance).collect();
    let worst = rows
        .iter()
        .max_by(|a, b| relmse(a).total_cmp(&relmse(b)))
        .filter(|row| relmse(row) > GOOD);
    let mut text = String::new();
    if !rows.is_empty() {
        text += &table_of_maps(&rows).to_string();
    }
    for MapRow { name, score } in &rows {
        if let Some(texels) = score.negative {
            text += &format!("Level {name}: {texels}\n");
        }
    }
    if let Some(MapRow { name, score }) = worst {
        let worst = &score.worst;
        let [x, y, z] = worst.direction.to_array();
        let [face, column, row] = worst.texel;
        let found = worst.found.element_sum() / 3.0;
        let exact = worst.exact.element_sum() / 3.0;
        text += &format!(
            "Worst direction, level {name}: ({x:.2}, {y:.2}, {z:.2}), face {face}, texel \
             {column},{row}: {found:.3}, exact {exact:.3}\n"
        );
    }
    text
}

fn relmse(row: &MapRow) -> f64 {
    row.score.errors.relmse
}

fn table_of_maps(rows: &[MapRow]) -> MarkdownTable {
    let columns =
        ["size", "alpha", "rms %", "between texels", "bias %"].map(|name| (name, Align::Right));
    let mut table = MarkdownTable::new(&[&[("level", Align::Left)], &columns[..]].concat());
    let rms = |relmse: f64| format!("{:.2}", 100.0 * relmse.sqrt());
    for MapRow { name, score } in rows {
        let [width, height] = score.size;
        table.row(&[
            name.clone(),
            format!("{width}x{height}"),
            format!("{:.4}", score.alpha),
            rms(score.errors.relmse),
            score.between.map_or_else(String::new, rms),
            format!("{:+.2}", 100.0 * score.errors.bias_rel),
        ]);
    }
    table
}

/// Longest printed line, characters.
const WIDTH: usize = 100;

/// Breaks lines at words, and indents what follows.
fn wrapped(text: &str) -> String {
    let mut broken = String::new();
    let mut column = 0;
    for word in text.split_inclusive([' ', '\n']) {
        if column > 0 && column + word.trim_end().chars().count() > WIDTH {
            broken = broken.trim_end().to_owned() + "\n    ";
            column = 4;
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
fn shortened(mut clauses: Vec<Clause>) -> String {
    let first = clauses.remove(0).under("Verdict");
    clauses.insert(0, first.clone());
    for count in (1..=clauses.len()).rev() {
        let (kept, dropped) = clauses.split_at(count);
        let ends_early = dropped.iter().any(|clause| !clause.is_remainder);
        let line = joined(kept) + if ends_early { "; ..." } else { "" };
        if line.chars().count() <= WIDTH {
            return line;
        }
    }
    // A single clause may take several lines; its flag comes last.
    let rest = if clauses.len() > 1 { "; ..." } else { "" };
    wrapped(&format!("{first}{rest}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The flag behind the last ": " of a single long clause.
    #[test]
    fn a_long_first_clause_keeps_its_flag() {
        let flag = format!("--alphas {}", ["0.1234"; 12].join(","));
        let long = Clause::detailed("wrong: each level has the width of the next one", &flag);
        let line = shortened(vec![long, Clause::new("nothing else")]);
        assert!(
            line.replace("\n    ", " ")
                .ends_with(&format!("{flag}; ..."))
        );
        assert!(
            line.lines().all(|line| line.chars().count() <= WIDTH),
            "{line}"
        );
        let short = shortened(vec![Clause::new("good"), Clause::new("x".repeat(WIDTH))]);
        assert_eq!(short, "Verdict: good; ...");
    }
}
