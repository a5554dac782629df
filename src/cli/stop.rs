//! Stops a run on Ctrl-C and, on Unix, on SIGTERM.

use super::{Failure, log};
use std::sync::atomic::{AtomicBool, Ordering};

/// Set by the first request. The second one ends the process.
pub static STOP: AtomicBool = AtomicBool::new(false);

/// Starts to handle requests.
#[cfg(unix)]
pub fn listen() -> Result<(), Failure> {
    use signal_hook::consts::{SIGINT, SIGTERM};
    // `nohup` ignores SIGHUP; a handler would undo that.
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM]).map_err(failure)?;
    std::thread::spawn(move || signals.forever().for_each(requested));
    Ok(())
}

/// Starts to handle requests.
#[cfg(not(unix))]
pub fn listen() -> Result<(), Failure> {
    const INTERRUPT: i32 = 2;
    ctrlc::set_handler(|| requested(INTERRUPT)).map_err(failure)
}

fn failure(error: impl std::fmt::Display) -> Failure {
    Failure::failed(format!("cannot handle Ctrl-C: {error}"))
}

fn requested(signal: i32) {
    if STOP.swap(true, Ordering::Relaxed) {
        // The exit code of a process ended by a signal.
        std::process::exit(128 + signal);
    }
    log("\nstopping after the current cell (Ctrl-C again: at once)");
}
