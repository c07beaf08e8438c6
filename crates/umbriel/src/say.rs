//! Words for people, on standard error.

use std::io::Write;
use umbriel_formats::one_line;

/// Writes one line to standard error. Whether somebody reads it does not matter to the work: a closed pipe or a full
/// disk behind it is no reason to fail.
pub(crate) fn say(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{}", one_line(line));
}
