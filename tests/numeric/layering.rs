//! The structure in docs/architecture.md, checked against the source files: imports, unsafe code,
//! lengths of files, and citations.

mod circles;
mod source;
mod texts;

use circles::first_circle;
use source::{code, comments, imports, module_of, words};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The lists that order modules: a module imports only from those before it in its list, so the
/// documents that name the rooms in order are the rule itself.
const LISTS: &[&str] = &["src/lib.rs", "src/base/mod.rs", "src/instrument/mod.rs"];

/// Modules of the instrument that metrics may import: they see images, a mask and the tone curve,
/// never a method.
const SEEN_BY_METRICS: &[&str] = &["metrics", "tonemap"];

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

/// Names of the modules of a list, in order.
fn listed_modules(list: &str) -> Vec<String> {
    code(&read(Path::new(list)))
        .lines()
        .filter_map(|line| line.trim().strip_prefix("pub mod ")?.strip_suffix(';'))
        .map(str::to_owned)
        .collect()
}

/// Whether a list allows an import of one of its modules from another. Paths below other folders
/// are none of its business.
fn may_import(list: &str, from: &[String], to: &[String]) -> bool {
    let folder = module_of(Path::new(list));
    let child = |path: &[String]| {
        path.strip_prefix(folder.as_slice())
            .and_then(|rest| rest.first().cloned())
    };
    let (Some(from), Some(to)) = (child(from), child(to)) else {
        return true;
    };
    let modules = listed_modules(list);
    let position = |name: &String| modules.iter().position(|module| module == name);
    from == to || matches!((position(&from), position(&to)), (Some(from), Some(to)) if to < from)
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
fn lib_rs_and_the_page_describe_every_folder_in_order() {
    let modules = listed_modules("src/lib.rs");
    let described: Vec<String> = read(Path::new("src/lib.rs"))
        .lines()
        .filter_map(|line| line.strip_prefix("//! - [`")?.split_once("`] "))
        .map(|(name, _)| name.to_owned())
        .collect();
    assert_eq!(described, modules);
    let folders: BTreeSet<String> = fs::read_dir(root().join("src"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_dir())
        .map(|path| path.file_name().unwrap().to_str().unwrap().to_owned())
        .collect();
    let named: Vec<String> = modules.into_iter().chain(["cli".to_owned()]).collect();
    assert_eq!(folders, BTreeSet::from_iter(named.iter().cloned()));
    let page = read(Path::new("docs/architecture.md"));
    let (_, table) = page.split_once("| folder | job |").unwrap();
    let rows: Vec<String> = table
        .lines()
        .skip(2)
        .map_while(|line| line.strip_prefix("| `")?.split_once('`'))
        .map(|(name, _)| name.to_owned())
        .collect();
    assert_eq!(rows, named);
}

#[test]
fn modules_import_only_from_those_before_them() {
    for (file, paths) in library_imports() {
        let from = module_of(&file);
        let is_metric = from.starts_with(&["instrument".to_owned(), "metrics".to_owned()]);
        for path in &paths {
            for list in LISTS {
                assert!(
                    may_import(list, &from, path),
                    "{} imports {}: see the order in {list}",
                    file.display(),
                    path.join("::")
                );
            }
            let is_seen = path.first().is_none_or(|folder| folder != "instrument")
                || path
                    .get(1)
                    .is_some_and(|module| SEEN_BY_METRICS.contains(&module.as_str()));
            assert!(
                !is_metric || is_seen,
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
    "instrument::brdf",
    "instrument::tonemap",
    "instrument::metrics::Epsilon",
    "instrument::ladder",
    "instrument::shade::METHODS",
    "instrument::shade::DIFFUSE",
    "instrument::shade::Method",
    "instrument::shade::Diffuse",
];

#[test]
fn cache_keys_contain_all_code_that_makes_the_entries() {
    let is_host = |file: &Path| {
        splitsum::instrument::gpu::HOST_FILES
            .iter()
            .any(|host| Path::new("src").join(host) == file)
    };
    let files = rust_files();
    // The files that make the entries; the loop below finds their imports.
    for file in [
        "src/instrument/pipeline/kept_reference.rs",
        "src/instrument/shade/reference_pass.rs",
        "src/instrument/shade/pass.rs",
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
