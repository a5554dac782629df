//! The command line: a file for each command, each a thin layer over the library.

mod answers;
mod bake;
mod cache;
mod check_bake;
mod check_shader;
mod compare;
mod cost;
mod devices;
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

    fn of(is_misuse: bool, text: impl ToString) -> Self {
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
            RunError::Store(error) => Self::of(error.is_misuse(), text),
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
    let result = match command {
        Command::Run(arguments) => run::execute(&arguments),
        Command::Plan(arguments) => plan::execute(&arguments),
        Command::Merge(arguments) => merge::execute(&arguments),
        Command::Render(arguments) => render::execute(&arguments),
        Command::Compare(arguments) => compare::execute(&arguments),
        Command::Bake(arguments) => bake::execute(&arguments),
        Command::Cost(arguments) => cost::execute(&arguments),
        Command::CompileShaders => cost::compile_shaders(),
        Command::CheckBake(arguments) => check_bake::execute(&arguments),
        Command::CheckShader(arguments) => check_shader::execute(&arguments),
        Command::Devices => devices::execute(),
        Command::List(arguments) => list::execute(&arguments),
        Command::Integrate(arguments) => integrate::execute(&arguments),
        Command::Report(arguments) => report::execute(&arguments),
        Command::Answers(arguments) => answers::execute(&arguments),
        Command::Gallery(arguments) => gallery::execute(&arguments),
        Command::Manual(arguments) => {
            manual::execute(&arguments, Cli::command().disable_help_subcommand(true))
        }
        #[cfg(feature = "view")]
        Command::View(arguments) => view::execute(&arguments),
        #[cfg(not(feature = "view"))]
        Command::View(_) => later::execute("view"),
    };
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
    let text = |kind| match error.get(kind) {
        Some(ContextValue::Strings(words)) => words.join(", "),
        found => found.map(ToString::to_string).unwrap_or_default(),
    };
    let name = |kind| {
        text(kind)
            .replace(['<', '>', '[', ']'], "")
            .replace("...", "")
    };
    let argument = name(ContextKind::InvalidArg);
    let flag = argument.split(' ').next().unwrap_or_default();
    let value = text(ContextKind::InvalidValue) + &text(ContextKind::InvalidSubcommand);
    let cli = Cli::command();
    let commands: Vec<&str> = cli
        .get_subcommands()
        .filter(|c| !c.is_hide_set())
        .map(|c| c.get_name())
        .collect();
    let fault = match (error.kind(), error.source()) {
        (ErrorKind::ValueValidation, Some(source)) => match source.to_string() {
            _ if source.is::<ParseIntError>() => {
                return format!("{flag}: {value:?} is not a whole number of at least 0");
            }
            why if why.contains(&value) => return format!("{flag}: {why}"),
            why => return format!("{flag}: {value:?}: {why}"),
        },
        (ErrorKind::InvalidSubcommand, _) => {
            let listed_in = Some("a command of `splitsum --help`");
            return not_listed("command", &value, &commands, "", listed_in);
        }
        (ErrorKind::InvalidValue, _) if !value.is_empty() => {
            return not_one_of(
                "name",
                &value,
                &text(ContextKind::ValidValue)
                    .split(", ")
                    .collect::<Vec<_>>(),
                "",
            );
        }
        (ErrorKind::InvalidValue | ErrorKind::MissingRequiredArgument, _) => {
            format!("{argument} is missing")
        }
        (ErrorKind::TooManyValues, _) => format!("{flag} takes no value"),
        (ErrorKind::ArgumentConflict, _) => format!(
            "{argument} cannot be used with {}",
            name(ContextKind::PriorArg)
        ),
        (ErrorKind::UnknownArgument, _) => match text(ContextKind::SuggestedArg) {
            near if near.is_empty() => format!("{argument} is unknown"),
            near => return format!("{argument} is unknown; did you mean {near}?"),
        },
        _ => error
            .to_string()
            .lines()
            .next()
            .unwrap_or_default()
            .replace("error: ", ""),
    };
    let command = std::env::args()
        .nth(1)
        .filter(|word| commands.contains(&word.as_str()));
    format!(
        "{fault}; see `splitsum{} --help`",
        command.map_or_else(String::new, |name| format!(" {name}"))
    )
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
    match progress::beside(|| std::io::stdout().write_all(text.as_bytes())) {
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
    let _ = progress::beside(|| writeln!(std::io::stderr(), "{}", lines.join("\n")));
}

fn warn_all(name: &str, warnings: &[String]) {
    warnings.iter().for_each(|warning| warn(name, warning));
}

fn warn(name: &str, warning: &str) {
    log(&format!("warning: {name}: {warning}"));
}
