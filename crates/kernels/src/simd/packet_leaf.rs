//! Sixteen rays of a packet against one triangle.

use super::rays16::Rays16;
use super::triangle_lanes::{Distances, LaneHits, ShearedLanes};
use super::triangle_leaf::TriangleLeaves;
use crate::bvh::WIDTH;
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
        let corners = &leaves.block(leaf).corners;
        let lanes = ShearedLanes {
            a: self.shear(&corners[0], place),
            b: self.shear(&corners[1], place),
            c: self.shear(&corners[2], place),
        };
        let t = Distances {
            min: self.t_min,
            max: t_max,
            scale: self.scale,
        };
        lanes.meet(self.simd, members, t)
    }

    /// The sheared corner of the triangle at `place`.
    #[inline(always)]
    fn shear(&self, corners: &[[f32; WIDTH]; 3], place: usize) -> [f32x16<S>; 3] {
        let x = self.moved(corners, 0, place);
        let y = self.moved(corners, 1, place);
        let z = self.moved(corners, 2, place);
        [x - self.shear[0] * z, y - self.shear[1] * z, z]
    }

    /// A component of the corner relative to the origins.
    #[inline(always)]
    fn moved(&self, corners: &[[f32; WIDTH]; 3], axis: usize, place: usize) -> f32x16<S> {
        let x = corners[self.axes[axis].min(2)][place % WIDTH];
        f32x16::splat(self.simd, x) - self.origin[axis]
    }
}
