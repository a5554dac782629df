//! At which exposure and contrast is the difference visible?
//!
//! The measure is the mean over the image of FLIP \[Andersson20\], from 0 to 1, after the tone
//! curve: the difference that a viewer notices when two images alternate in place. From
//! [`VISIBLE_FROM`] it counts as visible.

use super::prelude::*;

pub const QUESTION: Question = Question {
    name: "visibility",
    asks: "At which exposure and contrast is the difference visible?",
    columns: &[
        column("n", "Number of environments."),
        column(
            "flip",
            "Mean FLIP of an image, median over environments; from 0 (none) to 1.",
        ),
        column("flip_least", "Smallest mean FLIP of an image."),
        column("flip_most", "Largest mean FLIP of an image."),
        column(
            "visible_from",
            "Mean FLIP of a visible difference, a convention of this project.",
        ),
        column(
            "visible",
            "Number of environments whose `flip` reaches `visible_from`.",
        ),
    ],
    has_rows: false,
    lacks,
    answer,
    is_weighted: false,
    ..Question::PLAIN
};

const DISPLAY: [AxisId; 2] = [EXPOSURE, CONTRAST];

fn lacks(shape: &Shape) -> Option<&'static str> {
    let is_swept = DISPLAY.iter().any(|axis| shape.is_swept(*axis));
    (!is_swept).then_some("axes has neither two exposures nor two contrasts")
}

struct Curve<'r, 'f> {
    method: String,
    /// Exposure and contrast.
    key: Key,
    /// Mean FLIP by environment, median over its images.
    flips: Vec<f64>,
    rows: Vec<&'r Row<'f>>,
}

impl Curve<'_, '_> {
    fn middle(&self) -> f64 {
        median(&self.flips)
    }

    fn visible_count(&self) -> usize {
        self.flips
            .iter()
            .filter(|flip| **flip >= VISIBLE_FROM)
            .count()
    }
}

/// By method, contrast and exposure, the latter two ascending; methods without samples first.
fn curves<'r, 'f>(frame: &'r Frame<'f>) -> Vec<Vec<Curve<'r, 'f>>> {
    let flip = |row: &Row| row.flip().filter(|flip| flip.is_finite());
    // Images without the compared term are only there for scale.
    let rows = frame
        .rows
        .iter()
        .filter(|row| !frame.is_nothing(row) && flip(row).is_some());
    let mut methods = grouped(rows, |row| frame.way(row));
    methods.sort_by_key(|(_, rows)| rows[0].samples().is_some());
    let of_method = |(method, rows): (String, Vec<&'r Row<'f>>)| {
        let curve = |(key, rows): (Key, Vec<&'r Row<'f>>)| {
            let by_light = grouped(&rows, |row| row.point[ENVIRONMENT].clone());
            let middle = |own: &Vec<&&Row>| {
                median(&own.iter().filter_map(|row| row.flip()).collect::<Vec<_>>())
            };
            let flips = by_light.iter().map(|(_, own)| middle(own)).collect();
            Curve {
                method: method.clone(),
                key,
                flips,
                rows,
            }
        };
        let mut curves: Vec<Curve> = grouped(rows, |row| row.key(&DISPLAY))
            .into_iter()
            .map(curve)
            .collect();
        let size = |one: &Curve, i: usize| one.key[i].size().unwrap_or(f64::NAN);
        curves.sort_by(|a, b| {
            size(a, 1)
                .total_cmp(&size(b, 1))
                .then(size(a, 0).total_cmp(&size(b, 0)))
        });
        curves
    };
    methods.into_iter().map(of_method).collect()
}

fn answer(frame: &Frame) -> Option<Finding> {
    let methods = curves(frame);
    let axes = [&frame.way_axes()[..], &DISPLAY].concat();
    let mut table = Table::new(&axes, QUESTION.columns);
    for one in methods.iter().flatten() {
        let flips = || one.rows.iter().filter_map(|row| row.flip());
        let (least, most) = (
            flips().fold(f64::INFINITY, f64::min),
            flips().fold(0.0, f64::max),
        );
        let own = cells![
            one.flips.len(),
            one.middle(),
            least,
            most,
            VISIBLE_FROM,
            one.visible_count()
        ];
        table.row([one.rows[0].cells(&axes), own].concat());
    }
    let sentence = sentence(frame, methods.first()?)?;
    Some(Finding {
        sentence,
        table,
        digest: Some(digest(&methods)),
        figure: figure(frame, &methods),
    })
}

/// "exposure 0.5 to 50 and 500" or "every tried exposure": where the difference is visible at one
/// contrast.
fn shown(own: &[&Curve]) -> String {
    let is_visible = |one: &&&Curve| one.middle() >= VISIBLE_FROM;
    match own.iter().filter(is_visible).count() {
        0 => return "no tried exposure".to_owned(),
        n if n == own.len() && n > 1 => return "every tried exposure".to_owned(),
        _ => {}
    }
    let runs = own
        .chunk_by(|a, b| is_visible(&a) == is_visible(&b))
        .filter(|run| is_visible(&&run[0]));
    let words = runs.map(|run| match run {
        [only] => only.key[0].to_string(),
        run => format!("{} to {}", run[0].key[0], run[run.len() - 1].key[0]),
    });
    format!("exposure {}", listed(&words.collect::<Vec<_>>()))
}

