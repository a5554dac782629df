//!
pub mod pass;
