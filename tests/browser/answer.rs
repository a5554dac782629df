//! The answers: what stands on the first screen, sections with figures that are reached by pointer and keyboard, files to save.

use crate::fixture::{HOSTILE, SIDE, assert_clean, report, saved};
use serde_json::{Value, json};
use splitsum::report::page::images::Choice;
use splitsum::table::csv::Table;

#[test]
fn the_first_screen_of_a_laptop_answers_and_hostile_names_stay_text() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    for (width, height) in [(1366, 768), (1280, 720)] {
        page.resize(width, height, "light");
        let ready = page.go(&report, "");
        println!("interactive after {ready} ms");
        assert!(ready < 10_000.0, "{ready} ms");
        assert_eq!(page.text("#question"), HOSTILE);
        assert!(page.text(".first .sentence").contains("16 samples a pixel"), "{}", page.text(".first .sentence"));
        assert!(page.text(".device").contains("fake · formula") && page.text(".device").ends_with(" UTC"));
        // The case with its error: the method beside the reference, and a figure or a digest.
        assert_eq!(
            page.eval("[...document.querySelectorAll('.shots img')].map((i) => i.naturalWidth)"),
            json!([SIDE, SIDE, SIDE])
        );
        assert!(page.text(".shots").contains("split-sum") && page.text(".shots").contains("reference"));
        assert!(page.text(".case figcaption").contains("relmse"), "{}", page.text(".case figcaption"));
        let bottoms = "[...document.querySelectorAll('#question, .first .sentence, .shots, .lead-side :is(svg, table)')].filter((e) => e.getClientRects().length) \
                       .map((e) => e.getBoundingClientRect().bottom)";
        let bottoms = page.eval(bottoms);
        let all: Vec<f64> = bottoms.as_array().unwrap().iter().map(|bottom| bottom.as_f64().unwrap()).collect();
        assert!(all.len() >= 4 && all.iter().all(|bottom| *bottom < f64::from(height)), "{width}: {bottoms}");
        // Of a sentence about times of a CPU driver nothing is there.
        assert!(!page.text(".lead").contains("CPU driver"));
    }
    page.go(&report, "#run");
    let run = page.text("#view-run");
    assert!(run.contains("phong has \"<b>no</b>\" alpha of 0.5 & </script>") && run.contains(HOSTILE), "{run}");
    assert_eq!(page.eval("window.pwned ?? null"), Value::Null);
    assert_eq!(
        page.eval("document.querySelectorAll('img:not([src^=\"data:image/png\"]), b:not(.warning b, .case b)').length"),
        json!(0)
    );
    assert_clean(&page);
}

#[test]
fn every_answer_has_its_section_and_saves_what_stands_in_it() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    page.resize(1366, 768, "light");
    page.go(&report, "");
    let keys = page.eval("import('report/data').then(({ model }) => model.answers.map((one) => one.name))");
    assert!(!keys.as_array().unwrap().is_empty());
    for (i, key) in keys.as_array().unwrap().iter().enumerate() {
        let key = key.as_str().unwrap();
        assert_eq!(
            page.eval(&format!("document.querySelectorAll('.answer[id=\"{key}\"] .sentence').length")),
            json!(1),
            "{key}"
        );
        let button =
            |name: &str| format!("document.querySelector('.answer-tools[data-answer=\"{i}\"] [data-save={name}]')");
        // The table as it is saved is the one that is shown.
        let path = report.with_file_name("saved.csv");
        std::fs::write(&path, saved(&mut page, &button("csv"))).unwrap();
        let table = Table::read(&path).unwrap();
        page.eval(&format!("{}.closest('.answer-tools').querySelector('summary').click()", button("csv")));
        page.wait(&format!("document.querySelector('.answer-tools[data-answer=\"{i}\"] .data-table') !== null"));
        let shown = page.eval(&format!(
            "document.querySelectorAll('.answer-tools[data-answer=\"{i}\"] .data-table tbody tr').length"
        ));
        assert_eq!(shown.as_u64().unwrap() as usize, table.rows.len().min(200), "{key}");
        if page.eval(&format!("{} === null", button("svg"))) == json!(true) {
            continue;
        }
        let svg = saved(&mut page, &button("svg"));
        assert!(svg.starts_with("<svg") && !svg.contains("tabindex=\"0\""), "{key}: {}", &svg[..200]);
        let parsed = page.eval(&format!(
            "new DOMParser().parseFromString({}, 'image/svg+xml').querySelector('parsererror') === null",
            json!(svg)
        ));
        assert_eq!(parsed, json!(true), "{key}");
    }
    // An address leads to its answer.
    let last = keys.as_array().unwrap().last().unwrap().as_str().unwrap().to_owned();
    page.go(&report, &format!("#{last}"));
    assert_eq!(page.eval("document.body.dataset.view"), json!("answer"));
    assert_clean(&page);
}

#[test]
fn marks_are_reached_by_keyboard_and_pointer_and_lead_to_their_cells() {
    let Some((mut page, report, _dir)) = report(Choice::Automatic) else { return };
    for (width, side) in [(1366, "desk"), (390, "phone")] {
        page.resize(width, 800, "light");
        page.go(&report, "");
        let figures = page.eval(&format!("document.querySelectorAll('.{side} svg').length")).as_u64().unwrap();
        assert!(figures > 0);
        for i in 0..figures {
            // One mark is a stop of the keyboard; arrows reach every other one, each with its words.
            let walked = page.eval(&format!(
                "(() => {{ const svg = document.querySelectorAll('.{side} svg')[{i}], marks = [...svg.querySelectorAll('.mark')], seen = new Set(); \
                 if (!marks.length) return [0, 0, 0, 0]; \
                 const stops = svg.querySelectorAll('.mark[tabindex=\"0\"]').length; marks[0].focus(); let told = 0; \
                 for (let n = 0; n < 3000 && !seen.has(document.activeElement); n++) {{ const at = document.activeElement; seen.add(at); \
                   told += !document.querySelector('.tip').hidden && document.querySelector('.tip').textContent === at.dataset.tip; \
                   at.dispatchEvent(new KeyboardEvent('keydown', {{ key: 'ArrowRight', bubbles: true }})); }} \
                 return [stops - 1, marks.length - seen.size, marks.length - told, marks.filter((m) => !m.getAttribute('aria-label')).length]; }})()"
            ));
            assert_eq!(walked, json!([0, 0, 0, 0]), "figure {i} at {width}");
        }
        let cell = page.eval(&format!("document.querySelector('.{side} .mark[data-cell]').dataset.cell"));
        page.eval(&format!("document.querySelector('.{side} .mark[data-cell]').focus()"));
        page.key("Enter");
        page.wait("document.body.dataset.view === 'compare'");
        assert!(page.eval("location.hash").as_str().unwrap().contains(cell.as_str().unwrap()));
        page.go(&report, "");
        page.click(&format!(".{side} .mark[data-cell] path"));
        page.wait("document.body.dataset.view === 'compare'");
    }
    assert_clean(&page);
}
