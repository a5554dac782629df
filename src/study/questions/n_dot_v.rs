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

struct Place<'r, 'f> {
    method: String,
    width: Value,
    bin: [f64; 2],
    error: Estimate,
    rows: Vec<&'r Row<'f>>,
}

/// The images of each method at the tried count nearest to the default; methods without samples
/// first.
fn leading<'r, 'f>(frame: &'r Frame<'f>) -> Vec<(String, Vec<&'r Row<'f>>)> {
    let distance = |row: &Row| row.samples().map_or(0.0, from_usual);
    let is_asked = |row: &&Row| !row.cell.bins.is_empty() && !frame.is_nothing(row);
    let rows = frame.images().into_iter().filter(is_asked);
    let nearest = |(_, ways): (Value, Vec<&'r Row<'f>>)| {
        let ways = grouped(ways, |row| frame.way(row));
        ways.into_iter().reduce(|a, b| {
            if distance(b.1[0]) < distance(a.1[0]) {
                b
            } else {
                a
            }
        })
    };
    // Without any specular term diffuse methods are compared.
    let method = frame.way_axes()[0];
    let mut found: Vec<_> = grouped(rows, |row| row.point[method].clone())
        .into_iter()
        .filter_map(nearest)
        .collect();
    found.sort_by_key(|(_, rows)| rows[0].samples().is_some());
    found
}

fn places<'r, 'f>(frame: &Frame, method: &str, rows: &[&'r Row<'f>]) -> Vec<Place<'r, 'f>> {
    let bins = bins(
        rows.iter()
            .flat_map(|row| row.cell.bins.iter())
            .map(|bin| [bin.lo, bin.hi]),
    );
    let mut found = Vec::new();
    let of = frame.row_axis();
    for width in values(rows.iter().copied(), of)
        .into_iter()
        .filter(|width| *width != Value::Unset)
    {
        let own: Vec<&Row> = rows
            .iter()
            .copied()
            .filter(|row| row.point[of] == width)
            .collect();
        for &bin in &bins {
            let error = |row: &&Row| {
                let known = row.cell.bins.iter().find(|known| known.lo == bin[0])?;
                let error = frame.metric.error(known.scores.get(frame.metric_name())?);
                error
                    .is_finite()
                    .then(|| (row.point[ENVIRONMENT].clone(), error))
            };
            let error = estimate(
                &own.iter().filter_map(error).collect::<Vec<_>>(),
                Middle::Median,
            );
            let place = |error| Place {
                method: method.to_owned(),
                width: width.clone(),
                bin,
                error,
                rows: own.clone(),
            };
            found.extend(error.map(place));
        }
    }
    found
}

fn bins(all: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    let mut bins: Vec<[f64; 2]> = all.collect();
    bins.sort_by(|a, b| a[0].total_cmp(&b[0]));
    bins.dedup();
    bins
}

fn answer(frame: &Frame) -> Option<Finding> {
    let all: Vec<Place> = leading(frame)
        .into_iter()
        .flat_map(|(method, rows)| places(frame, &method, &rows))
        .collect();
    let ways = frame.way_axes();
    let of = frame.row_axis();
    let mut table = Table::new(&[&ways[..], &[of]].concat(), QUESTION.columns);
    for place in &all {
        let [lo, hi] = place
            .error
            .interval
            .map_or([None; 2], |ends| ends.map(Some));
        let own = cells![
            place.bin[0],
            place.bin[1].min(1.0),
            place.error.n,
            place.error.value,
            lo,
            hi
        ];
        let key = axis_cells(&[of], std::slice::from_ref(&place.width));
        table.row([place.rows[0].cells(&ways), key, own].concat());
    }
    let bins = bins(all.iter().map(|place| place.bin));
    Some(Finding {
        sentence: sentence(frame, &all)?,
        table,
        digest: Some(digest(frame, &all, &bins)),
        figure: figure(frame, &all),
    })
}

