//! The report in a real browser, opened from disk: what a reader sees, presses and saves. Skips with a line without Chromium.

mod access;
mod answer;
mod chromium;
mod compare;
mod contrast;
mod failed;
#[path = "../numeric/run/fake.rs"]
mod fake;
mod fixture;
mod joined;
mod live;
mod live_pixels;
mod sections;
mod tables;
mod viewer;

use fixture::{HOSTILE_FOLDER, assert_clean, cell, finished_run, page_of, report, write_page};
use serde_json::json;
use splitsum::report::page::PageOptions;
use splitsum::report::page::images::{Choice, Window};
use std::path::Path;
use viewer::open_compare;

#[test]
fn without_images_and_with_crops_the_page_says_so() {
    let Some((mut page, report, dir)) = report(Choice::None) else { return };
    page.go(&report, "#images");
    assert!(page.text("#view-images").contains("--no-images"));
    // Every image is linked, and there is no control without an effect.
    let links = page.eval("[...document.querySelectorAll('#view-images td a')].map((a) => a.href)");
    let links = links.as_array().unwrap();
    assert_eq!(links.len(), 3 * (1 + 4));
    for link in links {
        let file = link.as_str().unwrap().strip_prefix("file://").unwrap();
        assert!(Path::new(file).exists(), "{file}");
    }
    assert_eq!(page.eval("document.querySelectorAll('#view-images :is(input, select, .segments)').length"), json!(0));
    page.go(&report, "#compare");
    assert!(page.text("#view-compare").contains("Images were left out"));
    assert_eq!(page.eval("document.querySelectorAll('#view-compare :is(input, canvas)').length"), json!(0));
    let images = Choice::Crop(Window { x: 4, y: 6, width: 8, height: 5 });
    let run = dir.path().join("run");
    let path = write_page(
        std::slice::from_ref(&run),
        &PageOptions { images, out: dir.path().join("cut.html"), ..PageOptions::in_folder(&run) },
    );
    let id = cell(&report, ["sampled", "1", "0.1", "ggx", "1"]);
    open_compare(&mut page, &path, &id);
    assert!(page.text(".caption").contains("window 8 × 5 at (4, 6) of 24 × 24"));
    let link = page.eval("document.querySelector('.panel a').href");
    let file = link.as_str().unwrap().strip_prefix("file://").unwrap().to_owned();
    assert!(Path::new(&file).exists(), "{file}");
    assert_clean(&page);
}

#[test]
fn failed_cells_of_joined_runs_have_their_reasons_and_hostile_labels_are_text() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let dirs = [finished_run(dir.path(), HOSTILE_FOLDER, None), finished_run(dir.path(), "right", Some("split-sum"))];
    let path =
        write_page(&dirs, &PageOptions { out: dir.path().join("joined.html"), ..PageOptions::in_folder(&dirs[0]) });
    page.go(&path, "#run");
    assert!(page.text("#view-run").contains("the shader is broken"), "{}", page.text("#view-run"));
    page.go(&path, "");
    assert!(page.text("#view-answer").contains("cells failed"));
    page.go(&path, "#images");
    let table = page.text(".image-table");
    assert!(table.contains(&format!("{HOSTILE_FOLDER} · sampled 1")) && table.contains("right · sampled 1"), "{table}");
    assert_clean(&page);
}

#[test]
fn views_fit_phone_laptop_and_desk() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    let id = cell(&report, ["sampled", "4", "0.1", "ggx", "1"]);
    page.go(&report, "");
    let screens = [
        ("phone", 390, 844, "light"),
        ("laptop", 1366, 768, "light"),
        ("laptop", 1366, 768, "dark"),
        ("desk", 2560, 1440, "dark"),
    ];
    for (name, width, height, scheme) in screens {
        page.resize(width, height, scheme);
        for view in ["answer", "images", "compare", "live", "tables", "run"] {
            let hash = if view == "compare" { format!("#compare?cell={id}&split=0.5") } else { format!("#{view}") };
            page.follow(&hash);
            page.eval("new Promise((done) => setTimeout(done, 150))");
            let overflow = page.eval("document.documentElement.scrollWidth - document.documentElement.clientWidth");
            assert!(overflow.as_i64().unwrap() <= 0, "{view} is {overflow} pixels too wide at {width}");
            page.screenshot(&format!("{view}-{name}-{scheme}"));
        }
    }
    assert_clean(&page);
}

#[test]
fn a_page_is_written_over_a_page_alone() {
    use splitsum::report::page::{PageError, check_out};
    let dir = tempfile::tempdir().unwrap();
    let run = finished_run(dir.path(), "run", None);
    let report = page_of(&run, Choice::None);
    assert!(check_out(&report).is_ok());
    assert!(matches!(check_out(dir.path()), Err(PageError::OutIsFolder { .. })));
    assert!(matches!(check_out(&run.join("errors.csv")), Err(PageError::NotAReport { .. })));
    assert!(check_out(&dir.path().join("new.html")).is_ok());
}
