//! The structure in docs/architecture.md, checked against the source files: imports, unsafe code,
//! lengths of files, and citations.

mod circles;
mod source;

use circles::first_circle;
use source::{code, comments, imports, module_of, words};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Rows from low to high. Columns of a row are independent; a column lists its modules in order. A
/// module imports only from lower rows, or from earlier modules of its column.
const ROWS: &[&[&[&str]]] = &[
    &[&["glsl", "spelling", "math", "color", "files", "pixels"]],
    &[&["brdf", "environment", "scene"], &["gpu"]],
    &[
        &["precompute", "gbuffer", "tonemap", "metrics", "shade"],
        &["table", "figure"],
    ],
    &[&["bakes"], &["ladder"]],
    &[&["pipeline"], &["oracle"], &["cost"]],
    &[&["experiment", "run"]],
    &[&["study", "report"], &["view"]],
];

/// Metrics see images, a mask and the tone curve, never a method.
const SEEN_BY_METRICS: &[&str] = &[
    "glsl", "spelling", "math", "color", "files", "pixels", "tonemap",
];

/// Longest source file without a reason, lines.
const LINES_MAX: usize = 500;
/// Start of the line that gives the reason for a longer file.
const REASON: &str = "Long because ";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Files of the project below a folder with one of the extensions, relative to the project, sorted.
pub fn files(folder: &str, extensions: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![root().join(folder)];
    while let Some(dir) = open.pop() {
        for entry in fs::read_dir(&dir).unwrap_or_else(|error| panic!("{}: {error}", dir.display()))
        {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path
                .extension()
                .is_some_and(|e| extensions.iter().any(|wanted| e == *wanted))
            {
                found.push(path.strip_prefix(root()).unwrap().to_owned());
            }
        }
    }
    found.sort();
    assert!(!found.is_empty(), "{folder} holds no {extensions:?}");
    found
}

