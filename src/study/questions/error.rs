//! How wrong is each method?
//!
//! The error of each method and sample count in each case: geometric mean over point sets, and over
//! environments if these are averaged. For a mean square error such as relmse, 100 sqrt(error) is
//! the root mean square error in percent of the reference ("rms"): 0.01 is 10 % rms.
//!
//! The *leading* method is the first without samples, as renderers ship it, else the first that
//! samples, at its largest count.

use super::prelude::*;
use super::{ERROR, IS_RESOLVED, NOISE_FLOOR};

pub const QUESTION: Question = Question {
    name: "error",
    asks: "How wrong is each method?",
    columns: &[
        ERROR,
        NOISE_FLOOR,
        IS_RESOLVED,
        column(
            "rms_percent",
            "Root mean square error in % of the reference; only of metrics that are mean squares.",
        ),
    ],
    lacks,
    answer,
    ..Question::PLAIN
};

fn lacks(shape: &Shape) -> Option<&'static str> {
    // A white furnace has a reference without specular term.
    (shape.reference_method == NONE)
        .then_some("reference.method is none: the difference is the missing term")
}

/// One way in one case, over all point sets.
struct Case<'r, 'f> {
    row: &'r Row<'f>,
    way: String,
    error: f64,
    is_resolved: bool,
}

fn cases<'r, 'f>(frame: &Frame, images: &[&'r Row<'f>]) -> Vec<Case<'r, 'f>> {
    let luck = frame.swept(&[Part::Luck, Part::Display]);
    let axes: Vec<AxisId> = AXES.ids().filter(|of| !luck.contains(of)).collect();
    let rows: Vec<&'r Row<'f>> = images
        .iter()
        .copied()
        .filter(|row| frame.error(row).is_some())
        .collect();
    let case = |(_, rows): (_, Vec<&'r Row<'f>>)| Case {
        row: rows[0],
        way: frame.way(rows[0]),
        error: geometric_mean(
            &rows
                .iter()
                .filter_map(|row| frame.error(row))
                .collect::<Vec<_>>(),
        ),
        is_resolved: rows.iter().all(|row| frame.is_resolved(row)),
    };
    by(&rows, &axes).into_iter().map(case).collect()
}

fn answer(frame: &Frame) -> Option<Finding> {
    let images = frame.images();
    let all = cases(frame, &images);
    let has_methods = images.iter().any(|row| !row.has_no_method());
    let is_fixed =
        |case: &&Case| case.row.samples().is_none() && !(has_methods && case.row.has_no_method());
    let largest = || {
        all.iter().reduce(|a, b| {
            if b.row.samples() > a.row.samples() {
                b
            } else {
                a
            }
        })
    };
    let lead = &all.iter().find(is_fixed).or_else(largest)?.way;
    let columns = [&frame.table_axes()[..], &[METHOD, SAMPLES]].concat();
    let mut table = Table::new(&columns, QUESTION.columns);
    for case in &all {
        let floor = frame.noise_floor(case.row);
        let own = cells![
            case.error,
            floor,
            case.is_resolved,
            rms_percent(frame, case.error)
        ];
        table.row([case.row.cells(&columns), own].concat());
    }
    Some(Finding {
        sentence: sentence(frame, lead, &all)?,
        digest: Some(digest(frame, lead, &all)),
        table,
        figure: figure(frame, &all),
    })
}

fn numbers<'r, 'f>(cases: &[Case<'r, 'f>], way: &str) -> Numbers<'r, 'f> {
    Numbers::new(
        cases
            .iter()
            .filter(|case| case.way == way)
            .map(|case| (case.row, case.error)),
        Middle::GeometricMean,
    )
}

/// The leading method by [`Frame::row_axis`] and environment; if the axis has one value, every
/// method by environment.
fn digest(frame: &Frame, lead: &str, all: &[Case]) -> Table {
    let words = |mean: &Estimate| with_rms(frame, mean.value) + &interval_words(mean, number);
    if frame.shape.is_swept(frame.row_axis()) {
        return numbers(all, lead).digest(frame, &words);
    }
    let ways = distinct_in_order(all.iter().map(|case| case.way.clone()));
    let rows: Vec<_> = ways
        .iter()
        .map(|way| (cells![way.as_str()], numbers(all, way)))
        .collect();
    by_light(frame, &[AXES[METHOD].name], &rows, &words)
}

/// Smaller ratios of errors are not mentioned.
const CHANGE_MIN: f64 = 2.0;

