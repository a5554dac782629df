//! The live view: its controls, its link, what it says where it cannot be shown.

use crate::chromium::Page;
use crate::fixture::{assert_clean, page_of, report};
use serde_json::{Value, json};
use splitsum::study::page::images::Choice;
use splitsum::table::colormap::{OFF_MASK_COLOR, RELATIVE_ERROR, SIGNED_ERROR};
use splitsum::tonemap::ToneCurve;
use std::path::Path;

/// Waits until the view is at rest with every sample.
pub fn rest(page: &mut Page) {
    page.wait("document.querySelector('.live-stage canvas')?.dataset.ready === '1'");
}

/// Opens the view with a stage of `size` and makes it reachable as `live`.
pub fn open(page: &mut Page, report: &Path, hash: &str, size: [u32; 2]) {
    page.go(report, hash);
    page.eval(&format!(
        "import('report/live').then((module) => {{ window.live = module.liveView(); \
         document.querySelector('.live-stage').style.cssText = 'width: {}px; height: {}px; min-height: 0'; }})",
        size[0], size[1]
    ));
    page.wait(&format!("live.canvas.width === {} && live.canvas.height === {}", size[0], size[1]));
    rest(page);
}

/// Linear RGBA of the page.
pub fn linear(page: &mut Page, method: &str) -> Vec<[f64; 3]> {
    let values = page.eval(&format!("Array.from(live.render.linear('{method}'))"));
    let values: Vec<f64> = values.as_array().unwrap().iter().map(|x| x.as_f64().unwrap_or(f64::NAN)).collect();
    values.chunks_exact(4).map(|texel| [texel[0], texel[1], texel[2]]).collect()
}

/// Bytes of a pixel of the canvas, drawn in the same task; row 0 is the top.
fn drawn(page: &mut Page, mode: &str, x: u32, y: u32) -> [u8; 3] {
    let script = format!(
        "(() => {{ const gl = live.render.gl, out = new Uint8Array(4); live.render.drawResult('{mode}', false); \
         gl.readPixels({x}, live.canvas.height - 1 - {y}, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, out); return [...out]; }})()"
    );
    let bytes = page.eval(&script);
    std::array::from_fn(|c| bytes[c].as_u64().unwrap() as u8)
}

fn near(a: [u8; 3], b: [u8; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= 2)
}

