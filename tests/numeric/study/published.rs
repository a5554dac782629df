//! What the repository shows of published runs is what they say, and every column is explained.

use crate::run::runs::{invoke, log, plan};
use crate::run::whole::EXPERIMENT;
use splitsum::report::publish::with_answers;
use splitsum::run::columns::{CELL, TABLES};
use splitsum::study::columns;
use splitsum::table::csv::Table;
use std::path::{Path, PathBuf};

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn text(name: &str) -> String {
    std::fs::read_to_string(file(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

#[test]
fn the_readme_shows_the_published_answers() {
    let readme = text("README.md");
    let filled = with_answers(&readme, &file("results")).unwrap();
    assert!(
        filled == readme,
        "README.md is not what the runs in results/ say; `splitsum answers DIR... --publish results` writes it"
    );
    // A block whose run is not there stays as it is: then nothing is shown.
    let blocks: Vec<&str> = filled.split("<!-- answer").skip(1).collect();
    assert!(!blocks.is_empty(), "README.md has no block of answers");
    for block in blocks {
        let rows =
            block.split("<!-- /answer").next().unwrap_or("").lines().filter(|line| line.starts_with('|')).count();
        assert!((3..13).contains(&rows), "{rows} lines of a table in the block{}", block.lines().next().unwrap_or(""));
    }
}

#[test]
fn the_page_of_columns_is_that_of_the_lists() {
    assert!(
        text("docs/columns.md") == columns::page(),
        "docs/columns.md is old; `splitsum list columns > docs/columns.md` writes it"
    );
}

#[test]
fn every_column_of_every_table_is_explained() {
    let text = format!("{EXPERIMENT}[timing]\nwarmup = 1\nrounds = 3\n[ladder]\n");
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(&text));
    invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
    let axes = splitsum::experiment::axis::Named::all().map(|axis| axis.name());
    let metrics: Vec<&str> = splitsum::metrics::METRICS.iter().map(|metric| metric.description().name).collect();
    let known: Vec<&str> = axes.chain(metrics.iter().copied()).chain([CELL.name]).collect();
    for (file, columns, _) in TABLES {
        let table = Table::read(&dir.path().join(file)).unwrap();
        for name in &table.columns {
            let bare = name.strip_suffix("_noise_floor").unwrap_or(name);
            let is_told = known.contains(&bare) || columns.iter().any(|column| column.name == *name);
            assert!(is_told, "{file}: the column {name} is not explained");
        }
        for column in *columns {
            assert!(table.columns.iter().any(|name| name == column.name), "{file} has no column {}", column.name);
        }
    }
}
