//! A ray against the triangles of a leaf, all at once.

use super::triangle_lanes::{Distances, LaneHits, ShearedLanes};
use crate::{ShearedRay, Triangle};
use fearless_simd::{Simd, f32x16, prelude::*};
use glam::Vec3;

/// The corners of the triangles of all leaves. A leaf of `n` triangles beginning with item `first` has nine rows of `n` numbers,
/// from `9·first` on: a.x, a.y, a.z, b.x, ... c.z.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct TriangleLeaves {
    rows: Vec<f32>,
}

/// What the last leaf's vectors read beyond its end.
const PADDING: usize = 16;

impl TriangleLeaves {
    /// Room for `items` triangles.
    pub(crate) fn new(items: usize) -> Self {
        Self {
            rows: vec![0.0; 9 * items + PADDING],
        }
    }

    /// Writes the triangles of one leaf.
    pub(crate) fn set(&mut self, first: usize, triangles: &[Triangle]) {
        let n = triangles.len();
        let rows = &mut self.rows[9 * first..9 * (first + n)];
        for (i, triangle) in triangles.iter().enumerate() {
            for (corner, p) in [triangle.a, triangle.b, triangle.c].into_iter().enumerate() {
                for axis in 0..3 {
                    rows[(3 * corner + axis) * n + i] = p[axis];
                }
            }
        }
    }

    /// Triangle `i` of a leaf.
    #[inline(always)]
    pub(crate) fn triangle(&self, (first, n): (usize, usize), i: usize) -> Triangle {
        let rows = &self.rows[9 * first..9 * (first + n)];
        Triangle {
            a: Vec3::new(rows[i], rows[n + i], rows[2 * n + i]),
            b: Vec3::new(rows[3 * n + i], rows[4 * n + i], rows[5 * n + i]),
            c: Vec3::new(rows[6 * n + i], rows[7 * n + i], rows[8 * n + i]),
        }
    }

    pub(crate) fn memory(&self) -> usize {
        self.rows.capacity() * size_of::<f32>()
    }
}

/// A sheared ray, each constant in all lanes.
pub(crate) struct LeafRay<S: Simd> {
    axes: [usize; 3],
    origin: [f32x16<S>; 3],
    shear: [f32x16<S>; 2],
    scale: f32x16<S>,
    t_min: f32x16<S>,
}

impl<S: Simd> LeafRay<S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, ray: &ShearedRay, t_min: f32) -> Self {
        let (axes, [x, y, z], [sx, sy, scale]) = ray.parts();
        Self {
            axes,
            origin: [
                f32x16::splat(simd, x),
                f32x16::splat(simd, y),
                f32x16::splat(simd, z),
            ],
            shear: [f32x16::splat(simd, sx), f32x16::splat(simd, sy)],
            scale: f32x16::splat(simd, scale),
            t_min: f32x16::splat(simd, t_min),
        }
    }

    /// [`ShearedLanes::meet`] for this ray and the triangles of a leaf, up to `t_max`.
    #[inline(always)]
    pub(crate) fn meet(
        &self,
        simd: S,
        leaves: &TriangleLeaves,
        (first, n): (usize, usize),
        t_max: f32,
    ) -> Option<LaneHits<S>> {
        let rows = &leaves.rows[9 * first..9 * (first + n) + PADDING];
        let lanes = ShearedLanes {
            a: self.shear(simd, rows, n, 0),
            b: self.shear(simd, rows, n, 3 * n),
            c: self.shear(simd, rows, n, 6 * n),
        };
        let t = Distances {
            min: self.t_min,
            max: f32x16::splat(simd, t_max),
            scale: self.scale,
        };
        lanes.meet(simd, (1 << n) - 1, t)
    }

    /// The sheared corners whose rows begin at `corner`.
    #[inline(always)]
    fn shear(&self, simd: S, rows: &[f32], n: usize, corner: usize) -> [f32x16<S>; 3] {
        let x = row(simd, rows, corner + self.axes[0] * n) - self.origin[0];
        let y = row(simd, rows, corner + self.axes[1] * n) - self.origin[1];
        let z = row(simd, rows, corner + self.axes[2] * n) - self.origin[2];
        [x - self.shear[0] * z, y - self.shear[1] * z, z]
    }
}

#[inline(always)]
fn row<S: Simd>(simd: S, rows: &[f32], begin: usize) -> f32x16<S> {
    f32x16::from_slice(simd, &rows[begin..begin + 16])
}