#[test]
fn keys_sliders_and_the_link_of_the_live_view() {
    let Some((mut page, report, _dir)) = report(Choice::None) else { return };
    page.resize(1200, 800, "light");
    let size = [80, 60];
    open(&mut page, &report, "#live?object=sphere&pitch=0&yaw=0", size);
    let value = |page: &mut Page, script: &str| page.eval(script).as_f64().unwrap();
    let slide = |page: &mut Page, name: &str, value: f64| {
        page.eval(&format!(
            "(() => {{ const e = document.getElementById('live-{name}'); e.value = {value}; e.dispatchEvent(new Event('input')); }})()"
        ));
        rest(page);
    };
    // Constant light of radiance 1 and a lobe that reflects f0 whole: a metal of this albedo shows it as its radiance.
    for (name, at) in [("red", 0.9), ("green", 0.5), ("blue", 0.1), ("brightness", 2.0), ("metallic", 1.0)] {
        slide(&mut page, name, at);
    }
    let middle = (size[1] / 2 * size[0] + size[0] / 2) as usize;
    let shown = linear(&mut page, "split")[middle];
    assert!(shown.iter().zip([1.8, 1.0, 0.2]).all(|(a, b)| (a - b).abs() < 2e-3), "{shown:?}");
    slide(&mut page, "exposure", 1.0);
    slide(&mut page, "contrast", 2.0);
    let curve = ToneCurve { exposure: 2.0, contrast: 2.0 };
    let bytes = drawn(&mut page, "split", size[0] / 2, size[1] / 2);
    assert!(near(bytes, curve.apply_rgb8(shown.map(|x| x as f32))), "{bytes:?}");

    // Roughness and alpha, as the project defines them.
    slide(&mut page, "roughness", 0.5);
    assert_eq!(page.text("output[for=live-roughness]"), "0.5 · α 0.25");

    // Errors have the project's colours.
    page.key("3");
    rest(&mut page);
    assert_eq!(page.eval("document.querySelectorAll('.live .ramp-ticks span').length"), json!(4));
    let [test, truth] = ["split", "sampled"].map(|method| linear(&mut page, method)[middle]);
    let relative: [f64; 3] = std::array::from_fn(|c| (test[c] - truth[c]) / (truth[c].powi(2) + 1e-2).sqrt());
    let error = (relative.iter().map(|e| e * e).sum::<f64>() / 3.0).sqrt();
    assert!(error > 1e-2, "{test:?} {truth:?}");
    let bytes = drawn(&mut page, "error", size[0] / 2, size[1] / 2);
    assert!(near(bytes, RELATIVE_ERROR.color(error)), "{bytes:?} {error}");
    let bytes = drawn(&mut page, "signed", size[0] / 2, size[1] / 2);
    let signed = relative.iter().sum::<f64>() / 3.0;
    assert!(near(bytes, SIGNED_ERROR.color(signed)), "{bytes:?} {signed}");
    assert_eq!(drawn(&mut page, "error", 1, 1), OFF_MASK_COLOR);

    // Any first part of the samples is an estimate of the whole.
    slide(&mut page, "samples", 9.0);
    let whole = linear(&mut page, "sampled")[middle][1];
    let told = page.eval(
        "(() => { live.render.restart(); live.render.drawBase(); live.render.drawSamples(8); live.describe(); return live.badge.textContent; })()",
    );
    assert_eq!(told, json!("split sum against 8 of 64 samples a pixel"));
    let part = linear(&mut page, "sampled")[middle][1];
    assert_eq!(page.eval("live.settings.samples"), json!(64));
    let share = page.eval("live.render.done");
    assert_eq!(share, json!(8));
    assert!((part - whole).abs() < 0.15 * whole, "{part} of 8 for {whole} of 64");

    // Keys turn, flip and hold.
    page.eval("live.canvas.focus()");
    for key in ["ArrowRight", "ArrowRight", "ArrowUp"] {
        page.key(key);
    }
    assert_eq!((value(&mut page, "live.settings.yaw"), value(&mut page, "live.settings.pitch")), (10.0, 5.0));
    for (key, mode) in [("1", "split"), ("4", "signed"), ("2", "sampled")] {
        page.key(key);
        page.wait(&format!("live.canvas.dataset.mode === '{mode}'"));
    }
    page.press(" ");
    page.wait("live.canvas.dataset.mode === 'split'");
    page.release(" ");
    page.wait("live.canvas.dataset.mode === 'sampled'");
    page.click(".live [aria-label=Nearer]");
    page.eval("document.querySelector('.live .pickers select:last-of-type')");
    rest(&mut page);

    // A drag turns.
    let before = value(&mut page, "live.settings.yaw");
    page.eval(
        "(() => { const c = live.canvas, b = c.getBoundingClientRect(); const at = (type, x) => c.dispatchEvent(new PointerEvent(type, \
         { pointerId: 1, clientX: b.left + x, clientY: b.top + 9, buttons: 1, bubbles: true })); \
         c.setPointerCapture = () => {}; at('pointerdown', 10); at('pointermove', 50); at('pointerup', 50); })()",
    );
    let turned = value(&mut page, "live.settings.yaw");
    assert!((turned - (before - 90.0)).abs() < 1e-9, "40 of 80 pixels are a quarter turn: {before} to {turned}");
    rest(&mut page);

    // The address restores everything.
    let settings = page.eval("JSON.stringify(live.settings)");
    page.wait("location.hash.includes('yaw=-80')");
    let hash = page.eval("location.hash").as_str().unwrap().to_owned();
    assert!(hash.contains("mode=sampled") && hash.contains("roughness=0.5"), "{hash}");
    open(&mut page, &report, &hash, size);
    let rounded = |text: &Value| {
        let value: Value = serde_json::from_str(text.as_str().unwrap()).unwrap();
        value
            .as_object()
            .unwrap()
            .iter()
            .map(|(k, v)| match v.as_f64() {
                Some(x) => (k.clone(), json!((x * 100.0).round() / 100.0)),
                None => (k.clone(), v.clone()),
            })
            .collect::<serde_json::Map<_, _>>()
    };
    assert_eq!(rounded(&page.eval("JSON.stringify(live.settings)")), rounded(&settings));

    // Everything has a name for a screen reader.
    let unnamed = page.eval(
        "[...document.querySelectorAll('.live input, .live select')].filter((e) => !e.labels?.[0]?.textContent.trim() && !e.getAttribute('aria-label')).length \
         + [...document.querySelectorAll('.live button')].filter((b) => !b.textContent.trim() && !b.getAttribute('aria-label')).length \
         + (document.querySelector('.live canvas').getAttribute('aria-label').includes('roughness') ? 0 : 1)",
    );
    assert_eq!(unnamed, json!(0));
    assert_clean(&page);
}

