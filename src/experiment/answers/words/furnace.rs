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
    let mut names: Vec<String> = Vec::new();
    for name in all.iter().map(|one| parted(answers, one).0) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let fact = |name: &String| {
        let mut own: Vec<&Furnace> = all.iter().filter(|one| parted(answers, one).0 == *name).collect();
        own.sort_by_key(|one| alphas.iter().position(|alpha| *alpha == parted(answers, one).1));
        let mut verb = "";
        let at = own.iter().map(|one| {
            let own = if one.change > 0.0 { "creates " } else { "loses " };
            let said = if verb == own { "" } else { own };
            verb = own;
            match parted(answers, one).1 {
                "" => format!("{said}{}", percent(one.change)),
                alpha => format!("{said}{} at alpha {}", percent(one.change), short("alpha", alpha)),
            }
        });
        format!("{name} {}.", listed(&at.collect::<Vec<_>>()))
    };
    Some(Answer {
        number: percent(worst.change),
        unit: format!(
            "of the energy {} by {}",
            if worst.change > 0.0 { "is created" } else { "is lost" },
            parted(answers, worst).0
        ),
        sentence: format!("In a white furnace one scattering loses {lost} of the energy{exactness}; {created}."),
        facts: names.iter().map(fact).collect(),
    })
}

/// A bin of n·v that shows more than this above what arrives creates energy: less is within what its own noise gives.
const MEANT: f64 = 0.005;
