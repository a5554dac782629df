//! Leaves what the live view of the report needs.

use super::{Progress, Run, RunError, cell_result};
use crate::pixels::RgbImage;
use crate::runner::live::{self, LIVE_FILE, LiveRecord};
use crate::runner::renderer::Renderer;
use std::path::Path;

impl Run<'_> {
    /// All cells. What the live view of the report needs is made before them, since a run whose cells are all done has nothing left to
    /// make, and written meanwhile.
    pub(super) fn live_and_cells(
        &mut self,
        renderer: &mut dyn Renderer,
        progress: &mut dyn Progress,
    ) -> Result<(), RunError> {
        let (store, path) = (self.store.clone(), self.store.dir().join(LIVE_FILE));
        let live = self.live(&path, renderer, progress)?;
        std::thread::scope(|scope| {
            let written = live.map(|live| scope.spawn(move || store.write_json(&path, &live.packed())));
            let result = self.cells(renderer, progress);
            match written.map(|written| written.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))) {
                Some(Err(error)) => result.and(Err(error.into())),
                _ => result,
            }
        })
    }

    /// The tables of the live view, unless they are there. Without them the report has no such view.
    fn live(
        &self,
        path: &Path,
        renderer: &mut dyn Renderer,
        progress: &mut dyn Progress,
    ) -> Result<Option<LiveRecord<RgbImage>>, RunError> {
        let is_ours = self.share.is_none_or(|share| share.has_live);
        if !is_ours || self.is_stopped() || path.exists() {
            return Ok(None);
        }
        let tables = cell_result(live::tables(self.plan, renderer))?;
        Ok(tables.map_err(|reason| progress.note(&format!("the report will have no live view: {reason}"))).ok())
    }
}
