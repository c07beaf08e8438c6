//! What a loader says beside the scene: what it left out, and what it decided.

use std::collections::BTreeMap;

/// What was loaded, ignored and decided.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// Things in the file that have no effect on the picture, by name, with how often they occurred:
    /// "extension KHR_materials_sheen", "animation", "degenerate triangle". `--strict` makes them errors.
    pub ignored: BTreeMap<String, usize>,
    /// Decisions the user may want to know of, one line each: "no camera in the file: framed automatically".
    pub notes: Vec<String>,
    /// The scene had no light, and got a sky and a sun.
    pub daylight: bool,
}

impl Report {
    /// Counts one more of `what`.
    pub fn ignore(&mut self, what: impl Into<String>) {
        self.ignore_n(what, 1);
    }

    /// Counts `n` more of `what`.
    pub fn ignore_n(&mut self, what: impl Into<String>, n: usize) {
        if n > 0 {
            *self.ignored.entry(what.into()).or_default() += n;
        }
    }

    /// Says a decision.
    pub fn note(&mut self, line: impl Into<String>) {
        self.notes.push(line.into());
    }
}
