//! What a frame and the tables behind it take.

use super::{Answer, ERROR_DIGITS, TIME_DIGITS, sentence_case};
use crate::runner::statistics::{TOO_FEW_ROUNDS, median};
use crate::runner::timing::{Key, swept_axes};
use crate::runner::timing_ratios::{Payback, interval_words};
use crate::study::answers::Answers;
use crate::study::answers::study::{FrameTime, Row, Study};
use crate::study::answers::table_times::TableTime;
use crate::study::answers::times::FrameRatio;
use crate::table::markdown::significant;
use std::collections::{BTreeMap, BTreeSet};

/// Median frame time of a method at a sample count (empty for none) over the cells that were timed, ms.
fn frame_ms(study: &Study, method: &str, samples: &str) -> Option<f64> {
    let of_method = |row: &&Row| study.value(row, "method") == method && study.value(row, "samples") == samples;
    let times = study.images().into_iter().filter(of_method).filter_map(|row: &Row| row.frame_ms);
    let mut medians: Vec<f64> = times.map(|time: FrameTime| time.median).collect();
    medians.sort_by(f64::total_cmp);
    medians.get(medians.len() / 2).copied()
}

/// What a frame costs at break-even against the method without samples.
pub(super) fn time_fact(study: &Study, answers: &Answers, sampled: &str, samples: u32, fixed: &str) -> Option<String> {
    let samples = samples.to_string();
    let (at_break_even, without) = (frame_ms(study, sampled, &samples)?, frame_ms(study, fixed, "")?);
    Some(format!(
        "A frame then takes {} ms against {} ms for {fixed}, medians over what was timed{}.",
        significant(at_break_even, TIME_DIGITS),
        significant(without, TIME_DIGITS),
        ratio_words(answers, sampled, &samples, fixed).map_or_else(String::new, |(_, words)| format!("; {words}"))
    ))
}

/// Median and words of the ratios of frame times, each taken pair by pair in the same rounds: it is not the quotient of the medians that stand
/// beside it, and the words say so.
fn ratio_words(answers: &Answers, sampled: &str, samples: &str, fixed: &str) -> Option<(f64, String)> {
    let is_it = |ratio: &&FrameRatio| ratio.sampled == sampled && ratio.samples == samples && ratio.fixed == fixed;
    let own: Vec<&FrameRatio> = answers.frame_ratios.iter().filter(is_it).collect();
    let range = |of: &dyn Fn(&FrameRatio) -> [f64; 2]| {
        let ends =
            own.iter().map(|ratio| of(ratio)).fold([f64::INFINITY, 0.0f64], |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        ends.map(|end| significant(end, ERROR_DIGITS)).join(" to ")
    };
    let middle = median(&own.iter().map(|ratio| ratio.ratio).collect::<Vec<_>>());
    let is_unknown = own.iter().any(|ratio| ratio.interval[0].is_nan());
    let words = match own.len() {
        0 => return None,
        1 => {
            let times = significant(middle, ERROR_DIGITS);
            let interval = interval_words(own[0].interval, ERROR_DIGITS);
            format!(
                "round by round it takes {times} times as long ({}{interval})",
                if is_unknown { "" } else { "95 % " }
            )
        }
        count => format!(
            "round by round it takes {} times as long in {count} configurations, {} in the middle one, {}",
            range(&|ratio| [ratio.ratio; 2]),
            significant(middle, ERROR_DIGITS),
            match is_unknown {
                true => TOO_FEW_ROUNDS.to_owned(),
                false => format!("and the 95 % intervals reach from {}", range(&|ratio| ratio.interval)),
            }
        ),
    };
    Some((middle, words))
}

/// Where methods were timed but too few sample counts tried to break even: what a frame costs with each.
pub(super) fn from_times(study: &Study, answers: &Answers) -> Option<Answer> {
    let mut ways: Vec<(&str, &str)> = Vec::new();
    for row in study.rows.iter().filter(|row| row.frame_ms.is_some()) {
        let way = (study.value(row, "method"), study.value(row, "samples"));
        if way.0 != "none" && !ways.contains(&way) {
            ways.push(way);
        }
    }
    let fixed = ways.iter().find(|way| way.1.is_empty())?;
    let without = frame_ms(study, fixed.0, "")?;
    let mut ratios = ways.iter().filter(|way| !way.1.is_empty()).filter_map(|(method, samples)| {
        let ms = frame_ms(study, method, samples)?;
        let (ratio, words) = ratio_words(answers, method, samples, fixed.0)?;
        let sentence = format!(
            "A frame of {method} with {samples} samples takes {} ms against {} ms for {}, medians over what was timed; {words}",
            significant(ms, TIME_DIGITS),
            significant(without, TIME_DIGITS),
            fixed.0
        );
        let ratio = significant(ratio, ERROR_DIGITS);
        Some((ratio, format!("frame time of {method} with {samples} samples over that of {}", fixed.0), sentence))
    });
    let (ratio, unit, sentence) = ratios.next()?;
    let further: Vec<String> = ratios.map(|(_, _, sentence)| sentence + ".").collect();
    let tables = tables_words(answers, fixed.0);
    let sentence = match (&tables, payback_words(answers, fixed.0)) {
        (Some(tables), Some(payback)) => format!("{sentence}; {tables}, {payback}."),
        (Some(tables), None) => format!("{sentence}; {tables}."),
        (None, _) => sentence + ".",
    };
    let sampled: BTreeSet<&str> = ways.iter().filter(|way| !way.1.is_empty()).map(|way| way.0).collect();
    let others = sampled.into_iter().filter_map(|method| Some(sentence_case(&tables_words(answers, method)?) + "."));
    Some(Answer {
        number: format!("×{ratio}"),
        unit,
        sentence,
        facts: further.into_iter().chain(level_words(answers, fixed.0)).chain(others).collect(),
    })
}

/// The smallest and the largest of some times.
fn range_ms(medians: &[f64]) -> String {
    let (lo, hi) = medians.iter().fold((f64::INFINITY, 0.0f64), |(lo, hi), ms| (lo.min(*ms), hi.max(*ms)));
    let [lo, hi] = [lo, hi].map(|ms| significant(ms, TIME_DIGITS));
    if lo == hi { format!("{lo} ms") } else { format!("{lo} to {hi} ms") }
}

/// ", by prefilter_sample_count": what the sets of tables of a method differ in beside the models and maps they are made for; empty for nothing.
fn by_swept<'t>(times: impl IntoIterator<Item = &'t TableTime>) -> String {
    // The image's size is none of theirs.
    let is_parameter = |name: &&str| !["brdf", "method", "diffuse", "size"].contains(name);
    let swept = swept_axes(times.into_iter().map(|time| &time.key));
    let names: Vec<&str> = swept.into_iter().filter(is_parameter).collect();
    if names.is_empty() { String::new() } else { format!(", by {}", names.join(" and ")) }
}

