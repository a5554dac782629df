//! Names of series at the ends of their lines, in place of a legend.

use super::frame::{Frame, HEIGHT_MIN};
use super::ink::class;
use super::labels::OFF;
use super::text::{Anchor, MIDDLE, NAME, Words};
use super::{Figure, Mark, Panel, Shape};

/// Largest share of the width that names at the ends of lines take.
const ENDS_SHARE: f64 = 0.27;

/// The room for names at the ends of lines, pixels; `None` if some panel has no line of some
/// series, or the names are too many or too long.
pub fn ends_room(figure: &Figure, width: f64) -> Option<f64> {
    let has_end = |panel: &Panel, series: usize| {
        panel
            .marks
            .iter()
            .any(|mark| mark.series == Some(series) && end(mark).is_some())
    };
    let series_count = figure.series.len();
    let has_all_ends = |panel: &Panel| (0..series_count).all(|series| has_end(panel, series));
    let room = OFF + NAME.widest(figure.series.iter().map(|series| &series.name));
    let has_room = room < ENDS_SHARE * width && series_count as f64 * NAME.line() <= HEIGHT_MIN;
    (series_count > 0 && has_room && figure.panels.iter().all(has_all_ends)).then_some(room)
}

/// The last point of a line, or the y of a rule.
fn end(mark: &Mark) -> Option<[f64; 2]> {
    match &mark.shape {
        Shape::Line(points) => points.last().copied(),
        Shape::HorizontalRule(y) => Some([f64::NAN, *y]),
        _ => None,
    }
}

/// The names of the series at the ends of their lines, apart from each other.
pub fn end_names(figure: &Figure, panel: &Panel, frame: &Frame) -> Vec<Words> {
    let mut ends: Vec<LineEnd> = (0..figure.series.len())
        .filter(|series| !figure.series[*series].name.is_empty())
        .filter_map(|series| LineEnd::find(panel, frame, series))
        .collect();
    ends.sort_by(|a, b| a.y.total_cmp(&b.y));
    // Each name leaves room for the names below it.
    let mut lowest = frame.bottom - ends.len() as f64 * NAME.line();
    let mut highest = frame.top;
    let mut names = Vec::new();
    for LineEnd { series, y } in ends {
        let y = y.min(lowest + NAME.line()).max(highest);
        lowest += NAME.line();
        highest = y + NAME.line();
        names.push(Words {
            text: figure.series[series].name.clone(),
            full: None,
            position: [frame.right + OFF, y + NAME.size * MIDDLE],
            anchor: Anchor::Start,
            is_upright: false,
            class: format!("fig-n {}", class(figure.ink(Some(series)))).into(),
        });
    }
    names
}

/// The end of the last line or rule of a series.
struct LineEnd {
    series: usize,
    y: f64,
}

impl LineEnd {
    fn find(panel: &Panel, frame: &Frame, series: usize) -> Option<Self> {
        let point = panel
            .marks
            .iter()
            .filter(|mark| mark.series == Some(series))
            .filter_map(end)
            .next_back()?;
        let y = frame.y.pixel(point[1]) + frame.dodge.shift(Some(series), point);
        Some(Self { series, y })
    }
}
