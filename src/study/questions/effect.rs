//! Is one way to make an image better than another, and where?
//!
//! For a swept axis of methods, of their parameters or of their tables, the first value is the
//! base. Each image with another value is paired with the image that has the base and agrees on all
//! other axes ([`pair`]). The *effect* is the ratio of their errors: below 1 the value is better.
//! It is averaged geometrically over environments, but never over an axis along which it is below 1
//! here and above 1 there. Pairs with both errors within the reference's noise do not count. A
//! sentence names values of two axes only if some image has both.

use super::prelude::*;

pub const QUESTION: Question = Question {
    name: "effect",
    asks: "Is one way to make the image better than another, and where?",
    columns: &[
        column("axis", "The axis whose value changes."),
        column("value", "The value that is compared."),
        column("base", "The first value of the axis."),
        column(
            "ratio",
            "Error over the error of the base; below 1 the value is closer to the reference.",
        ),
        column(
            "is_resolved",
            "1 if one of the two errors is resolved against the reference's noise, else 0.",
        ),
    ],
    lacks,
    answer,
    ..Question::PLAIN
};

const WAYS: [Part; 3] = [Part::Method, Part::Parameter, Part::Table];
const SENTENCES_MAX: usize = 2;

fn lacks(shape: &Shape) -> Option<&'static str> {
    // A sampling method has no partner without samples.
    let has_two = |draws: bool| {
        shape
            .methods()
            .filter(|method| method.uses_samples == draws)
            .count()
            > 1
    };
    let is_way =
        |axis: AxisId| WAYS.contains(&AXES[axis].part) && axis != METHOD && shape.is_swept(axis);
    match AXES.ids().any(is_way) || has_two(true) || has_two(false) {
        true => None,
        false if shape.methods().count() > 1 => Some(
            "one method samples and the other does not, so that no two images share their samples: \
             ask break-even",
        ),
        false => Some("no axis of methods, their parameters or their tables has two values"),
    }
}

/// An image, compared with the image of the base.
struct Effect<'r, 'f> {
    value: Value,
    row: &'r Row<'f>,
    ratio: f64,
    is_resolved: bool,
}

struct OfAxis<'r, 'f> {
    axis: AxisId,
    base: Value,
    effects: Vec<Effect<'r, 'f>>,
}

impl<'r, 'f> OfAxis<'r, 'f> {
    fn new(frame: &Frame, images: &[&'r Row<'f>], axis: AxisId) -> Option<Self> {
        let base = frame.shape.values[axis].first()?.clone();
        let effect = |(row, base): (&'r Row<'f>, &'r Row<'f>)| {
            let ratio = frame.error(row)? / frame.error(base)?;
            let is_resolved = frame.is_resolved(row) || frame.is_resolved(base);
            ratio.is_finite().then_some(Effect {
                value: row.point[axis].clone(),
                row,
                ratio,
                is_resolved,
            })
        };
        let effects: Vec<Effect> = pair(images, axis, &base)
            .into_iter()
            .filter_map(effect)
            .collect();
        (!effects.is_empty()).then_some(Self {
            axis,
            base,
            effects,
        })
    }

    fn resolved(&self) -> Vec<(Value, Numbers<'r, 'f>)> {
        let resolved = self.effects.iter().filter(|effect| effect.is_resolved);
        let numbers = |(value, own): (Value, Vec<&Effect<'r, 'f>>)| {
            (
                value,
                Numbers::ratios(own.iter().map(|effect| (effect.row, effect.ratio))),
            )
        };
        grouped(resolved, |effect| effect.value.clone())
            .into_iter()
            .map(numbers)
            .collect()
    }

    /// ", 2 within the noise": environments beyond the n with a resolved ratio.
    fn unresolved(&self, n: usize) -> String {
        let [_, all] =
            Numbers::ratios(self.effects.iter().map(|effect| (effect.row, effect.ratio))).wins();
        if all > n {
            format!(", {} within the noise", all - n)
        } else {
            String::new()
        }
    }

    fn best(&self) -> Option<Best<'r, 'f>> {
        let rivals = self
            .resolved()
            .into_iter()
            .filter_map(|(value, own)| Some((value, own.estimate()?, own)));
        let best = rivals.reduce(|a, b| if b.1.value < a.1.value { b } else { a });
        best.map(|(value, ratio, own)| (value, own, ratio))
    }
}

