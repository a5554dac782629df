//! `splitsum compare`: every metric on two files.

use super::{Failure, print, print_data, tell};
use clap::Args;
use serde::{Serialize, Serializer};
use splitsum::experiment::axis::{AXES, CONTRAST, EXPOSURE};
use splitsum::experiment::value::{Kind, Range};
use splitsum::metrics::{Comparison, Epsilon, METRICS};
use splitsum::pixels::{Decoded, GrayImage, exr};
use splitsum::table::markdown::{Align, MarkdownTable};
use splitsum::tonemap::ToneCurve;
use std::path::{Path, PathBuf};

/// Scores a linear EXR image against a reference.
#[derive(Args, Debug)]
#[command(
    allow_negative_numbers = true,
    after_help = "Example:\n  splitsum render --method split-sum --out ball.exr\n  \
    splitsum render --method reference --out reference.exr\n  splitsum compare ball.exr reference.exr --json"
)]
pub struct Arguments {
    /// The image to judge.
    test: PathBuf,
    /// The image that it should be.
    reference: PathBuf,
    /// Image that is 1 where pixels count and 0 elsewhere; the reference's alpha channel when left out, else all pixels.
    #[arg(long, value_name = "MASK.exr")]
    mask: Option<PathBuf>,
    /// Prints JSON for programs.
    #[arg(long)]
    json: bool,
    /// Factor before the tone curve, for the display metrics.
    #[arg(long, value_name = "E", default_value = "1", value_parser = |text: &str| number(EXPOSURE, text))]
    exposure: f64,
    /// Exponent of the tone curve times 2.2, for the display metrics.
    #[arg(long, value_name = "C", default_value = "1", value_parser = |text: &str| number(CONTRAST, text))]
    contrast: f64,
    /// Mean luminance m of the light, for the relative metrics: they have 0.01 m^2 beside r^2. `environments.csv` of a run has it, before
    /// environment_scale; with the default they are those of light of mean luminance 1.
    #[arg(long, value_name = "M", default_value = "1", value_parser = mean)]
    environment_mean: f64,
}

fn mean(text: &str) -> Result<f64, String> {
    Kind::Number(Range::above(0.0, 1e30)).parse_text(text).map(|value| value.number())
}

fn number(axis: usize, text: &str) -> Result<f64, String> {
    AXES[axis].kind.parse_text(text).map(|value| value.number())
}

/// Most pixels of images that are compared, a frame of 3840 x 2160: FLIP and SSIM hold some 180 bytes a pixel.
const COMPARED_PIXELS_MAX: u64 = 1 << 23;

pub fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let test = read(&arguments.test)?;
    let [width, height] = [test.rgb.width, test.rgb.height];
    if u64::from(width) * u64::from(height) > COMPARED_PIXELS_MAX {
        return Err(Failure::input(format!(
            "{}: {width}x{height} pixels, whose metrics take {} MiB of memory; expected at most {COMPARED_PIXELS_MAX} pixels, such as 3840x2160",
            arguments.test.display(),
            (u64::from(width) * u64::from(height) * 180) >> 20
        )));
    }
    let reference = read(&arguments.reference)?;
    let (mask, mask_source) = match (&arguments.mask, &reference.alpha) {
        (Some(path), _) => (read(path)?.rgb.map(|texel| texel[0]), format!("--mask {}", path.display())),
        (None, Some(alpha)) => (alpha.clone(), format!("the alpha channel of {}", arguments.reference.display())),
        (None, None) => (GrayImage::filled(reference.rgb.width, reference.rgb.height, 1.0), "all pixels".to_owned()),
    };
    let curve = ToneCurve { exposure: arguments.exposure as f32, contrast: arguments.contrast as f32 };
    let epsilon = Epsilon::of_light(arguments.environment_mean);
    let comparison = Comparison::new(&test.rgb, &reference.rgb, &mask, curve, epsilon).map_err(|error| {
        let (test, reference) = (arguments.test.display(), arguments.reference.display());
        Failure::input(format!("{test} against {reference}, masked by {mask_source}: {error}"))
    })?;
    tell(&format!(
        "relative metrics: light of mean luminance {}, {:e} beside r^2",
        epsilon.mean(),
        epsilon.beside_square()
    ));
    let scores = comparison.evaluate_all();
    if arguments.json {
        let text = serde_json::to_string_pretty(&InOrder(&scores)).map_err(Failure::failed)?;
        return print_data(&(text + "\n"));
    }
    let mut table = MarkdownTable::new(&[
        ("metric", Align::Left),
        ("value", Align::Right),
        ("better", Align::Left),
        ("of", Align::Left),
    ]);
    for ((name, value), metric) in scores.iter().zip(METRICS) {
        let d = metric.description();
        table.row(&[*name, &value.to_string(), d.better.name(), d.space.name()]);
    }
    print(&table.to_string())
}

/// Scores as a JSON object in the order of [`METRICS`]; a map of `serde_json` would sort them.
struct InOrder<'a>(&'a [(&'static str, f64)]);

impl Serialize for InOrder<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        // JSON has no infinity: PSNR of equal images becomes the text "inf".
        let value = |x: f64| if x.is_finite() { serde_json::json!(x) } else { serde_json::json!(x.to_string()) };
        serializer.collect_map(self.0.iter().map(|(name, x)| (name, value(*x))))
    }
}

fn read(path: &Path) -> Result<Decoded, Failure> {
    let decoded = exr::read(path).map_err(Failure::input)?;
    for warning in &decoded.warnings {
        super::warn(&path.display().to_string(), warning);
    }
    Ok(decoded)
}
