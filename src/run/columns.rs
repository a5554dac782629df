//! The columns of a run's tables. Axes and metrics have lists of their own.
//!
//! [`columns!`] declares the known columns of a table as a struct: the name of a field is the name
//! of the column, and its doc comment is the meaning in docs/columns.md.

use crate::base::csv::Cell;

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

/// The known columns of a row.
pub trait Columns {
    const COLUMNS: &'static [Column];

    /// The values, in the order of [`Columns::COLUMNS`].
    fn fields(self) -> Vec<Cell>;

    fn names() -> impl Iterator<Item = String> {
        Self::COLUMNS.iter().map(|column| column.name.to_owned())
    }
}

/// The text of a doc comment, without the space that follows its slashes.
const fn doc_text(comment: &'static str) -> &'static str {
    comment.split_at(1).1
}

macro_rules! columns {
    (
        $(#[$attribute:meta])*
        pub struct $row:ident {
            $($(#[doc = $line:literal])+ pub $field:ident: $of:ty,)+
        }
    ) => {
        $(#[$attribute])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $row {
            $($(#[doc = $line])+ pub $field: $of,)+
        }

        impl Columns for $row {
            const COLUMNS: &'static [Column] = &[
                $(column(stringify!($field), doc_text(concat!($($line),+))),)+
            ];

            fn fields(self) -> Vec<Cell> {
                vec![$(self.$field.into(),)+]
            }
        }
    };
}

/// The first column of most tables.
pub const CELL: Column = column(
    "cell",
    "Id of the cell: a hash of everything that determines its scores.",
);

/// The verdict on a cell that could not be rendered or scored.
pub const FAILED: &str = "failed";
/// The verdict on a finished cell of an experiment without references.
pub const UNSCORED: &str = "unscored";

columns! {
    /// `errors.csv`, besides the cell, its axes, the metrics and their noise floors.
    pub struct ErrorColumns {
        /// Samples per pixel and term at which the reference stopped; the fewest of its terms;
        /// empty if no term is an integral.
        pub reference_samples: Option<u64>,
        /// Relative standard error of the reference image; the largest of its terms; empty if no
        /// term is an integral.
        pub reference_relative_error: Option<f64>,
        /// `samples`; `relative-error` if every term reached the requested error; `noise-share` if
        /// fewer samples were exact enough for all images that it judges; empty if no term is an
        /// integral.
        pub reference_stopped_by: Option<&'static str>,
        /// The headline metric, as a mean square, against its noise floor: `resolved`,
        /// `reference-limited` below 11 floors (100 with exact references), `equal-within-noise`
        /// up to four, `no-noise-floor`, `failed`, or `unscored` without references.
        pub verdict: String,
    }
}

columns! {
    /// `errors.csv` of an experiment with sequences of frames: its columns after [`ErrorColumns`].
    pub struct SteadinessColumns {
        /// `relmse` of the accumulated frames without noise: bias and, if moving, lag; empty for
        /// single images.
        pub lag_bias: Option<f64>,
        /// Variance of the last eight results by the curve of `tone_mapped_mse`, without motion;
        /// empty for single images.
        pub flicker: Option<f64>,
    }
}

columns! {
    /// `errors_by_n_dot_v.csv`, besides the cell, its axes and the metrics.
    pub struct BinColumns {
        /// Lower end of the bin of n·v, inclusive.
        pub n_dot_v_from: f64,
        /// Upper end of the bin of n·v, exclusive.
        pub n_dot_v_to: f64,
        /// Pixels in the bin.
        pub pixel_count: usize,
        /// Mean of the reference over the bin's pixels and channels.
        pub reference_mean: Option<f64>,
    }
}

columns! {
    /// `steps.csv`, besides the cell.
    pub struct StepColumns {
        /// Lower end of the bin of n·v, inclusive.
        pub n_dot_v_from: f64,
        /// Upper end of the bin of n·v, exclusive.
        pub n_dot_v_to: f64,
        /// The approximation: see docs/estimators.md, "The ladder".
        pub step: String,
        /// Covariance share of the `relmse`, in the ladder's order; shares of a cell and band sum
        /// to 1.
        pub share: f64,
        /// Standard error of the share, from scrambled point sets; 0 if nothing is sampled.
        pub share_error: f64,
        /// `relmse` after this step and all before it.
        pub rung_error: f64,
        /// `relmse` that the step adds if it comes first, after the steps that it needs.
        pub first_in: f64,
        /// `relmse` saved if this step and those that need it are exact; below 0 it hides other
        /// errors.
        pub last_out: f64,
        /// Mean of the step's added `relmse` over all legal orders; the steps' numbers sum to the
        /// error.
        pub shapley: f64,
        /// Relative standard error of the step, root mean square over pixels; 0 if nothing is
        /// sampled.
        pub step_error: f64,
        /// `relmse` of an exact image, from the reference's standard error.
        pub noise: f64,
    }
}

columns! {
    /// `recovery.csv`, besides the cell.
    pub struct RecoveryColumns {
        /// Id of a cell of the candidate: its method and parameters. The cell is a photo.
        pub candidate: String,
        /// Photos of the fit, one per orientation of the light.
        pub photos: usize,
        /// The loss of the fit: see docs/recovery.md, "Losses".
        pub loss: &'static str,
        /// Lower end of the band of n·v, inclusive; 0 to 1 is the fit to whole photos.
        pub n_dot_v_from: f64,
        /// Upper end of the band of n·v, exclusive.
        pub n_dot_v_to: f64,
        /// Perceptual roughness of the photos, √alpha.
        pub true_roughness: f64,
        /// F0 of the photos.
        pub true_f0: f64,
        /// Recovered perceptual roughness.
        pub roughness: f64,
        /// Recovered F0, at most 3.
        pub f0: f64,
        /// 1 if the fit ends at the least or largest width or F0, else 0.
        pub is_at_limit: u64,
        /// Loss of the recovered material.
        pub loss_at_fit: f64,
        /// Loss of the true material; far above `loss_at_fit` the fit hides an error.
        pub loss_at_truth: f64,
    }
}

columns! {
    /// `timings.csv`: the columns before the axes that change times.
    pub struct TimedColumns {
        /// `frame` for passes of every frame, `precompute` for tables that are computed once.
        pub phase: String,
        /// Width and height of the environment, texels.
        pub environment_size: String,
    }
}

columns! {
    /// `timings.csv`: the columns after the axes that change times.
    pub struct PassColumns {
        /// Name of the device pass.
        pub pass: String,
        /// Rounds.
        pub n: usize,
        /// Median time over the rounds, ms.
        pub median_ms: f64,
        /// Lower end of the 95 % interval of the median, ms; empty below six rounds.
        pub median_lo_ms: Option<f64>,
        /// Upper end of the 95 % interval of the median, ms.
        pub median_hi_ms: Option<f64>,
        /// Median time of the same submissions on the host's clock, ms.
        pub wall_median_ms: f64,
        /// Median sum of the passes over the median of the host's time.
        pub passes_over_wall: f64,
        /// `ok`, `passes-exceed-wall`, `mostly-outside-passes` or `no-samples`.
        pub wall_check: &'static str,
        /// Name of the device.
        pub device: String,
        /// `cpu` for a software driver: its times say nothing about a GPU.
        pub device_type: String,
    }
}

columns! {
    /// `environments.csv`, besides the axis `environment`.
    pub struct EnvironmentColumns {
        /// Mean luminance over the sphere, in the map's own unit.
        pub mean_luminance: f64,
        /// Luminance of the brightest texel.
        pub peak_luminance: f64,
        /// log2 of peak over mean; empty for a black environment.
        pub dynamic_range_stops: Option<f64>,
    }
}

columns! {
    /// `images.csv`, besides the cell. Each is the name of a file.
    pub struct ImageColumns {
        /// Linear EXR of the cell, in `images/`.
        pub radiance: String,
        /// Linear EXR of its reference; a layer holds the standard error; empty without
        /// references.
        pub reference: Option<String>,
        /// Tone-mapped PNG of the cell.
        pub picture: String,
        /// Tone-mapped PNG of its reference; empty without references.
        pub reference_picture: Option<String>,
        /// PNG of the relative error, in fixed colours; empty without references.
        pub error: Option<String>,
    }
}

/// A table of a run, for docs/columns.md.
#[derive(Clone, Copy, Debug)]
pub struct TableEntry {
    pub file: &'static str,
    /// The known columns, in parts that need not be neighbours.
    parts: &'static [&'static [Column]],
    /// Its rows and further columns, in words.
    pub about: &'static str,
}

impl TableEntry {
    pub fn columns(&self) -> impl Iterator<Item = &'static Column> {
        self.parts.iter().copied().flatten()
    }
}

/// Every table of a run.
pub const TABLES: &[TableEntry] = &[
    TableEntry {
        file: "errors.csv",
        parts: &[ErrorColumns::COLUMNS, SteadinessColumns::COLUMNS],
        about: "One row per cell. Further columns: every axis, every metric, and \
                `METRIC_noise_floor`, the score of an exact image.",
    },
    TableEntry {
        file: "errors_by_n_dot_v.csv",
        parts: &[BinColumns::COLUMNS],
        about: "One row per cell and bin of n·v; only with references. Further columns: every axis, every metric, and \
                `METRIC_noise_floor` of metrics whose bins determine the whole.",
    },
    TableEntry {
        file: "steps.csv",
        parts: &[StepColumns::COLUMNS],
        about: "One row per cell, band of n·v and step, to four digits. Only with `[ladder]`. \
                `errors.csv` has the axes.",
    },
    TableEntry {
        file: "recovery.csv",
        parts: &[RecoveryColumns::COLUMNS],
        about: "One row per surface in photos, candidate method, loss and band of n·v. Only with \
                `[recovery]`. `errors.csv` has the axes.",
    },
    TableEntry {
        file: "timings.csv",
        parts: &[TimedColumns::COLUMNS, PassColumns::COLUMNS],
        about: "One row per timed configuration and pass. Further columns: the axes that change \
                times.",
    },
    TableEntry {
        file: "environments.csv",
        parts: &[EnvironmentColumns::COLUMNS],
        about: "One row per environment. Further column: `environment`.",
    },
    TableEntry {
        file: "images.csv",
        parts: &[ImageColumns::COLUMNS],
        about: "One row per finished cell. The files are in `images/`.",
    },
];
