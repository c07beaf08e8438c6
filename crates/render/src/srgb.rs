//! The sRGB transfer curve, both ways.

use std::sync::LazyLock;
use umbriel_kernels::{LANES, Vec3Lanes};

/// Pixels that [`SrgbEncoder::encode_all`] takes at most.
pub(crate) const BLOCK: usize = 32;

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
pub(crate) struct SrgbEncoder {
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
    pub(crate) fn get() -> &'static Self {
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
    pub(crate) fn encode_all(&self, linear: &[f32], bytes: &mut [u8]) {
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

    /// [`SrgbEncoder::encode`] of the colours of opaque pixels, one a lane.
    #[inline(always)]
    pub(crate) fn encode_lanes(&self, colors: &Vec3Lanes, pixels: &mut [u32; LANES]) {
        let mut above = [[0; LANES]; 3];
        let [red, green, blue] = &mut above;
        for (i, ((red, green), blue)) in red.iter_mut().zip(green).zip(blue).enumerate() {
            let color = colors.get(i);
            *red = Self::above_least(color.x);
            *green = Self::above_least(color.y);
            *blue = Self::above_least(color.z);
        }
        *pixels = [0xff00_0000; LANES];
        for (above, shift) in above.iter().zip([0, 8, 16]) {
            let mut classes = [0; LANES];
            for (class, above) in classes.iter_mut().zip(above) {
                *class = self.classes[(above >> Self::SHIFT) as usize % Self::CLASSES];
            }
            for (pixel, (class, above)) in pixels.iter_mut().zip(classes.iter().zip(above)) {
                let code = (class + (above & ((1 << Self::SHIFT) - 1))) >> Self::SHIFT;
                *pixel |= (code & 255) << shift;
            }
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
}
