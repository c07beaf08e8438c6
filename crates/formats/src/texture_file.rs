//! Textures from PNG and JPEG files.

use crate::{FileError, Place, sniff};
use image::{
    DynamicImage, ImageDecoder, ImageError, Limits,
    codecs::{jpeg::JpegDecoder, png::PngDecoder},
};
use std::{io::Cursor, path::Path};
use umbriel_render::{Encoding, Filter, ImageTexture, Wrap};

/// Most texels along a side.
const MAX_SIDE: u32 = 16_384;
/// Most texels of a texture: 512 MiB as they are kept.
const MAX_TEXELS: u64 = 128 << 20;
/// Most bytes that a decoder may take.
const MAX_BYTES: u64 = 512 << 20;

/// Decodes a PNG or JPEG file, decided by its first bytes; any number of channels and bits becomes RGBA
/// of 8 bits.
///
/// The result is sRGB-encoded, repeats and is filtered bilinearly; the caller knows better.
/// At most 16,384 texels a side, 128 Mi texels and 512 MiB while decoding.
pub fn load_texture(path: &Path, bytes: &[u8]) -> Result<ImageTexture, FileError> {
    decode_texture(bytes)
        .map_err(|fault| match fault {
            TextureFault::Wrong(message) => FileError::input(path, Place::File, message),
            TextureFault::TooLarge(message) => FileError::limit(path, Place::File, message),
        })
        .map(|texture| ImageTexture {
            name: path.display().to_string(),
            ..texture
        })
}

/// Why a texture cannot be decoded, without its place.
pub(crate) enum TextureFault {
    Wrong(String),
    TooLarge(String),
}

/// See [`load_texture`]; the name is left empty.
pub(crate) fn decode_texture(bytes: &[u8]) -> Result<ImageTexture, TextureFault> {
    let input = Cursor::new(bytes);
    let image = match sniff::describe(bytes) {
        Some("a PNG image") => decode(PngDecoder::with_limits(input, limits()).map_err(fault)?)?,
        Some("a JPEG image") => decode(JpegDecoder::new(input).map_err(fault)?)?,
        other => {
            let found = other.unwrap_or("of an unknown format");
            return Err(TextureFault::Wrong(format!(
                "the image is {found}; expected PNG or JPEG"
            )));
        }
    };
    let rgba = image.into_rgba8();
    let (width, height) = rgba.dimensions();
    if width == 0 || height == 0 {
        return Err(TextureFault::Wrong("the image has no texels".to_owned()));
    }
    let texels = rgba
        .into_raw()
        .chunks_exact(4)
        .map(|t| [t[0], t[1], t[2], t[3]])
        .collect();
    Ok(ImageTexture {
        name: String::new(),
        width,
        height,
        texels,
        encoding: Encoding::Srgb,
        wrap: [Wrap::Repeat; 2],
        filter: Filter::Bilinear,
    })
}

fn limits() -> Limits {
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_BYTES);
    limits
}

/// Decodes the pixels after the header was compared with the limits.
fn decode(mut decoder: impl ImageDecoder) -> Result<DynamicImage, TextureFault> {
    let (width, height) = decoder.dimensions();
    let texels = u64::from(width) * u64::from(height);
    if width > MAX_SIDE
        || height > MAX_SIDE
        || texels > MAX_TEXELS
        || decoder.total_bytes() > MAX_BYTES
    {
        let message = format!(
            "the image has {width} x {height} texels; the limits are {MAX_SIDE} a side and {MAX_TEXELS} in all"
        );
        return Err(TextureFault::TooLarge(message));
    }
    decoder
        .set_limits(limits())
        .and_then(|()| DynamicImage::from_decoder(decoder))
        .map_err(fault)
}

fn fault(error: ImageError) -> TextureFault {
    match error {
        ImageError::Limits(_) => {
            let limits = format!("the limits are {MAX_SIDE} texels a side and {MAX_BYTES} bytes");
            TextureFault::TooLarge(format!("the image is too large; {limits}"))
        }
        error => {
            // The decoder's words may go over several lines.
            let words = error
                .to_string()
                .split_whitespace()
                .collect::<Vec<_>>()
                .join(" ");
            TextureFault::Wrong(format!("the image cannot be decoded: {words}"))
        }
    }
}
