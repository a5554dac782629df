//! What the repository shows of published runs is what they say.

use splitsum::study::columns;
use splitsum::study::publish::with_answers;
use std::path::{Path, PathBuf};

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn text(name: &str) -> String {
    std::fs::read_to_string(file(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

#[test]
fn the_readme_shows_the_published_answers() {
    let readme = text("README.md");
    let filled = with_answers(&readme, &file("results")).unwrap();
    assert!(
        filled == readme,
        "README.md is not what the runs in results/ say; `splitsum answers DIR... --publish results` writes it"
    );
    // A block whose run is not there stays as it is: then nothing is shown.
    let block = filled.split("<!-- answer").nth(1).expect("README.md has a block of answers");
    assert!(block.contains('|'), "the block in README.md is empty");
}

#[test]
fn the_page_of_columns_is_that_of_the_lists() {
    assert!(
        text("docs/columns.md") == columns::page(),
        "docs/columns.md is old; `splitsum list columns > docs/columns.md` writes it"
    );
}
