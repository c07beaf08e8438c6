//! The map, seen from the eye: where it matches, and how large its texels are.

use super::{
    Fact, ShowContext, Shown,
    light_pictures::as_linear,
    seen::{Seen, see},
};
use crate::{Image, ShadowComparison, color::LUMINANCE, shadow_map::MOST_SLOPE};
use rayon::prelude::*;
use umbriel_kernels::glam::Vec3;

const MATCH: [f32; 3] = [0.02, 0.65, 0.05];
const SKY: [f32; 4] = [0.05, 0.05, 0.05, 1.0];

/// Green where the point's depth is that of the map within what a texel of this slope spans; `ground` elsewhere.
pub(super) fn compare(context: &ShowContext, ground: &Image) -> Shown {
    let map = context.maps.of(context.light);
    let points = see(context);
    let matches: Vec<Option<bool>> = points
        .par_iter()
        .map(|point| {
            let point = point.as_ref()?;
            let found = map.lookup(point.p, point.ng)?;
            Some(is_match(point, &found))
        })
        .collect();
    let green = |(&[r, g, b, a], is_match): (&[f32; 4], &Option<bool>)| {
        if *is_match != Some(true) {
            return [r, g, b, a];
        }
        // The ground stays readable under the green.
        let light = 0.35 + 0.65 * Vec3::new(r, g, b).dot(LUMINANCE);
        let [mr, mg, mb] = MATCH;
        [mr * light, mg * light, mb * light, a]
    };
    let asked = matches.iter().flatten().count();
    let matching = matches.iter().filter(|m| **m == Some(true)).count();
    Shown {
        image: Image {
            pixels: ground.pixels.iter().zip(&matches).map(green).collect(),
            ..*ground
        },
        facts: vec![
            Fact::percent("of the points in the map match", matching, asked),
            Fact::percent("of the picture is in the map", asked, points.len()),
        ],
    }
}

/// Whether the map's depth is the point's: one texel's width, and what the slope makes of it, which is cut as for [`Bias::SlopeScaled`](crate::Bias).
fn is_match(point: &Seen, found: &ShadowComparison) -> bool {
    let cos = point.cos.abs().max(f32::MIN_POSITIVE);
    let slope = ((1.0 - cos * cos).max(0.0).sqrt() / cos).min(MOST_SLOPE);
    (found.depth - found.tap.stored).abs() <= found.texel * (1.0 + slope)
}

/// Least width of a square of one colour, in pixels.
const LEAST_SQUARE: f64 = 6.0;

/// Each texel in a colour of its own, or each square of the least power of two of texels that is [`LEAST_SQUARE`] wide in the median; grey
/// where no map is.
pub(super) fn map_texels(context: &ShowContext) -> Shown {
    let map = context.maps.of(context.light);
    let [width, height] = context.settings.resolution.map(|n| n as usize);
    let points = see(context);
    let found: Vec<Option<ShadowComparison>> = points
        .par_iter()
        .map(|point| point.as_ref().and_then(|p| map.lookup(p.p, p.ng)))
        .collect();
    let sizes = points.iter().zip(&found).filter_map(|(point, found)| {
        Some((
            found.as_ref()?.texel,
            found.as_ref()?.texel / point.as_ref()?.pixel,
        ))
    });
    let (widths, pixels): (Vec<f32>, Vec<f32>) = sizes.unzip();
    let pixels = median(pixels);
    // More than 2^14 texels no map has.
    let power = (0..14)
        .find(|&k| pixels * f64::from(1 << k) >= LEAST_SQUARE)
        .unwrap_or(14);
    let pixel = |(point, found): (&Option<Seen>, &Option<ShadowComparison>)| {
        let Some(point) = point else { return SKY };
        let color = found
            .as_ref()
            .map_or([0.5; 3], |found| square_color(found, power));
        let light = 0.35 + 0.65 * point.cos_eye.clamp(0.0, 1.0);
        let [r, g, b] = color.map(|c| as_linear(c * light));
        [r, g, b, 1.0]
    };
    Shown {
        image: Image {
            width,
            height,
            pixels: points.iter().zip(&found).map(pixel).collect(),
        },
        facts: vec![
            Fact::new("width of a texel, median", 1e3 * median(widths), "mm"),
            Fact::plain("that is in pixels", pixels),
            Fact::plain("texels along a square of one colour", f64::from(1 << power)),
        ],
    }
}

/// The middle value; 0 of none.
fn median(mut values: Vec<f32>) -> f64 {
    values.sort_by(f32::total_cmp);
    values.get(values.len() / 2).map_or(0.0, |&v| f64::from(v))
}

/// A hue that differs from square to square of 2^`power` texels, lighter and darker as on a chess board, so that neighbours never look alike.
fn square_color(found: &ShadowComparison, power: u32) -> [f32; 3] {
    let [x, y] = found.tap.texel.map(|i| (i >> power) as u32);
    let key =
        (x.wrapping_mul(0x9E37_79B1) ^ y.wrapping_mul(0x85EB_CA77)) ^ (found.tap.face as u32) << 13;
    let hash = (key ^ key >> 15).wrapping_mul(0x2C1B_3C6D);
    let hue = (hash >> 8) as f32 / (1 << 24) as f32;
    let value = if (x ^ y) & 1 == 0 { 1.0 } else { 0.72 };
    // The wheel of hues, with a saturation of 0.55.
    [0.0, 1.0 / 3.0, 2.0 / 3.0].map(|shift| {
        let turn = (hue + shift).fract();
        let full = ((turn - 0.5).abs() * 6.0 - 1.0).clamp(0.0, 1.0);
        value * (0.45 + 0.55 * full)
    })
}
