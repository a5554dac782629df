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

mod figure;
mod sentences;

use super::prelude::*;
use crate::instrument::metrics::{DISPLAY_HEADLINE, HEADLINE, PICTURE_SCORES};
use figure::figure;
use sentences::sentences;
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
    let has_picture = shape.values[SCENE]
        .iter()
        .any(|scene| !is_design(&scene.to_string()));
    if !shape.methods().any(|method| method.name == BASE) {
        Some("axes.method has no `split-sum`, with which the pictures are compared")
    } else if shape.methods().count() < 2 {
        Some("axes.method has only `split-sum`")
    } else if !has_picture {
        Some("axes.scene has no scene but `design`, which is not a picture")
    } else if !shape.is_swept(ENVIRONMENT_ORIENTATION) {
        Some("axes.environment_orientation has fewer than two orientations")
    } else {
        None
    }
}

/// A picture of a method, and the same picture of the base.
#[derive(Clone, Copy)]
struct Compared<'r, 'f> {
    row: &'r Row<'f>,
    base: &'r Row<'f>,
}

impl Compared<'_, '_> {
    /// The ratio of their scores; `None` if neither is resolved.
    fn ratio(&self, frame: &Frame) -> Option<f64> {
        let is_resolved = frame.is_resolved(self.row) || frame.is_resolved(self.base);
        let ratio = frame.error(self.row)? / frame.error(self.base)?;
        (is_resolved && ratio.is_finite() && ratio > 0.0).then_some(ratio)
    }
}

/// A picture and its ratio.
#[derive(Clone, Copy)]
struct Worst<'r, 'f> {
    row: &'r Row<'f>,
    ratio: f64,
}

/// What distinguishes the groups of one scene and score.
#[derive(Clone, PartialEq, Eq, Hash)]
struct MethodCase {
    /// On the swept axes of cases.
    case: Key,
    variant: Variant,
}

/// The pictures of one method in one case and score.
struct Group<'r, 'f> {
    /// Or [`ALL`].
    scene: String,
    metric: &'static str,
    /// On the swept axes of cases.
    case: Key,
    variant: Variant,
    ratios: Numbers<'r, 'f>,
    /// Least and largest score.
    scores: [f64; 2],
}

impl<'r, 'f> Group<'r, 'f> {
    /// `None` without a resolved picture.
    fn new(
        frame: &Frame,
        scene: &str,
        key: &MethodCase,
        pictures: &[&Compared<'r, 'f>],
    ) -> Option<Self> {
        let ratios = pictures
            .iter()
            .filter_map(|picture| Some((picture.row, picture.ratio(frame)?)));
        let ratios = Numbers::new(ratios, Middle::Median).evidence();
        let scores = || ratios.rows().filter_map(|row| frame.score(row));
        let scores = [scores().reduce(f64::min)?, scores().reduce(f64::max)?];
        Some(Self {
            scene: scene.to_owned(),
            metric: frame.metric_name(),
            case: key.case.clone(),
            variant: key.variant.clone(),
            ratios,
            scores,
        })
    }

    fn median(&self) -> Option<Estimate> {
        self.ratios.estimate()
    }

    /// The share of the pictures with a ratio above 1.
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

    fn worst(&self) -> Option<Worst<'r, 'f>> {
        let items = self.ratios.items().iter();
        worst(items.map(|&(row, ratio)| Worst { row, ratio }))
    }

    /// The picture whose ratio is nearest.
    fn nearest(&self, to: f64) -> Option<&'r Row<'f>> {
        let distance = |ratio: f64| (ratio / to).ln().abs();
        let items = self.ratios.items().iter();
        items
            .min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)))
            .map(|(row, _)| *row)
    }

    /// What the digest shows of a group; `None` for ratios of the base to itself.
    fn digest_cell(&self) -> Option<Cell> {
        if self.metric == BRIGHTNESS {
            return Some(percent_extent(self.scores).into());
        }
        if self.variant.method == BASE {
            return None;
        }
        let median = with_interval(&self.median()?);
        let worse = percent(self.worse()?.value);
        Some(Cell::quantity(format!("{median}, {worse} worse")))
    }
}

