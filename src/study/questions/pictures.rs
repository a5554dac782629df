//! Which split sum makes the better pictures?
//!
//! A *picture* is a scene under one environment in one orientation. Each score of a picture is
//! divided by the score of the textbook's split sum ([`BASE`]) in the same picture; the scores are
//! [`PICTURE_SCORES`]. `bias_rel`, the error of mean brightness, has a sign: its ratios are of
//! magnitudes, and the table also has its signed range. Ratios are never averaged: a case has their
//! median, the share of pictures that a method makes worse, and the worst picture. Pictures in
//! which neither error is resolved do not count.
//!
//! Pictures under one environment share its lamps: medians and shares are taken within each
//! environment first, and intervals are over environments. A prediction interval is for one new
//! environment.

use super::prelude::*;
use crate::instrument::metrics::{DISPLAY_HEADLINE, HEADLINE, PICTURE_SCORES};
use std::collections::HashMap;

pub const QUESTION: Question = Question {
    name: "pictures",
    asks: "Which split sum makes the better pictures?",
    columns: &[
        column("metric", "The score."),
        column("base", "The textbook's split sum."),
        column("images", "Number of pictures."),
        column(
            "median_ratio",
            "Score over the score of the base, the median picture; below 1 the method is better.",
        ),
        column(
            "worse_fraction",
            "Share of the pictures with a ratio above 1.",
        ),
        column("worst_ratio", "The largest ratio of a picture."),
        column(
            "median_lo",
            "Lower end of the 95 % interval of `median_ratio` over environments.",
        ),
        column("median_hi", super::UPPER),
        column(
            "median_predicted_lo",
            "Lower 95 % prediction limit of `median_ratio` under one new environment.",
        ),
        column("median_predicted_hi", super::UPPER),
        column(
            "worse_lo",
            "Lower end of the 95 % interval of `worse_fraction` over environments.",
        ),
        column("worse_hi", super::UPPER),
        column(
            "worse_predicted_lo",
            "Lower 95 % prediction limit of `worse_fraction` under one new environment.",
        ),
        column("worse_predicted_hi", super::UPPER),
        column(
            "least_score",
            "The least score of a picture; `bias_rel` is signed.",
        ),
        column("largest_score", "The largest score of a picture."),
        column(
            "worst_environment",
            "The environment of the picture with the largest ratio.",
        ),
        column("worst_orientation", "Its `environment_orientation`."),
        column("worst_scene", "Its scene."),
        column("worst_cell", "Its cell."),
    ],
    is_weighted: false,
    has_rows: false,
    lacks,
    answer,
    ..Question::PLAIN
};

const BASE: &str = "split-sum";
const BRIGHTNESS: &str = PICTURE_SCORES[3];

fn lacks(shape: &Shape) -> Option<&'static str> {
    let has_base = shape.methods().any(|method| method.name == BASE);
    match () {
        () if !has_base => {
            Some("axes.method has no `split-sum`, with which the pictures are compared")
        }
        () if shape.methods().count() < 2 => Some("axes.method has only `split-sum`"),
        () if shape.values[SCENE]
            .iter()
            .all(|scene| is_design(&scene.to_string())) =>
        {
            Some("axes.scene has no scene but `design`, which is not a picture")
        }
        () if !shape.is_swept(ENVIRONMENT_ORIENTATION) => {
            Some("axes.environment_orientation has fewer than two orientations")
        }
        () => None,
    }
}

/// The pictures of one method in one case and score.
struct Group<'r, 'f> {
    scene: String,
    /// On the swept axes of cases.
    key: Key,
    metric: &'static str,
    /// As [`Frame::way`].
    name: String,
    ratios: Numbers<'r, 'f>,
    /// Least and largest score.
    scores: [f64; 2],
}

impl<'r, 'f> Group<'r, 'f> {
    fn median(&self) -> Option<Estimate> {
        self.ratios.estimate()
    }

    fn worse(&self) -> Option<Estimate> {
        let is_worse = self
            .ratios
            .items()
            .iter()
            .map(|(row, ratio)| (*row, f64::from(u8::from(*ratio > 1.0))));
        let clipped = |ends: [f64; 2]| ends.map(|end| end.clamp(0.0, 1.0));
        let worse = Numbers::new(is_worse, Middle::Mean).estimate()?;
        Some(Estimate {
            interval: worse.interval.map(clipped),
            prediction: worse.prediction.map(clipped),
            ..worse
        })
    }

