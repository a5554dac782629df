//! The tables in docs/estimators.md and the answers in README.md are those of the published runs. `GOLDEN=update` writes them anew from `results/`.

use splitsum::brdf::{MODELS, MaskingShadowing, alpha_from_perceptual_roughness};
use splitsum::precompute::dfg::reference::dfg;
use splitsum::runner::timing::{TimingRecord, summarize};
use splitsum::slips;
use splitsum::table::csv::Table;
use splitsum::table::markdown::{Align, MarkdownTable, significant};
use std::fmt::Write;
use std::path::{Path, PathBuf};

const PAGE: &str = "docs/estimators.md";
const README: &str = "README.md";
/// Published runs whose answers the README shows, each with how the facts begin that the question asks for beside the answer.
const SHOWN: [(&str, &[&str]); 11] = [
    ("break-even", &["In equal frame time"]),
    ("sample-count", &[]),
    ("level-bias", &[]),
    ("printed-slips", &[]),
    ("tables", &[]),
    ("energy", &[]),
    ("diffuse", &[]),
    ("diffuse-measured", &[]),
    ("exposure-and-contrast", &[]),
    ("dynamic-range", &["The error of split-sum in sky"]),
    ("timing", &[]),
];
/// Digits of a score in the page.
const DIGITS: usize = 3;

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn table(name: &str) -> Table {
    Table::read(&file("results").join(name)).unwrap()
}

/// The page with what stands between the markers of block `name` replaced by `text`.
fn with_block(page: &str, name: &str, text: &str) -> String {
    let (begin, end) =
        (format!("<!-- {name}: written by tests/numeric/published.rs -->\n"), format!("<!-- /{name} -->"));
    let start = page.find(&begin).unwrap_or_else(|| panic!("the page has no {begin}")) + begin.len();
    let length = page[start..].find(&end).unwrap_or_else(|| panic!("the page has no {end}"));
    format!("{}\n{text}\n{}", &page[..start], &page[start + length..])
}

/// Values of a column, each once, in order.
fn values(table: &Table, name: &str) -> Vec<String> {
    let column = table.column(name).unwrap();
    let mut found: Vec<String> = Vec::new();
    for row in &table.rows {
        if !found.contains(&row[column]) {
            found.push(row[column].clone());
        }
    }
    found
}

/// The numbers of `name` in the rows that have these values.
fn numbers(table: &Table, name: &str, wanted: &[(&str, &str)]) -> Vec<f64> {
    let columns: Vec<usize> = wanted.iter().map(|(name, _)| table.column(name).unwrap()).collect();
    let is_wanted = |row: &[String]| columns.iter().zip(wanted).all(|(column, (_, value))| row[*column] == *value);
    let all = table.numbers(name).unwrap();
    table.rows.iter().zip(all).filter(|(row, _)| is_wanted(row)).map(|(_, x)| x.unwrap()).collect()
}

fn median(mut numbers: Vec<f64>) -> f64 {
    assert!(numbers.len() % 2 == 1, "{numbers:?}");
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}

/// relMSE of the printed and the right estimator by environment and alpha: the median over the models.
fn printed_run(errors: &Table) -> String {
    let alphas = values(errors, "alpha");
    let header: Vec<String> = alphas.iter().map(|alpha| format!("alpha {alpha}")).collect();
    let mut columns = vec![("environment", Align::Left), ("method", Align::Left)];
    columns.extend(header.iter().map(|name| (name.as_str(), Align::Right)));
    let mut text = MarkdownTable::new(&columns);
    for environment in values(errors, "environment") {
        for method in values(errors, "method") {
            let mut row = vec![environment.clone(), method.clone()];
            row.extend(alphas.iter().map(|alpha| {
                let cell = [("environment", environment.as_str()), ("method", &method), ("alpha", alpha)];
                significant(median(numbers(errors, "relmse_eps1e-2", &cell)), DIGITS)
            }));
            text.row(&row);
        }
    }
    text.to_string()
}

