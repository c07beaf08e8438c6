//! The text of one scene file and where each of its keys and values stands.

use crate::{ErrorKind, FileError, Place, Report, sniff};
use std::{
    ops::Range,
    path::{Path, PathBuf},
};
use toml::de::{DeTable, DeValue};

/// Greatest size of a scene file, and of a scene with all its included files.
pub(super) const MAX_BYTES: u64 = 64 << 20;

/// Characters of a source line that a message shows.
const SNIPPET_WIDTH: usize = 100;

/// One step of a path into a document.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Step {
    Key(String),
    Index(usize),
}

/// Where one key with its value, or one element of an array, stands in the text.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub path: Vec<Step>,
    pub key: Range<usize>,
    pub value: Range<usize>,
}

/// Something wrong at a place of a text.
#[derive(Debug)]
pub(super) struct Fault {
    pub kind: ErrorKind,
    pub span: Range<usize>,
    pub message: String,
}

impl Fault {
    pub(super) fn new(span: Range<usize>, message: impl Into<String>) -> Self {
        Self {
            kind: ErrorKind::Input,
            span,
            message: message.into(),
        }
    }
}

/// A scene file in memory.
///
/// Spans past the end of the text stand for `-D` overrides: `text.len() + 1 + i` is the `i`-th.
#[derive(Debug)]
pub(super) struct Source {
    pub path: PathBuf,
    pub text: String,
    pub entries: Vec<Entry>,
    pub overrides: Vec<(String, String)>,
}

impl Source {
    /// Reads a file, without judging more than its size and encoding.
    pub(super) fn read(path: &Path, report: &mut Report) -> Result<Self, FileError> {
        report.files.insert(path.to_owned());
        let mut bytes = sniff::read_regular(path, MAX_BYTES)?;
        if let Some(what) = sniff::describe(&bytes) {
            let message = format!("is {what}; expected a scene in TOML");
            return Err(FileError::input(path, Place::File, message));
        }
        if bytes.starts_with(b"\xEF\xBB\xBF") {
            bytes.drain(..3);
        }
        let text = String::from_utf8(bytes).map_err(|error| {
            let at = error.utf8_error().valid_up_to();
            FileError::input(
                path,
                Place::Byte(at as u64),
                "is not UTF-8 text; expected a scene in TOML",
            )
        })?;
        Ok(Self {
            path: path.to_owned(),
            text,
            entries: Vec::new(),
            overrides: Vec::new(),
        })
    }

    /// The span that stands for an override.
    pub(super) fn override_span(&self, index: usize) -> Range<usize> {
        let at = self.text.len() + 1 + index;
        at..at + 1
    }

    /// The error to show for a fault.
    pub(super) fn error(&self, fault: Fault) -> FileError {
        if let Some(index) = fault.span.start.checked_sub(self.text.len() + 1)
            && let Some((key, value)) = self.overrides.get(index)
        {
            return FileError {
                kind: fault.kind,
                ..FileError::input(format!("-D {key}={value}"), Place::File, fault.message)
            };
        }
        let (line, column) = self.line_column(fault.span.start);
        FileError {
            kind: fault.kind,
            snippet: Some(self.snippet(&fault.span)),
            ..FileError::input(&self.path, Place::Line(line, column), fault.message)
        }
    }

    /// Line and column of a byte, both from 1; the column counts characters.
    pub(super) fn line_column(&self, byte: usize) -> (usize, usize) {
        let byte = floor_char(&self.text, byte);
        let before = &self.text[..byte];
        let start = before.rfind('\n').map_or(0, |i| i + 1);
        (
            before.matches('\n').count() + 1,
            before[start..].chars().count() + 1,
        )
    }

