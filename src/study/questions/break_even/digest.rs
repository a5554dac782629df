//! The digest of a break-even: one row per pair of methods, one column per value of the rows' axis.

use super::Pair;
use crate::study::questions::prelude::*;

/// The pairs of a row of the digest.
#[derive(PartialEq, Eq, Hash)]
struct DigestKey {
    metric: &'static str,
    /// On the conditions without the row axis.
    others: Key,
}

/// One row per metric, condition and pair of methods, one column per value of
/// [`Frame::row_axis`], else a single column `head`.
pub(in crate::study::questions) fn digest(
    frame: &Frame,
    axes: &[AxisId],
    all: &[Pair],
    head: &str,
) -> Table {
    let row_axis = frame.row_axis();
    let others: Vec<AxisId> = axes
        .iter()
        .copied()
        .filter(|axis| *axis != row_axis)
        .collect();
    let steps = all.iter().filter_map(|pair| pair.value(axes, row_axis));
    let steps = ascending(distinct_in_order(steps.cloned()));

    let mut heads = vec!["metric".to_owned()];
    heads.extend(others.iter().map(|axis| frame.names.name(*axis).to_owned()));
    heads.extend(["without samples", "sampling"].map(str::to_owned));
    if steps.is_empty() {
        heads.push(head.to_owned());
    }
    heads.extend(steps.iter().map(|step| frame.names.heading(row_axis, step)));

    let key = |pair: &&Pair| DigestKey {
        metric: pair.metric,
        others: axes
            .iter()
            .zip(&pair.key)
            .filter(|(axis, _)| **axis != row_axis)
            .map(|(_, value)| value.clone())
            .collect(),
    };
    let mut table = Table::with_names(heads);
    for (key, pairs) in grouped(all, key) {
        for (methods, pairs) in grouped(pairs, |pair| pair.methods.clone()) {
            let mut row = cells![key.metric];
            for (axis, value) in others.iter().zip(&key.others) {
                row.push(frame.names.short_cell(*axis, value));
            }
            row.extend(cells![
                &Variant::new(methods.fixed),
                &Variant::new(methods.sampled)
            ]);
            let quantity = |pair: &&Pair| pair.quantity();
            if steps.is_empty() {
                row.push(pairs.first().map(quantity).into());
            }
            for step in &steps {
                let pair = pairs
                    .iter()
                    .find(|pair| pair.value(axes, row_axis) == Some(step));
                row.push(pair.map(quantity).into());
            }
            table.row(row);
        }
    }
    table
}