/// The picture with the largest ratio; of equal ones the one whose values come first, as texts. An id
/// would decide by the shaders that were compiled.
fn worst<'r, 'f>(pictures: impl Iterator<Item = Worst<'r, 'f>>) -> Option<Worst<'r, 'f>> {
    fn texts(picture: &Worst) -> impl Iterator<Item = String> {
        picture.row.point.values().map(Value::to_string)
    }
    pictures.max_by(|a, b| {
        a.ratio
            .total_cmp(&b.ratio)
            .then_with(|| texts(b).cmp(texts(a)))
    })
}

/// The worst picture of several groups.
fn worst_of<'r, 'f>(groups: &[&Group<'r, 'f>]) -> Option<Worst<'r, 'f>> {
    worst(groups.iter().filter_map(|group| group.worst()))
}

/// These axes without the axes that distinguish pictures.
fn without_picture_axes(mut axes: Vec<AxisId>) -> Vec<AxisId> {
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
fn compared<'r, 'f>(frame: &Frame, images: &[&'r Row<'f>]) -> Vec<Compared<'r, 'f>> {
    let mut bases = images.to_vec();
    bases.retain(|row| row.text(METHOD) == BASE);
    let mut axes = frame.case_axes();
    axes.retain(|axis| bases.iter().all(|row| row.point[*axis] != Value::Unset));
    let bases: HashMap<Key, &Row> = bases.iter().map(|row| (row.key(&axes), *row)).collect();
    images
        .iter()
        .filter_map(|row| {
            let base = bases.get(&row.key(&axes))?;
            Some(Compared { row, base })
        })
        .collect()
}

/// By scene, all scenes first if several are shown; then by case and method; then by score.
fn groups<'r, 'f>(frame: &Frame, pictures: &[Compared<'r, 'f>]) -> Vec<Group<'r, 'f>> {
    let axes = without_picture_axes(frame.case_axes());
    let by_score = PICTURE_SCORES.map(|metric| frame.like(frame.run, metric));
    let mut scenes = distinct_in_order(pictures.iter().map(|picture| picture.row.text(SCENE)));
    if scenes.len() > 1 {
        scenes.insert(0, ALL.to_owned());
    }
    let mut groups = Vec::new();
    for scene in scenes {
        let of_scene = pictures
            .iter()
            .filter(|picture| scene == ALL || picture.row.text(SCENE) == scene);
        let key = |picture: &&Compared| MethodCase {
            case: picture.row.key(&axes),
            variant: frame.variant(picture.row),
        };
        for (key, pictures) in grouped(of_scene, key) {
            for frame in &by_score {
                groups.extend(Group::new(frame, &scene, &key, &pictures));
            }
        }
    }
    groups
}

fn answer(frame: &Frame) -> Option<Finding> {
    // Includes pictures for every metric: a metric of radiance leaves them out if there is a
    // design.
    let pictures = frame.like(frame.run, DISPLAY_HEADLINE);
    let mut images = pictures.images();
    images.retain(|row| !is_design(&row.text(SCENE)));
    let groups = groups(frame, &compared(frame, &images));
    // The sentences, the digest and the figure are about all scenes.
    let all_scenes = &groups.first()?.scene;
    let all: Vec<&Group> = groups
        .iter()
        .filter(|group| group.scene == *all_scenes)
        .collect();
    Some(Finding {
        table: table(frame, &groups)?,
        sentences: sentences(frame, &all)?,
        digest: Some(digest(frame, &all)),
        figure: figure(frame, &all),
    })
}

fn table(frame: &Frame, groups: &[Group]) -> Option<Table> {
    let case_axes = without_picture_axes(frame.table_axes());
    let axes = [&[SCENE], &case_axes[..], &[METHOD, SAMPLES]].concat();
    let mut table = Table::new(&axes, QUESTION.columns);
    for group in groups {
        let median = group.median()?;
        let worse = group.worse()?;
        let worst = group.worst()?;
        let mut key = worst.row.key(&axes);
        key[0] = group.scene.clone().into();
        let mut row = axis_cells(&axes, &key);
        row.extend(cells![
            group.metric,
            BASE,
            group.ratios.items().len(),
            median.value,
            worse.value,
            worst.ratio
        ]);
        let intervals = [
            median.interval,
            median.prediction,
            worse.interval,
            worse.prediction,
        ];
        for interval in intervals {
            match interval {
                Some([lo, hi]) => row.extend(cells![lo, hi]),
                None => row.extend([Cell::Missing, Cell::Missing]),
            }
        }
        row.extend(group.scores.map(Cell::from));
        for axis in [ENVIRONMENT, ENVIRONMENT_ORIENTATION, SCENE] {
            row.push((&worst.row.point[axis]).into());
        }
        row.push((&*worst.row.cell.id).into());
        table.row(row);
    }
    Some(table)
}

/// The score of the sentences, the order of methods and the figure.
fn leading_score(frame: &Frame) -> &'static str {
    PICTURE_SCORES
        .into_iter()
        .find(|metric| *metric == frame.metric_name())
        .unwrap_or(HEADLINE)
}