    /// The source line of a span with carets below it, cut to a window around the span.
    fn snippet(&self, span: &Range<usize>) -> String {
        let (line, column) = self.line_column(span.start);
        let at = floor_char(&self.text, span.start);
        let start = self.text[..at].rfind('\n').map_or(0, |i| i + 1);
        let source = self.text[start..]
            .split('\n')
            .next()
            .unwrap_or_default()
            .trim_end_matches('\r');
        let skip = column.saturating_sub(SNIPPET_WIDTH / 2);
        let shown: Vec<char> = source.chars().skip(skip).take(SNIPPET_WIDTH).collect();
        // Tabs and control characters have no width of their own that carets could follow.
        let shown: String = shown
            .into_iter()
            .map(|c| if c.is_control() { ' ' } else { c })
            .collect();
        let end = floor_char(
            &self.text,
            span.end.clamp(at, start + source.len().max(at - start)),
        );
        let width = self.text[at..end.max(at)].chars().count();
        let left = column - 1 - skip.min(column - 1);
        let carets = "^".repeat(width.clamp(1, SNIPPET_WIDTH.saturating_sub(left).max(1)));
        let number = line.to_string();
        let margin = " ".repeat(number.len());
        format!(
            "{number} | {shown}\n{margin} | {}{carets}",
            " ".repeat(left)
        )
    }

    /// The entry at a path.
    pub(super) fn entry(&self, path: &[Step]) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.path == path)
    }

    /// The deepest entry whose key or value is, or else contains, `span`.
    pub(super) fn entry_at(&self, span: &Range<usize>) -> Option<&Entry> {
        let exact = self
            .entries
            .iter()
            .rev()
            .find(|e| e.key == *span || e.value == *span);
        exact.or_else(|| {
            let holds = |range: &Range<usize>| range.start <= span.start && span.end <= range.end;
            let holding = self
                .entries
                .iter()
                .filter(|e| holds(&e.key) || holds(&e.value));
            holding.max_by_key(|e| e.path.len())
        })
    }

    /// The value of `field` in a table, or the table's header where the field was not written.
    pub(super) fn span_of(
        &self,
        table: &str,
        index: Option<usize>,
        fields: &[&str],
    ) -> Range<usize> {
        let mut path = vec![Step::Key(table.to_owned())];
        path.extend(index.map(Step::Index));
        let header = self.entry(&path).map_or(0..0, |entry| entry.value.clone());
        for field in fields {
            path.push(Step::Key((*field).to_owned()));
            if let Some(entry) = self.entry(&path) {
                return entry.value.clone();
            }
            path.pop();
        }
        header
    }

    /// The value of `field` in the table `inner` of a table, or `inner` itself where the field was not written.
    pub(super) fn span_within(
        &self,
        table: &str,
        index: Option<usize>,
        inner: &str,
        field: &str,
    ) -> Range<usize> {
        let mut path = vec![Step::Key(table.to_owned())];
        path.extend(index.map(Step::Index));
        path.extend([inner, field].map(|key| Step::Key(key.to_owned())));
        match self.entry(&path) {
            Some(entry) => entry.value.clone(),
            None => self.span_of(table, index, &[inner]),
        }
    }
}

/// The start of the character that holds `byte`.
fn floor_char(text: &str, byte: usize) -> usize {
    let mut byte = byte.min(text.len());
    while !text.is_char_boundary(byte) {
        byte -= 1;
    }
    byte
}

/// Lists all keys and elements of a document.
pub(super) fn list_entries(table: &DeTable<'_>) -> Vec<Entry> {
    let mut entries = Vec::new();
    list_table(table, &mut Vec::new(), &mut entries);
    entries
}

/// The nesting is bounded by the parser.
fn list_table(table: &DeTable<'_>, path: &mut Vec<Step>, entries: &mut Vec<Entry>) {
    for (key, value) in table.iter() {
        path.push(Step::Key(key.get_ref().to_string()));
        list_value(value.get_ref(), key.span(), value.span(), path, entries);
        path.pop();
    }
}

fn list_value(
    value: &DeValue<'_>,
    key: Range<usize>,
    span: Range<usize>,
    path: &mut Vec<Step>,
    entries: &mut Vec<Entry>,
) {
    entries.push(Entry {
        path: path.clone(),
        key,
        value: span,
    });
    match value {
        DeValue::Table(table) => list_table(table, path, entries),
        DeValue::Array(array) if array.iter().any(|v| v.get_ref().is_table()) => {
            for (i, item) in array.iter().enumerate() {
                path.push(Step::Index(i));
                list_value(item.get_ref(), item.span(), item.span(), path, entries);
                path.pop();
            }
        }
        _ => {}
    }
}
