//! Why a cell, or the whole run, cannot be scored.

use super::renderer::RenderFault;
use super::store::StoreError;
use crate::instrument::metrics::MetricsError;

#[derive(Debug)]
pub enum CellFault {
    /// Only this cell fails.
    Cell(String),
    /// A file cannot be written: the run ends.
    Store(StoreError),
    /// The device is lost: the run ends.
    Lost(String),
}

impl From<StoreError> for CellFault {
    fn from(error: StoreError) -> Self {
        Self::Store(error)
    }
}

impl From<MetricsError> for CellFault {
    fn from(error: MetricsError) -> Self {
        Self::Cell(error.to_string())
    }
}

impl From<RenderFault> for CellFault {
    fn from(fault: RenderFault) -> Self {
        if fault.device_lost {
            Self::Lost(fault.message)
        } else {
            Self::Cell(fault.message)
        }
    }
}
