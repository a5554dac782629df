//! How much energy is lost, and what creates some.

use super::{Answer, ERROR_DIGITS, listed};
use crate::experiment::answers::furnace::Furnace;
use crate::experiment::answers::study::short;
use crate::experiment::answers::{Answers, key_label};
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

/// `loses 2.9 %`, `creates 1.0 %`.
fn verb(change: f64) -> String {
    format!("{} {}", if change > 0.0 { "creates" } else { "loses" }, percent(change))
}

pub(super) fn from_furnace(answers: &Answers) -> Option<Answer> {
    let all = &answers.furnace;
    let mut alphas: Vec<&str> = all.iter().map(|one| parted(answers, one).1).collect();
    alphas.sort_by(|a, b| a.parse().unwrap_or(0.0f64).total_cmp(&b.parse().unwrap_or(0.0)));
    alphas.dedup();
    let at = |alpha: &str| {
        let own = all.iter().filter(|one| parted(answers, one).1 == alpha);
        let least = own.clone().max_by(|a, b| a.change.total_cmp(&b.change))?;
        let most = own.min_by(|a, b| a.change.total_cmp(&b.change))?;
        let [least, most] = [least, most].map(|one| format!("{} ({})", percent(one.change), parted(answers, one).0));
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
    let strongest = all
        .iter()
        .filter_map(|one| one.extremes.map(|[_, most]| (one, most)))
        .filter(|(one, (change, _))| *change > one.interval.map_or(0.0, |[lo, _]| one.change - lo) * CLEAR)
        .max_by(|a, b| a.1.0.total_cmp(&b.1.0));
    let created = match strongest {
        None => "none creates energy at any n·v".to_owned(),
        Some((one, (change, [lo, hi]))) => {
            let mut who: Vec<String> = Vec::new();
            for other in all.iter().filter(|other| other.extremes.is_some_and(|[_, most]| most.0 > MEANT)) {
                let name = parted(answers, other).0;
                if !who.contains(&name) {
                    who.push(name);
                }
            }
            let (name, alpha) = parted(answers, one);
            let at = if alpha.is_empty() { String::new() } else { format!(" at alpha {}", short("alpha", alpha)) };
            match who.is_empty() {
                true => format!("none creates more than {}", percent(change)),
                false => format!(
                    "only {} create any, up to {} ({name}{at}, n·v {lo} to {})",
                    listed(&who),
                    percent(change),
                    hi.min(1.0)
                ),
            }
        }
    };
    let worst = all.iter().min_by(|a, b| a.change.total_cmp(&b.change))?;
    let mut names: Vec<String> = Vec::new();
    for name in all.iter().map(|one| parted(answers, one).0) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let fact = |name: &String| {
        let mut own: Vec<&Furnace> = all.iter().filter(|one| parted(answers, one).0 == *name).collect();
        own.sort_by_key(|one| alphas.iter().position(|alpha| *alpha == parted(answers, one).1));
        let at = own.iter().map(|one| match parted(answers, one).1 {
            "" => verb(one.change),
            alpha => format!("{} at alpha {}", verb(one.change), short("alpha", alpha)),
        });
        format!("{name} {}.", listed(&at.collect::<Vec<_>>()))
    };
    Some(Answer {
        number: percent(worst.change),
        unit: format!("of the energy {} by {}", if worst.change > 0.0 { "is created" } else { "is lost" }, parted(answers, worst).0),
        sentence: format!("In a white furnace one scattering loses {lost} of the energy{exactness}; {created}."),
        facts: names.iter().map(fact).collect(),
    })
}

/// A bin holds a tenth of the surface or so: its noise is a few times that of the whole.
const CLEAR: f64 = 5.0;
/// Less than this share is no creation worth a name: it is within what a bin's own noise gives.
const MEANT: f64 = 0.005;
