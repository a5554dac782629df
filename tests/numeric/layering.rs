//! The layout that docs/architecture.md promises, read from the source files: who may import whom, where unsafe code lives,
//! that lists and files agree, and that every citation resolves.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Rows from low to high; a row holds columns that do not know each other, and a column its modules in order. A module imports only
/// from lower rows or from earlier in its own column.
const ROWS: &[&[&[&str]]] = &[
    &[&["glsl", "math", "color", "files", "spelling", "pixels"]],
    &[&["brdf", "environment", "scene"], &["gpu"]],
    &[&["precompute", "gbuffer", "shade", "tonemap"]],
    &[&["metrics"], &["table"]],
    &[&["pipeline"], &["oracle"], &["slips"]],
    &[&["runner"]],
    &[&["study"]],
];

/// What metrics see: images, a mask and the tone curve, never a method.
const SEEN_BY_METRICS: &[&str] = &["glsl", "math", "color", "files", "pixels", "tonemap"];

/// Names that say nothing about a file's subject.
const EMPTY_NAMES: &[&str] = &["util", "utils", "helper", "helpers", "common", "misc"];

/// Longest source file, lines.
const LINES_MAX: usize = 500;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Files below a folder of the project with one of the extensions, relative to the project, in order.
fn files(folder: &str, extensions: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![root().join(folder)];
    while let Some(dir) = open.pop() {
        for entry in fs::read_dir(&dir).unwrap_or_else(|error| panic!("{}: {error}", dir.display())) {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|e| extensions.iter().any(|wanted| e == *wanted)) {
                found.push(path.strip_prefix(root()).unwrap().to_owned());
            }
        }
    }
    found.sort();
    assert!(!found.is_empty(), "{folder} holds no {extensions:?}");
    found
}

fn read(path: &Path) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn rust_files() -> Vec<PathBuf> {
    files("src", &["rs"])
}

fn shader_files() -> Vec<PathBuf> {
    files("shaders", &["rs", "glsl", "comp", "vert", "frag"])
}

/// A source text taken apart: code without comments and literals, and the comments without their markers, one space a line break.
#[derive(Default)]
struct Text {
    code: String,
    comments: String,
}

impl Text {
    fn of(source: &str) -> Self {
        let chars: Vec<char> = source.chars().collect();
        let at = |i: usize| chars.get(i).copied().unwrap_or('\0');
        let find = |from: usize, end: &str| {
            let end: Vec<char> = end.chars().collect();
            (from..chars.len()).find(|&i| chars[i..].starts_with(&end)).map_or(chars.len(), |i| i + end.len())
        };
        let mut text = Self::default();
        let mut i = 0;
        while i < chars.len() {
            i = match (at(i), at(i + 1)) {
                ('/', '/') => {
                    let end = find(i, "\n");
                    let line: String = chars[i..end].iter().collect();
                    text.comments += line.trim_start_matches(['/', '!']).trim();
                    text.comments.push(' ');
                    text.code.push('\n');
                    end
                }
                ('/', '*') => find(i, "*/"),
                ('r', '"' | '#') if !at(i.wrapping_sub(1)).is_alphanumeric() && at(i.wrapping_sub(1)) != '_' => {
                    let hashes = chars[i + 1..].iter().take_while(|c| **c == '#').count();
                    let quote = i + 1 + hashes;
                    // A raw identifier (r#type) has no quote.
                    if at(quote) == '"' { find(quote + 1, &format!("\"{}", "#".repeat(hashes))) } else { quote }
                }
                ('"', _) => {
                    let mut end = i + 1;
                    while end < chars.len() && at(end) != '"' {
                        end += if at(end) == '\\' { 2 } else { 1 };
                    }
                    end + 1
                }
                ('\'', '\\') => find(i + 3, "'"),
                ('\'', _) if at(i + 2) == '\'' => i + 3,
                (c, _) => {
                    text.code.push(c);
                    i + 1
                }
            };
        }
        text
    }
}

