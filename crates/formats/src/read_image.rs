//! Reading pictures to compare them.

use crate::{FileError, Place, sniff};
use exr::prelude::{ReadChannels, ReadLayers, Vec2, read};
use image::{DynamicImage, ImageDecoder, Limits, codecs::png::PngDecoder};
use std::{io::Cursor, path::Path};
use umbriel_render::Image;

/// What the numbers of a picture mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureKind {
    /// PNG: display values from 0 to 1 in the sRGB transfer curve.
    Display,
    /// EXR: linear light.
    Linear,
}

/// Greatest number of pixels of a picture that is read: 4 GiB of numbers.
const MAX_PIXELS: u64 = 1 << 28;
/// Most bytes of pixels for each byte of an EXR file. Deflate reaches 1032 for pictures of one colour; a header that
/// claims more would only take memory.
const MAX_RATIO: u64 = 4096;
/// Most bytes that the PNG decoder may take: 16 bits for four channels of all pixels.
const MAX_DECODED: u64 = 8 * MAX_PIXELS;

/// Reads a PNG or EXR file, whatever its extension; the values are as stored, not converted.
///
/// An EXR file's picture is its first part with channels `R G B`; it is placed in the display window.
pub fn read_image(path: &Path) -> Result<(Image, PictureKind), FileError> {
    let bytes = sniff::read_regular(path, sniff::MAX_FILE)?;
    if bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
        Ok((read_png(path, &bytes)?, PictureKind::Display))
    } else if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        Ok((read_exr(path, &bytes)?, PictureKind::Linear))
    } else {
        let found = match &bytes[..] {
            [] => "empty",
            bytes => sniff::describe(bytes).unwrap_or("no known picture"),
        };
        let message = format!("is {found}; expected a PNG or EXR picture");
        Err(FileError::input(path, Place::File, message))
    }
}

fn read_png(path: &Path, bytes: &[u8]) -> Result<Image, FileError> {
    let bad =
        |error: image::ImageError| FileError::input(path, Place::File, format!("bad PNG: {error}"));
    let mut limits = Limits::default();
    limits.max_alloc = Some(MAX_DECODED);
    let decoder = PngDecoder::with_limits(Cursor::new(bytes), limits).map_err(bad)?;
    let (width, height) = decoder.dimensions();
    check_size(path, u64::from(width), u64::from(height))?;
    let pixels = DynamicImage::from_decoder(decoder)
        .map_err(bad)?
        .into_rgba32f();
    Ok(Image {
        width: width as usize,
        height: height as usize,
        pixels: pixels.pixels().map(|p| p.0).collect(),
    })
}

pub(crate) fn read_exr(path: &Path, bytes: &[u8]) -> Result<Image, FileError> {
    let bad =
        |error: exr::error::Error| FileError::input(path, Place::File, format!("bad EXR: {error}"));
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(bad)?;
    for header in &meta.headers {
        let window = header.shared_attributes.display_window.size;
        for size in [header.layer_size, window] {
            check_size(path, size.width() as u64, size.height() as u64)?;
        }
        let unpacked = header.layer_size.area() as u64 * header.channels.bytes_per_pixel as u64;
        if unpacked > MAX_RATIO * bytes.len() as u64 {
            let message = format!(
                "bad EXR: {unpacked} bytes of pixels in a file of {}; expected a whole file",
                bytes.len()
            );
            return Err(FileError::input(path, Place::File, message));
        }
    }
    let file = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgba_channels(
            |size, _| (size.width(), vec![[0.0; 4]; size.area()]),
            |(width, pixels): &mut (usize, Vec<[f32; 4]>),
             at,
             (r, g, b, a): (f32, f32, f32, f32)| {
                pixels[at.y() * *width + at.x()] = [r, g, b, a];
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(bad)?;
    let window = file.attributes.display_window;
    let offset = file.layer_data.attributes.layer_position - window.position;
    let (width, pixels) = file.layer_data.channel_data.pixels;
    Ok(place(window.size, offset, width, &pixels))
}

/// A picture of `size` that holds `pixels` (rows of `width`) at `offset`; what lies outside is dropped.
fn place(size: Vec2<usize>, offset: Vec2<i32>, width: usize, pixels: &[[f32; 4]]) -> Image {
    let mut image = Image {
        width: size.width(),
        height: size.height(),
        pixels: vec![[0.0; 4]; size.area()],
    };
    for (i, pixel) in pixels.iter().enumerate() {
        let x = i64::from(offset.x()) + (i % width) as i64;
        let y = i64::from(offset.y()) + (i / width) as i64;
        if (0..image.width as i64).contains(&x) && (0..image.height as i64).contains(&y) {
            image.pixels[y as usize * image.width + x as usize] = *pixel;
        }
    }
    image
}

fn check_size(path: &Path, width: u64, height: u64) -> Result<(), FileError> {
    if width.checked_mul(height).is_some_and(|n| n <= MAX_PIXELS) {
        return Ok(());
    }
    let message = format!("{width} x {height} pixels; at most {MAX_PIXELS} are read");
    Err(FileError::limit(path, Place::File, message))
}
