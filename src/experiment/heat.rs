//! Error by `n_dot_v` and alpha: where on a surface, and on which surface, a method is wrong.

use super::plan::{Cell, Plan};
use super::statistics::median;
use super::store::{CellRecord, Store};
use super::tables::HEADLINE;
use crate::table::markdown::{Align, MarkdownTable, significant};
use std::collections::BTreeSet;

const DIGITS: usize = 2;

/// A table for each method with its largest sample count: rows are alphas, columns bins of `n_dot_v`, values medians of the headline
/// error over everything else that is swept. Empty where alpha is not swept.
pub fn section(plan: &Plan, done: &[(&Cell, &CellRecord)], store: &Store) -> String {
    if !plan.swept().any(|axis| axis.name == "alpha") {
        return String::new();
    }
    let method = |cell: &Cell| cell.point.get("method").to_string();
    let samples = |cell: &Cell| cell.point.settings().samples;
    let mut text = String::new();
    let mut seen = BTreeSet::new();
    for name in done.iter().map(|(cell, _)| method(cell)).filter(|name| name != "none") {
        if !seen.insert(name.clone()) {
            continue;
        }
        let largest = done.iter().filter(|(cell, _)| method(cell) == name).map(|(cell, _)| samples(cell)).max();
        let of_method: Vec<(&Cell, Vec<BinError>)> = done
            .iter()
            .filter(|(cell, _)| method(cell) == name && Some(samples(cell)) == largest)
            .map(|(cell, _)| (*cell, bin_errors(store, cell)))
            .collect();
        let count = of_method[0].0.point.get("samples").to_string();
        let _ = std::fmt::Write::write_fmt(
            &mut text,
            format_args!("`{}`:\n\n{}\n", format!("{name} {count}").trim_end(), table(&of_method)),
        );
    }
    format!("## Error by alpha and n_dot_v\n\nMedian {HEADLINE}; grazing angles on the left.\n\n{text}")
}

/// A bin's edges and its headline error; none where no pixel fell into it.
type BinError = (f64, f64, Option<f64>);

/// The bins of a finished cell, whose record holds them on disk only. A record that is gone leaves blanks.
fn bin_errors(store: &Store, cell: &Cell) -> Vec<BinError> {
    let bins = store.cell(&cell.id).ok().flatten().map_or_else(Vec::new, |record| record.bins);
    bins.iter().map(|bin| (bin.lo, bin.hi, bin.scores.get(HEADLINE).map(|score| score.0))).collect()
}

fn table(cells: &[(&Cell, Vec<BinError>)]) -> MarkdownTable {
    let bins: Vec<(f64, f64)> = cells[0].1.iter().map(|(lo, hi, _)| (*lo, *hi)).collect();
    let names: Vec<String> = bins.iter().map(|(lo, hi)| format!("{lo} to {}", hi.min(1.0))).collect();
    let mut header = vec![("alpha", Align::Right)];
    header.extend(names.iter().map(|name| (name.as_str(), Align::Right)));
    let mut table = MarkdownTable::new(&header);
    let mut alphas: Vec<f64> = cells.iter().map(|(cell, _)| cell.point.get("alpha").number()).collect();
    alphas.sort_by(f64::total_cmp);
    alphas.dedup();
    for alpha in alphas {
        let mut row = vec![alpha.to_string()];
        for (lo, _) in &bins {
            let of_alpha = cells.iter().filter(|(cell, _)| cell.point.get("alpha").number() == alpha);
            let errors: Vec<f64> =
                of_alpha.filter_map(|(_, errors)| errors.iter().find(|(from, ..)| from == lo)?.2).collect();
            row.push(if errors.is_empty() { String::new() } else { significant(median(&errors), DIGITS) });
        }
        table.row(&row);
    }
    table
}
