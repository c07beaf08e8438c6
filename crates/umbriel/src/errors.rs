//! What the program says and returns when something goes wrong.

use crate::say::say;
use serde_json::{Value, json};
use umbriel_formats::{ErrorKind, FileError, Place};

/// Exit codes; they are documented in `--help` and never change their meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Exit {
    Different = 1,
    Usage = 2,
    Input = 3,
    Io = 4,
    Limit = 5,
    Internal = 70,
    Interrupted = 130,
}

impl Exit {
    fn name(self) -> &'static str {
        match self {
            Self::Different => "different",
            Self::Usage => "usage",
            Self::Input => "input",
            Self::Io => "io",
            Self::Limit => "limit",
            Self::Internal => "internal",
            Self::Interrupted => "interrupted",
        }
    }
}

/// Why a command ends without success.
#[derive(Debug)]
pub(crate) struct Failure {
    pub(crate) exit: Exit,
    /// One line; for a file it begins with the file and the place. Empty: there is nothing to say.
    pub(crate) message: String,
    /// Source lines with a caret.
    pub(crate) snippet: Option<String>,
    /// The file in which it is, and where.
    file: Option<(String, Place)>,
}

impl Failure {
    pub(crate) fn new(exit: Exit, message: impl Into<String>) -> Self {
        Self {
            exit,
            message: message.into(),
            snippet: None,
            file: None,
        }
    }

    pub(crate) fn usage(message: impl Into<String>) -> Self {
        Self::new(Exit::Usage, message)
    }

    /// Ends the program without a word.
    pub(crate) fn silent(exit: Exit) -> Self {
        Self::new(exit, "")
    }

    /// Writes the failure for people.
    pub(crate) fn print(&self) {
        if self.message.is_empty() {
            return;
        }
        say(&format!("error: {}", self.message));
        for line in self.snippet.iter().flat_map(|snippet| snippet.lines()) {
            say(line);
        }
    }

    /// The failure for programs.
    pub(crate) fn to_json(&self) -> Value {
        let (file, place) = match &self.file {
            Some((file, place)) => (json!(file), place_json(place)),
            None => (Value::Null, Value::Null),
        };
        json!({ "error": {
            "exit_code": self.exit as u8,
            "kind": self.exit.name(),
            "message": self.message,
            "file": file,
            "place": place,
        } })
    }
}

fn place_json(place: &Place) -> Value {
    match place {
        Place::File => Value::Null,
        Place::Line(line, column) => json!({ "line": line, "column": column }),
        Place::Pointer(pointer) => json!({ "pointer": pointer }),
        Place::Byte(byte) => json!({ "byte": byte }),
    }
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        Self {
            exit: match error.kind {
                ErrorKind::Input => Exit::Input,
                ErrorKind::Io => Exit::Io,
                ErrorKind::Limit => Exit::Limit,
            },
            message: error.to_string(),
            snippet: error.snippet,
            file: Some((error.file.display().to_string(), error.place)),
        }
    }
}
