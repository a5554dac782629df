//! What does a frame cost with each method?
//!
//! The time of a frame is the sum of its passes, the median over rounds, with the 95 % interval of that median (order statistics and
//! resampling, none below six rounds). Methods that stand side by side were timed in the same rounds in changing order; the time of
//! one over that of another is the median of the ratios round by round, so that what disturbs a round disturbs both. It is not the quotient
//! of the medians. The host's own time of the same submissions checks the sum.
//!
//! Times hold for the device that was timed; those of a driver that computes on the CPU say nothing about a GPU.

use super::prelude::*;
use super::{DEVICE, DEVICE_TYPE, MAP_SIZE, MS_HI};
use crate::run::timing::{FRAME, Key, Summary, TimingRecord, summarize, swept_axes};
use crate::run::timing_ratios::{Ratio, ratios};

pub const QUESTION: Question = Question {
    name: "frame-time",
    asks: "What does a frame cost with each method?",
    columns: &[
        MAP_SIZE,
        column("rounds", "Rounds that were timed."),
        column("ms", "Time of a frame in milliseconds, the median over rounds."),
        column("ms_lo", "Lower end of its 95 % interval; empty below six rounds."),
        MS_HI,
        column("over", "A method timed in the same rounds, with its sample count; a row for each."),
        column("ratio", "Time over that of this method, the median of the ratios round by round."),
        column("ratio_lo", "Lower end of its 95 % interval; empty below six rounds."),
        column("ratio_hi", super::UPPER),
        column("verdict", "FAST, SLOW or SAME (within 2 %) where the interval says so, else AMBIGUOUS."),
        column("host_check", "`ok` where the passes sum to 50 to 105 % of the host's own time, else what is wrong."),
        DEVICE,
        DEVICE_TYPE,
    ],
    uses_times: true,
    uses_costs: false,
    lacks,
    answer,
};

fn lacks(shape: &Shape) -> Option<&'static str> {
    (!shape.has_timing).then_some("the experiment has no [timing]")
}

/// The axes that tell timed configurations apart: method and sample count, and all that are swept.
pub(super) fn key_axes<'k>(keys: impl IntoIterator<Item = &'k Key>) -> Vec<usize> {
    let swept = swept_axes(keys).into_iter().filter_map(index_of);
    [METHOD, SAMPLES].into_iter().chain(swept.filter(|axis| ![METHOD, SAMPLES].contains(axis))).collect()
}

/// The values of a key on these axes, as cells of a table.
pub(super) fn key_cells(key: &Key, axes: &[usize]) -> Vec<Cell> {
    axes.iter().map(|axis| text(key, *axis).into()).collect()
}

pub(super) fn text(key: &Key, axis: usize) -> &str {
    key.get(AXES[axis].name).map_or("", String::as_str)
}

/// "sampled 40": how a timed frame is made.
pub(super) fn way(key: &Key) -> String {
    let method = if text(key, METHOD) == NONE { text(key, DIFFUSE_METHOD) } else { text(key, METHOD) };
    format!("{method} {}", text(key, SAMPLES)).trim_end().to_owned()
}

/// The ends of an interval as cells; nothing below six rounds.
pub(super) fn ends(interval: [f64; 2]) -> [Cell; 2] {
    interval.map(|end| Some(end).filter(|end| end.is_finite()).into())
}

pub(super) fn map_size(record: &TimingRecord) -> String {
    let [width, height] = record.environment_size;
    format!("{width}x{height}")
}

/// A timed frame.
struct Timed<'f> {
    record: &'f TimingRecord,
    key: Key,
    summary: Summary,
}

/// Frames, those of methods without samples first.
fn frames<'f>(frame: &Frame<'f>) -> Vec<Timed<'f>> {
    let records = frame.run.timings.iter().filter(|record| record.phase == FRAME);
    let timed = |record: &'f TimingRecord| Timed { record, key: record.key(), summary: summarize(&record.sums_ms()) };
    let mut found: Vec<Timed> = records.map(timed).filter(|one| one.summary.n > 0).collect();
    found.sort_by_key(|one| {
        let samples = text(&one.key, SAMPLES).parse::<u32>().unwrap_or(0);
        (samples > 0, text(&one.key, METHOD).to_owned(), samples, one.record.block.clone())
    });
    found
}

