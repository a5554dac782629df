//! Where on a surface, and on which surface, does a method err?
//!
//! The error of a method over the pixels with n·v in a bin, by bin and [`Frame::row_axis`]: the
//! median over everything else that is swept, of each method at the tried count nearest to the
//! default.
//!
//! On the scene `design` each bin sees the whole map. In a picture n·v is tied to the place on the
//! map: with an orthographic camera the mirror direction is 2 acos(n·v) from v, so each bin sees
//! one ring of the map. Turning the map by 60 degrees changes a bin by up to a factor of 440 (sky,
//! alpha 0.1, n·v 0.3 to 0.4): from one view the figure shows where lamps are, not the effect of
//! grazing angles.

use super::prelude::*;

pub const QUESTION: Question = Question {
    name: "n-dot-v",
    asks: "Where on a surface, and on which surface, does a method err?",
    columns: &[
        column("n_dot_v_from", "Least n·v of the bin."),
        column("n_dot_v_to", "Largest n·v of the bin."),
        column("n", "Number of environments."),
        column(
            "error",
            "Median over environments of the error over the bin's pixels, in the metric of the \
             question.",
        ),
        column(
            "error_lo",
            "Lower end of its 95 % interval over environments; empty below six environments.",
        ),
        column("error_hi", super::UPPER),
    ],
    lacks,
    answer,
    is_weighted: false,
    ..Question::PLAIN
};

fn lacks(shape: &Shape) -> Option<&'static str> {
    (!shape.is_swept(ALPHA)).then_some("axes.alpha has fewer than two values")
}

/// The error of a method in a bin of n·v, at one value of [`Frame::row_axis`].
struct BinError<'r, 'f> {
    variant: Variant,
    row_value: Value,
    bin: [f64; 2],
    error: Estimate,
    rows: Vec<&'r Row<'f>>,
}

/// The images of a method at one sample count.
struct VariantImages<'r, 'f> {
    variant: Variant,
    rows: Vec<&'r Row<'f>>,
}

/// The images of each method at the tried count nearest to the default; methods without samples
/// first.
fn nearest_to_default<'r, 'f>(frame: &'r Frame<'f>) -> Vec<VariantImages<'r, 'f>> {
    let mut rows = frame.images();
    rows.retain(|row| !row.cell.bins.is_empty() && !frame.is_nothing(row));
    // Without any specular term diffuse methods are compared.
    let method = frame.variant_axes()[0];
    let distance = |rows: &[&Row]| rows[0].samples().map_or(0.0, from_usual);
    let mut variants = Vec::new();
    for (_, rows) in grouped(rows, |row| row.point[method].clone()) {
        let nearest = grouped(rows, |row| frame.variant(row))
            .into_iter()
            .reduce(|a, b| {
                if distance(&b.1) < distance(&a.1) {
                    b
                } else {
                    a
                }
            });
        variants.extend(nearest.map(|(variant, rows)| VariantImages { variant, rows }));
    }
    variants.sort_by_key(|images| images.rows[0].samples().is_some());
    variants
}

/// The errors of a method by [`Frame::row_axis`] and bin.
fn bin_errors<'r, 'f>(frame: &Frame, images: &VariantImages<'r, 'f>) -> Vec<BinError<'r, 'f>> {
    let row_axis = frame.row_axis();
    let bins = images.rows.iter().flat_map(|row| row.cell.bins.iter());
    let bins = distinct_bins(bins.map(|bin| [bin.range.lo, bin.range.hi]));
    let mut found = Vec::new();
    for row_value in values(images.rows.iter().copied(), row_axis) {
        if row_value == Value::Unset {
            continue;
        }
        let mut rows = images.rows.clone();
        rows.retain(|row| row.point[row_axis] == row_value);
        for &bin in &bins {
            let by_light: Vec<(Value, f64)> = rows
                .iter()
                .filter_map(|row| {
                    let light = row.point[ENVIRONMENT].clone();
                    Some((light, bin_error(frame, row, bin)?))
                })
                .collect();
            if let Some(error) = estimate(&by_light, Middle::Median) {
                found.push(BinError {
                    variant: images.variant.clone(),
                    row_value: row_value.clone(),
                    bin,
                    error,
                    rows: rows.clone(),
                });
            }
        }
    }
    found
}

fn bin_error(frame: &Frame, row: &Row, bin: [f64; 2]) -> Option<f64> {
    let mut bins = row.cell.bins.iter();
    let known = bins.find(|known| known.range.lo == bin[0])?;
    let name = frame.metric_name();
    let floor = known.noise_floors.get(name);
    let noise_use = frame.run.noise_use();
    let score = noise_use.answered(frame.metric, known.scores.get(name)?, floor);
    Some(frame.metric.error(score)).filter(|error| error.is_finite())
}

/// Each bin once, ascending.
fn distinct_bins(all: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    let mut bins: Vec<[f64; 2]> = all.collect();
    bins.sort_by(|a, b| a[0].total_cmp(&b[0]));
    bins.dedup();
    bins
}

fn answer(frame: &Frame) -> Option<Finding> {
    let all: Vec<BinError> = nearest_to_default(frame)
        .iter()
        .flat_map(|images| bin_errors(frame, images))
        .collect();
    Some(Finding {
        sentences: sentences(frame, &all)?,
        table: table(frame, &all),
        digest: Some(digest(frame, &all)),
        figure: figure(frame, &all),
    })
}

