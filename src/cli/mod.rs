//! The command line: a file for each command, each a thin layer over the library.

mod answers;
mod bake;
mod cache;
mod check_bake;
mod check_shader;
mod compare;
mod completed;
mod cost;
mod devices;
mod edited_shaders;
mod flags;
mod gallery;
mod integrate;
#[cfg(not(feature = "view"))]
mod later;
mod list;
mod manual;
mod merge;
mod plan;
mod progress;
mod render;
mod report;
mod run;
mod shared;
mod stop;
mod subject;
#[cfg(feature = "view")]
mod view;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, Parser, Subcommand};
use splitsum::base::names::{not_listed, not_one_of, printable};
use splitsum::cost::child::COMMAND;
use splitsum::instrument::environment::GUIDE;
use splitsum::run::{RenderFault, RunError};
use std::error::Error;
use std::num::ParseIntError;
use std::process::ExitCode;

/// Measure how wrong the split-sum approximation of image-based lighting is.
#[derive(Debug, Parser)]
#[command(
    version,
    about,
    after_help = "Exit codes: 0 done, now or before; 1 failed or stopped; 2 bad usage or bad \
                  input; 3 nothing to do: the experiment has no \
    cell, or the table no query; 4 finished but some cells failed; 75 temporary failure, run the \
    command again: the device was lost, or \
    another run uses the folder.\n\n\
    Examples:\n  splitsum run experiments/quick.toml\n  splitsum render --method split-sum --alpha \
    0.25 --out ball.png\n  \
    splitsum list methods"
)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Run(run::Arguments),
    Plan(plan::Arguments),
    Merge(merge::Arguments),
    Render(Box<render::Arguments>),
    Compare(compare::Arguments),
    Bake(bake::Arguments),
    Cost(cost::Arguments),
    /// Compile shaders for `cost`.
    #[command(name = COMMAND, hide = true)]
    CompileShaders,
    CheckBake(Box<check_bake::Arguments>),
    CheckShader(check_shader::Arguments),
    /// List the Vulkan devices.
    Devices,
    List(list::Arguments),
    Integrate(integrate::Arguments),
    Report(report::Arguments),
    Answers(answers::Arguments),
    Gallery(gallery::Arguments),
    Manual(manual::Arguments),
    #[cfg(feature = "view")]
    View(Box<view::Arguments>),
    /// Open a window (needs a build with `--features view`).
    #[cfg(not(feature = "view"))]
    View(later::Arguments),
}

impl Command {
    fn execute(self) -> Result<(), Failure> {
        match self {
            Self::Run(arguments) => run::execute(&arguments),
            Self::Plan(arguments) => plan::execute(&arguments),
            Self::Merge(arguments) => merge::execute(&arguments),
            Self::Render(arguments) => render::execute(&arguments),
            Self::Compare(arguments) => compare::execute(&arguments),
            Self::Bake(arguments) => bake::execute(&arguments),
            Self::Cost(arguments) => cost::execute(&arguments),
            Self::CompileShaders => cost::compile_shaders(),
            Self::CheckBake(arguments) => check_bake::execute(&arguments),
            Self::CheckShader(arguments) => check_shader::execute(&arguments),
            Self::Devices => devices::execute(),
            Self::List(arguments) => list::execute(&arguments),
            Self::Integrate(arguments) => integrate::execute(&arguments),
            Self::Report(arguments) => report::execute(&arguments),
            Self::Answers(arguments) => answers::execute(&arguments),
            Self::Gallery(arguments) => gallery::execute(&arguments),
            Self::Manual(arguments) => {
                manual::execute(&arguments, Cli::command().disable_help_subcommand(true))
            }
            #[cfg(feature = "view")]
            Self::View(arguments) => view::execute(&arguments),
            #[cfg(not(feature = "view"))]
            Self::View(_) => later::execute("view"),
        }
    }
}

/// Why a command failed, with its exit code.
#[derive(Debug)]
struct Failure {
    code: u8,
    text: String,
}

impl Failure {
    fn failed(text: impl ToString) -> Self {
        Self {
            code: 1,
            text: text.to_string(),
        }
    }

    /// The user's input is wrong.
    fn input(text: impl ToString) -> Self {
        Self {
            code: 2,
            text: text.to_string(),
        }
    }

    /// Bad input if `is_misuse`, else a failure.
    fn by_misuse(is_misuse: bool, text: impl ToString) -> Self {
        if is_misuse {
            Self::input(text)
        } else {
            Self::failed(text)
        }
    }

    fn nothing_to_do(text: impl ToString) -> Self {
        Self {
            code: 3,
            text: text.to_string(),
        }
    }

    fn cells_failed(text: impl ToString) -> Self {
        Self {
            code: 4,
            text: text.to_string(),
        }
    }

    /// Temporary; the same command may succeed later.
    fn passing(text: impl ToString) -> Self {
        Self {
            code: 75,
            text: text.to_string(),
        }
    }

    /// Opening the device failed: the host lacks something, unless the device was lost.
    fn opening(fault: RenderFault) -> Self {
        if fault.device_lost {
            Self::passing(fault.message)
        } else {
            Self::input(fault.message)
        }
    }

    fn rendering(fault: RenderFault) -> Self {
        match fault {
            RenderFault {
                device_lost: true,
                message,
                ..
            } => Self::passing(message),
            RenderFault {
                is_input: true,
                message,
                ..
            } => Self::input(message),
            RenderFault { message, .. } => Self::failed(message),
        }
    }
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        let text = error.to_string();
        match error {
            RunError::DeviceLost(_) => Self::passing(text),
            RunError::NoRenderer(_) => Self::input(text),
            RunError::Damaged(_) => Self::failed(text),
            RunError::Store(error) if error.is_passing() => Self::passing(text),
            RunError::Store(error) => Self::by_misuse(error.is_misuse(), text),
        }
    }
}

