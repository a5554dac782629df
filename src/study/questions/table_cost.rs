//! What do the tables of a method cost once, and after how many frames are they paid back?
//!
//! Passes that make tables run once for each map and model; the time of a pass is the median over rounds. Let T be what the tables of a
//! method without samples cost beyond those of a sampling one with the same parameters, f its frame time and r the ratio of the
//! other's to it. A frame saves (r - 1) f, so the tables are paid back after ceil(T / ((r - 1) f)) frames; the interval is that of r. Where
//! the interval of r does not say whose frames are faster there is no such number. Sets of tables made with other parameters are
//! alternatives: their times are a range and never a sum.

use super::frame_time::{ends, key_axes, key_cells, map_size, text, way};
use super::prelude::*;
use super::{DEVICE, DEVICE_TYPE, MAP_SIZE, MS_HI};
use crate::run::timing::{Key, PRECOMPUTE, TimingRecord, summarize};
use crate::run::timing_ratios::{Payback, Ratio, TableCost, ratios};
use crate::shade::METHODS;

pub const QUESTION: Question = Question {
    name: "table-cost",
    asks: "What do the tables cost once, and after how many frames are they paid back?",
    columns: &[
        MAP_SIZE,
        column(
            "pass",
            "A pass that makes a table, or `all`: all passes beyond those of the sampling method in `over`.",
        ),
        column("ms", "Its time in milliseconds, once, the median over rounds."),
        column("ms_lo", "Lower end of its 95 % interval; empty below six rounds and for `all`."),
        MS_HI,
        column("over", "The sampling method, with its sample count, that the tables are paid back against."),
        column("payback_frames", "Frames after which the tables are paid back; empty where that is not known."),
        column("payback_frames_lo", "Lower end of its 95 % interval, that of the ratio of frame times."),
        column("payback_frames_hi", super::UPPER),
        column("payback", "`paid back`, `never` (its frames are slower), or why it is not decided."),
        DEVICE,
        DEVICE_TYPE,
    ],
    uses_times: true,
    uses_costs: false,
    lacks,
    answer,
};

fn lacks(shape: &Shape) -> Option<&'static str> {
    match () {
        () if !shape.has_timing => Some("the experiment has no [timing]"),
        () if !shape.methods().any(|method| method.uses_prefiltered() || method.uses_dfg) => {
            Some("axes.method has no method with tables")
        }
        () => None,
    }
}

fn answer(frame: &Frame) -> Option<Finding> {
    let is_set = |record: &&TimingRecord| record.phase == PRECOMPUTE && !record.passes.is_empty();
    let mut sets: Vec<&TimingRecord> = frame.run.timings.iter().filter(is_set).collect();
    // A table's sample count is an axis of its own; the method's belongs to `over`.
    let axes = key_axes(&sets.iter().map(|record| record.key()).collect::<Vec<_>>());
    let axes: Vec<usize> = axes.into_iter().filter(|axis| *axis != SAMPLES).collect();
    let mut table = Table::new(&axes, QUESTION.columns);
    for (record, pass) in sets.iter().flat_map(|record| record.passes.iter().map(move |pass| (record, pass))) {
        let summary = summarize(&pass.ms);
        let mut row = key_cells(&record.key(), &axes);
        row.extend(cells![map_size(record), pass.pass.as_str(), summary.median]);
        row.extend(ends(summary.interval).into_iter().chain(vec![Cell::Missing; 5]));
        row.extend(cells![record.device.as_str(), record.device_type.as_str()]);
        table.row(row);
    }
    let ratios: Vec<Ratio> = ratios(&frame.run.timings).into_iter().filter(Ratio::has_payback).collect();
    for (pair, tables) in ratios.iter().flat_map(|pair| pair.tables.iter().map(move |tables| (pair, tables))) {
        table.row(payback_row(pair, tables, &axes));
    }
    // Methods without samples first.
    let draws = |name: &str| METHODS.iter().any(|method| method.name == name && method.uses_samples);
    sets.sort_by_key(|record| draws(text(&record.axes, METHOD)));
    let methods = grouped(sets, |record| text(&record.axes, METHOD).to_owned());
    let (lead, own) = methods.first()?;
    let digest = digest(&methods, &ratios);
    Some(Finding {
        sentence: sentence(frame, &digest, lead),
        table,
        figure: figure(frame, own, lead),
        digest: Some(digest),
    })
}

fn payback_row(pair: &Ratio, tables: &TableCost, axes: &[usize]) -> Vec<Cell> {
    let mut key: Key = tables.key.clone();
    key.insert(AXES[METHOD].name.to_owned(), text(&pair.fixed.axes, METHOD).to_owned());
    let (frames, interval, words) = match tables.payback {
        Payback::Frames { count, interval } => (Some(count), interval, "paid back".to_owned()),
        other => (None, [f64::NAN; 2], why(other)),
    };
    let ms = Some(tables.ms).filter(|ms| ms.is_finite());
    let mut row = key_cells(&key, axes);
    row.extend(cells![map_size(pair.fixed), "all", ms, None::<f64>, None::<f64>, way(&pair.sampled.key()), frames]);
    row.extend(ends(interval));
    row.extend(cells![words, pair.fixed.device.as_str(), pair.fixed.device_type.as_str()]);
    row
}

