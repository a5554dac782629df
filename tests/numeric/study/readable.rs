//! Each question as its reader sees it: the sentences, the head of the table, the digest, and the
//! marks of the figure, of a run whose errors follow a law that a reader can compute.

use super::paper::{Made, bins, finding, finished_of};
use super::tables;
use crate::run::timing_ratios::swept;
use crate::snapshot::assert_snapshot;
use splitsum::base::csv::Cell;
use splitsum::draw::figure::{Figure, Mark, ScaleKind, Shape};
use splitsum::draw::markdown::significant;
use splitsum::experiment::axis::Point;
use splitsum::experiment::value::Value;
use splitsum::instrument::ladder::STEPS;
use splitsum::instrument::metrics::HEADLINE;
use splitsum::run::timing::{FRAME, PassSamples};
use splitsum::study::finished::{Finished, RecoveredRow, StepRow};
use splitsum::study::frame::Frame;
use splitsum::study::questions::{Finding, question};
use std::sync::Arc;

/// Rows of a table that a snapshot shows.
const ROWS: usize = 6;

/// Compares the answer to a question with `tests/snapshots/answer_QUESTION.snap`.
fn assert_reads(name: &str, law: &str, finding: &Finding) {
    let mut table = finding.table.clone().without_empty();
    let count = table.rows.len();
    table.rows.truncate(ROWS);
    let mut text = format!("Law: {law}\n\n{}\n\n", finding.sentences.markdown());
    text += &format!(
        "The first {} of {count} rows:\n{}\n",
        table.rows.len(),
        table.markdown()
    );
    if let Some(digest) = &finding.digest {
        text += &format!("Digest:\n{}\n", digest.markdown());
    }
    if let Some(figure) = &finding.figure {
        text += &drawn(figure);
    }
    assert_snapshot(&format!("answer_{name}"), &text);
}

/// A figure in words: a line for each panel and series, with its marks in data units.
fn drawn(figure: &Figure) -> String {
    let mut text = format!("Figure: {}\n{}\n", figure.title, figure.note);
    for panel in &figure.panels {
        let scale = |kind: &ScaleKind| match kind {
            ScaleKind::Linear { .. } => "linear".to_owned(),
            ScaleKind::Log { .. } => "log".to_owned(),
            ScaleKind::Steps(names) => format!("steps {}", names.join(", ")),
        };
        text += &format!(
            "[{}] x: {} ({}), y: {} ({})\n",
            panel.title,
            panel.x.label,
            scale(&panel.x.kind),
            panel.y.label,
            scale(&panel.y.kind)
        );
        let series = figure.series.iter().map(|series| series.name.as_str());
        let named = series.enumerate().map(|(index, name)| (Some(index), name));
        for (index, name) in named.chain([(None, "rule")]) {
            let marks = panel.marks.iter().filter(|mark| mark.series == index);
            let words: Vec<String> = marks.filter_map(mark_words).collect();
            if !words.is_empty() {
                text += &format!("  {name}: {}\n", words.join(" "));
            }
        }
    }
    text
}

/// Lines join dots, which have the same numbers.
fn mark_words(mark: &Mark) -> Option<String> {
    let number = |x: f64| significant(x, 3);
    let point = |[x, y]: [f64; 2]| format!("({}, {})", number(x), number(y));
    match &mark.shape {
        Shape::Line(_) => None,
        Shape::Dot(at) => Some(point(*at)),
        Shape::Whisker(a, b) => Some(format!("{}-{}", point(*a), point(*b))),
        Shape::HorizontalBar { y, base, to } => Some(format!(
            "{}: {} to {}",
            number(*y),
            number(*base),
            number(*to)
        )),
        Shape::HorizontalRule(y) => Some(format!("y = {}", number(*y))),
        Shape::VerticalRule(x) => Some(format!("x = {}", number(*x))),
    }
}

/// Skies whose sun stands at 10 k degrees; k tells them apart.
fn skies(count: usize) -> String {
    let names: Vec<String> = (1..=count)
        .map(|k| format!("\"builtin:sky:elevation_deg={k}0\""))
        .collect();
    format!("environment = [{}]", names.join(", "))
}

/// The k of a sky.
fn k(point: &Point) -> f64 {
    let name = point.get("environment").to_string();
    let degrees = name.rsplit('=').next().unwrap();
    degrees.parse::<f64>().unwrap() / 10.0
}

fn number(point: &Point, axis: &str) -> f64 {
    match point.get(axis) {
        Value::Count(n) => f64::from(*n),
        other => other.number(),
    }
}

fn method(point: &Point) -> String {
    point.get("method").to_string()
}

const HEAD: &str =
    "name = \"made\"\nsize = [16, 16]\nreference = { samples = 32, noise_share = 0 }\n";

