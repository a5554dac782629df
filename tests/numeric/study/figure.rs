//! Figures: the SVG shows the data of the marks.

mod crowded;
mod figures;
mod legible;

use figures::{Drawn, dots, hard, hostile};
use splitsum::draw::figure::svg::{WIDTHS, svg};
use splitsum::draw::figure::{Figure, Mark, Scale, ScaleKind, Shape};
use std::collections::BTreeSet;

/// A coordinate has two decimals.
const ROUNDING: f64 = 0.005 + 1e-6;

/// The place of a value in a domain from 0 to 1, by the definition of the scale.
fn share(kind: &ScaleKind, value: f64) -> f64 {
    match kind {
        ScaleKind::Linear { lo, hi } => (value - lo) / (hi - lo),
        ScaleKind::Log { lo, hi } => (value.log10() - lo.log10()) / (hi.log10() - lo.log10()),
        ScaleKind::Steps(names) => (value + 0.5) / names.len() as f64,
    }
}

fn kinds() -> Vec<(ScaleKind, Vec<f64>)> {
    vec![
        (
            ScaleKind::Linear { lo: -0.3, hi: 1.7 },
            vec![-0.3, -0.11, 0.0, 0.923, 1.7],
        ),
        (
            ScaleKind::Log { lo: 2e-4, hi: 31.0 },
            vec![2e-4, 1e-3, 0.017, 1.0, 31.0],
        ),
        (
            ScaleKind::Steps(["a", "b", "c", "d", "e"].map(str::to_owned).to_vec()),
            vec![0.0, 1.0, 2.0, 3.0, 4.0],
        ),
    ]
}

#[test]
fn a_mark_is_drawn_where_its_numbers_say() {
    for (x, xs) in kinds() {
        for (y, ys) in kinds() {
            let points: Vec<[f64; 2]> = xs.iter().zip(&ys).map(|(x, y)| [*x, *y]).collect();
            let figure = dots([x.clone(), y.clone()], &points);
            for width in WIDTHS {
                let drawn = Drawn::new(&svg(&figure, width));
                let [left, top, right, bottom] = drawn.panels()[0];
                let found = drawn.dots();
                assert_eq!(found.len(), points.len());
                for ([px, py], [vx, vy]) in found.into_iter().zip(&points) {
                    let down = matches!(y, ScaleKind::Steps(_));
                    let up = share(&y, *vy);
                    let expected = [
                        left + share(&x, *vx) * (right - left),
                        top + if down { up } else { 1.0 - up } * (bottom - top),
                    ];
                    // The panel's own corners are rounded, too.
                    let error = (px - expected[0]).abs().max((py - expected[1]).abs());
                    assert!(
                        error <= 2.0 * ROUNDING,
                        "{x:?} {y:?} at {width}: {vx}, {vy} is {error} px off"
                    );
                }
            }
        }
    }
}

#[test]
fn lines_whiskers_and_bars_end_where_their_numbers_say() {
    let [x, y] = [
        ScaleKind::Log { lo: 1.0, hi: 100.0 },
        ScaleKind::Linear { lo: 0.0, hi: 2.0 },
    ];
    let steps = kinds().remove(2).0;
    let first_path = |shape: Shape, x: &ScaleKind, y: &ScaleKind| -> ([f64; 4], Vec<f64>) {
        let mut figure = dots([x.clone(), y.clone()], &[]);
        figure.panels[0].marks = vec![Mark::new(shape, 0).tip("tip")];
        let drawn = Drawn::new(&svg(&figure, WIDTHS[0]));
        (drawn.panels()[0], drawn.numbers_of_first_mark())
    };
    let close = |a: &[f64], b: &[f64]| {
        assert!(
            a.len() >= b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 3.0 * ROUNDING),
            "{a:?} is not {b:?}"
        );
    };
    let line = Shape::Line(vec![[1.0, 2.0], [10.0, 0.5], [100.0, 1.0]]);
    let ([left, top, right, bottom], found) = first_path(line, &x, &y);
    let (wide, high) = (right - left, bottom - top);
    close(
        &found,
        &[
            left,
            top,
            left + wide / 2.0,
            bottom - high / 4.0,
            right,
            bottom - high / 2.0,
        ],
    );
    let (_, found) = first_path(Shape::Whisker([10.0, 0.5], [10.0, 1.5]), &x, &y);
    close(
        &found,
        &[
            left + wide / 2.0,
            bottom - high / 4.0,
            left + wide / 2.0,
            bottom - high * 0.75,
        ],
    );
    let bar = Shape::HorizontalBar {
        y: 1.0,
        base: 0.5,
        to: 1.5,
    };
    let ([left, top, right, bottom], found) = first_path(bar, &y, &steps);
    let (wide, step) = (right - left, (bottom - top) / 5.0);
    close(
        &[found[0], found[1] + found[3] / 2.0, found[2]],
        &[left + wide / 4.0, top + 1.5 * step, wide / 2.0],
    );
    // A bar fills about two thirds of its row.
    let filled = found[3] / step;
    assert!((0.6..0.75).contains(&filled), "{filled} of a row");
}

