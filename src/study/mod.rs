//! What finished runs say: questions with their answers, figures, the page. Needs no device.

pub mod answers;
pub mod figure;
pub mod finished;
pub mod frame;
pub mod page;
pub mod questions;
pub(crate) mod summary;
pub mod table;
