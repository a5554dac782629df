//! Which method errs less at the same modelled GPU cost?
//!
//! A case is as in `break-even`. There sampling takes c samples a pixel for the error of the method without samples. By the model of
//! [`crate::cost`] it takes a to b samples for the other's cost: a where its upper bound meets the other's lower one, b the reverse. So
//! sampling errs less at equal cost where c <= a, the other one where c > b; between them the model does not tell. Each card has its own a
//! and b and its own wins. The other's cost has its share of the prefiltered map: made by samples on the GPU, once in [`FRAMES`] frames or
//! in each. The DFG table and that of lobes hang on no light and count nothing; the environment's levels are needed by both.

use super::break_even::{self, conditions, counted, pairs, tried};
use super::prelude::*;
use super::{FIXED, SAMPLED};
use crate::cost::child::Job;
use crate::cost::family::Family;
use crate::cost::record::{CostRecord, TEXEL};
use crate::metrics::{ALL_VIEWS, VIEWS};
use crate::precompute::PrecomputeSettings;
use crate::study::frame::curve::beside;

pub const QUESTION: Question = Question {
    name: "equal-cost",
    asks: "Which method errs less at the same modelled GPU cost?",
    columns: &[
        column("n_dot_v_from", "Pixels with n·v from here; 0 with `n_dot_v_to` 1 is the whole image."),
        column("n_dot_v_to", "To here."),
        SAMPLED,
        FIXED,
        column("card", "The card that the model is for."),
        column("samples_at_equal_cost_least", "Samples a pixel at the other's cost by the model: least of both ends."),
        column("samples_at_equal_cost_most", "Most of them."),
        column("samples_at_equal_cost_each_frame_least", "The same where the prefiltered map is made anew each frame."),
        column("samples_at_equal_cost_each_frame_most", "Most of them."),
        column(
            "samples_at_equal_error",
            "Samples a pixel at the other's error: median over environments; twice the largest tried count for more.",
        ),
        column("environments", "Number of environments."),
        column("sampled_errs_less", "Environments under which sampling errs less at any cost between the ends."),
        column("fixed_errs_less", "Environments under which the other one does."),
    ],
    uses_times: false,
    uses_costs: true,
    lacks: break_even::lacks,
    answer,
};

/// Frames of 1920x1080 that share a prefiltered map: a second.
const FRAMES: f64 = 60.0;

/// Samples a pixel at equal cost: the least, the most.
type Afforded = [u32; 2];

/// A case at some n·v.
struct Met {
    names: [String; 2],
    /// The sampling pass, the other one, and the one that makes its map.
    jobs: [Job; 3],
    tables: PrecomputeSettings,
    key: Key,
    light: Value,
    seen: [f64; 2],
    /// Samples a pixel at equal error; twice the largest tried count for more.
    count: f64,
}

/// The cases of one pair of methods under one condition and some n·v on a card, a number an environment.
struct Group<'m> {
    seen: [f64; 2],
    key: &'m Key,
    family: &'static Family,
    /// At equal cost, with a map a second and a map a frame.
    afforded: [Afforded; 2],
    counts: Vec<f64>,
}

impl Group<'_> {
    /// Environments under which the sampling method and under which the other one errs less.
    fn wins(&self) -> [usize; 2] {
        let [least, most] = self.afforded[0].map(f64::from);
        let number = |wins: &dyn Fn(f64) -> bool| self.counts.iter().filter(|count| wins(**count)).count();
        [number(&|count| count <= least), number(&|count| count > most)]
    }

    fn median(&self) -> f64 {
        median(&self.counts)
    }
}

/// A method that samples and one that does not, with their groups.
type Pair<'m> = ([String; 2], Vec<Group<'m>>);

