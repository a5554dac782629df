//! What does a frame cost with each method, and what do the tables cost once?
//!
//! A time is the sum of passes in each round, the median over rounds, with its 95 % interval.
//! Compared methods were timed in the same rounds: the ratio of two methods is the median of the
//! ratios round by round, so that a disturbed round affects both; it is not the quotient of the
//! medians. Ratios are of the passes that shade: the others cost the same with every method. The
//! host's own time of the same submissions checks the sum.
//!
//! Tables are computed once per map and model. Sets of tables with other parameters are
//! alternatives: their times are a range, never a sum.
//!
//! Times hold for the timed device only. Times of a CPU driver say nothing about a GPU.

use super::prelude::*;
use crate::base::math::order_statistics::median_interval;
use crate::run::timing::{FRAME, Key, PRECOMPUTE, TimingRecord, swept_axes};
use crate::run::timing_ratios::{Ratio, ratios};

pub const QUESTION: Question = Question {
    name: "times",
    asks: "What does a frame cost with each method, and what do the tables cost once?",
    columns: &[
        column(
            "phase",
            "`frame` for the cost of each frame, `precompute` for tables that are computed once.",
        ),
        column(
            "environment_size",
            "Width and height of the environment, texels.",
        ),
        column(
            "pass",
            "A pass of a table, or `all`: the sum of all passes.",
        ),
        column("rounds", "Timed rounds."),
        column("ms", "Time in milliseconds, the median over rounds."),
        column(
            "ms_lo",
            "Lower end of its 95 % interval; empty below six rounds.",
        ),
        column("ms_hi", super::UPPER),
        column(
            "shading_ms",
            "Time of the passes that shade: no g-buffer, background or tone curve. Median of \
             rounds.",
        ),
        column(
            "over",
            "A method timed in the same rounds, with its sample count; one row for each.",
        ),
        column(
            "ratio",
            "Time to shade over this method's, the median of the ratios round by round.",
        ),
        column(
            "ratio_lo",
            "Lower end of its 95 % interval; empty below six rounds.",
        ),
        column("ratio_hi", super::UPPER),
        column(
            "host_check",
            "`ok` if the passes sum to 50 to 105 % of the host's own time, else the fault.",
        ),
        column("device", "The device that was timed."),
        column(
            "device_type",
            "Its type; times of a `cpu` say nothing about a GPU.",
        ),
    ],
    needs_scores: false,
    uses_times: true,
    is_weighted: false,
    has_rows: false,
    lacks: |shape| (!shape.has_timing).then_some("the experiment has no [timing]"),
    answer,
};

/// A timed configuration.
struct Timed<'f> {
    record: &'f TimingRecord,
    key: Key,
    /// Sums of the passes, ms, one per round.
    sums: Vec<f64>,
}

impl Timed<'_> {
    fn text(&self, axis: AxisId) -> &str {
        text(&self.key, axis)
    }

    fn median(&self) -> f64 {
        median(&self.sums)
    }

    fn shading(&self) -> f64 {
        median(&self.record.shading_ms())
    }

    /// The method; without specular term the diffuse method.
    fn method(&self) -> &str {
        method(&self.key)
    }
}

fn text(key: &Key, axis: AxisId) -> &str {
    key.get(AXES[axis].name).map_or("", String::as_str)
}

fn method(key: &Key) -> &str {
    if text(key, METHOD) == NONE {
        text(key, DIFFUSE_METHOD)
    } else {
        text(key, METHOD)
    }
}

fn variant(key: &Key) -> Variant {
    Variant {
        samples: text(key, SAMPLES).parse().ok(),
        ..Variant::new(method(key))
    }
}

