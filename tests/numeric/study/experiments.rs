//! Every shipped experiment, run with the synthetic renderer: each plans, and fills the tables that
//! docs/columns.md describes.

use super::questions::{experiments, run_scrambled};
use crate::scratch::scratch;
use splitsum::base::csv::Table;
use splitsum::experiment::axis::Named;
use splitsum::experiment::plan::Plan;
use splitsum::instrument::metrics::{METRICS, Pooling};
use splitsum::run::columns::{CELL, Column, TABLES};
use splitsum::study::finished::Finished;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

const SHIPPED: &str = "experiments";
const LIGHTS: &str = "builtin:constant,builtin:sky,builtin:studio";

/// A finished run of a shipped experiment.
struct Shipped {
    name: String,
    plan: Plan,
    dir: PathBuf,
    run: Finished,
}

/// The shipped experiments under three environments, at two values of each axis that is not zipped.
/// Every error, share and time differs.
fn shipped() -> &'static [Shipped] {
    static RUNS: OnceLock<Vec<Shipped>> = OnceLock::new();
    RUNS.get_or_init(|| {
        experiments(SHIPPED)
            .into_iter()
            .map(|(name, text)| {
                let plan = Plan::from_text(Path::new("experiments/own.toml"), &text, &short(&text))
                    .unwrap_or_else(|error| panic!("{name}: {error}"));
                let dir = scratch();
                run_scrambled(&plan, &dir);
                let run = Finished::read(&dir).unwrap();
                Shipped {
                    name,
                    plan,
                    dir,
                    run,
                }
            })
            .collect()
    })
}

/// Overrides that make an experiment small.
fn short(text: &str) -> Vec<String> {
    let root: toml::Table = text.parse().unwrap();
    let zipped = root.get("zip").map(ToString::to_string).unwrap_or_default();
    let is_zipped = |axis: &str| zipped.contains(&format!("\"{axis}\""));
    let mut set = vec![format!("environment={LIGHTS}")];
    if !is_zipped("size") {
        set.push("size=24x17".to_owned());
    }
    for (axis, values) in root["axes"].as_table().unwrap() {
        let values = values.as_array().map_or(&[][..], Vec::as_slice);
        if values.len() > 2 && axis != "method" && axis != "environment" && !is_zipped(axis) {
            // A grid of widths has at least three.
            let kept = if root.contains_key("recovery") { 3 } else { 2 };
            let first = values[..kept.min(values.len())].iter();
            let first: Vec<String> = first.map(|v| v.to_string().replace('"', "")).collect();
            set.push(format!("{axis}={}", first.join(",")));
        }
    }
    set
}

/// The columns of a table, by what may be in them.
#[derive(Default)]
struct Filled {
    /// Columns that had a value in some experiment.
    somewhere: BTreeSet<String>,
    all: BTreeSet<String>,
}

/// Values that answers may leave out, beside columns whose meaning says when they are empty.
const OPTIONAL: [&str; 4] = [
    // Upper ends are as empty as lower ends, of which docs/columns.md says so.
    "_hi",
    "_lo",
    // Of three counts or more above the noise.
    "slope",
    "slope_standard_error",
];

impl Filled {
    /// Notes the columns of a table. Numbers are finite, but for `psnr` of equal images, and a known
    /// column is full unless its meaning says when it is empty.
    fn note(&mut self, place: &str, table: &Table, known: &[Column]) {
        for (index, name) in table.columns.iter().enumerate() {
            let bare = name.strip_suffix("_noise_floor").unwrap_or(name);
            let is_axis = Named::all().any(|axis| axis.name() == name);
            let is_metric = METRICS.iter().any(|metric| metric.name == bare);
            let column = known.iter().find(|column| column.name == name);
            assert!(
                is_axis || is_metric || column.is_some() || name == CELL.name,
                "{place}: the column {name} is not in docs/columns.md"
            );
            let values = || table.rows.iter().map(|row| row[index].as_str());
            for value in values() {
                let is_of_equal_images = name == "psnr" && value == "inf";
                assert!(
                    is_of_equal_images || !["NaN", "nan", "inf", "-inf"].contains(&value),
                    "{place}: {name} is {value}"
                );
            }
            let may_be_empty = is_axis
                || column.is_some_and(|column| column.about.contains("empty"))
                || OPTIONAL.iter().any(|end| name.ends_with(end));
            let empty = values().filter(|value| value.is_empty()).count();
            assert!(
                may_be_empty || empty == 0 || is_metric,
                "{place}: {name} is empty in {empty} of {} rows",
                table.rows.len()
            );
            if !is_axis {
                let file = place.split(' ').next_back().unwrap();
                let key = format!("{file} {name}");
                self.all.insert(key.clone());
                if empty < table.rows.len() {
                    self.somewhere.insert(key);
                }
            }
        }
    }

