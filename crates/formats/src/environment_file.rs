//! Pictures of what is around a scene: Radiance HDR and EXR, latitude by longitude.

use crate::{FileError, Place, read_image::read_exr, report::Report, sniff};
use image::{DynamicImage, ImageDecoder, Limits, codecs::hdr::HdrDecoder};
use std::{io::Cursor, path::Path};
use umbriel_render::{EnvironmentMap, kernels::glam::Vec3};

/// The brightest that is kept: the largest number of EXR's half precision.
const BRIGHTEST: f32 = 65_504.0;

/// Decodes a map of the surroundings, decided by its first bytes: Radiance HDR, or EXR with channels `R G B`; linear Rec. 709.
///
/// `strength` multiplies the radiance, `rotation` turns the map, see [`EnvironmentMap::new`]. What is negative or no number becomes black, and
/// what is above 65,504 that: the report says how often. At most 64 Mi texels.
///
/// # Errors
/// For another format, a damaged file, and too many texels.
pub fn load_environment(
    path: &Path,
    bytes: &[u8],
    strength: f32,
    rotation: f32,
    report: &mut Report,
) -> Result<EnvironmentMap, FileError> {
    let (width, height, mut texels) = if bytes.starts_with(b"#?") {
        read_hdr(path, bytes)?
    } else if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        let image = read_exr(path, bytes)?;
        let texels = image.pixels.iter().map(|p| Vec3::new(p[0], p[1], p[2]));
        (image.width, image.height, texels.collect())
    } else {
        let found = sniff::describe(bytes).unwrap_or("no known picture");
        let message = format!("is {found}; expected a Radiance HDR or an EXR picture");
        return Err(FileError::input(path, Place::File, message));
    };
    check_texels(path, width as u64, height as u64)?;
    mend(&mut texels, path, report);
    for texel in &mut texels {
        *texel *= strength;
    }
    if width != 2 * height {
        report.note(format!(
            "{}: {width} x {height} is stretched over the sphere, which is twice as wide as high",
            path.display()
        ));
    }
    EnvironmentMap::new(width, height, texels, rotation)
        .ok_or_else(|| FileError::input(path, Place::File, "has no texels; expected some"))
}

fn read_hdr(path: &Path, bytes: &[u8]) -> Result<(usize, usize, Vec<Vec3>), FileError> {
    let bad = |error: image::ImageError| {
        FileError::input(path, Place::File, format!("bad Radiance HDR: {error}"))
    };
    let mut decoder = HdrDecoder::new(Cursor::new(bytes)).map_err(bad)?;
    let (width, height) = decoder.dimensions();
    check_texels(path, u64::from(width), u64::from(height))?;
    decoder.set_limits(Limits::no_limits()).map_err(bad)?;
    let image = DynamicImage::from_decoder(decoder).map_err(bad)?;
    let texels = image
        .into_rgb32f()
        .pixels()
        .map(|p| Vec3::from(p.0))
        .collect();
    Ok((width as usize, height as usize, texels))
}

fn check_texels(path: &Path, width: u64, height: u64) -> Result<(), FileError> {
    let most = EnvironmentMap::MAX_TEXELS;
    if width.checked_mul(height).is_some_and(|n| n <= most) {
        return Ok(());
    }
    let message = format!("{width} x {height} texels; expected at most {most}");
    Err(FileError::limit(path, Place::File, message))
}

/// Makes all texels finite and at least 0.
fn mend(texels: &mut [Vec3], path: &Path, report: &mut Report) {
    let (mut dark, mut bright) = (0, 0);
    for texel in texels.iter_mut() {
        dark += usize::from(texel.to_array().iter().any(|c| !(*c >= 0.0)));
        bright += usize::from(texel.to_array().iter().any(|c| *c > BRIGHTEST));
        *texel = Vec3::from(
            texel
                .to_array()
                .map(|c| if c >= 0.0 { c.min(BRIGHTEST) } else { 0.0 }),
        );
    }
    let mut note = |count: usize, what: &str| {
        if count > 0 {
            report.note(format!("{}: {count} texels {what}", path.display()));
        }
    };
    note(dark, "were negative or no numbers, and are black");
    note(bright, "were above 65504, and are that bright");
}
