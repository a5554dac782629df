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
use crate::study::table::shown;

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
    uses_times: true,
    is_weighted: false,
    has_rows: false,
    lacks: |shape| (!shape.has_timing).then_some("the experiment has no [timing]"),
    answer,
};

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

/// "sampled 40".
fn way(key: &Key) -> String {
    format!("{} {}", method(key), text(key, SAMPLES))
        .trim_end()
        .to_owned()
}

/// The timed sets of a phase; methods without samples first.
fn timed<'f>(frame: &Frame<'f>, phase: &str) -> Vec<Timed<'f>> {
    let records = frame
        .run
        .timings
        .iter()
        .filter(|record| record.phase == phase);
    let timed = |record: &'f TimingRecord| Timed {
        record,
        key: record.key(),
        sums: record.sums_ms(),
    };
    let mut found: Vec<Timed> = records
        .map(timed)
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
    let [frames, sets] = [FRAME, PRECOMPUTE].map(|phase| timed(frame, phase));
    let ratios = ratios(&frame.run.timings);
    let swept = swept_axes(frames.iter().chain(&sets).map(|one| &one.key))
        .into_iter()
        .filter_map(AxisId::find);
    let axes = distinct_in_order(
        [METHOD, SAMPLES, BRDF, DIFFUSE_METHOD]
            .into_iter()
            .chain(swept),
    );
    let mut table = Table::new(&axes, QUESTION.columns);
    let mut row = |one: &Timed, pass: &str, ms: &[f64], ratio: Option<&Ratio>| {
        let [width, height] = one.record.environment_size;
        let mut row: Vec<Cell> = axes.iter().map(|axis| one.text(*axis).into()).collect();
        row.extend(cells![
            one.record.phase.as_str(),
            format!("{width}x{height}"),
            pass,
            ms.len(),
            median(ms)
        ]);
        row.extend(ends(median_interval(ms)));
        row.push(Some(one.shading()).filter(|ms| *ms > 0.0).into());
        row.extend(cells![
            ratio.map(|ratio| way(&ratio.fixed.key())),
            ratio.map(|ratio| ratio.ratio)
        ]);
        row.extend(ends(ratio.map_or([f64::NAN; 2], |ratio| ratio.interval)));
        row.extend(
            [
                one.record.wall_check(),
                &one.record.device,
                &one.record.device_type,
            ]
            .map(Cell::from),
        );
        table.row(row);
    };
    for one in &frames {
        let mut own = ratios
            .iter()
            .filter(|ratio| std::ptr::eq(ratio.sampled, one.record))
            .peekable();
        if own.peek().is_none() {
            row(one, ALL, &one.sums, None);
        }
        own.for_each(|ratio| row(one, ALL, &one.sums, Some(ratio)));
    }
    for one in &sets {
        row(one, ALL, &one.sums, None);
        one.record
            .passes
            .iter()
            .for_each(|pass| row(one, &pass.pass, &pass.ms, None));
    }
    let digest = digest(&frames, &sets, &ratios);
    Some(Finding {
        sentence: sentence(frame, &digest)?,
        table,
        figure: figure(frame, &frames, &axes),
        digest: Some(digest),
    })
}

/// The ends of an interval; missing below six rounds.
fn ends(interval: [f64; 2]) -> [Cell; 2] {
    interval.map(|end| Some(end).filter(|end| end.is_finite()).into())
}

const SHADING: &str = "ms to shade";
const AS_SAMPLES: &str = "as long as";

/// One row per way to make a frame: its times, over the first way's or in samples, and the cost of
/// its tables.
fn digest(frames: &[Timed], sets: &[Timed], ratios: &[Ratio]) -> Table {
    let ways = grouped(frames, |one| way(&one.key));
    let first = ways
        .iter()
        .map(|(name, _)| name.as_str())
        .find(|name| *name != NONE)
        .unwrap_or("");
    let over = format!("times `{first}`");
    let names = [
        "configurations",
        "ms a frame",
        SHADING,
        &over,
        AS_SAMPLES,
        "tables once, ms",
        "of which",
    ];
    let mut table = Table::with_names(std::iter::once(AXES[METHOD].name).chain(names));
    for (name, own) in &ways {
        let ms = [Timed::median, Timed::shading].map(|ms| range(own.iter().map(|one| ms(one))));
        let is_own = |record: &TimingRecord, name: &str| way(&record.key()) == name;
        let times = ratios.iter().filter_map(|ratio| match () {
            () if is_own(ratio.sampled, name) && is_own(ratio.fixed, first) => Some(ratio.ratio),
            () if is_own(ratio.fixed, name) && is_own(ratio.sampled, first) => {
                Some(ratio.ratio.recip())
            }
            () => None,
        });
        let times: Vec<f64> = times.collect();
        let times = (!times.is_empty()).then(|| range(times));
        let samples: Option<Vec<f64>> = own
            .iter()
            .map(|one| samples_as_long(one.record, ratios))
            .collect();
        let samples = samples.map(|samples| format!("{} samples", range(samples)));
        let tables: Vec<&Timed> = sets
            .iter()
            .filter(|set| set.method() == own[0].method())
            .collect();
        let all = (!tables.is_empty()).then(|| range(tables.iter().map(|set| set.median())));
        let [ms, shading] = ms;
        table.row(cells![
            name.as_str(),
            own.len(),
            ms,
            shading,
            times,
            samples,
            all,
            passes(&tables)
        ]);
    }
    table.without_empty()
}