/// Two lines that cross: at their starts the names would be in the other order.
#[test]
fn a_series_is_named_at_the_end_of_its_line() {
    let linear = ScaleKind::Linear { lo: 0.0, hi: 1.0 };
    let mut figure = dots([linear.clone(), linear], &[]);
    figure.series.truncate(2);
    let line = |series: usize, [start, end]: [f64; 2]| {
        Mark::new(Shape::Line(vec![[0.0, start], [1.0, end]]), series)
    };
    figure.panels[0].marks = vec![line(0, [0.1, 0.9]), line(1, [0.8, 0.3])];
    let drawn = Drawn::new(&svg(&figure, WIDTHS[0]));
    let [_, top, right, bottom] = drawn.panels()[0];
    for (name, end) in [("a", 0.9), ("b", 0.3)] {
        let [x, y] = drawn.text_position(name);
        assert!(x > right && x < right + 20.0, "{name} at {x}");
        // The baseline is a little below the middle of the letters.
        let below = y - (bottom - end * (bottom - top));
        assert!((0.0..8.0).contains(&below), "{name} is {below} px below");
    }
}

#[test]
fn a_legend_has_the_series_in_order_each_after_its_sample() {
    let linear = ScaleKind::Linear { lo: 0.0, hi: 1.0 };
    let figure = dots([linear.clone(), linear], &[[0.5, 0.5]]);
    for width in WIDTHS {
        let drawn = Drawn::new(&svg(&figure, width));
        let mut before = 0.0;
        for (index, series) in figure.series.iter().enumerate() {
            let [sample_x, sample_y] = drawn.legend_sample(index);
            let [x, y] = drawn.text_position(&series.name);
            let name = &series.name;
            assert!(sample_x > before, "{name}: its sample is left of another");
            assert!((x - sample_x) > 0.0 && (x - sample_x) < 30.0, "{name}");
            assert!((y - sample_y).abs() < 8.0, "{name}");
            before = x;
        }
    }
}

#[test]
fn values_outside_of_the_domain_are_arrows_at_its_border() {
    let [x, y] = [
        ScaleKind::Log { lo: 1.0, hi: 100.0 },
        ScaleKind::Log { lo: 0.1, hi: 10.0 },
    ];
    let outside = [
        [0.0, 1.0],
        [-3.0, 1.0],
        [f64::INFINITY, 1.0],
        [1e9, 1.0],
        [10.0, 0.0],
        [10.0, f64::INFINITY],
    ];
    let figure = dots([x, y], &outside);
    let drawn = Drawn::new(&svg(&figure, WIDTHS[0]));
    let [left, top, right, bottom] = drawn.panels()[0];
    let arrows: Vec<[f64; 2]> = drawn.starts("fig-b");
    let expected = [Some(left), Some(left), Some(right), Some(right), None, None];
    assert_eq!(arrows.len(), outside.len());
    for (i, ([px, py], x)) in arrows.into_iter().zip(expected).enumerate() {
        let place = [
            x.unwrap_or((left + right) / 2.0),
            [(top + bottom) / 2.0, bottom, top][i.saturating_sub(3).min(2)],
        ];
        assert!(
            (px - place[0]).abs() < 0.02 && (py - place[1]).abs() < 0.02,
            "{:?} at {px}, {py}",
            outside[i]
        );
    }
    let mut nothing = figure.clone();
    nothing.panels[0].marks = vec![Mark::new(Shape::Dot([f64::NAN, 1.0]), 0).tip("NaN")];
    assert_eq!(
        Drawn::new(&svg(&nothing, WIDTHS[0])).marks().len(),
        0,
        "NaN has no place"
    );
    let mut line = figure;
    line.panels[0].marks = vec![Mark::new(
        Shape::Line(vec![
            [1.0, 1.0],
            [10.0, 1e-9],
            [1e7, 5.0],
            [f64::NAN, 1.0],
            [2.0, 1e30],
        ]),
        0,
    )];
    let drawn = Drawn::new(&svg(&line, WIDTHS[0]));
    for [x, y] in drawn.vertices("fig-l") {
        assert!(
            x >= left - 0.01 && x <= right + 0.01 && y >= top - 0.01 && y <= bottom + 0.01,
            "{x}, {y}"
        );
    }
}

