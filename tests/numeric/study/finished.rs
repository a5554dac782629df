//! Finished runs read from their files, complete and damaged, and runs in progress.

use crate::run::runs::{finished, invoke, log, plan, read};
use crate::run::whole::EXPERIMENT;
use splitsum::experiment::axis::AXES;
use splitsum::experiment::value::Value;
use splitsum::instrument::metrics::METRICS;
use splitsum::run::columns::{Columns, StepColumns};
use splitsum::run::store::Store;
use splitsum::study::finished::{
    Bin, BinRange, Bins, Finished, FinishedCell, MetricValues, StepRow,
};
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

/// Bins are packed by what a cell has; each number comes out where it went in.
#[test]
fn packed_bins_hold_what_each_bin_has() {
    let numbers = |first: f64, names: &'static [&str]| {
        MetricValues::from_fn(move |name| {
            let index = names.iter().position(|known| *known == name)?;
            Some(first + index as f64)
        })
    };
    let bin = |lo: f64, mean: Option<f64>, scores: MetricValues, floors: MetricValues| Bin {
        range: BinRange {
            lo,
            hi: lo + 0.1,
            pixel_count: (100.0 * lo) as u64,
        },
        reference_mean: mean,
        scores,
        noise_floors: floors,
    };
    let none = || numbers(0.0, &[]);
    let whole = [
        bin(0.1, Some(1.5), numbers(2.0, &["rmse", "bias_rel"]), none()),
        bin(0.2, None, none(), numbers(3.0, &["relmse"])),
        bin(
            0.3,
            Some(0.0),
            numbers(4.0, &["bias_rel"]),
            numbers(5.0, &["ssim"]),
        ),
    ];
    let scores_alone = [bin(0.5, None, numbers(6.0, &["relmse"]), none())];
    let numbers_of = |bin: &Bin| {
        METRICS
            .iter()
            .map(|metric| {
                let [score, floor] =
                    [&bin.scores, &bin.noise_floors].map(|values| values.get(metric.name));
                (score, floor)
            })
            .collect::<Vec<_>>()
    };
    for bins in [&whole[..], &scores_alone, &[]] {
        let mut packed: Bins = bins.iter().cloned().collect();
        // Neither an equal nor another layout changes a number.
        packed.share_layout(&bins.iter().cloned().collect());
        packed.share_layout(&whole.iter().cloned().collect());
        let unpacked: Vec<Bin> = packed.iter().collect();
        assert_eq!(packed.is_empty(), bins.is_empty());
        assert_eq!(unpacked.len(), bins.len());
        for (a, b) in unpacked.iter().zip(bins) {
            assert_eq!((a.range, a.reference_mean), (b.range, b.reference_mean));
            assert_eq!(numbers_of(a), numbers_of(b));
        }
    }
}

/// Rows of a cell usually follow each other, but need not.
#[test]
fn rows_of_bins_can_be_in_any_order() {
    let dir = tempfile::tempdir().unwrap();
    let run = whole(dir.path());
    let ordered = Finished::read(&run).unwrap();
    let path = run.join("errors_by_n_dot_v.csv");
    let text = std::fs::read_to_string(&path).unwrap();
    let (head, rows) = text.split_once('\n').unwrap();
    let mut rows: Vec<&str> = rows.lines().collect();
    // Every other row: cells alternate, and each keeps the order of its own.
    let later: Vec<&str> = rows.iter().skip(1).step_by(2).copied().collect();
    rows = rows.into_iter().step_by(2).chain(later).collect();
    std::fs::write(&path, format!("{head}\n{}\n", rows.join("\n"))).unwrap();
    let mixed = Finished::read(&run).unwrap();
    let ranges = |run: &Finished| {
        let sorted = |cell: &FinishedCell| {
            let mut bins: Vec<Bin> = cell.bins.iter().collect();
            bins.sort_by(|a, b| a.range.lo.total_cmp(&b.range.lo));
            let score = |bin: Bin| (bin.range, bin.scores.get("relmse"));
            bins.into_iter().map(score).collect::<Vec<_>>()
        };
        run.cells.iter().map(sorted).collect::<Vec<_>>()
    };
    assert!(ranges(&ordered).iter().all(|bins| bins.len() > 2));
    assert_eq!(ranges(&mixed), ranges(&ordered));
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
        assert_eq!(
            (&*read.id, &read.point),
            (planned.id.to_string().as_str(), &point)
        );
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
