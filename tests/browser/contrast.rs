//! Contrast of the page's colours in both themes, as WCAG 2 defines it: 4.5 to 1 for text.

use crate::chromium::Page;
use crate::fixture::report;
use splitsum::report::page::images::Choice;

const TEXT: f64 = 4.5;

/// Red, green and blue of an expression's colour, as the browser computes it.
fn rgb(page: &mut Page, color: &str) -> [f64; 3] {
    let script = format!(
        "(() => {{ const e = document.createElement('i'); e.style.color = '{color}'; document.body.append(e); \
         const c = getComputedStyle(e).color.match(/[\\d.]+/g).map(Number); e.remove(); return c; }})()"
    );
    let all = page.eval(&script);
    std::array::from_fn(|c| all[c].as_f64().unwrap_or_else(|| panic!("{color}: {all}")))
}

fn luminance(color: [f64; 3]) -> f64 {
    let linear = color.map(|code| match code / 255.0 {
        c if c <= 0.04045 => c / 12.92,
        c => ((c + 0.055) / 1.055).powf(2.4),
    });
    0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
}

fn contrast(a: [f64; 3], b: [f64; 3]) -> f64 {
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

#[test]
fn the_measure_is_that_of_wcag() {
    // Black on white, and the grey that is known as the lightest one of 4.5 to 1 on white.
    assert!((contrast([0.0; 3], [255.0; 3]) - 21.0).abs() < 1e-12);
    assert!((contrast([118.0; 3], [255.0; 3]) - 4.54).abs() < 0.005);
}

#[test]
fn text_stands_out_in_both_themes() {
    let Some((mut page, report, _dir)) = report(Choice::None) else { return };
    for scheme in ["light", "dark"] {
        page.resize(1200, 800, scheme);
        page.go(&report, "");
        let mut check = |front: &str, back: &str, least: f64| {
            let [a, b] = [front, back].map(|name| rgb(&mut page, &format!("var(--{name})")));
            assert!(contrast(a, b) >= least, "{scheme}: {front} on {back} has {:.2}, not {least}", contrast(a, b));
        };
        for name in ["ink", "muted", "accent", "warn"] {
            check(name, "paper", TEXT);
        }
        for (front, back) in
            [("warn", "warn-paper"), ("muted", "faint"), ("paper", "accent"), ("paper", "good"), ("paper", "ink")]
        {
            check(front, back, TEXT);
        }
    }
}

/// What is drawn in figures and written around them, as the browser paints it.
const PAINTED: &str = "[...document.querySelectorAll('.desk .fig text:not(.fig-dark, .fig-pale), .view:not([hidden]) :is(p, td, th, h1, h2, summary, figcaption, button)')] \
    .filter((e) => e.getClientRects().length && e.textContent.trim()).map((e) => { const style = getComputedStyle(e); \
    return e.ownerSVGElement ? style.fill : style.color; })";

#[test]
fn words_stand_out_from_what_is_below_them() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    for scheme in ["light", "dark"] {
        page.resize(1366, 768, scheme);
        page.go(&report, "");
        let paper = rgb(&mut page, "var(--paper)");
        let painted = page.eval(PAINTED);
        let colors: std::collections::BTreeSet<&str> =
            painted.as_array().unwrap().iter().filter_map(|c| c.as_str()).collect();
        assert!(colors.len() > 2, "{colors:?}");
        for color in colors {
            let own = rgb(&mut page, color);
            assert!(contrast(own, paper) >= TEXT, "{scheme}: {color} has {:.2}", contrast(own, paper));
        }
    }
}