/// Identifiers of a text, with where each begins.
fn words(code: &str) -> impl Iterator<Item = (usize, &str)> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    code.split(move |c: char| !is_word(c))
        .filter(|word| !word.is_empty())
        .map(move |word| (word.as_ptr() as usize - code.as_ptr() as usize, word))
}

/// Module of a file below `src`: `src/a/b.rs` and `src/a/b/mod.rs` are `[a, b]`.
fn module_of(file: &Path) -> Vec<String> {
    let path = file.strip_prefix("src").unwrap().with_extension("");
    let mut module: Vec<String> = path.iter().map(|part| part.to_str().unwrap().to_owned()).collect();
    if module.last().is_some_and(|last| last == "mod" || last == "lib") {
        module.pop();
    }
    module
}

/// Every path that code of `module` names by `crate::` or `super::`, from the crate's root, trees in braces multiplied out.
fn imports(module: &[String], code: &str) -> BTreeSet<Vec<String>> {
    let mut found = BTreeSet::new();
    for (start, word) in words(code) {
        // The second `super` of `super::super` belongs to the first.
        if !["crate", "super"].contains(&word) || code[..start].ends_with("::") {
            continue;
        }
        let mut base = if word == "crate" { Vec::new() } else { module[..module.len() - 1].to_vec() };
        let mut rest = &code[start + word.len()..];
        while let Some(after) = rest.strip_prefix("::super") {
            base.pop();
            rest = after;
        }
        expand(rest, &base, &mut found);
    }
    found
}

/// Reads `::name`, `::{...}` and `::*` after `base`; returns what follows.
fn expand<'t>(text: &'t str, base: &[String], found: &mut BTreeSet<Vec<String>>) -> &'t str {
    let end = text.trim_start();
    let Some(rest) = end.strip_prefix("::").map(str::trim_start) else {
        found.insert(base.to_vec());
        return end;
    };
    if let Some(mut rest) = rest.strip_prefix('{') {
        loop {
            // Each item of the tree stands as if after `::`.
            rest = rest.trim_start();
            if let Some(after) = rest.strip_prefix('}') {
                return after;
            }
            let name = rest.len() - rest.trim_start_matches(|c: char| c.is_alphanumeric() || c == '_').len();
            let mut path = base.to_vec();
            if &rest[..name] != "self" {
                path.push(rest[..name].to_owned());
            }
            rest = expand(&rest[name..], &path, found);
            // Past ` as other` and the comma.
            let next = rest.find([',', '}']).expect("a use tree is closed");
            rest = rest[next..].trim_start_matches(',');
        }
    }
    let name = rest.len() - rest.trim_start_matches(|c: char| c.is_alphanumeric() || c == '_').len();
    let mut path = base.to_vec();
    if name > 0 {
        path.push(rest[..name].to_owned());
        return expand(&rest[name..], &path, found);
    }
    found.insert(path);
    rest
}

/// The place of a top-level module: row, column, place in the column.
fn place(module: &str) -> Option<(usize, usize, usize)> {
    ROWS.iter().enumerate().find_map(|(row, columns)| {
        columns.iter().enumerate().find_map(|(column, modules)| {
            modules.iter().position(|name| *name == module).map(|position| (row, column, position))
        })
    })
}

fn may_import(from: &str, to: &str) -> bool {
    let (Some(a), Some(b)) = (place(from), place(to)) else { return false };
    from == to || b.0 < a.0 || (b.0 == a.0 && b.1 == a.1 && b.2 < a.2)
}

/// Files of the library with their imports into it; `main.rs` and the command line are the row above all.
fn library_imports() -> BTreeMap<PathBuf, BTreeSet<Vec<String>>> {
    let is_library =
        |file: &PathBuf| module_of(file).first().is_some_and(|top| !["main", "cli"].contains(&top.as_str()));
    let with_imports = |file: PathBuf| {
        let found = imports(&module_of(&file), &Text::of(&read(&file)).code);
        (file, found)
    };
    rust_files().into_iter().filter(is_library).map(with_imports).collect()
}

