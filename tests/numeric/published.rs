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
        compare("error_digest.csv", "0.0073 (", "0.0083 ("),
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