/// The timed sets of a phase; methods without samples first.
fn timed<'f>(frame: &Frame<'f>, phase: &str) -> Vec<Timed<'f>> {
    let records = frame.run.timings.iter();
    let mut found: Vec<Timed> = records
        .filter(|record| record.phase == phase)
        .map(|record| Timed {
            record,
            key: record.key(),
            sums: record.sums_ms(),
        })
        .filter(|one| !one.sums.is_empty())
        .collect();
    found.sort_by_key(|one| {
        let samples = one.text(SAMPLES).parse::<u32>().unwrap_or(0);
        (
            samples > 0,
            one.text(METHOD).to_owned(),
            samples,
            one.record.block.clone(),
        )
    });
    found
}

fn answer(frame: &Frame) -> Option<Finding> {
    let frames = timed(frame, FRAME);
    let tables = timed(frame, PRECOMPUTE);
    let ratios = ratios(&frame.run.timings);
    let swept = swept_axes(frames.iter().chain(&tables).map(|one| &one.key))
        .into_iter()
        .filter_map(AxisId::find);
    let axes = distinct_in_order(
        [METHOD, SAMPLES, BRDF, DIFFUSE_METHOD]
            .into_iter()
            .chain(swept),
    );
    let variants = variants(&frames, &tables, &ratios);
    Some(Finding {
        sentences: sentences(frame, &variants)?,
        table: table(&axes, &frames, &tables, &ratios),
        digest: Some(digest(&variants)),
        figure: figure(frame, &frames, &axes),
    })
}

fn table(axes: &[AxisId], frames: &[Timed], tables: &[Timed], ratios: &[Ratio]) -> Table {
    let mut table = Table::new(axes, QUESTION.columns);
    for one in frames {
        let ratios: Vec<&Ratio> = ratios
            .iter()
            .filter(|ratio| std::ptr::eq(ratio.sampled, one.record))
            .collect();
        if ratios.is_empty() {
            table.row(row(axes, one, ALL, &one.sums, None));
        }
        for ratio in ratios {
            table.row(row(axes, one, ALL, &one.sums, Some(ratio)));
        }
    }
    for one in tables {
        table.row(row(axes, one, ALL, &one.sums, None));
        for pass in &one.record.passes {
            table.row(row(axes, one, &pass.pass, &pass.ms, None));
        }
    }
    table
}

/// A row of the table: the times of a pass, in ms, one per round.
fn row(axes: &[AxisId], one: &Timed, pass: &str, ms: &[f64], ratio: Option<&Ratio>) -> Vec<Cell> {
    let record = one.record;
    let [width, height] = record.environment_size;
    let [ms_lo, ms_hi] = ends(median_interval(ms));
    let [ratio_lo, ratio_hi] = match ratio {
        Some(ratio) => ends(ratio.interval),
        None => [Cell::Missing, Cell::Missing],
    };
    let mut row: Vec<Cell> = axes.iter().map(|axis| one.text(*axis).into()).collect();
    row.extend(cells![
        record.phase.as_str(),
        format!("{width}x{height}"),
        pass,
        ms.len(),
        median(ms),
        ms_lo,
        ms_hi,
        Some(one.shading()).filter(|ms| *ms > 0.0),
        ratio.map(|ratio| Cell::from(&variant(&ratio.fixed.key()))),
        ratio.map(|ratio| ratio.ratio),
        ratio_lo,
        ratio_hi,
        record.wall_check(),
        record.device.as_str(),
        record.device_type.as_str()
    ]);
    row
}

/// The ends of an interval; missing below six rounds.
fn ends(interval: [f64; 2]) -> [Cell; 2] {
    interval.map(|end| Some(end).filter(|end| end.is_finite()).into())
}

/// The times of a method at one sample count, over its configurations.
struct VariantTimes {
    variant: Variant,
    configuration_count: usize,
    ms: Extent,
    shading_ms: Extent,
    /// The time to shade over the first variant's.
    ratio: Option<Extent>,
    /// The samples of the first sampling method that take as long to shade.
    samples_as_long: Option<Extent>,
    tables_ms: Option<Extent>,
    /// "mips 28 to 29, prefilter 265 to 287": times of tables.
    passes: Option<String>,
}

