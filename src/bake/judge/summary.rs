//! The verdict of a whole bake as a sentence.

use super::bake::Judged;
use super::clause::{Clause, joined, with_first};
use super::level::LevelScore;
use super::verdict::{Part, PartVerdict};
use super::{Cause, words};

impl Judged {
    /// Summarises the faults in one line, faults of several levels first; `None` without faults.
    pub fn wrong(&self) -> Option<String> {
        self.wrong_clauses().map(|clauses| joined(&clauses))
    }

    /// Sums up the whole bake in one line.
    pub fn verdict(&self) -> String {
        joined(&self.verdict_clauses())
    }

    /// Returns the verdict as clauses, the most important first.
    pub fn verdict_clauses(&self) -> Vec<Clause> {
        self.wrong_clauses()
            .unwrap_or_else(|| vec![self.good_clause()])
    }

    fn wrong_clauses(&self) -> Option<Vec<Clause>> {
        let faults = self.faults()?;
        Some(with_first(faults, |clause| clause.under("wrong")))
    }

    fn good_clause(&self) -> Clause {
        let coarsest = self
            .levels
            .iter()
            .filter_map(LevelScore::coarseness)
            .max_by(f64::total_cmp);
        let is_table = self.axes.is_empty() && self.sh.is_none();
        match coarsest {
            Some(relmse) => Clause::detailed(
                "good, but coarse",
                format!(
                    "lookups between texels err by up to {:.1} % rms",
                    100.0 * relmse.sqrt()
                ),
            ),
            None if is_table => Clause::detailed(
                "good",
                "the DFG table is within a step of 8 bits of its integral",
            ),
            None => Clause::detailed("good", "every part is within 3 % rms of its integral"),
        }
    }

    /// Lists the cause in the whole bake and faults besides, else the faults of parts.
    fn faults(&self) -> Option<Vec<Clause>> {
        let Some(whole) = self.whole_cause() else {
            return self.faults_of_parts();
        };
        let mut clauses = whole.clauses();
        if let Some(fixed) = &self.fixed {
            match fixed.faults() {
                Some(more) => clauses.extend(with_first(more, |clause| clause.after("besides, "))),
                None => clauses.push(Clause::new("nothing else")),
            }
        }
        Some(clauses)
    }

    fn faults_of_parts(&self) -> Option<Vec<Clause>> {
        let mut wrong: Vec<PartVerdict> = self
            .parts()
            .into_iter()
            .filter(|part| !part.verdict.is_good())
            .collect();
        wrong.sort_by_key(|part| {
            let is_of_levels = matches!(part.part, Part::Levels(..));
            // A cut costs more light than other slips.
            let is_cut = part.verdict.causes().iter().any(Cause::is_cut);
            [part.verdict.lacks_slip(), !is_cut, !is_of_levels]
        });
        if wrong.is_empty() {
            return None;
        }
        let mut clauses: Vec<Clause> = wrong.iter().flat_map(PartVerdict::clauses).collect();
        if !self.causes().iter().any(Cause::is_unknown) {
            let left = self
                .maps()
                .filter_map(LevelScore::left)
                .max_by(f64::total_cmp);
            clauses.extend(left.map(|left| {
                Clause::remainder(format!("{:.1} % rms if fixed", 100.0 * left.sqrt()))
            }));
        }
        Some(clauses)
    }
}

impl LevelScore {
    /// Returns its slip in words.
    pub fn slip_in_words(&self) -> Option<String> {
        self.slip.as_ref().map(|slip| words::sentence(&slip.causes))
    }
}