/// Two methods under six skies; the bins of n·v below and above 0.5 have 2 and 0.5 times the error.
fn curves() -> Finished {
    let text = format!(
        "{HEAD}[axes]\n{}\ndiffuse = [\"none\"]\nalpha = [0.1, 0.5]\nmethod = [\"split-sum\", \
         \"sampled\"]\nsamples = [1, 4, 16, 64, 256]\n",
        skies(6)
    );
    let error = |point: &Point| match method(point).as_str() {
        "split-sum" => k(point) * number(point, "alpha") / 10.0,
        _ => 1.0 / number(point, "samples"),
    };
    let mut run = finished_of(&text, |point| Some(Made::error(error(point))));
    for cell in &mut run.cells {
        let error = error(&cell.point);
        cell.bins = bins(HEADLINE, &[2.0 * error, 0.5 * error]).into();
    }
    run
}

const CURVES: &str = "under sky k of 6 split-sum errs by k alpha / 10, sampled by 1 / samples; \
                      below n·v 0.5 twice that, above half of it";

#[test]
fn break_even_reads() {
    assert_reads("break-even", CURVES, &finding(&curves(), "break-even"));
}

#[test]
fn convergence_reads() {
    // A bias that differs, so that the errors stop falling at different counts.
    let text = format!(
        "{HEAD}[axes]\n{}\ndiffuse = [\"none\"]\nmethod = [\"sampled\", \
         \"split-sum\"]\nsamples = [1, 4, 16, 64, 256]\n",
        skies(6)
    );
    let run = finished_of(&text, |point| {
        let error = match method(point).as_str() {
            "split-sum" => 0.2,
            _ => 1.0 / number(point, "samples") + k(point).powi(2) / 100.0,
        };
        Some(Made::error(error))
    });
    let law = "under sky k of 6 sampled errs by 1 / samples + k² / 100, split-sum by 0.2";
    assert_reads("convergence", law, &finding(&run, "convergence"));
}

#[test]
fn error_reads() {
    assert_reads("error", CURVES, &finding(&curves(), "error"));
}

#[test]
fn n_dot_v_reads() {
    assert_reads("n-dot-v", CURVES, &finding(&curves(), "n-dot-v"));
}

#[test]
fn effect_reads() {
    let text = format!(
        "{HEAD}[axes]\n{}\ndiffuse = [\"none\"]\nalpha = [0.1, 0.5]\nmethod = [\"split-sum\", \
         \"split-sum-one\", \"split-sum-two\"]\n",
        skies(6)
    );
    let run = finished_of(&text, |point| {
        let k = k(point);
        let is_wide = number(point, "alpha") == 0.5;
        let ratio = match method(point).as_str() {
            "split-sum-one" => 0.1 * k,
            "split-sum-two" if is_wide => 0.5,
            "split-sum-two" => 0.2 * k,
            _ => 1.0,
        };
        Some(Made::error(0.01 * k * ratio))
    });
    let law = "under sky k of 6 split-sum errs by k / 100; over it split-sum-one errs by k / 10, \
               split-sum-two by k / 5 at alpha 0.1 and by 1 / 2 at alpha 0.5";
    assert_reads("effect", law, &finding(&run, "effect"));
}

#[test]
fn visibility_reads() {
    let text = format!(
        "{HEAD}[axes]\n{}\ndiffuse = [\"none\"]\nmethod = [\"split-sum\", \
         \"split-sum-two\"]\nexposure = [0.5, 1, 2]\ncontrast = [1, 2]\n",
        skies(3)
    );
    let run = finished_of(&text, |point| {
        let curve = number(point, "exposure") * number(point, "contrast");
        let share = if method(point) == "split-sum" {
            0.02
        } else {
            0.01
        };
        Some(Made {
            flip: share * k(point) * curve,
            ..Made::error(0.1)
        })
    });
    let law = "under sky k of 3 the FLIP of split-sum is 0.02 k exposure contrast, of \
               split-sum-two half of it";
    assert_reads("visibility", law, &finding(&run, "visibility"));
}

