//! The names in the documents: each axis, method, metric, question, experiment and flag exists.
//!
//! A name is a text in backquotes. Files of the repository exist, too. Four rules find a name, from
//! the strictest to the loosest:
//!
//! 1. A command (`splitsum bake --for bevy`, `--set alpha=1`): the command, its flags, and values
//!    of axes exist.
//! 2. After a noun ("the axis `bend`", "the methods `a`, `b` and `c`"): the list of that noun has
//!    it.
//! 3. A setting (`dfg = "centres"`): the axis takes the value.
//! 4. Any other word in lower case (`split_error`, `sh9`, `split-sum-*`): the program lists it, or
//!    its code has that word outside of comments.

use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd};
use splitsum::experiment::axis::Named;
use splitsum::experiment::config::NOISE_SHARE_KEY;
use splitsum::instrument::metrics::METRICS;
use splitsum::instrument::shade::{DIFFUSE, METHODS};
use splitsum::study::questions::QUESTIONS;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

/// Names that the program does not have, and why they are right.
const EXCEPTIONS: &[(&str, &str)] = &[
    ("--bevy", "a flag of scripts/check-clients.sh"),
    ("--filament", "a flag of scripts/check-clients.sh"),
    ("--features", "a flag of cargo"),
    (
        "--validation",
        "a flag of `view` for tests, absent from its help",
    ),
    ("--icc-type", "a flag of darktable-cli"),
    ("--no-mirror", "a flag of cmgen"),
    ("--resize:filter", "a flag of oiiotool"),
    ("--tocolorspace", "a flag of oiiotool"),
    ("all", "every method or family, in `cost`"),
    ("axis", "a placeholder in `--set axis=v1,v2`"),
    (
        "egui-ash-renderer",
        "a crate for other versions of egui than ours",
    ),
    ("dfg_lut", "the name that other programs give the DFG table"),
    ("lights_fragment_maps", "a shader chunk of three.js"),
    ("sat", "a function in a formula"),
    ("two-words", "a placeholder"),
    ("v360", "a filter of ffmpeg"),
];

/// Folders and files whose words the documents may name.
const CODE: &[&str] = &[
    "Cargo.toml",
    "assets/bakes",
    "assets/report",
    "examples",
    "experiments",
    "python/src",
    "python/package/splitsum",
    "scripts",
    "shaders",
    "src",
    "tests",
];

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Noun {
    Axis,
    Method,
    DiffuseMethod,
    Metric,
    Question,
    Experiment,
}

impl Noun {
    /// Returns the noun that ends a text: "the diffuse methods " ends with one.
    fn at_end_of(text: &str) -> Option<Self> {
        let mut words = text.split_whitespace().rev();
        let last = words.next()?.to_lowercase();
        let last = last.trim_start_matches('(');
        let is_diffuse = words.next().is_some_and(|word| word == "diffuse");
        match last {
            "axis" | "axes" => Some(Self::Axis),
            "method" | "methods" if is_diffuse => Some(Self::DiffuseMethod),
            "method" | "methods" => Some(Self::Method),
            "metric" | "metrics" => Some(Self::Metric),
            "question" | "questions" => Some(Self::Question),
            "experiment" | "experiments" => Some(Self::Experiment),
            _ => None,
        }
    }

    fn word(self) -> &'static str {
        match self {
            Self::Axis => "an axis",
            Self::Method => "a method",
            Self::DiffuseMethod => "a diffuse method",
            Self::Metric => "a metric",
            Self::Question => "a question",
            Self::Experiment => "an experiment",
        }
    }
}

static PROGRAM: LazyLock<Program> = LazyLock::new(Program::load);

