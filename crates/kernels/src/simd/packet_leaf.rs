//! Sixteen rays of a packet against one triangle.

use super::rays16::Rays16;
use super::triangle_lanes::{Distances, LaneHits, ShearedLanes};
use super::triangle_leaf::TriangleLeaves;
use fearless_simd::{Simd, f32x16, prelude::*};

/// The rays of a packet, sheared along the axis that is the longest of all of them.
pub(crate) struct PacketLeaf<S: Simd> {
    simd: S,
    axes: [usize; 3],
    origin: [f32x16<S>; 3],
    shear: [f32x16<S>; 2],
    /// `1 / d_kz`.
    scale: f32x16<S>,
    t_min: f32x16<S>,
}

impl<S: Simd> PacketLeaf<S> {
    /// For the rays like ray `one`.
    #[inline(always)]
    pub(crate) fn new(simd: S, rays: &Rays16<S>, one: usize) -> Self {
        let [x, y, z] = rays.ways.axes(one);
        Self {
            simd,
            axes: [x, y, z],
            origin: [rays.origin[x], rays.origin[y], rays.origin[z]],
            shear: [rays.slope[x], rays.slope[y]],
            scale: rays.scale,
            t_min: rays.t_min,
        }
    }

    /// [`ShearedLanes::meet`] for the rays of `members` and the triangle at `place` in a leaf, up to `t_max`.
    #[inline(always)]
    pub(crate) fn meet(
        &self,
        leaves: &TriangleLeaves,
        leaf: (usize, usize),
        place: usize,
        members: u32,
        t_max: f32x16<S>,
    ) -> Option<LaneHits<S>> {
        let (rows, n) = (leaves.rows(leaf), leaf.1);
        let lanes = ShearedLanes {
            a: self.shear(rows, n, place),
            b: self.shear(rows, n, place + 3 * n),
            c: self.shear(rows, n, place + 6 * n),
        };
        let t = Distances {
            min: self.t_min,
            max: t_max,
            scale: self.scale,
        };
        lanes.meet(self.simd, members, t)
    }

    /// The sheared corner of which `corner` is the first component.
    #[inline(always)]
    fn shear(&self, rows: &[f32], n: usize, corner: usize) -> [f32x16<S>; 3] {
        let [kx, ky, kz] = self.axes;
        let x = f32x16::splat(self.simd, rows[corner + kx * n]) - self.origin[0];
        let y = f32x16::splat(self.simd, rows[corner + ky * n]) - self.origin[1];
        let z = f32x16::splat(self.simd, rows[corner + kz * n]) - self.origin[2];
        [x - self.shear[0] * z, y - self.shear[1] * z, z]
    }
}
