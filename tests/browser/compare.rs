//! The comparison where the window changes and where not all images are in the page: places, keys, steps of colour.

use crate::chromium::{self, Page};
use crate::fixture::{SIDE, assert_clean, cell, page_of, report, report_of};
use crate::viewer::shown;
use serde_json::json;
use splitsum::report::page::images::Choice;
use splitsum::table::csv::Table;
use std::path::Path;

const READY: &str = "document.querySelector('.viewer-stage canvas')?.dataset.ready !== undefined";

/// The texel in the middle of the canvas, as the probe names it.
fn middle(page: &mut Page) -> String {
    let at = page.eval(
        "(() => { const b = document.querySelector('.viewer-stage canvas').getBoundingClientRect(); \
         return [b.left + b.width / 2 + 1, b.top + b.height / 2 + 1]; })()",
    );
    page.click_at(at[0].as_f64().unwrap(), at[1].as_f64().unwrap());
    page.text(".probe h2 span").split(" · ").next().unwrap().to_owned()
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
