//! The comparison of images: flipping by keys, its pixels against the renderer's, links.

use crate::chromium::Page;
use crate::fake::{ERROR_AT_ONE, SPLIT_SUM_ERROR};
use crate::fixture::{SIDE, assert_clean, cell, report, stored};
use half::f16;
use serde_json::json;
use splitsum::report::page::images::Choice;
use splitsum::tonemap::ToneCurve;
use std::path::Path;

/// Bytes of the canvas where a texel is drawn, read in the same task as a redraw.
pub fn drawn(page: &mut Page, x: u32, y: u32) -> Vec<u64> {
    let script = format!(
        "(() => {{ const c = document.querySelector('.viewer-stage canvas'), gl = c.getContext('webgl2'); \
         const ev = document.getElementById('exposure'); ev.dispatchEvent(new Event('input')); \
         const scale = Math.floor(Math.min(c.width, c.height) / {SIDE}); \
         const px = Math.round(c.width / 2 + ({x} + 0.5 - {SIDE} / 2) * scale), \
               py = Math.round(c.height / 2 + ({y} + 0.5 - {SIDE} / 2) * scale), out = new Uint8Array(4); \
         gl.readPixels(px, c.height - 1 - py, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, out); return [...out].slice(0, 3); }})()"
    );
    page.eval(&script).as_array().unwrap().iter().map(|byte| byte.as_u64().unwrap()).collect()
}

pub fn open_compare(page: &mut Page, report: &Path, cell: &str) {
    page.resize(1200, 800, "light");
    page.go(report, &format!("#compare?cell={cell}"));
    page.wait("document.querySelector('.viewer-stage canvas').dataset.ready !== undefined");
}

pub fn shown(page: &mut Page) -> String {
    page.eval("document.querySelector('.viewer-stage canvas').dataset.shown").as_str().unwrap().to_owned()
}

#[test]
fn keys_flip_in_place_and_space_holds_the_reference() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    let of = |method: &str, samples: &str| cell(&report, [method, samples, "0.1", "ggx", "1"]);
    let (first, second, split) = (of("sampled", "1"), of("sampled", "4"), of("split-sum", ""));
    open_compare(&mut page, &report, &first);
    assert_eq!(shown(&mut page), first);
    page.key("2");
    assert_eq!(shown(&mut page), second);
    page.key("4");
    assert_eq!(shown(&mut page), split);
    page.press(" ");
    assert_eq!(shown(&mut page), "reference");
    // The score is that of the image, not of what judges it.
    let label = "document.querySelector('.viewer-stage canvas').getAttribute('aria-label')";
    let spoken = page.eval(label);
    assert!(spoken.as_str().is_some_and(|text| text.contains("reference") && !text.contains("relMSE")), "{spoken}");
    page.release(" ");
    assert_eq!(shown(&mut page), split);
    page.key("ArrowLeft");
    assert_eq!(shown(&mut page), of("sampled", "16"));
    page.key("e");
    assert_eq!(page.eval("document.querySelector('.viewer-stage canvas').dataset.mode"), json!("error"));
    assert_eq!(page.eval("document.querySelectorAll('.ramp-ticks span').length"), json!(4));
    // No tone curve reaches an error.
    let disabled =
        "[...document.querySelectorAll('#exposure, #contrast, [aria-label=Tone] button')].map((e) => e.disabled)";
    assert_eq!(page.eval(disabled), json!([true, true, true, true]));
    page.key("e");
    assert_eq!(page.eval(disabled), json!([false, false, false, false]));
    page.key("e");
    let flip = page.eval(
        "(() => { const canvas = document.querySelector('.viewer-stage canvas'), gl = canvas.getContext('webgl2'); \
         const times = []; for (let i = 0; i < 20; i++) { const start = performance.now(); \
         document.body.dispatchEvent(new KeyboardEvent('keydown', { key: String(1 + i % 4), bubbles: true })); \
         gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)); times.push(performance.now() - start); } \
         return times.sort((a, b) => a - b)[10]; })()",
    );
    println!("flip: {flip} ms in the median");
    assert!(flip.as_f64().unwrap() < 250.0, "{flip} ms");
    assert_clean(&page);
}

