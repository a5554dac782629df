//! The columns of a run's tables. Axes and metrics have lists of their own.

/// A column and its meaning, for docs/columns.md and the page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column {
    pub name: &'static str,
    /// One or two sentences with unit and range.
    pub about: &'static str,
}

pub const fn column(name: &'static str, about: &'static str) -> Column {
    Column { name, about }
}

/// The first column of most tables.
pub const CELL: Column = column(
    "cell",
    "Id of the cell: a hash of everything that determines its scores.",
);

/// The verdict on a cell without scores.
pub const FAILED: &str = "failed";

/// `errors.csv`, besides the cell, its axes, the metrics and their noise floors.
pub const ERRORS: &[Column] = &[
    column(
        "reference_samples",
        "Samples per pixel and term at which the reference stopped; the fewest of its terms.",
    ),
    column(
        "reference_relative_error",
        "Relative standard error of the reference image; the largest of its terms.",
    ),
    column(
        "reference_stopped_by",
        "`samples`, or `relative-error` if every term reached the requested error.",
    ),
    column(
        "verdict",
        "The headline metric against its noise floor: `resolved`, `reference-limited` below ten \
         standard errors, `equal-within-noise` \
         below two, `no-noise-floor`, or `failed`.",
    ),
    column(
        "lag_bias",
        "Of sequences: `relmse` of the accumulated frames without noise: bias and, if moving, lag.",
    ),
    column(
        "flicker",
        "Of sequences: variance of the last eight results by the curve of `tone_mapped_mse`, no \
         motion.",
    ),
];

/// The columns of sequences of frames, the last ones of [`ERRORS`].
pub const STEADINESS: &[Column] = ERRORS.split_at(4).1;

/// `errors_by_n_dot_v.csv`, besides the cell, its axes and the metrics.
pub const BINS: &[Column] = &[
    column("n_dot_v_from", "Lower end of the bin of n·v, inclusive."),
    column("n_dot_v_to", "Upper end of the bin of n·v, exclusive."),
    column("pixel_count", "Pixels in the bin."),
    column(
        "reference_mean",
        "Mean of the reference over the bin's pixels and channels.",
    ),
];

/// `steps.csv`, besides the cell.
pub const STEPS: &[Column] = &[
    BINS[0],
    BINS[1],
    column(
        "step",
        "The approximation: see docs/estimators.md, \"The ladder\".",
    ),
    column(
        "share",
        "Covariance share of the `relmse`, in the ladder's order; shares of a cell and band sum to \
         1.",
    ),
    column(
        "share_error",
        "Standard error of the share, from scrambled point sets; 0 if nothing is sampled.",
    ),
    column("rung_error", "`relmse` after this step and all before it."),
    column(
        "first_in",
        "`relmse` that the step adds if it comes first, after the steps that it needs.",
    ),
    column(
        "last_out",
        "`relmse` saved if this step and those that need it are exact; below 0 it hides other \
         errors.",
    ),
    column(
        "shapley",
        "Mean of the step's added `relmse` over all legal orders; the steps' numbers sum to the \
         error.",
    ),
    column(
        "step_error",
        "Relative standard error of the step, root mean square over pixels; 0 if nothing is \
         sampled.",
    ),
    column(
        "noise",
        "`relmse` of an exact image, from the reference's standard error.",
    ),
];

/// The numbers of `steps.csv`.
pub const STEP_NUMBERS: &[Column] = STEPS.split_at(3).1;

/// `timings.csv`, besides the cell and the axes that change times.
pub const TIMINGS: &[Column] = &[
    column(
        "phase",
        "`frame` for passes of every frame, `precompute` for tables that are computed once.",
    ),
    column(
        "environment_size",
        "Width and height of the environment, texels.",
    ),
    column("pass", "Name of the device pass."),
    column("n", "Rounds."),
    column("median_ms", "Median time over the rounds, ms."),
    column(
        "median_lo_ms",
        "Lower end of the 95 % interval of the median, ms; empty below six rounds.",
    ),
    column(
        "median_hi_ms",
        "Upper end of the 95 % interval of the median, ms.",
    ),
    column(
        "wall_median_ms",
        "Median time of the same submissions on the host's clock, ms.",
    ),
    column(
        "passes_over_wall",
        "Median sum of the passes over the median of the host's time.",
    ),
    column(
        "wall_check",
        "`ok`, `passes-exceed-wall`, `mostly-outside-passes` or `no-samples`.",
    ),
    column("device", "Name of the device."),
    column(
        "device_type",
        "`cpu` for a software driver: its times say nothing about a GPU.",
    ),
];

/// `environments.csv`, besides the two axes of the light.
pub const ENVIRONMENTS: &[Column] = &[
    column(
        "mean_luminance",
        "Mean luminance over the sphere, in the map's own unit.",
    ),
    column("peak_luminance", "Luminance of the brightest texel."),
    column(
        "dynamic_range_stops",
        "log2 of peak over mean; empty for a black environment.",
    ),
];

/// `images.csv`, besides the cell.
pub const IMAGES: &[Column] = &[
    column("radiance", "Linear EXR of the cell, in `images/`."),
    column(
        "reference",
        "Linear EXR of its reference; a layer holds the standard error.",
    ),
    column("picture", "Tone-mapped PNG of the cell."),
    column("reference_picture", "Tone-mapped PNG of its reference."),
    column("error", "PNG of the relative error, in fixed colours."),
];

/// Every table of a run: file, columns, and its rows and further columns in words.
pub const TABLES: &[(&str, &[Column], &str)] = &[
    (
        "errors.csv",
        ERRORS,
        "One row per cell. Further columns: every axis, every metric, and `METRIC_noise_floor`, \
         the score of an exact image.",
    ),
    (
        "errors_by_n_dot_v.csv",
        BINS,
        "One row per cell and bin of n·v. Further columns: every axis, every metric, and \
         `METRIC_noise_floor` of metrics whose bins \
         determine the whole.",
    ),
    (
        "steps.csv",
        STEPS,
        "One row per cell, band of n·v and step, to four digits. Only with `[ladder]`. \
         `errors.csv` has the axes.",
    ),
    (
        "timings.csv",
        TIMINGS,
        "One row per timed configuration and pass. Further columns: the axes that change times.",
    ),
    (
        "environments.csv",
        ENVIRONMENTS,
        "One row per environment and clip, by their two axes.",
    ),
    (
        "images.csv",
        IMAGES,
        "One row per finished cell. The files are in `images/`.",
    ),
];
