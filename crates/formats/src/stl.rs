//! STL, binary and text.

use crate::{
    FileError, Place, Report,
    words::{Text, Words},
};
use std::path::Path;
use umbriel_kernels::glam::Vec3;
use umbriel_render::Mesh;

/// Bytes before the triangles: 80 free ones and the number of triangles.
const HEADER: usize = 84;
/// Bytes of a triangle: normal, three corners, two free bytes.
const TRIANGLE: usize = 50;

/// The triangles of an STL file. Its normals are not used: they follow from the corners, and files often
/// have wrong ones.
///
/// Size decides before content does: a binary file may begin with "solid", as text files do.
///
/// Source: 3D Systems, StereoLithography Interface Specification, 1988.
pub(crate) fn read_stl(path: &Path, bytes: &[u8], report: &mut Report) -> Result<Mesh, FileError> {
    let without_mark = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let positions = if let Some(body) = [bytes, without_mark].into_iter().find_map(exact_binary) {
        read_binary(body)
    } else if looks_like_text(without_mark) {
        read_text(&Text::new(path, bytes)?)?
    } else {
        read_binary(inexact_binary(path, bytes, report)?)
    };
    let corners = u32::try_from(positions.len()).map_err(|_| {
        FileError::limit(
            path,
            Place::File,
            "has more than 2^32 corners; expected fewer",
        )
    })?;
    Ok(Mesh {
        positions,
        indices: (0..corners / 3)
            .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
            .collect(),
        ..Mesh::default()
    })
}

/// The size that the header of a binary file demands, and its triangle count.
fn demanded_size(bytes: &[u8]) -> Option<(u64, u32)> {
    let count = u32::from_le_bytes(bytes.get(80..HEADER)?.try_into().ok()?);
    Some((HEADER as u64 + TRIANGLE as u64 * u64::from(count), count))
}

fn exact_binary(bytes: &[u8]) -> Option<&[u8]> {
    let (size, _) = demanded_size(bytes)?;
    (size == bytes.len() as u64).then(|| &bytes[HEADER..])
}

/// "solid" at the start, and a keyword that follows its line soon.
fn looks_like_text(bytes: &[u8]) -> bool {
    let start = bytes.trim_ascii_start();
    if !start
        .get(..5)
        .is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
    {
        return false;
    }
    let line = start.iter().position(|&b| b == b'\n' || b == b'\r');
    let next = line.map_or(&[][..], |end| start[end..].trim_ascii_start());
    let has = |word: &[u8]| {
        next.get(..word.len())
            .is_some_and(|found| found.eq_ignore_ascii_case(word))
    };
    // All on one line, or a file that was cut: text as long as nothing in it is binary.
    has(b"facet") || has(b"endsolid") || start.iter().all(|&b| b >= 0x20 || b.is_ascii_whitespace())
}

/// A binary file with something after its triangles; one with too little is refused.
fn inexact_binary<'a>(
    path: &Path,
    bytes: &'a [u8],
    report: &mut Report,
) -> Result<&'a [u8], FileError> {
    let Some((size, count)) = demanded_size(bytes) else {
        let message = format!(
            "has {} bytes; expected at least {HEADER} of a binary STL file",
            bytes.len()
        );
        return Err(FileError::input(
            path,
            Place::Byte(bytes.len() as u64),
            message,
        ));
    };
    let len = bytes.len() as u64;
    if size > len {
        let message =
            format!("{count} triangles need {size} bytes; expected them, but the file has {len}");
        return Err(FileError::input(path, Place::Byte(80), message));
    }
    report.note(format!(
        "{}: {} bytes after the last triangle",
        path.display(),
        len - size
    ));
    Ok(&bytes[HEADER..size as usize])
}

fn read_binary(body: &[u8]) -> Vec<Vec3> {
    let float = |b: &[u8]| f32::from_le_bytes([b[0], b[1], b[2], b[3]]);
    let corner = |b: &[u8]| Vec3::new(float(b), float(&b[4..]), float(&b[8..]));
    let triangles = body.chunks_exact(TRIANGLE);
    triangles
        .flat_map(|t| [corner(&t[12..]), corner(&t[24..]), corner(&t[36..])])
        .collect()
}

/// `solid NAME {facet normal X Y Z outer loop {vertex X Y Z}³ endloop endfacet} endsolid NAME`, any number
/// of times, in any case.
fn read_text(text: &Text) -> Result<Vec<Vec3>, FileError> {
    let mut positions = Vec::new();
    let mut words = text.words(0, text.bytes.len());
    let mut in_solid = false;
    while let Some(word) = words.next() {
        if word.is("solid") || word.is("endsolid") {
            in_solid = word.is("solid");
            words = after_line(text, &words);
        } else if in_solid && word.is("facet") {
            expect(text, &mut words, "normal")?;
            read_vector(text, &mut words)?;
            expect(text, &mut words, "outer")?;
            expect(text, &mut words, "loop")?;
            for _ in 0..3 {
                expect(text, &mut words, "vertex")?;
                positions.push(read_vector(text, &mut words)?);
            }
            expect(text, &mut words, "endloop")?;
            expect(text, &mut words, "endfacet")?;
        } else {
            let expected = if in_solid {
                "`facet` or `endsolid`"
            } else {
                "`solid`"
            };
            return Err(text.unexpected(Some(word), expected));
        }
    }
    if in_solid {
        return Err(text.unexpected(None, "`facet` or `endsolid`"));
    }
    Ok(positions)
}

/// The words after the rest of this line, which is a name.
fn after_line<'a>(text: &Text<'a>, words: &Words<'a>) -> Words<'a> {
    let rest = &text.bytes[words.position()..];
    let end = rest
        .iter()
        .position(|&b| b == b'\n' || b == b'\r')
        .unwrap_or(rest.len());
    text.words(words.position() + end, text.bytes.len())
}

fn expect<'a>(text: &Text<'a>, words: &mut Words<'a>, keyword: &str) -> Result<(), FileError> {
    match words.next() {
        Some(word) if word.is(keyword) => Ok(()),
        other => Err(text.unexpected(other, &format!("`{keyword}`"))),
    }
}

fn read_vector<'a>(text: &Text<'a>, words: &mut Words<'a>) -> Result<Vec3, FileError> {
    let mut v = [0.0; 3];
    for x in &mut v {
        let word = words.next();
        *x = word
            .and_then(|w| w.parse())
            .ok_or_else(|| text.unexpected(word, "a number"))?;
    }
    Ok(Vec3::from(v))
}
