//! Which format a file has, and its bytes, read with limits.

use crate::{FileError, Place, Report};
use std::{fs, io, path::Path};

/// Formats of models that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ModelFormat {
    Gltf,
    Glb,
    Obj,
    Ply,
    Stl,
}

/// Largest file that is read, in bytes.
pub(crate) const MAX_FILE: u64 = 2 << 30;

/// Reads a regular file of at most [`MAX_FILE`] bytes, and notes that it was read.
pub(crate) fn read_file(path: &Path, report: &mut Report) -> Result<Vec<u8>, FileError> {
    report.files.insert(path.to_owned());
    read_regular(path, MAX_FILE)
}

/// Reads a regular file of at most `limit` bytes.
///
/// Folders, pipes and devices are refused before they are opened: reading a pipe could wait for ever.
pub(crate) fn read_regular(path: &Path, limit: u64) -> Result<Vec<u8>, FileError> {
    let meta = fs::metadata(path).map_err(|error| FileError::io(path, &error))?;
    if meta.is_dir() {
        return Err(FileError::io(
            path,
            &io::Error::other("is a folder; expected a file"),
        ));
    }
    if !meta.is_file() {
        return Err(FileError::io(
            path,
            &io::Error::other("is a pipe or device; expected a regular file"),
        ));
    }
    if meta.len() > limit {
        let message = format!("has {} bytes; the limit is {limit} bytes", meta.len());
        return Err(FileError::limit(path, Place::File, message));
    }
    fs::read(path).map_err(|error| FileError::io(path, &error))
}

/// The format that the extension promises, if the first bytes do not say otherwise.
pub(crate) fn model_format(path: &Path, bytes: &[u8]) -> Result<ModelFormat, FileError> {
    let format = format_of_extension(path).ok_or_else(|| {
        let found = describe(bytes).map_or(String::new(), |what| format!(" (it is {what})"));
        let message = format!(
            "not a known extension{found}; expected .toml, .gltf, .glb, .obj, .ply or .stl"
        );
        FileError::input(path, Place::File, message)
    })?;
    match describe(bytes) {
        Some(what) if !agrees(format, what) => {
            let message = format!("is {what}; expected {}", expected(format));
            Err(FileError::input(path, Place::File, message))
        }
        _ => Ok(format),
    }
}

fn format_of_extension(path: &Path) -> Option<ModelFormat> {
    let extension = path.extension()?.to_str()?.to_ascii_lowercase();
    Some(match extension.as_str() {
        "gltf" => ModelFormat::Gltf,
        "glb" => ModelFormat::Glb,
        "obj" => ModelFormat::Obj,
        "ply" => ModelFormat::Ply,
        "stl" => ModelFormat::Stl,
        _ => return None,
    })
}

/// What files with these first bytes are.
const MAGIC: [(&[u8], &str); 15] = [
    (b"\x89PNG", "a PNG image"),
    (b"\xFF\xD8\xFF", "a JPEG image"),
    (b"GIF8", "a GIF image"),
    (b"\x76\x2F\x31\x01", "an OpenEXR image"),
    (b"#?RADIANCE", "a Radiance HDR image"),
    (b"glTF", GLB),
    (b"ply\n", PLY),
    (b"ply\r", PLY),
    (b"PK\x03\x04", "a ZIP archive (or USDZ, 3MF)"),
    (b"\x1F\x8B", "a gzip archive"),
    (b"RIFF", "a WebP image (or another RIFF file)"),
    (b"\xABKTX 20\xBB", "a KTX2 texture"),
    (b"%PDF", "a PDF document"),
    (b"Kaydara FBX", "an FBX file"),
    (b"PXR-USDC", "a USD file"),
];
const GLB: &str = "a binary glTF file (.glb)";
const PLY: &str = "a PLY file";

/// The name of what the first bytes show, if they show something.
pub(crate) fn describe(bytes: &[u8]) -> Option<&'static str> {
    MAGIC
        .iter()
        .find(|(magic, _)| bytes.starts_with(magic))
        .map(|(_, name)| *name)
}

fn agrees(format: ModelFormat, what: &str) -> bool {
    (format == ModelFormat::Glb && what == GLB) || (format == ModelFormat::Ply && what == PLY)
}

fn expected(format: ModelFormat) -> &'static str {
    match format {
        ModelFormat::Gltf => "a glTF file (JSON)",
        ModelFormat::Glb => GLB,
        ModelFormat::Obj => "a Wavefront OBJ file",
        ModelFormat::Ply => PLY,
        ModelFormat::Stl => "an STL file",
    }
}