/// Directional albedo by model, masking and alpha: the mean over a part of the sphere. Above 1 in bold.
fn albedos(errors: &Table, part: &[(&str, &str)]) -> String {
    let alphas = values(errors, "alpha");
    let header: Vec<String> = alphas.iter().map(|alpha| format!("alpha {alpha}")).collect();
    let mut columns = vec![("model", Align::Left), ("masking", Align::Left)];
    columns.extend(header.iter().map(|name| (name.as_str(), Align::Right)));
    let mut text = MarkdownTable::new(&columns);
    for model in values(errors, "brdf") {
        for masking in values(errors, "masking") {
            let mut row = vec![model.clone(), masking.clone()];
            row.extend(alphas.iter().map(|alpha| {
                let cell = [&[("brdf", model.as_str()), ("masking", &masking), ("alpha", alpha)], part].concat();
                let [bias] = numbers(errors, "bias_rel", &cell)[..] else { panic!("{cell:?}") };
                let albedo = significant(1.0 + bias, DIGITS);
                if albedo.parse::<f64>().unwrap() > 1.0 { format!("**{albedo}**") } else { albedo }
            }));
            text.row(&row);
        }
    }
    text.to_string()
}

/// Error of a DFG lookup beyond the outermost texel centres, where the table is constant, by its side.
fn table_edges() -> String {
    const SIDES: [u32; 2] = [32, 128];
    const ALONG: u32 = 8;
    let mut worst = SIDES.map(|_| [0.0f64; 4]);
    for model in MODELS {
        let at = |n_dot_v, perceptual_roughness| {
            let alpha = alpha_from_perceptual_roughness(perceptual_roughness);
            dfg(*model, MaskingShadowing::Separable, n_dot_v, alpha)
        };
        for along in (0..ALONG).map(|i| (f64::from(i) + 0.5) / f64::from(ALONG)) {
            let right = [at(along, 1.0), at(1.0, along)];
            for (side, worst) in SIDES.iter().zip(&mut worst) {
                let outermost = 1.0 - 0.5 / f64::from(*side);
                for (edge, held) in [at(along, outermost), at(outermost, along)].iter().enumerate() {
                    let errors = [held.f0_scale - right[edge].f0_scale, held.f90_scale - right[edge].f90_scale];
                    for (k, error) in errors.into_iter().enumerate() {
                        worst[2 * edge + k] = worst[2 * edge + k].max(error.abs());
                    }
                }
            }
        }
    }
    let names = ["side", "A at alpha 1", "B at alpha 1", "A at n·v 1", "B at n·v 1"];
    let mut text = MarkdownTable::new(&names.map(|name| (name, Align::Right)));
    for (side, worst) in SIDES.iter().zip(worst) {
        text.row(&[side.to_string()].into_iter().chain(worst.map(|error| significant(error, 2))).collect::<Vec<_>>());
    }
    text.to_string()
}

#[test]
fn the_page_shows_the_published_runs() {
    let published = table("printed-slips/printed_slips.csv");
    let mut energy = String::from("The whole sphere:\n\n");
    energy += &albedos(&table("energy/errors.csv"), &[]);
    let _ = write!(energy, "\nThe rim, n·v from 0 to 0.1:\n\n");
    energy += &albedos(&table("energy/errors_by_n_dot_v.csv"), &[("n_dot_v_from", "0")]);
    let blocks = [
        ("slips", format!("{}\n{}", slips::HEADING, slips::markdown(&published).unwrap())),
        ("printed estimator", printed_run(&table("printed-slips/errors.csv"))),
        ("energy", energy),
        ("table edges", table_edges()),
    ];
    assert_shown(PAGE, &blocks);
}

