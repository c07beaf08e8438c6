//! From linear light to bytes: exposure, tone curves, the sRGB transfer curve.

use crate::Image;
use rayon::prelude::*;
use std::sync::LazyLock;
use umbriel_kernels::{
    VectorUnit,
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

/// The linear value of an sRGB byte. Source: IEC 61966-2-1, 1999.
#[inline]
pub fn srgb_to_linear(byte: u8) -> f32 {
    static TABLE: LazyLock<[f32; 256]> =
        LazyLock::new(|| std::array::from_fn(|i| decode_srgb(i as f64 / 255.0)));
    TABLE[usize::from(byte)]
}

/// The linear value of `v` in `[0, 1]` on the sRGB curve. Source: IEC 61966-2-1, 1999.
fn decode_srgb(v: f64) -> f32 {
    let linear = if v <= 0.04045 {
        v / 12.92
    } else {
        ((v + 0.055) / 1.055).powf(2.4)
    };
    linear as f32
}

/// The nearest sRGB byte of a linear value; below 0 and NaN become 0, above 1 becomes 255.
///
/// Source: IEC 61966-2-1, 1999.
#[inline]
pub fn linear_to_srgb(linear: f32) -> u8 {
    SrgbEncoder::get().encode(linear)
}

/// Finds the nearest byte by the upper bits of a float and one sum.
struct SrgbEncoder {
    /// Of each class of floats with equal upper bits, from that of `LEAST` to that of 1, in the upper bits the byte of its least one; in the
    /// lower bits what carries into them when the lower bits of a float are added that has the next byte.
    classes: [u32; Self::CLASSES],
}

impl SrgbEncoder {
    /// A power of two below the first bound.
    const LEAST: f32 = 1.0 / 8192.0;
    /// Lower bits that a class leaves out. Seven bits of the mantissa remain: a class is at most 1/128 of its values
    /// wide, which is less than the distance of two bounds anywhere, so that no class holds more than one.
    const SHIFT: u32 = 16;
    /// A power of two not below the number of classes: indices need no check.
    const CLASSES: usize = 2048;

    /// The encoder, made once.
    fn get() -> &'static Self {
        static ENCODER: LazyLock<SrgbEncoder> = LazyLock::new(SrgbEncoder::new);
        &ENCODER
    }

    fn new() -> Self {
        let bounds = srgb_bounds();
        let first = Self::LEAST.to_bits() >> Self::SHIFT;
        let classes = std::array::from_fn(|i| {
            let least = (first + i as u32) << Self::SHIFT;
            let byte = bounds.partition_point(|&bound| bound.to_bits() <= least);
            let next = bounds.get(byte).map_or(u32::MAX, |bound| bound.to_bits()) - least;
            let carry = (1_u32 << Self::SHIFT).saturating_sub(next);
            ((byte as u32) << Self::SHIFT) + carry
        });
        Self { classes }
    }

    #[inline(always)]
    fn encode(&self, linear: f32) -> u8 {
        let above = Self::above_least(linear);
        let class = self.classes[(above >> Self::SHIFT) as usize % Self::CLASSES];
        ((class + (above & ((1 << Self::SHIFT) - 1))) >> Self::SHIFT) as u8
    }

    /// By how much the bits of a value, cut to the range, are above those of the least one.
    #[inline(always)]
    fn above_least(linear: f32) -> u32 {
        // The first comparison fails for NaN, too.
        let inside = if linear > Self::LEAST {
            linear.min(1.0)
        } else {
            Self::LEAST
        };
        inside.to_bits() - Self::LEAST.to_bits()
    }

    /// [`SrgbEncoder::encode`] of the colours of pixels, and their alpha as it is: bits in vectors, then the classes one by one, then bytes in
    /// vectors.
    #[inline(always)]
    fn encode_all(&self, linear: &[f32], bytes: &mut [u8]) {
        let mut above = [0; 4 * BLOCK];
        for (above, &linear) in above.iter_mut().zip(linear) {
            *above = Self::above_least(linear);
        }
        let mut classes = [0; 4 * BLOCK];
        for (class, above) in classes.iter_mut().zip(&above) {
            *class = self.classes[(above >> Self::SHIFT) as usize % Self::CLASSES];
        }
        let codes = classes.iter().zip(&above);
        for ((i, byte), ((class, above), linear)) in
            bytes.iter_mut().enumerate().zip(codes.zip(linear))
        {
            let color = ((class + (above & ((1 << Self::SHIFT) - 1))) >> Self::SHIFT) as u8;
            let alpha = alpha_byte(*linear);
            *byte = if i % 4 == 3 { alpha } else { color };
        }
    }
}

