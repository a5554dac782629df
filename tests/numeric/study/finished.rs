//! Finished runs read from their files, complete and damaged, and runs in progress.

use crate::run::runs::{finished, invoke, log, plan, read};
use crate::run::whole::EXPERIMENT;
use splitsum::experiment::axis::AXES;
use splitsum::experiment::value::Value;
use splitsum::run::columns::{Columns, StepColumns};
use splitsum::run::store::Store;
use splitsum::study::finished::{Finished, StepRow};
use std::path::{Path, PathBuf};

/// A run of one case: the split sum and three counts.
fn whole(dir: &Path) -> PathBuf {
    let text = "name = \"x\"\nsize = [16, 16]\nreference = { samples = 32, noise_share = 0 }\n[axes]\nmethod = \
                [\"split-sum\", \"sampled\"]\n\
                samples = [1, 4, 16]\ndiffuse = [\"none\"]\n";
    finished(&plan(text), dir)
}

fn fault(dir: &Path) -> String {
    Finished::read(dir).unwrap_err().to_string()
}

#[test]
fn damaged_tables_are_refused_by_name() {
    let dir = tempfile::tempdir().unwrap();
    let run = whole(dir.path());
    let path = |name: &str| run.join(name);
    let read = |name: &str| std::fs::read_to_string(path(name)).unwrap();
    let (errors, bins) = (read("errors.csv"), read("errors_by_n_dot_v.csv"));
    let lines = |text: &str, count: usize| {
        text.lines()
            .take(count)
            .map(|line| format!("{line}\n"))
            .collect::<String>()
    };
    let cells: Vec<&str> = errors
        .lines()
        .skip(1)
        .map(|line| line.split(',').next().unwrap())
        .collect();
    assert_eq!(cells.len(), 4);
    let column = errors
        .lines()
        .next()
        .unwrap()
        .split(',')
        .position(|name| name == "relmse")
        .unwrap();
    let score = errors
        .lines()
        .nth(1)
        .unwrap()
        .split(',')
        .nth(column)
        .unwrap();
    let of_first = lines(&bins, 1)
        + &bins
            .lines()
            .filter(|line| line.starts_with(cells[0]))
            .collect::<Vec<_>>()
            .join("\n")
        + "\n";
    let damages = [
        ("errors.csv", String::new(), "the file is empty"),
        ("errors.csv", lines(&errors, 1), "the table is truncated"),
        (
            "errors.csv",
            lines(&errors, 4),
            "3 rows, but the folder has records of 4 cells",
        ),
        (
            "errors.csv",
            errors[..errors.len() - 3].to_owned(),
            "ends within a row",
        ),
        (
            "errors.csv",
            lines(&errors, 2) + "0009,sampled,1\n",
            "line 3: the row has 3 cells",
        ),
        (
            "errors.csv",
            errors.replacen("verdict", "verdicts", 1),
            "\"verdict\" is not a column",
        ),
        (
            "errors.csv",
            errors.replacen(score, "3e-l", 1),
            "\"3e-l\" is not a number",
        ),
        (
            "errors.csv",
            errors.replacen(cells[1], cells[0], 1),
            "4 rows of 3 cells",
        ),
        ("errors_by_n_dot_v.csv", String::new(), "the file is empty"),
        (
            "errors_by_n_dot_v.csv",
            of_first,
            &format!("no row of cell {}", cells[1]),
        ),
    ];
    for (name, text, expected) in damages {
        std::fs::write(path(name), &text).unwrap();
        let message = fault(&run);
        assert!(
            message.contains(&path(name).display().to_string()) && message.contains(expected),
            "{message}"
        );
        assert_eq!(message.lines().count(), 1, "{message}");
        std::fs::write(path("errors.csv"), &errors).unwrap();
        std::fs::write(path("errors_by_n_dot_v.csv"), &bins).unwrap();
    }
    let head = ["cell".to_owned()]
        .into_iter()
        .chain(StepColumns::names())
        .collect::<Vec<_>>()
        .join(",");
    std::fs::write(
        path("steps.csv"),
        format!("{head}\n{},0.1,0.2,view,3,4,5,6,7,8,9,10\n", cells[0]),
    )
    .unwrap();
    let of = Finished::read(&run).unwrap().cells;
    let StepRow {
        share,
        share_error,
        rung_error,
        first_in,
        last_out,
        shapley,
        step_error,
        noise,
        ..
    } = of[0].steps[0];
    let read = [
        share,
        share_error,
        rung_error,
        first_in,
        last_out,
        shapley,
        step_error,
        noise,
    ];
    assert_eq!(
        (of.len(), read),
        (4, [3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0])
    );
}

