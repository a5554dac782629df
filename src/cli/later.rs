//! Commands of features that this build lacks.

use super::Failure;
use clap::Args;

#[derive(Args, Debug)]
pub struct Arguments {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
    rest: Vec<String>,
}

pub fn execute(name: &str) -> Result<(), Failure> {
    Err(Failure::input(format!(
        "splitsum {name}: built without the `{name}` feature; build with `cargo build --release \
         --features {name}`"
    )))
}
