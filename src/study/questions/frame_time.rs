//! What does a frame cost with each method?
//!
//! The time of a frame is the sum of its passes, the median over rounds, with the 95 % interval of that median (order statistics and
//! resampling, none below six rounds). Methods that stand side by side were timed in the same rounds in changing order; the time of
//! one over that of another is the median of the ratios round by round, so that what disturbs a round disturbs both. It is not the quotient
//! of the medians. The host's own time of the same submissions checks the sum.
//!
//! Times hold for the device that was timed; those of a driver that computes on the CPU say nothing about a GPU.

use super::words::{number, percent};
use super::{Finding, Question};
use crate::runner::axis::index_of;
use crate::runner::statistics::TOO_FEW_ROUNDS;
use crate::runner::timing::{FRAME, Key, Summary, TimingRecord, summarize, swept_axes};
use crate::runner::timing_ratios::{Ratio, ratios};
use crate::study::figure::{Figure, Mark, Panel, Scale, Series, Shape as Form};
use crate::study::frame::{Frame, Shape, distinct_in_order};
use crate::study::table::{Column, Table};
use crate::table::csv::Cell;

pub const QUESTION: Question = Question {
    name: "frame-time",
    asks: "What does a frame cost with each method?",
    columns: &[
        Column { name: "environment_size", about: "Width and height of the environment's map." },
        Column { name: "rounds", about: "Rounds that were timed." },
        Column { name: "ms", about: "Time of a frame in milliseconds, the median over rounds." },
        Column { name: "ms_lo", about: "Lower end of its 95 % interval; empty below six rounds." },
        Column { name: "ms_hi", about: "Upper end of that interval." },
        Column { name: "over", about: "A method timed in the same rounds, with its sample count; a row for each." },
        Column { name: "ratio", about: "Time over that of this method, the median of the ratios round by round." },
        Column { name: "ratio_lo", about: "Lower end of its 95 % interval; empty below six rounds." },
        Column { name: "ratio_hi", about: "Upper end of that interval." },
        Column {
            name: "verdict",
            about: "FAST, SLOW or SAME (within 2 %) where the interval says so, else AMBIGUOUS.",
        },
        Column {
            name: "host_check",
            about: "`ok` where the passes sum to 50 to 105 % of the host's own time, else what is wrong.",
        },
        Column { name: "load", about: "Runnable tasks on the host over the minute before the first round." },
        Column { name: "processors", about: "Processors of the host." },
        Column { name: "device", about: "The device that was timed." },
        Column { name: "device_type", about: "Its type; times of a `cpu` say nothing about a GPU." },
    ],
    uses_times: true,
    lacks,
    answer,
};

/// Runnable tasks for each processor above which others were at work too: a run itself keeps each processor busy.
const LOAD_MAX: f64 = 2.0;

fn lacks(shape: &Shape) -> Option<&'static str> {
    (!shape.has_timing).then_some("the experiment has no [timing]")
}

/// The axes that tell timed configurations apart: method and sample count, and all that are swept.
pub(super) fn key_axes<'k>(keys: impl IntoIterator<Item = &'k Key>) -> Vec<&'static str> {
    const NAMED: [&str; 2] = ["method", "samples"];
    NAMED.into_iter().chain(swept_axes(keys).into_iter().filter(|name| !NAMED.contains(name))).collect()
}

/// The values of a key on these axes, as cells of a table.
pub(super) fn key_cells(key: &Key, axes: &[&str]) -> Vec<Cell> {
    axes.iter().map(|name| Cell::Text(text(key, name).to_owned())).collect()
}

pub(super) fn text<'k>(key: &'k Key, name: &str) -> &'k str {
    key.get(name).map_or("", String::as_str)
}

/// "sampled 40": how a timed frame is made.
pub(super) fn way(key: &Key) -> String {
    let method = if text(key, "method") == "none" { text(key, "diffuse") } else { text(key, "method") };
    format!("{method} {}", text(key, "samples")).trim_end().to_owned()
}

/// What beside the way tells a configuration apart: "ggx · sh9".
fn place(key: &Key, axes: &[&str]) -> String {
    let words = axes.iter().filter(|name| !["method", "samples"].contains(name)).map(|name| text(key, name));
    words.filter(|word| !word.is_empty()).collect::<Vec<_>>().join(" · ")
}

/// The ends of an interval as cells; nothing below six rounds.
pub(super) fn ends(interval: [f64; 2]) -> [Cell; 2] {
    interval.map(|end| Some(end).filter(|end| end.is_finite()).into())
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
    let samples = |one: &Timed| text(&one.key, "samples").parse::<u32>().unwrap_or(0);
    let order =
        |one: &Timed| (samples(one) > 0, text(&one.key, "method").to_owned(), samples(one), one.record.block.clone());
    found.sort_by_key(order);
    found
}

