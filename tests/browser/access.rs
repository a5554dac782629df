//! What a screen reader and the keyboard need: headings in order, names, places to scroll to.

use crate::fixture::{assert_clean, cell, report};
use serde_json::json;
use splitsum::report::page::images::Choice;

/// What is wrong with the view that is shown, one text a fault.
const FAULTS: &str = "(() => { const faults = [], view = document.querySelector('.view:not([hidden])'); \
    const seen = (e) => e.getClientRects().length > 0, all = (selector) => [...view.querySelectorAll(selector)].filter(seen); \
    const levels = all('h1, h2, h3, h4').map((e) => Number(e.localName[1])); \
    if (levels.filter((level) => level === 1).length !== 1 || levels[0] !== 1) faults.push(`headings ${levels}`); \
    levels.forEach((level, i) => { if (i && level > levels[i - 1] + 1) faults.push(`heading ${level} after ${levels[i - 1]}`); }); \
    for (const e of all('th')) if (!e.textContent.trim()) faults.push('a table head says nothing'); \
    for (const e of all('.scroll')) if (e.tabIndex !== 0 || !e.getAttribute('aria-label')) faults.push(`what scrolls cannot be reached: ${e.className}`); \
    const named = (e) => e.getAttribute('aria-label')?.trim() || e.getAttribute('aria-labelledby') || e.labels?.length || e.textContent.trim(); \
    for (const e of all('button, a, input, select, canvas[role], svg[role=img], [tabindex=\"0\"]')) if (!named(e)) faults.push(`no name: ${e.outerHTML.slice(0, 120)}`); \
    const ids = [...document.querySelectorAll('[id]')].map((e) => e.id); \
    if (new Set(ids).size < ids.length) faults.push('two elements have one id'); \
    for (const e of document.querySelectorAll('[aria-labelledby], [aria-controls], [aria-describedby]')) for (const name of ['labelledby', 'controls', 'describedby']) { \
      const id = e.getAttribute(`aria-${name}`); if (id && !document.getElementById(id)) faults.push(`aria-${name} of nothing: ${id}`); } \
    return faults; })()";

#[test]
fn every_view_can_be_read_and_reached() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    let id = cell(&report, ["sampled", "4", "0.1", "ggx", "1"]);
    page.go(&report, "");
    for width in [390, 1440] {
        page.resize(width, 844, "light");
        for view in ["answer", "images", "compare", "live", "tables", "run"] {
            page.follow(&if view == "compare" { format!("#compare?cell={id}&split=0.5") } else { format!("#{view}") });
            assert_eq!(page.eval(FAULTS), json!([]), "{view} at {width}");
        }
    }
    // The link over the menu is the first stop of the keyboard, and leads to the view.
    page.go(&report, "");
    page.key("Tab");
    assert_eq!(page.eval("document.activeElement.id"), json!("skip"));
    page.eval("document.activeElement.click()");
    assert_eq!(page.eval("document.activeElement.id"), json!("main"));
    page.eval("document.querySelector('.view:not([hidden]) h1').remove()");
    assert!(!page.eval(FAULTS).as_array().unwrap().is_empty(), "the measure finds what it is to find");
    assert_clean(&page);
}
