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

/// One method, at one sample count, in one case, over all point sets.
struct Case<'r, 'f> {
    row: &'r Row<'f>,
    /// As [`Frame::variant`].
    variant: Variant,
    error: f64,
    is_resolved: bool,
}

fn cases<'r, 'f>(frame: &Frame, images: &[&'r Row<'f>]) -> Vec<Case<'r, 'f>> {
    let luck = frame.swept(&[Part::Luck, Part::Display]);
    let mut rows = images.to_vec();
    rows.retain(|row| frame.error(row).is_some());
    let axes = varying(&rows, AXES.ids().filter(|axis| !luck.contains(axis)));
    let mut cases = Vec::new();
    for (_, rows) in group_by_axes(&rows, &axes) {
        let errors: Vec<f64> = rows.iter().filter_map(|row| frame.error(row)).collect();
        cases.push(Case {
            row: rows[0],
            variant: frame.variant(rows[0]),
            error: geometric_mean(&errors),
            is_resolved: rows.iter().all(|row| frame.is_resolved(row)),
        });
    }
    cases
}

fn answer(frame: &Frame) -> Option<Finding> {
    let images = frame.images();
    let all = cases(frame, &images);
    let leading = leading(&images, &all)?;
    let axes = [&frame.table_axes()[..], &[METHOD, SAMPLES]].concat();
    let mut table = Table::new(&axes, QUESTION.columns);
    for case in &all {
        let mut row = case.row.cells(&axes);
        row.extend(cells![
            case.error,
            frame.noise_floor(case.row),
            case.is_resolved,
            rms_percent(frame, case.error)
        ]);
        table.row(row);
    }
    Some(Finding {
        sentences: sentences(frame, leading, &all)?,
        digest: Some(digest(frame, &leading.variant, &all)),
        table,
        figure: figure(frame, &all),
    })
}

/// The first case of the leading method.
fn leading<'c, 'r, 'f>(images: &[&Row], all: &'c [Case<'r, 'f>]) -> Option<&'c Case<'r, 'f>> {
    let has_methods = images.iter().any(|row| !row.has_no_method());
    let is_fixed =
        |case: &Case| case.row.samples().is_none() && !(has_methods && case.row.has_no_method());
    let fixed = all.iter().find(|case| is_fixed(case));
    fixed.or_else(|| {
        let largest = all.iter().reduce(|a, b| {
            if b.row.samples() > a.row.samples() {
                b
            } else {
                a
            }
        })?;
        all.iter().find(|case| case.variant == largest.variant)
    })
}

fn numbers<'r, 'f>(cases: &[Case<'r, 'f>], variant: &Variant) -> Numbers<'r, 'f> {
    let cases = cases.iter().filter(|case| case.variant == *variant);
    Numbers::new(
        cases.map(|case| (case.row, case.error)),
        Middle::GeometricMean,
    )
}

/// The leading method by [`Frame::row_axis`] and environment; if the axis has one value, every
/// method by environment.
fn digest(frame: &Frame, leading: &Variant, all: &[Case]) -> Table {
    let words = |mean: &Estimate| error_with_interval(frame, mean);
    if frame.shape.is_swept(frame.row_axis()) {
        return numbers(all, leading).digest(frame, &words);
    }
    let variants = distinct_in_order(all.iter().map(|case| &case.variant));
    let rows: Vec<DigestRow> = variants
        .into_iter()
        .map(|variant| DigestRow {
            head: cells![variant],
            numbers: numbers(all, variant),
        })
        .collect();
    by_light(frame, &[AXES[METHOD].name], &rows, &words)
}

/// Smaller ratios of errors are not mentioned.
const CHANGE_MIN: f64 = 2.0;

fn sentences(frame: &Frame, leading: &Case, all: &[Case]) -> Option<Sentences> {
    let errors = numbers(all, &leading.variant);
    let mean = errors.estimate()?;
    let cases = if mean.n == 1 {
        let short = |axis: AxisId| frame.names.short_phrase(axis, &leading.row.point[axis]);
        statement![" on ", short(SCENE), " under ", short(ENVIRONMENT)]
    } else {
        let n = Number::Count(mean.n as u64);
        let plural = AXES[ENVIRONMENT].plural;
        statement![" (geometric mean of ", n, format!(" {plural})")]
    };
    let error = estimated(&mean);
    let error = match rms_percent(frame, mean.value) {
        Some(percent) => {
            let rms = Quantity::rounded(percent).unit(" % rms").strong();
            statement![error, ", about ", rms]
        }
        None => error.strong().into(),
    };
    let headline = statement![
        "The ",
        Phrase::Metric(frame.metric_name()),
        " of ",
        Phrase::Method(leading.variant.clone()),
        " is ",
        error,
        cases,
        "."
    ];
    let extremes = errors.extremes(frame, "it", CHANGE_MIN, |error| {
        error_statement(frame, error)
    });
    let sentences = Sentences::new(headline);
    let is_resolved = all
        .iter()
        .any(|case| case.variant == leading.variant && case.is_resolved);
    if is_resolved {
        let sentences = sentences.with_details(extremes);
        Some(sentences.with_scope(errors.scope(frame)))
    } else {
        let noise = "This is within the reference's noise: the true error may be smaller.".into();
        Some(sentences.with_details(extremes.into_iter().chain([noise])))
    }
}

