//! The columns of a run's tables with their meaning. Axes and metrics explain themselves in their own lists.

/// A column and its meaning, for docs/columns.md and the page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column {
    pub name: &'static str,
    /// One or two sentences with unit and range.
    pub about: &'static str,
}

/// A column with its meaning.
pub const fn column(name: &'static str, about: &'static str) -> Column {
    Column { name, about }
}

/// Id of a cell: the first column of most tables.
pub const CELL: Column = column("cell", "Id of the cell: a hash of everything that determines its scores.");

/// The verdict on a cell without scores.
pub const FAILED: &str = "failed";

/// Of `errors.csv`, beside the cell, its axes, the metrics and their noise floors.
pub const ERRORS: &[Column] = &[
    column(
        "var_hat",
        "Variance of the image over point sets, mean over pixels. Unbiased. Only with `[bias_variance]`.",
    ),
    column("bias2_hat", "Squared bias of the image over point sets, mean over pixels. Unbiased, so it may be below 0."),
    column("var_hat_rel", "The variance relative to the squared reference plus ε, as in `relmse`."),
    column("bias2_hat_rel", "The squared bias relative to the squared reference plus ε, as in `relmse`."),
    column("reference_samples", "Samples a pixel and term at which the reference stopped; the fewest of its terms."),
    column("reference_relative_error", "Relative standard error of the reference image; the largest of its terms."),
    column("reference_stopped_by", "`samples`, or `relative-error` where every term reached the requested error."),
    column(
        "verdict",
        "Of the headline metric against its noise floor: `resolved`, `reference-limited` below ten standard errors, `equal-within-noise` \
         below two, `no-noise-floor`, or `failed`.",
    ),
    column("diffuse_weight", "How the diffuse term is weighted beside a specular one; the same for every method."),
];

/// Of `errors_by_n_dot_v.csv`, beside the cell, its axes and the metrics.
pub const BINS: &[Column] = &[
    column("n_dot_v_from", "Lower end of the bin of n·v, inclusive."),
    column("n_dot_v_to", "Upper end of the bin of n·v, exclusive."),
    column("pixel_count", "Pixels in the bin."),
];

/// Of `steps.csv`, beside the cell.
pub const STEPS: &[Column] = &[
    BINS[0],
    BINS[1],
    column("step", "What is approximated: see docs/estimators.md, \"The ladder\"."),
    column(
        "share",
        "Covariance share of the error's `relmse` in the ladder's order; shares of a cell and band sum to 1.",
    ),
    column("share_error", "Its standard error, from the scrambles of what is drawn; 0 where nothing is."),
    column("rung_error", "`relmse` after this step and all before it."),
    column("first_in", "`relmse` that the step adds when it is made first, after those that it needs."),
    column(
        "last_out",
        "`relmse` that goes when it alone is made exact, with those that need it; below 0 it hides error of others.",
    ),
    column("shapley", "The mean of what the step adds over all legal orders; the steps' numbers sum to the error."),
    column(
        "step_error",
        "Standard error of the step over the step, each as the root of its mean square over pixels; 0 where nothing is drawn.",
    ),
    column("noise", "`relmse` of an exact image, from the reference's standard error."),
];

/// The numbers of `steps.csv`.
pub const STEP_NUMBERS: &[Column] = STEPS.split_at(3).1;

/// Of `timings.csv`, beside the cell and the axes that cost time.
pub const TIMINGS: &[Column] = &[
    column("phase", "`frame` for passes of every frame, `precompute` for tables that are made once."),
    column("environment_size", "Width and height of the environment, texels."),
    column("pass", "Name of the device pass."),
    column("n", "Rounds."),
    column("median_ms", "Median time over the rounds, ms."),
    column("mad_ms", "Median absolute deviation from the median, ms."),
    column("p05_ms", "5th percentile, ms."),
    column("p95_ms", "95th percentile, ms."),
    column("min_ms", "Least time, ms."),
    column("wall_median_ms", "Median time of the same submissions on the host's clock, ms."),
    column("passes_over_wall", "Median sum of the passes over the median of the host's time."),
    column("wall_check", "`ok`, `passes-exceed-wall`, `mostly-outside-passes` or `no-samples`."),
    column("device", "Name of the device."),
    column("device_type", "`cpu` for a software driver: its times say nothing about a GPU."),
    column("median_lo_ms", "Lower end of the 95 % interval of the median, ms; empty below six rounds."),
    column("median_hi_ms", "Upper end of the 95 % interval of the median, ms."),
    column(
        "drift_percent_per_min",
        "Trend over the rounds, percent of the median a minute; empty for short measurements.",
    ),
    column("flags", "Words of caution: `few-samples`, `drift`, `outliers`, `throttled`."),
    column("clock_before_mhz", "Clock of the device before the rounds, MHz; `unknown` where nobody tells."),
    column("clock_after_mhz", "Clock of the device after the rounds, MHz."),
    column("slowdown", "Reasons for a low clock, by NVIDIA's names."),
    column("load_before", "Load average of the host before the rounds."),
];

/// Of `timing_ratios.csv`, beside the axes that tell its rows apart.
pub const RATIOS: &[Column] = &[
    column("environment_size", "Width and height of the environment, texels."),
    column("sampled", "The sampling method; of two alike methods the first in the list of methods."),
    column("samples", "Its samples a pixel."),
    column("fixed", "The other method."),
    column("sampled_over_fixed", "Median over rounds of the time of `sampled` over that of `fixed`."),
    column("ratio_lo", "Lower end of its 95 % interval; empty below six rounds."),
    column("ratio_hi", "Upper end of its 95 % interval."),
    column("rounds", "Rounds in which both were timed."),
    column("device", "Name of the device."),
    column("device_type", "`cpu` for a software driver: its times say nothing about a GPU."),
];

/// Of `environments.csv`, beside the two axes of the light.
pub const ENVIRONMENTS: &[Column] = &[
    column("mean_luminance", "Mean luminance over the sphere, in the map's own unit."),
    column("peak_luminance", "Luminance of the brightest texel."),
    column("dynamic_range_stops", "log2 of peak over mean; empty for a black environment."),
];

/// Of `images.csv`, beside the cell.
pub const IMAGES: &[Column] = &[
    column("radiance", "Linear EXR of the cell, in `images/`."),
    column("reference", "Linear EXR of its reference; a layer holds the standard error."),
    column("picture", "Tone-mapped PNG of the cell."),
    column("reference_picture", "Tone-mapped PNG of its reference."),
    column("error", "PNG of the relative error, in fixed colours."),
];

/// Every table of a run: its file, the columns of its own, and which lists it takes columns from besides.
pub const TABLES: &[(&str, &[Column], &str)] = &[
    (
        "errors.csv",
        ERRORS,
        "One row a cell. Besides: every axis, every metric, and `METRIC_noise_floor`, the score of an exact image.",
    ),
    ("errors_by_n_dot_v.csv", BINS, "One row a cell and bin of n·v. Besides: every axis and every metric."),
    (
        "steps.csv",
        STEPS,
        "One row a cell, band of n·v and step, to four digits. Only with `[ladder]`. `errors.csv` has the axes of a cell.",
    ),
    ("timings.csv", TIMINGS, "One row a timed configuration and pass. Besides: the axes that cost time."),
    (
        "timing_ratios.csv",
        RATIOS,
        "One row a pair of methods that was timed in the same rounds. Besides: the axes that tell pairs apart.",
    ),
    ("environments.csv", ENVIRONMENTS, "One row an environment and clip, by their two axes."),
    ("images.csv", IMAGES, "One row a finished cell. Files stand in `images/`."),
];
