//! Writing a file whole or not at all.

use crate::FileError;
use std::{
    fs, io,
    io::Write,
    path::{Path, PathBuf},
    process,
};

/// Longest chain of symbolic links, as in Linux.
const MAX_LINKS: usize = 40;
/// Most names that are tried for a temporary file.
const MAX_NAMES: usize = 100;

/// Finds out, before any work is done, whether `path` can be written, and changes nothing.
///
/// Refuses a missing or read-only folder, what is no regular file in the file's place (a folder, a pipe, a device), a
/// read-only file, a name that the system does not take, and one of the `inputs` under any of its names.
pub fn check_output(path: &Path, inputs: &[&Path]) -> Result<(), FileError> {
    let target = resolve(path)?;
    let folder = folder_of(&target);
    if !folder.is_dir() {
        let message = format!(
            "the folder {} does not exist; make it first",
            folder.display()
        );
        return Err(refuse(path, &message));
    }
    check_inputs(path, inputs)?;
    match fs::metadata(&target) {
        Ok(meta) if meta.is_dir() => {
            return Err(refuse(path, "is a folder; expected the name of a file"));
        }
        Ok(meta) if !meta.is_file() => {
            return Err(refuse(
                path,
                "is a pipe or device; expected the name of a file",
            ));
        }
        Ok(meta) if meta.permissions().readonly() => {
            return Err(refuse(path, "is read-only; nothing was written"));
        }
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            return Err(FileError::io(path, &error));
        }
        _ => {}
    }
    // The only sure way to learn whether a file can be made in a folder is to make one.
    let (probe, _) = create_temporary(&target).map_err(|error| FileError::io(path, &error))?;
    fs::remove_file(&probe).map_err(|error| FileError::io(path, &error))
}

/// Refuses a `path` that is one of the `inputs` under any of its names; the part of [`check_output`] to repeat when more
/// inputs are known.
pub fn check_inputs(path: &Path, inputs: &[&Path]) -> Result<(), FileError> {
    let Ok(target) = path.canonicalize() else {
        return Ok(());
    };
    let is_target = |input: &Path| input.canonicalize().is_ok_and(|input| input == target);
    if inputs.iter().copied().any(is_target) {
        return Err(refuse(
            path,
            "is an input; expected another name for the output",
        ));
    }
    Ok(())
}

/// Writes `bytes` to a temporary file in the same folder and renames it to `path`.
///
/// Whoever opens `path` finds the old file or the new one, whole, even after a crash of the program or
/// the machine: the bytes are on the disk before the name changes. Of two programs that write to one
/// path, one wins.
/// A symbolic link stays one: its target is replaced, or made.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    let fail = |error: io::Error| {
        let message = format!(
            "{error}; {} bytes were to be written, and nothing was changed",
            bytes.len()
        );
        FileError {
            message,
            ..FileError::io(path, &error)
        }
    };
    let target = resolve(path)?;
    if fs::metadata(&target).is_ok_and(|meta| !meta.is_file()) {
        // A rename would put a file in the place of a device for everybody.
        return Err(refuse(path, "is no regular file; nothing was changed"));
    }
    let (temporary, mut file) = create_temporary(&target).map_err(fail)?;
    let written = file
        .write_all(bytes)
        .and_then(|()| file.sync_data())
        .and_then(|()| fs::rename(&temporary, &target));
    written.map_err(|error| {
        // The first error is the one to tell.
        let _ = fs::remove_file(&temporary);
        fail(error)
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

/// The file that a chain of symbolic links ends at, which need not exist.
fn resolve(path: &Path) -> Result<PathBuf, FileError> {
    let mut target = path.to_owned();
    for _ in 0..MAX_LINKS {
        match fs::read_link(&target) {
            Ok(next) => target = folder_of(&target).join(next),
            Err(_) => return Ok(target),
        }
    }
    Err(refuse(
        path,
        "is a symbolic link that leads nowhere; expected the name of a file",
    ))
}

/// A new file beside `path` with a hidden name. The name of an older process that was killed may be left over.
fn create_temporary(path: &Path) -> io::Result<(PathBuf, fs::File)> {
    let mut result = Err(io::ErrorKind::AlreadyExists.into());
    for attempt in 0..MAX_NAMES {
        let name = folder_of(path).join(format!(".umbriel-{}-{attempt}.tmp", process::id()));
        result = fs::File::options()
            .write(true)
            .create_new(true)
            .open(&name)
            .map(|file| (name, file));
        if !matches!(&result, Err(error) if error.kind() == io::ErrorKind::AlreadyExists) {
            break;
        }
    }
    result
}