#[test]
fn unreadable_records_are_ignored() {
    let dir = tempfile::tempdir().unwrap();
    let run = whole(dir.path());
    std::fs::write(run.join("cells/0009.json"), "{").unwrap();
    assert!(Finished::read(&run).is_ok());
    // A published folder has no records. A table without rows is a fault.
    std::fs::remove_dir_all(run.join("cells")).unwrap();
    assert!(Finished::read(&run).is_ok());
    let errors = std::fs::read_to_string(run.join("errors.csv")).unwrap();
    std::fs::write(
        run.join("errors.csv"),
        errors.lines().next().unwrap().to_owned() + "\n",
    )
    .unwrap();
    assert!(fault(&run).contains("no rows"), "{}", fault(&run));
    assert!(fault(&run.join("nowhere")).contains("expected the folder of a run"));
}

#[test]
fn a_run_reads_back_as_it_was_scored() {
    let dir = tempfile::tempdir().unwrap();
    let plan = plan(EXPERIMENT);
    let run = Finished::read(&finished(&plan, dir.path())).unwrap();
    assert_eq!(run.cells.len(), plan.cells.len());
    for (read, planned) in run.cells.iter().zip(&plan.cells) {
        // Tables have the axis of a layer only if the experiment names it.
        let mut point = planned.point.clone();
        for axis in AXES.ids().filter(|axis| !plan.columns.contains(axis)) {
            point[axis] = Value::Unset;
        }
        assert_eq!((&read.id, &read.point), (&planned.id.to_string(), &point));
        assert!(
            read.scores
                .as_ref()
                .is_some_and(|scores| scores.get("relmse").is_some_and(|x| x > 0.0))
        );
        assert!(
            read.noise_floors.get("flip").is_none()
                && !read.bins.is_empty()
                && read.images.is_some()
        );
    }
    assert_eq!((run.failed_count(), run.lights.len()), (0, 1));
    assert_eq!(run.config.unwrap().axes.len(), plan.config.axes.len());
}

#[test]
fn a_run_in_progress_has_no_answers_and_a_truncated_table_is_refused() {
    let (dir, plan) = (tempfile::tempdir().unwrap(), plan(EXPERIMENT));
    let dir = dir.path();
    invoke(&plan, dir, &log(), 7).unwrap();
    let early = read(dir.join("errors.csv"));
    invoke(&plan, dir, &log(), 10).unwrap();
    assert_eq!(Finished::read(dir).unwrap().cells.len(), 17);
    std::fs::write(dir.join("errors.csv"), early).unwrap();
    let error = Finished::read(dir).unwrap_err().to_string();
    assert!(
        error.contains("7 rows, but the folder has records of 17 cells: the table is truncated"),
        "{error}"
    );
    let at_work = Store::open(dir, &plan).unwrap();
    let error = Finished::read(dir).unwrap_err().to_string();
    assert!(error.contains("a run is using the folder"), "{error}");
    drop(at_work);
    invoke(&plan, dir, &log(), usize::MAX).unwrap();
    assert_eq!(Finished::read(dir).unwrap().cells.len(), 32);
}
