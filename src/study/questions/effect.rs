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

/// The parts of axes whose values are compared.
const COMPARED: [Part; 3] = [Part::Method, Part::Parameter, Part::Table];
const SENTENCES_MAX: usize = 2;

fn lacks(shape: &Shape) -> Option<&'static str> {
    // A sampling method has no partner without samples.
    let count_sampling = shape.methods().filter(|method| method.uses_samples).count();
    let count_fixed = shape.methods().count() - count_sampling;
    let has_parameter = AXES
        .ids()
        .any(|axis| COMPARED.contains(&AXES[axis].part) && axis != METHOD && shape.is_swept(axis));
    if has_parameter || count_sampling > 1 || count_fixed > 1 {
        None
    } else if shape.methods().count() > 1 {
        Some(
            "one method samples and the other does not, so that no two images share their samples: \
             ask break-even",
        )
    } else {
        Some("no axis of methods, their parameters or their tables has two values")
    }
}

/// An image, compared with the image of the base.
struct Effect<'r, 'f> {
    value: Value,
    row: &'r Row<'f>,
    ratio: f64,
    is_resolved: bool,
}

/// The effects of the values of an axis.
struct AxisEffects<'r, 'f> {
    axis: AxisId,
    base: Value,
    effects: Vec<Effect<'r, 'f>>,
}

/// The resolved ratios of a value.
struct ValueRatios<'r, 'f> {
    value: Value,
    ratios: Numbers<'r, 'f>,
}

/// The value with the least mean ratio.
struct Best<'r, 'f> {
    value: Value,
    ratios: Numbers<'r, 'f>,
    mean: Estimate,
}

impl<'r, 'f> AxisEffects<'r, 'f> {
    /// `None` without a pair.
    fn new(frame: &Frame, images: &[&'r Row<'f>], axis: AxisId) -> Option<Self> {
        let base = frame.shape.values[axis].first()?.clone();
        let mut effects = Vec::new();
        for (row, base) in pair(images, axis, &base) {
            let (Some(error), Some(base_error)) = (frame.error(row), frame.error(base)) else {
                continue;
            };
            let ratio = error / base_error;
            if ratio.is_finite() {
                effects.push(Effect {
                    value: row.point[axis].clone(),
                    row,
                    ratio,
                    is_resolved: frame.is_resolved(row) || frame.is_resolved(base),
                });
            }
        }
        (!effects.is_empty()).then_some(Self {
            axis,
            base,
            effects,
        })
    }

    /// In the order of the values, whichever of their ratios are resolved. Values without one are
    /// left out.
    fn resolved(&self) -> Vec<ValueRatios<'r, 'f>> {
        grouped(&self.effects, |effect| effect.value.clone())
            .into_iter()
            .filter_map(|(value, effects)| {
                let resolved: Vec<_> = effects
                    .iter()
                    .filter(|effect| effect.is_resolved)
                    .map(|effect| (effect.row, effect.ratio))
                    .collect();
                (!resolved.is_empty()).then(|| ValueRatios {
                    value,
                    ratios: Numbers::ratios(resolved),
                })
            })
            .collect()
    }

    /// ", 2 within the noise": environments beyond the n with a resolved ratio.
    fn unresolved(&self, n: usize) -> Option<Statement> {
        let ratios = self.effects.iter();
        let ratios = Numbers::ratios(ratios.map(|effect| (effect.row, effect.ratio)));
        let all = ratios.winning_environments().all;
        (all > n).then(|| {
            let unresolved = Number::Count((all - n) as u64);
            statement![", ", unresolved, " within the noise"]
        })
    }

    fn best(&self) -> Option<Best<'r, 'f>> {
        self.resolved()
            .into_iter()
            .filter_map(|ValueRatios { value, ratios }| {
                let mean = ratios.estimate()?;
                Some(Best {
                    value,
                    ratios,
                    mean,
                })
            })
            .reduce(|a, b| if b.mean.value < a.mean.value { b } else { a })
    }

