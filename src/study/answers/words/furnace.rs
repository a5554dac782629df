//! How much energy is lost, and what creates some.

use super::{Answer, ERROR_DIGITS, listed};
use crate::study::answers::furnace::Furnace;
use crate::study::answers::study::short;
use crate::study::answers::{Answers, key_label};
use crate::table::markdown::significant;

/// `12 %` of 0.12.
fn percent(share: f64) -> String {
    format!("{} %", significant(100.0 * share.abs(), ERROR_DIGITS))
}

/// The key without alpha, and alpha.
fn parted<'k>(answers: &Answers, one: &'k Furnace) -> (String, &'k str) {
    let alpha = answers.case_axes.iter().position(|name| name == "alpha");
    let kept = |of: &[String]| -> Vec<String> {
        of.iter().enumerate().filter(|(i, _)| Some(*i) != alpha).map(|(_, text)| text.clone()).collect()
    };
    let label = key_label(&kept(&answers.case_axes), &kept(&one.key)).replace(" · ", " ");
    (label, alpha.map_or("", |axis| one.key[axis].as_str()))
}

pub(super) fn from_furnace(answers: &Answers) -> Option<Answer> {
    let all = &answers.furnace;
    let mut alphas: Vec<&str> = all.iter().map(|one| parted(answers, one).1).collect();
    alphas.sort_by(|a, b| a.parse().unwrap_or(0.0f64).total_cmp(&b.parse().unwrap_or(0.0)));
    alphas.dedup();
    let at = |alpha: &str| {
        let own = all.iter().filter(|one| parted(answers, one).1 == alpha);
        let least = own.clone().max_by(|a, b| a.change.total_cmp(&b.change))?;
        let most = own.clone().min_by(|a, b| a.change.total_cmp(&b.change))?;
        // Of those that say the same number the first is named, and the others are counted.
        let named = |one: &Furnace| {
            let alike = own.clone().filter(|other| percent(other.change) == percent(one.change)).count() - 1;
            let others = if alike > 0 { format!(" and {alike} more") } else { String::new() };
            format!("{} ({}{others})", percent(one.change), parted(answers, one).0)
        };
        let [least, most] = [least, most].map(named);
        Some(match alpha {
            "" => format!("{least} to {most}"),
            _ => format!("{least} to {most} at alpha {}", short("alpha", alpha)),
        })
    };
    // The ends of the sweep stand for it; the facts have all of it.
    let ends: Vec<&str> = match alphas.as_slice() {
        [first, .., last] => vec![first, last],
        few => few.to_vec(),
    };
    let lost = listed(&ends.iter().filter_map(|alpha| at(alpha)).collect::<Vec<_>>());
    let half = all.iter().filter_map(|one| one.interval.map(|[lo, hi]| 0.5 * (hi - lo))).reduce(f64::max);
    let exactness = half.map_or_else(String::new, |half| format!(", each within ± {} (95 %)", percent(half)));
    let most = |one: &Furnace| one.extremes.map_or((f64::NEG_INFINITY, [0.0; 2]), |[_, most]| most);
    let mut creators: Vec<String> = Vec::new();
    for name in all.iter().filter(|one| most(one).0 > MEANT).map(|one| parted(answers, one).0) {
        if !creators.contains(&name) {
            creators.push(name);
        }
    }
    let strongest = all.iter().max_by(|a, b| most(a).0.total_cmp(&most(b).0))?;
    let created = match creators.len() {
        0 => format!("none creates more than {} at any n·v", percent(MEANT)),
        count => {
            let ((change, [lo, hi]), (name, alpha)) = (most(strongest), parted(answers, strongest));
            let at = if alpha.is_empty() { String::new() } else { format!("alpha {}, ", short("alpha", alpha)) };
            format!(
                "only {} {} any, up to {} ({name} at {at}n·v {lo} to {})",
                listed(&creators),
                if count == 1 { "creates" } else { "create" },
                percent(change),
                hi.min(1.0)
            )
        }
    };
    let worst = all.iter().min_by(|a, b| a.change.total_cmp(&b.change))?;
    // All that lose as much at the same alpha, to the digits that are shown.
    let is_tie = |one: &&Furnace| {
        percent(one.change) == percent(worst.change) && parted(answers, one).1 == parted(answers, worst).1
    };
    let ties: Vec<String> = all.iter().filter(is_tie).map(|one| parted(answers, one).0).collect();
    let at_alpha = match parted(answers, worst).1 {
        "" => String::new(),
        alpha => format!(" at alpha {}", short("alpha", alpha)),
    };
    let verb = if worst.change > 0.0 { "is created" } else { "is lost" };
    let (unit, tie) = match ties.as_slice() {
        [_, _, ..] => {
            let count = ties.len();
            let same = format!("{} {verb} by each of {}{at_alpha}.", percent(worst.change), listed(&ties));
            (format!("of the energy {verb} at most{at_alpha}, by {count} combinations alike"), Some(same))
        }
        _ => (format!("of the energy {verb} at most: {}{at_alpha}", parted(answers, worst).0), None),
    };
    let facts = creation(answers, &creators).into_iter().chain(tie).chain(losses(answers, &alphas));
    Some(Answer {
        number: percent(worst.change),
        unit,
        sentence: format!("In a white furnace one scattering loses {lost} of the energy{exactness}; {created}."),
        facts: facts.collect(),
    })
}

