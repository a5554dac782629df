//! How long the rest of a run takes and how much disk it needs.
//!
//! Every step (a cell, a timed configuration) has its stated work ([`work`]). What earlier runs took on a device scales it, kind by kind
//! ([`speeds`]). While a run works, its own records and the clock correct that ([`forecast`]).

pub mod forecast;
pub mod speeds;
pub mod work;

pub use forecast::{Ahead, Forecast, Host};
pub use speeds::{Speeds, SpeedsFile};
pub use work::{Steps, Work, file_bytes};