/// Most sample counts of a method in the figure: the fewest, the middle one and the most.
const COUNTS_SHOWN: usize = 3;

/// The figure's variants and its horizontal axis.
struct Drawing<'a, 'f> {
    frame: &'a Frame<'f>,
    variants: Vec<Variant>,
    /// Whether the values of the row axis are positive numbers, which then are the axis of the
    /// figure.
    is_by_size: bool,
}

/// Dots by [`Frame::row_axis`] if its values are numbers, else by variant; one panel per
/// environment, after their mean.
fn figure(frame: &Frame, all: &[Case]) -> Option<Figure> {
    let row_axis = frame.row_axis();
    let row_values = &frame.shape.values[row_axis];
    let drawing = Drawing {
        frame,
        variants: shown_variants(all),
        is_by_size: frame.shape.is_swept(row_axis)
            && row_values.iter().all(|value| size(frame, value).is_some()),
    };
    let variants = &drawing.variants;
    let shown = all.iter().filter(|case| variants.contains(&case.variant));
    let mut lights = Vec::new();
    for (light, cases) in grouped(shown, |case| case.row.point[ENVIRONMENT].clone()) {
        lights.push(LightMarks {
            light: if frame.shape.is_swept(ENVIRONMENT) {
                light
            } else {
                Value::Unset
            },
            marks: cases
                .into_iter()
                .filter_map(|case| drawing.image(case))
                .collect(),
        });
    }
    let left_out = if all.iter().all(|case| variants.contains(&case.variant)) {
        ""
    } else {
        "; smallest, middle and largest sample count"
    };
    let first = numbers(all, &variants[0]);
    let metric = frame.metric_name();
    Chart {
        title: "How wrong each method is",
        note: if first.has_interval() {
            format!("{metric}; first the geometric mean{INTERVAL}; other dots are images{left_out}")
        } else {
            format!("{metric}; each dot is an image{left_out}")
        },
        x: if drawing.is_by_size {
            ChartAxis::Log(frame.names.name(row_axis))
        } else {
            ChartAxis::Steps("", variants.iter().map(Variant::label).collect())
        },
        y: ChartAxis::Log(metric),
        panels: light_panels(frame, &first, || drawing.averages(all), lights),
        series: variants
            .iter()
            .map(|variant| {
                let case = all.iter().find(|case| case.variant == *variant);
                let method = case.map_or_else(String::new, |case| case.row.text(METHOD));
                method_series(variant.label(), &method, false)
            })
            .collect(),
    }
    .figure()
}

/// A value of the row axis under the name that the experiment uses, if it is a positive number.
fn size(frame: &Frame, value: &Value) -> Option<f64> {
    let value = frame.names.shown(frame.row_axis(), value);
    value.size().filter(|size| *size > 0.0)
}

impl Drawing<'_, '_> {
    /// The dot of a case, which links to its image.
    fn image(&self, case: &Case) -> Option<Mark> {
        let frame = self.frame;
        let series = self
            .variants
            .iter()
            .position(|variant| *variant == case.variant)?;
        let x = size(frame, &case.row.point[frame.row_axis()])
            .filter(|_| self.is_by_size)
            .unwrap_or(series as f64);
        let axes = frame.case_axes();
        let label = frame.names.label(&axes, &case.row.key(&axes));
        let error = with_rms(frame, case.error);
        let tip = format!("{}: {error} · {label}", case.variant.label());
        Some(dot([x, case.error], series, tip, case.row))
    }

    /// The mean over environments of each variant.
    fn averages(&self, all: &[Case]) -> Vec<Mark> {
        let frame = self.frame;
        let row_axis = frame.row_axis();
        let words = |mean: &Estimate| error_with_interval(frame, mean);
        let mut marks = Vec::new();
        for (series, variant) in self.variants.iter().enumerate() {
            let errors = numbers(all, variant);
            if !self.is_by_size {
                let name = variant.label();
                marks.extend(errors.marks(series, &name, |error| [series as f64, error], &words));
                continue;
            }
            let mut dots = Vec::new();
            for (value, part) in errors.parts(row_axis) {
                let x = size(frame, &value).unwrap_or(f64::NAN);
                let label = frame.names.value_label(row_axis, &value);
                dots.extend(part.marks(
                    series,
                    &format!("{}, {label}", variant.label()),
                    |error| [x, error],
                    &words,
                ));
            }
            marks.extend(joined(dots));
        }
        marks
    }
}

/// Methods without samples, and a few counts of each other method.
fn shown_variants(all: &[Case]) -> Vec<Variant> {
    let mut shown = Vec::new();
    for (_, cases) in grouped(all, |case| case.row.point[METHOD].clone()) {
        let mut counts = distinct_in_order(cases.iter().filter_map(|case| case.row.samples()));
        counts.sort_unstable();
        let last = counts.len().saturating_sub(1);
        if counts.len() > COUNTS_SHOWN {
            counts = [0, last / 2, last].map(|index| counts[index]).to_vec();
        }
        let is_shown = |case: &Case| case.row.samples().is_none_or(|n| counts.contains(&n));
        let variants = cases.into_iter().filter(|case| is_shown(case));
        shown.extend(distinct_in_order(variants.map(|case| case.variant.clone())));
    }
    shown
}
