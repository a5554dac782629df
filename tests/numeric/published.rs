//! The site of the published runs of this repository.

use splitsum::report::gallery::{BYTES_MAX, INDEX_FILE, write};
use std::path::{Path, PathBuf};

fn pages(folder: &Path) -> Vec<PathBuf> {
    let paths = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let of = |path: PathBuf| if path.is_dir() { pages(&path) } else { vec![path] };
    paths.flat_map(of).filter(|path| path.extension().is_some_and(|end| end == "html")).collect()
}

/// The files that a page links and shows.
fn targets(page: &str) -> impl Iterator<Item = &str> {
    let after = |mark| page.split(mark).skip(1).filter_map(|rest: &str| rest.split('"').next());
    let all = after("href=\"").chain(after("src=\"")).map(|link| link.split('#').next().unwrap_or_default());
    all.filter(|link| !link.is_empty() && !link.starts_with("data:"))
}

#[test]
fn the_site_has_every_published_run_and_no_link_leads_nowhere() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("site");
    let (bytes, notes) = write(&root.join("results"), &[], &out).unwrap();
    assert!(bytes < BYTES_MAX && notes.is_empty(), "{bytes} {notes:?}");
    let pages = pages(&out);
    for page in &pages {
        let text = std::fs::read_to_string(page).unwrap();
        for link in targets(&text) {
            assert!(page.parent().unwrap().join(link).is_file(), "{}: {link}", page.display());
        }
    }
    let index = std::fs::read_to_string(out.join(INDEX_FILE)).unwrap();
    // The numbers of the block in README.md, of the table of bakers, and one card for each run.
    let readme = std::fs::read_to_string(root.join("README.md")).unwrap();
    let row = readme.lines().find(|line| line.starts_with("| split-sum-two ")).unwrap();
    row.split('|').for_each(|cell| assert!(index.contains(cell.trim()), "{cell}"));
    assert!(index.contains("<td>cmgen (Filament) 1.9.25</td>"));
    let runs = pages.iter().filter(|page| page.ends_with("summary.html")).count();
    assert_eq!((index.matches("<article").count(), runs > 10), (runs, true));
    // A second time it replaces the site; folders of others stay.
    write(&root.join("results"), &[], &out).unwrap();
    std::fs::remove_file(out.join(INDEX_FILE)).unwrap();
    let error = write(&root.join("results"), &[], &out).unwrap_err();
    assert!(error.is_misuse() && error.to_string().contains("choose a new folder"), "{error}");
    let error = write(&out, &[], &dir.path().join("other")).unwrap_err();
    assert!(
        error.to_string().ends_with("published run; expected the folder of `splitsum answers --publish`"),
        "{error}"
    );
}
