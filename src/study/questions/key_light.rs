//! How strong must a key light be before the error is invisible?
//!
//! A direct light is exact, so it adds the same radiance to a method's image and to the reference.
//! Their difference stays, but after the tone curve a brighter surface shows less of it. The
//! measure is mean FLIP \[Andersson20\], as in the question `visibility`.
//!
//! A setting is one value of each axis but the light's: a model, a width, an exposure. Its FLIP at
//! one intensity is the median over environments, of each environment the median over turns of the
//! light and orientations of the map. The light hides the error from the least tried intensity from
//! which on every tried one stays below [`VISIBLE_FROM`].

use super::prelude::*;
use crate::instrument::metrics::TONE_MAPPED;

pub const QUESTION: Question = Question {
    name: "key-light",
    asks: "How strong must a key light be before the error is invisible?",
    columns: &[
        column("n", "Number of environments."),
        column(
            "flip",
            "Mean FLIP of an image: the median over environments, of each the median over turns of \
             the light.",
        ),
        column("flip_least", "Smallest mean FLIP of an image."),
        column("flip_most", "Largest mean FLIP of an image."),
        column(
            "tone_mapped",
            "Tone-mapped mean square error (`tone_mapped_mse`), the median of the same images.",
        ),
        column(
            "visible_from",
            "Mean FLIP of a visible difference, a convention of this project.",
        ),
        column(
            "hidden_from",
            "Least tried intensity from which on every tried one keeps `flip` below \
             `visible_from`; empty if none does.",
        ),
    ],
    has_rows: false,
    lacks,
    answer,
    is_weighted: false,
    ..Question::PLAIN
};

/// Axes over which a setting takes the median.
const POOLED: [AxisId; 3] = [ENVIRONMENT, ENVIRONMENT_ORIENTATION, LIGHT_TURN];

fn lacks(shape: &Shape) -> Option<&'static str> {
    let is_swept = shape.is_swept(LIGHT_INTENSITY);
    (!is_swept).then_some("axes.light_intensity has fewer than two intensities")
}

/// The images of a setting at one intensity.
struct Strength<'r, 'f> {
    intensity: Value,
    /// Mean FLIP by environment.
    flips: Vec<f64>,
    tone_mapped: f64,
    rows: Vec<&'r Row<'f>>,
}

impl<'r, 'f> Strength<'r, 'f> {
    fn new(frame: &Frame, intensity: Value, rows: Vec<&'r Row<'f>>) -> Self {
        let medians = |score: &dyn Fn(&Row) -> Option<f64>| -> Vec<f64> {
            let by_light = grouped(&rows, |row| row.point[ENVIRONMENT].clone());
            let scores = by_light
                .iter()
                .map(|(_, rows)| rows.iter().filter_map(|row| score(row)).collect::<Vec<_>>());
            scores.map(|scores| median(&scores)).collect()
        };
        Self {
            flips: medians(&|row| row.flip()),
            tone_mapped: median(&medians(&|row| frame.run.score(row.cell, &TONE_MAPPED))),
            intensity,
            rows,
        }
    }

    fn flip(&self) -> f64 {
        median(&self.flips)
    }

    fn is_hidden(&self) -> bool {
        self.flip() < VISIBLE_FROM
    }
}

/// A method at one value of each axis but the light's; by intensity, ascending.
struct Setting<'r, 'f> {
    variant: Variant,
    key: Key,
    strengths: Vec<Strength<'r, 'f>>,
}

impl Setting<'_, '_> {
    /// The least intensity from which on the error is hidden.
    fn hidden_from(&self) -> Option<&Value> {
        let hidden = self.strengths.iter().rev();
        let hidden = hidden.take_while(|strength| strength.is_hidden());
        hidden.last().map(|strength| &strength.intensity)
    }

    /// Whether the error is hidden at the least tried intensity and at all above.
    fn is_always_hidden(&self) -> bool {
        self.hidden_from() == self.strengths.first().map(|strength| &strength.intensity)
    }
}

/// The axes that distinguish settings.
fn setting_axes(frame: &Frame) -> Vec<AxisId> {
    let mut axes = frame.table_axes();
    axes.retain(|axis| !POOLED.contains(axis) && *axis != LIGHT_INTENSITY);
    axes.extend([EXPOSURE, CONTRAST]);
    axes
}