#[test]
fn the_reader_of_imports_sees_what_the_compiler_sees() {
    let source = r##"
        //! crate::comment
        use crate::{gpu::{self, Gpu as G}, shade};
        use super::super::math::*;
        use super::pass;
        const A: char = '"'; const S: &str = "crate::text \" crate::text"; const R: &str = r#"crate::raw " "#;
        fn f<'a>(x: &'a str) -> crate::scene::Camera { pub(crate) use self::x; 'q' /* crate::block */ }
    "##;
    let text = Text::of(source);
    let module = ["shade", "method", "x"].map(str::to_owned);
    let found: Vec<String> = imports(&module, &text.code).iter().map(|path| path.join("::")).collect();
    // `pub(crate)` names the crate itself: an empty path.
    let expected = ["", "gpu", "gpu::Gpu", "scene::Camera", "shade", "shade::math", "shade::method::pass"];
    assert_eq!(found, expected);
    assert_eq!(text.comments.trim(), "crate::comment");

    assert!(may_import("shade", "brdf") && may_import("shade", "gbuffer") && may_import("shade", "gpu"));
    assert!(!may_import("gbuffer", "shade") && !may_import("gpu", "brdf") && !may_import("scene", "gpu"));
    assert!(!may_import("table", "metrics") && !may_import("metrics", "table") && !may_import("pixels", "pipeline"));
}

#[test]
fn every_module_has_its_place() {
    let text = Text::of(&read(Path::new("src/lib.rs"))).code;
    let named: BTreeSet<&str> = text.lines().filter_map(|line| line.trim().strip_prefix("pub mod ")).collect();
    let placed: BTreeSet<String> = ROWS.iter().flat_map(|row| row.concat()).map(|name| format!("{name};")).collect();
    assert_eq!(named, placed.iter().map(String::as_str).collect());
}

