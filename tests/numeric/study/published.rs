//! The repository's pages show the numbers of published runs, and every column is explained.

use crate::run::runs::{Bench, invoke, log, plan};
use crate::run::whole::EXPERIMENT;
use crate::snapshot::assert_snapshot;
use splitsum::base::csv::Table;
use splitsum::report::blocks::{fill, fill_pages};
use splitsum::report::write::Written;
use splitsum::run::columns::{CELL, TABLES};
use splitsum::run::provenance::experiment_hash;
use splitsum::study::columns;
use splitsum::study::finished::Finished;
use splitsum::study::questions::answers;
use std::path::{Path, PathBuf};

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn text(name: &str) -> String {
    std::fs::read_to_string(file(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

#[test]
fn published_pages_match_their_runs() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::create_dir(dir.path().join("docs")).unwrap();
    std::os::unix::fs::symlink(file("results"), dir.path().join("results")).unwrap();
    std::fs::copy(file("README.md"), dir.path().join("README.md")).unwrap();
    for page in std::fs::read_dir(file("docs"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_file())
    {
        std::fs::copy(
            &page,
            dir.path().join("docs").join(page.file_name().unwrap()),
        )
        .unwrap();
    }
    let filled = fill_pages(&dir.path().join("results")).unwrap();
    assert!(filled.contains(&dir.path().join("README.md")), "{filled:?}");
    for page in filled {
        let name = page.strip_prefix(dir.path()).unwrap().display().to_string();
        assert!(
            std::fs::read_to_string(&page).unwrap() == text(&name),
            "{name} does not show what results/ says"
        );
    }
}

/// Runs whose answers need only the tables that are published with them: sentences, tables, digests
/// and figures are what the program writes today.
#[test]
fn published_answers_follow_from_their_tables() {
    let mut differences = Vec::new();
    for name in [
        "exposure-and-contrast",
        "ghosts",
        "lobes",
        "source-document-0",
        "timing",
    ] {
        let run = Finished::read(&file("results").join(name)).unwrap();
        let written = Written::new(&run, &answers(&run, None)).unwrap();
        for answer in &written.files {
            let published = format!("results/{name}/answers/{}", answer.name);
            if answer.text != text(&published) {
                differences.push(published);
            }
        }
    }
    assert!(
        differences.is_empty(),
        "the program writes other answers: {differences:?}"
    );
    // Each run can run again: its experiment is the one of its record.
    for dir in std::fs::read_dir(file("results"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
    {
        let Ok(record) = std::fs::read(dir.join("provenance.json")) else {
            continue;
        };
        let record: serde_json::Value = serde_json::from_slice(&record).unwrap();
        let experiment = std::fs::read_to_string(dir.join("experiment.toml")).unwrap();
        assert_eq!(
            record["experiment_hash"],
            experiment_hash(&experiment),
            "{}",
            dir.display()
        );
        let lines = record["sessions"].as_array().unwrap().iter();
        for argument in lines.flat_map(|session| session["command_line"].as_array().unwrap()) {
            let paths = argument.as_str().unwrap().split(['=', ',']);
            let of_machine: Vec<_> = paths.filter(|path| path.starts_with('/')).collect();
            assert!(of_machine.is_empty(), "{}: {of_machine:?}", dir.display());
        }
    }
}

#[test]
fn blocks_choose_rows_and_columns_and_name_their_faults() {
    let dir = tempfile::tempdir().unwrap();
    let answers = dir.path().join("run/answers");
    std::fs::create_dir_all(&answers).unwrap();
    let csv = "alpha,model,n·v below 0.2,empty\n0.1,ggx,0.012345,\n0.10,phong,3,\n0.5,ggx,more \
               than 512,\n";
    std::fs::write(answers.join("q.csv"), csv).unwrap();
    let run = |head: &str| {
        fill(
            &format!("a\n<!-- {head} -->old<!-- /csv -->\nb"),
            dir.path(),
        )
    };
    let content = |head: &str| {
        let page = run(head).unwrap_or_else(|error| panic!("{error}"));
        page.split_once("-->")
            .unwrap()
            .1
            .split_once("<!-- /csv")
            .unwrap()
            .0
            .to_owned()
    };
    // The same number in any notation; no filtered and no empty column.
    let table = "\n| model | n·v below 0.2 |\n|-------|--------------:|\n| ggx   |        0.0123 \
                 |\n| phong |             3 |\n";
    assert_eq!(content("csv run/answers/q.csv alpha=0.1"), table);
    assert_eq!(content("csv run/answers/q.csv alpha=0.5 show=model"), "ggx");
    // Two digits within a sentence.
    assert_eq!(
        content("csv run/answers/q.csv alpha=0.1 model=ggx show=\"n·v below 0.2\""),
        "0.012"
    );
    assert_eq!(content("csv elsewhere/q.csv"), "old");
    let faults = [
        "csv run/answers/none.csv",
        "csv run/answers/q.csv beta=1",
        "csv run/answers/q.csv alpha=0.2",
        "csv run/answers/q.csv alpha",
        "csv run/answers/q.csv show=beta",
    ];
    let faults = faults
        .map(|head| run(head).unwrap_err())
        .into_iter()
        .chain([fill("<!-- csv run", dir.path()).unwrap_err()]);
    let faults = faults.map(|fault| fault.replace(&dir.path().display().to_string(), "RESULTS"));
    assert_snapshot(
        "blocks_that_are_wrong",
        &faults.collect::<Vec<_>>().join("\n"),
    );
}

#[test]
fn the_page_of_columns_is_made_from_the_lists() {
    assert!(
        text("docs/columns.md") == columns::page(),
        "docs/columns.md is old; `splitsum list columns > docs/columns.md` writes it"
    );
}

#[test]
fn every_column_of_every_table_is_explained() {
    let text = format!("{EXPERIMENT}frames = [1]\n[timing]\nwarmup = 1\nrounds = 3\n[ladder]\n");
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(&text));
    invoke(&plan, dir.path(), &log(), usize::MAX).unwrap();
    let unscored = Bench::finished(crate::recovery::EXPERIMENT);
    let axes = splitsum::experiment::axis::Named::all().map(|axis| axis.name());
    let metrics: Vec<&str> = splitsum::instrument::metrics::METRICS
        .iter()
        .map(|metric| metric.name)
        .collect();
    let known: Vec<&str> = axes
        .chain(metrics.iter().copied())
        .chain([CELL.name])
        .collect();
    for entry in TABLES {
        let file = entry.file;
        let table = if file == "recovery.csv" {
            unscored.table(file)
        } else {
            Table::read(&dir.path().join(file)).unwrap()
        };
        for name in &table.columns {
            let bare = name.strip_suffix("_noise_floor").unwrap_or(name);
            let is_known =
                known.contains(&bare) || entry.columns().any(|column| column.name == *name);
            assert!(is_known, "{file}: the column {name} is not explained");
        }
        for column in entry.columns() {
            assert!(
                table.columns.iter().any(|name| name == column.name),
                "{file} has no column {}",
                column.name
            );
        }
    }
}

/// Rows that a summary shows of a digest.
const DIGEST_ROWS_MAX: usize = 100;

#[test]
fn published_summaries_show_whole_digests() {
    let mut count = 0;
    for dir in std::fs::read_dir(file("results"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
    {
        let Ok(summary) = std::fs::read_to_string(dir.join("summary.md")) else {
            continue;
        };
        for answer in std::fs::read_dir(dir.join("answers")).unwrap() {
            let path = answer.unwrap().path();
            let name = path.file_name().unwrap().to_str().unwrap();
            let Some(question) = name.strip_suffix("_digest.csv") else {
                continue;
            };
            let rows = Table::read(&path).unwrap().rows.len();
            assert!(rows <= DIGEST_ROWS_MAX, "{}", path.display());
            let before = summary
                .split_once(&format!("(answers/{question}.csv)"))
                .unwrap()
                .0;
            let table = before
                .lines()
                .rev()
                .skip_while(|line| !line.starts_with('|'));
            let lines = table.take_while(|line| line.starts_with('|')).count();
            assert_eq!(lines, rows + 2, "{}", path.display());
            count += 1;
        }
    }
    assert!(count > 20, "{count} digests");
}
