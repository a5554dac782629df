//! Argument parsing and exit code only.

mod cli;

fn main() -> std::process::ExitCode {
    cli::main()
}