pub fn main() -> ExitCode {
    let command = match Cli::try_parse() {
        Ok(Cli { command }) => command,
        Err(error)
            if error.use_stderr()
                && error.kind() != ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand =>
        {
            log(&usage_fault(&error));
            return ExitCode::from(2);
        }
        // Help and version.
        Err(error) => error.exit(),
    };
    let result = edited_shaders::load().and_then(|()| command.execute());
    progress::end();
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            log(&failure.text);
            ExitCode::from(failure.code)
        }
    }
}

/// Describes wrong arguments as other bad input: `--alpha: 3 is outside [0.001, 1]`.
fn usage_fault(error: &clap::Error) -> String {
    let argument = context_name(error, ContextKind::InvalidArg);
    let flag = argument.split(' ').next().unwrap_or_default();
    let value =
        context(error, ContextKind::InvalidValue) + &context(error, ContextKind::InvalidSubcommand);
    let fault = match error.kind() {
        ErrorKind::ValueValidation => match error.source() {
            Some(source) => return value_fault(flag, &value, source),
            None => first_line(error),
        },
        ErrorKind::InvalidSubcommand => {
            let commands = command_names();
            let commands: Vec<&str> = commands.iter().map(String::as_str).collect();
            let listed_in = Some("a command of `splitsum --help`");
            return not_listed("command", &value, &commands, "", listed_in);
        }
        ErrorKind::InvalidValue if !value.is_empty() => {
            let names = context(error, ContextKind::ValidValue);
            let names: Vec<&str> = names.split(", ").collect();
            return not_one_of("name", &value, &names, "");
        }
        ErrorKind::InvalidValue | ErrorKind::MissingRequiredArgument => {
            format!("{argument} is missing")
        }
        ErrorKind::TooManyValues => format!("{flag} takes no value"),
        ErrorKind::ArgumentConflict => format!(
            "{argument} cannot be used with {}",
            context_name(error, ContextKind::PriorArg)
        ),
        ErrorKind::UnknownArgument => {
            let near = context(error, ContextKind::SuggestedArg);
            if !near.is_empty() {
                return format!("{argument} is unknown; did you mean {near}?");
            }
            format!("{argument} is unknown")
        }
        _ => first_line(error),
    };
    let command = std::env::args()
        .nth(1)
        .filter(|word| command_names().contains(word));
    format!(
        "{fault}; see `splitsum{} --help`",
        command.map_or_else(String::new, |name| format!(" {name}"))
    )
}

/// Describes a value that its parser refused.
fn value_fault(flag: &str, value: &str, source: &(dyn Error + 'static)) -> String {
    if source.is::<ParseIntError>() {
        return format!("{flag}: {value:?} is not a whole number of at least 0");
    }
    let why = source.to_string();
    if why.contains(value) {
        format!("{flag}: {why}")
    } else {
        format!("{flag}: {value:?}: {why}")
    }
}

/// A fact of clap about an error; empty if it has none.
fn context(error: &clap::Error, kind: ContextKind) -> String {
    match error.get(kind) {
        Some(ContextValue::Strings(words)) => words.join(", "),
        found => found.map(ToString::to_string).unwrap_or_default(),
    }
}

/// As [`context`], for arguments: without clap's brackets and dots.
fn context_name(error: &clap::Error, kind: ContextKind) -> String {
    context(error, kind)
        .replace(['<', '>', '[', ']'], "")
        .replace("...", "")
}

fn first_line(error: &clap::Error) -> String {
    let text = error.to_string();
    let line = text.lines().next().unwrap_or_default();
    line.replace("error: ", "")
}

fn command_names() -> Vec<String> {
    Cli::command()
        .get_subcommands()
        .filter(|command| !command.is_hide_set())
        .map(|command| command.get_name().to_owned())
        .collect()
}

/// Writes to standard output for people, with control characters escaped.
fn print(text: &str) -> Result<(), Failure> {
    let safe: String = text
        .split_inclusive(['\n', '\t'])
        .map(|part| match part.strip_suffix(['\n', '\t']) {
            Some(line) => printable(line) + &part[line.len()..],
            None => printable(part),
        })
        .collect();
    print_data(&safe)
}

/// Writes to standard output for programs; a closed pipe (`splitsum list | head`) is not a failure.
fn print_data(text: &str) -> Result<(), Failure> {
    use std::io::Write;
    match progress::without_bar(|| std::io::stdout().write_all(text.as_bytes())) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::failed(format!("standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Removes the numbers of system errors and keeps their words.
fn without_numbers(text: &str) -> String {
    let mut parts = text.split(" (os error ");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |kept, part| {
        kept + part.split_once(')').map_or(part, |(_, rest)| rest)
    })
}

/// Writes lines to standard error, with control characters escaped. Ignores errors, where
/// `eprintln!` would panic.
fn log(text: &str) {
    use std::io::Write;
    let lines: Vec<String> = text
        .lines()
        .map(|line| printable(&without_numbers(line)))
        .collect();
    let _ = progress::without_bar(|| writeln!(std::io::stderr(), "{}", lines.join("\n")));
}

/// Prints warnings of an environment or a model.
fn warn_of_input(name: &str, warnings: &[String]) {
    for warning in warnings {
        warn(name, &with_guide(warning));
    }
}

/// Adds the page about the ways into the program to a warning of an input.
fn with_guide(warning: &str) -> String {
    format!("{warning} ({GUIDE})")
}

fn warn(name: &str, warning: &str) {
    log(&format!("warning: {name}: {warning}"));
}
