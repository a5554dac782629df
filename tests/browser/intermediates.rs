//! What an image is made of, in the comparison: pixels, values, addresses, and its message without
//! pictures.

use crate::chromium::Page;
use crate::compare::{drawn, open, probed, shown};
use crate::fixture::{SIDE, assert_clean, cell, page_of, report, stored};
use serde_json::json;
use splitsum::draw::colormap::OFF_MASK_COLOR;
use splitsum::instrument::tonemap::ToneCurve;
use splitsum::report::intermediates::INTERMEDIATES_FILE;
use splitsum::report::page::images::Choice;

/// The red channel of the synthetic renderer's pictures: a ramp of half floats to the right.
fn ramp(x: u32, width: u32) -> f64 {
    half::f16::from_f64((f64::from(x) + 0.5) / f64::from(width)).to_f64()
}

fn press_button(page: &mut Page, name: &str) {
    page.eval(&format!(
        "document.querySelector('.made-of button[value=\"{name}\"]').click()"
    ));
    page.wait(&format!(
        "document.querySelector('.viewer-stage canvas').dataset.shown === '{name}'"
    ));
}

fn is_near(drawn: &[u64], wanted: [f64; 3]) -> bool {
    drawn
        .iter()
        .zip(wanted)
        .all(|(byte, wanted)| (*byte as f64 - 255.0 * wanted).abs() <= 1.0)
}

#[test]
fn pictures_show_their_values_and_an_address_restores_them() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else {
        return;
    };
    let id = cell(&report, ["split-sum", "", "0.1", "ggx", "1"]);
    let (x, y) = (9, 4);
    open(&mut page, &report, &format!("cell={id}&texel={x},{y}"));
    let names = page.eval("[...document.querySelectorAll('.made-of button')].map((b) => b.value)");
    let wanted = json!([
        "position",
        "normal",
        "albedo",
        "f0",
        "alpha",
        "metallic",
        "occlusion",
        "irradiance",
        "prefiltered-0",
        "prefiltered-1",
        "prefiltered-2",
        "prefiltered-3",
        "prefiltered-4",
        "dfg"
    ]);
    assert_eq!(names, wanted);
    // A linear attachment: its value is the display value; nothing below the middle.
    press_button(&mut page, "normal");
    let bytes = drawn(&mut page, x, y);
    assert!(is_near(&bytes, [ramp(x, SIDE), 0.5, 0.0]), "{bytes:?}");
    assert_eq!(drawn(&mut page, x, SIDE - 2), OFF_MASK_COLOR.map(u64::from));
    assert_eq!(probed(&mut page, "normal")[..3], [ramp(x, SIDE), 0.5, 0.0]);
    // The values of the image at the same texel stay beside it.
    let truth = stored(&report, &id, x, y).map(f64::from);
    assert_eq!(probed(&mut page, &id)[..3], truth);
    let disabled = "['exposure', 'contrast'].map((id) => document.getElementById(id).disabled)";
    assert_eq!(page.eval(disabled), json!([true, true]));
    page.wait("location.hash.includes('show=normal')");
    let address = page.eval("location.hash").as_str().unwrap().to_owned();
    page.go(&report, &address);
    page.wait("document.querySelector('.viewer-stage canvas')?.dataset.shown === 'normal'");
    // The next picture by key; an image of the scene by its own key.
    page.key("n");
    page.wait("document.querySelector('.viewer-stage canvas').dataset.shown === 'albedo'");
    page.key("1");
    assert_eq!(
        shown(&mut page),
        cell(&report, ["sampled", "1", "0.1", "ggx", "1"])
    );
    let pressed = "document.querySelector('.made-of [aria-pressed=\"true\"]')";
    assert_eq!(page.eval(pressed), json!(null));
    assert_clean(&page);
}

#[test]
fn radiance_of_tables_follows_the_tone_curve() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else {
        return;
    };
    let id = cell(&report, ["split-sum", "", "0.1", "ggx", "1"]);
    open(&mut page, &report, &format!("cell={id}"));
    press_button(&mut page, "prefiltered-0");
    page.eval(
        "(() => { const e = document.getElementById('exposure'); e.value = 2; \
         e.dispatchEvent(new Event('input')); })()",
    );
    let curve = ToneCurve {
        exposure: 4.0,
        contrast: 1.0,
    };
    // A table has its own size; the canvas' middle is between its texels 63 and 64.
    let size = page.eval(
        "import('report/data').then(({ intermediatesOf, rows }) => intermediatesOf(rows.find((r) \
         => r.axes.method === 'split-sum')).find((i) => i.name === 'prefiltered-0').size)",
    );
    assert_eq!(size, json!([128, 64]));
    let bytes = page.eval(
        "(() => { const c = document.querySelector('.viewer-stage canvas'), gl = \
         c.getContext('webgl2'); document.getElementById('exposure').dispatchEvent(new \
         Event('input')); const out = new Uint8Array(4); gl.readPixels(c.width >> 1, c.height >> \
         1, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, out); return [...out].slice(0, 3); })()",
    );
    let bytes: Vec<u64> = bytes
        .as_array()
        .unwrap()
        .iter()
        .map(|byte| byte.as_u64().unwrap())
        .collect();
    let near = |x: u32| {
        let wanted = curve.apply_rgb8([ramp(x, 128) as f32, 0.5, 1.0]);
        bytes
            .iter()
            .zip(wanted)
            .all(|(a, b)| a.abs_diff(b.into()) <= 1)
    };
    assert!(near(63) || near(64), "{bytes:?}");
    // The probe reads the table alone; back at the image it reads all images.
    let lines = "document.querySelectorAll('[data-probe]').length";
    assert_eq!(page.eval(lines), json!(1));
    press_button_again(&mut page, "prefiltered-0", &id);
    assert!(page.eval(lines).as_u64().unwrap() > 1);
    assert_clean(&page);
}

/// A second press shows the image again.
fn press_button_again(page: &mut Page, name: &str, cell: &str) {
    page.eval(&format!(
        "document.querySelector('.made-of button[value=\"{name}\"]').click()"
    ));
    page.wait(&format!(
        "document.querySelector('.viewer-stage canvas').dataset.shown === '{cell}'"
    ));
}

#[test]
fn a_run_without_pictures_says_how_to_get_them() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else {
        return;
    };
    let run = report.parent().unwrap().to_owned();
    std::fs::remove_file(run.join(INTERMEDIATES_FILE)).unwrap();
    let report = page_of(&run, Choice::Automatic);
    let id = cell(&report, ["split-sum", "", "0.1", "ggx", "1"]);
    open(&mut page, &report, &format!("cell={id}&show=normal"));
    assert_eq!(shown(&mut page), id);
    let text = page.eval("document.querySelector('.made-of').textContent");
    assert!(
        text.as_str().unwrap().contains("splitsum render --show"),
        "{text}"
    );
    assert_clean(&page);
}
