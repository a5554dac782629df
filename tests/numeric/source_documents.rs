//! The numbers of docs/source-documents.md against the example that computes them.

#[path = "../../examples/source_document_slips.rs"]
#[allow(dead_code, reason = "its main is not called")]
mod source_document_slips;

use source_document_slips::{Slip, slips};

/// A row of the page's table of slips.
struct Row {
    document: u32,
    quantity: String,
    printed: String,
    correct: String,
}

fn page() -> String {
    std::fs::read_to_string("docs/source-documents.md").unwrap()
}

fn rows(page: &str) -> Vec<Row> {
    let after_head = page
        .lines()
        .skip_while(|line| !line.starts_with("| document |"));
    let rows = after_head.skip(2).take_while(|line| line.starts_with('|'));
    rows.map(|line| {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        assert_eq!(cells.len(), 6, "{line}");
        Row {
            document: cells[0].parse().unwrap(),
            quantity: cells[3].to_owned(),
            printed: cells[4].to_owned(),
            correct: cells[5].to_owned(),
        }
    })
    .collect()
}

/// Whether a text is a number with three digits, or with all that it needs.
fn is_rounded(text: &str, number: f64) -> bool {
    let Ok(written) = text.parse::<f64>() else {
        return text == "undefined" && !number.is_finite();
    };
    if written == 0.0 {
        return number.abs() < 1e-5;
    }
    let decimals = text
        .split_once('.')
        .map_or(0, |(_, digits)| digits.len() as i32);
    let third_digit = written.abs().log10().floor() as i32 - 2;
    let half_unit = 0.5 * 10f64.powi(third_digit.min(if decimals > 0 { -decimals } else { 0 }));
    (number - written).abs() <= half_unit * (1.0 + 1e-9)
}

#[test]
fn every_number_of_the_page_is_computed() {
    let page = page();
    let rows = rows(&page);
    assert_eq!(rows.len(), slips().count());
    for (row, Slip { document, figure }) in rows.iter().zip(slips()) {
        assert_eq!(
            (row.document, row.quantity.as_str()),
            (document, figure.quantity)
        );
        let values = (figure.values)();
        for (text, number) in [&row.printed, &row.correct].into_iter().zip(values) {
            assert!(
                is_rounded(text, number),
                "{}: {text}, computed {number}",
                row.quantity
            );
        }
    }
    let visible = slips().filter(|slip| slip.figure.changes_light()).count();
    let sentence = format!(
        "{visible} of the {} slips change light by more than 2 %.",
        rows.len()
    );
    assert!(page.replace('\n', " ").contains(&sentence), "{sentence}");
}
