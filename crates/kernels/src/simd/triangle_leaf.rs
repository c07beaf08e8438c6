//! A ray against the triangles of a leaf, all at once.

use super::triangle_lanes::{Distances, LaneHits, ShearedLanes};
use crate::Triangle;
use crate::bvh::WIDTH;
use fearless_simd::{Simd, f32x16, prelude::*};
use glam::Vec3;
use rayon::prelude::*;

/// Up to sixteen triangles of a leaf, component by component: 640 bytes, ten cache lines.
#[derive(Clone, Debug, PartialEq)]
#[repr(C, align(64))]
pub(super) struct TriangleLeaf {
    /// Corner by corner, x, y and z; zeros in unused places.
    pub(super) corners: [[[f32; WIDTH]; 3]; 3],
    /// Numbers of the triangles.
    primitives: [u32; WIDTH],
}

/// The triangles of all leaves. A leaf is named by its number here and by how many triangles it has.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct TriangleLeaves(Vec<TriangleLeaf>);

impl TriangleLeaves {
    /// Writes the triangles of all leaves, given as ranges of `items`, the numbers of the triangles.
    pub(crate) fn new(
        leaves: &[(usize, usize)],
        items: &[u32],
        triangle: impl Fn(usize) -> Triangle + Sync,
    ) -> Self {
        let leaf =
            |&(first, n): &(usize, usize)| TriangleLeaf::new(&items[first..first + n], &triangle);
        Self(leaves.par_iter().with_min_len(SERIAL).map(leaf).collect())
    }

    /// Triangle `i` of a leaf.
    #[inline(always)]
    pub(crate) fn triangle(&self, (leaf, _): (usize, usize), i: usize) -> Triangle {
        let corner = |k: usize| Vec3::from(self.0[leaf].corners[k].map(|row| row[i % WIDTH]));
        Triangle {
            a: corner(0),
            b: corner(1),
            c: corner(2),
        }
    }

    /// The number of triangle `i` of a leaf.
    #[inline(always)]
    pub(crate) fn primitive(&self, (leaf, _): (usize, usize), i: usize) -> u32 {
        self.0[leaf].primitives[i % WIDTH]
    }

    /// The numbers of all triangles; those that were cut are in several leaves.
    pub(crate) fn primitives(&self) -> impl Iterator<Item = u32> {
        let all = self.0.iter().flat_map(|leaf| leaf.primitives);
        all.filter(|&primitive| primitive != NOTHING)
    }

    #[inline(always)]
    pub(super) fn leaf(&self, (leaf, _): (usize, usize)) -> &TriangleLeaf {
        &self.0[leaf]
    }

    /// The boxes of a leaf's triangles, as a node has them.
    #[inline(always)]
    pub(crate) fn boxes<S: Simd>(&self, simd: S, (leaf, _): (usize, usize)) -> [[f32; WIDTH]; 6] {
        let corners = &self.0[leaf].corners;
        let [min_x, max_x] = span(simd, corners, 0);
        let [min_y, max_y] = span(simd, corners, 1);
        let [min_z, max_z] = span(simd, corners, 2);
        [min_x, min_y, min_z, max_x, max_y, max_z]
    }

    pub(crate) fn memory(&self) -> usize {
        self.0.capacity() * size_of::<TriangleLeaf>()
    }
}

/// Leaves that one thread writes.
const SERIAL: usize = 1024;

/// Stands in unused places.
const NOTHING: u32 = u32::MAX;

impl TriangleLeaf {
    fn new(items: &[u32], triangle: &impl Fn(usize) -> Triangle) -> Self {
        let mut leaf = Self {
            corners: [[[0.0; WIDTH]; 3]; 3],
            primitives: [NOTHING; WIDTH],
        };
        for (i, &item) in items.iter().enumerate() {
            leaf.primitives[i] = item;
            let Triangle { a, b, c } = triangle(item as usize);
            for (rows, corner) in leaf.corners.iter_mut().zip([a, b, c]) {
                for axis in 0..3 {
                    rows[axis][i] = corner[axis];
                }
            }
        }
        leaf
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
        let corners = &leaves.leaf(leaf).corners;
        let lanes = ShearedLanes {
            a: self.shear(simd, &corners[0]),
            b: self.shear(simd, &corners[1]),
            c: self.shear(simd, &corners[2]),
        };
        let t = Distances {
            min: f32x16::splat(simd, self.t_min),
            max: f32x16::splat(simd, t_max),
            scale: f32x16::splat(simd, self.shear[2]),
        };
        lanes.meet(simd, (1 << leaf.1) - 1, t)
    }

    /// The sheared corners.
    #[inline(always)]
    fn shear<S: Simd>(&self, simd: S, corners: &[[f32; WIDTH]; 3]) -> [f32x16<S>; 3] {
        let x = self.moved(simd, corners, 0);
        let y = self.moved(simd, corners, 1);
        let z = self.moved(simd, corners, 2);
        let [sx, sy, _] = self.shear;
        [
            x - f32x16::splat(simd, sx) * z,
            y - f32x16::splat(simd, sy) * z,
            z,
        ]
    }

    /// A component of the corners relative to the origin.
    #[inline(always)]
    fn moved<S: Simd>(&self, simd: S, corners: &[[f32; WIDTH]; 3], axis: usize) -> f32x16<S> {
        let row = f32x16::simd_from(simd, corners[self.axes[axis].min(2)]);
        row - f32x16::splat(simd, self.origin[axis])
    }
}

/// The least and the greatest of the three corners' rows along an axis.
#[inline(always)]
fn span<S: Simd>(simd: S, corners: &[[[f32; WIDTH]; 3]; 3], axis: usize) -> [[f32; WIDTH]; 2] {
    let [a, b, c] = [
        f32x16::simd_from(simd, corners[0][axis]),
        f32x16::simd_from(simd, corners[1][axis]),
        f32x16::simd_from(simd, corners[2][axis]),
    ];
    [a.min(b).min(c).into(), a.max(b).max(c).into()]
}
