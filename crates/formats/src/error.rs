//! What can go wrong with a file, and where.

use std::{fmt, path::PathBuf};

/// A position in an input file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    #[default]
    File,
    /// Line and column of a text, both counted from 1; columns count characters.
    Line(usize, usize),
    /// JSON pointer (RFC 6901), for glTF.
    Pointer(String),
    /// Offset of a byte, counted from 0, for binary formats.
    Byte(u64),
}

/// What kind of failure it is; the program maps it to an exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// The content of a file is wrong.
    Input,
    /// The operating system refused a file.
    Io,
    /// A size is over a limit.
    Limit,
}

/// An error in or with a file, shown as `FILE:PLACE: what; what was expected`.
#[derive(Clone, Debug)]
pub struct FileError {
    /// Which failure.
    pub kind: ErrorKind,
    /// Which file, as the user wrote it.
    pub file: PathBuf,
    /// Where in the file.
    pub place: Place,
    /// What is wrong; after a semicolon what was expected.
    pub message: String,
    /// Source lines with a caret, for texts; printed below the message.
    pub snippet: Option<String>,
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        match &self.place {
            Place::File => {}
            Place::Line(line, column) => write!(f, ":{line}:{column}")?,
            Place::Pointer(pointer) => write!(f, ":{pointer}")?,
            Place::Byte(byte) => write!(f, ":byte {byte}")?,
        }
        write!(f, ": {}", self.message)
    }
}

impl std::error::Error for FileError {}

impl FileError {
    /// Wrong content somewhere in `file`.
    pub fn input(file: impl Into<PathBuf>, place: Place, message: impl Into<String>) -> Self {
        Self {
            kind: ErrorKind::Input,
            file: file.into(),
            place,
            message: message.into(),
            snippet: None,
        }
    }

    /// The operating system's refusal, in its own words.
    pub fn io(file: impl Into<PathBuf>, error: &std::io::Error) -> Self {
        Self {
            kind: ErrorKind::Io,
            message: error.to_string(),
            ..Self::input(file, Place::File, "")
        }
    }

    /// A size over a limit.
    pub fn limit(file: impl Into<PathBuf>, place: Place, message: impl Into<String>) -> Self {
        Self {
            kind: ErrorKind::Limit,
            ..Self::input(file, place, message)
        }
    }
}
