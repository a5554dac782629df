//! The comparison of images: its pixels equal the renderer's, keys flip and wipe, an address
//! restores the view.

use crate::chromium::Page;
use crate::fake::{ERROR_AT_ONE, SPLIT_SUM_ERROR};
use crate::fixture::{SIDE, assert_clean, cell, report, stored};
use half::f16;
use serde_json::json;
use splitsum::base::color::srgb_encode;
use splitsum::draw::colormap::{OFF_MASK_COLOR, RELATIVE_ERROR, SIGNED_ERROR};
use splitsum::instrument::tonemap::ToneCurve;
use splitsum::report::page::images::Choice;
use std::path::Path;

const READY: &str = "document.querySelector('.viewer-stage canvas')?.dataset.ready !== undefined";

/// Bytes of the canvas where a texel is drawn, read in the same task as a redraw.
pub fn drawn(page: &mut Page, x: u32, y: u32) -> Vec<u64> {
    let script = format!(
        "(() => {{ const c = document.querySelector('.viewer-stage canvas'), gl = \
         c.getContext('webgl2'); \
         const ev = document.getElementById('exposure'); ev.dispatchEvent(new Event('input')); \
         const scale = Math.floor(Math.min(c.width, c.height) / {SIDE}); \
         const px = Math.round(c.width / 2 + ({x} + 0.5 - {SIDE} / 2) * scale), \
               py = Math.round(c.height / 2 + ({y} + 0.5 - {SIDE} / 2) * scale), out = new \
               Uint8Array(4); \
         gl.readPixels(px, c.height - 1 - py, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, out); return \
         [...out].slice(0, 3); }})()"
    );
    page.eval(&script)
        .as_array()
        .unwrap()
        .iter()
        .map(|byte| byte.as_u64().unwrap())
        .collect()
}

pub fn open(page: &mut Page, report: &Path, hash: &str) {
    page.resize(1200, 800, "light");
    page.go(report, &format!("#compare?{hash}"));
    page.wait(READY);
}

pub fn shown(page: &mut Page) -> String {
    page.eval("document.querySelector('.viewer-stage canvas').dataset.shown")
        .as_str()
        .unwrap()
        .to_owned()
}

/// Numbers of the probe's row: red, green, blue, error.
pub fn probed(page: &mut Page, row: &str) -> Vec<f64> {
    let script = format!(
        "[...document.querySelectorAll('[data-probe^=\"{row}\"] td')].map((td) => \
         Number(td.dataset.value))"
    );
    page.eval(&script)
        .as_array()
        .unwrap()
        .iter()
        .map(|value| value.as_f64().unwrap())
        .collect()
}

#[test]
fn pixels_and_errors_are_the_renderers() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else {
        return;
    };
    let id = cell(&report, ["split-sum", "", "0.1", "ggx", "1"]);
    let (x, y) = (9, 14);
    open(&mut page, &report, &format!("cell={id}&texel={x},{y}"));
    let truth = stored(&report, &id, x, y);
    // The page's shader includes the renderer's tone curve; the device may round by one code.
    let near = |drawn: &[u64], wanted: [u8; 3]| {
        drawn
            .iter()
            .zip(wanted)
            .all(|(a, b)| a.abs_diff(u64::from(b)) <= 1)
    };
    for (stops, contrast) in [(0.0f32, 1.0), (2.0, 2.0)] {
        for (id, value) in [("exposure", stops), ("contrast", contrast)] {
            page.eval(&format!(
                "(() => {{ const e = document.getElementById('{id}'); e.value = {value}; \
                 e.dispatchEvent(new Event('input')); }})()"
            ));
        }
        let wanted = ToneCurve {
            exposure: stops.exp2(),
            contrast,
        }
        .apply_rgb8(truth);
        let bytes = drawn(&mut page, x, y);
        assert!(near(&bytes, wanted), "{bytes:?} {wanted:?}");
    }
    page.key("t");
    page.eval(
        "(() => { const e = document.getElementById('exposure'); e.value = -5; \
               e.dispatchEvent(new Event('input')); })()",
    );
    let dark = truth.map(|value| (255.0 * srgb_encode(value / 32.0)).round() as u8);
    let bytes = drawn(&mut page, x, y);
    assert!(near(&bytes, dark), "{bytes:?} for {dark:?} in sRGB");
    page.key("t");
    let values = probed(&mut page, &id);
    assert_eq!(&values[..3], truth.map(f64::from).as_slice());
    let reference = probed(&mut page, "reference");
    let squares =
        (0..3).map(|c| (values[c] - reference[c]).powi(2) / (reference[c].powi(2) + 1e-2));
    let error = (squares.sum::<f64>() / 3.0).sqrt();
    assert!(
        (values[3] - error).abs() < 1e-12 && (error - f64::from(SPLIT_SUM_ERROR)).abs() < 0.02,
        "{values:?} {error}"
    );
    // Error maps have the project's colours.
    let id = cell(&report, ["sampled", "4", "0.5", "ggx", "1"]);
    let (x, y) = (12, 12);
    let test = stored(&report, &id, x, y).map(f64::from);
    let factor = 1.0 + f64::from(ERROR_AT_ONE) / 2.0;
    let reference = test.map(|value| f64::from(f16::from_f64(value / factor)));
    let each = |c: usize| (test[c] - reference[c]) / (reference[c].powi(2) + 1e-2).sqrt();
    let [relative, signed] = [
        ((0..3).map(|c| each(c).powi(2)).sum::<f64>() / 3.0).sqrt(),
        (0..3).map(each).sum::<f64>() / 3.0,
    ];
    for (mode, wanted) in [
        ("error", RELATIVE_ERROR.color(relative)),
        ("signed", SIGNED_ERROR.color(signed)),
    ] {
        open(&mut page, &report, &format!("cell={id}&mode={mode}"));
        let bytes = drawn(&mut page, x, y);
        assert!(
            bytes
                .iter()
                .zip(wanted)
                .all(|(a, b)| a.abs_diff(u64::from(b)) <= 2),
            "{mode}: {bytes:?} {wanted:?}"
        );
        assert_eq!(drawn(&mut page, 0, 0), OFF_MASK_COLOR.map(u64::from));
    }
    assert_clean(&page);
}

