//! Common imports of the questions.

pub use super::chart::{
    Chart, ChartAxis, ChartPanel, INTERVAL, LightMarks, dot, joined, light_panels, method_series,
    only, solid, step,
};
pub use super::numbers::{ALL, DigestRow, Numbers, Wins, all_head, by_light, from_usual, sides};
pub use super::words::*;
pub use super::{Finding, N_DOT_V_FROM, N_DOT_V_TO, Question, Sentences};
pub use crate::base::csv::{Cell, NameAndLabel};
pub use crate::draw::figure::{Figure, Mark, Series, Shape as Form};
pub use crate::draw::variant::Variant;
pub(super) use crate::draw::words::statement;
pub use crate::draw::words::{
    Coverage, Extent, Interval, Number, Phrase, Quantity, Statement, Unit,
};
pub use crate::experiment::axis::*;
pub use crate::experiment::value::Value;
pub use crate::instrument::scene::is_design;
pub use crate::instrument::shade::NONE;
pub use crate::study::frame::estimate::{Estimate, Middle, estimate, geometric_mean, median};
pub use crate::study::frame::{
    Frame, Key, Row, Shape, VISIBLE_FROM, agree, ascending, distinct_in_order, group_by_axes,
    grouped, grouped_ascending, pair, values, varying,
};
pub use crate::study::table::{Table, column};
pub(super) use crate::study::table::{axis_cells, cells, value_cell};