#[test]
fn without_float_targets_or_tables_the_live_view_says_so() {
    let Some((mut page, report, _dir)) = report(Choice::None) else { return };
    let blocked = "const get = WebGL2RenderingContext.prototype.getExtension; WebGL2RenderingContext.prototype.getExtension = \
                   function (name) { return name === 'EXT_color_buffer_float' ? null : get.call(this, name); };";
    page.before_load(blocked);
    page.go(&report, "#live");
    let text = page.text("#view-live");
    assert!(text.contains("EXT_color_buffer_float") && text.contains("needs"), "{text}");

    std::fs::remove_file(report.with_file_name("live.json")).unwrap();
    let dir = report.parent().unwrap();
    let written = page_of(dir, Choice::None);
    page.go(&written, "#live");
    assert!(page.text("#view-live").contains("has no live.json"));
    assert_clean(&page);
}

#[test]
fn the_probe_follows_the_samples_that_are_done() {
    let Some((mut page, report, _dir)) = report(Choice::None) else { return };
    page.resize(1200, 800, "light");
    open(&mut page, &report, "#live?object=sphere&mode=signed&n=64", [80, 60]);
    assert_eq!(page.text(".live .probe th:last-child"), "signed error");
    // The frames of a change before its last sample, one sample each, by hand.
    let seen = page.eval(
        "(() => { live.loop = () => {}; cancelAnimationFrame(live.frame); live.canvas.dataset.ready = ''; const read = () => [...document.querySelectorAll('.live .probe tbody tr')].map((r) => r.textContent); \
         const before = read(), r = live.render; Object.assign(r.view, { albedo: [0.1, 0.2, 0.3] }); r.restart(); r.drawBase(); r.stale = false; live.probe(); const base = read(); \
         r.drawSamples(3); live.probe(); return [before, base, read()]; })()",
    );
    let at = |state: usize, row: usize| seen[state][row].as_str().unwrap().to_owned();
    assert!(at(0, 1).starts_with("sampled") && !at(0, 1).contains(" of "), "{seen}");
    assert_ne!(at(0, 0), at(1, 0), "the split sum is that of the new settings at once");
    assert_eq!(at(1, 1), "sampled–––", "no row of the old settings");
    assert!(at(2, 1).starts_with("sampled (3 of 64)"), "{seen}");
    // The frames themselves ask for it.
    page.eval("(() => { delete live.loop; let count = 0; const probe = live.probe; live.probe = () => { if (live.canvas.dataset.ready !== '1') count += 1; window.probes = count; probe.call(live); }; live.set({ metallic: 0.5, samples: 64 }); })()");
    rest(&mut page);
    assert!(page.eval("window.probes").as_u64().unwrap() > 0);
    assert_clean(&page);
}