#[test]
fn keys_flip_in_place_and_an_address_restores_the_view() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else {
        return;
    };
    let of = |method: &str, samples: &str| cell(&report, [method, samples, "0.1", "ggx", "1"]);
    open(&mut page, &report, &format!("cell={}", of("sampled", "1")));
    for (key, wanted) in [
        ("2", of("sampled", "4")),
        ("4", of("split-sum", "")),
        ("ArrowLeft", of("sampled", "16")),
    ] {
        page.key(key);
        assert_eq!(shown(&mut page), wanted);
    }
    page.press(" ");
    assert_eq!(shown(&mut page), "reference");
    page.release(" ");
    assert_eq!(shown(&mut page), of("sampled", "16"));
    // The wipe moves by the keyboard.
    page.key("d");
    page.eval("document.querySelector('.split-handle').focus()");
    page.key("ArrowLeft");
    assert_eq!(
        page.eval("document.querySelector('.split-handle').style.left"),
        json!("48%")
    );
    assert_eq!(shown(&mut page), of("sampled", "16"));

    // Playing goes around the sample counts, until the second press.
    page.key("p");
    for samples in ["1", "4"] {
        let next = of("sampled", samples);
        page.wait(&format!(
            "document.querySelector('.viewer-stage canvas').dataset.shown === '{next}'"
        ));
    }
    page.key("p");

    // An address restores the view.
    let first = of("sampled", "4");
    open(
        &mut page,
        &report,
        &format!("cell={first}&split=0.5&texel=11,13&mode=signed"),
    );
    for key in ["]", "]", "+", "+", "c"] {
        page.key(key);
    }
    page.wait("location.hash.includes('clip=1')");
    let address = page.eval("location.hash").as_str().unwrap().to_owned();
    let state = "(() => { const c = document.querySelector('.viewer-stage canvas'); return \
                 [c.dataset.shown, c.dataset.mode, \
                 document.querySelector('.split-handle').style.left, \
                 document.querySelector('.scale-text').textContent, \
                 document.getElementById('exposure').value, document.querySelector('.probe h2 \
                 span').textContent]; })()";
    let before = page.eval(state);
    assert_eq!([&before[0], &before[1]], [&json!(first), &json!("signed")]);
    assert_eq!(before[5], json!("texel (11, 13) · pinned"));
    page.go(&report, &address);
    page.wait(READY);
    assert_eq!(page.eval(state), before);
    // Addresses are limited to the range of the controls; texts that are not numbers are ignored.
    for (address, wanted) in [
        (
            "contrast=-3&ev=99&zoom=1e6&x=-500&split=7",
            json!(["0.1", "14", "96×", "100%"]),
        ),
        ("contrast=x&ev=&cell=%&zoom=NaN", json!(["1", "0"])),
    ] {
        open(&mut page, &report, address);
        let shown = page.eval(
            "[document.getElementById('contrast').value, \
             document.getElementById('exposure').value, \
             document.querySelector('.scale-text').textContent, \
             document.querySelector('.split-handle').style.left]",
        );
        let count = wanted.as_array().unwrap().len();
        assert_eq!(
            json!(shown.as_array().unwrap()[..count]),
            wanted,
            "{address}"
        );
    }
    assert_clean(&page);
}
