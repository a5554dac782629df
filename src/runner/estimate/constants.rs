//! Speeds that nobody measured here: those of a software driver (lavapipe, LLVM 15) on two quiet cores, from the records of the published
//! runs. These took 0.65 to 1.25 of what the constants say; a busy machine or another processor is another matter.

use super::speeds::{Line, Speeds};

/// Samples of the method `sampled` that such a driver draws in a second: to scale these speeds to another device.
pub const SAMPLES_PER_SECOND: f64 = 60e6;

const NS: f64 = 1e-9;

/// A device's work: kind, ns a pixel, ns a sample.
const DEVICE_NS: [(&str, f64, f64); 11] = [
    ("image", 120.0, 15.0),
    ("image split-sum", 250.0, 15.0),
    ("image none", 250.0, 15.0),
    ("image seed0-literal", 120.0, 32.0),
    ("image reference", 120.0, 42.0),
    ("reference", 1500.0, 20.0),
    ("reference none", 1500.0, 28.0),
    ("table", 0.0, 10.0),
    ("table prefilter", 0.0, 2.5),
    ("table dfg", 0.0, 9.0),
    ("table irradiance", 0.0, 11.0),
];
/// Submission of a timed frame, seconds.
const FRAME_SECONDS: f64 = 0.002;
/// The tone curve, for each pixel, seconds.
const DISPLAY_SECONDS_PER_PIXEL: f64 = 50.0 * NS;
/// Scores and pictures of a cell on one thread, for each pixel, seconds.
const SCORE_SECONDS_PER_PIXEL: f64 = 500.0 * NS;
/// Start of a process and its device, seconds.
const START_SECONDS: f64 = 1.0;
/// Tables, contact sheets, answers and report, for each pixel of each cell, seconds.
const END_SECONDS_PER_PIXEL: f64 = 150.0 * NS;

/// f32 R, G, B and A.
const LINEAR_BYTES_PER_PIXEL: f64 = 16.0;
/// The same with the three channels of the standard error.
const REFERENCE_BYTES_PER_PIXEL: f64 = 28.0;
/// A PNG of a rendered image or an error map.
const PICTURE_BYTES_PER_PIXEL: f64 = 1.3;
/// All metrics in ten bins.
const RECORD_BYTES: f64 = 12_000.0;
/// A pixel of a cell in a contact sheet.
const SHEET_BYTES_PER_PIXEL: f64 = 1.5;
/// A cell in the tables and answers.
const ROWS_BYTES: f64 = 6000.0;

/// The speeds as they are.
pub fn constants() -> Speeds {
    constants_at(SAMPLES_PER_SECOND)
}

/// The speeds of a device that draws this many samples of the method `sampled` in a second, and does all its other work as much faster.
pub fn constants_at(samples_per_second: f64) -> Speeds {
    let fixed = |fixed: f64| Line { fixed, ..Line::default() };
    let per_pixel = |per_pixel: f64| Line { per_pixel, ..Line::default() };
    let mut speeds = Speeds::of(&[
        ("display", per_pixel(DISPLAY_SECONDS_PER_PIXEL)),
        ("score", per_pixel(SCORE_SECONDS_PER_PIXEL)),
        ("start", fixed(START_SECONDS)),
        ("end", per_pixel(END_SECONDS_PER_PIXEL)),
        ("bytes linear", per_pixel(LINEAR_BYTES_PER_PIXEL)),
        ("bytes reference", per_pixel(REFERENCE_BYTES_PER_PIXEL)),
        ("bytes picture", per_pixel(PICTURE_BYTES_PER_PIXEL)),
        ("bytes record", fixed(RECORD_BYTES)),
        ("bytes sheet", per_pixel(SHEET_BYTES_PER_PIXEL)),
        ("bytes rows", fixed(ROWS_BYTES)),
    ]);
    speeds.extend(device_speeds(samples_per_second));
    speeds
}

/// Of these, the work of the device alone.
pub fn device_speeds(samples_per_second: f64) -> Speeds {
    let slowness = SAMPLES_PER_SECOND / samples_per_second;
    let mut speeds = Speeds::default();
    for (kind, pixel_ns, sample_ns) in DEVICE_NS {
        let line = Line { fixed: 0.0, per_pixel: pixel_ns * NS, per_sample: sample_ns * NS }.times(slowness);
        speeds.set(kind, line);
        if kind.starts_with("image") {
            speeds.set(&kind.replacen("image", "frame", 1), Line { fixed: FRAME_SECONDS, ..line });
        }
    }
    speeds
}