    fn worst(&self) -> Option<(&'r Row<'f>, f64)> {
        worst(self.ratios.items().iter().copied())
    }

    fn nearest(&self, to: f64) -> Option<&'r Row<'f>> {
        let distance = |ratio: f64| (ratio / to).ln().abs();
        let items = self.ratios.items().iter().copied();
        items
            .min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)))
            .map(|(row, _)| row)
    }
}

/// The picture with the largest ratio; of equal ones the one whose id comes first.
fn worst<'r, 'f>(pictures: impl Iterator<Item = (&'r Row<'f>, f64)>) -> Option<(&'r Row<'f>, f64)> {
    pictures.max_by(|a, b| {
        a.1.total_cmp(&b.1)
            .then_with(|| b.0.cell.id.cmp(&a.0.cell.id))
    })
}

/// These axes without the axes that distinguish pictures.
fn of_cases(mut axes: Vec<AxisId>) -> Vec<AxisId> {
    axes.retain(|axis| {
        ![
            ENVIRONMENT,
            ENVIRONMENT_ORIENTATION,
            ENVIRONMENT_ROTATION,
            SCENE,
        ]
        .contains(axis)
    });
    axes
}

/// Each picture with the same picture of the base.
fn pairs<'r, 'f>(frame: &Frame, images: &[&'r Row<'f>]) -> Vec<[&'r Row<'f>; 2]> {
    let bases: Vec<&Row> = images
        .iter()
        .copied()
        .filter(|row| row.text(METHOD) == BASE)
        .collect();
    let mut axes = frame.case_axes();
    axes.retain(|axis| bases.iter().all(|row| row.point[*axis] != Value::Unset));
    let by_key: HashMap<Key, &Row> = bases.iter().map(|row| (row.key(&axes), *row)).collect();
    images
        .iter()
        .filter_map(|row| Some([*row, *by_key.get(&row.key(&axes))?]))
        .collect()
}

fn groups<'r, 'f>(frame: &Frame, pairs: &[[&'r Row<'f>; 2]]) -> Vec<Group<'r, 'f>> {
    let axes = of_cases(frame.case_axes());
    let scenes = distinct_in_order(pairs.iter().map(|[row, _]| row.text(SCENE)));
    let all = (scenes.len() > 1).then(|| ALL.to_owned());
    let scored = PICTURE_SCORES.map(|metric| frame.like(frame.run, metric));
    let mut found = Vec::new();
    for scene in all.into_iter().chain(scenes) {
        let own = pairs
            .iter()
            .filter(|[row, _]| scene == ALL || row.text(SCENE) == scene);
        for ((key, name), pairs) in grouped(own, |[row, _]| (row.key(&axes), frame.way(row))) {
            found.extend(scored.iter().filter_map(|of| {
                let ratio = |[row, base]: &&[&'r Row<'f>; 2]| {
                    let is_resolved = of.is_resolved(row) || of.is_resolved(base);
                    let ratio = of.error(row)? / of.error(base)?;
                    (is_resolved && ratio.is_finite() && ratio > 0.0).then_some((*row, ratio))
                };
                let ratios =
                    Numbers::new(pairs.iter().filter_map(ratio), Middle::Median).evidence();
                let scores = || ratios.rows().filter_map(|row| of.score(row));
                let scores = [scores().reduce(f64::min)?, scores().reduce(f64::max)?];
                let (scene, key, name) = (scene.clone(), key.clone(), name.clone());
                Some(Group {
                    scene,
                    key,
                    metric: of.metric_name(),
                    name,
                    ratios,
                    scores,
                })
            }));
        }
    }
    found
}

