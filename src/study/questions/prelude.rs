//! Common imports of the questions.

pub use super::chart::{Along, Chart, INTERVAL, dot, joined, light_panels, only, step};
pub use super::numbers::{ALL, Numbers, all_head, by_light, from_usual, sides};
pub use super::words::*;
pub use super::{Finding, Question, SEEN_FROM, SEEN_TO};
pub use crate::base::csv::Cell;
pub use crate::draw::figure::{Figure, Mark, Shape as Form};
pub use crate::experiment::axis::*;
pub use crate::experiment::value::Value;
pub use crate::instrument::scene::is_design;
pub use crate::instrument::shade::NONE;
pub use crate::study::frame::estimate::{Estimate, Middle, estimate, geometric_mean, median};
pub use crate::study::frame::{
    Frame, Key, Row, Shape, VISIBLE_FROM, ascending, by, distinct_in_order, fits, grouped,
    grouped_ascending, pair, values,
};
pub use crate::study::table::{Table, column};
pub(super) use crate::study::table::{axis_cells, cells};
