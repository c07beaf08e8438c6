//! Writing a file whole or not at all.

use crate::FileError;
use std::{
    fs, io,
    io::Write,
    path::{Path, PathBuf},
    process,
};

/// Finds out, before any work is done, whether `path` can be written, and changes nothing.
///
/// Refuses a missing or read-only folder, a folder in the file's place, a read-only file, and one of the
/// `inputs` under any of its names.
pub fn check_output(path: &Path, inputs: &[&Path]) -> Result<(), FileError> {
    if path.is_dir() {
        return Err(refuse(path, "is a folder; expected the name of a file"));
    }
    let folder = folder_of(path);
    if !folder.is_dir() {
        let message = format!(
            "the folder {} does not exist; make it first",
            folder.display()
        );
        return Err(refuse(path, &message));
    }
    if let Ok(target) = path.canonicalize()
        && inputs
            .iter()
            .any(|input| input.canonicalize().is_ok_and(|input| input == target))
    {
        return Err(refuse(
            path,
            "is the input; expected another name for the output",
        ));
    }
    if fs::metadata(path).is_ok_and(|meta| meta.permissions().readonly()) {
        return Err(refuse(path, "is read-only; nothing was written"));
    }
    // The only sure way to learn whether a file can be made in a folder is to make one.
    let probe = temporary_name(&resolve(path));
    create(&probe).map_err(|error| FileError::io(path, &error))?;
    fs::remove_file(&probe).map_err(|error| FileError::io(path, &error))
}

/// Writes `bytes` to a temporary file in the same folder and renames it to `path`.
///
/// Whoever opens `path` finds the old file or the new one, whole, even after a crash of the program or
/// the machine: the bytes are on the disk before the name changes. Of two programs that write to one
/// path, one wins.
/// A symbolic link stays one: its target is replaced.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    let target = resolve(path);
    let temporary = temporary_name(&target);
    let written = create(&temporary)
        .and_then(|mut file| file.write_all(bytes).and_then(|()| file.sync_data()))
        .and_then(|()| fs::rename(&temporary, &target));
    written.map_err(|error| {
        // It may not exist; the first error is the one to tell.
        let _ = fs::remove_file(&temporary);
        let message = format!(
            "{error}; {} bytes were to be written, and nothing was changed",
            bytes.len()
        );
        FileError {
            message,
            ..FileError::io(path, &error)
        }
    })
}

fn refuse(path: &Path, message: &str) -> FileError {
    FileError::io(path, &io::Error::other(message))
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// The file that a chain of symbolic links ends at.
fn resolve(path: &Path) -> PathBuf {
    match fs::symlink_metadata(path) {
        Ok(meta) if meta.is_symlink() => path.canonicalize().unwrap_or_else(|_| path.to_owned()),
        _ => path.to_owned(),
    }
}

/// A hidden name beside `path` that another process does not use.
fn temporary_name(path: &Path) -> PathBuf {
    folder_of(path).join(format!(".umbriel-{}.tmp", process::id()))
}

fn create(path: &Path) -> io::Result<fs::File> {
    fs::File::options().write(true).create_new(true).open(path)
}
