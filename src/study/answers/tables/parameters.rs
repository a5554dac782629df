//! What parameters change, which tables are enough, whether the claimed counts suffice, and what tables cost.

use super::{AnswerTable, count, texts, yes};
use crate::runner::tables::{DISPLAY_HEADLINE, HEADLINE};
use crate::runner::timing::swept_axes;
use crate::study::answers::Answers;
use crate::study::answers::claim::Sufficiency;
use crate::study::answers::effects::Effect;
use crate::study::answers::sizes::Enough;
use crate::study::answers::study::RUN_AXIS;
use crate::study::answers::table_times::TableTime;
use crate::table::csv::Cell;

/// One row an axis, value, method and alpha; an empty alpha is all of them.
pub(super) fn effects(answers: &Answers) -> AnswerTable {
    let row = |effect: &Effect| {
        let mut row = texts(&[&effect.axis, &effect.value, &effect.base, &effect.method].map(|text| text.to_owned()));
        row.push(effect.alpha.as_deref().map_or(Cell::Missing, Cell::from));
        row.extend([effect.ratio, effect.interval[0], effect.interval[1]].map(Cell::Number));
        row.extend([effect.n, effect.better, effect.in_noise].map(|n| Cell::Integer(n as u64)));
        row
    };
    let columns = [
        "axis",
        "value",
        "base",
        "method",
        "alpha",
        "error_ratio",
        "ratio_lo",
        "ratio_hi",
        "pairs",
        "pairs_better",
        "pairs_in_noise",
    ];
    AnswerTable {
        name: "effects",
        columns: columns.map(str::to_owned).to_vec(),
        rows: answers.effects.iter().map(row).collect(),
    }
}

/// A finite number, or nothing.
fn finite(number: f64) -> Cell {
    Some(number).filter(|number| number.is_finite()).into()
}

/// One row a parameter of tables: from which value on a larger one gains nothing.
pub(super) fn sizes(answers: &Answers) -> AnswerTable {
    let row = |one: &Enough| {
        let mut row = texts(&[&one.axis, &one.method, &one.value, &one.together].map(|text| text.to_owned()));
        for effect in [&one.beyond, &one.below] {
            row.push(effect.as_ref().map_or(Cell::Missing, |effect| Cell::from(effect.value.as_str())));
            let number = |get: fn(&Effect) -> f64| effect.as_ref().map_or(Cell::Missing, |effect| finite(get(effect)));
            row.extend([number(|e| e.ratio), number(|e| e.interval[0]), number(|e| e.interval[1])]);
            row.push(effect.as_ref().map_or(Cell::Missing, |effect| Cell::Integer(effect.n as u64)));
        }
        row
    };
    let of = |name: &str| {
        [name.to_owned()].into_iter().chain(["ratio", "lo", "hi", "pairs"].map(|end| format!("{name}_{end}")))
    };
    let columns = ["axis", "method", "enough", "enough_together"]
        .map(str::to_owned)
        .into_iter()
        .chain(of("larger"))
        .chain(of("smaller"));
    AnswerTable { name: "table_sizes", columns: columns.collect(), rows: answers.enough.iter().map(row).collect() }
}

/// One row a model (empty for all), sampling method and count.
pub(super) fn sufficiency(answers: &Answers) -> AnswerTable {
    let row = |one: &Sufficiency| {
        let mut row = vec![one.model.as_deref().map_or(Cell::Missing, Cell::from), Cell::from(one.method.as_str())];
        row.extend([count(one.samples), Cell::Integer(one.error.n as u64)]);
        row.extend([one.error.median, one.error.lower_quartile, one.error.upper_quartile].map(Cell::Number));
        let against = one.against.as_ref();
        row.push(against.map_or(Cell::Missing, |against| Cell::from(against.fixed.as_str())));
        row.extend(
            against.map_or([const { Cell::Missing }; 3], |a| [a.ratio, a.interval[0], a.interval[1]].map(finite)),
        );
        row.extend(against.map_or([const { Cell::Missing }; 2], |a| [a.n, a.better].map(|n| Cell::Integer(n as u64))));
        let flip = one.flip.map_or([None; 3], |f| [f.median, f.lower_quartile, f.upper_quartile].map(Some));
        row.extend(flip.map(Cell::from));
        row.push(Cell::Integer(one.visible as u64));
        row
    };
    let quartiles = |name: &str| [name.to_owned(), format!("{name}_lower_quartile"), format!("{name}_upper_quartile")];
    let mut columns = ["brdf", "method", "samples", "cells"].map(str::to_owned).to_vec();
    columns.extend(quartiles(HEADLINE));
    columns.extend(["fixed", "error_over_fixed", "ratio_lo", "ratio_hi", "pairs", "pairs_better"].map(str::to_owned));
    columns.extend(quartiles(DISPLAY_HEADLINE));
    columns.push("cells_visible".to_owned());
    AnswerTable { name: "sufficiency", columns, rows: answers.sufficiency.iter().map(row).collect() }
}

/// One row a pass that makes a table, and set of tables: the columns after `diffuse` are the swept axes that such sets differ in.
pub(super) fn table_times(answers: &Answers) -> AnswerTable {
    let named = ["brdf", "method", "diffuse"];
    let mut axes = named.to_vec();
    let swept = swept_axes(answers.table_times.iter().map(|time| &time.key));
    axes.extend(swept.into_iter().filter(|name| !named.contains(name)));
    let has_runs = answers.table_times.iter().any(|time| !time.run.is_empty());
    let row = |time: &TableTime| {
        let [width, height] = time.environment_size;
        let mut row = if has_runs { vec![Cell::Text(time.run.clone())] } else { Vec::new() };
        row.push(Cell::Text(format!("{width}x{height}")));
        row.extend(texts(&axes.iter().map(|name| time.axis(name).to_owned()).collect::<Vec<_>>()));
        row.push(Cell::Text(time.pass.clone()));
        row.extend([time.ms.median, time.ms.interval[0], time.ms.interval[1]].map(finite));
        row.extend([Cell::Integer(time.ms.n as u64), yes(time.is_cpu)]);
        row
    };
    let mut columns = if has_runs { vec![RUN_AXIS] } else { Vec::new() };
    columns.push("environment_size");
    columns.extend(&axes);
    columns.extend(["pass", "median_ms", "lo_ms", "hi_ms", "rounds", "is_cpu_time"]);
    AnswerTable {
        name: "table_times",
        columns: columns.into_iter().map(str::to_owned).collect(),
        rows: answers.table_times.iter().map(row).collect(),
    }
}
