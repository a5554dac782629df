//! At which exposure and contrast is the difference visible?
//!
//! The measure is the mean over the image of FLIP \[Andersson20\], from 0 to 1, after the tone
//! curve: the difference that a viewer notices when two images alternate in place. From
//! [`VISIBLE_FROM`] it counts as visible.

use super::prelude::*;
use crate::draw::words;

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

/// A method at one exposure and contrast.
struct Setting<'r, 'f> {
    variant: Variant,
    exposure: Value,
    contrast: Value,
    /// Mean FLIP by environment, median over its images.
    flips: Vec<f64>,
    rows: Vec<&'r Row<'f>>,
}

impl<'r, 'f> Setting<'r, 'f> {
    fn new(variant: &Variant, key: &[Value], rows: Vec<&'r Row<'f>>) -> Self {
        let by_light = grouped(&rows, |row| row.point[ENVIRONMENT].clone());
        let flips = by_light.iter().map(|(_, rows)| {
            let flips: Vec<f64> = rows.iter().filter_map(|row| row.flip()).collect();
            median(&flips)
        });
        Self {
            variant: variant.clone(),
            exposure: key[0].clone(),
            contrast: key[1].clone(),
            flips: flips.collect(),
            rows,
        }
    }

    fn median(&self) -> f64 {
        median(&self.flips)
    }

    fn is_visible(&self) -> bool {
        self.median() >= VISIBLE_FROM
    }

    fn visible_count(&self) -> usize {
        self.flips
            .iter()
            .filter(|flip| **flip >= VISIBLE_FROM)
            .count()
    }

    fn key(&self) -> Key {
        vec![self.exposure.clone(), self.contrast.clone()]
    }
}

/// By method, contrast and exposure, the latter two ascending; methods without samples first.
fn settings<'r, 'f>(frame: &'r Frame<'f>) -> Vec<Vec<Setting<'r, 'f>>> {
    // Images without the compared term are only there for scale.
    let rows = frame
        .rows
        .iter()
        .filter(|row| !frame.is_nothing(row) && row.flip().is_some_and(f64::is_finite));
    let mut methods = grouped(rows, |row| frame.variant(row));
    methods.sort_by_key(|(_, rows)| rows[0].samples().is_some());
    let size = |value: &Value| value.size().unwrap_or(f64::NAN);
    let mut found = Vec::new();
    for (variant, rows) in methods {
        let mut settings: Vec<Setting> = grouped(rows, |row| row.key(&DISPLAY))
            .into_iter()
            .map(|(key, rows)| Setting::new(&variant, &key, rows))
            .collect();
        settings.sort_by(|a, b| {
            size(&a.contrast)
                .total_cmp(&size(&b.contrast))
                .then(size(&a.exposure).total_cmp(&size(&b.exposure)))
        });
        found.push(settings);
    }
    found
}

fn answer(frame: &Frame) -> Option<Finding> {
    let methods = settings(frame);
    Some(Finding {
        sentences: sentences(frame, methods.first()?)?,
        table: table(frame, &methods),
        digest: Some(digest(&methods)),
        figure: figure(frame, &methods),
    })
}

fn table(frame: &Frame, methods: &[Vec<Setting>]) -> Table {
    let axes = [&frame.variant_axes()[..], &DISPLAY].concat();
    let mut table = Table::new(&axes, QUESTION.columns);
    for setting in methods.iter().flatten() {
        let flips = || setting.rows.iter().filter_map(|row| row.flip());
        let mut row = setting.rows[0].cells(&axes);
        row.extend(cells![
            setting.flips.len(),
            setting.median(),
            flips().fold(f64::INFINITY, f64::min),
            flips().fold(0.0, f64::max),
            VISIBLE_FROM,
            setting.visible_count()
        ]);
        table.row(row);
    }
    table
}

/// The exposures at which the difference is visible at one contrast.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum VisibleAt {
    None,
    /// Of several.
    Every,
    /// The first and the last exposure of each run of neighbours.
    Runs(Vec<[Value; 2]>),
}

impl VisibleAt {
    /// At one contrast, by exposure, ascending.
    fn new(settings: &[&Setting]) -> Self {
        let visible_count = settings.iter().filter(|one| one.is_visible()).count();
        if visible_count == 0 {
            return Self::None;
        }
        if visible_count == settings.len() && visible_count > 1 {
            return Self::Every;
        }
        let runs = settings
            .chunk_by(|a, b| a.is_visible() == b.is_visible())
            .filter(|run| run[0].is_visible())
            .map(|run| [&run[0], &run[run.len() - 1]].map(|one| one.exposure.clone()));
        Self::Runs(runs.collect())
    }

    /// "exposure 0.5 to 50 and 500" or "every tried exposure".
    fn statement(&self) -> Statement {
        match self {
            Self::None => "no tried exposure".into(),
            Self::Every => "every tried exposure".into(),
            Self::Runs(runs) => {
                let runs = runs.iter().map(|[first, last]| {
                    if first == last {
                        first.to_string().into()
                    } else {
                        format!("{first} to {last}").into()
                    }
                });
                statement!["exposure ", Statement::listed(runs.collect())]
            }
        }
    }
}