/// Methods without samples first.
fn settings<'r, 'f>(frame: &'r Frame<'f>, axes: &[AxisId]) -> Vec<Setting<'r, 'f>> {
    let rows = frame
        .rows
        .iter()
        .filter(|row| !frame.is_nothing(row) && row.flip().is_some_and(f64::is_finite));
    let mut methods = grouped(rows, |row| frame.variant(row));
    methods.sort_by_key(|(_, rows)| rows[0].samples().is_some());
    let mut settings = Vec::new();
    for (variant, rows) in methods {
        for (key, rows) in grouped(rows, |row| row.key(axes)) {
            let strengths = grouped_ascending(rows, LIGHT_INTENSITY, |row| row);
            settings.push(Setting {
                variant: variant.clone(),
                key,
                strengths: strengths
                    .into_iter()
                    .map(|(intensity, rows)| Strength::new(frame, intensity, rows))
                    .collect(),
            });
        }
    }
    settings
}

fn answer(frame: &Frame) -> Option<Finding> {
    let axes = setting_axes(frame);
    let settings = settings(frame, &axes);
    Some(Finding {
        sentences: sentences(frame, &settings)?,
        table: table(frame, &axes, &settings),
        digest: Some(digest(frame, &axes, &settings)),
        figure: figure(frame, &axes, &settings),
    })
}

fn sentences(frame: &Frame, settings: &[Setting]) -> Option<Sentences> {
    let variant = &settings.first()?.variant;
    let own: Vec<&Setting> = settings
        .iter()
        .filter(|setting| setting.variant == *variant)
        .collect();
    let strongest = &own[0].strengths.last()?.intensity;
    let never = own.iter().filter(|setting| setting.hidden_from().is_none());
    let count = |n: usize| Number::Count(n as u64);
    let headline = statement![
        "In ",
        count(never.count()),
        " of ",
        count(own.len()),
        " settings no tried key light, up to ",
        times_the_light(frame, strongest),
        ", hides the error of ",
        Phrase::Method(variant.clone()),
        "."
    ];
    let always = own.iter().filter(|setting| setting.is_always_hidden());
    let least = &own[0].strengths.first()?.intensity;
    let always = if least.is_zero() {
        let count = count(always.count());
        statement!["In ", count, " it is invisible without a key light."]
    } else {
        statement![
            "In ",
            count(always.count()),
            " it is invisible at ",
            times_the_light(frame, least),
            " and at all above."
        ]
    };
    let rows: Vec<&Row> = settings
        .iter()
        .flat_map(|setting| &setting.strengths)
        .flat_map(|strength| &strength.rows)
        .copied()
        .collect();
    let scope = scope_statement(frame, &rows);
    Some(Sentences::new(headline).with_details(std::iter::once(always).chain(scope)))
}

/// An intensity in a sentence: "16 times the light".
fn times_the_light(frame: &Frame, intensity: &Value) -> Phrase {
    Phrase::AxisValue {
        axis: frame.names.name(LIGHT_INTENSITY),
        label: frame.names.in_sentence(LIGHT_INTENSITY, intensity),
    }
}

fn table(frame: &Frame, axes: &[AxisId], settings: &[Setting]) -> Table {
    let axes = [&frame.variant_axes()[..], axes, &[LIGHT_INTENSITY]].concat();
    let mut table = Table::new(&axes, QUESTION.columns);
    for setting in settings {
        let hidden_from = setting.hidden_from().map_or(Cell::Missing, Cell::from);
        for strength in &setting.strengths {
            let flips = || strength.rows.iter().filter_map(|row| row.flip());
            let mut row = strength.rows[0].cells(&axes);
            row.extend(cells![
                strength.flips.len(),
                strength.flip(),
                flips().fold(f64::INFINITY, f64::min),
                flips().fold(0.0, f64::max),
                strength.tone_mapped,
                VISIBLE_FROM,
                hidden_from.clone()
            ]);
            table.row(row);
        }
    }
    table
}

/// The axes of a setting that the experiment sweeps, without the exposure.
fn row_axes(frame: &Frame, axes: &[AxisId]) -> Vec<AxisId> {
    let swept = axes
        .iter()
        .filter(|axis| **axis != EXPOSURE && frame.shape.is_swept(**axis));
    swept.copied().collect()
}

fn value<'s>(axes: &[AxisId], setting: &'s Setting, axis: AxisId) -> &'s Value {
    let index = axes.iter().position(|known| *known == axis);
    &setting.key[index.expect("an axis of settings")]
}

