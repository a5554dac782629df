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
    Err(Failure::failed(format!("splitsum {name} is not there yet; `splitsum --help` lists the commands")))
}
