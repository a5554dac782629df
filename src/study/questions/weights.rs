//! One answer under several weights of views: the first weight has the sentences and the figure,
//! each has its rows.

use super::{Finding, WEIGHT};
use crate::draw::words::{Phrase, Statement, statement};
use crate::experiment::axis::SCENE;
use crate::instrument::metrics::{Pooling, Weight};
use crate::instrument::scene::is_design;
use crate::study::frame::Frame;
use crate::study::table::Table;

/// Whether a frame's images are designs and not pictures.
fn has_designs_only(frame: &Frame) -> bool {
    let images = frame.images();
    !images.is_empty() && images.iter().all(|row| is_design(&row.text(SCENE)))
}

/// The weight of a frame's scores as they are recorded.
pub fn recorded_weight(frame: &Frame) -> &'static Weight {
    if has_designs_only(frame) {
        &Weight::Uniform
    } else {
        &Weight::Picture
    }
}

/// The weights to answer by; none if the images of a frame are pictures, or their bins do not
/// determine the metric.
pub fn weights<'f>(frame: &Frame<'f>) -> &'f [Weight] {
    let has_bins = frame.run.cells.iter().any(|cell| !cell.bins.is_empty());
    if !has_bins || frame.metric.pooling == Pooling::None || !has_designs_only(frame) {
        return &[];
    }
    &frame.run.weights
}

/// A finding with the weight of its rows.
pub fn with_weight(finding: Finding, weight: &Weight) -> Finding {
    Finding {
        table: Table::united(WEIGHT.name, vec![(weight.name(), finding.table)]),
        ..finding
    }
}

/// The findings under each weight as one; `None` if there are none.
pub fn united(findings: Vec<(&Weight, Finding)>) -> Option<Finding> {
    let has_several = findings.len() > 1;
    let mut tables = Vec::new();
    let mut digests = Vec::new();
    let mut first = None;
    for (weight, mut finding) in findings {
        tables.push((weight.name(), std::mem::take(&mut finding.table)));
        digests.extend(finding.digest.take().map(|digest| (weight.name(), digest)));
        first.get_or_insert((weight, finding));
    }
    let (weight, mut finding) = first?;
    finding.table = Table::united(WEIGHT.name, tables);
    finding.digest = if has_several {
        (!digests.is_empty()).then(|| Table::united(WEIGHT.name, digests))
    } else {
        digests.pop().map(|(_, digest)| digest)
    };
    name_weight(&mut finding, weight);
    Some(finding)
}

/// Says how views count, unless all count alike.
fn name_weight(finding: &mut Finding, weight: &Weight) {
    let (statement, note): (Statement, String) = match weight {
        Weight::Uniform => return,
        Weight::Picture => (
            "Views count as in pictures.".into(),
            "views weighted as in pictures".to_owned(),
        ),
        Weight::Scene(scene) => (
            statement!["Views count as in ", Phrase::Code(scene.clone()), "."],
            format!("views weighted as in `{scene}`"),
        ),
    };
    finding.sentences.scope.push(statement);
    if let Some(figure) = &mut finding.figure {
        figure.note = format!("{}; {note}", figure.note);
    }
}
