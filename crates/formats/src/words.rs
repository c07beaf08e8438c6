//! Words of a text file with their places.

use crate::{FileError, Place};
use std::{borrow::Cow, path::Path};

/// A text file that need not be UTF-8.
#[derive(Clone, Copy)]
pub(crate) struct Text<'a> {
    pub(crate) path: &'a Path,
    pub(crate) bytes: &'a [u8],
}

/// A run of bytes without white space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Word<'a> {
    /// Offset in the file.
    pub(crate) at: usize,
    pub(crate) bytes: &'a [u8],
}

impl<'a> Word<'a> {
    pub(crate) fn text(self) -> Cow<'a, str> {
        String::from_utf8_lossy(self.bytes)
    }

    /// The word in a message: at most 40 characters.
    pub(crate) fn show(self) -> String {
        let text = self.text();
        let short: String = text
            .chars()
            .take(40)
            .flat_map(char::escape_default)
            .collect();
        let more = if text.chars().nth(40).is_some() {
            "…"
        } else {
            ""
        };
        format!("\"{short}{more}\"")
    }

    pub(crate) fn is(self, keyword: &str) -> bool {
        self.bytes.eq_ignore_ascii_case(keyword.as_bytes())
    }

    pub(crate) fn parse<T: std::str::FromStr>(self) -> Option<T> {
        std::str::from_utf8(self.bytes).ok()?.parse().ok()
    }
}

impl<'a> Text<'a> {
    /// Skips the byte order mark, and refuses UTF-16, whose words would all be unknown.
    pub(crate) fn new(path: &'a Path, bytes: &'a [u8]) -> Result<Self, FileError> {
        if bytes.starts_with(b"\xFF\xFE") || bytes.starts_with(b"\xFE\xFF") {
            return Err(FileError::input(
                path,
                Place::Byte(0),
                "is UTF-16; expected UTF-8 or ASCII",
            ));
        }
        let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
        Ok(Self { path, bytes })
    }

    /// Line and column of an offset, both from 1; found only when an error needs them.
    pub(crate) fn place(&self, at: usize) -> Place {
        let before = &self.bytes[..at.min(self.bytes.len())];
        let ends_line = |i: usize| {
            before[i] == b'\n' || (before[i] == b'\r' && self.bytes.get(i + 1) != Some(&b'\n'))
        };
        let ends: Vec<usize> = (0..before.len()).filter(|&i| ends_line(i)).collect();
        let start = ends.last().map_or(0, |end| end + 1);
        let column = String::from_utf8_lossy(&before[start..]).chars().count() + 1;
        Place::Line(ends.len() + 1, column)
    }

    pub(crate) fn error(&self, at: usize, message: impl Into<String>) -> FileError {
        FileError::input(self.path, self.place(at), message)
    }

    /// "expected X" at a word, or at the end of the file.
    pub(crate) fn unexpected(&self, word: Option<Word>, expected: &str) -> FileError {
        match word {
            Some(word) => self.error(word.at, format!("{}; expected {expected}", word.show())),
            None => self.error(
                self.bytes.len(),
                format!("the file ends here; expected {expected}"),
            ),
        }
    }

    /// The words from `start` to `end`; a backslash before the end of a line counts as white space.
    pub(crate) fn words(&self, start: usize, end: usize) -> Words<'a> {
        Words {
            bytes: &self.bytes[..end],
            at: start,
        }
    }

    /// Start and end of each line; one that ends with a backslash goes on in the next.
    pub(crate) fn lines(&self) -> impl Iterator<Item = (usize, usize)> + use<'a> {
        let bytes = self.bytes;
        let mut start = 0;
        std::iter::from_fn(move || {
            if start >= bytes.len() {
                return None;
            }
            let mut end = start;
            while end < bytes.len() {
                let is_end = bytes[end] == b'\n' || bytes[end] == b'\r';
                let after_return =
                    bytes[end] == b'\n' && end > start + 1 && bytes[end - 1] == b'\r';
                let slash = if after_return {
                    end.checked_sub(2)
                } else {
                    end.checked_sub(1)
                };
                let goes_on = slash.is_some_and(|i| i >= start && bytes[i] == b'\\');
                if is_end && !goes_on {
                    break;
                }
                end += 1;
            }
            let line = (start, end);
            start = end + 1;
            Some(line)
        })
    }
}

/// Iterator over the words of a part of a text.
#[derive(Clone)]
pub(crate) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Words<'_> {
    /// The offset after the last word.
    pub(crate) fn position(&self) -> usize {
        self.at
    }
}

impl<'a> Iterator for Words<'a> {
    type Item = Word<'a>;

    fn next(&mut self) -> Option<Word<'a>> {
        let bytes = self.bytes;
        let space = |i: usize| {
            bytes[i].is_ascii_whitespace()
                || bytes[i] == 0x0B
                || (bytes[i] == b'\\' && matches!(bytes.get(i + 1), Some(b'\n' | b'\r') | None))
        };
        while self.at < bytes.len() && space(self.at) {
            self.at += 1;
        }
        let start = self.at;
        while self.at < bytes.len() && !space(self.at) {
            self.at += 1;
        }
        (self.at > start).then(|| Word {
            at: start,
            bytes: &bytes[start..self.at],
        })
    }
}