#[test]
fn pictures_reads() {
    let text = format!(
        "{HEAD}[axes]\n{}\nenvironment_orientation = [1, 2]\nscene = [\"sphere\", \
         \"shader-ball\"]\ndiffuse = [\"none\"]\nmethod = [\"split-sum\", \"split-sum-two\"]\n",
        skies(6)
    );
    let run = finished_of(&text, |point| {
        let is_turned = number(point, "environment_orientation") == 2.0;
        let turn = if is_turned { 1.5 } else { 1.0 };
        // No two ratios are equal: of equal ones the worst is named by its cell's id, which the
        // code of the shaders changes.
        let is_ball = point.get("scene").to_string() == "shader-ball";
        let scene = if is_ball { 1.01 } else { 1.0 };
        let ratio = if method(point) == "split-sum" {
            1.0
        } else {
            0.2 * k(point) * turn * scene
        };
        Some(Made {
            flip: 0.1 * ratio,
            ..Made::error(0.05 * ratio)
        })
    });
    let law = "under sky k of 6 the ratio of split-sum-two to split-sum is k / 5 at orientation 1 \
               and 1.5 times that at 2, under the shader ball 1 % more, in every score";
    let mut finding = finding(&run, "pictures");
    let columns = &finding.table.columns;
    let at = |name: &str| columns.iter().position(|column| column == name).unwrap();
    let (shown, id) = (at("method"), at("worst_cell"));
    finding
        .table
        .rows
        .retain(|row| row[shown] != "split-sum".into());
    for row in &mut finding.table.rows {
        row[id] = Cell::Missing;
    }
    assert_reads("pictures", law, &finding);
}

#[test]
fn ladder_reads() {
    let text = format!(
        "{HEAD}[ladder]\nsamples = 64\n[axes]\n{}\nscene = [\"design\"]\ndiffuse = \
         [\"none\"]\nalpha = [0.1, 0.5]\nmethod = [\"split-sum\"]\n",
        skies(6)
    );
    let mut run = finished_of(&text, |_| Some(Made::error(0.1)));
    let total = (STEPS.len() * (STEPS.len() + 1) / 2) as f64;
    for cell in &mut run.cells {
        // The first step gains what the last one loses.
        let shift = 0.01 * (k(&cell.point) - 3.5) * 10.0 * number(&cell.point, "alpha");
        let last = STEPS.len() - 1;
        let share = |i: usize| {
            let shift = match i {
                0 => shift,
                _ if i == last => -shift,
                _ => 0.0,
            };
            (i + 1) as f64 / total + shift
        };
        for n_dot_v in [[0.0, 1.0], [0.0, 0.2], [0.8, 1.0]] {
            let steps = STEPS.iter().enumerate().map(|(i, step)| StepRow {
                n_dot_v,
                step: step.name.to_owned(),
                share: share(i) * if n_dot_v[1] == 0.2 { 0.5 } else { 1.0 },
                share_error: 1e-3,
                rung_error: 0.1 * (i + 1) as f64,
                first_in: 0.5 * share(i),
                last_out: 2.0 * share(i),
                shapley: 1.1 * share(i),
                step_error: 1e-3 * (i + 1) as f64,
                noise: 1e-6,
            });
            Arc::make_mut(&mut cell.steps).extend(steps);
        }
    }
    let law = "over all n·v the share of step i is i / 36, plus (k - 3.5) alpha / 10 for the first \
               step and minus that for the last, under sky k of 6; half of it below n·v 0.2; alone \
               half of it, last 2 times, Shapley 1.1 times";
    assert_reads("ladder", law, &finding(&run, "ladder"));
}

#[test]
fn tables_reads() {
    let law = "the split errs by 1 at alpha 0.1 and by 4 at 0.5; tables of 16 texels by 0.19, of \
               64 by 0.04, quadratic 0.03, with 256 samples 0.01; under the sky by twice that";
    assert_reads("tables", law, &tables::run().finding("tables"));
}

#[test]
fn times_reads() {
    let text = format!(
        "{HEAD}[timing]\nrounds = 7\n[axes]\ndiffuse = [\"none\"]\nmethod = [\"split-sum\", \
         \"sampled\"]\nsamples = [40]\n"
    );
    let mut run = finished_of(&text, |_| Some(Made::error(0.1)));
    run.timings = swept();
    for record in &mut run.timings {
        let passes = record.passes.iter_mut();
        for (i, pass) in passes.enumerate() {
            // The median stays; the interval of seven rounds is from the least to the largest.
            pass.ms[0] *= 0.5;
            pass.ms[6] *= 1.0 + 0.5 * (i + 1) as f64;
        }
        if record.phase == FRAME {
            record.passes.push(PassSamples {
                pass: "gbuffer".to_owned(),
                ms: vec![1.0; 7],
            });
        }
    }
    let frame = Frame::new(&run, None);
    let finding = (question("times").unwrap().answer)(&frame).unwrap();
    let law = "frames shade in 2 ms (split-sum), 6 ms (40 samples), 4 and 3 ms (40 and 16 \
               unfiltered), after a g-buffer of 1 ms; tables take 40 or 382 ms; the least round \
               has half the time, the longest 1.5 times or more";
    assert_reads("times", law, &finding);
}

