//! The comparison where the window changes and where not all images are in the page: places, keys, steps of colour.

use crate::chromium::{self, Page};
use crate::fixture::{SIDE, assert_clean, cell, page_of, report, report_of};
use crate::viewer::shown;
use serde_json::json;
use splitsum::report::page::images::Choice;
use splitsum::table::csv::Table;
use std::path::Path;

const READY: &str = "document.querySelector('.viewer-stage canvas')?.dataset.ready !== undefined";

#[test]
fn a_pinned_texel_is_marked_where_it_lies() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    page.resize(1440, 900, "light");
    page.go(&report, &format!("#compare?cell={}&zoom=40&x=5.5&y=7.5", split_sum(&report)));
    page.wait(READY);
    assert_eq!(page.eval("document.querySelector('.probe-mark').hidden"), json!(true));
    let texel = middle(&mut page);
    let place = "(() => { const b = document.querySelector('.probe-mark').getBoundingClientRect(), c = document.querySelector('.viewer-stage canvas').getBoundingClientRect(); \
                 return [b.left + b.width / 2 - c.left - c.width / 2, b.top + b.height / 2 - c.top - c.height / 2, b.width]; })()";
    let at = |page: &mut Page| -> Vec<f64> {
        page.eval(place).as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
    };
    let before = at(&mut page);
    assert!(
        texel == "texel (5, 7)" && before[0].abs() < 2.0 && before[1].abs() < 2.0 && before[2] >= 40.0,
        "{before:?}"
    );
    page.eval("document.body.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowRight', shiftKey: true, bubbles: true }))");
    let after = at(&mut page);
    assert!((after[0] - before[0] - 40.0).abs() < 1.0 && (after[1] - before[1]).abs() < 1.0, "{before:?} {after:?}");
    assert_clean(&page);
}

/// A cell of the split sum; an address that names a cell shows it without the wipe.
fn split_sum(report: &Path) -> String {
    cell(report, ["split-sum", "", "0.1", "ggx", "1"])
}

/// Waits until the canvas has as many pixels as its stage.
fn wait_for_size(page: &mut Page) {
    page.wait(
        "(() => { const c = document.querySelector('.viewer-stage canvas'), b = c.parentElement.getBoundingClientRect(); \
         return b.width > 0 && c.width === Math.round(b.width) && c.height === Math.round(b.height); })()",
    );
    page.eval("new Promise((done) => requestAnimationFrame(() => setTimeout(done, 50)))");
}

/// The texel in the middle of the canvas, as the probe names it.
fn middle(page: &mut Page) -> String {
    let at = page.eval(
        "(() => { const b = document.querySelector('.viewer-stage canvas').getBoundingClientRect(); \
         return [b.left + b.width / 2 + 1, b.top + b.height / 2 + 1]; })()",
    );
    page.click_at(at[0].as_f64().unwrap(), at[1].as_f64().unwrap());
    page.text(".probe h2 span").split(" · ").next().unwrap().to_owned()
}

/// The image fills its stage and lies in its middle.
fn assert_fitted(page: &mut Page, when: &str) {
    wait_for_size(page);
    let wanted = page.eval(&format!(
        "(() => {{ const c = document.querySelector('.viewer-stage canvas'); return `${{Math.floor(Math.min(c.width, c.height) / {SIDE})}}×`; }})()"
    ));
    assert_eq!(json!(page.text(".viewer-stage .scale-text")), wanted, "{when}");
    assert_eq!(middle(page), format!("texel ({0}, {0})", SIDE / 2), "{when}");
}

#[test]
fn the_image_is_fitted_again_when_the_window_changes() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    for width in [1440, 390] {
        page.resize(width, 900, "light");
        page.go(&report, "#images");
        page.wait(&format!("document.querySelector('.image-table .thumb canvas').width === {SIDE}"));
        page.eval(&format!("location.hash = '#compare?cell={}'", split_sum(&report)));
        page.wait(READY);
        assert_fitted(&mut page, &format!("from the images at {width}"));
    }
    for width in [1440, 390] {
        page.resize(width, 900, "light");
        assert_fitted(&mut page, &format!("widened to {width}"));
    }
    // While another page is open the stage has no size.
    page.eval("location.hash = '#run'");
    page.wait("document.body.dataset.view === 'run'");
    page.resize(1440, 900, "light");
    page.eval(&format!("location.hash = '#compare?cell={}'", split_sum(&report)));
    page.wait("document.body.dataset.view === 'compare'");
    assert_fitted(&mut page, "back from another page");
    // A place that the reader has chosen stays.
    page.go(&report, &format!("#compare?cell={}&zoom=40&x=5.5&y=7.5", split_sum(&report)));
    page.wait(READY);
    for width in [390, 1440] {
        page.resize(width, 900, "light");
        wait_for_size(&mut page);
        assert_eq!(middle(&mut page), "texel (5, 7)", "{width}");
        assert_eq!(page.text(".viewer-stage .scale-text"), "40×", "{width}");
    }
    assert_clean(&page);
}