/// What the program has.
struct Program {
    listed: BTreeMap<Noun, BTreeSet<String>>,
    /// The flags of each command.
    flags: BTreeMap<String, BTreeSet<String>>,
    /// The arguments of `splitsum list`.
    topics: BTreeSet<String>,
    /// Every name that `splitsum list` prints, and every column of a table.
    names: BTreeSet<String>,
    /// Every word of the code.
    words: BTreeSet<String>,
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn output_of(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_splitsum"))
        .args(arguments)
        .output()
        .unwrap();
    assert!(output.status.success(), "splitsum {arguments:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// Lists the first cells of the rows of all Markdown tables.
fn first_cells(text: &str) -> impl Iterator<Item = &str> {
    text.lines()
        .filter_map(|line| line.strip_prefix('|')?.split('|').next())
        .map(|cell| cell.trim().trim_matches('`'))
}

/// Lists the commands of the program from its help.
fn commands() -> BTreeSet<String> {
    let help = output_of(&["--help"]);
    let (_, rest) = help.split_once("Commands:\n").unwrap();
    rest.lines()
        .take_while(|line| !line.is_empty())
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next())
        .filter(|command| *command != "help")
        .map(str::to_owned)
        .collect()
}

fn flags_of(command: &str) -> BTreeSet<String> {
    output_of(&[command, "--help"])
        .lines()
        .map(str::trim_start)
        .filter(|line| line.starts_with('-'))
        .flat_map(|line| line.split([' ', ',', '=', '[']))
        .filter(|word| word.starts_with("--"))
        .map(str::to_owned)
        .collect()
}

fn files_below(path: &Path) -> Vec<PathBuf> {
    if path.is_file() {
        return vec![path.to_owned()];
    }
    let skipped = ["node_modules", "snapshots", "target", "documents.rs"];
    std::fs::read_dir(path)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| !skipped.iter().any(|name| path.ends_with(name)))
        .flat_map(|path| files_below(&path))
        .collect()
}

/// Collects the words of a file, with and without their hyphens: `split-sum`, `split`, `sum`.
fn collect_words(path: &Path, words: &mut BTreeSet<String>) {
    let stem = path.file_stem().unwrap().to_string_lossy().into_owned();
    words.insert(stem.replace('_', "-"));
    words.insert(stem);
    let Ok(text) = std::fs::read_to_string(path) else {
        return;
    };
    let is_code = |line: &&str| {
        !["//", "# "]
            .iter()
            .any(|mark| line.trim().starts_with(mark))
    };
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    for line in text.lines().filter(is_code) {
        let line = line.to_lowercase();
        for word in line.split(|c: char| !(is_part(c) || c == '-')) {
            words.extend(word.split('-').map(str::to_owned));
            words.insert(word.to_owned());
        }
    }
}

impl Program {
    fn load() -> Self {
        let names_of = |names: Vec<&str>| names.into_iter().map(str::to_owned).collect();
        let experiments = files_below(&root().join("experiments"))
            .into_iter()
            .filter(|path| path.extension().is_some_and(|end| end == "toml"))
            .map(|path| path.file_stem().unwrap().to_string_lossy().into_owned());
        let listed = BTreeMap::from([
            (
                Noun::Axis,
                names_of(Named::all().map(Named::name).collect()),
            ),
            (
                Noun::Method,
                names_of(METHODS.iter().map(|method| method.name).collect()),
            ),
            (
                Noun::DiffuseMethod,
                names_of(DIFFUSE.iter().map(|diffuse| diffuse.name).collect()),
            ),
            (
                Noun::Metric,
                names_of(METRICS.iter().map(|metric| metric.name).collect()),
            ),
            (
                Noun::Question,
                names_of(QUESTIONS.iter().map(|question| question.name).collect()),
            ),
            (Noun::Experiment, experiments.collect()),
        ]);
        let flags: BTreeMap<String, BTreeSet<String>> = commands()
            .into_iter()
            .map(|command| (command.clone(), flags_of(&command)))
            .collect();
        let lists = output_of(&["list"]);
        let columns = output_of(&["list", "columns"]);
        let mut topics: BTreeSet<String> = lists
            .lines()
            .filter_map(|line| line.strip_prefix("# "))
            .map(str::to_owned)
            .collect();
        topics.insert("columns".to_owned());
        let names = first_cells(&lists)
            .chain(first_cells(&columns))
            .map(str::to_owned)
            .chain(listed.values().flatten().cloned())
            .chain(flags.keys().cloned())
            .collect();
        let mut words = BTreeSet::new();
        for path in CODE.iter().flat_map(|path| files_below(&root().join(path))) {
            collect_words(&path, &mut words);
        }
        Self {
            listed,
            flags,
            topics,
            names,
            words,
        }
    }