fn answer(frame: &Frame) -> Option<Finding> {
    // Includes pictures for every metric: a metric of radiance leaves them out if there is a
    // design.
    let pictures = frame.like(frame.run, DISPLAY_HEADLINE);
    let images: Vec<&Row> = pictures
        .images()
        .into_iter()
        .filter(|row| !is_design(&row.text(SCENE)))
        .collect();
    let groups = groups(frame, &pairs(frame, &images));
    let axes = [
        &[SCENE],
        &of_cases(frame.table_axes())[..],
        &[METHOD, SAMPLES],
    ]
    .concat();
    let mut table = Table::new(&axes, QUESTION.columns);
    for group in &groups {
        let ([median, worse], (row, worst)) = ([group.median()?, group.worse()?], group.worst()?);
        let mut key = row.key(&axes);
        key[0] = group.scene.clone().into();
        let images = group.ratios.items().len();
        let head = cells![group.metric, BASE, images, median.value, worse.value, worst];
        let ends = [
            median.interval,
            median.prediction,
            worse.interval,
            worse.prediction,
        ];
        let ends = ends
            .into_iter()
            .flat_map(|ends| ends.map_or([None; 2], |ends| ends.map(Some)))
            .map(Cell::from);
        let scores = group.scores.map(Cell::from);
        let [light, orientation, scene] =
            [ENVIRONMENT, ENVIRONMENT_ORIENTATION, SCENE].map(|of| (&row.point[of]).into());
        let place = [light, orientation, scene, row.cell.id.as_str().into()];
        table.row(
            [axis_cells(&axes, &key), head]
                .concat()
                .into_iter()
                .chain(ends)
                .chain(scores)
                .chain(place)
                .collect(),
        );
    }
    // The sentence, the digest and the figure are about all scenes.
    let lead = groups.first()?.scene.clone();
    let own: Vec<&Group> = groups.iter().filter(|group| group.scene == lead).collect();
    Some(Finding {
        sentence: sentence(frame, &own)?,
        table,
        digest: Some(digest(frame, &own)),
        figure: figure(frame, &own),
    })
}

/// The score of the sentence and the digest.
fn leading(frame: &Frame) -> &'static str {
    PICTURE_SCORES
        .into_iter()
        .find(|metric| *metric == frame.metric_name())
        .unwrap_or(HEADLINE)
}

/// The groups of one score by method, without the base; the method with the least ratios first.
fn by_method<'g, 'r, 'f>(
    all: &[&'g Group<'r, 'f>],
    metric: &str,
) -> Vec<(String, Vec<&'g Group<'r, 'f>>)> {
    let own = all
        .iter()
        .copied()
        .filter(|group| group.metric == metric && group.name != BASE);
    let mut methods = grouped(own, |group| group.name.clone());
    let mean = |own: &[&Group]| {
        geometric_mean(
            &own.iter()
                .filter_map(|group| Some(group.median()?.value))
                .collect::<Vec<_>>(),
        )
    };
    methods.sort_by(|a, b| mean(&a.1).total_cmp(&mean(&b.1)));
    methods
}

/// "-52 to 54 %".
fn brightness(scores: [f64; 2]) -> String {
    range_words(scores.map(|score| 100.0 * score), number) + " %"
}

/// "shader-ball, venice_sunset, orientation 7, alpha 0.1".
fn picture_name(frame: &Frame, row: &Row) -> String {
    let swept = frame
        .swept(&[Part::Case])
        .into_iter()
        .filter(|axis| *axis != ENVIRONMENT);
    let axes: Vec<AxisId> = std::iter::once(ENVIRONMENT).chain(swept).collect();
    frame
        .names
        .label(&axes, &row.key(&axes))
        .replace(" · ", ", ")
}

fn sentence(frame: &Frame, all: &[&Group]) -> Option<String> {
    let metric = leading(frame);
    let methods = by_method(all, metric);
    let (name, own) = methods.first()?;
    let medians = own.iter().filter_map(|group| Some(group.median()?.value));
    let worse = own
        .iter()
        .filter_map(|group| Some(100.0 * group.worse()?.value));
    let (row, most) = worst(own.iter().filter_map(|group| group.worst()))?;
    Some(format!(
        "In the median picture `{name}` has **{} times** the `{metric}` of `{BASE}`, and it makes \
         {} % of the pictures worse. \
         The worst has {} times: {}.",
        range(medians),
        range(worse),
        number(most),
        picture_name(frame, row),
    ))
}