    /// A value in code.
    fn phrase(&self, frame: &Frame, value: &Value) -> Phrase {
        let text = frame.names.in_sentence(self.axis, value);
        if self.axis == METHOD {
            Phrase::Method(Variant::new(text))
        } else {
            Phrase::Code(text)
        }
    }
}

fn answer(frame: &Frame) -> Option<Finding> {
    let images = frame.images();
    let all: Vec<AxisEffects> = frame
        .swept(&COMPARED)
        .into_iter()
        .filter_map(|axis| AxisEffects::new(frame, &images, axis))
        .collect();
    let first = all.first()?;
    Some(Finding {
        sentences: sentences(frame, &images, &all)?,
        table: table(frame, &all),
        digest: Some(digest(frame, &all)),
        figure: figure(frame, first),
    })
}

fn table(frame: &Frame, all: &[AxisEffects]) -> Table {
    let axes = frame.table_axes().into_iter();
    let axes = distinct_in_order(axes.chain([METHOD, SAMPLES, POINT_SET]));
    let mut table = Table::new(&axes, QUESTION.columns);
    for one in all {
        for effect in &one.effects {
            let mut row = effect.row.cells(&axes);
            row.extend(cells![
                AXES[one.axis].name,
                value_cell(one.axis, &effect.value),
                value_cell(one.axis, &one.base),
                effect.ratio,
                effect.is_resolved
            ]);
            table.row(row);
        }
    }
    table
}

/// One sentence for each of the first axes. A sentence names values of two axes only if some image
/// has both.
fn sentences(frame: &Frame, images: &[&Row], all: &[AxisEffects]) -> Option<Sentences> {
    let mut named: Vec<(AxisId, Value)> = Vec::new();
    let mut statements = Vec::new();
    for one in all {
        let best = one.best();
        let winner = match &best {
            Some(best) if best.mean.value < 1.0 => &best.value,
            _ => &one.base,
        };
        let has_all = |row: &&Row| {
            row.point[one.axis] == *winner
                && named.iter().all(|(axis, value)| {
                    row.point[*axis] == *value || row.point[*axis] == Value::Unset
                })
        };
        if statements.len() < SENTENCES_MAX && images.iter().any(has_all) {
            statements.push(statement_of_axis(frame, one, best.as_ref()));
            named.push((one.axis, winner.clone()));
        }
    }
    let resolved = all
        .first()?
        .effects
        .iter()
        .filter(|effect| effect.is_resolved)
        .map(|effect| (effect.row, effect.ratio));
    let scope = Numbers::ratios(resolved).scope(frame);
    statements.extend(left_out(all));
    let mut statements = statements.into_iter();
    let headline = statements.next()?;
    Some(
        Sentences::new(headline)
            .with_details(statements)
            .with_scope(scope),
    )
}

/// "26 of 2,400 ratios are within the noise of their references, and no mean contains them."
fn left_out(all: &[AxisEffects]) -> Option<Statement> {
    let is_resolved = all
        .iter()
        .flat_map(|one| &one.effects)
        .map(|effect| effect.is_resolved);
    let ratios = is_resolved.clone().count();
    let out = is_resolved.filter(|is_resolved| !is_resolved).count();
    (out > 0 && out < ratios).then(|| {
        let [out, ratios] = [out, ratios].map(|count| Number::Count(count as u64));
        let why = " ratios are within the noise of their references, and no mean contains them.";
        statement![out, " of ", ratios, why]
    })
}

