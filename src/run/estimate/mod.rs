//! Predicts how long the rest of a run takes.
//!
//! Each step (a cell, a timed configuration) has stated work ([`work`]); the records and the clock of the run correct its speed
//! ([`forecast`]).

pub mod forecast;
pub mod work;

pub use forecast::{Ahead, Forecast, Host};
pub use work::{Steps, Work};
