//! Bytes that glTF refers to: buffers, their views and data URIs.

use super::json::Json;
use crate::{
    ErrorKind, FileError, Report, folder,
    folder::{NameError, NameSyntax},
    sniff,
};
use base64::{
    Engine, alphabet,
    engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig},
};
use std::{borrow::Cow, cell::Cell};

/// The buffers of a file and the views into them.
pub(super) struct Buffers<'a> {
    buffers: Vec<Cow<'a, [u8]>>,
    views: Vec<Json<'a>>,
    /// What is left of the limit on numbers without bytes.
    zeros: Cell<u64>,
}

/// Most numbers of all accessors that have no bytes in the file (all zero, then sparse values), each time they are read.
pub(super) const MAX_ZEROS: u64 = 1 << 24;

/// A part of a buffer.
#[derive(Clone, Copy)]
pub(super) struct View<'b> {
    pub(super) bytes: &'b [u8],
    /// Distance of elements, if the file says one.
    pub(super) stride: Option<u64>,
}

impl<'a> Buffers<'a> {
    /// Loads every buffer; `binary` is the binary chunk of a .glb file.
    pub(super) fn load(
        root: &Json<'a>,
        binary: Option<&'a [u8]>,
        report: &mut Report,
    ) -> Result<Self, FileError> {
        let mut buffers = Vec::new();
        for (i, buffer) in root.objects("buffers")?.into_iter().enumerate() {
            let size = buffer.size("byteLength")?;
            let bytes = match (buffer.text("uri")?, binary) {
                (Some(uri), _) => load_uri(&buffer, uri, Some(size), report)?,
                (None, Some(chunk)) if i == 0 => Cow::Borrowed(chunk),
                // Some extensions allow a buffer without data as the fallback of a compressed one.
                (None, _) => Cow::Borrowed(&[][..]),
            };
            let has = bytes.len() as u64;
            if has < size && !(has == 0 && !buffer.has("uri") && i > 0) {
                return Err(buffer.error_at(
                    "byteLength",
                    format!("is {size}; the buffer has only {has} bytes"),
                ));
            }
            buffers.push(bytes);
        }
        Ok(Self {
            buffers,
            views: root.objects("bufferViews")?,
            zeros: Cell::new(MAX_ZEROS),
        })
    }

    /// Whether `n` more numbers without bytes are within the limit.
    pub(super) fn take_zeros(&self, n: u64) -> bool {
        let left = self.zeros.get().checked_sub(n);
        self.zeros.set(left.unwrap_or(0));
        left.is_some()
    }

    pub(super) fn view_count(&self) -> usize {
        self.views.len()
    }

    /// View number `index`, which exists.
    pub(super) fn view(&self, index: usize) -> Result<View<'_>, FileError> {
        let json = &self.views[index];
        let Some(buffer) = json.index("buffer", self.buffers.len())? else {
            return Err(json.error("has no `buffer`"));
        };
        let buffer = &self.buffers[buffer];
        let offset = json.integer("byteOffset")?.unwrap_or(0);
        let length = json.size("byteLength")?;
        let end = offset
            .checked_add(length)
            .filter(|end| *end <= buffer.len() as u64);
        let Some(end) = end else {
            let message = format!(
                "needs {length} bytes from {offset} on; the buffer has only {}",
                buffer.len()
            );
            return Err(json.error(message));
        };
        Ok(View {
            // Both are at most the buffer's length.
            bytes: &buffer[offset as usize..end as usize],
            stride: json.integer("byteStride")?,
        })
    }
}

/// Whether a URI is one of data.
pub(super) fn is_data(uri: &str) -> bool {
    uri.get(..5)
        .is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:"))
}

/// The bytes of the `uri` of `json`, from the URI itself or from a file in the folder.
///
/// `size` is what the file says it has; a data URI that is too short for it is not decoded.
pub(super) fn load_uri<'a>(
    json: &Json,
    uri: &str,
    size: Option<u64>,
    report: &mut Report,
) -> Result<Cow<'a, [u8]>, FileError> {
    if is_data(uri) {
        return decode_data(json, uri, size.unwrap_or(0)).map(Cow::Owned);
    }
    match folder::resolve(json.file, uri, NameSyntax::Uri) {
        Ok(path) => sniff::read_file(&path, report).map(Cow::Owned),
        Err(error) => {
            let kind = if matches!(error, NameError::Missing(_)) {
                ErrorKind::Io
            } else {
                ErrorKind::Input
            };
            Err(FileError {
                kind,
                ..json.error_at("uri", error.message())
            })
        }
    }
}

fn decode_data(json: &Json, uri: &str, size: u64) -> Result<Vec<u8>, FileError> {
    let Some((head, data)) = uri.split_once(',') else {
        return Err(json.error_at("uri", "is a data URI without a comma"));
    };
    if !head.to_ascii_lowercase().ends_with(";base64") {
        return Err(json.error_at("uri", "is a data URI in another encoding; expected base64"));
    }
    let holds = data.len() as u64 / 4 * 3 + 3;
    if holds < size {
        return Err(json.error_at(
            "uri",
            format!("holds at most {holds} bytes; `byteLength` is {size}"),
        ));
    }
    let config =
        GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent);
    let decoded = GeneralPurpose::new(&alphabet::STANDARD, config).decode(data);
    decoded.map_err(|error| json.error_at("uri", format!("is not base64: {error}")))
}
