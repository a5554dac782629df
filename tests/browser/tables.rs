//! The table of all cells: a choice for each swept axis, sorting, saving, and where a row leads.

use crate::chromium::Page;
use crate::fixture::{assert_clean, report, rows, saved};
use serde_json::json;
use splitsum::report::page::images::Choice;
use splitsum::table::csv::Table;

/// Chooses a value of an axis.
fn choose(page: &mut Page, axis: &str, value: &str) {
    page.eval(&format!(
        "(() => {{ const label = [...document.querySelectorAll('.controls .choice')].find((e) => e.firstChild.textContent === '{axis}'); \
         const box = label.querySelector('select'); box.value = '{value}'; box.dispatchEvent(new Event('change')); }})()"
    ));
}

fn column(page: &mut Page, name: &str) -> Vec<String> {
    let script = format!(
        "(() => {{ const heads = [...document.querySelectorAll('.data-table th')]; \
         const i = heads.findIndex((th) => th.querySelector('[data-sort=\"{name}\"]')); \
         return [...document.querySelectorAll('.data-table tbody tr')].map((tr) => tr.children[i].title); }})()"
    );
    page.eval(&script).as_array().unwrap().iter().map(|value| value.as_str().unwrap().to_owned()).collect()
}

fn numbers(texts: &[String]) -> Vec<f64> {
    texts.iter().map(|text| text.parse().unwrap()).collect()
}

#[test]
fn choices_and_sorting_are_kept_in_the_address() {
    let Some((mut page, report, _dir)) = report(Choice::None) else { return };
    page.resize(1200, 800, "light");
    page.go(&report, "#tables");
    let all = rows(&report);
    assert_eq!(column(&mut page, "cell").len(), all.len());
    choose(&mut page, "brdf", "phong");
    choose(&mut page, "samples", "16");
    let wanted = all.iter().filter(|row| row[4] == "phong" && row[2] == "16").count();
    assert_eq!(column(&mut page, "brdf"), vec!["phong"; wanted]);
    assert!(page.text("#view-tables .note").starts_with(&format!("{wanted} of {} cells", all.len())));
    page.click("[data-sort=rmse]");
    assert!(numbers(&column(&mut page, "rmse")).is_sorted());
    page.click("[data-sort=rmse]");
    assert!(numbers(&column(&mut page, "rmse")).is_sorted_by(|a, b| a >= b));
    page.wait("location.hash.includes('sort=-rmse')");
    let hash = page.eval("location.hash").as_str().unwrap().to_owned();
    assert!(hash.contains("brdf=phong") && hash.contains("samples=16"), "{hash}");
    page.go(&report, &hash);
    assert_eq!(column(&mut page, "brdf").len(), wanted);
    // An axis that a method does not use is last, whichever way the rest is sorted.
    page.go(&report, "#tables?sort=-samples");
    let samples = column(&mut page, "samples");
    assert!(samples[0] == "16" && samples.last().unwrap().is_empty(), "{samples:?}");
    assert_clean(&page);
}

#[test]
fn what_is_saved_is_what_is_shown_and_rows_lead_to_images() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    page.resize(1200, 800, "light");
    page.go(&report, "#tables?alpha=0.1");
    let shown = column(&mut page, "cell");
    let path = report.with_file_name("saved.csv");
    std::fs::write(&path, saved(&mut page, "document.querySelector('#view-tables .controls > button')")).unwrap();
    let (saved, truth) = (Table::read(&path).unwrap(), Table::read(&report.with_file_name("errors.csv")).unwrap());
    let place = |table: &Table, name: &str| table.column(name).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(saved.rows.iter().map(|row| row[place(&saved, "cell")].clone()).collect::<Vec<_>>(), shown);
    let metrics = ["rmse", "flip", "ssim"];
    for row in &saved.rows {
        let id = &row[place(&saved, "cell")];
        let other = truth.rows.iter().find(|other| other[place(&truth, "cell")] == *id).unwrap();
        for name in metrics {
            let [a, b] =
                [(&saved, row), (&truth, other)].map(|(table, row)| row[place(table, name)].parse::<f64>().unwrap());
            assert_eq!(a, b, "{name} of {id}");
        }
        // What people author stands beside what is swept.
        let roughness: f64 = row[place(&saved, "perceptual_roughness")].parse().unwrap();
        assert!((roughness * roughness - 0.1).abs() < 1e-4, "{roughness}");
    }
    page.click(".data-table tbody td button");
    page.wait("document.body.dataset.view === 'compare'");
    page.wait(&format!("document.querySelector('.viewer-stage canvas').dataset.shown === {}", json!(shown[0])));
    assert_clean(&page);
}
