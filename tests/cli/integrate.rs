//! `splitsum integrate` through the binary: independent answers, every fault of a table, outputs
//! that stay complete.

use super::{entries, splitsum, stderr, stdout};
use splitsum::base::csv::Table;
use std::path::Path;

/// Relative accuracy of the golden queries.
const QUERY_TOLERANCE: f64 = 2e-4;
/// The default `--tolerance` is 1e-5, and Schlick's part may add as much again.
const BOUND: f64 = 2e-5;

fn golden(name: &str) -> Table {
    Table::read(
        &Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("tests/golden")
            .join(name),
    )
    .unwrap()
}

/// A folder with a table of queries and the golden environment beside it.
fn folder(queries: &str) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("q.csv"), queries).unwrap();
    let environment = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/env_analytic.exr");
    std::fs::copy(environment, dir.path().join("env_analytic.exr")).unwrap();
    dir
}

/// Answers to a table, read from the file of `--out`; all reach their tolerance.
fn answers(queries: &str, arguments: &[&str]) -> Table {
    let dir = folder(queries);
    let output = splitsum(
        dir.path(),
        &[&["integrate", "q.csv", "--out", "a.csv"], arguments].concat(),
    );
    let notes = stderr(&output);
    // Shows the progress on a slow machine.
    assert!(
        output.status.success()
            && notes
                .lines()
                .all(|line| line.ends_with(" left: integrating")),
        "{notes}"
    );
    assert_eq!(stdout(&output), "");
    assert_eq!(entries(dir.path()), ["a.csv", "env_analytic.exr", "q.csv"]);
    Table::read(&dir.path().join("a.csv")).unwrap()
}

fn as_queries(table: &Table, columns: &[(&str, &str)]) -> String {
    let names: Vec<&str> = columns.iter().map(|(_, name)| *name).collect();
    let places: Vec<usize> = columns
        .iter()
        .map(|(column, _)| table.column(column).unwrap())
        .collect();
    let row = |cells: &Vec<String>| {
        places
            .iter()
            .map(|&i| cells[i].as_str())
            .collect::<Vec<_>>()
            .join(",")
    };
    names.join(",") + "\n" + &table.rows.iter().map(row).collect::<Vec<_>>().join("\n") + "\n"
}

fn numbers(table: &Table, column: &str) -> Vec<f64> {
    let column = table.column(column).unwrap();
    table
        .rows
        .iter()
        .map(|row| row[column].parse().unwrap())
        .collect()
}

/// Compares three columns with three columns of a golden table, relative to the brightest channel,
/// and checks the bounds of the answers.
fn assert_golden(
    answers: &Table,
    ours: &str,
    golden: &Table,
    theirs: &str,
    tolerance: f64,
    bound: f64,
) {
    let channels =
        |table: &Table, name: &str| ["r", "g", "b"].map(|c| numbers(table, &format!("{name}{c}")));
    let (found, expected) = (
        channels(answers, &format!("{ours}_")),
        channels(golden, theirs),
    );
    let error = channels(answers, &format!("{ours}_error_"));
    assert!(!answers.rows.is_empty() && answers.rows.len() == golden.rows.len());
    for row in 0..golden.rows.len() {
        let largest = (0..3).map(|c| expected[c][row]).fold(0.0, f64::max);
        for c in 0..3 {
            let off = (found[c][row] - expected[c][row]).abs();
            assert!(
                off <= tolerance * largest,
                "{ours} row {row} channel {c}: {off} of {largest}"
            );
            assert!(
                (0.0..=bound * largest).contains(&error[c][row]),
                "{ours} row {row}: bound {}",
                error[c][row]
            );
        }
    }
}

const SURFACE: [(&str, &str); 10] = [
    ("env", "environment"),
    ("model", "brdf"),
    ("alpha", "alpha"),
    ("nx", "nx"),
    ("ny", "ny"),
    ("nz", "nz"),
    ("vx", "vx"),
    ("vy", "vy"),
    ("vz", "vz"),
    ("id", "id"),
];