fn peak<'c, 'r, 'f>(own: &'c [Curve<'r, 'f>]) -> Option<&'c Curve<'r, 'f>> {
    own.iter().max_by(|a, b| a.middle().total_cmp(&b.middle()))
}

fn sentence(frame: &Frame, own: &[Curve]) -> Option<String> {
    let peak = peak(own)?;
    let over = match peak.flips.len() {
        1 => String::new(),
        n => format!(" (median of {n} {})", AXES[ENVIRONMENT].plural),
    };
    // Contrasts with equal words are grouped.
    let contrasts = grouped(own, |one| one.key[1].clone())
        .into_iter()
        .map(|(contrast, at)| (contrast, shown(&at)));
    let groups = grouped(contrasts, |(_, words)| words.clone());
    let part = |(words, own): &(String, Vec<(Value, String)>)| {
        let at = listed(
            &own.iter()
                .map(|(contrast, _)| contrast.to_string())
                .collect::<Vec<_>>(),
        );
        if groups.len() == 1 {
            format!("at {words}")
        } else {
            format!("at {words} with contrast {at}")
        }
    };
    Some(format!(
        "The error of `{}` is most visible at {}: mean FLIP {}{over}. It is visible {}.",
        peak.method,
        frame.names.label(&DISPLAY, &peak.key).replace(" · ", ", "),
        number(peak.middle()),
        groups.iter().map(part).collect::<Vec<_>>().join(", ")
    ))
}

fn tried(methods: &[Vec<Curve>], axis: AxisId) -> Vec<Value> {
    values(
        methods.iter().flatten().flat_map(|one| &one.rows).copied(),
        axis,
    )
}

/// One row per method, one column per contrast.
fn digest(methods: &[Vec<Curve>]) -> Table {
    let contrasts = tried(methods, CONTRAST);
    let heads = contrasts
        .iter()
        .map(|contrast| format!("visible at contrast {contrast}"));
    let names = [
        AXES[METHOD].name,
        "most at exposure",
        "contrast",
        "mean FLIP there",
        "visible from",
    ]
    .map(str::to_owned);
    let mut table = Table::with_names(names.into_iter().chain(heads));
    for own in methods {
        let Some(peak) = peak(own) else { continue };
        let mut row = cells![
            peak.method.as_str(),
            peak.key[0].to_string(),
            peak.key[1].to_string()
        ];
        row.extend(cells![peak.middle(), VISIBLE_FROM]);
        row.extend(contrasts.iter().map(|contrast| {
            let at: Vec<&Curve> = own.iter().filter(|one| one.key[1] == *contrast).collect();
            Cell::from((!at.is_empty()).then(|| shown(&at)))
        }));
        table.row(row);
    }
    table
}

/// One panel per method, one line per contrast: FLIP over exposure.
fn figure(frame: &Frame, methods: &[Vec<Curve>]) -> Option<Figure> {
    let contrasts = tried(methods, CONTRAST);
    let mark = |one: &Curve, series: usize| {
        let Curve {
            method,
            key,
            rows,
            flips,
        } = one;
        let (value, seen) = (one.middle(), one.visible_count());
        let curve = frame.names.label(&DISPLAY, key);
        let tip = format!(
            "{method} · {curve}: mean FLIP {}, visible in {seen} of {}",
            number(value),
            flips.len()
        );
        let dot = Mark::new(
            Form::Dot([key[0].size().unwrap_or(f64::NAN), value]),
            series,
        )
        .tip(tip);
        Mark {
            cell: only(rows),
            ..dot
        }
    };
    let panel = |own: &Vec<Curve>| {
        let line = |(series, contrast): (usize, &Value)| {
            joined(
                own.iter()
                    .filter(|one| one.key[1] == *contrast)
                    .map(|one| mark(one, series))
                    .collect(),
            )
        };
        let rule = Mark::neutral(Form::HorizontalRule(VISIBLE_FROM));
        let lines = contrasts.iter().enumerate().flat_map(line);
        (
            own[0].method.clone(),
            std::iter::once(rule).chain(lines).collect(),
        )
    };
    let chart = Chart {
        title: "The difference after the tone curve",
        note: format!(
            "mean FLIP, median over the rest; a difference from {VISIBLE_FROM} counts as visible \
             (a convention)"
        ),
        x: Along::Log(AXES[EXPOSURE].name),
        y: Along::Log("mean FLIP"),
        panels: methods.iter().map(panel).collect(),
        series: contrasts
            .iter()
            .map(|contrast| frame.names.one(CONTRAST, contrast))
            .collect(),
    };
    chart.figure()
}