/// Cell and method of every row.
fn rows_of(table: &Table) -> Vec<[String; 2]> {
    let columns = ["cell", "method"].map(|name| table.column(name).unwrap());
    table.rows.iter().map(|row| columns.map(|column| row[column].clone())).collect()
}

#[test]
fn keys_lead_to_images_with_pixels_and_to_every_method_without_samples() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let axes = "environment = [\"builtin:constant\"]\nbrdf = [\"ggx\"]\nalpha = [0.25]\nmethod = [\"sampled\", \"split-sum\"]\n\
                samples = [1, 2, 4, 8, 16, 32, 64, 128, 256, 512]\npoint_set = [0, 1, 2]";
    let report = report_of(dir.path(), axes, "");
    // What the page cannot read is not in it.
    let run = report.parent().unwrap();
    let (cells, files) = (Table::read(&run.join("errors.csv")).unwrap(), Table::read(&run.join("images.csv")).unwrap());
    let [cell, set] = ["cell", "point_set"].map(|name| cells.column(name).unwrap());
    let [of, file] = ["cell", "radiance"].map(|name| files.column(name).unwrap());
    let mut removed = 0;
    for row in cells.rows.iter().filter(|row| ["1", "2"].contains(&row[set].as_str())) {
        let name = &files.rows.iter().find(|other| other[of] == row[cell]).unwrap()[file];
        std::fs::remove_file(run.join("images").join(name)).unwrap();
        removed += 1;
    }
    assert_eq!(removed, 20);
    let report = page_of(run, Choice::Automatic);
    page.resize(1280, 720, "light");
    page.go(&report, "#compare");
    page.wait(READY);
    // It opens on the split sum, wiped to the reference.
    let first = rows_of(&cells).into_iter().find(|row| row[1] == "split-sum").unwrap();
    assert_eq!(shown(&mut page), first[0]);
    let wipe = page.eval("[...document.querySelectorAll('.badge')].map((e) => e.hidden ? '' : e.textContent).concat(document.querySelector('.split-handle').style.left)");
    assert_eq!(wipe, json!(["split-sum", "reference", "50%"]));
    // Every column of the probe can be read, and no number is cut.
    let cut = page.eval(
        "[document.querySelector('.probe .scroll'), ...document.querySelectorAll('.probe td')].filter((e) => e.scrollWidth > e.clientWidth).length",
    );
    assert_eq!(cut, json!(0));
    let listed = page.eval(
        "[...document.querySelectorAll('.variant')].filter((b) => b.querySelector('kbd').textContent !== '·') \
         .map((b) => [b.querySelector('kbd').textContent, b.querySelector('span').textContent, b.dataset.cell])",
    );
    let listed = listed.as_array().unwrap();
    assert_eq!(listed.len(), 9, "{listed:?}");
    for (i, entry) in listed.iter().enumerate() {
        let [key, label, cell] = [0, 1, 2].map(|k| entry[k].as_str().unwrap());
        assert_eq!(key, (i + 1).to_string());
        assert!(label == "split-sum" || label.ends_with("set 0"), "{label}");
        page.key(key);
        assert_eq!(shown(&mut page), cell, "{label}");
        assert_eq!(page.eval("document.querySelector('.viewer-stage').classList.contains('empty')"), json!(false));
    }
    assert!(listed.iter().any(|entry| entry[1] == "split-sum"), "{listed:?}");
    // A cell without pixels says so, and a key leads back.
    page.eval("[...document.querySelectorAll('.variant')].find((b) => b.textContent.includes('set 1')).click()");
    page.wait("document.querySelector('.viewer-stage').classList.contains('empty')");
    // White on dark, as the text around it.
    assert_eq!(page.eval("getComputedStyle(document.querySelector('.caption a')).color"), json!("rgb(255, 255, 255)"));
    page.key("1");
    assert_eq!(page.eval("document.querySelector('.viewer-stage').classList.contains('empty')"), json!(false));
    assert_clean(&page);
}

