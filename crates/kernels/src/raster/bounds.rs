//! Where a cluster lies on the picture.

use super::clusters::Cluster;
use super::projection::{GUARD, Projection};
use super::slide::pixels_between;
use fearless_simd::{Simd, f32x8, mask32x8, prelude::*};
use glam::{Vec3, Vec4};

/// What is known of a cluster.
#[derive(Clone, Copy, Debug)]
pub(super) enum Place {
    /// Not on the picture.
    Outside,
    /// Nothing of it needs a cut.
    Whole {
        /// All its pixels are in `[x0, y0, x1, y1]`, with the ends, on the picture.
        pixels: [i32; 4],
        /// None of its depths is above this.
        nearest: f32,
    },
    /// Its triangles are looked at one by one.
    Unsure,
}

/// Relative error of a sum of four products and of what follows, with room to spare.
const ERROR: f32 = 8.0 * f32::EPSILON;

impl Projection {
    /// Where the box of a cluster lies: by its eight corners, and by as much more as rounding may move a vertex.
    #[inline(always)]
    pub(super) fn place<S: Simd>(&self, simd: S, cluster: &Cluster, size: [u32; 2]) -> Place {
        if cluster.vertices == 0 {
            return Place::Outside;
        }
        if !cluster.finite {
            return Place::Unsure;
        }
        let (low, high) = (cluster.min - self.origin, cluster.max - self.origin);
        let [x, y, z, w] = self.box_corners(simd, low, high);
        let reach = low.abs().max(high.abs());
        let [ex, ey, ez, ew] = self.rows.map(|row| {
            let row = row.abs();
            ERROR * (row.x * reach.x + row.y * reach.y + row.z * reach.z + row.w)
        });
        let w_min = w.reduce_min();
        // Also for what is NaN.
        if !(w_min - ew >= 1.00001 * self.least_w) {
            let beyond = |d: f32x8<S>, error: f32| d.reduce_max() < -error;
            let outside = beyond(w - self.least_w, ew)
                || beyond(w + x, ew + ex)
                || beyond(w - x, ew + ex)
                || beyond(w + y, ew + ey)
                || beyond(w - y, ew + ey);
            return if outside {
                Place::Outside
            } else {
                Place::Unsure
            };
        }
        let inverse = f32x8::splat(simd, 1.0) / w;
        let [(x0, x1), (y0, y1)] = [
            self.span(0, x * inverse, ex, ew, w_min - ew),
            self.span(1, y * inverse, ey, ew, w_min - ew),
        ];
        let depth = z * inverse;
        let greatest = depth.abs().reduce_max();
        let nearest = depth.reduce_max() + (ez + greatest * ew) / (w_min - ew) + ERROR * greatest;
        let sound = x0 >= -GUARD && x1 <= GUARD && y0 >= -GUARD && y1 <= GUARD && greatest < 1e30;
        if !sound {
            return Place::Unsure;
        }
        let [x0, x1] = pixels_between(x0 as i32, x1 as i32);
        let [y0, y1] = pixels_between(y0 as i32, y1 as i32);
        let (x0, x1) = (x0.max(0), x1.min(size[0] as i32 - 1));
        let (y0, y1) = (y0.max(0), y1.min(size[1] as i32 - 1));
        if x0 > x1 || y0 > y1 {
            return Place::Outside;
        }
        Place::Whole {
            pixels: [x0, y0, x1, y1],
            nearest,
        }
    }

    /// The corners of a box in clip space.
    #[inline(always)]
    fn box_corners<S: Simd>(&self, simd: S, low: Vec3, high: Vec3) -> [f32x8<S>; 4] {
        let splat = (f32x8::splat(simd, 0.0), mask32x8::from_bitmask(simd, 0xaa));
        let pick = |bits: u64, low: f32, high: f32| {
            mask32x8::from_bitmask(simd, bits).select(splat.0 + high, splat.0 + low)
        };
        let x = pick(0xaa, low.x, high.x);
        let y = pick(0xcc, low.y, high.y);
        let z = pick(0xf0, low.z, high.z);
        let [a, b, c, d] = self.rows;
        [
            row8(a, x, y, z),
            row8(b, x, y, z),
            row8(c, x, y, z),
            row8(d, x, y, z),
        ]
    }

    /// Least and greatest position on an axis of the picture, in its units, for `ratio` = `clip / w` of the corners.
    #[inline(always)]
    fn span<S: Simd>(&self, axis: usize, ratio: f32x8<S>, e: f32, ew: f32, w: f32) -> (f32, f32) {
        let at = ratio * self.scale[axis] + self.center[axis];
        let error = (e + ratio.abs().reduce_max() * ew) / w * self.scale[axis].abs() + 8.0;
        (at.reduce_min() - error, at.reduce_max() + error)
    }
}

#[inline(always)]
fn row8<S: Simd>(r: Vec4, x: f32x8<S>, y: f32x8<S>, z: f32x8<S>) -> f32x8<S> {
    x * r.x + y * r.y + z * r.z + r.w
}