/// The samples of the first sampling method that take as long to shade as this way without samples:
/// where the ratio over their count passes 1, interpolated. `None` if it does not between the timed
/// counts.
fn samples_as_long(fixed: &TimingRecord, ratios: &[Ratio]) -> Option<f64> {
    let beside: Vec<&Ratio> = ratios
        .iter()
        .filter(|ratio| std::ptr::eq(ratio.fixed, fixed))
        .collect();
    let is_first = |ratio: &&&Ratio| ratio.sampled.value(METHOD) == beside[0].sampled.value(METHOD);
    let count = |ratio: &&Ratio| Some([ratio.sampled.value(SAMPLES).parse().ok()?, ratio.ratio]);
    let mut points: Vec<[f64; 2]> = beside.iter().filter(is_first).filter_map(count).collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let passes = points
        .windows(2)
        .find(|ends| ends[0][1] <= 1.0 && ends[1][1] > 1.0)?;
    let [[n, a], [m, b]] = [passes[0], passes[1]];
    Some(n + (m - n) * (1.0 - a) / (b - a))
}

/// "mips 28 to 29, prefilter 265 to 287": times by kind; levels of a map count together.
fn passes(tables: &[&Timed]) -> Option<String> {
    let kind = |pass: &str| pass.split(' ').next().unwrap_or_default().to_owned();
    let of_set = |set: &&Timed| {
        let passes = grouped(&set.record.passes, |pass| kind(&pass.pass)).into_iter();
        let sum = |own: Vec<_>| {
            own.iter()
                .map(|pass: &&crate::run::timing::PassSamples| median(&pass.ms))
                .sum::<f64>()
        };
        passes
            .map(|(kind, own)| (kind, sum(own)))
            .collect::<Vec<_>>()
    };
    let kinds = grouped(tables.iter().flat_map(of_set), |(kind, _)| kind.clone());
    let words = kinds
        .into_iter()
        .map(|(kind, own)| format!("{kind} {}", range(own.into_iter().map(|(_, ms)| ms))));
    Some(words.collect::<Vec<_>>().join(", ")).filter(|words| !words.is_empty())
}

/// The samples that each way without samples costs; without counts, the first way and the last (the
/// costliest). Then the tables of the first.
fn sentence(frame: &Frame, digest: &Table) -> Option<String> {
    let place = |name: &str| digest.columns.iter().position(|column| column == name);
    let text = |row: &[Cell], name: &str| {
        place(name).map_or_else(String::new, |column| shown(&row[column]))
    };
    let base = digest.rows.iter().find(|row| shown(&row[0]) != NONE)?;
    let (name, ms, on) = (shown(&base[0]), text(base, SHADING), frame.cpu_words());
    let over = format!("times `{name}`");
    let counted = |row: &&Vec<Cell>| !text(row, AS_SAMPLES).is_empty();
    let samples = digest
        .rows
        .iter()
        .filter(counted)
        .map(|row| format!("`{}` {}", shown(&row[0]), text(row, AS_SAMPLES)));
    let samples: Vec<String> = samples.collect();
    let last = digest.rows.iter().rfind(|row| !text(row, &over).is_empty());
    let frames = match last {
        _ if !samples.is_empty() => format!("As long to shade{on} as: {}.", samples.join(", ")),
        None => format!("`{name}` takes {ms} ms to shade{on}."),
        Some(last) => {
            let [other, times, other_ms] =
                [AXES[METHOD].name, over.as_str(), SHADING].map(|name| text(last, name));
            format!(
                "`{other}` takes {times} times as long to shade as `{name}`{on}: {other_ms} ms \
                 instead of {ms} ms."
            )
        }
    };
    Some(match text(base, "tables once, ms") {
        none if none.is_empty() => frames,
        once => format!("{frames} The tables of `{name}` take {once} ms once per map and model."),
    })
}

fn figure(frame: &Frame, frames: &[Timed], axes: &[AxisId]) -> Option<Figure> {
    let name = |one: &Timed| {
        let rest = axes
            .iter()
            .filter(|axis| ![METHOD, SAMPLES].contains(axis))
            .map(|axis| one.text(*axis).to_owned());
        let words = std::iter::once(way(&one.key))
            .chain(rest)
            .filter(|word| !word.is_empty());
        words.collect::<Vec<_>>().join(" · ")
    };
    let bar = |(y, one): (usize, &Timed)| {
        let shape = Form::HorizontalBar {
            y: y as f64,
            base: 0.0,
            to: one.median(),
        };
        Mark::new(shape, 0)
            .tip(format!("{}: {} ms", name(one), number(one.median())))
            .cell(&one.record.cell)
    };
    let first = frames.first()?;
    Chart {
        title: "Time of a frame",
        note: format!(
            "median over {} rounds, {}{}",
            first.sums.len(),
            first.record.device,
            frame.cpu_words()
        ),
        x: Along::Linear("ms"),
        y: Along::Steps("", frames.iter().map(name).collect()),
        panels: vec![(String::new(), frames.iter().enumerate().map(bar).collect())],
        series: vec!["frame".to_owned()],
    }
    .figure()
}
