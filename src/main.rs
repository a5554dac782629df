//! Argument parsing and exit code only.
fn main() {}