#[test]
fn frames_reads() {
    let text = format!(
        "{HEAD}[axes]\n{}\ndiffuse = [\"none\"]\nalpha = [0.1, 0.5]\nmethod = [\"split-sum\", \
         \"sampled\", \"sampled-vndf\"]\nsamples = [1]\nframes = [1, 4, 16]\nmotion = [\"still\", \
         \"light\"]\n",
        skies(6)
    );
    let lag = |point: &Point| {
        let is_turning = point.get("motion").to_string() == "light";
        if is_turning { 0.02 * k(point) } else { 0.0 }
    };
    let mut run = finished_of(&text, |point| {
        let error = match method(point).as_str() {
            "split-sum" => 0.1 * k(point) * number(point, "alpha"),
            "sampled" => 0.4 / number(point, "frames") + lag(point),
            _ => 0.2 / number(point, "frames") + lag(point),
        };
        Some(Made::error(error))
    });
    for cell in &mut run.cells {
        let lag = lag(&cell.point);
        cell.steadiness = Some([lag, 0.5 * lag + 0.001]);
    }
    let law = "under sky k of 6 split-sum errs by k alpha / 10, sampled by 0.4 / frames and \
               sampled-vndf by 0.2 / frames, plus a lag of 0.02 k under a turning light; the \
               flicker is half the lag plus 0.001";
    assert_reads("frames", law, &finding(&run, "frames"));
}

#[test]
fn key_light_reads() {
    let text = format!(
        "{HEAD}[[lights]]\nkind = \"directional\"\ndirection = [0, -1, -1]\nunit = \
         \"map\"\n[axes]\n{}\ndiffuse = [\"none\"]\nalpha = [0.1, 0.5]\nmethod = \
         [\"split-sum\"]\nlight_intensity = [0, 1, 16]\nlight_turn_deg = [0, 90]\nexposure = \
         [1, 4, 100]\n",
        skies(6)
    );
    let run = finished_of(&text, |point| {
        let turned = number(point, "light_turn_deg") / 90.0;
        let width = if number(point, "alpha") < 0.2 {
            1.0
        } else {
            0.5
        };
        let flip = 0.08 * width * number(point, "exposure") * k(point) / 3.5 * (0.9 + 0.2 * turned)
            / (1.0 + number(point, "light_intensity"));
        Some(Made {
            flip,
            ..Made::error(0.01 * flip)
        })
    });
    let law = "under sky k of 6 FLIP is 0.08 k / 3.5 times the exposure, half of it at alpha 0.5, \
               over 1 + the intensity; a tenth less or more by the turn of the light";
    assert_reads("key_light", law, &finding(&run, "key-light"));
}

#[test]
fn recovery_reads() {
    let text = format!(
        "name = \"made\"\nsize = [16, 16]\nreference = \"none\"\n[recovery]\n[axes]\n{}\nmethod = \
         [\"reference\", \"split-sum\", \"split-sum-two\"]\nsamples = [64]\nperceptual_roughness = \
         [0.2, 0.5, 0.7]\nf0 = [1, 0.04]\ndiffuse = [\"none\"]\nalbedo = [0]\n",
        skies(6)
    );
    let mut run = finished_of(&text, |_| Some(Made::error(0.1)));
    let cells = |name: &str| {
        let cells = run.cells.iter();
        let of = cells.filter(|cell| method(&cell.point) == name).cloned();
        of.collect::<Vec<_>>()
    };
    let mut recovered = Vec::new();
    for truth in cells("reference") {
        let roughness = number(&truth.point, "alpha").sqrt();
        let f0 = f64::from(truth.point.get("f0").color()[0]);
        for (name, part) in [("split-sum", 1.0), ("split-sum-two", 0.1)] {
            let candidate = cells(name)
                .into_iter()
                .find(|cell| cell.point.get("environment") == truth.point.get("environment"))
                .unwrap();
            for loss in ["nvdiffrec", "relative"] {
                let bias = part * 0.4 * roughness * roughness;
                let sign = if loss == "relative" { -1.0 } else { 1.0 };
                recovered.push(RecoveredRow {
                    truth: truth.id.to_string(),
                    candidate: candidate.id.to_string(),
                    loss: loss.to_owned(),
                    n_dot_v: [0.0, 1.0],
                    true_roughness: roughness,
                    true_f0: f0,
                    roughness: roughness + sign * bias * (1.0 + 0.01 * k(&truth.point)),
                    f0: f0 * (1.0 + sign * bias),
                    is_at_limit: part == 1.0 && roughness > 0.6 && k(&truth.point) > 5.0,
                });
            }
        }
    }
    run.recovered = recovered;
    let law = "the textbook's roughness is too large by 0.4 of its square and 1 % more of that under \
               sky k of 6, its F0 by the same part, both too small by the relative loss; two lookups \
               err a tenth of that";
    assert_reads("recovery", law, &finding(&run, "recovery"));
}