    fn has_flag(&self, command: Option<&str>, flag: &str) -> bool {
        match command.and_then(|command| self.flags.get(command)) {
            Some(flags) => flags.contains(flag),
            None => self.flags.values().any(|flags| flags.contains(flag)),
        }
    }
}

/// Whether a name matches a pattern with at most one `*`.
fn matches(pattern: &str, name: &str) -> bool {
    match pattern.split_once('*') {
        Some((start, end)) => {
            name.len() >= start.len() + end.len() && name.starts_with(start) && name.ends_with(end)
        }
        None => pattern == name,
    }
}

/// Whether a text may be a name or, with a `*` or a first `-` or `_`, a part of one.
fn is_name(text: &str) -> bool {
    let is_part = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "-_*".contains(c);
    let start = text.trim_start_matches(['-', '_']);
    text.chars().all(is_part)
        && !text.starts_with("--")
        && start.starts_with(|c: char| c.is_ascii_lowercase())
}

/// Whether one of the names is the written one: `a-one`, `a-*`, or `-one` after it.
fn has(names: &BTreeSet<String>, written: &str) -> bool {
    if written.contains('*') {
        return names.iter().any(|name| matches(written, name));
    }
    names.contains(written)
        || written.starts_with(['-', '_']) && names.iter().any(|name| name.ends_with(written))
}

/// Whether a text only separates two names of a list.
fn is_joint(text: &str) -> bool {
    ["", ",", "and", "or", ", and", ", or", "to"].contains(&text.trim())
}

/// The faults of one document.
struct Check<'a> {
    program: &'a Program,
    page: &'a str,
    faults: Vec<String>,
    /// The exceptions that were needed.
    excepted: BTreeSet<&'static str>,
}