/// The groups of one method and score.
struct MethodGroups<'g, 'r, 'f> {
    variant: Variant,
    groups: Vec<&'g Group<'r, 'f>>,
}

impl MethodGroups<'_, '_, '_> {
    fn mean_ratio(&self) -> f64 {
        let medians = self.groups.iter();
        let medians = medians.filter_map(|group| Some(group.median()?.value));
        geometric_mean(&medians.collect::<Vec<_>>())
    }
}

/// The groups of one score by method, without the base; the method with the least ratios first.
fn by_method<'g, 'r, 'f>(all: &[&'g Group<'r, 'f>], metric: &str) -> Vec<MethodGroups<'g, 'r, 'f>> {
    let groups = all
        .iter()
        .copied()
        .filter(|group| group.metric == metric && group.variant.method != BASE);
    let mut methods: Vec<MethodGroups> = grouped(groups, |group| group.variant.clone())
        .into_iter()
        .map(|(variant, groups)| MethodGroups { variant, groups })
        .collect();
    methods.sort_by(|a, b| a.mean_ratio().total_cmp(&b.mean_ratio()));
    methods
}

/// The axes that name a picture.
fn picture_axes(frame: &Frame) -> Vec<AxisId> {
    distinct_in_order(std::iter::once(ENVIRONMENT).chain(frame.swept(&[Part::Case])))
}

/// "shader-ball, venice_sunset, orientation 7, alpha 0.1".
fn picture_name(frame: &Frame, row: &Row) -> String {
    let axes = picture_axes(frame);
    frame.names.comma_label(&axes, &row.key(&axes))
}

/// One row per score and case, one column per method: the median ratio and the share of worse
/// pictures; for [`BRIGHTNESS`] the range of the pictures. The last row has the worst pictures by
/// the leading score.
fn digest(frame: &Frame, all: &[&Group]) -> Table {
    let axes = without_picture_axes(frame.case_axes());
    let methods = by_method(all, leading_score(frame));
    let case_heads = frame.names.heads(&axes);
    let mut variants: Vec<Variant> = methods.iter().map(|one| one.variant.clone()).collect();
    variants.push(Variant::new(BASE));
    let heads = ["score"].into_iter().chain(case_heads.iter().copied());
    let heads = heads.map(str::to_owned);
    let heads = heads.chain(variants.iter().map(Variant::to_string));
    let mut table = Table::with_names(heads).with_labels(&variants);
    for metric in PICTURE_SCORES {
        let mut groups = all.to_vec();
        groups.retain(|group| group.metric == metric);
        for case in distinct_in_order(groups.iter().map(|group| group.case.clone())) {
            let mut row = cells![metric];
            row.extend(frame.names.head(&axes, &case));
            for variant in &variants {
                let group = groups
                    .iter()
                    .find(|group| group.variant == *variant && agree(&group.case, &case));
                row.push(group.and_then(|group| group.digest_cell()).into());
            }
            table.row(row);
        }
    }
    let mut row = cells![leading_score(frame)];
    for index in 0..case_heads.len() {
        row.push(if index == 0 {
            "worst picture".into()
        } else {
            Cell::Missing
        });
    }
    for MethodGroups { groups, .. } in &methods {
        let worst = worst_of(groups)
            .map(|Worst { row, ratio }| format!("{}: {}", number(ratio), picture_name(frame, row)))
            .map(Cell::quantity);
        row.push(worst.into());
    }
    row.push(Cell::Missing);
    table.row(row);
    table
}