fn met(frame: &Frame) -> Vec<Met> {
    let axes = frame.case_axes();
    let of = |frame: &Frame, seen: [f64; 2]| -> Vec<Met> {
        let images = frame.images();
        let of: Vec<usize> = conditions(frame).collect();
        let all = pairs(beside(frame, &images, &axes));
        let of_pair = |(names, cases): &([String; 2], Vec<break_even::Case>)| {
            let tried = tried(cases);
            let settings = |row: &Row| row.cell.point.settings();
            let met = |case: &break_even::Case| {
                let [sampled, fixed] = [case.of.curve.first(), case.of.fixed].map(settings);
                let jobs = [sampled.specular_job(), fixed.specular_job(), fixed.prefilter_job()];
                (jobs, fixed.shading.precompute)
            };
            let case = |case: &break_even::Case| Met {
                names: names.clone(),
                jobs: met(case).0,
                tables: met(case).1,
                key: of.iter().map(|axis| case.of.fixed.point[*axis].clone()).collect(),
                light: case.of.fixed.point[ENVIRONMENT].clone(),
                seen,
                count: case.number(&tried).min(2.0 * f64::from(tried[tried.len() - 1])),
            };
            cases.iter().map(case).collect::<Vec<_>>()
        };
        all.iter().flat_map(of_pair).collect()
    };
    let mut found = of(frame, ALL_VIEWS);
    if frame.images().iter().all(|row| is_design(&row.text(SCENE))) {
        for seen in VIEWS {
            let Some(run) = frame.run.seen_at(seen) else { continue };
            found.extend(of(&Frame::new(&run, Some(frame.metric_name())), seen));
        }
    }
    found
}

/// Samples of a case at equal cost on a card, the map made once in so many frames.
fn afforded(costs: &CostRecord, family: &Family, case: &Met, frames: f64) -> Option<Afforded> {
    let [sampled, fixed, prefilter] = &case.jobs;
    let family = family.at_boost();
    let other = costs.with_tables(&family, [fixed, prefilter], &case.tables, frames)?;
    Some(costs.pass(&family, sampled)?.afforded(&family, TEXEL, other))
}

fn answer(frame: &Frame) -> Option<Finding> {
    let costs = frame.run.costs.as_ref()?;
    let of: Vec<usize> = conditions(frame).collect();
    let all = met(frame);
    let mut found: Vec<Pair> = Vec::new();
    for (names, of_pair) in grouped(&all, |case| case.names.clone()) {
        let groups = grouped(of_pair, |case| (case.key.clone(), case.seen.map(f64::to_bits)));
        let groups = groups.into_iter().flat_map(|(_, cases)| {
            let Met { seen, key, .. } = cases[0];
            let of_light =
                |(_, own): (Value, Vec<&Met>)| median(&own.iter().map(|case| case.count).collect::<Vec<_>>());
            let counts: Vec<f64> =
                grouped(cases.clone(), |case| case.light.clone()).into_iter().map(of_light).collect();
            costs.families().filter_map(move |family| {
                let of = |frames| afforded(costs, family, cases[0], frames);
                Some(Group { seen: *seen, key, family, afforded: [of(FRAMES)?, of(1.0)?], counts: counts.clone() })
            })
        });
        found.push((names, groups.collect()));
    }
    found.retain(|(_, groups)| !groups.is_empty());
    let tried: Vec<u32> = {
        let mut counts: Vec<u32> = frame.images().iter().filter_map(|row| row.samples()).collect();
        counts.sort_unstable();
        counts.dedup();
        counts
    };
    let mut table = Table::new(&of, QUESTION.columns);
    for ([sampled, fixed], groups) in &found {
        for group in groups {
            let [[least, most], [frame_least, frame_most]] = group.afforded;
            let [won, lost] = group.wins();
            let key = group.key.iter().map(Cell::from);
            let own = cells![group.seen[0], group.seen[1], sampled.as_str(), fixed.as_str(), group.family.card.name];
            let rest = cells![least, most, frame_least, frame_most, group.median(), group.counts.len(), won, lost];
            table.row(key.chain(own).chain(rest).collect());
        }
    }
    Some(Finding {
        sentence: sentence(frame, found.first()?),
        digest: Some(digest(&found, &tried)),
        table,
        figure: figure(frame, &found, &tried),
    })
}

