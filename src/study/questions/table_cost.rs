//! What do the tables of a method cost once, and after how many frames are they paid back?
//!
//! Passes that make tables run once for each map and model; the time of a pass is the median over rounds. Let T be what the tables of a
//! method without samples cost beyond those of a sampling one with the same parameters, f its frame time and r the ratio of the
//! other's to it. A frame saves (r - 1) f, so the tables are paid back after ceil(T / ((r - 1) f)) frames; the interval is that of r. Where
//! the interval of r does not say whose frames are faster there is no such number. Sets of tables made with other parameters are
//! alternatives: their times are a range and never a sum.

use super::frame_time::{ends, key_axes, key_cells, range, text, way};
use super::{Finding, Question};
use crate::runner::axis::index_of;
use crate::runner::timing::{Key, PRECOMPUTE, TimingRecord, summarize};
use crate::runner::timing_ratios::{Payback, Ratio, TableCost, ratios};
use crate::study::figure::{Figure, Mark, Panel, Scale, Series, Shape as Form};
use crate::study::frame::{Frame, Shape, distinct_in_order};
use crate::study::table::{Column, Table};
use crate::table::csv::Cell;

pub const QUESTION: Question = Question {
    name: "table-cost",
    asks: "What do the tables cost once, and after how many frames are they paid back?",
    columns: &[
        Column { name: "environment_size", about: "Width and height of the environment's map." },
        Column {
            name: "pass",
            about: "A pass that makes a table, or `all`: all passes beyond those of the sampling method in `over`.",
        },
        Column { name: "ms", about: "Its time in milliseconds, once, the median over rounds." },
        Column { name: "ms_lo", about: "Lower end of its 95 % interval; empty below six rounds and for `all`." },
        Column { name: "ms_hi", about: "Upper end of that interval." },
        Column {
            name: "over",
            about: "The sampling method, with its sample count, that the tables are paid back against.",
        },
        Column {
            name: "payback_frames",
            about: "Frames after which the tables are paid back; empty where that is not known.",
        },
        Column {
            name: "payback_frames_lo",
            about: "Lower end of its 95 % interval, that of the ratio of frame times.",
        },
        Column { name: "payback_frames_hi", about: "Upper end of that interval." },
        Column { name: "payback", about: "`paid back`, `never` (its frames are slower), or why it is not decided." },
        Column { name: "device", about: "The device that was timed." },
        Column { name: "device_type", about: "Its type; times of a `cpu` say nothing about a GPU." },
    ],
    uses_times: true,
    lacks,
    answer,
};

fn lacks(shape: &Shape) -> Option<&'static str> {
    let needs_tables = crate::shade::METHODS.iter().filter(|method| method.uses_prefiltered || method.uses_dfg);
    match () {
        () if !shape.has_timing => Some("the experiment has no [timing]"),
        () if !needs_tables.into_iter().any(|method| shape.has("method", &[method.name])) => {
            Some("axes.method has no method with tables")
        }
        () => None,
    }
}

/// Methods in words, those without samples first.
fn methods(sets: &[&TimingRecord]) -> Vec<String> {
    let mut names = distinct_in_order(sets.iter().map(|record| text(&record.axes, "method").to_owned()));
    let draws = |name: &String| crate::shade::METHODS.iter().any(|method| method.name == name && method.uses_samples);
    names.sort_by_key(|name| draws(name));
    names
}

fn answer(frame: &Frame) -> Option<Finding> {
    let is_set = |record: &&TimingRecord| record.phase == PRECOMPUTE && !record.passes.is_empty();
    let sets: Vec<&TimingRecord> = frame.run.timings.iter().filter(is_set).collect();
    let ratios = ratios(&frame.run.timings);
    let keys: Vec<Key> = sets.iter().map(|record| record.key()).collect();
    // A table's sample count is an axis of its own; the method's belongs to `over`.
    let axes: Vec<&str> = key_axes(&keys).into_iter().filter(|name| *name != "samples").collect();
    let indices: Vec<usize> = axes.iter().filter_map(|name| index_of(name)).collect();
    let mut table = Table::new(&indices, QUESTION.columns);
    for (record, key) in sets.iter().zip(&keys) {
        for pass in &record.passes {
            let summary = summarize(&pass.ms);
            let mut row = key_cells(key, &axes);
            row.extend([Cell::Text(size(record)), pass.pass.as_str().into(), summary.median.into()]);
            row.extend(ends(summary.interval));
            row.extend(vec![Cell::Missing; 5]);
            row.extend([record.device.as_str(), record.device_type.as_str()].map(Cell::from));
            table.row(row);
        }
    }
    let paid = || ratios.iter().filter(|pair| pair.has_payback());
    for (pair, tables) in paid().flat_map(|pair| pair.tables.iter().map(move |tables| (pair, tables))) {
        table.row(payback_row(pair, tables, &axes));
    }
    let methods = methods(&sets);
    let lead = methods.first()?;
    Some(Finding {
        sentence: sentence(frame, &sets, &ratios, lead),
        table,
        digest: Some(digest(&sets, &ratios, &methods)),
        figure: figure(frame, &sets, lead),
    })
}