fn why(payback: Payback) -> String {
    if payback == Payback::NotTimed { "the tables were not timed".to_owned() } else { payback.to_string() }
}

/// The levels of a prefiltered map are passes of their own, "prefilter mip 2": they count together.
fn kind(pass: &str) -> &str {
    pass.split(' ').next().unwrap_or_default()
}

/// One row a method and kind of pass, and one a sampling way that the tables are paid back against.
fn digest(methods: &[(String, Vec<&TimingRecord>)], ratios: &[Ratio]) -> Table {
    let mut table = Table::with_names(["tables of", "pass", "ms once", "paid back against", "frames"]);
    let none = None::<String>;
    for (method, sets) in methods {
        // Kinds, in the order of the passes, with their times in each set.
        let passes = sets.iter().flat_map(|record| record.passes.iter().map(move |pass| (record.key(), pass)));
        let kinds = grouped(passes, |(_, pass)| kind(&pass.pass).to_owned());
        let ms = |own: Vec<(Key, f64)>| {
            let sets = grouped(own, |(key, _)| format!("{key:?}"));
            range(sets.iter().map(|(_, own)| own.iter().map(|(_, ms)| ms).sum::<f64>()))
        };
        let median =
            |(key, pass): &(Key, &crate::run::timing::PassSamples)| (key.clone(), summarize(&pass.ms).median);
        let all = kinds.iter().flat_map(|(_, own)| own.iter().map(median)).collect();
        table.row(cells![method.as_str(), "all", ms(all), none.clone(), none.clone()]);
        for (kind, own) in &kinds {
            table.row(cells![
                method.as_str(),
                kind.as_str(),
                ms(own.iter().map(median).collect()),
                none.clone(),
                none.clone()
            ]);
        }
        // Most samples first.
        let mut own: Vec<&Ratio> = ratios.iter().filter(|pair| text(&pair.fixed.axes, METHOD) == method).collect();
        own.sort_by_key(|pair| std::cmp::Reverse(text(&pair.sampled.axes, SAMPLES).parse::<u32>().ok()));
        for (over, pairs) in grouped(own, |pair| way(&pair.sampled.key())) {
            let paybacks = pairs.iter().flat_map(|pair| &pair.tables).map(|tables| tables.payback);
            // One that is not decided leaves the whole open.
            let counts: Result<Vec<f64>, Payback> = paybacks.map(|one| one.frames().ok_or(one)).collect();
            let frames = counts.map_or_else(why, |counts| {
                let least = counts.iter().copied().fold(f64::INFINITY, f64::min);
                let most = counts.iter().copied().fold(0.0, f64::max);
                if least == most { least.to_string() } else { format!("{least} to {most}") }
            });
            table.row(cells![method.as_str(), "all", none.clone(), over, frames]);
        }
    }
    table
}

fn sentence(frame: &Frame, digest: &Table, method: &str) -> String {
    let text = |row: &[Cell], column: usize| crate::study::table::shown(&row[column]);
    let mut own = digest.rows.iter().filter(|row| text(row, 0) == method);
    let ms = own.next().map_or_else(String::new, |row| text(row, 2));
    let paid = own.find(|row| !text(row, 3).is_empty()).map(|row| (text(row, 3), text(row, 4)));
    let end = paid.map_or_else(String::new, |(over, frames)| match frames.chars().next() {
        Some(digit) if digit.is_ascii_digit() => format!(" Against `{over}` they are paid back after {frames} frames."),
        _ => format!(" When they are paid back against `{over}`: {frames}."),
    });
    format!("The tables of `{method}` cost {ms} ms once for each map and model{}.{end}", frame.cpu_words())
}

/// One bar a pass of the leading method, over its sets of tables the longest.
fn figure(frame: &Frame, sets: &[&TimingRecord], method: &str) -> Option<Figure> {
    let passes = grouped(sets.iter().flat_map(|record| &record.passes), |pass| pass.pass.clone());
    let bar = |(y, (name, own)): (usize, &(String, Vec<_>))| {
        let ms: Vec<f64> =
            own.iter().map(|pass: &&crate::run::timing::PassSamples| summarize(&pass.ms).median).collect();
        let longest = ms.iter().copied().fold(0.0, f64::max);
        Mark::new(Form::HorizontalBar { y: y as f64, base: 0.0, to: longest }, 0)
            .tip(format!("{name}: {} ms", range(ms)))
    };
    Chart {
        title: &format!("What the tables of {method} cost once"),
        note: format!("median over rounds, of several sets of tables the longest{}", frame.cpu_words()),
        x: Along::Linear("ms"),
        y: Along::Steps("", passes.iter().map(|(name, _)| name.clone()).collect()),
        panels: vec![(String::new(), passes.iter().enumerate().map(bar).collect())],
        series: vec!["pass".to_owned()],
    }
    .figure()
}
