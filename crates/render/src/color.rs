//! From linear light to bytes: exposure and tone curves.

use crate::{
    Image,
    srgb::{BLOCK, SrgbEncoder},
};
use rayon::prelude::*;
use umbriel_kernels::{
    LANES, Vec3Lanes, VectorUnit,
    glam::{Mat3, Vec3},
};

/// How radiance above 1 is brought into the range of a screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tonemap {
    /// Not at all: clipped at 1. For comparisons and measurements.
    Linear,
    /// Khronos PBR Neutral: base colours stay true, only highlights are compressed.
    #[default]
    Neutral,
    /// The fit of the ACES reference rendering and output transforms by Stephen Hill.
    Aces,
    /// AgX: bright saturated colours turn pale, as film does.
    Agx,
}

/// Luminance weights of linear Rec. 709. Source: ITU-R BT.709-6, 2015.
pub const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

/// How a linear picture becomes bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Development {
    /// In stops: each doubles the light.
    pub exposure: f32,
    /// The tone curve.
    pub tonemap: Tonemap,
}

/// Brings a linear picture to sRGB bytes with alpha: exposure in stops (each doubles the light), tone curve, transfer curve.
pub fn develop(image: &Image, exposure: f32, tonemap: Tonemap) -> Vec<[u8; 4]> {
    let mut bytes = vec![[0; 4]; image.pixels.len()];
    let developer = Developer::new(&Development { exposure, tonemap });
    let shares = bytes.par_chunks_mut(SHARE);
    shares
        .zip(image.pixels.par_chunks(SHARE))
        .for_each(|(bytes, pixels)| developer.develop(pixels, bytes));
    bytes
}

/// Pixels that one thread develops.
const SHARE: usize = 4096;

/// A [`Development`] made ready.
pub(crate) struct Developer {
    encoder: &'static SrgbEncoder,
    gain: f32,
    tonemap: Tonemap,
}

impl Developer {
    pub(crate) fn new(development: &Development) -> Self {
        Self {
            encoder: SrgbEncoder::get(),
            gain: development.exposure.exp2(),
            tonemap: development.tonemap,
        }
    }

    /// Develops pixels on this thread; both slices have one length.
    pub(crate) fn develop(&self, pixels: &[[f32; 4]], bytes: &mut [[u8; 4]]) {
        let mut block = [[0.0; 4]; BLOCK];
        for (bytes, pixels) in bytes.chunks_mut(BLOCK).zip(pixels.chunks(BLOCK)) {
            block[..pixels.len()].copy_from_slice(pixels);
            for pixel in &mut block[..pixels.len()] {
                let [r, g, b, a] = *pixel;
                *pixel = self.expose(Vec3::new(r, g, b)).extend(a).to_array();
            }
            let mut coded = [[0; 4]; BLOCK];
            VectorUnit::default().run(
                #[inline(always)]
                || {
                    self.encoder
                        .encode_all(block.as_flattened(), coded.as_flattened_mut());
                },
            );
            bytes.copy_from_slice(&coded[..pixels.len()]);
        }
    }

    /// Develops opaque pixels, one a lane; the first byte of each is in its lowest bits. To be called within [`VectorUnit::run`].
    #[inline(always)]
    pub(crate) fn develop_lanes(&self, colors: &mut Vec3Lanes, pixels: &mut [u32; LANES]) {
        if !self.changes_nothing() {
            for i in 0..LANES {
                colors.set(i, self.expose(colors.get(i)));
            }
        }
        self.encoder.encode_lanes(colors, pixels);
    }

    #[inline(always)]
    fn changes_nothing(&self) -> bool {
        self.tonemap == Tonemap::Linear && self.gain == 1.0
    }

    #[inline(always)]
    fn expose(&self, color: Vec3) -> Vec3 {
        if self.changes_nothing() {
            color
        } else {
            apply_tonemap(color * self.gain, self.tonemap)
        }
    }
}

/// The exposure in stops that brings the picture's bright parts just below white.
///
/// The 95th percentile of the luminance of the finished pixels becomes 0.8; a black picture stays as it is.
pub fn auto_exposure(image: &Image) -> f32 {
    let mut luminances: Vec<f32> = image
        .pixels
        .iter()
        .filter(|p| p[3] > 0.0)
        .map(|&[r, g, b, _]| LUMINANCE.dot(Vec3::new(r, g, b)))
        .collect();
    if luminances.is_empty() {
        return 0.0;
    }
    let rank = (luminances.len() - 1) * 95 / 100;
    let (_, &mut bright, _) = luminances.select_nth_unstable_by(rank, f32::total_cmp);
    if bright > 0.0 {
        (0.8 / bright).log2()
    } else {
        0.0
    }
}