fn sentence(frame: &Frame, lead: &str, all: &[Case]) -> Option<String> {
    let errors = numbers(all, lead);
    let (mean, first) = (
        errors.estimate()?,
        all.iter().find(|case| case.way == lead)?.row,
    );
    let scope = match mean.n {
        1 => {
            let [scene, light] =
                [SCENE, ENVIRONMENT].map(|of| frame.names.short(of, &first.point[of]));
            format!(" on {scene} under {light}")
        }
        n => format!(" (geometric mean of {n} {})", AXES[ENVIRONMENT].plural),
    };
    let (value, percent) = (number(mean.value), rms_percent(frame, mean.value));
    let rms = percent.map_or_else(String::new, |percent| {
        format!(", about **{} % rms**", number(percent))
    });
    let value = if percent.is_some() {
        value
    } else {
        format!("**{value}**")
    };
    let interval = interval_words(&mean, number);
    let text = format!(
        "The `{}` of `{lead}` is {value}{interval}{rms}{scope}.",
        frame.metric_name()
    );
    let extremes = errors.extremes(frame, "it", CHANGE_MIN, |error| with_rms(frame, error));
    let end = match all.iter().any(|case| case.way == lead && case.is_resolved) {
        false => " This is within the reference's noise: the true error may be smaller.".to_owned(),
        true => errors.scope(frame),
    };
    Some(text + &extremes + &end)
}

/// Most sample counts of a method in the figure: the fewest, the middle one and the most.
const COUNTS_SHOWN: usize = 3;

/// Dots by [`Frame::row_axis`] if its values are numbers, else by way; one panel per environment,
/// after their mean.
fn figure(frame: &Frame, all: &[Case]) -> Option<Figure> {
    let ways = shown_ways(all);
    let shown = all.iter().filter(|case| ways.contains(&case.way));
    let (of, axes) = (frame.row_axis(), frame.case_axes());
    let size = |value: &Value| {
        frame
            .names
            .shown(of, value)
            .size()
            .filter(|size| *size > 0.0)
    };
    let is_by_size = frame.shape.is_swept(of)
        && frame.shape.values[of]
            .iter()
            .all(|value| size(value).is_some());
    let mark = |case: &Case| {
        let series = ways.iter().position(|way| *way == case.way)?;
        let x = size(&case.row.point[of])
            .filter(|_| is_by_size)
            .unwrap_or(step(&ways, &case.way));
        let label = frame.names.label(&axes, &case.row.key(&axes));
        let tip = format!("{}: {} · {label}", case.way, with_rms(frame, case.error));
        Some(dot([x, case.error], series, tip, case.row))
    };
    let panel = |(light, own): (Value, Vec<&Case>)| {
        let light = if frame.shape.is_swept(ENVIRONMENT) {
            light
        } else {
            Value::Unset
        };
        (light, own.into_iter().filter_map(mark).collect())
    };
    let words = |mean: &Estimate| with_rms(frame, mean.value) + &interval_words(mean, number);
    let summed = || {
        let of_way = |(series, way): (usize, &String)| {
            let own = numbers(all, way);
            if !is_by_size {
                return own.marks(series, |error| [series as f64, error], (way, &words));
            }
            let marks = own.values(of).into_iter().flat_map(|value| {
                let (x, name) = (
                    size(&value).unwrap_or(f64::NAN),
                    format!("{way}, {}", frame.names.one(of, &value)),
                );
                own.at(of, &value)
                    .marks(series, |error| [x, error], (&name, &words))
            });
            joined(marks.collect())
        };
        ways.iter().enumerate().flat_map(of_way).collect()
    };
    let is_shown = |case: &Case| ways.contains(&case.way);
    let left_out = if all.iter().all(is_shown) {
        ""
    } else {
        "; smallest, middle and largest sample count"
    };
    let lead = numbers(all, &ways[0]);
    let lights = grouped(shown, |case| case.row.point[ENVIRONMENT].clone())
        .into_iter()
        .map(panel)
        .collect();
    Chart {
        title: "How wrong each method is",
        note: match lead.is_summed() {
            true => {
                format!(
                    "{}; first the geometric mean{INTERVAL}; other dots are images{left_out}",
                    frame.metric_name()
                )
            }
            false => format!("{}; each dot is an image{left_out}", frame.metric_name()),
        },
        x: if is_by_size {
            Along::Log(frame.names.name(of))
        } else {
            Along::Steps("", ways.clone())
        },
        y: Along::Log(frame.metric_name()),
        panels: light_panels(frame, &lead, summed, lights),
        series: ways.clone(),
    }
    .figure()
}

/// Methods without samples, and a few counts of each other method.
fn shown_ways(all: &[Case]) -> Vec<String> {
    let of_method = |(_, own): (Value, Vec<&Case>)| {
        let mut counts = distinct_in_order(own.iter().filter_map(|case| case.row.samples()));
        counts.sort_unstable();
        let last = counts.len().saturating_sub(1);
        if counts.len() > COUNTS_SHOWN {
            counts = [0, last / 2, last].map(|place| counts[place]).to_vec();
        }
        let is_kept = |case: &&Case| case.row.samples().is_none_or(|n| counts.contains(&n));
        distinct_in_order(own.into_iter().filter(is_kept).map(|case| case.way.clone()))
    };
    grouped(all, |case| case.row.point[METHOD].clone())
        .into_iter()
        .flat_map(of_method)
        .collect()
}