/// One row per score and case, one column per method: the median ratio and the share of worse
/// pictures; for [`BRIGHTNESS`] the range of the pictures. The last row has the worst pictures by
/// the leading score.
fn digest(frame: &Frame, all: &[&Group]) -> Table {
    let axes = of_cases(frame.case_axes());
    let methods = by_method(all, leading(frame));
    let heads = frame.names.heads(&axes);
    let names: Vec<&str> = methods
        .iter()
        .map(|(name, _)| name.as_str())
        .chain([BASE])
        .collect();
    let mut table = Table::with_names(
        ["score"]
            .iter()
            .chain(&heads)
            .chain(&names)
            .map(|name| (*name).to_owned()),
    );
    let words = |group: &Group| match group.metric {
        BRIGHTNESS => Some(brightness(group.scores)),
        _ if group.name == BASE => None,
        _ => Some(format!(
            "{}, {} worse",
            with_interval(&group.median()?),
            percent(group.worse()?.value)
        )),
    };
    for metric in PICTURE_SCORES {
        let own: Vec<&Group> = all
            .iter()
            .copied()
            .filter(|group| group.metric == metric)
            .collect();
        for key in distinct_in_order(own.iter().map(|group| group.key.clone())) {
            let cells = names.iter().map(|name| {
                own.iter()
                    .find(|group| group.name == *name && fits(&group.key, &key))
                    .and_then(|group| words(group))
            });
            table.row(
                [
                    cells![metric],
                    frame.names.head(&axes, &key),
                    cells.map(Cell::from).collect(),
                ]
                .concat(),
            );
        }
    }
    let worst = methods.iter().map(|(_, own)| {
        let worst = worst(own.iter().filter_map(|group| group.worst()));
        Cell::from(
            worst.map(|(row, ratio)| format!("{}: {}", number(ratio), picture_name(frame, row))),
        )
    });
    let blanks = heads.iter().skip(1).map(|_| Cell::Missing);
    let head = heads
        .iter()
        .take(1)
        .map(|_| Cell::from("worst picture"))
        .chain(blanks);
    let first = std::iter::once(Cell::from(leading(frame)));
    table.row(
        first
            .chain(head)
            .chain(worst)
            .chain([Cell::Missing])
            .collect(),
    );
    table
}

/// The leading score of the median picture by [`Frame::row_axis`], one panel per other case, and a
/// single dot for the worst picture of each method there. Dots link to their image.
fn figure(frame: &Frame, all: &[&Group]) -> Option<Figure> {
    let (axes, row_axis, metric) = (
        of_cases(frame.case_axes()),
        frame.row_axis(),
        leading(frame),
    );
    let steps = values(all.iter().flat_map(|group| group.ratios.rows()), row_axis);
    let methods = by_method(all, metric);
    let series: Vec<String> = methods.iter().map(|(name, _)| name.clone()).collect();
    let title = |key: &Key| frame.names.label_where(&axes, key, |axis| axis != row_axis);
    let titles = distinct_in_order(all.iter().map(|group| title(&group.key)));
    let line = |line: usize, own: &[&Group]| {
        let dot = |group: &&Group| {
            let median = group.median()?;
            let row = group.nearest(median.value)?;
            let x = step(&steps, &row.point[row_axis]);
            let words = |all: &Estimate| format!("median picture {}", with_interval(all));
            let mut dot = group
                .ratios
                .marks(line, |y| [x, y], (&group.name, &words))
                .into_iter()
                .next()?;
            dot.cell = Some(row.cell.id.clone());
            Some(dot)
        };
        let worst = worst(own.iter().filter_map(|group| group.worst())).map(|(row, most)| {
            let tip = format!(
                "worst picture {}, {}",
                number(most),
                picture_name(frame, row)
            );
            self::dot([step(&steps, &row.point[row_axis]), most], line, tip, row)
        });
        joined(own.iter().filter_map(dot).collect())
            .into_iter()
            .chain(worst)
            .collect::<Vec<_>>()
    };
    let panel = |name: String| {
        let lines = methods.iter().enumerate().flat_map(|(index, (_, own))| {
            let own: Vec<&Group> = own
                .iter()
                .copied()
                .filter(|group| title(&group.key) == name)
                .collect();
            line(index, &own)
        });
        let marks = std::iter::once(Mark::neutral(Form::HorizontalRule(1.0)))
            .chain(lines)
            .collect();
        (name, marks)
    };
    Chart {
        title: "Pictures against the textbook's split sum",
        note: format!(
            "{metric} over the {metric} of {BASE}; below 1 is better. Lines: the median picture; \
             single marks: the worst picture"
        ),
        x: Along::values(frame, row_axis, &steps),
        y: Along::Log("ratio"),
        panels: titles.into_iter().map(panel).collect(),
        series,
    }
    .figure()
}
