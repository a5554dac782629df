//! View by view: sizes and places of what is seen, labels for people, the probe by keyboard, the address, hostile names in data.

use crate::chromium::{self, Page};
use crate::fixture::{HOSTILE, assert_clean, cell, report, report_of};
use crate::viewer::{open_compare, shown};
use serde_json::{Value, json};
use splitsum::report::page::images::Choice;
use std::path::Path;

#[test]
fn values_that_round_to_the_same_keep_their_digits() {
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let axes = "environment = [\"builtin:constant\"]\nbrdf = [\"ggx\"]\nalpha = [0.22361, 0.22362]\nmethod = [\"sampled\"]\nsamples = [1, 4]\n\
                lod_bias = [0, 1.2924812503605781]";
    let report = report_of(dir.path(), axes, "");
    page.go(&report, "#images");
    let text = page.text(".image-table");
    assert!(text.contains("alpha 0.22361") && text.contains("alpha 0.22362"), "{text}");
    // A bare number in a label says what it is.
    assert!(text.contains("bias 1.292") && !text.contains("1.29248"), "{text}");
    assert_clean(&page);
}

#[test]
fn the_probe_moves_by_keyboard() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    let id = cell(&report, ["sampled", "1", "0.1", "ggx", "1"]);
    open_compare(&mut page, &report, &id);
    // It starts in the middle.
    assert!(page.text(".probe h2").contains("(12, 12)"), "{}", page.text(".probe h2"));
    let press = |page: &mut Page, key: &str| {
        page.eval(&format!(
            "document.body.dispatchEvent(new KeyboardEvent('keydown', {{ key: '{key}', shiftKey: true, bubbles: true }}))"
        ));
    };
    for key in ["ArrowRight", "ArrowRight", "ArrowUp"] {
        press(&mut page, key);
    }
    assert!(page.text(".probe h2").contains("(14, 11) · pinned"), "{}", page.text(".probe h2"));
    assert!(page.text("#announcer").contains("texel (14, 11)") && page.text("#announcer").contains("sampled 1"));
    for _ in 0..30 {
        press(&mut page, "ArrowLeft");
    }
    assert!(page.text(".probe h2").contains("(0, 11)"));
    assert_eq!(shown(&mut page), id, "arrows with shift choose no image");
    assert_clean(&page);
}

#[test]
fn the_address_is_written_seldom_and_read_with_care() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    page.before_load(
        "window.writes = 0; const replace = History.prototype.replaceState; \
         History.prototype.replaceState = function (...all) { window.writes++; return replace.apply(this, all); };",
    );
    let id = cell(&report, ["sampled", "1", "0.1", "ggx", "1"]);
    open_compare(&mut page, &report, &id);
    let writes = page.eval(
        "(() => { const e = document.getElementById('exposure'), before = writes; \
         for (let i = 0; i < 200; i++) { e.value = i / 50; e.dispatchEvent(new Event('input')); } return writes - before; })()",
    );
    // Browsers refuse more than a hundred in half a minute.
    assert!(writes.as_u64().unwrap() < 10, "{writes}");
    page.wait("location.hash.includes('ev=4')");
    // What was not written yet is not written over the next page.
    page.eval("(() => { const e = document.getElementById('exposure'); e.value = 2; e.dispatchEvent(new Event('input')); e.value = 3; e.dispatchEvent(new Event('input')); })()");
    page.key("b");
    page.eval("new Promise((done) => setTimeout(done, 600))");
    assert_eq!(page.eval("location.hash"), json!("#tables"));
    page.eval("history.back()");
    page.wait("document.body.dataset.view === 'compare'");
    assert!(page.eval("location.hash.includes('ev=3')") == json!(true), "{}", page.eval("location.hash"));
    // A broken address shows something.
    page.go(&report, "#compare?cell=%&x=%E0%A4%A");
    page.wait("document.querySelector('.viewer-stage canvas').dataset.ready !== undefined");
    assert_clean(&page);
}

#[test]
fn hostile_file_names_are_text_in_every_section() {
    const NAME: &str = "=cmd|' C' \"q\", a,b\n<script>window.pwned = 3<\\script><img src=x onerror=window.pwned=4>.exr";
    let Some(mut page) = chromium::open() else { return };
    let dir = tempfile::tempdir().unwrap();
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/env_analytic.exr");
    std::fs::copy(golden, dir.path().join(NAME)).unwrap();
    let axes = format!(
        "environment = [\"builtin:constant\", {}]\nbrdf = [\"ggx\"]\nalpha = [0.1, 0.5]\nmethod = [\"sampled\", \"split-sum\"]\nsamples = [1, 4]",
        json!(NAME)
    );
    let report = report_of(
        dir.path(),
        &axes,
        &format!("[[exclude]]\nenvironment = {}\nalpha = 0.5\nwhy = {}", json!(NAME), json!(HOSTILE)),
    );
    page.resize(1200, 900, "light");
    for view in ["answer", "images", "compare", "live", "tables", "run"] {
        page.go(&report, &format!("#{view}"));
        page.eval("new Promise((done) => setTimeout(done, 200))");
        assert_eq!(page.eval("window.pwned ?? null"), Value::Null, "{view}");
        assert_eq!(
            page.eval("document.querySelectorAll('img:not([src^=\"data:image/png\"]), main script').length"),
            json!(0),
            "{view}"
        );
    }
    // The short name of the map stands whole where values do.
    page.follow("#tables");
    let is_there = format!(
        "[...document.querySelectorAll('.data-table td')].some((td) => td.title === {})",
        json!(NAME.trim_end_matches(".exr"))
    );
    assert_eq!(page.eval(&is_there), json!(true));
    assert_clean(&page);
}
