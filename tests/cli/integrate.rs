//! `splitsum integrate` through the binary: outside answers, every fault of a table, files left whole.

use super::{entries, splitsum, stderr, stdout};
use splitsum::brdf::MODELS;
use splitsum::table::csv::Table;
use std::path::Path;

/// Relative accuracy of the golden queries.
const QUERY_TOLERANCE: f64 = 2e-4;
/// What `--tolerance` promises by default, 1e-5, and as much again for Schlick's part.
const BOUND: f64 = 2e-5;

fn golden(name: &str) -> Table {
    Table::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name)).unwrap()
}

/// A folder with a table of queries and the golden environment beside it.
fn folder(queries: &str) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("q.csv"), queries).unwrap();
    let environment = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/env_analytic.exr");
    std::fs::copy(environment, dir.path().join("env_analytic.exr")).unwrap();
    dir
}

/// Answers to a table, read from the file that `--out` names; all of them reach their tolerance.
fn answers(queries: &str, arguments: &[&str]) -> Table {
    let dir = folder(queries);
    let output = splitsum(dir.path(), &[&["integrate", "q.csv", "--out", "a.csv"], arguments].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(stdout(&output), "");
    assert_eq!(entries(dir.path()), ["a.csv", "env_analytic.exr", "q.csv"]);
    assert_eq!(stderr(&output), "");
    Table::read(&dir.path().join("a.csv")).unwrap()
}

/// Some columns of a table as CSV under other names.
fn as_queries(table: &Table, columns: &[(&str, &str)]) -> String {
    let names: Vec<&str> = columns.iter().map(|(_, name)| *name).collect();
    let places: Vec<usize> = columns.iter().map(|(column, _)| table.column(column).unwrap()).collect();
    let row = |cells: &Vec<String>| places.iter().map(|&i| cells[i].as_str()).collect::<Vec<_>>().join(",");
    names.join(",") + "\n" + &table.rows.iter().map(row).collect::<Vec<_>>().join("\n") + "\n"
}

fn numbers(table: &Table, column: &str) -> Vec<f64> {
    table.numbers(column).unwrap().into_iter().map(Option::unwrap).collect()
}

/// Three columns against three of a golden table, relative to the brightest channel, and the bounds of the answers.
fn assert_golden(answers: &Table, ours: &str, golden: &Table, theirs: &str, tolerance: f64, bound: f64) {
    let channels = |table: &Table, name: &str| ["r", "g", "b"].map(|c| numbers(table, &format!("{name}{c}")));
    let (found, expected) = (channels(answers, &format!("{ours}_")), channels(golden, theirs));
    let error = channels(answers, &format!("{ours}_error_"));
    assert!(!answers.rows.is_empty() && answers.rows.len() == golden.rows.len());
    for row in 0..golden.rows.len() {
        let largest = (0..3).map(|c| expected[c][row]).fold(0.0, f64::max);
        for c in 0..3 {
            let off = (found[c][row] - expected[c][row]).abs();
            assert!(off <= tolerance * largest, "{ours} row {row} channel {c}: {off} of {largest}");
            assert!((0.0..=bound * largest).contains(&error[c][row]), "{ours} row {row}: bound {}", error[c][row]);
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
fn golden_queries_are_met() {
    let golden = golden("queries.csv");
    let queries = as_queries(&golden, &[&[("f0", "f0")], &SURFACE[..]].concat());
    let found = answers(&queries, &["--kind", "shading"]);
    // Columns and cells as given, then the answers.
    assert_eq!(found.columns[..11], queries.lines().next().unwrap().split(',').collect::<Vec<_>>());
    assert_eq!(found.columns[11..14], ["specular_r", "specular_g", "specular_b"]);
    assert_eq!(found.columns.len(), 11 + 4 * 6);
    for (row, line) in found.rows.iter().zip(queries.lines().skip(1)) {
        assert_eq!(row[..11].join(","), line);
    }
    assert_golden(&found, "specular", &golden, "spec_schlick_", QUERY_TOLERANCE, BOUND);
    assert_golden(&found, "specular_white", &golden, "spec_F1_", QUERY_TOLERANCE, BOUND);
    assert_golden(&found, "diffuse", &golden, "diff_1mF_over_pi_", QUERY_TOLERANCE, BOUND);
    assert_golden(&found, "lambert", &golden, "lambert_over_pi_", QUERY_TOLERANCE, BOUND);
}

#[test]
fn golden_albedos_are_met() {
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
        for (row, (a, b)) in numbers(&found, ours).iter().zip(numbers(&golden, theirs)).enumerate() {
            assert!((a - b).abs() < 1e-5, "{ours} row {row}: {a} {b}");
        }
    }
    assert!(numbers(&found, "error").iter().all(|error| (0.0..1e-6).contains(error)));

    // White furnace of Phong at alpha 1: the fit creates energy, the exact masking gives GGX's albedo.
    let queries = "brdf,masking,n_dot_v,alpha\nphong,separable,0.1,1\nphong,smith-exact,0.1,1\nggx,smith-exact,0.1,1\n";
    let albedo = numbers(&answers(queries, &["--kind", "dfg"]), "albedo");
    assert!((albedo[0] - 1.141).abs() < 1e-3 && (albedo[1] - 0.558).abs() < 1e-3, "{albedo:?}");
    assert!((albedo[1] - albedo[2]).abs() < 1e-6, "{albedo:?}");
}

#[test]
fn golden_prefiltered_texels_are_met() {
    let golden = golden("prefilter.csv");
    let columns =
        [("rz", "rz"), ("ry", "ry"), ("rx", "rx"), ("alpha", "alpha"), ("model", "brdf"), ("env", "environment")];
    let found = answers(&as_queries(&golden, &columns), &["--kind", "prefilter"]);
    assert_golden(&found, "prefiltered", &golden, "", 1e-3, BOUND);
}

#[test]
fn diffuse_rungs_follow_from_irradiance_and_coefficients() {
    let golden: serde_json::Value = serde_json::from_slice(
        &std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/sh9.json")).unwrap(),
    )
    .unwrap();
    let query = "environment,brdf,alpha,f0,nx,ny,nz,vx,vy,vz\nenv_analytic.exr,ggx,0.25,0.3,0,-1,0,0.6,-0.8,0\n";
    let [rungs, terms] = ["ladder", "shading"].map(|kind| answers(query, &["--kind", kind]));
    let pair = answers("brdf,alpha,n_dot_v\nggx,0.25,0.8\n", &["--kind", "dfg"]);
    let left = 1.0 - (0.3 * numbers(&pair, "f0_scale")[0] + numbers(&pair, "f90_scale")[0]);
    for (c, channel) in ["r", "g", "b"].iter().enumerate() {
        let of = |answers, name: &str| numbers(answers, &format!("{name}_{channel}"))[0];
        let coefficient = |k: usize| golden["envs"]["analytic"]["L_bilinear"][k][c].as_f64().unwrap();
        // E/π at -y: of the nine functions only Y00, Y1-1, Y20 and Y22 are not 0.
        let linear = 0.282094792 * coefficient(0) - 2.0 / 3.0 * 0.488602512 * coefficient(1);
        let truncated = linear - 0.25 * (0.315391565 * coefficient(6) + 0.546274215 * coefficient(8));
        for (name, right) in [
            ("diffuse_fresnel_inside", of(&terms, "diffuse")),
            ("diffuse_reference", left * of(&terms, "lambert")),
            ("diffuse_ladder_truncation", left * truncated),
            ("diffuse_ladder_clamp", left * truncated.max(0.0)),
        ] {
            let (own, bound) = (of(&rungs, name), of(&rungs, &format!("{name}_error")));
            assert!((own - right).abs() <= bound + 2e-6 * coefficient(0), "{name} {channel}: {own}, not {right}");
        }
    }
}

#[test]
fn irradiance_and_coefficients_agree() {
    let golden: serde_json::Value = serde_json::from_slice(
        &std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/sh9.json")).unwrap(),
    )
    .unwrap();
    let found = answers("environment\nenv_analytic.exr\n", &["--kind", "sh9"]);
    let expected = |k: usize, c: usize| golden["envs"]["analytic"]["L_bilinear"][k][c].as_f64().unwrap();
    for (k, name) in ["l00", "l1m1", "l10", "l11", "l2m2", "l2m1", "l20", "l21", "l22"].iter().enumerate() {
        for (c, channel) in ["r", "g", "b"].iter().enumerate() {
            let value = numbers(&found, &format!("{name}_{channel}"))[0];
            assert!((value - expected(k, c)).abs() <= 1e-6 * expected(0, c), "{name} {channel}: {value}");
        }
    }
    // A constant map: E = π L for every normal, and L00 = L √(4π).
    let found = answers(
        "environment,nx,ny,nz\nbuiltin:constant:radiance=2,0,0.6,-0.8\nenv_analytic.exr,0,1,0\n",
        &["--kind", "irradiance", "--tolerance", "1e-7"],
    );
    let irradiance = numbers(&found, "irradiance_g");
    assert!((irradiance[0] / (2.0 * std::f64::consts::PI) - 1.0).abs() < 1e-7, "{irradiance:?}");
    assert!(numbers(&found, "irradiance_error_g").iter().zip(&irradiance).all(|(e, x)| *e <= 1e-7 * x));
}

/// The names of all models, as a message lists them.
fn models() -> String {
    MODELS.iter().map(|model| model.name()).collect::<Vec<_>>().join(", ")
}

/// Runs a table that must be refused: exit code, every expected line of the message and no other, and the old output untouched.
fn assert_refused(queries: &str, arguments: &[&str], code: i32, lines: &[&str]) {
    let dir = folder(queries);
    std::fs::write(dir.path().join("a.csv"), "old").unwrap();
    let output = splitsum(dir.path(), &[&["integrate", "q.csv", "--out", "a.csv"], arguments].concat());
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(code), "{message}");
    let found: Vec<&str> = message.lines().collect();
    assert_eq!(found.len(), lines.len(), "{message}");
    for (found, expected) in found.iter().zip(lines) {
        assert!(found.starts_with(expected), "{found:?} does not begin with {expected:?}");
    }
    assert_eq!(std::fs::read(dir.path().join("a.csv")).unwrap(), b"old");
    assert_eq!(entries(dir.path()), ["a.csv", "env_analytic.exr", "q.csv"]);
}

const HEADER: &str = "environment,brdf,alpha,f0,nx,ny,nz,vx,vy,vz";

#[test]
fn every_fault_of_every_row_is_told_with_its_place() {
    let rows = [
        "env_analytic.exr,ggx,0.2,0.04,0,1,0,0,1,0",
        "env_analytic.exr,ggx,0.2,0.04,0,0,0,0,1,0",
        "env_analytic.exr,ggx,0.2,0.04,0,1,0,0,1,1",
        "env_analytic.exr,ggx,0.2,0.04,0,1,0,0.6,-0.8,0",
        "env_analytic.exr,ggx,0.2,0.04,0,1,0,1,0,0",
        "",
        "env_analytic.exr,ggx,0,0.04,0,1,0,0,1,0",
        "env_analytic.exr,ggx,1.4,0.04,0,1,0,0,1,0",
        "env_analytic.exr,ggx,nan,inf,0,1,0,0,1,x",
        "env_analytic.exr,beckman,0.2,1.5,0,1,0,0,1,0",
        "builtin:ski,ggx,0.2,1:2,0,1,0,0,1,0",
        "none.hdr,ggx,0.2,0.1:0.2:0.3,0,1,0,0,1,0",
        "none.hdr,ggx,-1,0.1:0.2:0.3,0,1,0,0,1,0",
        "env_analytic.exr,ggx,0.2",
    ];
    let queries = format!("{HEADER}\n{}\n", rows.join("\n"));
    assert_refused(
        &queries,
        &[],
        2,
        &[
            "q.csv:3:nx,ny,nz: the vector is zero; expected a unit vector",
            "q.csv:4:vx,vy,vz: (0, 1, 1) has length 1.414213562373",
            "q.csv:5:vx,vy,vz: v is not above the horizon: n·v is -0.8; expected above 0",
            "q.csv:6:vx,vy,vz: v is not above the horizon: n·v is 0; expected above 0",
            "q.csv:8:alpha: 0 is outside (0, 1]",
            "q.csv:9:alpha: 1.4 is outside (0, 1]",
            "q.csv:10:alpha: \"nan\" is not a finite number",
            "q.csv:10:f0: \"inf\" is not a finite number",
            "q.csv:10:vz: \"x\" is not a finite number",
            &format!(
                "q.csv:11:brdf: \"beckman\" is not a BRDF model; did you mean \"beckmann\"?; expected one of {}",
                models()
            ),
            "q.csv:11:f0: 1.5 is outside [0, 1]",
            "q.csv:12:f0: \"1:2\" is neither a number nor R:G:B",
            "q.csv:12:environment: environment builtin:ski: there is no builtin \"ski\"; did you mean \"sky\"?",
            "q.csv:13:environment: environment none.hdr: no such file",
            "q.csv:14:alpha: -1 is outside (0, 1]",
            "q.csv:15: the row has 3 cells; expected 10, as the header",
        ],
    );
}

#[test]
fn faults_of_the_header_come_first() {
    let row = "env_analytic.exr,ggx,9,0.04,0,1,0,0,1,0";
    assert_refused(
        &format!("{}\n{row}\n", HEADER.replace("alpha", "alhpa")),
        &[],
        2,
        &[
            "q.csv:1:alhpa: unknown column for --kind shading; did you mean \"alpha\"?",
            "q.csv:1:alpha: the column is missing; --kind shading expects environment,brdf,alpha,f0,nx,ny,nz,vx,vy,vz",
        ],
    );
    assert_refused(
        &format!("{HEADER},n_dot_v,masking,masking,colour\n{row},1,a,b,red\n"),
        &[],
        2,
        &[
            "q.csv:1:n_dot_v: unknown column for --kind shading; --kind dfg has it",
            "q.csv:1:masking: the column is there twice; expected once",
            "q.csv:1:colour: unknown column for --kind shading; expected environment,",
        ],
    );
    // A column too many does not hide the rows.
    assert_refused(
        &format!("{HEADER},colour\n{row},red\n"),
        &[],
        2,
        &["q.csv:1:colour: unknown column for --kind shading; expected environment,", "q.csv:2:alpha: "],
    );
    assert_refused("", &[], 2, &["q.csv:1: the file is empty; expected a header of environment,"]);
    let masking = "brdf,alpha,n_dot_v,masking\nggx,0.5,0,smith\n";
    assert_refused(
        masking,
        &["--kind", "dfg"],
        2,
        &[
            "q.csv:2:masking: \"smith\" is not a masking-shadowing; expected one of separable,",
            "q.csv:2:n_dot_v: 0 is outside (0, 1]",
        ],
    );
    assert_refused(
        "environment,brdf,alpha,rx,ry,rz,weight\nenv_analytic.exr,ggx,0.5,0,1,0,g1\n",
        &["--kind", "prefilter"],
        2,
        &["q.csv:2:weight: \"g1\" is not a prefilter weight; expected one of cosine, masking, none"],
    );
}

#[test]
fn tables_that_cannot_be_used_at_all() {
    assert_refused(&format!("{HEADER}\n\n"), &[], 3, &["q.csv: no query below the header"]);
    let dir = folder("x");
    for (arguments, code, part) in [
        (&["integrate", "no.csv"][..], 2, "no.csv:1: cannot be read"),
        (&["integrate", "env_analytic.exr"][..], 2, "env_analytic.exr:1: the line is not UTF-8 text"),
        (&["integrate", "q.csv", "--out", "no/a.csv"][..], 2, "--out: there is no folder no"),
        (&["integrate", "q.csv", "--kind", "shade"][..], 2, "did you mean \"shading\"?"),
        (&["integrate", "q.csv", "--tolerance", "2"][..], 2, "2 is outside [1e-9, 0.1]"),
    ] {
        let output = splitsum(dir.path(), arguments);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", stderr(&output));
        assert!(stderr(&output).contains(part), "{arguments:?}: {}", stderr(&output));
    }
}

/// Widths and cosines that f64 cannot answer end in a message, never in NaN or without an end.
#[test]
fn what_has_no_answer_is_refused() {
    let dfg = |row: &str| format!("brdf,alpha,n_dot_v\nggx,0.5,0.5\n{row}\n");
    let below = "q.csv:3:alpha: 1e-300 is below 0.0001, the narrowest lobe that is integrated";
    assert_refused(&dfg("ggx,1e-300,0.5"), &["--kind", "dfg"], 2, &[below]);
    let infinite = "q.csv: the answer to query 2 is not finite (1 in all)";
    assert_refused(&dfg("ggx,0.5,1e-300"), &["--kind", "dfg"], 1, &[infinite]);
}

#[test]
fn spreadsheets_and_editors_leave_their_marks() {
    // A byte order mark, CRLF, blanks around cells, quotes and a blank line change nothing.
    let plain = answers("id,brdf,alpha,n_dot_v\na,ggx,0.5,0.25\nb,phong,0.1,0.9\n", &["--kind", "dfg"]);
    let marked = "\u{feff}id,brdf, alpha ,n_dot_v\r\na,ggx,0.5,0.25\r\n\r\n\"b\",\"phong\", 0.1,0.9\r\n";
    assert_eq!(answers(marked, &["--kind", "dfg"]).rows, plain.rows);
}