fn variants(frames: &[Timed], tables: &[Timed], ratios: &[Ratio]) -> Vec<VariantTimes> {
    let groups = grouped(frames, |one| variant(&one.key));
    let first = groups
        .iter()
        .map(|(variant, _)| variant.clone())
        .find(|variant| variant.method != NONE)
        .unwrap_or_default();
    let mut variants = Vec::new();
    for (variant, frames) in groups {
        let tables: Vec<&Timed> = tables
            .iter()
            .filter(|table| table.method() == frames[0].method())
            .collect();
        let to_first = ratios_to(&first, &variant, ratios);
        let samples: Option<Vec<f64>> = frames
            .iter()
            .map(|one| samples_as_long(one.record, ratios))
            .collect();
        variants.push(VariantTimes {
            configuration_count: frames.len(),
            ms: Extent::from_values(frames.iter().map(|one| one.median())),
            shading_ms: Extent::from_values(frames.iter().map(|one| one.shading())),
            ratio: (!to_first.is_empty()).then(|| Extent::from_values(to_first)),
            samples_as_long: samples.map(Extent::from_values),
            tables_ms: (!tables.is_empty())
                .then(|| Extent::from_values(tables.iter().map(|table| table.median()))),
            passes: passes(&tables),
            variant,
        });
    }
    variants
}

/// The ratios of a variant's time to shade over the first variant's.
fn ratios_to(first: &Variant, wanted: &Variant, ratios: &[Ratio]) -> Vec<f64> {
    let mut found = Vec::new();
    for ratio in ratios {
        let sampled = variant(&ratio.sampled.key());
        let fixed = variant(&ratio.fixed.key());
        if sampled == *wanted && fixed == *first {
            found.push(ratio.ratio);
        } else if fixed == *wanted && sampled == *first {
            found.push(ratio.ratio.recip());
        }
    }
    found
}

/// One row per variant: its times, over the first variant's or in samples, and the cost of its
/// tables.
fn digest(variants: &[VariantTimes]) -> Table {
    let first = first_variant(variants).map_or_else(String::new, |first| first.variant.to_string());
    let mut table = Table::with_names([
        AXES[METHOD].name,
        "configurations",
        "ms a frame",
        "ms to shade",
        &format!("times `{first}`"),
        "as long as",
        "tables once, ms",
        "of which",
    ]);
    for one in variants {
        let samples = one.samples_as_long;
        table.row(cells![
            &one.variant,
            one.configuration_count,
            one.ms,
            one.shading_ms,
            one.ratio,
            samples.map(|samples| Quantity::new(samples).unit(Unit::SAMPLES)),
            one.tables_ms,
            one.passes.clone()
        ]);
    }
    table.without_empty()
}

/// The first variant with a compared term, over which ratios are taken.
fn first_variant(variants: &[VariantTimes]) -> Option<&VariantTimes> {
    variants.iter().find(|one| one.variant.method != NONE)
}

/// The samples of the first sampling method that take as long to shade as this method without
/// samples: where the ratio over their count passes 1, interpolated. `None` if it does not between
/// the timed counts.
fn samples_as_long(fixed: &TimingRecord, ratios: &[Ratio]) -> Option<f64> {
    let mut ratios: Vec<&Ratio> = ratios
        .iter()
        .filter(|ratio| std::ptr::eq(ratio.fixed, fixed))
        .collect();
    let first = ratios.first()?.sampled.value(METHOD);
    ratios.retain(|ratio| ratio.sampled.value(METHOD) == first);
    let point = |ratio: &Ratio| Some([ratio.sampled.value(SAMPLES).parse().ok()?, ratio.ratio]);
    let mut points: Vec<[f64; 2]> = ratios.into_iter().filter_map(point).collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let passes = points
        .windows(2)
        .find(|ends| ends[0][1] <= 1.0 && ends[1][1] > 1.0)?;
    let [n, a] = passes[0];
    let [m, b] = passes[1];
    Some(n + (m - n) * (1.0 - a) / (b - a))
}