fn values_of(axes: &[AxisId], setting: &Setting, wanted: &[AxisId]) -> Key {
    let value = |axis: &AxisId| value(axes, setting, *axis).clone();
    wanted.iter().map(value).collect()
}

fn exposures(axes: &[AxisId], settings: &[Setting]) -> Vec<Value> {
    let exposures = settings
        .iter()
        .map(|setting| value(axes, setting, EXPOSURE).clone());
    ascending(distinct_in_order(exposures))
}

/// A row for each method and setting, a column for each exposure: the least intensity that hides
/// the error.
fn digest(frame: &Frame, axes: &[AxisId], settings: &[Setting]) -> Table {
    let rows = row_axes(frame, axes);
    let exposures = exposures(axes, settings);
    let mut heads = vec![AXES[METHOD].name.to_owned()];
    heads.extend(frame.names.heads(&rows).into_iter().map(str::to_owned));
    let of_exposure = |exposure| format!("hidden at exposure {exposure} from");
    heads.extend(exposures.iter().map(of_exposure));
    let mut table = Table::with_names(heads);
    let groups = grouped(settings, |setting| {
        (setting.variant.clone(), values_of(axes, setting, &rows))
    });
    for ((variant, key), group) in groups {
        let mut row = cells![&variant];
        row.extend(frame.names.head(&rows, &key));
        for exposure in &exposures {
            let setting = group
                .iter()
                .find(|setting| value(axes, setting, EXPOSURE) == exposure);
            row.push(match setting.map(|setting| setting.hidden_from()) {
                None => Cell::Missing,
                Some(None) => "none tried".into(),
                Some(Some(intensity)) => Cell::quantity(intensity.to_string()),
            });
        }
        table.row(row);
    }
    table
}

/// A panel for each method, model and exposure, a line for each width: FLIP over intensity.
fn figure(frame: &Frame, axes: &[AxisId], settings: &[Setting]) -> Option<Figure> {
    let intensities = {
        let strengths = settings.iter().flat_map(|setting| &setting.strengths);
        ascending(distinct_in_order(
            strengths.map(|strength| strength.intensity.clone()),
        ))
    };
    let row_axis = frame.row_axis();
    let widths = ascending(distinct_in_order(
        settings
            .iter()
            .map(|setting| value(axes, setting, row_axis).clone()),
    ));
    let mut panel_axes = row_axes(frame, axes);
    panel_axes.retain(|axis| *axis != row_axis);
    panel_axes.push(EXPOSURE);
    let groups = grouped(settings, |setting| {
        (
            setting.variant.clone(),
            values_of(axes, setting, &panel_axes),
        )
    });
    let panels = groups.into_iter().map(|((variant, key), group)| {
        let mut marks = vec![Mark::neutral(Form::HorizontalRule(VISIBLE_FROM))];
        for setting in group {
            let series = step(&widths, value(axes, setting, row_axis)) as usize;
            let dots = setting.strengths.iter();
            let dots = dots.map(|strength| dot_of(frame, setting, strength, &intensities, series));
            marks.extend(joined(dots.collect()));
        }
        ChartPanel {
            title: commas([
                &variant.label(),
                &frame.names.comma_label(&panel_axes, &key),
            ]),
            marks,
        }
    });
    Chart {
        title: "The difference under a key light",
        note: format!(
            "mean FLIP, median over environments and turns of the light; a difference from \
             {VISIBLE_FROM} counts as visible (a convention)"
        ),
        x: ChartAxis::values(frame, LIGHT_INTENSITY, &intensities),
        y: ChartAxis::Log("mean FLIP"),
        panels: panels.collect(),
        series: widths
            .iter()
            .map(|width| solid(frame.names.value_label(row_axis, width)))
            .collect(),
    }
    .figure()
}

fn dot_of(
    frame: &Frame,
    setting: &Setting,
    strength: &Strength,
    intensities: &[Value],
    series: usize,
) -> Mark {
    let x = step(intensities, &strength.intensity);
    let tip = format!(
        "{} · {}: mean FLIP {}",
        setting.variant.label(),
        frame
            .names
            .value_label(LIGHT_INTENSITY, &strength.intensity),
        number(strength.flip())
    );
    let dot = Mark::new(Form::Dot([x, strength.flip()]), series).tip(tip);
    Mark {
        cell: only(&strength.rows),
        ..dot
    }
}