#[test]
fn marks_that_coincide_on_a_step_are_drawn_side_by_side() {
    let names = ScaleKind::Steps(vec!["one".to_owned(), "other".to_owned()]);
    let log = ScaleKind::Log { lo: 1.0, hi: 100.0 };
    for is_y in [true, false] {
        let kinds = if is_y {
            [log.clone(), names.clone()]
        } else {
            [names.clone(), log.clone()]
        };
        let at = |value: f64| if is_y { [value, 1.0] } else { [1.0, value] };
        let mut figure = dots(kinds, &[]);
        // Three series, and one of them three times; an interval goes with its dot.
        let dot = |series: usize| Mark::new(Shape::Dot(at(10.0)), series).tip("dot");
        let whisker = Mark::new(Shape::Whisker(at(5.0), at(20.0)), 2).tip("interval");
        figure.panels[0].marks = vec![dot(0), dot(1), dot(1), dot(1), dot(2), whisker];
        let drawn = Drawn::new(&svg(&figure, WIDTHS[0]));
        let places = drawn.dots();
        for (i, a) in places.iter().enumerate() {
            for b in &places[..i] {
                assert!((a[0] - b[0]).hypot(a[1] - b[1]) >= 6.0, "{places:?}");
            }
        }
        let across = usize::from(is_y);
        let interval = drawn.vertices("fig-l")[0];
        assert!(
            (interval[across] - places[4][across]).abs() < 0.02,
            "an interval leaves its dot"
        );
    }
}

#[test]
fn labels_of_ticks_are_round_and_at_their_values() {
    let domains = [
        (0.9, 1.3),
        (0.5, 2.0),
        (0.2, 5.5),
        (1e-3, 0.4),
        (1e-4, 30.0),
        (1e-9, 1e12),
        (3.0, 7.0),
        (0.011, 0.019),
    ];
    for (lo, hi) in domains {
        for width in WIDTHS {
            let kind = ScaleKind::Log { lo, hi };
            let figure = dots(
                [kind.clone(), ScaleKind::Linear { lo: 0.0, hi: 1.0 }],
                &[[lo * 1.01, 0.5]],
            );
            let drawn = Drawn::new(&svg(&figure, width));
            let [left, _, right, bottom] = drawn.panels()[0];
            let labels = drawn.labels_below(bottom);
            assert!(labels.len() >= 2, "{lo} to {hi}: {labels:?}");
            // One digit each, or as far apart as one digit allows.
            let values: Vec<f64> = labels
                .iter()
                .map(|(text, _)| figures::parse_label(text))
                .collect();
            let is_round = |value: f64| {
                format!("{value:.6e}")
                    .trim_start_matches(|c: char| c.is_ascii_digit())
                    .starts_with(".000000")
            };
            let steps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let is_even = steps
                .iter()
                .all(|step| is_round(*step) && (step / steps[0] - 1.0).abs() < 1e-9);
            assert!(
                is_even || values.iter().all(|value| is_round(*value)),
                "{lo} to {hi}: {values:?}"
            );
            for (value, (text, x)) in values.into_iter().zip(labels) {
                let off = (x - left - share(&kind, value) * (right - left)).abs();
                assert!(off < 25.0, "{lo} to {hi}: {text} is {off} px off");
            }
        }
    }
    // Tried sample counts have labels, and there are no ticks in between.
    for counts in [
        &[1.0, 4.0, 16.0, 64.0, 256.0, 1024.0][..],
        &[1.0, 2.0],
        &[2.0, 3.0],
    ] {
        let x = Scale::log("", counts.iter().copied()).unwrap();
        let points: Vec<[f64; 2]> = counts.iter().map(|x| [*x, 0.5]).collect();
        let drawn = Drawn::new(&svg(
            &dots([x.kind, ScaleKind::Linear { lo: 0.0, hi: 1.0 }], &points),
            WIDTHS[0],
        ));
        let labels = drawn.labels_below(drawn.panels()[0][3]);
        let found: Vec<f64> = labels
            .iter()
            .map(|(text, _)| figures::parse_label(text))
            .collect();
        assert_eq!(found, counts);
    }
}

