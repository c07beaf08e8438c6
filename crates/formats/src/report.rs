//! What a loader says beside the scene: what it left out, and what it decided.

use std::{
    borrow::Cow,
    collections::{BTreeMap, BTreeSet},
    path::PathBuf,
};

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
    /// Every file that was read: the output must not be one of them, and a change of one is a change of the scene.
    pub files: BTreeSet<PathBuf>,
}

impl Report {
    /// Counts one more of `what`.
    pub fn ignore(&mut self, what: impl Into<String>) {
        self.ignore_n(what, 1);
    }

    /// Counts `n` more of `what`.
    pub fn ignore_n(&mut self, what: impl Into<String>, n: usize) {
        if n > 0 {
            *self
                .ignored
                .entry(one_line(&what.into()).into_owned())
                .or_default() += n;
        }
    }

    /// Says a decision.
    pub fn note(&mut self, line: impl Into<String>) {
        self.notes.push(one_line(&line.into()).into_owned());
    }
}

/// A text without control characters, which are shown as in Rust (`\n`): names of files and of what is in them may hold
/// line ends and commands to the terminal.
pub fn one_line(text: &str) -> Cow<'_, str> {
    if !text.contains(char::is_control) {
        return text.into();
    }
    let show = |c: char| {
        if c.is_control() {
            c.escape_default().to_string()
        } else {
            c.to_string()
        }
    };
    text.chars().map(show).collect()
}
