//! `splitsum check-shader`: how wrong a function of a shader is.

use super::flags::coordinates;
use super::shared::DeviceFlag;
use super::{Failure, print, print_data, progress};
use clap::Args;
use serde_json::json;
use splitsum::bake::shader_check::{ERRORS, Row, check, verdict, worst};
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
    #[arg(long, value_name = "NAME", default_value = MaskingShadowing::names()[0], value_parser = MaskingShadowing::parse)]
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
    let (verdict, failures) = (verdict(&rows), failures(arguments, &rows));
    if arguments.json {
        let passes = failures.is_empty();
        print_data(&format!(
            "{:#}\n",
            json!({ "verdict": verdict, "failures": failures, "passes": passes, "rows": rows })
        ))?;
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
fn failures(arguments: &Arguments, rows: &[Row]) -> Vec<String> {
    let limits = arguments.fail_above.into_iter().flatten().enumerate();
    let above = limits.filter_map(|(error, limit)| {
        let (size, words) = worst(rows, error);
        let (name, _, unit, scale) = ERRORS[error];
        (size > limit.into())
            .then(|| format!("{name} above {} {unit}: {words}", scale as f32 * limit))
    });
    let wrong =
        Some(verdict(rows)).filter(|words| arguments.fail_on_wrong && words.starts_with("wrong"));
    above.chain(wrong).collect()
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
        let scales = ERRORS.iter().map(|own| own.3).enumerate();
        let errors = scales
            .flat_map(|(error, scale)| row.ranked(error).map(|view| scale * view.errors[error]));
        let surface = [row.alpha, row.f0].map(|x| x.to_string());
        table.row(
            &surface
                .into_iter()
                .chain(errors.map(|error| format!("{error:+.1}")))
                .collect::<Vec<_>>(),
        );
    }
    table
}
