//! At which exposure and contrast does the difference show?
//!
//! The measure is FLIP [Andersson20], the difference that a viewer notices when two images are flipped in place, from 0 to 1: its mean over
//! the image, after the tone curve. From [`VISIBLE_FROM`] on a difference is called visible. Of each method and tone curve: the median
//! over everything else that is swept, its extremes, and how many images show the difference.

use super::words::{count, label, listed, number};
use super::{Finding, Question};
use crate::runner::tables::DISPLAY_HEADLINE;
use crate::runner::value::Value;
use crate::study::figure::{Figure, Mark, Panel, Ramp, Scale, Shape as Form};
use crate::study::frame::estimate::median;
use crate::study::frame::{Frame, Row, Shape, VISIBLE_FROM, ascending, axis, distinct_in_order, size_of};
use crate::study::table::{Column, Table};
use crate::table::csv::Cell;

pub const QUESTION: Question = Question {
    name: "visibility",
    asks: "At which exposure and contrast does the difference show?",
    columns: &[
        Column { name: "n", about: "Images of the method at this tone curve." },
        Column { name: "flip", about: "Mean FLIP of an image, the median over these images; from 0 (none) to 1." },
        Column { name: "flip_least", about: "Mean FLIP of the image with the least." },
        Column { name: "flip_most", about: "Mean FLIP of the image with the most." },
        Column {
            name: "visible_from",
            about: "Mean FLIP from which a difference is called visible, a convention of this project.",
        },
        Column { name: "visible", about: "How many of the images have at least that." },
    ],
    uses_times: false,
    lacks,
    answer,
};

fn lacks(shape: &Shape) -> Option<&'static str> {
    let is_swept = display_axes().iter().any(|axis| shape.is_swept(*axis));
    (!is_swept).then_some("axes has neither two exposures nor two contrasts")
}

/// Exposure and contrast.
fn display_axes() -> [usize; 2] {
    ["exposure", "contrast"].map(axis)
}

/// A method at one tone curve.
struct Curve<'r, 'f> {
    method: String,
    /// Exposure and contrast.
    values: [Value; 2],
    /// Mean FLIP of each image.
    flips: Vec<f64>,
    rows: Vec<&'r Row<'f>>,
}

impl Curve<'_, '_> {
    fn middle(&self) -> f64 {
        median(&self.flips)
    }

    fn is_visible(&self) -> bool {
        self.middle() >= VISIBLE_FROM
    }

    fn visible_count(&self) -> usize {
        self.flips.iter().filter(|flip| **flip >= VISIBLE_FROM).count()
    }
}

/// By method, contrast and exposure, the latter two ascending; methods without samples first.
fn curves<'r, 'f>(frame: &'r Frame<'f>) -> Vec<Curve<'r, 'f>> {
    let mut found: Vec<Curve> = Vec::new();
    // The image without a specular term is there for scale, unless it is the diffuse term that is asked about.
    for row in frame.rows.iter().filter(|row| frame.way(row) != "none") {
        let Some(flip) = frame.score_in(row, DISPLAY_HEADLINE).filter(|flip| flip.is_finite()) else { continue };
        let (method, values) = (frame.way(row), display_axes().map(|axis| row.point.0[axis].clone()));
        match found.iter_mut().find(|known| known.method == method && known.values == values) {
            Some(known) => {
                known.flips.push(flip);
                known.rows.push(row);
            }
            None => found.push(Curve { method, values, flips: vec![flip], rows: vec![row] }),
        }
    }
    let methods = distinct_in_order(found.iter().map(|one| (one.rows[0].samples().is_some(), one.method.clone())));
    let order = |one: &Curve| {
        let place = methods.iter().position(|(_, name)| *name == one.method);
        (one.rows[0].samples().is_some(), place)
    };
    let size = |value: &Value| size_of(value).unwrap_or(f64::NAN);
    found.sort_by(|a, b| {
        let by_value = |axis: usize| size(&a.values[axis]).total_cmp(&size(&b.values[axis]));
        order(a).cmp(&order(b)).then(by_value(1)).then(by_value(0))
    });
    found
}

fn answer(frame: &Frame) -> Option<Finding> {
    let curves = curves(frame);
    let methods = distinct_in_order(curves.iter().map(|one| one.method.clone()));
    let of = |method: &String| -> Vec<&Curve> { curves.iter().filter(|one| one.method == *method).collect() };
    let axes = [frame.way_axes(), display_axes().to_vec()].concat();
    let mut table = Table::new(&axes, QUESTION.columns);
    for one in &curves {
        let least = one.flips.iter().copied().fold(f64::INFINITY, f64::min);
        let most = one.flips.iter().copied().fold(0.0, f64::max);
        let mut row = one.rows[0].cells(&axes);
        row.push(Cell::Integer(one.flips.len() as u64));
        row.extend([one.middle(), least, most, VISIBLE_FROM].map(Cell::Number));
        row.push(Cell::Integer(one.visible_count() as u64));
        table.row(row);
    }
    Some(Finding {
        sentence: sentence(&of(methods.first()?))?,
        table,
        digest: Some(digest(&methods, &of)),
        figure: figure(&methods, &of),
    })
}

/// Ascending values with runs of tried neighbours drawn together: "0.1 to 5", "0.1 and 500".
fn runs(tried: &[&Value], wanted: &[&Value]) -> String {
    let mut parts: Vec<[&Value; 2]> = Vec::new();
    let mut is_open = false;
    for value in tried {
        let is_wanted = wanted.contains(value);
        match parts.last_mut().filter(|_| is_open && is_wanted) {
            Some(part) => part[1] = value,
            None if is_wanted => parts.push([value, value]),
            None => {}
        }
        is_open = is_wanted;
    }
    let words = parts.iter().map(|[lo, hi]| if lo == hi { lo.to_string() } else { format!("{lo} to {hi}") });
    listed(&words.collect::<Vec<_>>())
}

