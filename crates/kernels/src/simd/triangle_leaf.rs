//! A ray against the triangles of a leaf, all at once.

use super::triangle_lanes::{Distances, LaneHits, ShearedLanes};
use crate::Triangle;
use crate::bvh::{Tree, WIDTH};
use fearless_simd::{Simd, f32x16, prelude::*};
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;

/// Sixteen triangles, component by component: 640 bytes, ten cache lines.
#[derive(Clone, Debug, PartialEq)]
#[repr(C, align(64))]
pub(super) struct TriangleBlock {
    /// Corner by corner, x, y and z; zeros in unused lanes.
    pub(super) corners: [[[f32; WIDTH]; 3]; 3],
    /// Numbers of the triangles.
    primitives: [u32; WIDTH],
}

/// The triangles of all leaves. A leaf `(quarter, n)` has `n` lanes of a block from a quarter on, counted through all blocks.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct TriangleLeaves(Vec<TriangleBlock>);

/// Lanes in a quarter of a block.
const QUARTER: usize = WIDTH / 4;

/// Stands in unused lanes.
const NOTHING: u32 = u32::MAX;

/// Blocks that one thread writes.
const SERIAL: usize = 1024;

impl TriangleLeaves {
    /// Places the leaves of a tree over `items`, the numbers of triangles.
    pub(crate) fn new(
        tree: &mut Tree,
        items: &[u32],
        triangle: impl Fn(usize) -> Triangle + Sync,
    ) -> Self {
        let mut shelf = Shelf::default();
        tree.place_leaves(|first, n| shelf.place(&items[first..first + n]));
        let block = |items: &[u32; WIDTH]| TriangleBlock::new(items, &triangle);
        let blocks = shelf.blocks.par_iter().with_min_len(SERIAL);
        Self(blocks.map(block).collect())
    }

    /// The lanes of a leaf.
    #[inline(always)]
    pub(crate) fn lanes(&self, (quarter, n): (usize, usize)) -> Range<usize> {
        let first = quarter % 4 * QUARTER;
        first..first + n
    }

    /// A bit for each lane of a leaf.
    #[inline(always)]
    pub(crate) fn mask(&self, (quarter, n): (usize, usize)) -> u32 {
        ((1 << n) - 1) << (quarter % 4 * QUARTER)
    }

    #[inline(always)]
    pub(super) fn block(&self, (quarter, _): (usize, usize)) -> &TriangleBlock {
        &self.0[quarter / 4]
    }

    /// The triangle in a lane of a leaf's block.
    #[inline(always)]
    pub(crate) fn triangle(&self, leaf: (usize, usize), lane: usize) -> Triangle {
        let corners = &self.block(leaf).corners;
        let corner = |k: usize| Vec3::from(corners[k].map(|row| row[lane % WIDTH]));
        Triangle {
            a: corner(0),
            b: corner(1),
            c: corner(2),
        }
    }

    /// The number of the triangle in a lane of a leaf's block.
    #[inline(always)]
    pub(crate) fn primitive(&self, leaf: (usize, usize), lane: usize) -> u32 {
        self.block(leaf).primitives[lane % WIDTH]
    }

    /// The numbers of all triangles; those that were cut are in several leaves.
    pub(crate) fn primitives(&self) -> impl Iterator<Item = u32> {
        let all = self.0.iter().flat_map(|block| block.primitives);
        all.filter(|&primitive| primitive != NOTHING)
    }

    /// The boxes of the triangles of a leaf's block, as a node has them.
    #[inline(always)]
    pub(crate) fn boxes<S: Simd>(&self, simd: S, leaf: (usize, usize)) -> [[f32; WIDTH]; 6] {
        let corners = &self.block(leaf).corners;
        let [min_x, max_x] = span(simd, corners, 0);
        let [min_y, max_y] = span(simd, corners, 1);
        let [min_z, max_z] = span(simd, corners, 2);
        [min_x, min_y, min_z, max_x, max_y, max_z]
    }

    pub(crate) fn memory(&self) -> usize {
        self.0.capacity() * size_of::<TriangleBlock>()
    }
}

/// Blocks being filled with leaves, none of which lies in two.
#[derive(Default)]
struct Shelf {
    blocks: Vec<[u32; WIDTH]>,
    /// The last block that has so many quarters left at its end.
    open: [Option<usize>; 4],
}

impl Shelf {
    /// Puts the triangles of a leaf where they leave the least room; gives their first quarter.
    fn place(&mut self, items: &[u32]) -> usize {
        let quarters = items.len().div_ceil(QUARTER);
        let fits = (quarters..4).find_map(|room| Some((self.open[room].take()?, room)));
        let (block, room) = fits.unwrap_or_else(|| {
            self.blocks.push([NOTHING; WIDTH]);
            (self.blocks.len() - 1, 4)
        });
        let first = (4 - room) * QUARTER;
        self.blocks[block][first..first + items.len()].copy_from_slice(items);
        self.open[room - quarters] = Some(block);
        4 * block + 4 - room
    }
}

impl TriangleBlock {
    fn new(items: &[u32; WIDTH], triangle: &impl Fn(usize) -> Triangle) -> Self {
        let mut corners = [[[0.0; WIDTH]; 3]; 3];
        for (lane, &item) in items.iter().enumerate() {
            if item == NOTHING {
                continue;
            }
            let Triangle { a, b, c } = triangle(item as usize);
            for (rows, corner) in corners.iter_mut().zip([a, b, c]) {
                for axis in 0..3 {
                    rows[axis][lane] = corner[axis];
                }
            }
        }
        Self {
            corners,
            primitives: *items,
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
        let corners = &leaves.block(leaf).corners;
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
        lanes.meet(simd, leaves.mask(leaf), t)
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