/// Where those that create energy do so, one sentence each.
fn creation(answers: &Answers, creators: &[String]) -> Vec<String> {
    let of = |name: &String| {
        let own = answers.furnace.iter().filter(|one| parted(answers, one).0 == *name);
        let gains: Vec<(&Furnace, f64, [f64; 2])> = own
            .filter_map(|one| {
                let (change, bin) = one.extremes.map(|[_, most]| most).filter(|most| most.0 > MEANT)?;
                Some((one, change, bin))
            })
            .collect();
        let view = |[lo, hi]: [f64; 2]| format!(" at n·v {lo} to {}", hi.min(1.0));
        // Bins that are the same everywhere are said once.
        let shared = gains.first().map(|gain| gain.2).filter(|bin| gains.iter().all(|gain| gain.2 == *bin));
        let at = |(one, change, bin): &(&Furnace, f64, [f64; 2])| {
            let own_view = if shared.is_some() { String::new() } else { view(*bin) };
            let alpha = match parted(answers, one).1 {
                "" => String::new(),
                alpha => format!(" at alpha {}", short("alpha", alpha)),
            };
            format!("+{}{alpha}{own_view}", percent(*change))
        };
        let [parts, wholes]: [Vec<String>; 2] =
            [gains.iter().map(at).collect(), gains.iter().map(|gain| signed(gain.0.change)).collect()];
        let shared = shared.map_or_else(String::new, view);
        format!("{name} creates energy{shared}: {}; over the whole surface {}.", listed(&parts), listed(&wholes))
    };
    creators.iter().map(of).collect()
}

/// `−12 %` of -0.12.
fn signed(change: f64) -> String {
    format!("{}{}", if change < 0.0 { "−" } else { "+" }, percent(change))
}

/// What is lost at each alpha: at the ends and in the middle of the sweep: a sentence for every model, from its best way of masking to its worst.
fn losses(answers: &Answers, alphas: &[&str]) -> Vec<String> {
    let all = &answers.furnace;
    let model = |one: &Furnace| parted(answers, one).0.split(' ').next().unwrap_or_default().to_owned();
    let mut models: Vec<String> = Vec::new();
    for name in all.iter().map(model) {
        if !models.contains(&name) {
            models.push(name);
        }
    }
    // The ends and the middle of the sweep: the tables have all of it.
    let mut told = vec![0, alphas.len() / 2, alphas.len().saturating_sub(1)];
    told.dedup();
    let of = |name: &String| {
        let at = told.iter().filter_map(|&i| alphas.get(i)).filter_map(|alpha| {
            let own = || all.iter().filter(|one| model(one) == *name && parted(answers, one).1 == *alpha);
            let least = own().max_by(|a, b| a.change.total_cmp(&b.change))?;
            let most = own().min_by(|a, b| a.change.total_cmp(&b.change))?;
            let way = |one: &Furnace| match parted(answers, one).0.split_once(' ') {
                Some((_, rest)) if own().count() > 1 => format!(" ({rest})"),
                _ => String::new(),
            };
            let [a, b] = [least, most].map(|one| format!("{}{}", signed(one.change), way(one)));
            let range =
                if signed(least.change) == signed(most.change) { signed(least.change) } else { format!("{a} to {b}") };
            Some(if alpha.is_empty() { range } else { format!("{range} at alpha {}", short("alpha", alpha)) })
        });
        format!("{name}: {}.", listed(&at.collect::<Vec<_>>()))
    };
    models.iter().map(of).collect()
}

/// A bin of n·v that shows more than this above what arrives creates energy: less is within what its own noise gives.
const MEANT: f64 = 0.005;