fn sentence(frame: &Frame, all: &[Place]) -> Option<String> {
    let lead = &all.first()?.method;
    let own = || all.iter().filter(|place| place.method == *lead);
    let by_error = |a: &&Place, b: &&Place| a.error.value.total_cmp(&b.error.value);
    let (most, least) = (own().max_by(by_error)?, own().min_by(by_error)?);
    let place = |place: &Place| {
        format!(
            "{}, {}",
            view(place.bin),
            frame.names.one(frame.row_axis(), &place.width)
        )
    };
    let over = match most.error.n {
        1 => String::new(),
        n => format!(" (median of {n} {})", AXES[ENVIRONMENT].plural),
    };
    let is_design = most.rows.iter().all(|row| is_design(&row.text(SCENE)));
    let turns = [ENVIRONMENT_ORIENTATION, ENVIRONMENT_ROTATION, SCENE]
        .iter()
        .any(|of| frame.shape.is_swept(*of));
    let (scope, end) = match () {
        () if is_design => ("On the scene `design`", ""),
        () if turns => ("In these views", ""),
        () => (
            "In this view",
            " Each n·v sees one part of the map, so the places of lamps matter as much as the \
             method.",
        ),
    };
    Some(format!(
        "{scope}, `{lead}` errs most at {}: {} {}{over}. It errs least at {}: {}.{end}",
        place(most),
        frame.metric_name(),
        number(most.error.value),
        place(least),
        number(least.error.value)
    ))
}

/// One row per method and value of [`Frame::row_axis`], one column per bin.
fn digest(frame: &Frame, all: &[Place], bins: &[[f64; 2]]) -> Table {
    let of = [frame.row_axis()];
    let first = std::iter::once(AXES[METHOD].name)
        .chain(frame.names.heads(&of))
        .map(str::to_owned);
    let mut table = Table::with_names(first.chain(bins.iter().map(|bin| view(*bin))));
    for ((method, width), own) in grouped(all, |place| (place.method.clone(), place.width.clone()))
    {
        let place = |bin: &[f64; 2]| own.iter().find(|place| place.bin == *bin);
        let cells = bins
            .iter()
            .map(|bin| Cell::from(place(bin).map(|place| with_interval(&place.error))));
        table.row(
            cells![method]
                .into_iter()
                .chain(frame.names.head(&of, &[width]))
                .chain(cells)
                .collect(),
        );
    }
    table
}

/// One panel per method, one line per value of [`Frame::row_axis`]: the error over n·v.
fn figure(frame: &Frame, all: &[Place]) -> Option<Figure> {
    let (of, names) = (frame.row_axis(), &frame.names);
    let widths = ascending(distinct_in_order(
        all.iter().map(|place| place.width.clone()),
    ));
    let mark = |place: &Place, series: usize| {
        let Place {
            method,
            width,
            bin,
            error,
            rows,
        } = place;
        let tip = format!(
            "{method} · {} · {}: {}",
            names.one(of, width),
            view(*bin),
            with_interval(error)
        );
        let dot = Mark::new(
            Form::Dot([0.5 * (bin[0] + bin[1].min(1.0)), error.value]),
            series,
        )
        .tip(tip);
        Mark {
            cell: only(rows),
            ..dot
        }
    };
    let panel = |(method, own): (String, Vec<&Place>)| {
        let line = |(series, width): (usize, &Value)| {
            joined(
                own.iter()
                    .filter(|place| place.width == *width)
                    .map(|place| mark(place, series))
                    .collect(),
            )
        };
        (method, widths.iter().enumerate().flat_map(line).collect())
    };
    let rest = if frame.swept(&[Part::Case]).len() > 1 {
        ", median over the rest"
    } else {
        ""
    };
    let chart = Chart {
        title: &format!("Error by n·v and {}", names.name(of)),
        note: format!("{}{rest}", frame.metric_name()),
        x: Along::Linear("n·v"),
        y: Along::Log(frame.metric_name()),
        panels: grouped(all, |place| place.method.clone())
            .into_iter()
            .map(panel)
            .collect(),
        series: widths.iter().map(|width| names.one(of, width)).collect(),
    };
    chart.figure()
}
