//! Figures are legible: words do not overlap and stay within the picture, and colours have
//! contrast.

use super::figures::{Drawn, dots, hard};
use crate::table;
use roxmltree::Node;
use splitsum::draw::figure::ink::{INKS, SERIES, method_ink};
use splitsum::draw::figure::svg::{WIDTHS, svg};
use splitsum::draw::figure::text::{ASCENT, AXIS, DESCENT, Font, LABEL, NAME, NOTE, TITLE};
use splitsum::draw::figure::{Mark, ScaleKind, Series, Shape};

/// Contrast of words, and of series with their names, with their ground (WCAG 2.2, 1.4.3).
const WORDS_LEAST: f64 = 4.5;

fn font(node: &Node) -> Font {
    let class = node.attribute("class").unwrap_or_default();
    let known = [TITLE, NAME, AXIS, NOTE]
        .into_iter()
        .find(|font| font.class == class);
    let is_name = class.starts_with("fig-n ");
    known.unwrap_or(if is_name { NAME } else { LABEL })
}

/// Left, top, right and bottom of a text.
fn area(node: &Node) -> [f64; 4] {
    let number = |key: &str| {
        node.attribute(key)
            .and_then(|value| value.parse::<f64>().ok())
            .unwrap()
    };
    let font = font(node);
    let words = node
        .children()
        .find(|child| child.is_text())
        .and_then(|child| child.text())
        .unwrap_or_default();
    let width = font.width(words);
    let before = match node.attribute("text-anchor") {
        Some("middle") => width / 2.0,
        Some("end") => width,
        _ => 0.0,
    };
    let (x, y, up, down) = (
        number("x"),
        number("y"),
        font.size * ASCENT,
        font.size * DESCENT,
    );
    match node.has_attribute("transform") {
        true => [x - up, y + before - width, x + down, y + before],
        false => [x - before, y - up, x - before + width, y + down],
    }
}

#[test]
fn no_words_leave_the_picture_or_hide_others() {
    for figure in hard() {
        for width in WIDTHS {
            let drawn = Drawn::new(&svg(&figure, width));
            let root = drawn.document().root_element();
            let size = ["width", "height"].map(|key| {
                root.attribute(key)
                    .and_then(|value| value.parse::<f64>().ok())
                    .unwrap()
            });
            let texts: Vec<Node> = root
                .descendants()
                .filter(|node| node.tag_name().name() == "text")
                .collect();
            let areas: Vec<[f64; 4]> = texts.iter().map(area).collect();
            for (i, a) in areas.iter().enumerate() {
                let of = |k: usize| format!("{:?} {:?}", texts[k].text(), areas[k]);
                let is_inside = a[0] >= 0.0 && a[1] >= 0.0 && a[2] <= size[0] && a[3] <= size[1];
                assert!(
                    is_inside,
                    "{} at {width}: {} leaves {size:?}",
                    figure.title,
                    of(i)
                );
                for (k, b) in areas[..i].iter().enumerate() {
                    let is_hidden = a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];
                    assert!(
                        !is_hidden,
                        "{} at {width}: {} on {}",
                        figure.title,
                        of(i),
                        of(k)
                    );
                }
            }
        }
    }
}

fn luminance(color: &str) -> f64 {
    table::luminance([1, 3, 5].map(|i| u8::from_str_radix(&color[i..i + 2], 16).unwrap()))
}

fn contrast(a: &str, b: &str) -> f64 {
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

fn ink(name: &str) -> [&'static str; 2] {
    INKS.iter().find(|ink| ink.selector == name).unwrap().colors
}

#[test]
fn series_and_words_have_contrast_on_both_grounds() {
    for side in [0, 1] {
        let ground = ink(".fig-ground")[side];
        for series in SERIES {
            let found = contrast(series[side], ground);
            assert!(
                found >= WORDS_LEAST,
                "{} on {ground}: {found}",
                series[side]
            );
        }
        for name in [".fig-ink", ".fig-muted"] {
            let found = contrast(ink(name)[side], ground);
            assert!(found >= WORDS_LEAST, "{name} on {ground}: {found}");
        }
        let colors: std::collections::BTreeSet<&str> =
            SERIES.iter().map(|series| series[side]).collect();
        assert_eq!(colors.len(), SERIES.len());
    }
}

/// Every figure of methods, whichever it shows and in whichever order, gives a method the same
/// colour.
#[test]
fn a_method_has_one_colour_in_every_figure() {
    let names = [
        "split-sum",
        "split-sum-one",
        "split-sum-two",
        "sampled",
        "sampled-vndf",
    ];
    let mut colors = std::collections::BTreeMap::new();
    for shown in [vec![0, 1, 2, 3, 4], vec![4, 2], vec![3, 1, 0], vec![1]] {
        let mut figure = dots(
            [
                ScaleKind::Linear { lo: 0.0, hi: 1.0 },
                ScaleKind::Linear { lo: 0.0, hi: 1.0 },
            ],
            &[],
        );
        let series = shown.iter().map(|of| names[*of].to_owned());
        figure.series = series
            .map(|name| Series {
                ink: method_ink(&name),
                name,
                is_dashed: false,
            })
            .collect();
        let mark = |(i, _)| Mark::new(Shape::Line(vec![[0.0, 0.5], [1.0, i as f64 / 8.0]]), i);
        figure.panels[0].marks = shown.iter().enumerate().map(mark).collect();
        let drawn = Drawn::new(&svg(&figure, WIDTHS[0]));
        let labels = drawn.document().descendants().filter(|node| {
            node.attribute("class")
                .is_some_and(|class| class.starts_with("fig-n fig-s"))
                && node.text().is_some()
        });
        let labels: Vec<_> = labels
            .map(|node| (node.text().unwrap(), node.attribute("class").unwrap()))
            .collect();
        assert!(
            shown.len() == 1 || labels.len() == shown.len(),
            "{labels:?}"
        );
        for (name, class) in labels {
            assert_eq!(
                *colors.entry(name.to_owned()).or_insert(class.to_owned()),
                class,
                "{name}"
            );
        }
    }
    let distinct: std::collections::BTreeSet<&String> = colors.values().collect();
    assert!(
        colors.len() == names.len() && distinct.len() == names.len(),
        "{colors:?}"
    );
}