#[test]
fn answers_match_golden_queries() {
    let golden = golden("queries.csv");
    let queries = as_queries(&golden, &[&[("f0", "f0")], &SURFACE[..]].concat());
    let found = answers(&queries, &["--kind", "shading"]);
    // Columns and cells as given, then the answers.
    assert_eq!(
        found.columns[..11],
        queries
            .lines()
            .next()
            .unwrap()
            .split(',')
            .collect::<Vec<_>>()
    );
    assert_eq!(
        found.columns[11..14],
        ["specular_r", "specular_g", "specular_b"]
    );
    assert_eq!(found.columns.len(), 11 + 4 * 6);
    for (row, line) in found.rows.iter().zip(queries.lines().skip(1)) {
        assert_eq!(row[..11].join(","), line);
    }
    assert_golden(
        &found,
        "specular",
        &golden,
        "spec_schlick_",
        QUERY_TOLERANCE,
        BOUND,
    );
    assert_golden(
        &found,
        "specular_white",
        &golden,
        "spec_F1_",
        QUERY_TOLERANCE,
        BOUND,
    );
    assert_golden(
        &found,
        "diffuse",
        &golden,
        "diff_1mF_over_pi_",
        QUERY_TOLERANCE,
        BOUND,
    );
    assert_golden(
        &found,
        "lambert",
        &golden,
        "lambert_over_pi_",
        QUERY_TOLERANCE,
        BOUND,
    );
}

#[test]
fn answers_match_golden_albedos() {
    // Variants of the golden table as model and masking.
    let golden = golden("dfg.csv");
    let mut queries = String::from("brdf,masking,n_dot_v,alpha\n");
    for row in &golden.rows {
        let model = match row[0].as_str() {
            "ggx_smith_exact" => "ggx,separable",
            "ggx_karis_k_alpha_over_2" => "ggx,schlick",
            "beckmann_rational" => "beckmann,",
            "phong_rational" => "phong,separable",
            other => panic!("{other}"),
        };
        queries += &format!("{model},{},{}\n", row[1], row[2]);
    }
    let found = answers(&queries, &["--kind", "dfg"]);
    for (ours, theirs) in [("f0_scale", "A"), ("f90_scale", "B")] {
        for (row, (a, b)) in numbers(&found, ours)
            .iter()
            .zip(numbers(&golden, theirs))
            .enumerate()
        {
            assert!((a - b).abs() < 1e-5, "{ours} row {row}: {a} {b}");
        }
    }
    assert!(
        numbers(&found, "error")
            .iter()
            .all(|error| (0.0..1e-6).contains(error))
    );
}

#[test]
fn answers_match_golden_prefiltered_texels() {
    let golden = golden("prefilter.csv");
    let columns = [
        ("rz", "rz"),
        ("ry", "ry"),
        ("rx", "rx"),
        ("alpha", "alpha"),
        ("model", "brdf"),
        ("env", "environment"),
    ];
    let found = answers(&as_queries(&golden, &columns), &["--kind", "prefilter"]);
    assert_golden(&found, "prefiltered", &golden, "", 1e-3, BOUND);
}

fn golden_sh9() -> serde_json::Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/sh9.json");
    let golden: serde_json::Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
    golden["envs"]["analytic"]["L_bilinear"].clone()
}

#[test]
fn irradiance_and_coefficients_agree() {
    let golden = golden_sh9();
    let found = answers("environment\nenv_analytic.exr\n", &["--kind", "sh9"]);
    let expected = |k: usize, c: usize| golden[k][c].as_f64().unwrap();
    for (k, name) in [
        "l00", "l1m1", "l10", "l11", "l2m2", "l2m1", "l20", "l21", "l22",
    ]
    .iter()
    .enumerate()
    {
        for (c, channel) in ["r", "g", "b"].iter().enumerate() {
            let value = numbers(&found, &format!("{name}_{channel}"))[0];
            assert!(
                (value - expected(k, c)).abs() <= 1e-6 * expected(0, c),
                "{name} {channel}: {value}"
            );
        }
    }
    // A constant map: E = π L for every normal.
    let found = answers(
        "environment,nx,ny,nz\nbuiltin:constant:radiance=2,0,0.6,-0.8\nenv_analytic.exr,0,1,0\n",
        &["--kind", "irradiance", "--tolerance", "1e-7"],
    );
    let irradiance = numbers(&found, "irradiance_g");
    assert!(
        (irradiance[0] / (2.0 * std::f64::consts::PI) - 1.0).abs() < 1e-7,
        "{irradiance:?}"
    );
    assert!(
        numbers(&found, "irradiance_error_g")
            .iter()
            .zip(&irradiance)
            .all(|(e, x)| *e <= 1e-7 * x)
    );
}

#[test]
fn marks_of_spreadsheets_and_editors_are_ignored() {
    // A byte order mark, CRLF, blanks around cells, quotes and a blank line change nothing.
    let plain = answers(
        "id,brdf,alpha,n_dot_v\na,ggx,0.5,0.25\nb,phong,0.1,0.9\n",
        &["--kind", "dfg"],
    );
    let marked =
        "\u{feff}id,brdf, alpha ,n_dot_v\r\na,ggx,0.5,0.25\r\n\r\n\"b\",\"phong\", 0.1,0.9\r\n";
    assert_eq!(answers(marked, &["--kind", "dfg"]).rows, plain.rows);
}
