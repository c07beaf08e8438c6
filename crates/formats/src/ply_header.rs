//! The header of a PLY file.

use crate::{
    FileError, Place,
    words::{Text, Word},
};
use std::path::Path;

/// Longest header that is read: 1 MiB.
const MAX_HEADER: usize = 1 << 20;

/// How the numbers are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    Text,
    BinaryLittle,
    BinaryBig,
}

/// Types of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// A property of an element.
#[derive(Clone, Debug)]
pub(crate) struct Property {
    pub(crate) name: String,
    /// Type of a list's length; `None` for a single number.
    pub(crate) count: Option<Scalar>,
    pub(crate) kind: Scalar,
}

/// A kind of records.
#[derive(Clone, Debug)]
pub(crate) struct Element {
    pub(crate) name: String,
    pub(crate) count: u64,
    pub(crate) properties: Vec<Property>,
}

/// What the header says.
#[derive(Clone, Debug)]
pub(crate) struct Header {
    pub(crate) form: Form,
    pub(crate) elements: Vec<Element>,
    /// Offset of the first byte after the header.
    pub(crate) end: usize,
}

impl Scalar {
    fn parse(word: Word) -> Option<Self> {
        Some(match word.bytes {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    pub(crate) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    pub(crate) fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    /// The number that stands for full intensity in a colour of this type.
    pub(crate) fn white(self) -> f64 {
        match self {
            Self::I8 => 127.0,
            Self::U8 => 255.0,
            Self::I16 => 32_767.0,
            Self::U16 => 65_535.0,
            Self::I32 => f64::from(i32::MAX),
            Self::U32 => f64::from(u32::MAX),
            Self::F32 | Self::F64 => 1.0,
        }
    }

    /// The number in the first bytes of `b`, which has at least [`Scalar::size`] of them.
    pub(crate) fn value(self, b: &[u8], big: bool) -> f64 {
        let mut raw = [0; 8];
        let n = self.size();
        raw[..n].copy_from_slice(&b[..n]);
        if big {
            raw[..n].reverse();
        }
        let [b0, b1, b2, b3, ..] = raw;
        match self {
            Self::I8 => f64::from(b0 as i8),
            Self::U8 => f64::from(b0),
            Self::I16 => f64::from(i16::from_le_bytes([b0, b1])),
            Self::U16 => f64::from(u16::from_le_bytes([b0, b1])),
            Self::I32 => f64::from(i32::from_le_bytes([b0, b1, b2, b3])),
            Self::U32 => f64::from(u32::from_le_bytes([b0, b1, b2, b3])),
            Self::F32 => f64::from(f32::from_le_bytes([b0, b1, b2, b3])),
            Self::F64 => f64::from_le_bytes(raw),
        }
    }
}

/// Reads from `ply` to `end_header`; lines end with LF, CR LF or CR.
pub(crate) fn read_header(path: &Path, bytes: &[u8]) -> Result<Header, FileError> {
    // Only this much is ever looked at: a missing `end_header` does not cost the time of the whole file.
    let text = Text {
        path,
        bytes: &bytes[..bytes.len().min(MAX_HEADER)],
    };
    let mut form = None;
    let mut elements: Vec<Element> = Vec::new();
    for (number, (start, end)) in text.lines().enumerate() {
        let words: Vec<Word> = text.words(start, end).collect();
        let Some(&first) = words.first() else {
            continue;
        };
        // A line at the limit goes on where nothing is looked at.
        if (number == 0 && first.bytes != b"ply") || end == MAX_HEADER {
            break;
        }
        if first.bytes == b"end_header" {
            let missing = "no `format` line before the end of the header";
            return Ok(Header {
                form: form.ok_or_else(|| text.error(first.at, missing))?,
                elements,
                end: data_start(bytes, start, end),
            });
        }
        read_line(&text, &words, &mut form, &mut elements)?;
    }
    Err(unfinished(&text, bytes))
}

/// Where the data begins after the last line of the header, from `start` to `end`: CR LF is one end; after a CR alone the
/// data may begin with the byte of an LF.
fn data_start(bytes: &[u8], start: usize, end: usize) -> usize {
    let crlf = bytes[end..].starts_with(b"\r\n") && bytes[..start].ends_with(b"\n");
    (end + if crlf { 2 } else { 1 }).min(bytes.len())
}

/// Reads a line of the header that is not empty and not its last.
fn read_line(
    text: &Text,
    words: &[Word],
    form: &mut Option<Form>,
    elements: &mut Vec<Element>,
) -> Result<(), FileError> {
    let first = words[0];
    match first.bytes {
        b"format" => *form = Some(read_format(text, words)?),
        b"element" => elements.push(read_element(text, words)?),
        b"property" => {
            let property = read_property(text, words)?;
            let element = elements.last_mut();
            let element =
                element.ok_or_else(|| text.error(first.at, "a property before any element"))?;
            element.properties.push(property);
        }
        b"ply" | b"comment" | b"obj_info" => {}
        _ => {
            let expected = "a PLY header line (format, element, property, end_header)";
            return Err(text.unexpected(Some(first), expected));
        }
    }
    Ok(())
}

/// Why there was no end of the header.
fn unfinished(text: &Text, bytes: &[u8]) -> FileError {
    if !bytes.starts_with(b"ply") {
        let message = "is not a PLY file; expected `ply` in the first line";
        return FileError::input(text.path, Place::Byte(0), message);
    }
    if bytes.len() > MAX_HEADER {
        let place = Place::Byte(MAX_HEADER as u64);
        return FileError::limit(text.path, place, "no `end_header` within 1 MiB");
    }
    text.unexpected(None, "`end_header`")
}

fn read_format(text: &Text, words: &[Word]) -> Result<Form, FileError> {
    match words.get(1).map(|w| w.bytes) {
        Some(b"ascii") => Ok(Form::Text),
        Some(b"binary_little_endian") => Ok(Form::BinaryLittle),
        Some(b"binary_big_endian") => Ok(Form::BinaryBig),
        _ => Err(text.error(
            words[0].at,
            "unknown format; expected ascii, binary_little_endian or binary_big_endian",
        )),
    }
}

fn read_element(text: &Text, words: &[Word]) -> Result<Element, FileError> {
    let [_, name, count] = words else {
        return Err(text.error(words[0].at, "expected `element NAME COUNT`"));
    };
    let count = count
        .parse()
        .ok_or_else(|| text.unexpected(Some(*count), "a number of elements"))?;
    Ok(Element {
        name: name.text().into_owned(),
        count,
        properties: Vec::new(),
    })
}

fn read_property(text: &Text, words: &[Word]) -> Result<Property, FileError> {
    let scalar = |word: &Word| {
        Scalar::parse(*word).ok_or_else(|| {
            text.unexpected(
                Some(*word),
                "a type: char, uchar, short, ushort, int, uint, float or double",
            )
        })
    };
    let (count, kind, name) = match words {
        [_, list, count, kind, name] if list.bytes == b"list" => {
            let length = scalar(count)?;
            if length.is_float() {
                return Err(
                    text.unexpected(Some(*count), "a whole number type for the length of a list")
                );
            }
            (Some(length), scalar(kind)?, name)
        }
        [_, kind, name] => (None, scalar(kind)?, name),
        _ => {
            return Err(text.error(
                words[0].at,
                "expected `property TYPE NAME` or `property list TYPE TYPE NAME`",
            ));
        }
    };
    Ok(Property {
        name: name.text().into_owned(),
        count,
        kind,
    })
}