#[test]
fn pixels_are_the_renderers_exactly() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    let id = cell(&report, ["split-sum", "", "0.1", "ggx", "1"]);
    open_compare(&mut page, &report, &id);
    let (x, y) = (9, 14);
    let truth = stored(&report, &id, x, y);
    // The page's shader includes the renderer's tone curve; one code of rounding is left to the device.
    let near = |drawn: Vec<u64>, wanted: [u8; 3]| drawn.iter().zip(wanted).all(|(a, b)| a.abs_diff(u64::from(b)) <= 1);
    let curve = |exposure: f32, contrast: f32| ToneCurve { exposure, contrast }.apply_rgb8(truth);
    let bytes = drawn(&mut page, x, y);
    assert!(near(bytes.clone(), curve(1.0, 1.0)), "{bytes:?} {:?}", curve(1.0, 1.0));
    let slide = |page: &mut Page, id: &str, value: f32| {
        page.eval(&format!("(() => {{ const e = document.getElementById('{id}'); e.value = {value}; e.dispatchEvent(new Event('input')); }})()"));
    };
    slide(&mut page, "exposure", 2.0);
    slide(&mut page, "contrast", 2.0);
    let bytes = drawn(&mut page, x, y);
    assert!(near(bytes.clone(), curve(4.0, 2.0)), "{bytes:?} {:?}", curve(4.0, 2.0));

    // The probe, at the texel's centre on the screen.
    let place = page.eval(&format!(
        "(() => {{ const c = document.querySelector('.viewer-stage canvas'), b = c.getBoundingClientRect(); \
         const s = Math.floor(Math.min(c.width, c.height) / {SIDE}); \
         return [b.left + b.width / 2 + ({x} + 0.5 - {SIDE} / 2) * s, b.top + b.height / 2 + ({y} + 0.5 - {SIDE} / 2) * s]; }})()"
    ));
    page.click_at(place[0].as_f64().unwrap(), place[1].as_f64().unwrap());
    page.wait(&format!("document.querySelector('.probe h2').textContent.includes('({x}, {y}) · pinned')"));
    let probed = |page: &mut Page, key: &str| {
        let script = format!(
            "[...document.querySelectorAll('[data-probe=\"{key}\"] td')].map((td) => Number(td.dataset.value))"
        );
        page.eval(&script).as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect::<Vec<f64>>()
    };
    let values = probed(&mut page, &id);
    assert_eq!(&values[..3], truth.map(f64::from).as_slice());
    let reference_key = page.eval("document.querySelector('[data-probe^=reference]').dataset.probe");
    let reference = probed(&mut page, reference_key.as_str().unwrap());
    let squares = (0..3).map(|c| (values[c] - reference[c]).powi(2) / (reference[c].powi(2) + 1e-2));
    let error = (squares.sum::<f64>() / 3.0).sqrt();
    assert!(
        (values[3] - error).abs() < 1e-12 && (error - f64::from(SPLIT_SUM_ERROR)).abs() < 0.02,
        "{values:?} {error}"
    );
    assert_clean(&page);
}

#[test]
fn the_error_map_has_the_projects_colours() {
    use splitsum::table::colormap::RELATIVE_ERROR;
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    let id = cell(&report, ["sampled", "4", "0.5", "ggx", "1"]);
    open_compare(&mut page, &report, &id);
    page.key("e");
    let (x, y) = (12, 12);
    let [test, reference] = [stored(&report, &id, x, y).map(f64::from), {
        let factor = 1.0 + f64::from(ERROR_AT_ONE) / 2.0;
        stored(&report, &id, x, y).map(|value| f64::from(f16::from_f64(f64::from(value) / factor)))
    }];
    let squares = (0..3).map(|c| (test[c] - reference[c]).powi(2) / (reference[c].powi(2) + 1e-2));
    let wanted = RELATIVE_ERROR.color((squares.sum::<f64>() / 3.0).sqrt());
    let bytes = drawn(&mut page, x, y);
    assert!(bytes.iter().zip(wanted).all(|(a, b)| a.abs_diff(u64::from(b)) <= 2), "{bytes:?} {wanted:?}");
    let off = drawn(&mut page, 0, 0);
    assert_eq!(off, splitsum::table::colormap::OFF_MASK_COLOR.map(u64::from));
}

#[test]
fn a_link_restores_what_was_seen() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    let id = cell(&report, ["sampled", "1", "0.1", "ggx", "1"]);
    open_compare(&mut page, &report, &id);
    for key in ["3", "]", "]", "e", "d", "+", "+", "c"] {
        page.key(key);
    }
    page.wait("location.hash.includes('clip=1')");
    let hash = page.eval("location.hash").as_str().unwrap().to_owned();
    let state = "(() => { const c = document.querySelector('.viewer-stage canvas'); return [c.dataset.shown, c.dataset.mode, \
                 document.querySelector('.scale-text').textContent, document.querySelector('.split-handle').style.left, \
                 document.getElementById('exposure').value, document.querySelector('.checks input').checked]; })()";
    let before = page.eval(state);
    page.go(&report, &hash);
    page.wait("document.querySelector('.viewer-stage canvas').dataset.ready !== undefined");
    assert_eq!(page.eval(state), before);
    assert_eq!(before[0], json!(cell(&report, ["sampled", "16", "0.1", "ggx", "1"])));
    assert_eq!(before[4], json!("1"));
    assert_clean(&page);
}
