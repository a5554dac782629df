//! Predicts how long the rest of a run takes.
//!
//! Each step (a cell, a timed configuration) has stated work ([`work`]). Earlier runs on a device scale it, kind by kind ([`speeds`]);
//! the records and the clock of the current run correct that ([`forecast`]).

pub mod forecast;
pub mod speeds;
pub mod work;

pub use forecast::{Ahead, Forecast, Host};
pub use speeds::{Speeds, SpeedsFile};
pub use work::{Steps, Work};
