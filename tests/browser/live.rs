//! The live view: its controls, its link, its reference, and its message if it cannot be shown.

use crate::chromium::Page;
use crate::fixture::{assert_clean, report};
use serde_json::json;
use splitsum::draw::colormap::{OFF_MASK_COLOR, RELATIVE_ERROR, SIGNED_ERROR};
use splitsum::instrument::tonemap::ToneCurve;
use splitsum::report::page::images::Choice;
use std::path::Path;

/// Waits until the view has drawn every sample.
pub fn rest(page: &mut Page) {
    page.wait("document.querySelector('.live-stage canvas')?.dataset.ready === '1'");
}

/// Opens the view with a canvas of `size` and exposes it as `live`.
pub fn open(page: &mut Page, report: &Path, hash: &str, size: [u32; 2]) {
    page.go(report, hash);
    page.eval(&format!(
        "import('report/live').then((module) => {{ window.live = module.liveView(); \
         document.querySelector('.live-stage').style.cssText = 'width: {}px; height: {}px; \
         min-height: 0'; }})",
        size[0], size[1]
    ));
    page.wait(&format!(
        "live.canvas.width === {} && live.canvas.height === {}",
        size[0], size[1]
    ));
    rest(page);
}

/// Linear RGB of a method, with all its samples if the view has none, or of the reference; alpha is
/// 1 on the surface.
pub fn linear(page: &mut Page, way: &str) -> Vec<[f64; 4]> {
    let draw = format!(
        "live.render.done['{way}'] || live.render.drawSamples('{way}', live.render.total('{way}'))"
    );
    let values = page.eval(&format!("{draw}, Array.from(live.render.linear('{way}'))"));
    let values: Vec<f64> = values
        .as_array()
        .unwrap()
        .iter()
        .map(|x| x.as_f64().unwrap_or(f64::NAN))
        .collect();
    values
        .chunks_exact(4)
        .map(|texel| std::array::from_fn(|c| texel[c]))
        .collect()
}

/// Bytes of a pixel of the canvas, drawn in the same task; row 0 is the top.
fn drawn(page: &mut Page, mode: &str, x: u32, y: u32) -> [u8; 3] {
    let script = format!(
        "(() => {{ const gl = live.render.gl, out = new Uint8Array(4); \
         live.render.drawResult('split-sum', '{mode}'); \
         gl.readPixels({x}, live.canvas.height - 1 - {y}, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, out); \
         return [...out]; }})()"
    );
    let bytes = page.eval(&script);
    std::array::from_fn(|c| bytes[c].as_u64().unwrap() as u8)
}

fn near(a: [u8; 3], b: [u8; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= 2)
}