fn statement_of_axis(frame: &Frame, one: &AxisEffects, best: Option<&Best>) -> Statement {
    let Some(best) = best else {
        let axis = Phrase::Code(AXES[one.axis].name.to_owned());
        return statement![axis, " has no effect above the reference's noise."];
    };
    let name = one.phrase(frame, &best.value);
    let base = one.phrase(frame, &one.base);
    let metric = Phrase::Metric(frame.metric_name());
    if let Some(change) = best.ratios.change_of_sign(frame) {
        let [better, worse] = sides(frame, &change);
        let axis = frame.names.name(change.axis);
        let less = statement![name, " has less ", metric, " than ", base];
        return statement![
            less,
            format!(" at {axis} "),
            better,
            ", and more at ",
            worse,
            "."
        ];
    }
    let times = estimated(&best.mean).unit(" times");
    let among = format!("Of the {}, ", frame.names.plural(one.axis));
    let wins = wins(frame, one, &best.ratios);
    let against_base = |times: Quantity| {
        statement![
            times,
            " the ",
            metric.clone(),
            " of ",
            base.clone(),
            wins.clone(),
            "."
        ]
    };
    if one.resolved().len() == 1 {
        statement![name, " has ", against_base(times.strong())]
    } else if best.mean.value < 1.0 {
        statement![among, name, " errs least: it has ", against_base(times)]
    } else {
        let next = statement![name, ", has ", times, " its ", metric, "."];
        statement![among, "the base ", base, " errs least; the next, ", next]
    }
}

/// "; less under 7 of 10 environments": where a value is better.
fn wins(frame: &Frame, one: &AxisEffects, ratios: &Numbers) -> Statement {
    let Wins { below, all } = ratios.winning_environments();
    let environments = AXES[ENVIRONMENT].plural;
    if all == 1 {
        let light = ratios.light(frame, "");
        let Wins { below, all } = ratios.winning_images();
        if below == 0 || below == all {
            return light;
        }
        return statement![
            light,
            "; less in ",
            Number::Count(below as u64),
            " of ",
            Number::Count(all as u64),
            " images"
        ];
    }
    let all_number = Number::Count(all as u64);
    let count = if below == 0 {
        statement!["; more under each of ", all_number]
    } else {
        let below = Number::Count(below as u64);
        statement!["; less under ", below, " of ", all_number]
    };
    statement![count, format!(" {environments}"), one.unresolved(all)]
}

/// By [`Frame::row_axis`] and environment for a single value; else one row per value.
fn digest(frame: &Frame, all: &[AxisEffects]) -> Table {
    let resolved: Vec<Vec<ValueRatios>> = all.iter().map(AxisEffects::resolved).collect();
    if let [only] = &resolved[..]
        && let [value] = &only[..]
    {
        return value.ratios.digest(frame, &with_interval);
    }
    let names = &frame.names;
    let row_axis = frame.row_axis();
    let rows = all.iter().flat_map(|one| &one.effects);
    let mut steps = values(rows.map(|effect| effect.row), row_axis);
    steps.retain(|value| *value != Value::Unset);
    let mut heads = ["axis", "value", "base"].map(str::to_owned).to_vec();
    heads.extend(steps.iter().map(|value| names.heading(row_axis, value)));
    heads.extend([ALL, "wins under"].map(str::to_owned));
    let mut table = Table::with_names(heads);
    for (one, values) in all.iter().zip(&resolved) {
        for ValueRatios { value, ratios } in values {
            let mut row = cells![
                AXES[one.axis].name,
                names.short_cell(one.axis, value),
                names.short_cell(one.axis, &one.base)
            ];
            for step in &steps {
                let ratios = ratios.with_value(row_axis, step);
                row.push(ratios.cell(frame, &|all| number(all.value)));
            }
            row.push(ratios.pooled(frame).as_ref().map(estimated).into());
            let Wins { below, all } = ratios.winning_environments();
            row.push(Cell::quantity(format!("{below} of {all}")));
            table.row(row);
        }
    }
    table.without_empty()
}

/// A value in a figure: a method by its label.
fn label(frame: &Frame, axis: AxisId, value: &Value) -> String {
    if axis == METHOD {
        Variant::new(value.to_string()).label()
    } else {
        frame.names.in_sentence(axis, value)
    }
}

/// As [`label`] of the base, but without units.
fn base_label(frame: &Frame, one: &AxisEffects) -> String {
    if one.axis == METHOD {
        label(frame, METHOD, &one.base)
    } else {
        frame.names.short(one.axis, &one.base)
    }
}