#[test]
fn an_address_asks_for_no_more_than_the_controls_reach() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    page.resize(1200, 800, "light");
    page.go(&report, "#compare?contrast=-3&ev=99&zoom=1e6&x=-500&y=1e9&split=7");
    page.wait(READY);
    let shown = page.eval(
        "[Number(document.getElementById('contrast').value), Number(document.getElementById('exposure').value), document.querySelector('.scale-text').textContent, \
         document.querySelector('.split-handle').style.left, document.querySelector('.slider output[for=contrast]').textContent]",
    );
    assert_eq!(shown, json!([0.1, 14, "96×", "100%", "0.1"]));
    // The place lies within the image: its corner is in the middle of the stage.
    let texel = middle(&mut page);
    assert!(
        texel.starts_with(&format!("texel (0, {SIDE})")) || texel.starts_with(&format!("texel (0, {})", SIDE - 1)),
        "{texel}"
    );
    // Nonsense is no number.
    page.go(&report, "#compare?contrast=x&ev=&zoom=NaN");
    page.wait(READY);
    assert_eq!(
        page.eval("[document.getElementById('contrast').value, document.getElementById('exposure').value]"),
        json!(["1", "0"])
    );
    assert_clean(&page);
}

#[test]
fn errors_beyond_the_range_of_the_colours_can_be_marked() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    page.resize(1200, 800, "light");
    // The fake errs by far less than 1, so nothing of it lies beyond; a range that is narrower stands for larger errors.
    for (range, expected) in [("", false), ("report.colors.relative[1] = 0.01;", true)] {
        page.go(&report, "#answer");
        let script = format!(
            "import('report/data').then((data) => {{ const report = data.model; {range} location.hash = '#compare?mode=error&clip=1'; }})"
        );
        page.eval(&script);
        page.wait(READY);
        let marked = page.eval(
            "(() => { const c = document.querySelector('.viewer-stage canvas'), gl = c.getContext('webgl2'); \
             const ev = document.getElementById('exposure'); ev.dispatchEvent(new Event('input')); \
             const n = 40, out = new Uint8Array(4 * n); gl.readPixels((c.width >> 1) - 20, c.height >> 1, n, 1, gl.RGBA, gl.UNSIGNED_BYTE, out); \
             let found = 0; for (let i = 0; i < n; i++) if (out[4 * i] > 250 && out[4 * i + 1] < 5 && out[4 * i + 2] > 220) found++; return found > 5; })()",
        );
        assert_eq!(marked, json!(expected), "{range}");
        assert!(
            page.text(".error-legend").contains("≥ ") && page.text(".error-legend").contains("Mark beyond the range")
        );
        assert!(page.text(".checks").contains("Mark beyond the range"));
    }
    assert_clean(&page);
}

#[test]
fn images_with_keys_stand_first_and_contact_sheets_are_linked() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let axes = "environment = [\"builtin:constant\"]\nbrdf = [\"ggx\"]\nalpha = [0.25]\nmethod = [\"sampled\", \"split-sum\"]\n\
                samples = [1, 4]\npoint_set = [0, 1, 2, 3]";
    let report = report_of(dir.path(), axes, "");
    page.resize(1440, 900, "light");
    page.go(&report, "#compare");
    page.wait(READY);
    let keys = page.eval("[...document.querySelectorAll('.variants :is(kbd, summary)')].map((e) => e.textContent)");
    assert_eq!(keys, json!(["1", "2", "3", "6 more without a key", "·", "·", "·", "·", "·", "·"]));
    for view in ["images", "run"] {
        page.go(&report, &format!("#{view}"));
        let links = page.eval(&format!("[...document.querySelectorAll('#view-{view} .sheets a')].map((a) => a.href)"));
        let links = links.as_array().unwrap();
        assert!(!links.is_empty(), "{view}");
        for link in links {
            let file = link.as_str().unwrap().strip_prefix("file://").unwrap();
            assert!(std::path::Path::new(file).exists(), "{file}");
        }
    }
    assert_clean(&page);
}
