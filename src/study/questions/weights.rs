//! One answer under several weights of views: the leading weight has the sentence and the figure,
//! each has its rows.

use super::{Finding, WEIGHT};
use crate::draw::figure::Figure;
use crate::experiment::axis::SCENE;
use crate::instrument::metrics::{Pooling, Weight};
use crate::instrument::scene::is_design;
use crate::study::finished::Finished;
use crate::study::frame::Frame;
use crate::study::table::Table;

/// Whether a frame's images are designs and not pictures.
fn is_of_designs(frame: &Frame) -> bool {
    let images = frame.images();
    !images.is_empty() && images.iter().all(|row| is_design(&row.text(SCENE)))
}

/// The weight of a frame's scores as they are recorded.
pub fn own(frame: &Frame) -> &'static Weight {
    if is_of_designs(frame) {
        &Weight::Uniform
    } else {
        &Weight::Picture
    }
}

/// The run of a frame under each of its weights; none if its images are pictures, or their bins do
/// not determine the metric.
pub fn runs(frame: &Frame) -> Vec<Finished> {
    let has_bins = frame.run.cells.iter().any(|cell| !cell.bins.is_empty());
    let is_asked = has_bins && frame.metric.pooling != Pooling::None && is_of_designs(frame);
    frame
        .run
        .weights
        .iter()
        .filter(|_| is_asked)
        .map(|weight| frame.run.weighted(weight))
        .collect()
}

/// A finding with the weight of its rows.
pub fn marked(finding: Finding, weight: &Weight) -> Finding {
    Finding {
        table: Table::united(WEIGHT.name, vec![(weight.name(), finding.table)]),
        ..finding
    }
}

/// The findings under each weight as one; `None` if there are none.
pub fn united(findings: Vec<(&Weight, Finding)>) -> Option<Finding> {
    let lead = findings.first()?.0.clone();
    let has_several = findings.len() > 1;
    let (mut tables, mut digests, mut first) = (Vec::new(), Vec::new(), None);
    for (weight, mut finding) in findings {
        tables.push((weight.name(), std::mem::take(&mut finding.table)));
        digests.extend(finding.digest.take().map(|digest| (weight.name(), digest)));
        first.get_or_insert(finding);
    }
    let Finding {
        sentence, figure, ..
    } = first?;
    let words = match &lead {
        Weight::Uniform => String::new(),
        Weight::Picture => "Views count as in pictures".to_owned(),
        Weight::Scene(scene) => format!("Views count as in `{scene}`"),
    };
    let figure = figure.map(|figure| match words.is_empty() {
        true => figure,
        false => Figure {
            note: format!(
                "{}; {}",
                figure.note,
                words.replacen("Views count", "views weighted", 1)
            ),
            ..figure
        },
    });
    let digest = match has_several {
        true => (!digests.is_empty()).then(|| Table::united(WEIGHT.name, digests)),
        false => digests.pop().map(|(_, digest)| digest),
    };
    let sentence = if words.is_empty() {
        sentence
    } else {
        format!("{sentence} {words}.")
    };
    Some(Finding {
        sentence,
        table: Table::united(WEIGHT.name, tables),
        digest,
        figure,
    })
}