/// What the tables of a method cost once, pass by pass, each with the smallest and largest median over the sets of tables that were timed.
fn tables_words(answers: &Answers, method: &str) -> Option<String> {
    // The levels of a prefiltered map are passes of their own, "prefilter mip 2": here they count together.
    let mut kinds: Vec<&str> = Vec::new();
    let mut sums: BTreeMap<(&str, [u32; 2], &Key), BTreeMap<&str, f64>> = BTreeMap::new();
    let own = || answers.table_times.iter().filter(|time| time.axis("method") == method);
    for time in own() {
        let kind = time.pass.split(' ').next().unwrap_or_default();
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
        let own = sums.entry((&time.run, time.environment_size, &time.key)).or_default();
        *own.entry(kind).or_default() += time.ms.median;
    }
    let all: Vec<f64> = sums.values().map(|of_kind| of_kind.values().sum()).collect();
    let of = |kind: &&str| {
        let medians: Vec<f64> = sums.values().filter_map(|of_kind| of_kind.get(kind).copied()).collect();
        format!("{kind} {}", range_ms(&medians))
    };
    let words: Vec<String> = kinds.iter().map(of).collect();
    (!kinds.is_empty()).then(|| {
        let of_kinds = if words.len() > 1 { format!(" ({})", words.join(", ")) } else { String::new() };
        let swept = by_swept(own());
        let once = if swept.is_empty() { " once" } else { ", once" };
        format!("the tables of {method} cost {}{swept}{once} for each map and model{of_kinds}", range_ms(&all))
    })
}

/// What each level of the prefiltered map costs: the median over what was timed, or the range over maps of different parameters.
fn level_words(answers: &Answers, method: &str) -> Option<String> {
    let is_own = |time: &&TableTime| time.axis("method") == method && time.pass.contains(" mip ");
    let own = || answers.table_times.iter().filter(is_own);
    let swept = by_swept(own());
    let mut levels: Vec<&str> = Vec::new();
    for time in own().filter(|time| !time.pass.is_empty()) {
        if !levels.contains(&time.pass.as_str()) {
            levels.push(&time.pass);
        }
    }
    let cost = |pass: &&str| {
        let medians: Vec<f64> = own().filter(|time| time.pass == **pass).map(|time| time.ms.median).collect();
        let ms = match swept.is_empty() {
            true => format!("{} ms", significant(median(&medians), TIME_DIGITS)),
            false => range_ms(&medians),
        };
        format!("{} {ms}", pass.replace("prefilter ", ""))
    };
    (!levels.is_empty()).then(|| {
        format!("Of the prefiltered map of {method} {}{swept}.", levels.iter().map(cost).collect::<Vec<_>>().join(", "))
    })
}

/// When a method has paid for its tables against the first sampling method it was timed with.
fn payback_words(answers: &Answers, fixed: &str) -> Option<String> {
    let first = answers.frame_ratios.iter().find(|ratio| ratio.fixed == fixed)?;
    let own = answers.frame_ratios.iter().filter(|ratio| {
        (&ratio.fixed, &ratio.sampled, &ratio.samples) == (&first.fixed, &first.sampled, &first.samples)
    });
    let mut ends: Vec<[f64; 3]> = Vec::new();
    for payback in own.flat_map(|ratio| &ratio.paybacks) {
        match *payback {
            Payback::Frames { count, interval: [lo, hi] } => ends.push([lo, count, hi]),
            Payback::NotTimed | Payback::NotAsked => return None,
            Payback::Never => return Some("which its slower frames never pay back".to_owned()),
            Payback::NotDecided(why) => return Some(format!("and when they are paid back is not decided: {why}")),
        }
    }
    let least = |k: usize| ends.iter().map(|end| end[k]).fold(f64::INFINITY, f64::min);
    let most = |k: usize| ends.iter().map(|end| end[k]).fold(0.0, f64::max);
    let counts = if least(1) == most(1) { least(1).to_string() } else { format!("{} to {}", least(1), most(1)) };
    Some(format!("paid back after {counts} frames (95 % {} to {})", least(0), most(2)))
}