impl Check<'_> {
    fn fault(&mut self, name: &str, text: &str) {
        match EXCEPTIONS.iter().find(|(exception, _)| *exception == name) {
            Some((exception, _)) => {
                self.excepted.insert(exception);
            }
            None => self.faults.push(format!("{}: {text}", self.page)),
        }
    }

    /// Checks the words of a command line, or of flags alone. Returns whether it is one.
    fn command_line(&mut self, text: &str) -> bool {
        let mut words = text.split_whitespace().peekable();
        let first = words.peek().copied().unwrap_or_default();
        let is_program = first == "splitsum" || first.ends_with("/splitsum");
        if is_program {
            words.next();
        }
        let next = words.peek().copied().unwrap_or_default();
        if next.starts_with("--") {
            self.flags(None, &mut words);
            return true;
        }
        if !self.program.flags.contains_key(next) {
            if is_program && is_name(next) {
                self.fault(next, &format!("`{text}`: {next} is not a command"));
            }
            return is_program;
        }
        words.next();
        let rest: Vec<&str> = words.collect();
        if !is_program && rest.is_empty() {
            return false;
        }
        if next == "list" {
            for topic in rest.iter().filter(|word| is_name(word)) {
                if !self.program.topics.contains(*topic) {
                    self.fault(topic, &format!("`{text}`: {topic} is not listed"));
                }
            }
        }
        // Only a build with the window knows the flags of `view`.
        if next != "view" || cfg!(feature = "view") {
            self.flags(Some(next), &mut rest.into_iter().peekable());
        }
        true
    }

    fn flags<'w>(
        &mut self,
        command: Option<&str>,
        words: &mut std::iter::Peekable<impl Iterator<Item = &'w str>>,
    ) {
        while let Some(word) = words.next() {
            let (flag, joined) = match word.split_once('=') {
                Some((flag, value)) => (flag, Some(value)),
                None => (word, None),
            };
            let Some(name) = flag.strip_prefix("--") else {
                continue;
            };
            if !self.program.has_flag(command, flag) {
                let owner = command.unwrap_or("any command");
                self.fault(flag, &format!("{flag} is not a flag of {owner}"));
                continue;
            }
            let value = joined.or_else(|| words.next_if(|next| !next.starts_with("--")));
            let Some(value) = value else { continue };
            if name == "set" {
                self.setting(value);
            } else if let Some(axis) = Named::all().find(|axis| axis.flag() == name) {
                self.values(axis, value);
            }
        }
    }

    /// Checks `axis=value,value`.
    fn setting(&mut self, text: &str) {
        let (name, values) = text.split_once('=').unwrap_or((text, ""));
        match Named::all().find(|axis| axis.name() == name) {
            Some(axis) => self.values(axis, values),
            None if name == NOISE_SHARE_KEY => {}
            None => self.fault(name, &format!("`--set {text}`: {name} is not an axis")),
        }
    }

    fn values(&mut self, axis: Named, text: &str) {
        // A placeholder such as NAME or X is not a value.
        let is_placeholder = |value: &str| value.chars().all(|c| c.is_ascii_uppercase());
        if axis.parse_text(text).is_ok() {
            return;
        }
        for value in text.split(',').filter(|value| !is_placeholder(value)) {
            if let Err(fault) = axis.parse_text(value) {
                self.fault(value, &format!("{}: {fault}", axis.name()));
            }
        }
    }

    /// Checks `axis = "value"`. Returns whether it is a setting.
    fn quoted_setting(&mut self, text: &str) -> bool {
        let parts = text.split_once(" = \"");
        let Some((name, value)) =
            parts.and_then(|(name, rest)| Some((name, rest.strip_suffix('"')?)))
        else {
            return false;
        };
        if let Some(axis) = Named::all().find(|axis| axis.name() == name) {
            self.values(axis, value);
        }
        true
    }

    /// Checks that a file of the repository exists. Returns whether the text is a path.
    fn path(&mut self, text: &str) -> bool {
        let folders = ["docs/", "scripts/", "shaders/", "src/", "tests/"];
        let is_part = |c: char| c.is_ascii_alphanumeric() || "/_-.".contains(c);
        if !folders.iter().any(|folder| text.starts_with(folder)) || !text.chars().all(is_part) {
            return false;
        }
        // `src/instrument/brdf/x.rs` is a file to be written.
        let is_placeholder = Path::new(text).file_stem().is_some_and(|stem| stem == "x");
        if !is_placeholder && !root().join(text).exists() {
            self.fault(text, &format!("`{text}` is not a file of the repository"));
        }
        true
    }

    fn span(&mut self, text: &str, noun: Option<Noun>) {
        if self.path(text) || self.command_line(text) || self.quoted_setting(text) || !is_name(text)
        {
            return;
        }
        match noun {
            Some(noun) if !has(&self.program.listed[&noun], text) => {
                self.fault(text, &format!("`{text}` is not {}", noun.word()));
            }
            Some(_) => {}
            None if has(&self.program.names, text) || has(&self.program.words, text) => {}
            None => self.fault(text, &format!("`{text}` is not a name of the program")),
        }
    }

    /// Checks the lines of a code block that call the program.
    fn block(&mut self, text: &str) {
        for line in text.replace("\\\n", " ").lines() {
            let line = line.split(" #").next().unwrap_or_default().trim();
            let first = line.split_whitespace().next().unwrap_or_default();
            if first == "splitsum" || first.ends_with("/splitsum") {
                self.command_line(line);
            }
        }
    }

    fn markdown(&mut self, text: &str) {
        let mut before = String::new();
        let mut noun = None;
        let mut is_in_block = false;
        for event in Parser::new_ext(text, Options::ENABLE_TABLES) {
            match event {
                Event::Start(Tag::CodeBlock(_)) => is_in_block = true,
                Event::End(TagEnd::CodeBlock) => {
                    is_in_block = false;
                    self.block(&std::mem::take(&mut before));
                }
                Event::Text(text) => before += &text,
                Event::SoftBreak | Event::HardBreak => before.push(' '),
                Event::Code(name) if !is_in_block => {
                    if noun.is_none() || !is_joint(&before) {
                        noun = Noun::at_end_of(&before);
                    }
                    before.clear();
                    self.span(&name, noun);
                }
                // A link or an emphasis does not end a list of names.
                Event::Start(Tag::Link { .. } | Tag::Strong | Tag::Emphasis)
                | Event::End(TagEnd::Link | TagEnd::Strong | TagEnd::Emphasis) => {}
                _ => {
                    before.clear();
                    noun = None;
                }
            }
        }
    }
}