/// A value, its ratios, and their mean.
type Best<'r, 'f> = (Value, Numbers<'r, 'f>, Estimate);

fn answer(frame: &Frame) -> Option<Finding> {
    let images = frame.images();
    let all: Vec<OfAxis> = frame
        .swept(&WAYS)
        .into_iter()
        .filter_map(|axis| OfAxis::new(frame, &images, axis))
        .collect();
    let mut axes = frame.table_axes();
    axes.extend(
        [METHOD, SAMPLES, POINT_SET]
            .iter()
            .filter(|known| !axes.contains(known))
            .collect::<Vec<_>>(),
    );
    let mut table = Table::new(&axes, QUESTION.columns);
    for (of, effect) in all
        .iter()
        .flat_map(|of| of.effects.iter().map(move |effect| (of, effect)))
    {
        let own = cells![
            AXES[of.axis].name,
            &effect.value,
            &of.base,
            effect.ratio,
            effect.is_resolved
        ];
        table.row([effect.row.cells(&axes), own].concat());
    }
    let lead = all.first()?;
    let resolved = lead
        .effects
        .iter()
        .filter(|effect| effect.is_resolved)
        .map(|effect| (effect.row, effect.ratio));
    let scope = Numbers::ratios(resolved).scope(frame);
    let (mut named, mut sentences): (Vec<(AxisId, Value)>, Vec<String>) = (Vec::new(), Vec::new());
    for of in &all {
        let best = of.best();
        let winner = best
            .as_ref()
            .filter(|(.., ratio)| ratio.value < 1.0)
            .map_or(&of.base, |(value, ..)| value);
        let goes = |row: &Row| {
            named
                .iter()
                .all(|(axis, value)| [value, &Value::Unset].contains(&&row.point[*axis]))
        };
        if sentences.len() < SENTENCES_MAX
            && images
                .iter()
                .any(|row| row.point[of.axis] == *winner && goes(row))
        {
            sentences.push(sentence(frame, of, best.as_ref()));
            named.push((of.axis, winner.clone()));
        }
    }
    Some(Finding {
        sentence: sentences.join(" ") + &scope,
        table,
        digest: Some(digest(frame, &all)),
        figure: figure(frame, lead),
    })
}

fn sentence(frame: &Frame, of: &OfAxis, best: Option<&Best>) -> String {
    let Some((value, numbers, ratio)) = best else {
        return format!(
            "`{}` has no effect above the reference's noise.",
            AXES[of.axis].name
        );
    };
    let [name, base] =
        [value, &of.base].map(|value| format!("`{}`", frame.names.said(of.axis, value)));
    let metric = frame.metric_name();
    if let Some((along, groups)) = numbers.change_of_sign(frame) {
        let ([better, worse], along) = (sides(frame, along, &groups), frame.names.name(along));
        return format!(
            "{name} has less `{metric}` than {base} at {along} {better}, and more at {worse}."
        );
    }
    let (times, interval) = (number(ratio.value), interval_words(ratio, number));
    let wins = match numbers.wins() {
        [_, 1] => match numbers.less() {
            [less, n] if less > 0 && less < n => {
                format!("{}; less in {less} of {n} images", numbers.place(frame, ""))
            }
            _ => numbers.place(frame, ""),
        },
        [0, n] => format!(
            "; more under each of {n} {}{}",
            AXES[ENVIRONMENT].plural,
            of.unresolved(n)
        ),
        [wins, n] => format!(
            "; less under {wins} of {n} {}{}",
            AXES[ENVIRONMENT].plural,
            of.unresolved(n)
        ),
    };
    let tried = of.resolved().len();
    let among = format!("Of the {}", frame.names.plural(of.axis));
    match tried {
        1 => format!("{name} has **{times} times**{interval} the `{metric}` of {base}{wins}."),
        _ if ratio.value < 1.0 => {
            format!(
                "{among}, {name} errs least: it has {times} times{interval} the `{metric}` of \
                 {base}{wins}."
            )
        }
        _ => {
            format!(
                "{among}, the base {base} errs least; the next, {name}, has {times} \
                 times{interval} its `{metric}`."
            )
        }
    }
}