/// "mips 28 to 29, prefilter 265 to 287": times by the table that the passes fill.
fn passes(tables: &[&Timed]) -> Option<String> {
    let mut sums: Vec<(&str, f64)> = Vec::new();
    for table in tables {
        for (name, passes) in grouped(&table.record.passes, |pass| pass.table()) {
            sums.push((name, passes.iter().map(|pass| median(&pass.ms)).sum()));
        }
    }
    let words: Vec<String> = grouped(sums, |(name, _)| *name)
        .into_iter()
        .map(|(name, sums)| format!("{name} {}", range(sums.into_iter().map(|(_, ms)| ms))))
        .collect();
    (!words.is_empty()).then(|| words.join(", "))
}

/// The samples that each method without samples costs; without counts, the first variant and the
/// last (the costliest). Then the tables of the first.
fn sentences(frame: &Frame, variants: &[VariantTimes]) -> Option<Sentences> {
    let first = first_variant(variants)?;
    let driver = frame.cpu_words();
    let name = Phrase::Method(first.variant.clone());
    let ms = Quantity::new(first.shading_ms).unit(" ms");
    let as_samples = variants.iter().filter_map(|one| {
        let samples = Quantity::new(one.samples_as_long?).unit(Unit::SAMPLES);
        Some(statement![
            Phrase::Method(one.variant.clone()),
            " ",
            samples
        ])
    });
    let as_samples = Statement::joined(as_samples, ", ");
    let costliest = variants
        .iter()
        .rev()
        .find_map(|one| Some((one, one.ratio?)));
    let headline = if !as_samples.is_empty() {
        statement![format!("As long to shade{driver} as: "), as_samples, "."]
    } else if let Some((other, ratio)) = costliest {
        statement![
            Phrase::Method(other.variant.clone()),
            " takes ",
            Quantity::new(ratio).unit(" times"),
            " as long to shade as ",
            name.clone(),
            format!("{driver}: "),
            Quantity::new(other.shading_ms).unit(" ms"),
            " instead of ",
            ms,
            "."
        ]
    } else {
        statement![name.clone(), " takes ", ms, format!(" to shade{driver}.")]
    };
    let tables = first.tables_ms.map(|ms| {
        statement![
            "The tables of ",
            name,
            " take ",
            Quantity::new(ms).unit(" ms"),
            " once per map and model."
        ]
    });
    Some(Sentences::new(headline).with_details(tables))
}

fn figure(frame: &Frame, frames: &[Timed], axes: &[AxisId]) -> Option<Figure> {
    let first = frames.first()?;
    let names: Vec<String> = frames.iter().map(|one| bar_name(one, axes)).collect();
    let mut marks = Vec::new();
    for (index, one) in frames.iter().enumerate() {
        let bar = Form::HorizontalBar {
            y: index as f64,
            base: 0.0,
            to: one.median(),
        };
        let tip = format!("{}: {} ms", names[index], number(one.median()));
        marks.push(Mark::new(bar, 0).tip(tip).cell(one.record.cell));
    }
    Chart {
        title: "Time of a frame",
        note: format!(
            "median over {} rounds, {}{}",
            first.sums.len(),
            first.record.device,
            frame.cpu_words()
        ),
        x: ChartAxis::Linear("ms"),
        y: ChartAxis::Steps("", names),
        panels: vec![ChartPanel {
            title: String::new(),
            marks,
        }],
        series: vec![solid("frame")],
    }
    .figure()
}

/// "Sampling, 40 samples · ggx".
fn bar_name(one: &Timed, axes: &[AxisId]) -> String {
    let mut words = vec![variant(&one.key).label()];
    for axis in axes {
        let text = one.text(*axis);
        if ![METHOD, SAMPLES].contains(axis) && !text.is_empty() {
            words.push(text.to_owned());
        }
    }
    words.join(" · ")
}