fn size(record: &TimingRecord) -> String {
    let [width, height] = record.environment_size;
    format!("{width}x{height}")
}

fn payback_row(pair: &Ratio, tables: &TableCost, axes: &[&str]) -> Vec<Cell> {
    let mut key = tables.key.clone();
    key.insert("method".to_owned(), text(&pair.fixed.axes, "method").to_owned());
    let (frames, interval, words) = match tables.payback {
        Payback::Frames { count, interval } => (Some(count), interval, "paid back".to_owned()),
        other => (None, [f64::NAN; 2], payback_words(other)),
    };
    let mut row = key_cells(&key, axes);
    row.extend([Cell::Text(size(pair.fixed)), "all".into()]);
    row.push(Some(tables.ms).filter(|ms| ms.is_finite()).into());
    row.extend([Cell::Missing, Cell::Missing, Cell::Text(way(&pair.sampled.key())), frames.into()]);
    row.extend(ends(interval));
    row.push(Cell::Text(words));
    row.extend([pair.fixed.device.as_str(), pair.fixed.device_type.as_str()].map(Cell::from));
    row
}

fn payback_words(payback: Payback) -> String {
    match payback {
        Payback::NotTimed => "the tables were not timed".to_owned(),
        other => other.to_string(),
    }
}

/// The levels of a prefiltered map are passes of their own, "prefilter mip 2": they count together.
fn kind(pass: &str) -> &str {
    pass.split(' ').next().unwrap_or_default()
}

/// Time of the passes of one kind in one set of tables, or of all; nothing where it has none.
fn kind_ms(record: &TimingRecord, wanted: Option<&str>) -> Option<f64> {
    let own = record.passes.iter().filter(|pass| wanted.is_none_or(|wanted| kind(&pass.pass) == wanted));
    own.map(|pass| summarize(&pass.ms).median).reduce(|a, b| a + b)
}

/// Each kind of pass of a method with its range over the sets of tables, in the order of the passes; nothing first for the sum.
fn kinds(sets: &[&TimingRecord], method: &str) -> Vec<(String, String)> {
    let own = || sets.iter().filter(|record| text(&record.axes, "method") == method);
    let names =
        distinct_in_order(own().flat_map(|record| record.passes.iter().map(|pass| kind(&pass.pass).to_owned())));
    let ms = |wanted: Option<&str>| {
        let all: Vec<f64> = own().filter_map(|record| kind_ms(record, wanted)).collect();
        range(all.into_iter())
    };
    std::iter::once(("all".to_owned(), ms(None)))
        .chain(names.into_iter().map(|name| (name.clone(), ms(Some(&name)))))
        .collect()
}

/// When a method has paid for its tables against a sampling way: frames and their interval, or why there is no number. Over several
/// configurations the range of all; one that is not decided leaves the whole open.
fn payback(ratios: &[Ratio], method: &str, over: &str) -> Option<Result<(String, String), String>> {
    let own =
        || ratios.iter().filter(|pair| text(&pair.fixed.axes, "method") == method && way(&pair.sampled.key()) == over);
    let all: Vec<Payback> = own().flat_map(|pair| pair.tables.iter().map(|tables| tables.payback)).collect();
    let frames = |payback: &Payback| match *payback {
        Payback::Frames { count, interval } => Ok((count, interval)),
        other => Err(payback_words(other)),
    };
    let found: Result<Vec<(f64, [f64; 2])>, String> = all.iter().map(frames).collect();
    let of = |found: Vec<(f64, [f64; 2])>| {
        let whole = |number: f64| format!("{number}");
        let least = |of: fn(&(f64, [f64; 2])) -> f64| found.iter().map(of).fold(f64::INFINITY, f64::min);
        let most = |of: fn(&(f64, [f64; 2])) -> f64| found.iter().map(of).fold(0.0, f64::max);
        let (lo, hi) = (least(|one| one.0), most(|one| one.0));
        let frames = if lo == hi { whole(lo) } else { format!("{} to {}", whole(lo), whole(hi)) };
        (frames, format!("{} to {}", whole(least(|one| one.1[0])), whole(most(|one| one.1[1]))))
    };
    (!all.is_empty()).then(|| found.map(of))
}

