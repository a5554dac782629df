//! `splitsum compare`: every metric on two files.

use super::{Failure, log, print, print_data};
use clap::Args;
use serde_json::{Value, json};
use splitsum::base::names::Listed;
use splitsum::base::pixels::{Decoded, GrayImage, exr};
use splitsum::draw::markdown::{Align, MarkdownTable, significant};
use splitsum::experiment::axis::{AXES, AxisId, CONTRAST, EXPOSURE};
use splitsum::experiment::value::{Kind, Range};
use splitsum::instrument::metrics::{Comparison, Epsilon, METRICS};
use splitsum::instrument::tonemap::ToneCurve;
use std::path::{Path, PathBuf};

/// Score a linear EXR image against a reference.
#[derive(Args, Debug)]
#[command(
    allow_negative_numbers = true,
    after_help = "Example:\n  splitsum render --method split-sum --out ball.exr\n  \
    splitsum render --method reference --out reference.exr\n  splitsum compare ball.exr \
    reference.exr --json"
)]
pub struct Arguments {
    /// Score this image.
    test: PathBuf,
    /// Compare with this image.
    reference: PathBuf,
    /// Count pixels where this image is 1 [default: the reference's alpha, else all].
    #[arg(long, value_name = "MASK.exr")]
    mask: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
    /// Set the factor before the tone curve, for display metrics.
    #[arg(
        long,
        value_name = "E",
        default_value = "1",
        value_parser = |text: &str| number(EXPOSURE, text),
    )]
    exposure: f64,
    /// Set the exponent of the tone curve times 2.2, for display metrics.
    #[arg(
        long,
        value_name = "C",
        default_value = "1",
        value_parser = |text: &str| number(CONTRAST, text),
    )]
    contrast: f64,
    /// Set the light's mean luminance m; relative metrics add 0.01 m^2 to r^2.
    #[arg(long, value_name = "M", default_value = "1", value_parser = mean)]
    environment_mean: f64,
}

fn mean(text: &str) -> Result<f64, String> {
    Kind::Number(Range::above(0.0, 1e30))
        .parse_text(text)
        .map(|value| value.number())
}

fn number(axis: AxisId, text: &str) -> Result<f64, String> {
    AXES[axis].kind.parse_text(text).map(|value| value.number())
}

/// Most pixels of a comparison (3840 x 2160): FLIP needs up to 180 bytes per pixel.
const COMPARED_PIXELS_MAX: u64 = 1 << 23;

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let test = read(&arguments.test)?;
    let [width, height] = [test.rgb.width, test.rgb.height];
    if u64::from(width) * u64::from(height) > COMPARED_PIXELS_MAX {
        return Err(Failure::input(format!(
            "{}: {width}x{height} pixels need {} MiB of memory; expected at most \
             {COMPARED_PIXELS_MAX} pixels, such as 3840x2160",
            arguments.test.display(),
            (u64::from(width) * u64::from(height) * 180) >> 20
        )));
    }
    let reference = read(&arguments.reference)?;
    let Mask {
        image: mask,
        source,
    } = mask(arguments, &reference)?;
    let curve = ToneCurve {
        exposure: arguments.exposure as f32,
        contrast: arguments.contrast as f32,
    };
    let epsilon = Epsilon::of_light(arguments.environment_mean);
    let comparison =
        Comparison::new(&test.rgb, &reference.rgb, &mask, curve, epsilon).map_err(|error| {
            Failure::input(format!(
                "{} against {}, masked by {source}: {error}",
                arguments.test.display(),
                arguments.reference.display()
            ))
        })?;
    log(&format!(
        "relative metrics: mean luminance {}, epsilon {:e}",
        epsilon.mean(),
        epsilon.squared_epsilon()
    ));
    let scores = comparison.evaluate_all();
    if arguments.json {
        let scores: serde_json::Map<String, Value> = scores
            .iter()
            .map(|(name, score)| ((*name).to_owned(), json_number(*score)))
            .collect();
        return print_data(&format!("{:#}\n", Value::Object(scores)));
    }
    let mut table = MarkdownTable::new(&[
        ("metric", Align::Left),
        ("value", Align::Right),
        ("better", Align::Left),
        ("values", Align::Left),
    ]);
    for ((name, value), metric) in scores.iter().zip(METRICS) {
        table.row(&[
            *name,
            &significant(*value, 4),
            metric.better.name(),
            metric.space.name(),
        ]);
    }
    print(&table.to_string())
}

/// The pixels to count.
struct Mask {
    image: GrayImage,
    /// Where it comes from, in words.
    source: String,
}

fn mask(arguments: &Arguments, reference: &Decoded) -> Result<Mask, Failure> {
    if let Some(path) = &arguments.mask {
        return Ok(Mask {
            image: read(path)?.rgb.map(|texel| texel[0]),
            source: format!("--mask {}", path.display()),
        });
    }
    if let Some(alpha) = &reference.alpha {
        return Ok(Mask {
            image: alpha.clone(),
            source: format!("the alpha channel of {}", arguments.reference.display()),
        });
    }
    Ok(Mask {
        image: GrayImage::filled(reference.rgb.width, reference.rgb.height, 1.0),
        source: "all pixels".to_owned(),
    })
}

/// JSON has no infinity: the bias of a black reference is the text "inf".
fn json_number(number: f64) -> Value {
    if number.is_finite() {
        json!(number)
    } else {
        json!(number.to_string())
    }
}

fn read(path: &Path) -> Result<Decoded, Failure> {
    let decoded = exr::read(path).map_err(Failure::input)?;
    for warning in &decoded.warnings {
        super::warn(&path.display().to_string(), warning);
    }
    Ok(decoded)
}
