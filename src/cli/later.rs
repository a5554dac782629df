//! Commands of the contract that are not built yet: they say so.

use super::Failure;
use clap::Args;

#[derive(Args, Debug)]
pub struct Arguments {
    /// Taken and ignored.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
    rest: Vec<String>,
}

pub fn execute(name: &str) -> Result<(), Failure> {
    Err(Failure::input(format!(
        "splitsum {name}: this version has no window; report.html in the folder of a run has a live view (`splitsum report`)"
    )))
}
