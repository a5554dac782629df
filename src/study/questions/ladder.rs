//! At which step does the split sum's error arise?
//!
//! The rungs of the ladder lead from the reference to the split sum; each replaces one exact step by its approximation
//! ([`LADDER`], docs/estimators.md). In a case (environment, model, alpha, f0) let E_i be the images of the rungs, `δ_i = E_i - E_(i-1)`,
//! `e = Σ δ_i` and `w = 1/(r² + ε)` with r = E_0, as in `relmse`. The *share* of a step is `Σ w δ_i e / Σ w e²` over all pixels and channels.
//! Shares sum to 1; a negative one cancels error of the others. Means are over environments, with Student's interval.
//!
//! Rungs draw the same points, so that their noise cancels in δ. It is read from the images of the run: a published run has none.

use super::prelude::*;
use crate::metrics::attribution::{Step, steps};
use crate::pixels::{Decoded, exr};
use crate::shade::method::ladder::LADDER;
use crate::study::frame::estimate::CLUSTERS_MIN;
use crate::study::frame::line::t_95;

pub const QUESTION: Question = Question {
    name: "ladder",
    asks: "At which step does the split sum's error arise?",
    columns: &[
        column("step", "What is approximated: Fresnel, masking, view (n = v = r), levels, tables."),
        column(
            "share",
            "Covariance share of the split sum's error; shares of a case sum to 1, a negative one cancels others.",
        ),
        column("error", "relmse of the image after the step against the reference with the same points."),
    ],
    uses_times: false,
    lacks,
    answer,
};

fn lacks(shape: &Shape) -> Option<&'static str> {
    let has_all = LADDER.iter().all(|(rung, _)| shape.methods().any(|method| method.name == *rung));
    (!has_all).then_some(
        "axes.method does not have every rung: reference, ladder-fresnel, -masking, -view, -levels, split-sum",
    )
}

/// A case, by the row of its split sum.
struct Case<'r, 'f> {
    row: &'r Row<'f>,
    steps: Vec<Step>,
}

fn cases<'r, 'f>(frame: &Frame, images: &[&'r Row<'f>]) -> Vec<Case<'r, 'f>> {
    let others: Vec<usize> =
        (0..AXES.len()).filter(|of| AXES[*of].changes_radiance() && ![METHOD, SAMPLES].contains(of)).collect();
    let case = |row: &'r Row<'f>| {
        let rung = |(name, _): &(&str, &str)| -> Option<Decoded> {
            let own =
                images.iter().filter(|one| one.text(METHOD) == *name && fits(&one.key(&others), &row.key(&others)));
            let most = own.max_by_key(|one| one.samples())?;
            exr::read(&frame.run.dir.join("images").join(&most.cell.images.as_ref()?.radiance)).ok()
        };
        let chain = LADDER.iter().map(rung).collect::<Option<Vec<Decoded>>>()?;
        let mask = chain[0].alpha.as_ref()?;
        let found =
            steps(&chain.iter().map(|image| &image.rgb).collect::<Vec<_>>(), mask, frame.run.epsilon(&row.point));
        found.iter().all(|step| step.share.is_finite()).then_some(Case { row, steps: found })
    };
    let (last, _) = LADDER[LADDER.len() - 1];
    // An error within the reference's noise has no steps: constant light, where the split is exact.
    let is_told = |row: &&&'r Row<'f>| row.text(METHOD) == last && frame.is_resolved(row);
    images.iter().filter(is_told).filter_map(|row| case(row)).collect()
}

/// A mean over environments.
struct Mean {
    value: f64,
    /// Half of the 95 % interval; nothing for too few environments.
    half: Option<f64>,
}

/// The mean share of a step; measured environments alone where they are enough.
fn mean(cases: &[&Case], step: usize) -> Mean {
    let by_light = grouped(cases.iter().copied(), |case| case.row.point[ENVIRONMENT].clone());
    let measured: Vec<_> = by_light.iter().filter(|(light, _)| !is_formula(light)).collect();
    let own = if measured.len() >= CLUSTERS_MIN { measured } else { by_light.iter().collect() };
    let of_light =
        |(_, own): &&(Value, Vec<&Case>)| own.iter().map(|case| case.steps[step].share).sum::<f64>() / own.len() as f64;
    let shares: Vec<f64> = own.iter().map(of_light).collect();
    let n = shares.len() as f64;
    let value = shares.iter().sum::<f64>() / n;
    let variance = shares.iter().map(|share| (share - value).powi(2)).sum::<f64>() / (n - 1.0);
    Mean { value, half: (shares.len() >= CLUSTERS_MIN).then(|| t_95(shares.len() - 1) * (variance / n).sqrt()) }
}

/// Names of the steps.
fn names() -> Vec<&'static str> {
    LADDER.iter().skip(1).map(|(_, step)| *step).collect()
}

fn answer(frame: &Frame) -> Option<Finding> {
    let images = frame.images();
    let cases = cases(frame, &images);
    let axes = frame.case_axes();
    let mut table = Table::new(&axes, QUESTION.columns);
    for case in &cases {
        for (name, step) in names().into_iter().zip(&case.steps) {
            table.row([case.row.cells(&axes), cells![name, step.share, step.relmse]].concat());
        }
    }
    let groups = groups(frame, &cases);
    Some(Finding {
        sentence: sentence(frame, &groups, &cases)?,
        digest: Some(digest(&groups)),
        figure: figure(&groups),
        table,
    })
}

/// The cases of one model, f0 and whatever else is no light, by alpha.
struct Group<'c, 'r, 'f> {
    /// "ggx · F0 1".
    name: String,
    alpha: Value,
    cases: Vec<&'c Case<'r, 'f>>,
}

