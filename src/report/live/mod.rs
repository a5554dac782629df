//! `live.json`: what the Live view of the report renders with. A run writes it while it has its
//! device; `page::live` reads it.

pub mod model;
pub mod record;

use crate::experiment::plan::Plan;
use crate::run::companion::PlanFile;
use crate::run::{RenderFault, Renderer};
use record::{LIVE_FILE, record};

/// Makes `live.json` during a run.
#[derive(Clone, Copy, Debug)]
pub struct LiveFile;

impl PlanFile for LiveFile {
    fn name(&self) -> &'static str {
        LIVE_FILE
    }

    fn loss(&self) -> &'static str {
        "the report will have no Live view"
    }

    fn text(&self, plan: &Plan, renderer: &mut dyn Renderer) -> Result<String, RenderFault> {
        let record = record(plan, renderer)?;
        let text = serde_json::to_string_pretty(&record).expect("keys of the record are texts");
        Ok(text + "\n")
    }
}
