//! The published runs of this repository: their site, and the comparison with a repeated run.

use crate::scratch::scratch;
use splitsum::report::gallery::{BYTES_MAX, INDEX_FILE, write};
use std::path::{Path, PathBuf};
use std::process::Command;

fn pages(folder: &Path) -> Vec<PathBuf> {
    let paths = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let of = |path: PathBuf| {
        if path.is_dir() {
            pages(&path)
        } else {
            vec![path]
        }
    };
    paths
        .flat_map(of)
        .filter(|path| path.extension().is_some_and(|end| end == "html"))
        .collect()
}

fn targets(page: &str) -> impl Iterator<Item = &str> {
    let after = |mark| {
        page.split(mark)
            .skip(1)
            .filter_map(|rest: &str| rest.split('"').next())
    };
    let all = after("href=\"")
        .chain(after("src=\""))
        .map(|link| link.split('#').next().unwrap_or_default());
    all.filter(|link| !link.is_empty() && !link.starts_with("data:"))
}

#[test]
fn the_site_has_every_published_run_and_no_link_leads_nowhere() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let dir = scratch();
    let out = dir.join("site");
    let (bytes, notes) = write(&root.join("results"), &[], &out).unwrap();
    assert!(bytes < BYTES_MAX && notes.is_empty(), "{bytes} {notes:?}");
    let pages = pages(&out);
    for page in &pages {
        let text = std::fs::read_to_string(page).unwrap();
        for link in targets(&text) {
            assert!(
                page.parent().unwrap().join(link).is_file(),
                "{}: {link}",
                page.display()
            );
        }
    }
    let index = std::fs::read_to_string(out.join(INDEX_FILE)).unwrap();
    // The numbers of the block in README.md, of the table of bakers, and one card for each run.
    let readme = std::fs::read_to_string(root.join("README.md")).unwrap();
    let row = readme
        .lines()
        .find(|line| line.starts_with("| split-sum-two "))
        .unwrap();
    row.split('|')
        .for_each(|cell| assert!(index.contains(cell.trim()), "{cell}"));
    assert!(index.contains("<td>cmgen (Filament) 1.9.25</td>"));
    let runs = pages
        .iter()
        .filter(|page| page.ends_with("summary.html"))
        .count();
    assert_eq!((index.matches("<article").count(), runs > 10), (runs, true));
    // A second time it replaces the site; folders of others stay.
    write(&root.join("results"), &[], &out).unwrap();
    std::fs::remove_file(out.join(INDEX_FILE)).unwrap();
    let error = write(&root.join("results"), &[], &out).unwrap_err();
    assert!(
        error.is_misuse() && error.to_string().contains("choose a new folder"),
        "{error}"
    );
    let error = write(&root.join("shaders"), &[], &dir.join("other")).unwrap_err();
    assert!(
        error
            .to_string()
            .ends_with("published run; expected the folder of `splitsum answers --publish`"),
        "{error}"
    );
}

#[test]
fn a_repeated_run_agrees_within_its_own_errors_alone() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let published = root.join("results/coat/answers");
    let compare = |file: &str, from: &str, to: &str| {
        let new = scratch();
        for name in [
            "effect.csv",
            "effect_digest.csv",
            "error.csv",
            "error_digest.csv",
        ] {
            std::fs::copy(published.join(name), new.join(name)).unwrap();
        }
        let text = std::fs::read_to_string(new.join(file)).unwrap();
        assert!(text.contains(from), "{from}");
        std::fs::write(new.join(file), text.replacen(from, to, 1)).unwrap();
        let script = root.join("scripts/compare_answers.py");
        Some(
            Command::new("python3")
                .arg(script)
                .args([&published, &new])
                .output()
                .ok()?
                .status
                .success(),
        )
    };
    // Its noise floor is 1.1e-5: an rms of 0.0323 may become 0.0370. The ratio is unresolved.
    let error = |new| compare("error.csv", "0.0010428935542639984", new);
    let Some(is_same) = compare("effect_digest.csv", "1.7 (95", "1.7 (95") else {
        return eprintln!("skipped: no Python");
    };
    let digest = |new| compare("effect_digest.csv", "1.7 (95 % 1.6 to 1.9)", new);
    let found = [
        digest("1.8 (95 % 1.5 to 3)"),
        error("0.0012"),
        compare("effect.csv", "1.0571098240805465", "7"),
    ];
    assert!(is_same && found == [Some(true); 3], "{found:?}");
    let found = [
        digest("2.0 (95 % 1.6 to 2.9)"),
        digest("1.7"),
        error("0.002"),
        compare("error_digest.csv", "0.0079 (", "0.0089 ("),
    ];
    assert_eq!(found, [Some(false); 4]);
}

