//! Panels of thousands of dots: drawn dots do not hide each other, and stand for all others.

use super::figures::{Drawn, dots};
use splitsum::draw::figure::svg::{WIDTHS, svg};
use splitsum::draw::figure::{Figure, Mark, ScaleKind, Shape};

/// Dots of a series keep this distance along one axis, pixels.
const NEAR: f64 = 8.0;
const ROUNDING: f64 = 0.02;

fn unit() -> ScaleKind {
    ScaleKind::Linear { lo: 0.0, hi: 1.0 }
}

/// A wave of `count` dots, each with an interval.
fn wave(count: usize) -> Figure {
    let mut figure = dots([unit(), unit()], &[]);
    let marks = &mut figure.panels[0].marks;
    for k in 0..count {
        let x = (k as f64 + 0.5) / count as f64;
        let y = 0.5 + 0.3 * (40.0 * x).sin();
        marks.push(Mark::new(Shape::Dot([x, y]), 0).tip("dot"));
        marks.push(Mark::new(Shape::Whisker([x, y - 0.1], [x, y + 0.1]), 0));
    }
    figure
}

fn is_near(a: [f64; 2], b: [f64; 2], distance: f64) -> bool {
    (0..2).all(|i| (a[i] - b[i]).abs() < distance)
}

#[test]
fn dots_of_a_crowded_panel_stand_for_those_that_they_would_hide() {
    let figure = wave(4000);
    for width in WIDTHS {
        let text = svg(&figure, width);
        assert!(text.contains("where dots of a series touch, one is drawn"));
        let drawn = Drawn::new(&text);
        let [left, top, right, bottom] = drawn.panels()[0];
        let found = drawn.dots();
        assert!(found.len() > 50, "{} dots", found.len());
        for (i, a) in found.iter().enumerate() {
            for b in &found[..i] {
                assert!(!is_near(*a, *b, NEAR - ROUNDING), "{a:?} and {b:?} touch");
            }
        }
        for mark in &figure.panels[0].marks {
            if let Shape::Dot([x, y]) = mark.shape {
                let at = [left + x * (right - left), bottom - y * (bottom - top)];
                let has_stand_in = found.iter().any(|dot| is_near(*dot, at, NEAR + ROUNDING));
                assert!(has_stand_in, "nothing is drawn near {at:?}");
            }
        }
        // An interval goes with its dot.
        assert_eq!(text.matches("fig-thin\"").count(), found.len());
    }
}

#[test]
fn series_do_not_crowd_each_other_out() {
    let mut figure = wave(1200);
    let second: Vec<Mark> = figure.panels[0]
        .marks
        .iter()
        .map(|mark| Mark {
            series: Some(1),
            ..mark.clone()
        })
        .collect();
    let alone = Drawn::new(&svg(&figure, WIDTHS[0])).dots().len();
    figure.panels[0].marks.extend(second);
    assert_eq!(Drawn::new(&svg(&figure, WIDTHS[0])).dots().len(), 2 * alone);
}

#[test]
fn a_panel_with_room_draws_every_dot() {
    let figure = wave(250);
    let text = svg(&figure, WIDTHS[0]);
    assert_eq!(Drawn::new(&text).dots().len(), 250);
    assert!(!text.contains("one is drawn"));
}