/// By [`Frame::row_axis`] and environment for a single value; else one row per value.
fn digest(frame: &Frame, all: &[OfAxis]) -> Table {
    let words = &with_interval;
    let resolved: Vec<_> = all.iter().map(|of| (of, of.resolved())).collect();
    if let [(_, only)] = &resolved[..]
        && let [(_, numbers)] = &only[..]
    {
        return numbers.digest(frame, words);
    }
    let (along, names) = (frame.row_axis(), &frame.names);
    let mut widths = values(
        all.iter()
            .flat_map(|of| &of.effects)
            .map(|effect| effect.row),
        along,
    );
    widths.retain(|width| *width != Value::Unset);
    let heads = widths.iter().map(|width| names.heading(along, width));
    let first = ["axis", "value", "base"]
        .map(str::to_owned)
        .into_iter()
        .chain(heads);
    let mut table = Table::with_names(first.chain([ALL, "wins under"].map(str::to_owned)));
    for (of, value, numbers) in resolved
        .iter()
        .flat_map(|(of, own)| own.iter().map(move |(value, n)| (of, value, n)))
    {
        let mut row = cells![
            AXES[of.axis].name,
            names.short(of.axis, value),
            names.short(of.axis, &of.base)
        ];
        row.extend(widths.iter().map(|width| {
            numbers
                .at(along, width)
                .cell(frame, &|all| number(all.value))
        }));
        row.push(numbers.pooled(frame).map(|all| words(&all)).into());
        let [wins, n] = numbers.wins();
        row.push(format!("{wins} of {n}").into());
        table.row(row);
    }
    table.without_empty()
}

/// One panel per environment, after their mean: the ratio by [`Frame::row_axis`], one colour per
/// value.
fn figure(frame: &Frame, of: &OfAxis) -> Option<Figure> {
    let judged = distinct_in_order(of.effects.iter().map(|effect| effect.value.clone()));
    let (along, names) = (frame.row_axis(), &frame.names);
    let widths = values(of.effects.iter().map(|effect| effect.row), along);
    let panel = |(light, own): (Value, Vec<&Effect>)| {
        let mut marks = vec![Mark::neutral(Form::HorizontalRule(1.0))];
        for (value, own) in grouped(own, |effect| effect.value.clone()) {
            let mut by_width = grouped(own, |effect| effect.row.point[along].clone());
            by_width.sort_by(|(a, _), (b, _)| step(&widths, a).total_cmp(&step(&widths, b)));
            let dots = by_width.iter().map(|(width, own)| {
                let ratio =
                    geometric_mean(&own.iter().map(|effect| effect.ratio).collect::<Vec<_>>());
                let tip = format!(
                    "{}, {}: {} times",
                    names.said(of.axis, &value),
                    names.said(along, width),
                    number(ratio)
                );
                dot(
                    [step(&widths, width), ratio],
                    step(&judged, &value) as usize,
                    tip,
                    own[0].row,
                )
            });
            marks.extend(joined(dots.collect()));
        }
        (light, marks)
    };
    let resolved = of.resolved();
    let summed = || {
        let line = |(value, own): &(Value, Numbers)| {
            let dots = widths.iter().flat_map(|width| {
                let name = format!(
                    "{}, {}",
                    names.said(of.axis, value),
                    names.said(along, width)
                );
                let at = |ratio: f64| [step(&widths, width), ratio];
                own.at(along, width).marks(
                    step(&judged, value) as usize,
                    at,
                    (&name, &with_interval),
                )
            });
            joined(dots.collect())
        };
        std::iter::once(Mark::neutral(Form::HorizontalRule(1.0)))
            .chain(resolved.iter().flat_map(line))
            .collect()
    };
    let lead = resolved
        .first()
        .map_or_else(|| Numbers::ratios([]), |(_, own)| own.clone());
    let lights = grouped(&of.effects, |effect| effect.row.point[ENVIRONMENT].clone())
        .into_iter()
        .map(panel)
        .collect();
    Chart {
        title: &format!("Effect of {}", AXES[of.axis].name),
        note: format!(
            "Error over the error of {}; below 1 is better{}",
            names.short(of.axis, &of.base),
            if lead.is_summed() { INTERVAL } else { "" }
        ),
        x: Along::values(frame, along, &widths),
        y: Along::Log(&format!("{} over the base", frame.metric_name())),
        panels: light_panels(frame, &lead, summed, lights),
        series: judged
            .iter()
            .map(|value| names.said(of.axis, value))
            .collect(),
    }
    .figure()
}
