//! How long work is followed: a bar with the time left on a terminal, one line a step elsewhere.

use super::tell;
use indicatif::{ProgressBar, ProgressStyle};
use splitsum::run::Progress;
use std::io::IsTerminal;

/// Progress on standard error.
#[derive(Debug, Default)]
pub struct Terminal {
    bar: Option<ProgressBar>,
    total: usize,
    done: usize,
}

impl Terminal {
    fn say(&self, text: &str) {
        match &self.bar {
            Some(bar) => bar.suspend(|| tell(text)),
            None => tell(text),
        }
    }
}

impl Progress for Terminal {
    fn start(&mut self, total: usize, done: usize) {
        (self.total, self.done) = (total, done);
        if done > 0 {
            self.say(&format!("{done} of {total} steps are done already"));
        }
        if done < total && std::io::stderr().is_terminal() {
            let style = ProgressStyle::with_template("{bar:30} {pos}/{len}  {elapsed} gone, {eta} left  {wide_msg}")
                .expect("the template is well-formed");
            let bar = ProgressBar::new(total as u64).with_style(style);
            bar.set_position(done as u64);
            // Steps of an earlier invocation took no time of this one.
            bar.reset_eta();
            self.bar = Some(bar);
        }
    }

    fn step(&mut self, label: &str, failure: Option<&str>) {
        self.done += 1;
        if let Some(bar) = &self.bar {
            bar.set_message(label.to_owned());
            bar.set_position(self.done as u64);
        }
        match failure {
            Some(reason) => self.say(&format!("[{}/{}] {label}: failed: {reason}", self.done, self.total)),
            None if self.bar.is_none() => self.say(&format!("[{}/{}] {label}", self.done, self.total)),
            None => {}
        }
        if let (Some(bar), true) = (&self.bar, self.done >= self.total) {
            bar.finish_and_clear();
        }
    }

    fn note(&mut self, text: &str) {
        self.say(text);
    }
}