#[inline(always)]
fn apply_tonemap(color: Vec3, tonemap: Tonemap) -> Vec3 {
    match tonemap {
        Tonemap::Linear => color,
        Tonemap::Neutral => tonemap_neutral(color),
        Tonemap::Aces => tonemap_aces(color),
        Tonemap::Agx => tonemap_agx(color),
    }
}

/// Takes the Fresnel reflection of a white sky off dark colours, compresses what is above 0.8 towards 1
/// and lets it turn white.
///
/// Source: Khronos Group, "Khronos PBR Neutral Tone Mapper" specification, 2024.
fn tonemap_neutral(color: Vec3) -> Vec3 {
    const START: f32 = 0.8 - 0.04;
    const DESATURATION: f32 = 0.15;
    let least = color.min_element();
    let offset = if least < 0.08 {
        least - 6.25 * least * least
    } else {
        0.04
    };
    let color = color - offset;
    let peak = color.max_element();
    if peak < START {
        return color;
    }
    let d = 1.0 - START;
    let new_peak = 1.0 - d * d / (peak + d - START);
    let pale = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    (color * (new_peak / peak)).lerp(Vec3::splat(new_peak), pale)
}

/// A rational curve in a wide colour space.
///
/// Source: Stephen Hill's fit of the ACES RRT + ODT (sRGB), as published in MJP's BakingLab, 2016.
fn tonemap_aces(color: Vec3) -> Vec3 {
    let input = Mat3::from_cols_array_2d(&[
        [0.59719, 0.07600, 0.02840],
        [0.35458, 0.90834, 0.13383],
        [0.04823, 0.01566, 0.83777],
    ]);
    let output = Mat3::from_cols_array_2d(&[
        [1.60475, -0.10208, -0.00327],
        [-0.53108, 1.10813, -0.07276],
        [-0.07367, -0.00605, 1.07602],
    ]);
    let v = input * color;
    let a = v * (v + 0.024_578_6) - 0.000_090_537;
    let b = v * (0.983_729 * v + 0.432_951) + 0.238_081;
    output * (a / b)
}

/// Log-encodes the light, applies a sigmoid and undoes the display's curve.
///
/// Source: Troy Sobotka, AgX, 2022; matrices and polynomial of Benjamin Wrensch, "Minimal AgX Implementation", 2023.
fn tonemap_agx(color: Vec3) -> Vec3 {
    let inset = Mat3::from_cols_array_2d(&[
        [0.842_479_06, 0.042_328_24, 0.042_375_654],
        [0.078_433_59, 0.878_468_6, 0.078_433_6],
        [0.079_223_745, 0.079_166_13, 0.879_143],
    ]);
    const MIN_EV: f32 = -12.473_93;
    const MAX_EV: f32 = 4.026_069;
    let log = (inset * color)
        .max(Vec3::splat(1e-10))
        .map(f32::log2)
        .clamp(Vec3::splat(MIN_EV), Vec3::splat(MAX_EV));
    let x = (log - MIN_EV) / (MAX_EV - MIN_EV);
    let x2 = x * x;
    let x4 = x2 * x2;
    let curve =
        15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x
            - 0.002_32;
    let display = inset.inverse() * curve;
    display.max(Vec3::ZERO).map(|v| v.powf(2.2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_changes_nothing_in_range() {
        assert_eq!(
            apply_tonemap(Vec3::new(0.1, 0.5, 1.0), Tonemap::Linear),
            Vec3::new(0.1, 0.5, 1.0)
        );
    }

    /// Every curve keeps black black, grows with the light, stays in range, and ends near white.
    #[test]
    fn curves_are_monotonic_and_bounded() {
        for tonemap in [Tonemap::Neutral, Tonemap::Aces, Tonemap::Agx] {
            let mut last = -1e-3;
            for i in 0..=200 {
                let v = apply_tonemap(Vec3::splat((i as f32 * 0.1 - 10.0).exp2()), tonemap);
                assert!(
                    v.x >= last && v.max_element() <= 1.02,
                    "{tonemap:?} at {i}: {v}"
                );
                last = v.x;
            }
            assert!(last > 0.95, "{tonemap:?} ends at {last}");
            assert!(
                apply_tonemap(Vec3::ZERO, tonemap).max_element() < 2e-3,
                "{tonemap:?}"
            );
        }
    }

    /// From the specification: below the compression a colour only loses the offset of 0.04.
    #[test]
    fn neutral_keeps_base_colours() {
        let color = Vec3::new(0.5, 0.3, 0.2);
        assert!((tonemap_neutral(color) - (color - 0.04)).length() < 1e-6);
    }

    #[test]
    fn auto_exposure_brings_the_bright_part_to_four_fifths() {
        let image = Image {
            width: 10,
            height: 10,
            pixels: vec![[8.0, 8.0, 8.0, 1.0]; 100],
        };
        assert!((auto_exposure(&image) - 0.1_f32.log2()).abs() < 1e-5);
    }
}
