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
    ("image reference", 120.0, 42.0),
    ("reference", 1500.0, 20.0),
    ("reference none", 1500.0, 28.0),
    ("table", 0.0, 10.0),
    ("table prefilter", 0.0, 2.5),
    ("table dfg", 0.0, 9.0),
    ("table irradiance", 0.0, 11.0),
    ("ladder", 0.0, 400.0),
];
/// The host's work in seconds, and files in bytes: kind, for each item, for each pixel.
const HOST: [(&str, f64, f64); 10] = [
    ("display", 0.0, 50.0 * NS),
    // Scores and pictures of a cell on one thread.
    ("score", 0.0, 500.0 * NS),
    // A process and its device.
    ("start", 1.0, 0.0),
    // Tables, contact sheets, answers and report, for each cell.
    ("end", 0.0, 150.0 * NS),
    // f32 R, G, B and A; with the three channels of the standard error.
    ("bytes linear", 0.0, 16.0),
    ("bytes reference", 0.0, 28.0),
    // A PNG of a rendered image or an error map.
    ("bytes picture", 0.0, 1.3),
    // All metrics in ten bins.
    ("bytes record", 12_000.0, 0.0),
    // A cell in a contact sheet; in the tables and answers.
    ("bytes sheet", 0.0, 1.5),
    ("bytes rows", 6000.0, 0.0),
];

/// The speeds as they are.
pub fn constants() -> Speeds {
    constants_at(SAMPLES_PER_SECOND)
}

/// The speeds of a device that draws this many samples of the method `sampled` in a second, and does all its other work as much faster.
pub fn constants_at(samples_per_second: f64) -> Speeds {
    let host = HOST.map(|(kind, fixed, per_pixel)| (kind.to_owned(), Line { fixed, per_pixel, per_sample: 0.0 }));
    let mut speeds = device_speeds(samples_per_second);
    speeds.0.extend(host);
    speeds
}

/// Of these, the work of the device alone.
pub fn device_speeds(samples_per_second: f64) -> Speeds {
    let slowness = NS * SAMPLES_PER_SECOND / samples_per_second;
    let line = |(kind, per_pixel, per_sample): (&str, f64, f64)| {
        (kind.to_owned(), Line { fixed: 0.0, per_pixel, per_sample }.times(slowness))
    };
    Speeds(DEVICE_NS.map(line).into())
}