fn check<'a>(page: &'a str, text: &str) -> Check<'a> {
    let mut check = Check {
        program: &PROGRAM,
        page,
        faults: Vec::new(),
        excepted: BTreeSet::new(),
    };
    check.markdown(text);
    check
}

fn pages() -> Vec<PathBuf> {
    let documents = files_below(&root().join("docs")).into_iter();
    [root().join("README.md"), root().join("CONTRIBUTING.md")]
        .into_iter()
        .chain(documents.filter(|path| path.extension().is_some_and(|end| end == "md")))
        .collect()
}

#[test]
fn documents_name_what_the_program_has() {
    let mut faults = Vec::new();
    let mut excepted = BTreeSet::new();
    for path in pages() {
        let page = path
            .strip_prefix(root())
            .unwrap()
            .to_string_lossy()
            .into_owned();
        let check = check(&page, &std::fs::read_to_string(&path).unwrap());
        faults.extend(check.faults);
        excepted.extend(check.excepted);
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    let unused: Vec<&str> = EXCEPTIONS
        .iter()
        .map(|(name, _)| *name)
        .filter(|name| !excepted.contains(name))
        .collect();
    // A build without the window skips the flags of `view`.
    assert!(
        unused.is_empty() || cfg!(not(feature = "view")),
        "no document needs these exceptions: {unused:?}"
    );
}

#[test]
fn names_that_do_not_exist_are_reported() {
    let page = r#"
The axis `bent` and the axes `alpha`, `bend` or `lobe_width`. The method `split-sum-three`.
The diffuse methods `sh9`, `zh9` and `irradiance-map`. The metric `wpsnr`. The question `errors`.
The file `src/nowhere.rs`. The experiment `fronts`; `split-summed-*` and `-seventeen`; `relmse_of_nothing`.
Use `--sets`, `splitsum bakes`, `splitsum bake --with x`, `splitsum list knobs`, `run --for x`,
`--set width=1`, `--set bend=sideways`, `--method split-sum,split-sum-none`, `dfg = "middles"`.

| `split-sum-nowhere` | the axis |
|---|---|
| `alpha` | `render` |

    splitsum render --method split-sum \
        --lobe 3 --out ball.png   # --comment
    cargo build --no-such-flag

These exist: the axis `alpha`, the methods `split-sum-*`, `-four`, the metric `relmse`,
`splitsum bake my.hdr --for bevy`, `--set alpha=0.5,1`, `dfg = "centres"`, `n = 2`.
"#;
    let faults = check("page", page).faults;
    let expected = [
        "page: `bent` is not an axis",
        "page: `lobe_width` is not an axis",
        "page: `split-sum-three` is not a method",
        "page: `zh9` is not a diffuse method",
        "page: `wpsnr` is not a metric",
        "page: `errors` is not a question",
        "page: `src/nowhere.rs` is not a file of the repository",
        "page: `fronts` is not an experiment",
        "page: `split-summed-*` is not a name of the program",
        "page: `-seventeen` is not a name of the program",
        "page: `relmse_of_nothing` is not a name of the program",
        "page: --sets is not a flag of any command",
        "page: `splitsum bakes`: bakes is not a command",
        "page: --with is not a flag of bake",
        "page: `splitsum list knobs`: knobs is not listed",
        "page: --for is not a flag of run",
        "page: `--set width=1`: width is not an axis",
        "page: bend: ",
        "page: method: ",
        "page: dfg: ",
        "page: `split-sum-nowhere` is not a name of the program",
        "page: --lobe is not a flag of render",
    ];
    assert_eq!(faults.len(), expected.len(), "{}", faults.join("\n"));
    for (fault, start) in faults.iter().zip(expected) {
        assert!(fault.starts_with(start), "{fault} is not: {start}");
    }
}
