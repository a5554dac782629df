//! The site of published runs opens from the disk, fits every width, and leads to the cases of a
//! report.

use crate::chromium;
use crate::fixture::{HOSTILE, assert_clean, finished_run};
use crate::pages::{axe, faults};
use serde_json::{Value, json};
use splitsum::report::gallery::{INDEX_FILE, write};
use splitsum::report::publish::publish;
use splitsum::report::write::Written;
use splitsum::study::finished::Finished;
use splitsum::study::questions::answers;

#[test]
fn a_site_leads_to_a_case_of_a_report_and_asks_for_nothing_else() {
    let Some(mut page) = chromium::open() else {
        return;
    };
    let axe = axe();
    let dir = tempfile::tempdir().unwrap();
    let folder = finished_run(dir.path(), "run", None);
    let read = || {
        let run = Finished::read(&folder).unwrap();
        let answers = answers(&run, None);
        (run, answers)
    };
    let (results, out) = (dir.path().join("results"), dir.path().join("site"));
    // Only published answers get a report.
    std::fs::create_dir(&results).unwrap();
    assert!(write(&results, &[read()], &out).unwrap_err().is_misuse());
    let (run, own) = read();
    Written::new(&run, &own).unwrap().write().unwrap();
    publish(&folder, &results, false).unwrap();
    write(&results, &[(run, own)], &out).unwrap();
    for (width, scheme) in [(390, "light"), (1280, "dark"), (1920, "light")] {
        page.resize(width, 844, scheme);
        page.visit(
            &out.join(INDEX_FILE),
            "",
            "document.readyState === 'complete' && document.querySelector('.card h3 a') !== null",
        );
        let overflow = page
            .eval("document.documentElement.scrollWidth - document.documentElement.clientWidth");
        assert!(
            overflow.as_i64().unwrap() <= 0,
            "{overflow} pixels too wide at {width}"
        );
        if let Some(axe) = &axe {
            page.eval(&format!("{axe}; null"));
            assert_eq!(faults(&mut page), Vec::<String>::new(), "{width}, {scheme}");
        }
    }
    assert_eq!(page.eval("window.pwned ?? null"), Value::Null);
    assert!(
        page.text(".card h3")
            .contains(HOSTILE.split('\n').next().unwrap())
    );
    page.eval("document.querySelector('.card a[href*=\"#compare\"]').click()");
    page.wait("document.querySelector('.viewer-stage canvas')?.dataset.ready !== undefined");
    // The page is without the folder of its run.
    assert_eq!(
        page.eval("document.querySelectorAll('a[href*=\"images/\"], a[href*=\"tables/\"]').length"),
        json!(0)
    );
    page.follow("#live");
    page.wait("document.querySelector('.live-stage canvas') !== null");
    page.eval("history.go(-1)");
    assert_clean(&page);
}
