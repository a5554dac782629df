//! The filter of tables: what it understands, and what it says of the rest.

use crate::chromium::Page;
use crate::fixture::{assert_clean, report, rows};
use serde_json::json;
use splitsum::study::report::images::Choice;

/// Types a filter. Returns the count of rows and what is said beside the box.
fn filtered(page: &mut Page, filter: &str) -> (usize, String) {
    page.eval(&format!(
        "(() => {{ const e = document.querySelector('input[type=search]'); e.value = {}; e.dispatchEvent(new Event('input')); }})()",
        json!(filter)
    ));
    let count = page.eval("document.querySelectorAll('.data-table tbody tr').length");
    (count.as_u64().unwrap() as usize, page.text(".complaint"))
}

#[test]
fn comparisons_may_have_spaces_and_what_is_not_understood_is_said() {
    let Some((mut page, report, _dir)) = report(Choice::None) else { return };
    page.resize(1200, 800, "light");
    page.go(&report, "#tables");
    let all = rows(&report);
    let count = |test: &dyn Fn(&[String; 6]) -> bool| all.iter().filter(|row| test(row)).count();
    let (low, ggx, other) = (count(&|r| r[3] == "0.1"), count(&|r| r[4] == "ggx"), count(&|r| r[4] != "ggx"));
    assert!(low > 0 && ggx > 0 && other > 0 && low < all.len());
    for (filter, wanted) in [
        ("alpha=0.1", low),
        ("alpha = 0.1", low),
        ("alpha =0.10", low),
        ("brdf != ggx", other),
        ("brdf!=ggx", other),
        ("ggx alpha <= 0.1", count(&|r| r[4] == "ggx" && r[3] == "0.1")),
        ("samples >= 4 brdf = \"phong\"", count(&|r| r[4] == "phong" && ["4", "16"].contains(&r[2].as_str()))),
        ("alpha < inf", all.len()),
        ("samples = \"\"", count(&|r| r[2].is_empty())),
        ("", all.len()),
    ] {
        assert_eq!(filtered(&mut page, filter), (wanted, String::new()), "{filter}");
    }
    // What is not understood hides nothing and is said in words.
    for (filter, wanted, why) in [
        ("rmse<=", all.len(), "says no number"),
        ("alpha =", all.len(), "says no value"),
        ("colour = red", all.len(), "no column “colour”"),
        ("= 3", all.len(), "names no column"),
        ("alpha < few brdf = ggx", ggx, "“few” is no number"),
        ("alph = 0.1", all.len(), "perhaps “alpha”"),
    ] {
        let (count, said) = filtered(&mut page, filter);
        assert_eq!(count, wanted, "{filter}");
        assert!(said.starts_with("Not understood:") && said.contains(why), "{filter}: {said}");
    }
    assert_clean(&page);
}

#[test]
fn filter_sort_and_focus_survive_a_change_of_columns() {
    let Some((mut page, report, _dir)) = report(Choice::None) else { return };
    page.resize(1200, 800, "light");
    page.go(&report, "#tables");
    let (wanted, _) = filtered(&mut page, "brdf = ggx");
    assert!(wanted > 0 && wanted < rows(&report).len());
    page.click("[data-sort=alpha]");
    page.eval("document.querySelector('.controls input[type=checkbox]').focus()");
    page.click(".controls input[type=checkbox]");
    let state = page.eval(
        "[document.querySelectorAll('.data-table tbody tr').length, document.querySelector('input[type=search]').value, \
         document.querySelector('th:has([data-sort=alpha])').getAttribute('aria-sort'), document.activeElement.type, document.activeElement.checked]",
    );
    assert_eq!(state, json!([wanted, "brdf = ggx", "ascending", "checkbox", true]));
    page.wait("location.hash.includes('columns=all')");
    let hash = page.eval("location.hash").as_str().unwrap().to_owned();
    assert!(hash.contains("filter=brdf") && hash.contains("sort=alpha"), "{hash}");
    assert_clean(&page);
}