/// Three maps, one surface: two of three fits of the textbook are within its interval of
/// roughness, one within its interval of F0. Fits of parts of a photo do not count, nor does a
/// loss without a prediction.
#[test]
fn fits_within_the_predictions_of_another_run_are_counted() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let dir = scratch();
    for folder in ["published/answers", "run", "out"] {
        std::fs::create_dir_all(dir.join(folder)).unwrap();
    }
    let write = |name: &str, text: &str| std::fs::write(dir.join(name), text).unwrap();
    write(
        "published/answers/recovery.csv",
        "scene,perceptual_roughness,f0,method,loss,n_dot_v_from,n_dot_v_to,\
         new_roughness_lo,new_roughness_hi,new_f0_ratio_lo,new_f0_ratio_hi\n\
         sphere,0.7,0.5,split-sum,mse,0,1,0.8,0.9,1.2,1.4\n\
         sphere,0.7,0.5,split-sum,mse,0,0.2,0,1,0,3\n\
         sphere,0.7,0.5,split-sum,relative,0,1,,,,\n",
    );
    write(
        "run/errors.csv",
        "cell,scene,method\n\
         photo,sphere,reference\n\
         textbook,sphere,split-sum\n",
    );
    write(
        "run/recovery.csv",
        "cell,candidate,loss,n_dot_v_from,n_dot_v_to,true_roughness,true_f0,roughness,f0\n\
         photo,textbook,mse,0,1,0.7000000000000001,0.5,0.85,0.65\n\
         photo,textbook,mse,0,1,0.7,0.5,0.9001,0.75\n\
         photo,textbook,mse,0,1,0.7,0.5,0.95,0.5\n\
         photo,textbook,mse,0,0.2,0.7,0.5,0.5,0.5\n\
         photo,textbook,relative,0,1,0.7,0.5,0.5,0.5\n",
    );
    let output = Command::new("python3")
        .arg(root.join("scripts/check_predictions.py"))
        .args(["published", "run", "out"].map(|folder| dir.join(folder)))
        .output();
    let Ok(output) = output else {
        return eprintln!("skipped: no Python");
    };
    let said = String::from_utf8(output.stdout).unwrap();
    assert_eq!(
        said,
        "roughness: 2 of 3 fits within their prediction interval (66.7 %)\n\
         f0: 1 of 3 fits within their prediction interval (33.3 %)\n"
    );
    let read = |name: &str| std::fs::read_to_string(dir.join("out").join(name)).unwrap();
    assert_eq!(
        read("predictions.csv").lines().nth(1).unwrap(),
        "sphere,0.7,0.5,split-sum,mse,3,2,0.8,0.9,0.85,0.95,1,1.2,1.4,1.0,1.5"
    );
    assert_eq!(
        read("predictions_digest.csv").lines().last().unwrap(),
        "sphere,0.5,split-sum,mse,2 of 3,1 of 3"
    );
}

/// Between published values of roughness a prediction follows the line between them, wider by how
/// far the published ones bend; beyond them there is none.
#[test]
fn predictions_between_published_roughnesses_are_interpolated() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    // Middles of the logarithm 0, 0.1, 0 at 0.3, 0.5, 0.7, halves of widths 0.02, 0.04, 0.06. The
    // second difference is -2.5, Student's quantile of one degree of freedom 12.706.
    let script = r#"
import math
from check_predictions import Law, interpolated

law = Law({r: (math.exp(y - h), math.exp(y + h)) for r, y, h in [(0.3, 0, 0.02), (0.5, 0.1, 0.04), (0.7, 0, 0.06)]})
lo, hi = map(math.log, law.between(0.6))
half = math.hypot(0.05, 12.706 * 2.5 * 0.1 * 0.1)
assert abs(lo - (0.05 - half)) < 1e-9 and abs(hi - (0.05 + half)) < 1e-9, (lo, hi)
assert law.between(0.2) is None and law.between(0.8) is None
# A straight series is as wide between as at its ends. Intervals are of the bias, so they scale with roughness.
straight = {("sphere", r, 1, "split-sum", "mse"): (0.9 * r, 1.1 * r, 0.8, 1.25) for r in (0.2, 0.4, 0.7)}
found = interpolated(straight, ("sphere", 0.5, 1, "split-sum", "mse"))
assert max(abs(a - b) for a, b in zip(found, (0.45, 0.55, 0.8, 1.25))) < 1e-9, found
assert interpolated(straight, ("sphere", 0.5, 1, "split-sum", "relative")) is None
"#;
    assert_python(&root.join("scripts"), script);
}

/// In 2,000 simulated studies of ten maps, whose bias bends over roughness by chance, 95 % intervals
/// between six published values hold 93 to 99 % of the fits under one further map. Without the
/// error of the line they hold fewer.
#[test]
fn predictions_between_published_roughnesses_have_their_coverage() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let script = r#"
import math, random
import check_predictions
from check_predictions import Law

PUBLISHED = [0.2, 0.3, 0.4, 0.5, 0.7, 0.9]
T_9 = 2.262

def study():
    """The fits of ten maps and of one further map, by roughness: a bend that all share, and a spread."""
    waves = [(random.gauss(0, 0.06), random.uniform(5, 12), random.uniform(0, 6.3)) for _ in range(2)]
    bend = lambda r: sum(a * math.sin(k * r + p) for a, k, p in waves)
    maps = [(random.gauss(0, 0.015), random.gauss(0, 0.015)) for _ in range(11)]
    value = lambda m, r: bend(r) + m[0] + m[1] * (r - 0.5)
    return maps, value

def prediction(values):
    mean = sum(values) / len(values)
    variance = sum((x - mean) ** 2 for x in values) / (len(values) - 1)
    half = T_9 * math.sqrt(variance * (1 + 1 / len(values)))
    return math.exp(mean - half), math.exp(mean + half)

def coverage():
    random.seed(7)
    held = total = 0
    for _ in range(2000):
        (*maps, further), value = study()
        law = Law({r: prediction([value(m, r) for m in maps]) for r in PUBLISHED})
        for r in (0.25, 0.45, 0.6, 0.8):
            lo, hi = law.between(r)
            held += lo <= math.exp(value(further, r)) <= hi
            total += 1
    return held / total

with_error = coverage()
check_predictions.student = lambda degrees: 0.0
without = coverage()
assert 0.93 < with_error < 0.99 and without < 0.9, (with_error, without)
"#;
    assert_python(&root.join("scripts"), script);
}

/// Runs a script that imports modules of a folder; skips without Python.
fn assert_python(folder: &Path, script: &str) {
    let output = Command::new("python3")
        .args(["-B", "-c", script])
        .env("PYTHONPATH", folder)
        .output();
    match output {
        Ok(output) => assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        ),
        Err(_) => eprintln!("skipped: no Python"),
    }
}