#[test]
fn modules_import_only_from_below() {
    for (file, paths) in library_imports() {
        let module = module_of(&file);
        let Some(from) = module.first() else { continue };
        for path in paths.iter().filter(|path| !path.is_empty()) {
            let to = &path[0];
            assert!(may_import(from, to), "{} imports {}: {from} may not see {to}", file.display(), path.join("::"));
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
fn shared_numbers_depend_on_nothing() {
    // The build script includes these files, where the rest of the crate does not exist.
    for (file, paths) in library_imports().iter().filter(|(file, _)| file.starts_with("src/glsl")) {
        assert!(paths.iter().all(|path| path[..] == ["glsl"] || path.is_empty()), "{}: {paths:?}", file.display());
    }
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

/// What files of the host's hash may name without its code being in it: names and flags of models and methods, and what is done with a
/// finished image.
const SEEN_BY_HOST: &[&str] =
    &["brdf", "tonemap", "shade::METHODS", "shade::DIFFUSE", "shade::Method", "shade::Diffuse"];

#[test]
fn kept_results_hang_on_all_code_that_makes_them() {
    let is_host = |file: &Path| splitsum::gpu::HOST_FILES.iter().any(|host| Path::new("src").join(host) == file);
    let files = rust_files();
    for (file, paths) in library_imports().iter().filter(|(file, _)| is_host(file)) {
        for path in paths {
            // The file of the longest prefix.
            let source = |length: usize| {
                files.iter().find(|file| !path[..length].is_empty() && module_of(file) == path[..length])
            };
            let Some(source) = (1..=path.len()).rev().find_map(source) else { continue };
            let is_seen = SEEN_BY_HOST.iter().any(|seen| path.join("::").starts_with(seen));
            assert!(
                is_host(source) || is_seen,
                "{} hangs on {}, whose hash is not kept",
                file.display(),
                path.join("::")
            );
        }
    }
}

#[test]
fn unsafe_code_lives_in_gpu_only() {
    let mut count = 0;
    for file in rust_files() {
        let code = Text::of(&read(&file)).code;
        let here = words(&code).filter(|(_, word)| *word == "unsafe").count();
        let allowed = code.contains("allow(unsafe_code)");
        if file.starts_with("src/gpu") {
            count += here;
        } else {
            assert!(here == 0 && !allowed, "{}: unsafe code", file.display());
        }
    }
    assert!(count > 0, "the search finds nothing at all");
}

#[test]
fn names_say_their_subject() {
    for file in [rust_files(), shader_files(), files("tests", &["rs"])].concat() {
        for part in file.with_extension("").iter() {
            assert!(!EMPTY_NAMES.iter().any(|name| part == *name), "{}: name the subject", file.display());
        }
    }
}

#[test]
fn files_have_one_subject() {
    for file in [rust_files(), shader_files()].concat() {
        let lines = read(&file).lines().count();
        assert!(lines <= LINES_MAX, "{}: {lines} lines; what is its second subject?", file.display());
    }
}

#[test]
fn listed_names_are_file_stems() {
    let exists = |path: String| assert!(root().join(&path).is_file(), "{path} is missing");
    let stems = |folder: &str, extension: &str| -> BTreeSet<String> {
        files(folder, &[extension]).iter().map(|f| f.file_stem().unwrap().to_str().unwrap().to_owned()).collect()
    };
    let stem = |name: &str| name.replace('-', "_");
    let models: BTreeSet<String> = splitsum::brdf::MODELS.iter().map(|model| stem(model.name())).collect();
    let methods: BTreeSet<String> = splitsum::shade::METHODS.iter().map(|method| stem(method.name)).collect();
    let diffuse: BTreeSet<String> = splitsum::shade::DIFFUSE.iter().map(|diffuse| stem(diffuse.name)).collect();
    // The reference has entry points of its own; `none` computes nothing.
    let has_shader = |name: &String| !["none", "reference"].contains(&name.as_str());
    for (folder, names) in [("brdf", models), ("shade/method", methods), ("shade/diffuse", diffuse)] {
        names.iter().for_each(|name| exists(format!("src/{folder}/{name}.rs")));
        assert_eq!(
            stems(&format!("shaders/{folder}"), "glsl"),
            names.into_iter().filter(has_shader).collect(),
            "{folder}"
        );
    }
}

/// Whether a word has the form of a citation: a name and a year of two digits, or a recommendation's number.
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
    let brackets = text.split('[').skip(1).filter_map(|rest| rest.split_once(']')).map(|(inside, _)| inside);
    brackets.flat_map(|inside| words(inside).map(|(_, word)| word)).filter(|w| is_key(w)).map(str::to_owned).collect()
}

#[test]
fn every_citation_resolves() {
    let library = Text::of(&read(Path::new("src/lib.rs"))).comments;
    let (_, bibliography) = library.split_once("# Bibliography").expect("src/lib.rs has a bibliography");
    let entries: Vec<&str> =
        bibliography.split(" - ").filter_map(|entry| entry.trim().split_once(": ")).map(|(key, _)| key).collect();
    let resolved: BTreeSet<String> = entries.iter().map(|key| key.to_string()).collect();
    assert!(entries.iter().all(|key| is_key(key)), "{entries:?}");
    assert!(entries.is_sorted() && resolved.len() == entries.len(), "in alphabetical order, each once: {entries:?}");

    assert_eq!(
        keys("x[0] [Karis13 eq. 7], [Walter07, eq. 14; Kim22 \"IBL\"], [L00]").into_iter().collect::<Vec<_>>(),
        ["Karis13", "Kim22", "Walter07"]
    );
    let mut cited = BTreeSet::new();
    let commented = [rust_files(), shader_files(), files("tests", &["rs"])].concat();
    let sources = commented.iter().map(|file| (file, Text::of(&read(file)).comments));
    let pages = files("docs", &["md"]);
    let pages = pages.iter().map(|file| (file, read(file)));
    for (file, text) in sources.chain(pages) {
        for key in keys(&text) {
            assert!(resolved.contains(&key), "{}: [{key}] is not in the bibliography of src/lib.rs", file.display());
            cited.insert(key);
        }
    }
    let idle: Vec<&String> = resolved.difference(&cited).collect();
    assert!(idle.is_empty(), "in the bibliography and cited nowhere: {idle:?}");
}
