//! Depth images of moments, blurred beforehand.

use super::super::{DepthMap, ShadowFilter, bias::Receiver};
use super::{
    blur::blur,
    evsm::{exponential_moments, filter_evsm},
    msm::{filter_msm, four_moments},
    vsm::{filter_vsm, variance_moments},
};
use rayon::prelude::*;
use umbriel_kernels::glam::Vec2;

/// The blurred moments of one depth image.
#[derive(Clone, Debug)]
pub(crate) struct Moments {
    texels: Texels,
    side: usize,
    /// The depth in metres that counts as 0, and the length that counts as 1.
    start: f32,
    length: f32,
}

#[derive(Clone, Debug)]
enum Texels {
    Variance(Vec<[f32; 2]>),
    Exponential(Vec<[f32; 4]>),
    Four(Vec<[f32; 4]>),
}

impl Moments {
    /// The moments that a filter needs; `None` for filters of comparisons. Texels without anything are as deep as the
    /// deepest one.
    pub(crate) fn new(map: &DepthMap, filter: &ShadowFilter) -> Option<Self> {
        let is_needed = matches!(
            filter,
            ShadowFilter::Vsm { .. } | ShadowFilter::Evsm { .. } | ShadowFilter::Msm { .. }
        );
        let (first, last) = is_needed.then(|| map.range())?;
        let length = (last - first).max(1e-6 * last.abs()).max(f32::MIN_POSITIVE);
        let side = map.view.side as usize;
        let texels = match *filter {
            ShadowFilter::Vsm { radius } => {
                Texels::Variance(moments(map, first, length, radius, variance_moments))
            }
            ShadowFilter::Evsm { radius } => {
                Texels::Exponential(moments(map, first, length, radius, exponential_moments))
            }
            ShadowFilter::Msm { radius } => {
                Texels::Four(moments(map, first, length, radius, four_moments))
            }
            _ => return None,
        };
        Some(Self {
            texels,
            side,
            start: first,
            length,
        })
    }

    /// Bytes on the heap.
    pub(crate) fn memory(&self) -> usize {
        match &self.texels {
            Texels::Variance(texels) => size_of_val(&texels[..]),
            Texels::Exponential(texels) | Texels::Four(texels) => size_of_val(&texels[..]),
        }
    }

    /// The lit share of a receiver of `view`'s map.
    pub(crate) fn filter(&self, map: &DepthMap, receiver: &Receiver) -> f32 {
        let z = map.view.linear(receiver.stored.max(f32::MIN_POSITIVE));
        let t = ((z - self.start) / self.length).clamp(0.0, 1.0);
        match &self.texels {
            Texels::Variance(texels) => filter_vsm(self.sample(texels, receiver.at), t),
            Texels::Exponential(texels) => filter_evsm(self.sample(texels, receiver.at), t),
            Texels::Four(texels) => filter_msm(self.sample(texels, receiver.at), t),
        }
    }

    /// The moments between four texels.
    fn sample<const N: usize>(&self, texels: &[[f32; N]], at: Vec2) -> [f32; N] {
        let at = (at - 0.5).clamp(Vec2::ZERO, Vec2::splat(self.side as f32 - 1.0));
        let (low, share) = (at.floor().as_uvec2(), at - at.floor());
        let texel = |dx: usize, dy: usize| {
            let x = (low.x as usize + dx).min(self.side - 1);
            let y = (low.y as usize + dy).min(self.side - 1);
            &texels[y * self.side + x]
        };
        let (a, b, c, d) = (texel(0, 0), texel(1, 0), texel(0, 1), texel(1, 1));
        std::array::from_fn(|k| {
            let top = a[k] + (b[k] - a[k]) * share.x;
            let bottom = c[k] + (d[k] - c[k]) * share.x;
            top + (bottom - top) * share.y
        })
    }
}

fn moments<const N: usize>(
    map: &DepthMap,
    start: f32,
    length: f32,
    radius: u32,
    of: fn(f32) -> [f32; N],
) -> Vec<[f32; N]> {
    let share = |&stored: &f32| ((map.view.linear(stored) - start) / length).clamp(0.0, 1.0);
    let mut texels: Vec<_> = map.stored.par_iter().map(|d| of(share(d))).collect();
    blur(
        &mut texels,
        map.view.side as usize,
        radius.min(map.view.side),
    );
    texels
}
