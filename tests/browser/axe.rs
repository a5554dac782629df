//! What a screen reader, the keyboard and weak eyes need, judged by axe-core: names, roles, headings, contrast, places to scroll to.

use crate::chromium::Page;
use crate::fixture::{assert_clean, cell, report};
use serde_json::{Value, json};
use splitsum::report::page::images::Choice;
use std::path::Path;

/// Where scripts/check-page.sh installs it.
const SCRIPT: &str = "target/page-tools/node_modules/axe-core/axe.min.js";

/// The script of axe-core; `None` (with a line) if it is not installed.
fn axe() -> Option<String> {
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(SCRIPT)).ok();
    if text.is_none() {
        eprintln!("skipped: no axe-core; `sh scripts/check-page.sh` installs it (needs npm)");
        assert!(std::env::var_os("SPLITSUM_REQUIRE_BROWSER").is_none(), "SPLITSUM_REQUIRE_BROWSER is set");
    }
    text
}

/// The faults of the view that is shown: rule, element and what is wrong.
fn faults(page: &mut Page) -> Value {
    page.eval(
        "axe.run(document, { resultTypes: ['violations'] }).then(({ violations }) => violations.flatMap((rule) => \
         rule.nodes.map((node) => `${rule.id}: ${node.html.slice(0, 160)} ${node.failureSummary}`)))",
    )
}

#[test]
fn every_view_passes_axe() {
    let Some(axe) = axe() else { return };
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    let id = cell(&report, ["sampled", "4", "0.1", "ggx", "1"]);
    let mut all = Vec::new();
    for (width, scheme) in [(390, "light"), (1440, "light"), (1440, "dark")] {
        page.resize(width, 844, scheme);
        page.go(&report, "");
        page.eval(&format!("{axe}; null"));
        for view in ["answer", "images", "compare", "live", "tables", "run"] {
            page.follow(&if view == "compare" { format!("#compare?cell={id}&split=0.5") } else { format!("#{view}") });
            let found = faults(&mut page);
            all.extend(found.as_array().unwrap().iter().map(|fault| format!("{view} at {width}, {scheme}: {fault}")));
        }
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
    page.eval("document.querySelector('.view:not([hidden]) h1').remove()");
    page.eval("document.querySelector('.view:not([hidden]) p').style.color = '#444'");
    let found = faults(&mut page).to_string();
    assert!(found.contains("heading") && found.contains("color-contrast"), "axe finds no fault that was made: {found}");
    // The link over the menu is the first stop of the keyboard, and leads to the view.
    page.go(&report, "");
    page.key("Tab");
    assert_eq!(page.eval("document.activeElement.id"), json!("skip"));
    page.eval("document.activeElement.click()");
    assert_eq!(page.eval("document.activeElement.id"), json!("main"));
    assert_clean(&page);
}
