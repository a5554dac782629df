//! Progress on standard error: a bar on a terminal, elsewhere a line every few seconds.

use indicatif::{HumanDuration, ProgressBar, ProgressStyle};
use splitsum::base::names::printable;
use splitsum::run::Progress;
use splitsum::run::estimate::Ahead;
use std::io::{IsTerminal, Write};
use std::sync::{Mutex, MutexGuard, Once, PoisonError};
use std::time::{Duration, Instant};

const SILENT: Duration = Duration::from_secs(2);
/// The same for all phases of a command together: with a tick it ends within the first second.
const SILENT_PHASES: Duration = Duration::from_millis(700);
/// Time between lines; a hundredth of longer work.
const LINES_APART: Duration = Duration::from_secs(5);
/// Time between two drawings of the bar.
const TICK: Duration = Duration::from_millis(200);
const BAR_LENGTH: u64 = 1000;

static SHOWN: Mutex<Option<Shown>> = Mutex::new(None);

struct Shown {
    words: String,
    began: Instant,
    silent: Duration,
    /// Time of the last line.
    last_line: Instant,
    steps: Option<Steps>,
    bar: Option<ProgressBar>,
}

/// Work with a known number of steps.
struct Steps {
    total: usize,
    done: usize,
    /// Finished share, and seconds left at `updated`.
    ahead: Ahead,
    updated: Instant,
}

fn shown() -> MutexGuard<'static, Option<Shown>> {
    SHOWN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Starts work without steps.
pub fn doing(words: impl Into<String>) {
    follow(words.into(), None);
}

/// Starts the next phase of a command: time counts from its first one.
pub fn phase(words: impl Into<String>) {
    match &mut *shown() {
        Some(shown) if shown.silent == SILENT_PHASES => return shown.words = words.into(),
        _ => {}
    }
    doing(words);
    shown()
        .iter_mut()
        .for_each(|shown| shown.silent = SILENT_PHASES);
}

/// Starts work of `total` steps of about equal length; [`one_more`] ends each.
pub fn counting(words: impl Into<String>, total: usize) {
    follow(
        words.into(),
        Some(Steps {
            total,
            done: 0,
            ahead: Ahead::default(),
            updated: Instant::now(),
        }),
    );
}

pub fn one_more() {
    if let Some(Shown {
        steps: Some(steps),
        began,
        ..
    }) = &mut *shown()
    {
        let done = steps.done + 1;
        let left = steps.total.saturating_sub(done);
        steps.done = done;
        steps.ahead = Ahead {
            share: done as f64 / steps.total.max(1) as f64,
            seconds: began.elapsed().as_secs_f64() * left as f64 / done as f64,
        };
        steps.updated = Instant::now();
    }
}

pub fn end() {
    if let Some(Shown { bar: Some(bar), .. }) = shown().take() {
        bar.finish_and_clear();
    }
}

/// Writes while no bar is drawn.
pub fn without_bar<T>(write: impl FnOnce() -> T) -> T {
    match &*shown() {
        Some(Shown { bar: Some(bar), .. }) => bar.suspend(write),
        _ => write(),
    }
}

fn follow(words: String, steps: Option<Steps>) {
    static THREAD: Once = Once::new();
    end();
    let now = Instant::now();
    *shown() = Some(Shown {
        words,
        began: now,
        silent: SILENT,
        last_line: now,
        steps,
        bar: None,
    });
    THREAD.call_once(|| {
        std::thread::spawn(|| {
            loop {
                std::thread::sleep(TICK);
                shown().iter_mut().for_each(Shown::tick);
            }
        });
    });
}

impl Shown {
    fn tick(&mut self) {
        let elapsed = self.began.elapsed();
        // A run predicts its time from the first second.
        let is_due = elapsed >= self.silent
            || self
                .steps
                .as_ref()
                .is_some_and(|steps| steps.ahead.seconds > 0.0);
        if !std::io::stderr().is_terminal() {
            let apart = LINES_APART.max(elapsed / 100);
            let is_first = self.last_line == self.began && elapsed >= self.silent;
            if is_due && (is_first || self.last_line.elapsed() >= apart) {
                self.write_line();
            }
        } else if is_due {
            let message = self.message();
            let bar = self.bar.get_or_insert_with(|| {
                let template = if self.steps.is_some() {
                    "{bar:30} {wide_msg}"
                } else {
                    "{spinner} {wide_msg}"
                };
                ProgressBar::new(BAR_LENGTH).with_style(
                    ProgressStyle::with_template(template).expect("the template is well-formed"),
                )
            });
            if let Some(steps) = &self.steps {
                bar.set_position((steps.ahead.share * BAR_LENGTH as f64) as u64);
            }
            bar.set_message(message);
            bar.tick();
        }
    }

    fn write_line(&mut self) {
        self.last_line = Instant::now();
        // Nobody may be reading.
        let _ = writeln!(std::io::stderr(), "{}", printable(&self.message()));
    }

    fn message(&self) -> String {
        let gone = self.began.elapsed();
        match &self.steps {
            None => format!("{}: {}", self.words, HumanDuration(gone)),
            Some(Steps {
                total,
                done,
                ahead,
                updated,
            }) => {
                // A step that overruns takes no time from the steps behind it.
                let open = total.saturating_sub(*done).max(1) as f64;
                let behind = ahead.seconds * (open - 1.0) / open;
                let seconds = (ahead.seconds - updated.elapsed().as_secs_f64()).max(behind);
                let left = Duration::from_secs_f64(seconds.clamp(0.0, 1e9));
                let percent = 100.0 * ahead.share;
                format!(
                    "[{done}/{total}] {percent:.0} %, about {} left: {}",
                    HumanDuration(left),
                    self.words
                )
            }
        }
    }
}

#[derive(Debug, Default)]
pub struct Terminal;

impl Progress for Terminal {
    fn start(&mut self, total: usize, done: usize, ahead: Ahead) {
        if done > 0 {
            super::log(&format!("{done} of {total} steps are done already"));
        }
        if done >= total {
            return doing(END);
        }
        follow(
            STARTING.to_owned(),
            Some(Steps {
                total,
                done,
                ahead,
                updated: Instant::now(),
            }),
        );
    }

    fn step(&mut self, label: &str, failure: Option<&str>, ahead: Ahead) {
        let is_over = {
            let mut shown = shown();
            let Some(followed) = &mut *shown else { return };
            let is_first = followed.words == STARTING;
            label.clone_into(&mut followed.words);
            let Some(steps) = &mut followed.steps else {
                return;
            };
            steps.done += 1;
            steps.ahead = ahead;
            steps.updated = Instant::now();
            let is_over = steps.done >= steps.total;
            if (is_first || is_over) && failure.is_none() && !std::io::stderr().is_terminal() {
                followed.write_line();
            }
            is_over
        };
        if let Some(reason) = failure {
            super::log(&format!("{label}: failed: {reason}"));
        }
        if is_over {
            doing(END);
        }
    }

    fn open_again(&mut self, count: usize) {
        let mut shown = shown();
        if let Some(steps) = shown.as_mut().and_then(|followed| followed.steps.as_mut()) {
            steps.done = steps.done.saturating_sub(count);
        }
    }

    fn note(&mut self, text: &str) {
        super::log(text);
    }
}

const STARTING: &str = "starting";
const END: &str = "writing tables and contact sheets";