/// Sampling ways that a method's tables are paid back against.
fn rivals(ratios: &[Ratio], method: &str) -> Vec<String> {
    let own = ratios.iter().filter(|pair| pair.has_payback() && text(&pair.fixed.axes, "method") == method);
    let mut ways = distinct_in_order(own.map(|pair| way(&pair.sampled.key())));
    let samples = |way: &String| way.rsplit(' ').next().and_then(|n| n.parse::<u32>().ok());
    ways.sort_by_key(|way| std::cmp::Reverse(samples(way)));
    ways
}

fn sentence(frame: &Frame, sets: &[&TimingRecord], ratios: &[Ratio], method: &str) -> String {
    let on = if QUESTION.rests_on_cpu_times(frame) { " on this CPU driver" } else { "" };
    let kinds = kinds(sets, method);
    let parts: Vec<String> = kinds.iter().skip(1).map(|(name, ms)| format!("{name} {ms}")).collect();
    let parts = if parts.len() > 1 { format!(" ({})", parts.join(", ")) } else { String::new() };
    let all = kinds.first().map_or("", |(_, ms)| ms);
    let mut text = format!("The tables of `{method}` cost {all} ms once for each map and model{on}{parts}.");
    for over in rivals(ratios, method).into_iter().take(1) {
        text += &match payback(ratios, method, &over) {
            Some(Ok((frames, _))) if frames == "0" => format!(" Beside `{over}` they cost nothing more."),
            Some(Ok((frames, interval))) => {
                format!(" Against `{over}` they are paid back after {frames} frames (95 % {interval}).")
            }
            Some(Err(why)) if why == Payback::Never.to_string() => {
                format!(" Against `{over}` they are never paid back: its frames are faster.")
            }
            Some(Err(why)) => format!(" When they are paid back against `{over}` is {why}."),
            None => String::new(),
        };
    }
    text
}

/// One row a method and kind of pass, and one a sampling way that the tables are paid back against.
fn digest(sets: &[&TimingRecord], ratios: &[Ratio], methods: &[String]) -> Table {
    let names = ["tables of", "pass", "ms once", "paid back against", "frames", "95 %"];
    let mut table = Table::with_names(names.map(str::to_owned).to_vec());
    for method in methods {
        for (pass, ms) in kinds(sets, method) {
            let texts = [method, &pass, &ms, "", "", ""];
            table.row(texts.map(|text| Cell::Text(text.to_owned())).to_vec());
        }
        for over in rivals(ratios, method) {
            let Some(found) = payback(ratios, method, &over) else { continue };
            let (frames, interval) = found.unwrap_or_else(|why| (why, String::new()));
            let texts = [method.clone(), "all".to_owned(), String::new(), over, frames, interval];
            table.row(texts.map(Cell::Text).to_vec());
        }
    }
    table
}

/// One bar a pass of the leading method, over its sets of tables the longest.
fn figure(frame: &Frame, sets: &[&TimingRecord], method: &str) -> Option<Figure> {
    let own = || sets.iter().filter(|record| text(&record.axes, "method") == method);
    let passes = distinct_in_order(own().flat_map(|record| record.passes.iter().map(|pass| pass.pass.clone())));
    let ms = |name: &String| -> Vec<f64> {
        let of_set = |record: &&&TimingRecord| {
            record.passes.iter().find(|pass| pass.pass == *name).map(|pass| summarize(&pass.ms).median)
        };
        own().filter_map(|record| of_set(&record)).collect()
    };
    let mut marks = Vec::new();
    for (y, name) in passes.iter().enumerate() {
        let (y, all) = (y as f64, ms(name));
        let (least, most) =
            (all.iter().copied().fold(f64::INFINITY, f64::min), all.iter().copied().fold(0.0, f64::max));
        let tip = format!("{name}: {} ms", range(all.into_iter()));
        marks.push(Mark::new(Form::HorizontalBar { y, base: 0.0, to: most }, 0).tip(tip));
        if least < most {
            marks.push(Mark::neutral(Form::Whisker([least, y], [most, y])));
        }
    }
    let on = if QUESTION.rests_on_cpu_times(frame) { "; a CPU driver: nothing about a GPU" } else { "" };
    Some(Figure {
        title: format!("What the tables of {method} cost once"),
        note: format!(
            "median over rounds; the longest of {}, the line from the shortest{on}",
            sets_words(own().count())
        ),
        panels: vec![Panel {
            title: String::new(),
            x: Scale::linear("ms", passes.iter().flat_map(ms).chain([0.0]))?,
            y: Scale::steps("", passes.clone()),
            marks,
        }],
        series: vec![Series { name: "pass".to_owned(), is_dashed: false }],
        ramp: None,
    })
}

fn sets_words(n: usize) -> String {
    super::words::count(n, "set of tables", "sets of tables")
}
