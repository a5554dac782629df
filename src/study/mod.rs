//! What finished runs say: answers, figures, the report. Needs no device.

pub mod answers;
pub mod report;
pub(crate) mod summary;