/// What the panels of the figure share.
struct Drawing<'a, 'f> {
    frame: &'a Frame<'f>,
    axis: AxisId,
    /// The compared values: a series each.
    compared: Vec<Value>,
    /// The values of the row axis.
    steps: Vec<Value>,
}

/// One panel per environment, after their mean: the ratio by [`Frame::row_axis`], one colour per
/// value.
fn figure(frame: &Frame, one: &AxisEffects) -> Option<Figure> {
    let row_axis = frame.row_axis();
    let drawing = Drawing {
        frame,
        axis: one.axis,
        compared: distinct_in_order(one.effects.iter().map(|effect| effect.value.clone())),
        steps: values(one.effects.iter().map(|effect| effect.row), row_axis),
    };
    let resolved = one.resolved();
    let first = match resolved.first() {
        Some(first) => first.ratios.clone(),
        None => Numbers::ratios([]),
    };
    let mut lights = Vec::new();
    for (light, effects) in grouped(&one.effects, |effect| effect.row.point[ENVIRONMENT].clone()) {
        let marks = drawing.images(effects);
        lights.push(LightMarks { light, marks });
    }
    Chart {
        title: &format!("Effect of {}", AXES[one.axis].name),
        note: format!(
            "Error over the error of {}; below 1 is better{}",
            base_label(frame, one),
            if first.has_interval() { INTERVAL } else { "" }
        ),
        x: ChartAxis::values(frame, row_axis, &drawing.steps),
        y: ChartAxis::Log(&format!("{} over the base", frame.metric_name())),
        panels: light_panels(frame, &first, || drawing.averages(&resolved), lights),
        series: drawing
            .compared
            .iter()
            .map(|value| {
                let name = label(frame, one.axis, value);
                if one.axis == METHOD {
                    method_series(name, value.text(), false)
                } else {
                    solid(name)
                }
            })
            .collect(),
    }
    .figure()
}

impl Drawing<'_, '_> {
    fn series(&self, value: &Value) -> usize {
        step(&self.compared, value) as usize
    }

    /// "Split sum (textbook), alpha 0.1".
    fn name(&self, value: &Value, row_value: &Value) -> String {
        let names = &self.frame.names;
        format!(
            "{}, {}",
            label(self.frame, self.axis, value),
            names.in_sentence(self.frame.row_axis(), row_value)
        )
    }

    /// The mean over environments of each value.
    fn averages(&self, resolved: &[ValueRatios]) -> Vec<Mark> {
        let row_axis = self.frame.row_axis();
        let mut marks = vec![Mark::neutral(Form::HorizontalRule(1.0))];
        for ValueRatios { value, ratios } in resolved {
            let mut dots = Vec::new();
            for (index, row_value) in self.steps.iter().enumerate() {
                dots.extend(ratios.with_value(row_axis, row_value).marks(
                    self.series(value),
                    &self.name(value, row_value),
                    |ratio| [index as f64, ratio],
                    &with_interval,
                ));
            }
            marks.extend(joined(dots));
        }
        marks
    }

    /// The images under one environment.
    fn images(&self, effects: Vec<&Effect>) -> Vec<Mark> {
        let row_axis = self.frame.row_axis();
        let mut marks = vec![Mark::neutral(Form::HorizontalRule(1.0))];
        for (value, effects) in grouped(effects, |effect| effect.value.clone()) {
            let mut by_step = grouped(effects, |effect| {
                step(&self.steps, &effect.row.point[row_axis]) as usize
            });
            by_step.sort_by_key(|(index, _)| *index);
            let mut dots = Vec::new();
            for (index, effects) in by_step {
                let ratios: Vec<f64> = effects.iter().map(|effect| effect.ratio).collect();
                let ratio = geometric_mean(&ratios);
                let name = self.name(&value, &self.steps[index]);
                let tip = format!("{name}: {} times", number(ratio));
                let position = [index as f64, ratio];
                dots.push(dot(position, self.series(&value), tip, effects[0].row));
            }
            marks.extend(joined(dots));
        }
        marks
    }
}