fn answer(frame: &Frame) -> Option<Finding> {
    let (frames, ratios) = (frames(frame), ratios(&frame.run.timings));
    let axes = key_axes(frames.iter().map(|one| &one.key));
    let mut table = Table::new(&axes, QUESTION.columns);
    for one in &frames {
        let own = ratios.iter().filter(|ratio| std::ptr::eq(ratio.sampled, one.record)).map(Some);
        let own: Vec<Option<&Ratio>> = own.collect();
        for ratio in if own.is_empty() { vec![None] } else { own } {
            let mut row = key_cells(&one.key, &axes);
            row.extend(cells![map_size(one.record), one.summary.n, one.summary.median]);
            row.extend(ends(one.summary.interval));
            row.extend(cells![ratio.map(|ratio| way(&ratio.fixed.key())), ratio.map(|ratio| ratio.ratio)]);
            row.extend(ends(ratio.map_or([f64::NAN; 2], |ratio| ratio.interval)));
            row.extend(cells![ratio.map(|ratio| ratio.verdict.to_string()), one.record.wall_check()]);
            row.extend(cells![one.record.device.as_str(), one.record.device_type.as_str()]);
            table.row(row);
        }
    }
    let digest = digest(&frames, &ratios);
    Some(Finding {
        sentence: sentence(frame, &digest)?,
        table,
        figure: figure(frame, &frames, &axes),
        digest: Some(digest),
    })
}

/// One row a way of making a frame and a way that it was timed beside.
fn digest(frames: &[Timed], ratios: &[Ratio]) -> Table {
    let mut table = Table::with_names([AXES[METHOD].name, "configurations", "ms a frame", "times as long", "as"]);
    for (name, own) in grouped(frames, |one| way(&one.key)) {
        let ms = range(own.iter().map(|one| one.summary.median));
        let beside = grouped(ratios.iter().filter(|ratio| way(&ratio.sampled.key()) == name), |r| way(&r.fixed.key()));
        let times = beside.iter().map(|(base, own)| (Some(range(own.iter().map(|r| r.ratio))), Some(base.as_str())));
        let times: Vec<_> = times.collect();
        for (times, base) in if times.is_empty() { vec![(None, None)] } else { times } {
            table.row(cells![name.as_str(), own.len(), ms.as_str(), times, base]);
        }
    }
    table
}

/// The first way beside the last that was timed with it: the costliest.
fn sentence(frame: &Frame, digest: &Table) -> Option<String> {
    let text = |row: &[Cell], column: usize| crate::study::table::shown(&row[column]);
    let base = digest.rows.iter().find(|row| text(row, 0) != NONE)?;
    let (name, ms, on) = (text(base, 0), text(base, 2), frame.cpu_words());
    let Some(last) = digest.rows.iter().rfind(|row| text(row, 4) == name) else {
        return Some(format!("A frame of `{name}` takes {ms} ms{on}."));
    };
    let [other, other_ms, times] = [0, 2, 3].map(|column| text(last, column));
    Some(format!(
        "A frame of `{other}` takes {times} times as long as one of `{name}`{on}: {other_ms} ms beside {ms} ms."
    ))
}

/// One bar a configuration.
fn figure(frame: &Frame, frames: &[Timed], axes: &[usize]) -> Option<Figure> {
    let name = |one: &Timed| {
        let rest =
            axes.iter().filter(|axis| ![METHOD, SAMPLES].contains(axis)).map(|axis| text(&one.key, *axis).to_owned());
        let words: Vec<String> = std::iter::once(way(&one.key)).chain(rest).filter(|word| !word.is_empty()).collect();
        words.join(" · ")
    };
    let bar = |(y, one): (usize, &Timed)| {
        let tip = format!("{}: {} ms", name(one), number(one.summary.median));
        Mark::new(Form::HorizontalBar { y: y as f64, base: 0.0, to: one.summary.median }, 0)
            .tip(tip)
            .cell(&one.record.cell)
    };
    let first = frames.first()?;
    Chart {
        title: "Time of a frame",
        note: format!("median over {} rounds, {}{}", first.summary.n, first.record.device, frame.cpu_words()),
        x: Along::Linear("ms"),
        y: Along::Steps("", frames.iter().map(name).collect()),
        panels: vec![(String::new(), frames.iter().enumerate().map(bar).collect())],
        series: vec!["frame".to_owned()],
    }
    .figure()
}