#[test]
fn keys_sliders_reference_and_link_of_the_live_view() {
    let Some((mut page, report, _dir)) = report(Choice::None) else {
        return;
    };
    page.resize(1200, 800, "light");
    let size = [80, 60];
    open(&mut page, &report, "#live", size);
    let value = |page: &mut Page, script: &str| page.eval(script).as_f64().unwrap();
    let slide = |page: &mut Page, name: &str, value: &str| {
        page.eval(&format!(
            "(() => {{ const e = document.getElementById('live-{name}'); e.value = '{value}'; \
             e.dispatchEvent(new Event('input')); }})()"
        ));
        rest(page);
    };
    // The view opens on the case in which the split sum errs most visibly, under the wipe.
    let worst = page.eval(
        "import('report/data').then(({ firstRow }) => Number(firstRow(() => true).axes.alpha))",
    );
    assert!(
        (value(&mut page, "live.settings.roughness").powi(2) - worst.as_f64().unwrap()).abs()
            < 1e-9
    );
    assert_eq!(
        page.eval("[live.settings.method, live.shown.wipe, live.parts.badge.textContent]"),
        json!(["split-sum", 0.5, "Split sum (textbook)"])
    );

    let middle = (size[1] / 2 * size[0] + size[0] / 2) as usize;
    let shown = linear(&mut page, "split-sum")[middle];
    slide(&mut page, "ev", "1");
    let curve = ToneCurve {
        exposure: 2.0,
        contrast: 1.0,
    };
    let bytes = drawn(&mut page, "image", size[0] / 2, size[1] / 2);
    let radiance = std::array::from_fn(|c| shown[c] as f32);
    assert!(near(bytes, curve.apply_rgb8(radiance)), "{bytes:?}");
    slide(&mut page, "contrast", "2");
    let curve = ToneCurve {
        contrast: 2.0,
        ..curve
    };
    let bytes = drawn(&mut page, "image", size[0] / 2, size[1] / 2);
    assert!(near(bytes, curve.apply_rgb8(radiance)), "{bytes:?}");
    slide(&mut page, "brightness", "2");
    let brighter = linear(&mut page, "split-sum")[middle];
    for c in 0..3 {
        assert!((brighter[c] / shown[c] - 2.0).abs() < 1e-3, "{brighter:?}");
    }
    // A channel of the albedo alone.
    let albedo = page.eval("live.surface.albedo");
    slide(&mut page, "albedo_g", "0.25");
    let wanted = json!([albedo[0], 0.25, albedo[2]]);
    assert_eq!(page.eval("live.settings.albedo"), wanted);
    page.eval("live.set({ albedo: null, brightness: 1, contrast: 1 })");
    rest(&mut page);
    slide(&mut page, "roughness", "0.5");
    slide(&mut page, "coat", "0.25");
    slide(&mut page, "anisotropy", "0.75");

    // Errors are against the reference, in the project's colours.
    page.eval("live.canvas.focus()");
    page.key("e");
    rest(&mut page);
    let [test, truth] = ["split-sum", "reference"].map(|way| linear(&mut page, way)[middle]);
    // The light has mean luminance 1.
    let relative: [f64; 3] =
        std::array::from_fn(|c| (test[c] - truth[c]) / (truth[c].powi(2) + 1e-2).sqrt());
    let error = (relative.iter().map(|e| e * e).sum::<f64>() / 3.0).sqrt();
    let bytes = drawn(&mut page, "error", size[0] / 2, size[1] / 2);
    assert!(
        near(bytes, RELATIVE_ERROR.color(error)),
        "{bytes:?} {error}"
    );
    let bytes = drawn(&mut page, "signed", size[0] / 2, size[1] / 2);
    assert!(
        near(
            bytes,
            SIGNED_ERROR.color(relative.iter().sum::<f64>() / 3.0)
        ),
        "{bytes:?}"
    );
    assert_eq!(drawn(&mut page, "error", 1, 1), OFF_MASK_COLOR);
    // Half of the samples agree with all samples: the noise is far below the error, or the
    // reference is complete.
    let done = value(&mut page, "live.render.done.reference");
    let [shown, noise] = ["relmse", "noise"]
        .map(|name| value(&mut page, &format!("Number(live.canvas.dataset.{name})")));
    assert!(
        noise <= 0.01 * shown || done == 4096.0,
        "{noise} beside {shown} after {done}"
    );

    // Keys turn the camera, flip the halves and hold.
    page.eval("live.set({ yaw: 0 }).then(() => null)");
    for key in ["ArrowRight", "ArrowRight", "ArrowUp"] {
        page.key(key);
    }
    assert_eq!(
        (
            value(&mut page, "live.settings.yaw"),
            value(&mut page, "live.settings.pitch")
        ),
        (10.0, 5.0)
    );
    for (key, shown) in [
        ("e", "split-sum image"),
        ("s", "split-sum signed"),
        ("3", "split-sum-frostbite signed"),
    ] {
        page.key(key);
        page.wait(&format!(
            "`${{live.canvas.dataset.method}} ${{live.canvas.dataset.mode}}` === '{shown}'"
        ));
    }
    // Dragging turns the camera.
    let before = value(&mut page, "live.settings.yaw");
    page.eval(
        "(() => { const c = live.canvas, b = c.getBoundingClientRect(); const at = (type, x) => \
         c.dispatchEvent(new PointerEvent(type, \
         { pointerId: 1, clientX: b.left + x, clientY: b.top + 9, buttons: 1, bubbles: true })); \
         c.setPointerCapture = () => {}; at('pointerdown', 10); at('pointermove', 50); \
         at('pointerup', 50); })()",
    );
    let turned = value(&mut page, "live.settings.yaw");
    assert!(
        (turned - (before - 90.0)).abs() < 1e-9,
        "40 of 80 pixels are a quarter turn: {before} to {turned}"
    );

    // The address restores everything.
    rest(&mut page);
    page.wait("location.hash.includes('yaw=-80')");
    let hash = page.eval("location.hash").as_str().unwrap().to_owned();
    assert!(
        hash.contains("method=split-sum-frostbite") && hash.contains("roughness=0.5"),
        "{hash}"
    );
    open(&mut page, &report, &hash, size);
    let restored = page.eval(
        "(({ method, roughness, coat, anisotropy, yaw, ev }) => [method, \
                              roughness, coat, anisotropy, yaw, ev])(live.settings)",
    );
    assert_eq!(
        restored,
        json!(["split-sum-frostbite", 0.5, 0.25, 0.75, -80, 1])
    );
    assert_clean(&page);
}

#[test]
fn without_float_targets_the_live_view_says_so() {
    let Some((mut page, report, _dir)) = report(Choice::None) else {
        return;
    };
    let blocked = "const get = WebGL2RenderingContext.prototype.getExtension; \
                   WebGL2RenderingContext.prototype.getExtension = \
                   function (name) { return name === 'EXT_color_buffer_float' ? null : \
                   get.call(this, name); };";
    page.before_load(blocked);
    page.go(&report, "#live");
    let text = page.text("#view-live");
    assert!(
        text.contains("EXT_color_buffer_float") && text.contains("needs"),
        "{text}"
    );
    assert_clean(&page);
}