/// The setting with the largest median.
fn peak<'c, 'r, 'f>(settings: &'c [Setting<'r, 'f>]) -> Option<&'c Setting<'r, 'f>> {
    settings
        .iter()
        .max_by(|a, b| a.median().total_cmp(&b.median()))
}

fn sentences(frame: &Frame, settings: &[Setting]) -> Option<Sentences> {
    let peak = peak(settings)?;
    let environments = (peak.flips.len() != 1).then(|| {
        let n = Number::Count(peak.flips.len() as u64);
        let plural = AXES[ENVIRONMENT].plural;
        statement![" (median of ", n, format!(" {plural})")]
    });
    let headline = statement![
        "The error of ",
        Phrase::Method(peak.variant.clone()),
        " is most visible at ",
        frame.names.comma_phrases(&DISPLAY, &peak.key()),
        ": mean FLIP ",
        Number::rounded(peak.median()),
        environments,
        "."
    ];
    // Contrasts with equal exposures are grouped.
    let by_contrast = grouped(settings, |one| one.contrast.clone())
        .into_iter()
        .map(|(contrast, settings)| (contrast, VisibleAt::new(&settings)));
    let by_exposures = grouped(by_contrast, |(_, visible_at)| visible_at.clone());
    let is_single = by_exposures.len() == 1;
    let parts = by_exposures.into_iter().map(|(visible_at, contrasts)| {
        let contrasts = contrasts
            .into_iter()
            .map(|(contrast, _)| contrast.to_string().into());
        let contrasts = (!is_single)
            .then(|| statement![" with contrast ", Statement::listed(contrasts.collect())]);
        statement!["at ", visible_at.statement(), contrasts]
    });
    let detail = statement!["It is visible ", Statement::joined(parts, ", "), "."];
    Some(Sentences::new(headline).with_details([detail]))
}

fn contrasts(methods: &[Vec<Setting>]) -> Vec<Value> {
    let settings = methods.iter().flatten();
    let rows = settings.flat_map(|setting| &setting.rows).copied();
    values(rows, CONTRAST)
}

/// One row per method, one column per contrast.
fn digest(methods: &[Vec<Setting>]) -> Table {
    let contrasts = contrasts(methods);
    let mut heads = [
        AXES[METHOD].name,
        "most at exposure",
        "contrast",
        "mean FLIP there",
        "visible from",
    ]
    .map(str::to_owned)
    .to_vec();
    for contrast in &contrasts {
        heads.push(format!("visible at contrast {contrast}"));
    }
    let mut table = Table::with_names(heads);
    for settings in methods {
        let Some(peak) = peak(settings) else { continue };
        let mut row = cells![
            &peak.variant,
            Cell::quantity(peak.exposure.to_string()),
            Cell::quantity(peak.contrast.to_string()),
            peak.median(),
            VISIBLE_FROM
        ];
        for contrast in &contrasts {
            let at_contrast: Vec<&Setting> = settings
                .iter()
                .filter(|one| one.contrast == *contrast)
                .collect();
            row.push(if at_contrast.is_empty() {
                Cell::Missing
            } else {
                words::markdown(&[VisibleAt::new(&at_contrast).statement()]).into()
            });
        }
        table.row(row);
    }
    table
}

/// One panel per method, one line per contrast: FLIP over exposure.
fn figure(frame: &Frame, methods: &[Vec<Setting>]) -> Option<Figure> {
    let contrasts = contrasts(methods);
    let mut panels = Vec::new();
    for settings in methods {
        let mut marks = vec![Mark::neutral(Form::HorizontalRule(VISIBLE_FROM))];
        for (series, contrast) in contrasts.iter().enumerate() {
            let line = settings.iter().filter(|one| one.contrast == *contrast);
            marks.extend(joined(line.map(|one| mark(frame, one, series)).collect()));
        }
        panels.push(ChartPanel {
            title: settings[0].variant.label(),
            marks,
        });
    }
    Chart {
        title: "The difference after the tone curve",
        note: format!(
            "mean FLIP, median over the rest; a difference from {VISIBLE_FROM} counts as visible \
             (a convention)"
        ),
        x: ChartAxis::Log(AXES[EXPOSURE].name),
        y: ChartAxis::Log("mean FLIP"),
        panels,
        series: contrasts
            .iter()
            .map(|contrast| solid(frame.names.value_label(CONTRAST, contrast)))
            .collect(),
    }
    .figure()
}

fn mark(frame: &Frame, setting: &Setting, series: usize) -> Mark {
    let tip = format!(
        "{} · {}: mean FLIP {}, visible in {} of {}",
        setting.variant.label(),
        frame.names.label(&DISPLAY, &setting.key()),
        number(setting.median()),
        setting.visible_count(),
        setting.flips.len()
    );
    let exposure = setting.exposure.size().unwrap_or(f64::NAN);
    let dot = Mark::new(Form::Dot([exposure, setting.median()]), series).tip(tip);
    Mark {
        cell: only(&setting.rows),
        ..dot
    }
}