/// Processors of the host of the last session.
fn processors(frame: &Frame) -> Option<f64> {
    frame.run.provenance.pointer(&format!("{}/host/cpu_count", frame.run.last_session()))?.as_f64()
}

fn load(record: &TimingRecord) -> Option<f64> {
    record.host[0].load_average.as_ref().and_then(|load| load.first().copied())
}

/// Whether all frames were timed on a busy host.
fn was_busy(frame: &Frame, frames: &[Timed]) -> bool {
    let least = frames.iter().filter_map(|one| load(one.record)).reduce(f64::min);
    least.zip(processors(frame)).is_some_and(|(least, processors)| processors > 0.0 && least > LOAD_MAX * processors)
}

fn answer(frame: &Frame) -> Option<Finding> {
    let frames = frames(frame);
    let ratios = ratios(&frame.run.timings);
    let axes = key_axes(frames.iter().map(|one| &one.key));
    let indices: Vec<usize> = axes.iter().filter_map(|name| index_of(name)).collect();
    let mut table = Table::new(&indices, QUESTION.columns);
    for one in &frames {
        let own: Vec<&Ratio> = ratios.iter().filter(|ratio| std::ptr::eq(ratio.sampled, one.record)).collect();
        let over: Vec<Option<&Ratio>> = if own.is_empty() { vec![None] } else { own.into_iter().map(Some).collect() };
        for ratio in over {
            let [width, height] = one.record.environment_size;
            let mut row = key_cells(&one.key, &axes);
            row.extend([
                Cell::Text(format!("{width}x{height}")),
                Cell::Integer(one.summary.n as u64),
                one.summary.median.into(),
            ]);
            row.extend(ends(one.summary.interval));
            row.push(ratio.map_or(Cell::Missing, |ratio| Cell::Text(way(&ratio.fixed.key()))));
            row.push(ratio.map(|ratio| ratio.ratio).into());
            row.extend(ratio.map_or([Cell::Missing, Cell::Missing], |ratio| ends(ratio.interval)));
            row.push(ratio.map_or(Cell::Missing, |ratio| Cell::Text(ratio.verdict.to_string())));
            row.push(one.record.wall_check().into());
            row.extend([load(one.record), processors(frame)].map(Cell::from));
            row.extend([one.record.device.as_str(), one.record.device_type.as_str()].map(Cell::from));
            table.row(row);
        }
    }
    Some(Finding {
        sentence: sentence(frame, &frames, &ratios)?,
        table,
        digest: Some(digest(&frames, &ratios)),
        figure: figure(frame, &frames, &axes),
    })
}

/// The smallest and the largest of numbers: "5.1" or "5.1 to 6.0".
pub(super) fn range(values: impl Iterator<Item = f64> + Clone) -> String {
    let [lo, hi] = [values.clone().fold(f64::INFINITY, f64::min), values.fold(0.0, f64::max)].map(number);
    if lo == hi { lo } else { format!("{lo} to {hi}") }
}

/// "(95 % 1.0 to 1.2)" of a single interval, or why there is none.
fn interval_words(interval: [f64; 2]) -> String {
    match interval.iter().any(|end| end.is_nan()) {
        true => format!(" ({TOO_FEW_ROUNDS})"),
        false => format!(" (95 % {} to {})", number(interval[0]), number(interval[1])),
    }
}

fn sentence(frame: &Frame, frames: &[Timed], ratios: &[Ratio]) -> Option<String> {
    let ways = distinct_in_order(frames.iter().map(|one| way(&one.key)).filter(|way| way != "none"));
    let of = |wanted: &str| frames.iter().filter(|one| way(&one.key) == wanted).collect::<Vec<_>>();
    let base = ways.first()?;
    let ms = |way: &str| match of(way).as_slice() {
        [only] => format!("{} ms{}", number(only.summary.median), interval_words(only.summary.interval)),
        several => format!("{} ms", range(several.iter().map(|one| one.summary.median))),
    };
    // Against the last method of most samples: the costliest.
    let pair = ratios.iter().rfind(|ratio| way(&ratio.fixed.key()) == *base);
    let Some(pair) = pair else {
        return Some(format!("A frame of `{base}` takes {}{}.{}", ms(base), device(frame), busy(frame, frames)));
    };
    let other = way(&pair.sampled.key());
    let own = || ratios.iter().filter(|ratio| way(&ratio.fixed.key()) == *base && way(&ratio.sampled.key()) == other);
    let times = match own().count() {
        1 => format!("{} times as long{}", number(pair.ratio), interval_words(pair.interval)),
        _ => format!("{} times as long", range(own().map(|ratio| ratio.ratio))),
    };
    Some(format!(
        "A frame of `{base}` takes {}, one of `{other}` {}{}. Timed in the same rounds, `{other}` takes {times}.{}",
        ms(base),
        ms(&other),
        device(frame),
        busy(frame, frames)
    ))
}