#[test]
fn the_readme_shows_the_published_answers() {
    let mut answers = String::new();
    for (run, wanted) in SHOWN {
        let text = std::fs::read_to_string(file("results").join(run).join("answers/answer.json")).unwrap();
        let answer: serde_json::Value = serde_json::from_str(&text).unwrap();
        let [question, sentence] = ["question", "sentence"].map(|key| answer[key].as_str().unwrap());
        let facts: Vec<&str> = answer["facts"].as_array().unwrap().iter().map(|fact| fact.as_str().unwrap()).collect();
        let facts = wanted.iter().map(|start| {
            let fact = facts.iter().find(|fact| fact.starts_with(start));
            format!(" {}", fact.unwrap_or_else(|| panic!("results/{run}: no fact begins with {start:?}")))
        });
        let facts: String = facts.collect();
        writeln!(answers, "- *{question}* {sentence}{facts} [All numbers](results/{run}/summary.md)").unwrap();
    }
    assert_shown(README, &[("answers", answers)]);
}

/// The blocks of a page must hold these texts, or get them when asked to.
fn assert_shown(name: &str, blocks: &[(&str, String)]) {
    let page = std::fs::read_to_string(file(name)).unwrap();
    let fresh = blocks.iter().fold(page.clone(), |page, (name, text)| with_block(&page, name, text));
    if std::env::var("GOLDEN").is_ok_and(|value| value == "update") {
        std::fs::write(file(name), &fresh).unwrap();
        return;
    }
    for (shown, due) in page.lines().zip(fresh.lines()) {
        assert_eq!(shown, due, "{name} differs from results/; GOLDEN=update writes it anew");
    }
    assert_eq!(page.len(), fresh.len(), "{name}: lines are missing");
}

/// Where the raw samples of the timings are published, the published table is what they give.
#[test]
fn the_published_times_are_those_of_the_raw_samples() {
    for entry in std::fs::read_dir(file("results")).unwrap().map(Result::unwrap) {
        let raw = entry.path().join("timings");
        let records = std::fs::read_dir(&raw).into_iter().flatten().map(|record| record.unwrap().path());
        let records: Vec<TimingRecord> =
            records.map(|path| serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()).collect();
        if records.is_empty() {
            continue;
        }
        let table = Table::read(&entry.path().join("timings.csv")).unwrap();
        let columns = ["cell", "phase", "pass"].map(|name| table.column(name).unwrap());
        let medians = table.numbers("median_ms").unwrap();
        assert_eq!(
            table.rows.len(),
            records.iter().map(|record| record.passes.len()).sum::<usize>(),
            "{}",
            raw.display()
        );
        for (row, median) in table.rows.iter().zip(medians) {
            let key = columns.map(|column| row[column].as_str());
            let passes = records.iter().filter(|record| [record.cell.as_str(), &record.phase] == key[..2]);
            let mut found = passes.flat_map(|record| &record.passes).filter(|pass| pass.pass == key[2]);
            let given = found
                .any(|pass| median.is_some_and(|median| (summarize(&pass.ms).median - median).abs() <= 1e-12 * median));
            assert!(given, "{}: {key:?}", raw.display());
        }
    }
}

#[test]
fn the_published_slips_are_those_of_the_program() {
    let published = table("printed-slips/printed_slips.csv");
    let (columns, rows) = slips::table();
    assert_eq!(published.columns, columns);
    assert_eq!(published.rows.len(), rows.len());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("now.csv");
    let text = splitsum::table::csv::to_text(&columns, rows.iter().map(Vec::as_slice));
    std::fs::write(&path, text).unwrap();
    let now = Table::read(&path).unwrap();
    for (then, now) in published.rows.iter().zip(&now.rows) {
        assert_eq!(then[..4], now[..4]);
    }
    for column in ["printed_value", "right_value"] {
        let [then, now] = [&published, &now].map(|table| table.numbers(column).unwrap());
        for (i, (then, now)) in then.into_iter().zip(now).enumerate() {
            let (then, now) = (then.unwrap(), now.unwrap());
            // The integrals stop at 1e-5 and are a hundred times nearer; which parts they are made of is no promise.
            let is_same = (then - now).abs() <= 1e-9 * now.abs() + 1e-12 || (then.is_nan() && now.is_nan());
            assert!(is_same, "{column} of row {}: {then} published, {now} now", i + 1);
        }
    }
}