    fn assert_all_are_used(&self) {
        let unused: Vec<&String> = self.all.difference(&self.somewhere).collect();
        assert!(unused.is_empty(), "no experiment has a value of {unused:?}");
    }
}

#[test]
fn every_shipped_experiment_fills_its_tables() {
    let mut filled = Filled::default();
    for Shipped {
        name,
        plan,
        dir,
        run,
        ..
    } in shipped()
    {
        assert_eq!(run.failures.len() + run.failed_count(), 0, "{name}");
        let errors = Table::read(&dir.join("errors.csv")).unwrap();
        let ids: Vec<&str> = errors.rows.iter().map(|row| row[0].as_str()).collect();
        let due: Vec<String> = plan.cells.iter().map(|cell| cell.id.to_string()).collect();
        assert_eq!(ids, due, "{name}: a row a cell, in the order of the plan");
        for entry in TABLES {
            let path = dir.join(entry.file);
            let is_due = match entry.file {
                "steps.csv" => plan
                    .cells
                    .iter()
                    .any(|c| plan.ladder_of(&c.point).is_some()),
                "timings.csv" => plan.config.timing.is_some(),
                "recovery.csv" => plan.config.recovery.is_some(),
                "errors_by_n_dot_v.csv" => plan.config.is_scored,
                _ => true,
            };
            assert_eq!(path.exists(), is_due, "{name}: {}", entry.file);
            if is_due {
                let table = Table::read(&path).unwrap();
                assert!(!table.rows.is_empty(), "{name}: {} is empty", entry.file);
                let known: Vec<Column> = entry.columns().copied().collect();
                filled.note(&format!("{name} {}", entry.file), &table, &known);
            }
        }
    }
    filled.assert_all_are_used();
}

/// The bins of n·v of a cell tile its pixels, and together have the score of the whole.
#[test]
fn bins_of_shipped_experiments_make_the_whole() {
    for Shipped { name, run, .. } in shipped().iter().filter(|one| one.run.is_scored()) {
        for (index, cell) in run.cells.iter().enumerate() {
            let bins = &cell.bins;
            assert!(!bins.is_empty(), "{name}: {} has no bins", cell.id);
            let ranges = bins.ranges();
            let are_ascending = ranges.windows(2).all(|pair| pair[0].hi <= pair[1].lo);
            assert!(are_ascending && ranges.iter().all(|range| range.lo < range.hi));
            if index % 16 != 0 {
                continue;
            }
            let one = Finished {
                cells: vec![cell.clone()],
                ..run.clone()
            };
            let whole = one.within_n_dot_v([0.0, 2.0]).unwrap();
            let pooled = METRICS.iter().filter(|m| m.pooling != Pooling::None);
            for metric in pooled {
                let score = |cell: &splitsum::study::finished::FinishedCell| {
                    cell.scores.as_ref().unwrap().get(metric.name).unwrap()
                };
                let [found, right] = [score(&whole.cells[0]), score(cell)];
                // Each bin has its own ε, a hundredth of its mean; the whole has one.
                assert!(
                    (found / right - 1.0).abs() < 0.02,
                    "{name}: {} of {} is {right}, its bins make {found}",
                    metric.name,
                    cell.id
                );
            }
        }
    }
}

/// The list of experiments/README.md has each file of the folder once, and says of those that
/// scripts/standard-set.sh does not run that they are not in the set.
#[test]
fn the_list_of_experiments_is_the_folder() {
    let read = |path: &str| std::fs::read_to_string(path).unwrap();
    let readme = read("experiments/README.md");
    let row = |line: &str| {
        let (name, rest) = line.strip_prefix("| [")?.split_once("](")?;
        let (file, question) = rest.split_once(") |")?;
        assert_eq!(file, format!("{name}.toml"));
        Some((name.to_owned(), !question.contains("ot in the set")))
    };
    let listed: Vec<(String, bool)> = readme.lines().filter_map(row).collect();
    let mut names: Vec<&str> = listed.iter().map(|(name, _)| name.as_str()).collect();
    names.sort_unstable();
    let shipped = experiments(SHIPPED);
    let mut files: Vec<&str> = shipped.iter().map(|(name, _)| name.as_str()).collect();
    files.sort_unstable();
    assert_eq!(names, files);
    let script = read("scripts/standard-set.sh");
    let of_set = |line: &str| {
        Some(
            line.strip_prefix("set_names=\"")?
                .trim_end_matches('"')
                .to_owned(),
        )
    };
    let set = script.lines().find_map(of_set).unwrap();
    for (name, is_in_set) in &listed {
        let runs = set.split(' ').any(|run| run == name);
        assert_eq!(runs, *is_in_set, "{name}");
    }
}
