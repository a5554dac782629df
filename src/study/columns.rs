//! The text of docs/columns.md, from the lists of axes, metrics, tables and questions.

use super::questions::{QUESTIONS, WEIGHT};
use crate::base::names::{Listed, capitalised};
use crate::draw::markdown::{Align, MarkdownTable};
use crate::experiment::axis::Named;
use crate::experiment::axis::named::columns;
use crate::instrument::metrics::METRICS;
use crate::run::columns::{CELL, Column, TABLES};
use std::fmt::Write;

pub fn page() -> String {
    let mut text =
        "# Columns\n\nWritten by `splitsum list columns`, from the lists in the code. A \
                    missing value is an empty field. Numbers have all \
                    their digits. An interval is a 95 % interval.\n\n"
            .to_owned();
    let _ = write!(text, "`{}`: {}\n\n## Axes\n\n", CELL.name, CELL.about);
    let in_tables =
        Named::all().filter(|named| columns(named.axis).any(|column| column == named.name()));
    text += &table(in_tables.map(|axis| (axis.name(), format!("{}.", capitalised(axis.about())))));
    text += "\nAn axis is empty in the rows of methods that do not use it.\n\n## Metrics\n\n";
    let metric = |d: &crate::instrument::metrics::Metric| {
        let constants: Vec<String> = d
            .parameters
            .iter()
            .map(|(name, value)| format!("{name} = {value}"))
            .collect();
        let constants = if constants.is_empty() {
            String::new()
        } else {
            format!(" ({})", constants.join(", "))
        };
        format!(
            "{}{constants}. {} values, better: {}.",
            capitalised(d.formula),
            capitalised(d.space.name()),
            d.better.name()
        )
    };
    text += &table(METRICS.iter().map(|known| (known.name, metric(known))));
    text += "\n## Tables of a run\n";
    for entry in TABLES {
        let _ = write!(text, "\n### {}\n\n{}\n\n", entry.file, entry.about);
        text += &of_columns(entry.columns());
    }
    text += "\n## Tables of answers\n\nEach answered question has a table in `answers/`. Its first \
             columns are the axes that distinguish its \
             rows; `environment`, `brdf`, `alpha` and `f0` are included even with one value if \
             rows are single cases.\n";
    for question in QUESTIONS {
        let _ = write!(
            text,
            "\n### answers/{}.csv\n\n{}\n\n",
            question.name, question.asks
        );
        let weight = question.is_weighted.then_some(&WEIGHT);
        text += &of_columns(weight.into_iter().chain(question.columns));
    }
    text += "\n## Counts of compiled code\n\n`splitsum cost --out` writes one row per pass and \
             family.\n\n";
    text += &table(
        crate::cost::table::columns()
            .iter()
            .map(|(name, about)| (name.as_str(), about.clone())),
    );
    text
}

fn of_columns<'c>(columns: impl IntoIterator<Item = &'c Column>) -> String {
    table(
        columns
            .into_iter()
            .map(|column| (column.name, column.about.to_owned())),
    )
}

fn table<'n>(rows: impl Iterator<Item = (&'n str, String)>) -> String {
    let mut table = MarkdownTable::new(&[("column", Align::Left), ("meaning", Align::Left)]);
    rows.for_each(|(name, about)| table.row(&[format!("`{name}`"), about]));
    table.to_string()
}