/// Groups told together: those of some n·v, or of bands only, which together are the whole image.
fn seen<'g, 'm>(groups: &'g [Group<'m>], seen: [f64; 2]) -> Vec<&'g Group<'m>> {
    groups.iter().filter(|group| group.seen == seen).collect()
}

/// The cards of groups, in the model's order.
fn cards(groups: &[Group]) -> Vec<&'static str> {
    distinct_in_order(groups.iter().map(|group| group.family.card.name))
}

/// Both ends over the conditions of a card.
fn ends(groups: &[Group], card: &str) -> Afforded {
    let own = groups.iter().filter(|group| group.family.card.name == card).map(|group| group.afforded[0]);
    own.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]).expect("groups of a card")
}

fn words([least, most]: Afforded) -> String {
    range_words([least.into(), most.into()], |n| n.to_string())
}

/// In percent, how many of the cases the sampling method and the other one win: least and most of the cards.
fn shares(groups: &[&Group]) -> [String; 2] {
    let of_card = |(_, own): (&str, Vec<&&Group>)| {
        let all: usize = own.iter().map(|group| group.counts.len()).sum();
        [0, 1].map(|i| (1e2 * own.iter().map(|group| group.wins()[i]).sum::<usize>() as f64 / all as f64).round())
    };
    let of_cards: Vec<[f64; 2]> = grouped(groups, |group| group.family.card.name).into_iter().map(of_card).collect();
    [0, 1].map(|i| {
        let ends = of_cards.iter().fold([f64::INFINITY, 0.0], |[a, b], own| [own[i].min(a), own[i].max(b)]);
        range_words(ends, |percent| percent.to_string())
    })
}

/// The views that are told: both ends on a design, else the whole image.
fn told(groups: &[Group]) -> Vec<[f64; 2]> {
    let ends = [VIEWS[0], VIEWS[VIEWS.len() - 1]];
    if ends.iter().all(|view| !seen(groups, *view).is_empty()) { ends.to_vec() } else { vec![ALL_VIEWS] }
}

/// Whether the model leaves sampling any sample on any card.
fn can_win(groups: &[Group]) -> bool {
    groups.iter().any(|group| group.afforded[0][0] > 0)
}

fn of_view([lo, hi]: [f64; 2]) -> String {
    if [lo, hi] == ALL_VIEWS { "all n·v".to_owned() } else { format!("n·v {lo} to {hi}") }
}

/// The newest card leads; the one with the fewest samples stands beside it, where it is another one.
fn told_cards(groups: &[Group]) -> (&'static str, Option<&'static str>) {
    let cards = cards(groups);
    let newest = cards[cards.len() - 1];
    (newest, cards.into_iter().min_by_key(|card| ends(groups, card)).filter(|card| *card != newest))
}

fn sentence(frame: &Frame, ([sampled, fixed], groups): &Pair) -> String {
    let (newest, fewest) = told_cards(groups);
    let others = fewest.map_or_else(String::new, |card| format!("; on a `{card}` {}", words(ends(groups, card))));
    let samples = words(ends(groups, newest));
    let mut text = format!(
        "At the modelled cost of `{fixed}` on a `{newest}`, `{sampled}` takes **{samples} samples a pixel**{others}."
    );
    for view in told(groups) {
        let [won, lost] = shares(&seen(groups, view));
        let (at, metric) = (of_view(view), frame.metric_name());
        let less = if can_win(groups) { format!("less `{metric}` in {won} % of cases, ") } else { String::new() };
        text += &format!(" At {at} it has {less}more `{metric}` in {lost} % of cases, wherever in that range.");
    }
    text
}

