//! Depth images of moments, blurred beforehand.

use super::super::{DepthMap, ShadowFilter, bias::Receiver, cube::face_of};
use super::{
    blur::blur,
    evsm::{exponential_moments, filter_evsm},
    msm::{filter_msm, four_moments},
    vsm::{filter_vsm, variance_moments},
};
use rayon::prelude::*;
use umbriel_kernels::glam::Vec2;

/// The blurred moments of one depth image.
///
/// Around the face of a cube lies a frame of one texel, and the blur reaches over its edges: beyond them are the depths that the next faces hold along the
/// same rays, as they would be on this face. Around other images nothing is known, and their last texels count for what lies beyond.
#[derive(Clone, Debug)]
pub(crate) struct Moments {
    texels: Texels,
    /// Texels a side, with the frame.
    side: usize,
    /// Width of the frame.
    frame: f32,
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
    /// The moments that a filter needs of each image of a light; none for filters of comparisons. Texels without anything are as deep as the deepest
    /// one. The images are those of a cube, or each for itself.
    pub(crate) fn of(faces: &[DepthMap], cube: bool, filter: &ShadowFilter) -> Vec<Self> {
        let is_needed = matches!(
            filter,
            ShadowFilter::Vsm { .. } | ShadowFilter::Evsm { .. } | ShadowFilter::Msm { .. }
        );
        if !is_needed {
            return Vec::new();
        }
        let one = |face| Self::of_face(&Around { faces, face, cube }, filter);
        (0..faces.len()).filter_map(one).collect()
    }

    fn of_face(around: &Around, filter: &ShadowFilter) -> Option<Self> {
        let (first, last) = around.faces[around.face].range();
        let length = (last - first).max(1e-6 * last.abs()).max(f32::MIN_POSITIVE);
        let share = |z: f32| ((z - first) / length).clamp(0.0, 1.0);
        let texels = match *filter {
            ShadowFilter::Vsm { radius } => {
                Texels::Variance(around.blurred(radius, |z| variance_moments(share(z))))
            }
            ShadowFilter::Evsm { radius } => {
                Texels::Exponential(around.blurred(radius, |z| exponential_moments(share(z))))
            }
            ShadowFilter::Msm { radius } => {
                Texels::Four(around.blurred(radius, |z| four_moments(share(z))))
            }
            _ => return None,
        };
        Some(Self {
            texels,
            side: around.side() + 2 * around.frame(),
            frame: around.frame() as f32,
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
        let at = (at + (self.frame - 0.5)).clamp(Vec2::ZERO, Vec2::splat(self.side as f32 - 1.0));
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

/// A depth image among those of its light.
struct Around<'a> {
    faces: &'a [DepthMap],
    face: usize,
    cube: bool,
}

impl Around<'_> {
    fn side(&self) -> usize {
        self.faces[self.face].view.side as usize
    }

    /// Texels beyond each edge that bilinear sampling asks for.
    fn frame(&self) -> usize {
        usize::from(self.cube)
    }

    /// The means of `of` over squares of texels around each of the image and of its frame.
    fn blurred<const N: usize>(
        &self,
        radius: u32,
        of: impl Fn(f32) -> [f32; N] + Sync,
    ) -> Vec<[f32; N]> {
        let radius = radius.min(self.side() as u32);
        let reach = if self.cube { radius as usize + 1 } else { 0 };
        let side = self.side() + 2 * reach;
        let mut texels = vec![[0.0; N]; side * side];
        let rows = texels.par_chunks_mut(side).enumerate();
        rows.for_each(|(y, row)| {
            for (x, texel) in row.iter_mut().enumerate() {
                *texel = of(self.depth(x as i32 - reach as i32, y as i32 - reach as i32));
            }
        });
        blur(&mut texels, side, radius);
        let cut = reach - self.frame();
        if cut == 0 {
            return texels;
        }
        let kept = texels.chunks(side).skip(cut).take(side - 2 * cut);
        kept.flat_map(|row| &row[cut..side - cut])
            .copied()
            .collect()
    }

    /// The depth in metres of what the light sees in the middle of a texel, of a cube also beyond the edges.
    fn depth(&self, x: i32, y: i32) -> f32 {
        let map = &self.faces[self.face];
        if let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y))
            && let Some(z) = map.depth(x, y)
        {
            return z;
        }
        let way = map.view.ray(Vec2::new(x as f32, y as f32) + 0.5).dir;
        let next = &self.faces[face_of(way)];
        let seen = next.view.project(next.view.origin + way);
        let last = Vec2::splat(next.view.side as f32 - 1.0);
        let texel = seen.at.floor().clamp(Vec2::ZERO, last).as_uvec2();
        let z = next.depth(texel.x, texel.y).unwrap_or(f32::INFINITY);
        // `way` is one metre deep on the own face, and `seen.z` on the next one.
        z / seen.z
    }
}
