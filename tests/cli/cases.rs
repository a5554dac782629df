//! Named cases in text files below `tests/golden`: the files that a command reads, the command,
//! and its answer.
//!
//! ```text
//! What these cases have in common.
//!
//! ## width-too-narrow
//! # Why this case is here.
//! --- widths.csv
//! brdf,alpha,n_dot_v
//! ggx,1e-300,0.5
//! ---
//! $ integrate widths.csv --kind dfg
//! [2] widths.csv:2:alpha: 1e-300 is below 0.0001, the narrowest lobe that is integrated
//! ```
//!
//! A case may have several files and several commands. All cases of a file run in one folder, in
//! order, so a later command may read what an earlier one wrote.

use super::{entries, golden};
use std::path::{Path, PathBuf};

/// The cases of one file.
pub struct Cases {
    path: PathBuf,
    /// The text before the first case.
    head: String,
    pub cases: Vec<Case>,
}

#[derive(Default)]
pub struct Case {
    pub name: String,
    /// Lines that begin with `#`.
    notes: Vec<String>,
    files: Vec<InputFile>,
    pub runs: Vec<Run>,
}

struct InputFile {
    name: String,
    text: String,
}

/// A command without the name of the program, and its kept answer.
pub struct Run {
    pub command: String,
    pub answer: String,
}

impl Cases {
    /// Reads `tests/golden/NAME.txt`.
    pub fn read(name: &str) -> Self {
        let path = golden().join(format!("{name}.txt"));
        let text = std::fs::read_to_string(&path).unwrap();
        let mut parts = text.split("\n## ");
        let head = parts.next().unwrap().to_owned();
        let cases: Vec<Case> = parts.map(Case::parse).collect();
        for (index, case) in cases.iter().enumerate() {
            let is_new = cases[..index].iter().all(|other| other.name != case.name);
            assert!(is_new, "{name}: two cases have the name {}", case.name);
            assert!(!case.runs.is_empty(), "{name}: {} runs nothing", case.name);
        }
        Self { path, head, cases }
    }

    /// Reads every file of a folder of `tests/golden`, by name.
    pub fn folder(name: &str) -> Vec<Self> {
        let files = entries(&golden().join(name));
        let stems = files.iter().map(|file| file.strip_suffix(".txt").unwrap());
        stems
            .map(|stem| Self::read(&format!("{name}/{stem}")))
            .collect()
    }

    /// Writes the files of all cases into a folder.
    pub fn unpack(&self, dir: &Path) {
        for file in self.cases.iter().flat_map(|case| &case.files) {
            let path = dir.join(&file.name);
            let is_same = std::fs::read_to_string(&path).is_ok_and(|text| text == file.text);
            assert!(!path.exists() || is_same, "two files are {}", file.name);
            std::fs::write(path, &file.text).unwrap();
        }
    }

    /// Compares the answer to every command with the kept one; each failure begins with the names
    /// of file and case. With `INSTA_UPDATE=always` it writes these answers instead.
    pub fn check(
        mut self,
        mut answer: impl FnMut(&str) -> String,
        mut difference: impl FnMut(&str, &str) -> Option<String>,
    ) -> Vec<String> {
        let is_update = std::env::var_os("INSTA_UPDATE").is_some_and(|update| update == "always");
        let file = self.path.file_stem().unwrap().to_string_lossy();
        let mut failures = Vec::new();
        for case in &mut self.cases {
            for run in &mut case.runs {
                let found = answer(&run.command).trim_end().to_owned();
                let Some(difference) = difference(&found, &run.answer) else {
                    continue;
                };
                if is_update {
                    run.answer = found;
                } else {
                    failures.push(format!(
                        "{file}/{}: {}\n{difference}",
                        case.name, run.command
                    ));
                }
            }
        }
        if is_update {
            self.write();
        }
        failures
    }

    fn write(&self) {
        let mut text = format!("{}\n", self.head.trim_end());
        for case in &self.cases {
            text += &case.text();
        }
        std::fs::write(&self.path, text).unwrap();
    }
}

impl Case {
    /// Parses the text after `## `.
    fn parse(text: &str) -> Self {
        let mut lines = text.lines();
        let mut case = Self {
            name: lines.next().unwrap().to_owned(),
            ..Self::default()
        };
        while let Some(line) = lines.next() {
            if let Some(name) = line.strip_prefix("--- ") {
                let body = lines.by_ref().take_while(|line| *line != "---");
                let text = body.map(|line| format!("{line}\n")).collect();
                case.files.push(InputFile {
                    name: name.to_owned(),
                    text,
                });
            } else if let Some(command) = line.strip_prefix("$ ") {
                case.runs.push(Run {
                    command: command.to_owned(),
                    answer: String::new(),
                });
            } else if let Some(run) = case.runs.last_mut() {
                run.answer += line;
                run.answer.push('\n');
            } else {
                assert!(line.starts_with('#'), "{}: {line:?}", case.name);
                case.notes.push(line.to_owned());
            }
        }
        for run in &mut case.runs {
            run.answer.truncate(run.answer.trim_end().len());
        }
        case
    }

    fn text(&self) -> String {
        let mut text = format!("\n## {}\n", self.name);
        for note in &self.notes {
            text += &format!("{note}\n");
        }
        for file in &self.files {
            text += &format!("--- {}\n{}---\n", file.name, file.text);
        }
        for run in &self.runs {
            let is_plain = |line: &str| !["## ", "--- ", "$ "].iter().any(|s| line.starts_with(s));
            assert!(run.answer.lines().all(is_plain), "{}", run.answer);
            text += &format!("$ {}\n{}\n", run.command, run.answer);
        }
        text
    }
}