/// "exposure 0.5 to 50" or "every exposure": where the difference shows at one contrast.
fn shown(own: &[&&Curve]) -> String {
    let tried: Vec<&Value> = own.iter().map(|one| &one.values[0]).collect();
    let wanted: Vec<&Value> = own.iter().filter(|one| one.is_visible()).map(|one| &one.values[0]).collect();
    match wanted.len() {
        0 => "no tried exposure".to_owned(),
        n if n == tried.len() && n > 1 => "every tried exposure".to_owned(),
        _ => format!("exposure {}", runs(&tried, &wanted)),
    }
}

fn contrasts(own: &[&Curve]) -> Vec<Value> {
    ascending(distinct_in_order(own.iter().map(|one| one.values[1].clone())))
}

fn sentence(own: &[&Curve]) -> Option<String> {
    let peak = own.iter().max_by(|a, b| a.middle().total_cmp(&b.middle()))?;
    let over = match peak.flips.len() {
        1 => String::new(),
        n => format!(", the median of {}", count(n, "image", "images")),
    };
    let first = format!(
        "The error of `{}` shows most at {}: mean FLIP {}{over}.",
        peak.method,
        label(&display_axes(), &peak.values).replace(" · ", ", "),
        number(peak.middle())
    );
    // Contrasts that show alike are said together.
    let mut groups: Vec<(String, Vec<String>)> = Vec::new();
    for contrast in contrasts(own) {
        let at: Vec<&&Curve> = own.iter().filter(|one| one.values[1] == contrast).collect();
        let words = shown(&at);
        match groups.iter_mut().find(|(known, _)| *known == words) {
            Some((_, contrasts)) => contrasts.push(contrast.to_string()),
            None => groups.push((words, vec![contrast.to_string()])),
        }
    }
    let parts: Vec<String> = match groups.as_slice() {
        [(words, _)] => vec![format!("at {words}")],
        several => several.iter().map(|(words, at)| format!("at {words} (contrast {})", listed(at))).collect(),
    };
    Some(format!("{first} It is visible {}.", parts.join(", ")))
}

/// One row a method, one column a contrast.
fn digest<'r, 'f: 'r>(methods: &[String], of: &dyn Fn(&String) -> Vec<&'r Curve<'r, 'f>>) -> Table {
    let all: Vec<&Curve> = methods.iter().flat_map(of).collect();
    let contrasts = contrasts(&all);
    let heads = contrasts.iter().map(|contrast| format!("visible at contrast {contrast}"));
    let names = ["method", "most at exposure", "contrast", "mean FLIP there", "visible from"].map(str::to_owned);
    let mut table = Table::with_names(names.into_iter().chain(heads).collect());
    for method in methods {
        let own = of(method);
        let Some(peak) = own.iter().max_by(|a, b| a.middle().total_cmp(&b.middle())) else { continue };
        let mut row = vec![Cell::Text(method.clone())];
        row.extend(peak.values.iter().map(|value| Cell::Text(value.to_string())));
        row.extend([peak.middle(), VISIBLE_FROM].map(Cell::Number));
        row.extend(contrasts.iter().map(|contrast| {
            let at: Vec<&&Curve> = own.iter().filter(|one| one.values[1] == *contrast).collect();
            if at.is_empty() { Cell::Missing } else { Cell::Text(shown(&at)) }
        }));
        table.row(row);
    }
    table
}

/// One panel a method: exposure over contrast.
fn figure<'r, 'f: 'r>(methods: &[String], of: &dyn Fn(&String) -> Vec<&'r Curve<'r, 'f>>) -> Option<Figure> {
    let all: Vec<&Curve> = methods.iter().flat_map(of).collect();
    let values = |i: usize| ascending(distinct_in_order(all.iter().map(|one| one.values[i].clone())));
    let [exposures, contrasts] = [0, 1].map(values);
    let names = |values: &[Value]| values.iter().map(Value::to_string).collect::<Vec<_>>();
    let panel = |method: &String| {
        let marks = of(method).into_iter().filter_map(|one| {
            let x = exposures.iter().position(|value| *value == one.values[0])?;
            let y = contrasts.iter().position(|value| *value == one.values[1])?;
            let middle = one.middle();
            let tip = format!(
                "{method} · {}: mean FLIP {}, visible in {} of {}",
                label(&display_axes(), &one.values),
                number(middle),
                one.visible_count(),
                one.flips.len()
            );
            let mark = Mark::neutral(Form::Tile { x, y, value: Some(middle), text: number(middle) }).tip(tip);
            Some(if one.rows.len() == 1 { mark.cell(&one.rows[0].cell.id) } else { mark })
        });
        Panel {
            title: method.clone(),
            x: Scale::steps("exposure", names(&exposures)),
            y: Scale::steps("contrast", names(&contrasts)),
            marks: marks.collect(),
        }
    };
    let flips: Vec<f64> = all.iter().map(|one| one.middle()).filter(|flip| *flip > 0.0).collect();
    let lo = flips.iter().copied().fold(VISIBLE_FROM, f64::min);
    let hi = flips.iter().copied().fold(VISIBLE_FROM, f64::max);
    (lo < hi).then(|| Figure {
        title: "The difference after the tone curve".to_owned(),
        note: format!(
            "mean FLIP, median over the rest; from {VISIBLE_FROM} on a difference is called visible (a convention)"
        ),
        panels: methods.iter().map(panel).collect(),
        series: Vec::new(),
        ramp: Some(Ramp { label: "mean FLIP".to_owned(), lo, hi, is_log: true, middle: Some(VISIBLE_FROM) }),
    })
}