fn groups<'c, 'r, 'f>(frame: &Frame, cases: &'c [Case<'r, 'f>]) -> Vec<Group<'c, 'r, 'f>> {
    let others: Vec<usize> = frame.case_axes().into_iter().filter(|of| ![ALPHA, ENVIRONMENT].contains(of)).collect();
    let of_name = |(key, own): (Key, Vec<&'c Case<'r, 'f>>)| {
        let mut by_alpha = grouped(own, |case| case.row.point[ALPHA].clone());
        by_alpha.sort_by(|(a, _), (b, _)| size_of(a).partial_cmp(&size_of(b)).unwrap_or(std::cmp::Ordering::Equal));
        let name = label(&others, &key);
        by_alpha.into_iter().map(move |(alpha, cases)| Group { name: name.clone(), alpha, cases })
    };
    grouped(cases, |case| case.row.key(&others)).into_iter().flat_map(of_name).collect()
}

fn sentence(frame: &Frame, groups: &[Group], cases: &[Case]) -> Option<String> {
    let share = |group: &Group, step: usize| mean(&group.cases, step).value;
    let total = |step: usize| groups.iter().map(|group| share(group, step)).sum::<f64>();
    let lead = (0..names().len()).max_by(|a, b| total(*a).total_cmp(&total(*b)))?;
    let least = groups.iter().min_by(|a, b| share(a, lead).total_cmp(&share(b, lead)))?;
    let most = groups.iter().max_by(|a, b| share(a, lead).total_cmp(&share(b, lead)))?;
    let place = |group: &Group| joined_words(&[group.name.clone(), heading(ALPHA, &group.alpha)]);
    let lights = Numbers::new(cases.iter().map(|case| (case.row, 1.0)), Middle::GeometricMean);
    let mut text = format!(
        "**The {} makes {}** of the split sum's `relmse` ({})",
        says(names()[lead]),
        percent(share(least, lead)),
        place(least)
    );
    if groups.len() > 1 {
        text = format!(
            "**The {} makes {} to {}** of the split sum's `relmse`, least at {}.",
            says(names()[lead]),
            percent(share(least, lead)),
            percent(share(most, lead)),
            place(least),
        );
    } else {
        text += ".";
    }
    let other =
        (0..names().len()).filter(|step| *step != lead).flat_map(|step| groups.iter().map(move |group| (step, group)));
    let next = other.max_by(|(a, one), (b, two)| share(one, *a).abs().total_cmp(&share(two, *b).abs()));
    if let Some((step, group)) = next {
        text += &format!(
            " The next largest share is {} of {}, at {}.",
            percent(share(group, step)),
            names()[step],
            place(group)
        );
    }
    Some(text + &lights.scope(&frame.case_axes()))
}

/// A step in a sentence.
fn says(step: &str) -> String {
    if step == "view" { "step n = v = r".to_owned() } else { format!("step of {step}") }
}

fn joined_words(words: &[String]) -> String {
    words.iter().filter(|word| !word.is_empty()).cloned().collect::<Vec<_>>().join(", ")
}

/// Shares below this are written as 0.
const NOISE: f64 = 5e-4;

/// "97 % ± 3", "-2.1 %".
fn told(mean: &Mean) -> String {
    let rounded = |share: f64| if share.abs() < NOISE { 0.0 } else { share };
    let half = mean.half.map_or(String::new(), |half| format!(" ± {}", number(100.0 * rounded(half))));
    format!("{}{half}", percent(rounded(mean.value)))
}

fn digest(groups: &[Group]) -> Table {
    let heads = ["case", AXES[ALPHA].name, ROUGHNESS].into_iter().map(str::to_owned);
    let mut table = Table::with_names(heads.chain(names().into_iter().map(str::to_owned)));
    for group in groups {
        let head = cells![group.name.as_str(), short(ALPHA, &group.alpha), roughness(&group.alpha)];
        let shares = (0..names().len()).map(|step| Cell::from(told(&mean(&group.cases, step))));
        table.row(head.into_iter().chain(shares).collect());
    }
    table.without_empty()
}

/// Bars of shares by alpha, one panel a model: to the right of 0 what adds error, to the left what cancels it.
fn figure(groups: &[Group]) -> Option<Figure> {
    let alphas = ascending(distinct_in_order(groups.iter().map(|group| group.alpha.clone())));
    let marks = |group: &Group| {
        let (y, mut ends) = (step(&alphas, &group.alpha), [0.0, 0.0]);
        let bar = |i: usize| {
            let mean = mean(&group.cases, i);
            let end = &mut ends[usize::from(mean.value < 0.0)];
            let base = *end;
            *end += mean.value;
            let tip = format!("{}: {} · {}", names()[i], told(&mean), heading(ALPHA, &group.alpha));
            Mark::new(Form::HorizontalBar { y, base, to: base + mean.value }, i).tip(tip)
        };
        (0..names().len()).map(bar).collect::<Vec<_>>()
    };
    let panels = grouped(groups, |group| group.name.clone());
    let panel = |(name, own): (String, Vec<&Group>)| {
        let rule = [Mark::neutral(Form::VerticalRule(0.0)), Mark::neutral(Form::VerticalRule(1.0))];
        (name, own.into_iter().flat_map(marks).chain(rule).collect())
    };
    Chart {
        title: "Where the split sum's error comes from",
        note: "share of relmse by step, mean over environments; left of 0 a step cancels error".to_owned(),
        x: Along::Linear("share of the error"),
        y: Along::Steps("", alphas.iter().map(|alpha| heading(ALPHA, alpha)).collect()),
        panels: panels.into_iter().map(panel).collect(),
        series: names()
            .into_iter()
            .map(|step| if step == "view" { "view (n = v = r)".to_owned() } else { step.to_owned() })
            .collect(),
    }
    .figure()
}