pub fn read(path: &Path) -> String {
    fs::read_to_string(root().join(path))
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn rust_files() -> Vec<PathBuf> {
    files("src", &["rs"])
}

fn shader_files() -> Vec<PathBuf> {
    files("shaders", &["rs", "glsl", "comp", "vert", "frag"])
}

/// The place of a top-level module: row, column, place in the column.
fn place(module: &str) -> Option<(usize, usize, usize)> {
    ROWS.iter().enumerate().find_map(|(row, columns)| {
        columns.iter().enumerate().find_map(|(column, modules)| {
            modules
                .iter()
                .position(|name| *name == module)
                .map(|position| (row, column, position))
        })
    })
}

fn may_import(from: &str, to: &str) -> bool {
    let (Some(a), Some(b)) = (place(from), place(to)) else {
        return false;
    };
    from == to || b.0 < a.0 || (b.0 == a.0 && b.1 == a.1 && b.2 < a.2)
}

/// Files of the library with their imports from it; `main.rs` and the command line are the top row.
fn library_imports() -> BTreeMap<PathBuf, BTreeSet<Vec<String>>> {
    let is_library = |file: &PathBuf| {
        module_of(file)
            .first()
            .is_some_and(|top| !["main", "cli"].contains(&top.as_str()))
    };
    let with_imports = |file: PathBuf| {
        let found = imports(&module_of(&file), &code(&read(&file)));
        (file, found)
    };
    rust_files()
        .into_iter()
        .filter(is_library)
        .map(with_imports)
        .collect()
}

#[test]
fn every_module_has_its_place() {
    let text = code(&read(Path::new("src/lib.rs")));
    let named: BTreeSet<&str> = text
        .lines()
        .filter_map(|line| line.trim().strip_prefix("pub mod "))
        .collect();
    let placed: BTreeSet<String> = ROWS
        .iter()
        .flat_map(|row| row.concat())
        .map(|name| format!("{name};"))
        .collect();
    assert_eq!(named, placed.iter().map(String::as_str).collect());
}

#[test]
fn modules_import_only_from_below() {
    for (file, paths) in library_imports() {
        let module = module_of(&file);
        let Some(from) = module.first() else { continue };
        for path in paths.iter().filter(|path| !path.is_empty()) {
            let to = &path[0];
            assert!(
                may_import(from, to),
                "{} imports {}: {from} may not see {to}",
                file.display(),
                path.join("::")
            );
            assert!(
                from != "metrics" || to == "metrics" || SEEN_BY_METRICS.contains(&to.as_str()),
                "{} imports {}: metrics see images and a mask only",
                file.display(),
                path.join("::")
            );
        }
    }
}

#[test]
fn neither_files_nor_folders_form_import_cycles() {
    let modules: BTreeMap<Vec<String>, (PathBuf, BTreeSet<Vec<String>>)> = library_imports()
        .into_iter()
        .map(|(file, paths)| (module_of(&file), (file, paths)))
        .collect();
    assert_eq!(first_circle(&modules), None);
}

#[test]
fn references_and_passes_do_not_know_each_other() {
    for (file, paths) in library_imports() {
        let stem = file.file_stem().unwrap().to_str().unwrap();
        let forbidden: &[&str] = match stem {
            "reference" => &["gpu", "pass", "reference_pass"],
            _ if stem.ends_with("pass") => &["reference"],
            _ => continue,
        };
        for path in paths {
            let seen = path.iter().find(|part| forbidden.contains(&part.as_str()));
            assert_eq!(seen, None, "{} imports {}", file.display(), path.join("::"));
        }
    }
}

/// Items that hashed host files may name although their code is not hashed: names and flags of
/// models and methods, work on a finished image, and an ε, whose value is in the key.
const SEEN_BY_HOST: &[&str] = &[
    "brdf",
    "tonemap",
    "metrics::Epsilon",
    "ladder",
    "shade::METHODS",
    "shade::DIFFUSE",
    "shade::Method",
    "shade::Diffuse",
];

#[test]
fn cache_keys_contain_all_code_that_makes_the_entries() {
    let is_host = |file: &Path| {
        splitsum::gpu::HOST_FILES
            .iter()
            .any(|host| Path::new("src").join(host) == file)
    };
    let files = rust_files();
    // The files that make the entries; the loop below finds their imports.
    for file in [
        "src/pipeline/kept_reference.rs",
        "src/shade/reference_pass.rs",
        "src/shade/pass.rs",
    ] {
        assert!(is_host(Path::new(file)), "{file}");
    }
    for (file, paths) in library_imports().iter().filter(|(file, _)| is_host(file)) {
        for path in paths {
            // The file with the longest matching prefix.
            let source = |length: usize| {
                files
                    .iter()
                    .find(|file| !path[..length].is_empty() && module_of(file) == path[..length])
            };
            let Some(source) = (1..=path.len()).rev().find_map(source) else {
                continue;
            };
            let is_seen = SEEN_BY_HOST
                .iter()
                .any(|seen| path.join("::").starts_with(seen));
            assert!(
                is_host(source) || is_seen,
                "{} depends on {}, whose hash is not kept",
                file.display(),
                path.join("::")
            );
        }
    }
}

#[test]
fn long_files_have_a_reason() {
    for file in [rust_files(), shader_files()].concat() {
        let text = read(&file);
        let lines = text.lines().count();
        let head = text
            .lines()
            .map_while(|line| line.strip_prefix("//"))
            .map(|line| line.trim_start_matches(['!', ' ']));
        let has_reason = head.into_iter().any(|line| line.starts_with(REASON));
        assert!(
            lines <= LINES_MAX || has_reason,
            "{}: {lines} lines, and no reason",
            file.display()
        );
    }
}

/// Whether a word looks like a citation: a name and a year of two digits, or the number of a
/// recommendation.
fn is_key(word: &str) -> bool {
    let name = word.trim_end_matches(|c: char| c.is_ascii_digit());
    let digits = word.len() - name.len();
    name.len() >= 2
        && name.starts_with(|c: char| c.is_ascii_uppercase())
        && name.chars().all(|c| c.is_ascii_alphabetic())
        && (digits == 2 || digits == 3)
}

/// Keys in square brackets: `[Karis13 eq. 7]`, `[Walter07, eq. 14; Kim22 "IBL"]`.
fn keys(text: &str) -> BTreeSet<String> {
    let brackets = text
        .split('[')
        .skip(1)
        .filter_map(|rest| rest.split_once(']'))
        .map(|(inside, _)| inside);
    brackets
        .flat_map(|inside| words(inside).map(|(_, word)| word))
        .filter(|w| is_key(w))
        .map(str::to_owned)
        .collect()
}

#[test]
fn every_citation_resolves() {
    let bibliography = read(Path::new("docs/bibliography.md")).replace('\n', " ");
    let entries: Vec<&str> = bibliography
        .split(" - ")
        .filter_map(|entry| entry.trim().split_once(": "))
        .map(|(key, _)| key)
        .collect();
    let resolved: BTreeSet<String> = entries.iter().map(|key| key.to_string()).collect();
    assert!(entries.iter().all(|key| is_key(key)), "{entries:?}");
    assert!(
        entries.is_sorted() && resolved.len() == entries.len(),
        "in alphabetical order, each once: {entries:?}"
    );

    assert_eq!(
        keys("x[0] [Karis13 eq. 7], [Walter07, eq. 14; Kim22 \"IBL\"], [L00]")
            .into_iter()
            .collect::<Vec<_>>(),
        ["Karis13", "Kim22", "Walter07"]
    );
    let mut cited = BTreeSet::new();
    let commented = [rust_files(), shader_files(), files("tests", &["rs"])].concat();
    let sources = commented.iter().map(|file| (file, comments(&read(file))));
    let pages = files("docs", &["md"]);
    let pages = pages.iter().map(|file| (file, read(file)));
    for (file, text) in sources.chain(pages) {
        for key in keys(&text) {
            assert!(
                resolved.contains(&key),
                "{}: [{key}] is not in docs/bibliography.md",
                file.display()
            );
            cited.insert(key);
        }
    }
    let idle: Vec<&String> = resolved.difference(&cited).collect();
    assert!(
        idle.is_empty(),
        "in the bibliography and cited nowhere: {idle:?}"
    );
}
