//! `splitsum check-shader`: how wrong a function of a shader is.

use super::completed::listed;
use super::flags::coordinates;
use super::shared::DeviceFlag;
use super::{Failure, print, print_data, progress};
use clap::Args;
use serde_json::json;
use splitsum::bake::judge::shader::{ErrorKind, Row, ShaderVerdict, WorstError, check};
use splitsum::base::names::Listed;
use splitsum::draw::markdown::{Align, MarkdownTable};
use splitsum::instrument::brdf::MaskingShadowing;
use splitsum::instrument::shade::{FILE_PREFIX, from_file};
use splitsum::run::RenderFault;
use std::path::{Path, PathBuf};

/// Compare a specular function of a shader with the exact lobe: gain, width, direction.
#[derive(Args, Debug)]
#[command(
    allow_negative_numbers = true,
    after_help = "FILE is GLSL, or WGSL if its name ends in .wgsl \
                  (docs/own-method.md#check-a-function). Errors are medians over 64 views, \
    and the largest. A good function is within 3 % in gain, 10 % in width and 5 degrees in \
    direction: \
    split-sum-two is, the textbook's split sum is not.\n\n\
    Exit codes: 0 if every limit holds, 1 if a --fail limit is exceeded, 2 for wrong input.\n\n\
    Examples:\n  splitsum check-shader my.glsl\n  splitsum check-shader engine.glsl --entry \
    ibl_radiance --masking correlated\n  \
    splitsum check-shader engine.wgsl --entry ibl_radiance --json --fail-above 0.03,0.1,5"
)]
pub struct Arguments {
    /// Check a function of this file.
    file: PathBuf,
    /// Check this function of n, v, perceptual roughness and f0, not `specular_radiance`.
    #[arg(long, value_name = "NAME", default_value = from_file::FUNCTION, value_parser = entry)]
    entry: String,
    /// Set the lobe's masking-shadowing, and the DFG table's.
    #[arg(
        long,
        value_name = "NAME",
        default_value = MaskingShadowing::names()[0],
        value_parser = listed::<MaskingShadowing>(),
        hide_possible_values = true,
    )]
    masking: &'static MaskingShadowing,
    /// Print JSON.
    #[arg(long)]
    json: bool,
    /// Exit 1 if a median error is above its limit (0.03 is 3 %).
    #[arg(long, value_name = "GAIN,WIDTH,DEGREES", value_parser = limits)]
    fail_above: Option<[f32; 3]>,
    /// Exit 1 if the verdict is `wrong`.
    #[arg(long)]
    fail_on_wrong: bool,
    #[command(flatten)]
    device: DeviceFlag,
}

fn entry(text: &str) -> Result<String, String> {
    let is_name = !text.starts_with(|c: char| c.is_ascii_digit())
        && !text.is_empty()
        && text.chars().all(|c| c == '_' || c.is_ascii_alphanumeric());
    is_name
        .then(|| text.to_owned())
        .ok_or_else(|| format!("{text:?} is not the name of a function"))
}

fn limits(text: &str) -> Result<[f32; 3], String> {
    let limits = coordinates(text)
        .ok()
        .filter(|limits: &[f32; 3]| limits.iter().all(|limit| *limit >= 0.0));
    limits.ok_or_else(|| "expected three numbers of at least 0, such as 0.03,0.1,5".to_owned())
}

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let name = format!("{FILE_PREFIX}{}", arguments.file.display());
    let method =
        from_file::load_function(&name, Path::new(""), &arguments.entry).map_err(Failure::input)?;
    progress::doing("rendering");
    let mut pipeline = arguments.device.open().map_err(Failure::opening)?;
    let rows = check(&mut pipeline, method, *arguments.masking);
    let rows = rows.map_err(|error| Failure::rendering(RenderFault::from(error)))?;
    let verdict = ShaderVerdict::new(&rows);
    let failures = failures(arguments, &rows, &verdict);
    if arguments.json {
        let report = json!({
            "verdict": verdict.to_string(),
            "failures": failures,
            "passes": failures.is_empty(),
            "rows": rows,
        });
        print_data(&format!("{report:#}\n"))?;
    } else {
        print(&format!("{}Verdict: {verdict}\n", as_table(&rows)))?;
    }
    if failures.is_empty() {
        Ok(())
    } else {
        Err(Failure::failed(failures.join("\n")))
    }
}

/// Lists the errors above a limit, one a line.
fn failures(arguments: &Arguments, rows: &[Row], verdict: &ShaderVerdict) -> Vec<String> {
    let mut failures = Vec::new();
    if let Some(limits) = arguments.fail_above {
        for (kind, limit) in ErrorKind::ALL.into_iter().zip(limits) {
            let worst = WorstError::new(rows, kind);
            if worst.size > limit.into() {
                let limit = kind.scale() as f32 * limit;
                failures.push(format!(
                    "{} above {limit} {}: {worst}",
                    kind.name(),
                    kind.unit()
                ));
            }
        }
    }
    if arguments.fail_on_wrong && !verdict.is_good() {
        failures.push(verdict.to_string());
    }
    failures
}

fn as_table(rows: &[Row]) -> MarkdownTable {
    let columns = [
        "alpha",
        "f0",
        "gain %",
        "worst",
        "width %",
        "worst",
        "direction, degrees",
        "worst",
    ];
    let mut table = MarkdownTable::new(&columns.map(|name| (name, Align::Right)));
    for row in rows {
        let mut cells = vec![row.alpha.to_string(), row.f0.to_string()];
        for kind in ErrorKind::ALL {
            let median_and_largest = row.ranked(kind);
            cells.extend(median_and_largest.map(|view| {
                let error = kind.scale() * view.errors.get(kind);
                format!("{error:+.1}")
            }));
        }
        table.row(&cells);
    }
    table
}