/// One row a pair of methods.
fn digest(pairs: &[Pair], tried: &[u32]) -> Table {
    let views = pairs.first().map_or_else(Vec::new, |(_, groups)| told(groups));
    let cards = pairs.first().map_or_else(Vec::new, |(_, groups)| cards(groups));
    let mut heads = ["without samples", "sampling"].map(str::to_owned).to_vec();
    heads.extend(cards.iter().map(|card| format!("at its cost, {card}")));
    let wins = pairs.iter().any(|(_, groups)| can_win(groups));
    for view in &views {
        let shown = ["at its error, ", "errs less, %, ", "errs more, %, "].into_iter().enumerate();
        heads.extend(shown.filter(|(i, _)| wins || *i != 1).map(|(_, what)| format!("{what}{}", of_view(*view))));
    }
    let mut table = Table::with_names(heads);
    for ([sampled, fixed], groups) in pairs {
        let mut row = cells![fixed.as_str(), sampled.as_str()];
        row.extend(cards.iter().map(|card| Cell::from(words(ends(groups, card)))));
        for view in &views {
            let own = seen(groups, *view);
            let medians = own.iter().map(|group| group.median());
            let (least, most) = medians.fold((f64::INFINITY, 0.0), |(a, b), x| (f64::min(a, x), f64::max(b, x)));
            let [won, lost] = shares(&own);
            row.extend(cells![range_words([least, most], |n| counted(n, tried))]);
            row.extend(wins.then(|| Cell::from(won)));
            row.extend(cells![lost]);
        }
        table.row(row);
    }
    table
}

/// A panel a sampling method and card that is told, a row a method without samples: the range of equal cost as a line, medians of equal
/// error as dots.
fn figure(frame: &Frame, pairs: &[Pair], tried: &[u32]) -> Option<Figure> {
    let rows = distinct_in_order(pairs.iter().map(|([_, fixed], _)| fixed.clone()));
    let views = told(&pairs.first()?.1);
    let beyond = 2.0 * f64::from(*tried.last()?);
    // Less than one sample has a place on the logarithmic axis, too.
    let at = |n: f64| n.clamp(0.5, beyond);
    let of: Vec<usize> = conditions(frame).collect();
    let marks = |([sampled, fixed], groups): &Pair, card: &'static str| {
        let y = step(&rows, fixed);
        let [least, most] = ends(groups, card);
        let tip = format!("{sampled} at the cost of {fixed} on {card}: {} samples", words([least, most]));
        let range = Mark::new(Form::Whisker([at(least.into()), y], [at(most.into()).max(0.55), y]), 0).tip(tip);
        let dots = views.iter().enumerate().flat_map(|(k, view)| {
            let dot = |group: &&Group| {
                let tip =
                    format!("{}: {} samples at equal error", label(&of, group.key), counted(group.median(), tried));
                Mark::new(
                    Form::Dot([at(group.median()), y + 0.25 * (k as f64 + 0.5 - 0.5 * views.len() as f64)]),
                    k + 1,
                )
                .tip(tip)
            };
            let own = seen(groups, *view).into_iter().filter(|group| group.family.card.name == card);
            own.map(|group| dot(&group)).collect::<Vec<_>>()
        });
        std::iter::once(range).chain(dots).collect::<Vec<Mark>>()
    };
    let panels = |(sampled, own): (String, Vec<&Pair>)| {
        let panel = |card| {
            let rule = [Mark::neutral(Form::VerticalRule(beyond / 2.0))];
            let all = rule.into_iter().chain(own.iter().flat_map(|pair| marks(pair, card)));
            (format!("{sampled}, {card}"), all.collect())
        };
        let (newest, fewest) = told_cards(&own[0].1);
        [Some(newest), fewest].into_iter().flatten().map(panel).collect::<Vec<_>>()
    };
    Chart {
        title: "Samples a pixel at equal cost and at equal error",
        note: format!(
            "modelled cost (below 1: none); {}, a dot a condition, median environment; beyond the line: more than tried",
            frame.metric_name()
        ),
        x: Along::Log("samples a pixel"),
        y: Along::Steps("", rows.clone()),
        panels: grouped(pairs, |([sampled, _], _)| sampled.clone()).into_iter().flat_map(panels).collect(),
        series: std::iter::once("equal modelled cost".to_owned())
            .chain(views.iter().map(|view| format!("equal error, {}", of_view(*view))))
            .collect(),
    }
    .figure()
}