fn device(frame: &Frame) -> &'static str {
    if QUESTION.rests_on_cpu_times(frame) { " on this CPU driver" } else { "" }
}

fn busy(frame: &Frame, frames: &[Timed]) -> &'static str {
    if was_busy(frame, frames) { " The host was busy: time again on a quiet one." } else { "" }
}

/// One row a way of making a frame.
fn digest(frames: &[Timed], ratios: &[Ratio]) -> Table {
    let names = ["method", "configurations", "ms a frame", "95 %", "times as long", "as", "95 %", "host's time"];
    let mut table = Table::with_names(names.map(str::to_owned).to_vec());
    let interval = |ends: &mut dyn Iterator<Item = [f64; 2]>| match ends.next() {
        Some(only) if ends.next().is_none() => {
            interval_words(only).trim().trim_matches(['(', ')']).replace("95 % ", "")
        }
        _ => String::new(),
    };
    for name in distinct_in_order(frames.iter().map(|one| way(&one.key))) {
        let own = || frames.iter().filter(|one| way(&one.key) == name);
        let bad = own().filter(|one| one.record.wall_check() != "ok").count();
        let checked = if bad == 0 {
            "agrees".to_owned()
        } else {
            format!("disagrees in {}", percent(bad as f64 / own().count() as f64))
        };
        let of_ratio = || ratios.iter().filter(|ratio| way(&ratio.sampled.key()) == name);
        let mut bases = distinct_in_order(of_ratio().map(|ratio| way(&ratio.fixed.key())));
        if bases.is_empty() {
            bases.push(String::new());
        }
        for base in bases {
            let pairs = || of_ratio().filter(|ratio| way(&ratio.fixed.key()) == base);
            let times = if base.is_empty() { String::new() } else { range(pairs().map(|pair| pair.ratio)) };
            table.row(vec![
                Cell::Text(name.clone()),
                Cell::Integer(own().count() as u64),
                Cell::Text(range(own().map(|one| one.summary.median))),
                Cell::Text(interval(&mut own().map(|one| one.summary.interval))),
                Cell::Text(times),
                Cell::Text(base.clone()),
                Cell::Text(interval(&mut pairs().map(|pair| pair.interval))),
                Cell::Text(checked.clone()),
            ]);
        }
    }
    table
}

/// One bar a configuration.
fn figure(frame: &Frame, frames: &[Timed], axes: &[&str]) -> Option<Figure> {
    let places = distinct_in_order(frames.iter().map(|one| place(&one.key, axes)));
    let name =
        |one: &Timed| format!("{} · {}", way(&one.key), place(&one.key, axes)).trim_end_matches(" · ").to_owned();
    let mut marks = Vec::new();
    for (y, one) in frames.iter().enumerate() {
        let (y, series) = (y as f64, places.iter().position(|known| *known == place(&one.key, axes))?);
        let tip = format!("{}: {} ms{}", name(one), number(one.summary.median), interval_words(one.summary.interval));
        let bar = Form::HorizontalBar { y, base: 0.0, to: one.summary.median };
        marks.push(Mark::new(bar, series).tip(tip).cell(&one.record.cell));
        if let [lo, hi] = one.summary.interval
            && lo.is_finite()
        {
            marks.push(Mark::neutral(Form::Whisker([lo, y], [hi, y])));
        }
    }
    let longest = frames.iter().map(|one| one.summary.interval[1].max(one.summary.median));
    let first = frames.first()?;
    let on = if QUESTION.rests_on_cpu_times(frame) { " (a CPU driver: nothing about a GPU)" } else { "" };
    Some(Figure {
        title: "Time of a frame".to_owned(),
        note: format!("median over {} rounds with its 95 % interval, {}{on}", first.summary.n, first.record.device),
        panels: vec![Panel {
            title: String::new(),
            x: Scale::linear("ms", longest.chain([0.0]))?,
            y: Scale::steps("", frames.iter().map(name).collect()),
            marks,
        }],
        series: places
            .into_iter()
            .map(|name| Series { name: if name.is_empty() { "frame".to_owned() } else { name }, is_dashed: false })
            .collect(),
        ramp: None,
    })
}
