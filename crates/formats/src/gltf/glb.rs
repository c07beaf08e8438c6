//! The container of binary glTF: a header and chunks.

use crate::{FileError, Place};
use std::path::Path;

const JSON: u32 = 0x4E4F_534A;
const BIN: u32 = 0x004E_4942;

/// The JSON chunk and the binary chunk of a .glb file.
///
/// Every length is compared with the bytes that are there; unknown chunks are skipped.
///
/// Source: Khronos, glTF 2.0 specification, section 4.4, "Binary glTF Layout".
pub(super) fn split_glb<'a>(
    path: &Path,
    bytes: &'a [u8],
) -> Result<(&'a [u8], Option<&'a [u8]>), FileError> {
    let fail =
        |at: usize, message: String| Err(FileError::input(path, Place::Byte(at as u64), message));
    let length = read_length(path, bytes)?;
    let (mut json, mut binary) = (None, None);
    let mut at = 12;
    while at < length {
        let (Some(size), Some(kind)) = (word(bytes, at), word(bytes, at + 4)) else {
            return fail(
                at,
                "the file ends inside the header of a chunk; expected 8 bytes".to_owned(),
            );
        };
        let start = at + 8;
        let left = length.saturating_sub(start);
        if size as usize > left {
            return fail(
                at,
                format!("a chunk has {size} bytes; the file has only {left} left"),
            );
        }
        let end = start + size as usize;
        match (kind, json.is_some()) {
            (JSON, false) => json = Some(&bytes[start..end]),
            (JSON, true) => return fail(at, "is a second JSON chunk; expected one".to_owned()),
            (_, false) => return fail(at, "the first chunk is not JSON".to_owned()),
            (BIN, true) if binary.is_none() => binary = Some(&bytes[start..end]),
            _ => {}
        }
        at = end;
    }
    match json {
        Some(json) => Ok((json, binary)),
        None => fail(12, "the file has no JSON chunk".to_owned()),
    }
}

/// The length of the file as its header says, which is no more than there is.
fn read_length(path: &Path, bytes: &[u8]) -> Result<usize, FileError> {
    let fail =
        |at: usize, message: String| Err(FileError::input(path, Place::Byte(at as u64), message));
    if !bytes.starts_with(b"glTF") {
        return fail(
            0,
            "is not binary glTF; expected the letters glTF".to_owned(),
        );
    }
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return fail(
            bytes.len(),
            "the file ends inside its header; expected 12 bytes".to_owned(),
        );
    };
    if version != 2 {
        return fail(
            4,
            format!("is binary glTF of version {version}; expected 2"),
        );
    }
    let length = length as usize;
    if length > bytes.len() {
        return fail(
            8,
            format!(
                "the header says {length} bytes; the file has only {}",
                bytes.len()
            ),
        );
    }
    Ok(length)
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}