#[test]
fn user_text_in_a_figure_stays_text() {
    let figure = hostile();
    for width in WIDTHS {
        let text = svg(&figure, width);
        let drawn = Drawn::new(&text);
        let document = drawn.document();
        let names: BTreeSet<&str> = document
            .descendants()
            .filter(|n| n.is_element())
            .map(|n| n.tag_name().name())
            .collect();
        let known = ["svg", "title", "desc", "style", "rect", "g", "path", "text"];
        assert!(names.iter().all(|name| known.contains(name)), "{names:?}");
        assert!(
            !document.descendants().any(|node| node.has_attribute("id")),
            "ids of two figures would collide"
        );
        let marks = drawn.marks();
        let tips: Vec<&Mark> = figure
            .panels
            .iter()
            .flat_map(|panel| &panel.marks)
            .filter(|mark| !mark.tip.is_empty())
            .collect();
        assert_eq!(marks.len(), tips.len());
        for (index, panel) in figure.panels.iter().enumerate() {
            for mark in &panel.marks {
                let has = |key: &str, value: &str| {
                    let found = marks.iter().filter(|id| {
                        drawn.attribute(**id, "data-panel") == Some(index.to_string())
                    });
                    found
                        .into_iter()
                        .any(|id| drawn.attribute(*id, key).as_deref() == Some(value))
                };
                for key in ["data-tip", "aria-label"] {
                    assert!(has(key, &mark.tip), "{key} lacks {:?}", mark.tip);
                }
                assert!(mark.cell.as_ref().is_none_or(|cell| has("data-cell", cell)));
                assert!(
                    mark.series
                        .is_none_or(|series| has("data-series", &series.to_string()))
                );
            }
        }
        for id in marks {
            let node = document.get_node(id).unwrap();
            assert_eq!(
                node.first_element_child().and_then(|title| title.text()),
                node.attribute("data-tip")
            );
        }
    }
}

#[test]
fn empty_and_degenerate_figures_are_drawn() {
    let empty = Figure {
        title: String::new(),
        note: String::new(),
        panels: Vec::new(),
        series: Vec::new(),
    };
    let odd = [
        ScaleKind::Log { lo: 0.0, hi: 1.0 },
        ScaleKind::Log { lo: 1.0, hi: 1.0 },
        ScaleKind::Log {
            lo: f64::NAN,
            hi: f64::INFINITY,
        },
        ScaleKind::Linear { lo: 2.0, hi: 2.0 },
        ScaleKind::Linear {
            lo: f64::NEG_INFINITY,
            hi: 1.0,
        },
        ScaleKind::Linear {
            lo: 1e300,
            hi: 1.5e308,
        },
        ScaleKind::Log {
            lo: 1e-320,
            hi: 1e308,
        },
        ScaleKind::Steps(Vec::new()),
    ];
    let mut all = vec![empty];
    for kind in &odd {
        all.push(dots(
            [kind.clone(), ScaleKind::Steps(Vec::new())],
            &[[1.0, 0.0]],
        ));
        all.push(dots(
            [ScaleKind::Linear { lo: 0.0, hi: 1.0 }, kind.clone()],
            &[[0.5, 1.0]],
        ));
    }
    let mut unknown = dots([odd[3].clone(), odd[3].clone()], &[[2.0, 2.0]]);
    unknown.series.clear();
    all.push(unknown);
    for figure in all {
        let text = svg(&figure, 1);
        assert!(!text.contains("NaN") && !text.contains("inf"), "{figure:?}");
        Drawn::new(&text);
    }
}

#[test]
fn an_svg_is_the_same_each_time_and_of_few_digits() {
    for (figure, width) in hard()
        .iter()
        .flat_map(|figure| WIDTHS.map(|width| (figure, width)))
    {
        let text = svg(figure, width);
        assert!(
            text == svg(figure, width) && !text.contains("NaN") && !text.contains("inf"),
            "{}",
            figure.title
        );
        for path in Drawn::new(&text)
            .document()
            .descendants()
            .filter_map(|node| node.attribute("d"))
        {
            let mut numbers = path.split(|c: char| !c.is_ascii_digit() && c != '.');
            assert!(
                numbers.all(|number| number
                    .split_once('.')
                    .is_none_or(|(_, digits)| digits.len() <= 2)),
                "{path}"
            );
        }
    }
}
