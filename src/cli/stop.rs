//! How a run is asked to stop: Ctrl-C, and on Unix SIGTERM, as `kill`, schedulers and shutdowns send it.

use super::{Failure, tell};
use std::sync::atomic::{AtomicBool, Ordering};

/// Set by the first request. The second one ends the process at once.
pub static STOP: AtomicBool = AtomicBool::new(false);

/// Takes requests to stop from now on.
#[cfg(unix)]
pub fn listen() -> Result<(), Failure> {
    use signal_hook::consts::{SIGINT, SIGTERM};
    // Not SIGHUP: `nohup` has it ignored, and a handler would undo that.
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM]).map_err(failure)?;
    std::thread::spawn(move || signals.forever().for_each(requested));
    Ok(())
}

/// Takes requests to stop from now on.
#[cfg(not(unix))]
pub fn listen() -> Result<(), Failure> {
    /// The number of SIGINT.
    const INTERRUPT: i32 = 2;
    ctrlc::set_handler(|| requested(INTERRUPT)).map_err(failure)
}

fn failure(error: impl std::fmt::Display) -> Failure {
    Failure::failed(format!("Ctrl-C cannot be handled: {error}"))
}

fn requested(signal: i32) {
    if STOP.swap(true, Ordering::Relaxed) {
        // What shells report for a process that a signal ended.
        std::process::exit(128 + signal);
    }
    tell("\nstopping after the current cell (Ctrl-C again: at once)");
}