fn table(frame: &Frame, all: &[BinError]) -> Table {
    let variant_axes = frame.variant_axes();
    let row_axis = frame.row_axis();
    let axes = [&variant_axes[..], &[row_axis]].concat();
    let mut table = Table::new(&axes, QUESTION.columns);
    for one in all {
        let [lo, hi] = match one.error.interval {
            Some(ends) => ends.map(Some),
            None => [None; 2],
        };
        let mut row = one.rows[0].cells(&variant_axes);
        row.extend(axis_cells(
            &[row_axis],
            std::slice::from_ref(&one.row_value),
        ));
        row.extend(cells![
            one.bin[0],
            one.bin[1].min(1.0),
            one.error.n,
            one.error.value,
            lo,
            hi
        ]);
        table.row(row);
    }
    table
}

fn sentences(frame: &Frame, all: &[BinError]) -> Option<Sentences> {
    let variant = &all.first()?.variant;
    let of_method = || all.iter().filter(|one| one.variant == *variant);
    let by_error = |a: &&BinError, b: &&BinError| a.error.value.total_cmp(&b.error.value);
    let most = of_method().max_by(by_error)?;
    let least = of_method().min_by(by_error)?;
    let condition = |one: &BinError| {
        let value = frame.names.phrase(frame.row_axis(), &one.row_value);
        statement![n_dot_v_words(one.bin), ", ", value]
    };
    let environments = (most.error.n != 1).then(|| {
        let n = Number::Count(most.error.n as u64);
        let plural = AXES[ENVIRONMENT].plural;
        statement![" (median of ", n, format!(" {plural})")]
    });
    let is_design = most.rows.iter().all(|row| is_design(&row.text(SCENE)));
    let has_several_views = [ENVIRONMENT_ORIENTATION, ENVIRONMENT_ROTATION, SCENE]
        .iter()
        .any(|axis| frame.shape.is_swept(*axis));
    let views = if is_design {
        statement!["On the scene ", Phrase::Code("design".to_owned())]
    } else if has_several_views {
        "In these views".into()
    } else {
        "In this view".into()
    };
    let headline = statement![
        views,
        ", ",
        Phrase::Method(variant.clone()),
        " errs most at ",
        condition(most),
        format!(": {} ", frame.metric_name()),
        Number::rounded(most.error.value),
        environments,
        "."
    ];
    let detail = statement![
        "It errs least at ",
        condition(least),
        ": ",
        Number::rounded(least.error.value),
        "."
    ];
    let has_one_view = !is_design && !has_several_views;
    let scope = has_one_view.then(|| {
        "Each n·v sees one part of the map, so the places of lamps matter as much as the method."
            .into()
    });
    Some(
        Sentences::new(headline)
            .with_details([detail])
            .with_scope(scope),
    )
}

/// A row of the digest.
#[derive(PartialEq, Eq, Hash)]
struct DigestKey {
    variant: Variant,
    row_value: Value,
}

/// One row per method and value of [`Frame::row_axis`], one column per bin.
fn digest(frame: &Frame, all: &[BinError]) -> Table {
    let row_axis = frame.row_axis();
    let bins = distinct_bins(all.iter().map(|one| one.bin));
    let mut heads = vec![AXES[METHOD].name.to_owned()];
    heads.extend(
        frame
            .names
            .heads(&[row_axis])
            .into_iter()
            .map(str::to_owned),
    );
    heads.extend(bins.iter().map(|bin| n_dot_v_words(*bin)));
    let mut table = Table::with_names(heads);
    let key = |one: &&BinError| DigestKey {
        variant: one.variant.clone(),
        row_value: one.row_value.clone(),
    };
    for (key, errors) in grouped(all, key) {
        let mut row = cells![&key.variant];
        row.extend(frame.names.head_of(row_axis, &key.row_value));
        for bin in &bins {
            let error = errors.iter().find(|one| one.bin == *bin);
            row.push(error.map(|one| estimated(&one.error)).into());
        }
        table.row(row);
    }
    table
}

/// One panel per method, one line per value of [`Frame::row_axis`]: the error over n·v.
fn figure(frame: &Frame, all: &[BinError]) -> Option<Figure> {
    let row_axis = frame.row_axis();
    let row_values = ascending(distinct_in_order(
        all.iter().map(|one| one.row_value.clone()),
    ));
    let mut panels = Vec::new();
    for (variant, errors) in grouped(all, |one| one.variant.clone()) {
        let mut marks = Vec::new();
        for (series, row_value) in row_values.iter().enumerate() {
            let line = errors.iter().filter(|one| one.row_value == *row_value);
            marks.extend(joined(line.map(|one| mark(frame, one, series)).collect()));
        }
        panels.push(ChartPanel {
            title: variant.label(),
            marks,
        });
    }
    let rest = if frame.swept(&[Part::Case]).len() > 1 {
        ", median over the rest"
    } else {
        ""
    };
    Chart {
        title: &format!("Error by n·v and {}", frame.names.name(row_axis)),
        note: format!("{}{rest}", frame.metric_name()),
        x: ChartAxis::Linear("n·v"),
        y: ChartAxis::Log(frame.metric_name()),
        panels,
        series: row_values
            .iter()
            .map(|value| solid(frame.names.value_label(row_axis, value)))
            .collect(),
    }
    .figure()
}

fn mark(frame: &Frame, one: &BinError, series: usize) -> Mark {
    let tip = format!(
        "{} · {} · {}: {}",
        one.variant.label(),
        frame.names.value_label(frame.row_axis(), &one.row_value),
        n_dot_v_words(one.bin),
        with_interval(&one.error)
    );
    let middle = 0.5 * (one.bin[0] + one.bin[1].min(1.0));
    let dot = Mark::new(Form::Dot([middle, one.error.value]), series).tip(tip);
    Mark {
        cell: only(&one.rows),
        ..dot
    }
}
