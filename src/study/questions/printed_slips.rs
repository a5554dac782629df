//! What do the slips of the printed formulas cost?
//!
//! Each slip of the source documents has figures: one quantity by the printed formula and by the right one, in f64 ([`slips`]). Where the
//! quantity is one that light is proportional to, what is seen is wrong by max(p/q, q/p) of the printed value p and the right value q.
//! A slip stands for its worst figure. No image is behind this: what a printed estimator does to images is asked of its method.

use super::prelude::*;
use crate::slips::{self, Cost, VISIBLE_RATIO};

pub const QUESTION: Question = Question {
    name: "printed-slips",
    asks: "What do the slips of the printed formulas cost?",
    columns: &[
        column("document", "The source document: 0 [Kim22], 1 or 4."),
        column("printed", "The formula as printed, or its place in words."),
        column("right", "The right formula."),
        column("quantity", "What is computed with both: of GGX with separable masking where nothing else is said."),
        column("printed_value", "The quantity by the printed formula; empty where that gives no number."),
        column("right_value", "The quantity by the right formula."),
        column(
            "light_ratio",
            "By which factor light is wrong, at least 1; empty where the quantity is no amount of light.",
        ),
        column("changes_light", "1 where light is wrong by more than 2 %, which is told apart side by side, else 0."),
    ],
    uses_times: false,
    uses_costs: false,
    lacks,
    answer,
};

fn lacks(shape: &Shape) -> Option<&'static str> {
    (!shape.has_printed_slips).then_some("the experiment has no `printed_slips = true`")
}

/// Whether light is wrong by so much that it is told apart side by side.
fn is_seen(cost: &Cost) -> bool {
    cost.light_ratio.is_some_and(|ratio| ratio > VISIBLE_RATIO)
}

fn answer(frame: &Frame) -> Option<Finding> {
    if !frame.shape.has_printed_slips {
        return None;
    }
    let mut costs = slips::costs();
    let mut table = Table::new(&[], QUESTION.columns);
    for cost in &costs {
        let [printed, right] =
            [cost.figure.printed, cost.figure.right].map(|number| Some(number).filter(|number| number.is_finite()));
        let mut row = cells![cost.document, cost.slip.printed, cost.slip.right, cost.figure.quantity];
        row.extend(cells![printed, right, cost.light_ratio, is_seen(cost)]);
        table.row(row);
    }
    let digest = digest(&costs);
    costs.sort_by(|a, b| b.light_ratio.unwrap_or(0.0).total_cmp(&a.light_ratio.unwrap_or(0.0)));
    Some(Finding { sentence: sentence(&costs)?, digest: Some(digest), table, figure: figure(&costs) })
}

/// [`VISIBLE_RATIO`] in words.
const SEEN: &str = "more than 2 %";

/// One row a slip, by its worst figure.
fn digest(costs: &[Cost]) -> Table {
    let seen = costs.iter().filter(|cost| is_seen(cost)).count();
    let light = format!("light is wrong by ({seen} by {SEEN})");
    let names = ["document", "printed", "right", "quantity", "as printed", "right value", &light];
    let mut table = Table::with_names(names);
    for cost in costs {
        let light = match cost.light_ratio {
            None => "no amount of light".to_owned(),
            Some(ratio) if is_seen(cost) => format!("a factor of {}, {SEEN}", number(ratio)),
            Some(ratio) => format!("a factor of {}, not {SEEN}", number(ratio)),
        };
        let mut row = cells![cost.document, cost.slip.printed, cost.slip.right, cost.figure.quantity];
        row.extend(cells![number(cost.figure.printed), number(cost.figure.right), light]);
        table.row(row);
    }
    table
}

/// `costs` descend by ratio.
fn sentence(costs: &[Cost]) -> Option<String> {
    let most = costs.first()?;
    let seen = costs.iter().filter(|cost| is_seen(cost)).count();
    Some(format!(
        "{seen} of {} printed slips change light by {SEEN}. The costliest, {} in document {}, gives {} instead of {} for {}.",
        costs.len(),
        most.slip.printed.split(',').next().unwrap_or_default(),
        most.document,
        number(most.figure.printed),
        number(most.figure.right),
        most.figure.quantity
    ))
}

/// One bar a slip that changes light, from 1.
fn figure(costs: &[Cost]) -> Option<Figure> {
    let seen: Vec<(&Cost, f64)> = costs.iter().filter_map(|cost| Some((cost, cost.light_ratio?))).collect();
    let name = |cost: &Cost| format!("{}: {}", cost.document, cost.figure.quantity);
    let bar = |(y, (cost, ratio)): (usize, &(&Cost, f64))| {
        let tip = format!(
            "document {}, {} for {}: {} {} instead of {}",
            cost.document,
            cost.slip.printed,
            cost.slip.right,
            cost.figure.quantity,
            number(cost.figure.printed),
            number(cost.figure.right)
        );
        Mark::new(Form::HorizontalBar { y: y as f64, base: 1.0, to: *ratio }, 0).tip(tip)
    };
    let rule = Mark::neutral(Form::VerticalRule(VISIBLE_RATIO));
    Chart {
        title: "By which factor each printed slip makes light wrong",
        note: "document and quantity; the dashed line is 2 %, which is told apart side by side".to_owned(),
        x: Along::Log("factor"),
        y: Along::Steps("", seen.iter().map(|(cost, _)| name(cost)).collect()),
        panels: vec![(String::new(), std::iter::once(rule).chain(seen.iter().enumerate().map(bar)).collect())],
        series: vec!["light".to_owned()],
    }
    .figure()
}