/// The nearest byte of an alpha; that of NaN is 0. The compiler's own conversion takes one number at a time.
#[inline(always)]
fn alpha_byte(alpha: f32) -> u8 {
    const UNIT_STEPS: f32 = 8_388_608.0;
    let inside = if alpha > 0.0 { alpha.min(1.0) } else { 0.0 };
    ((inside * 255.0 + 0.5).floor() + UNIT_STEPS).to_bits() as u8
}

/// The least linear values whose nearest bytes are 1 to 255.
fn srgb_bounds() -> [f32; 255] {
    std::array::from_fn(|i| decode_srgb((i as f64 + 0.5) / 255.0))
}

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
    let development = Development { exposure, tonemap };
    let shares = bytes.par_chunks_mut(SHARE);
    shares
        .zip(image.pixels.par_chunks(SHARE))
        .for_each(|(bytes, pixels)| development.develop(pixels, bytes));
    bytes
}

/// Pixels that one thread develops.
const SHARE: usize = 4096;
/// Pixels at a time.
const BLOCK: usize = 32;

impl Development {
    /// Develops pixels on this thread; both slices have one length.
    pub(crate) fn develop(&self, pixels: &[[f32; 4]], bytes: &mut [[u8; 4]]) {
        let encoder = SrgbEncoder::get();
        let gain = self.exposure.exp2();
        let mut block = [[0.0; 4]; BLOCK];
        for (bytes, pixels) in bytes.chunks_mut(BLOCK).zip(pixels.chunks(BLOCK)) {
            block[..pixels.len()].copy_from_slice(pixels);
            self.expose(gain, &mut block[..pixels.len()]);
            let mut coded = [[0; 4]; BLOCK];
            VectorUnit::default().run(
                #[inline(always)]
                || encoder.encode_all(block.as_flattened(), coded.as_flattened_mut()),
            );
            bytes.copy_from_slice(&coded[..pixels.len()]);
        }
    }

    fn expose(&self, gain: f32, pixels: &mut [[f32; 4]]) {
        if self.tonemap == Tonemap::Linear && gain == 1.0 {
            return;
        }
        for pixel in pixels {
            let [r, g, b, a] = *pixel;
            let color = apply_tonemap(Vec3::new(r, g, b) * gain, self.tonemap);
            *pixel = color.extend(a).to_array();
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
    fn srgb_round_trip_is_exact() {
        for byte in 0..=255 {
            assert_eq!(linear_to_srgb(srgb_to_linear(byte)), byte);
        }
        assert_eq!(linear_to_srgb(0.5), 188);
        assert_eq!(linear_to_srgb(f32::NAN), 0);
        assert_eq!(linear_to_srgb(-1.0), 0);
        assert_eq!(linear_to_srgb(f32::INFINITY), 255);
    }

    /// Against the definition, at every bound and at every class of upper bits.
    #[test]
    fn encoder_finds_the_nearest_byte() {
        let encoder = SrgbEncoder::new();
        let bounds = srgb_bounds();
        let nearest = |linear: f32| bounds.partition_point(|&bound| bound <= linear) as u8;
        let classes = (0..=f32::INFINITY.to_bits())
            .step_by(1 << 12)
            .map(f32::from_bits);
        for value in classes.chain(bounds).filter(|v| v.is_finite()) {
            for v in [value.next_down(), value, value.next_up(), -value] {
                assert_eq!(encoder.encode(v), nearest(v), "{v}");
            }
        }
    }

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
