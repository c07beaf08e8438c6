//! A ray against the triangles of a leaf, all at once.

use super::triangle_lanes::{Distances, LaneHits, ShearedLanes};
use crate::Triangle;
use crate::bvh::WIDTH;
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
    /// Writes the triangles of all leaves, given as ranges of `items`, the numbers of the triangles.
    pub(crate) fn new(
        mut leaves: Vec<(usize, usize)>,
        items: &[u32],
        triangle: impl Fn(usize) -> Triangle + Sync,
    ) -> Self {
        let mut rows = vec![0.0; 9 * items.len() + PADDING];
        leaves.sort_unstable();
        fill(&leaves, 0, &mut rows, items, &triangle);
        Self { rows }
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

    /// The rows of a leaf, and the numbers after it that a vector may read.
    #[inline(always)]
    pub(super) fn rows(&self, (first, n): (usize, usize)) -> &[f32] {
        &self.rows[9 * first..9 * (first + n) + PADDING]
    }

    /// The boxes of a leaf's triangles, as a node has them.
    #[inline(always)]
    pub(crate) fn boxes<S: Simd>(&self, simd: S, leaf: (usize, usize)) -> [[f32; WIDTH]; 6] {
        let (rows, n) = (self.rows(leaf), leaf.1);
        let [min_x, max_x] = span(simd, rows, n, 0);
        let [min_y, max_y] = span(simd, rows, n, n);
        let [min_z, max_z] = span(simd, rows, n, 2 * n);
        [min_x, min_y, min_z, max_x, max_y, max_z]
    }

    pub(crate) fn memory(&self) -> usize {
        self.rows.capacity() * size_of::<f32>()
    }
}

/// Leaves that one thread writes.
const SERIAL: usize = 1024;

/// Fills the rows from item `begin` on with leaves, in the order of their items.
fn fill(
    leaves: &[(usize, usize)],
    begin: usize,
    rows: &mut [f32],
    items: &[u32],
    triangle: &(impl Fn(usize) -> Triangle + Sync),
) {
    if leaves.len() > SERIAL {
        let (left, right) = leaves.split_at(leaves.len() / 2);
        let middle = right[0].0;
        let (left_rows, right_rows) = rows.split_at_mut(9 * (middle - begin));
        rayon::join(
            || fill(left, begin, left_rows, items, triangle),
            || fill(right, middle, right_rows, items, triangle),
        );
        return;
    }
    for &(first, n) in leaves {
        let rows = &mut rows[9 * (first - begin)..9 * (first - begin + n)];
        for (i, &item) in items[first..first + n].iter().enumerate() {
            let Triangle { a, b, c } = triangle(item as usize);
            for (component, x) in [a, b, c].iter().flat_map(|p| p.to_array()).enumerate() {
                rows[component * n + i] = x;
            }
        }
    }
}

/// A sheared ray, ready for leaves.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LeafRay {
    /// `kx`, `ky`, `kz`.
    pub(super) axes: [usize; 3],
    /// Along these axes.
    pub(super) origin: [f32; 3],
    /// `(d_kx, d_ky, 1) / d_kz`.
    pub(super) shear: [f32; 3],
    pub(super) t_min: f32,
}

impl LeafRay {
    /// [`ShearedLanes::meet`] for this ray and the triangles of a leaf, up to `t_max`.
    #[inline(always)]
    pub(crate) fn meet<S: Simd>(
        &self,
        simd: S,
        leaves: &TriangleLeaves,
        leaf: (usize, usize),
        t_max: f32,
    ) -> Option<LaneHits<S>> {
        let rows = leaves.rows(leaf);
        let n = leaf.1;
        let lanes = ShearedLanes {
            a: self.shear(simd, rows, n, 0),
            b: self.shear(simd, rows, n, 3 * n),
            c: self.shear(simd, rows, n, 6 * n),
        };
        let t = Distances {
            min: f32x16::splat(simd, self.t_min),
            max: f32x16::splat(simd, t_max),
            scale: f32x16::splat(simd, self.shear[2]),
        };
        lanes.meet(simd, (1 << n) - 1, t)
    }

    /// The sheared corners whose rows begin at `corner`.
    #[inline(always)]
    fn shear<S: Simd>(&self, simd: S, rows: &[f32], n: usize, corner: usize) -> [f32x16<S>; 3] {
        let x = self.moved(simd, rows, n, corner, 0);
        let y = self.moved(simd, rows, n, corner, 1);
        let z = self.moved(simd, rows, n, corner, 2);
        let [sx, sy, _] = self.shear;
        [
            x - f32x16::splat(simd, sx) * z,
            y - f32x16::splat(simd, sy) * z,
            z,
        ]
    }

    /// A component of the corners relative to the origin.
    #[inline(always)]
    fn moved<S: Simd>(
        &self,
        simd: S,
        rows: &[f32],
        n: usize,
        corner: usize,
        axis: usize,
    ) -> f32x16<S> {
        let row = row(simd, rows, corner + self.axes[axis] * n);
        row - f32x16::splat(simd, self.origin[axis])
    }
}

/// The least and the greatest of the three corners' rows of one component.
#[inline(always)]
fn span<S: Simd>(simd: S, rows: &[f32], n: usize, component: usize) -> [[f32; WIDTH]; 2] {
    let a = row(simd, rows, component);
    let b = row(simd, rows, component + 3 * n);
    let c = row(simd, rows, component + 6 * n);
    [a.min(b).min(c).into(), a.max(b).max(c).into()]
}

#[inline(always)]
fn row<S: Simd>(simd: S, rows: &[f32], begin: usize) -> f32x16<S> {
    f32x16::from_slice(simd, &rows[begin..begin + 16])
}
