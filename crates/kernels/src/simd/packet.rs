//! Sixteen rays that keep together: against one box, and against sixteen boxes.

use super::box_ray::U;
use super::rays16::{Rays16, Slab16};
use crate::bvh::{Node, WIDTH};
use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};

/// Rays with the same signs and longest axis, and bounds of their constants over all of them: where interval arithmetic says that none meets a box,
/// none does.
///
/// Source: Boulos, Wald & Shirley, "Geometric and Arithmetic Culling Methods for Entire Ray Packets", University of Utah UUCS-06-010, 2006;
/// Wald, Boulos & Shirley, "Ray Tracing Deformable Scenes Using Dynamic Bounding Volume Hierarchies", ACM TOG 26(1), 2007.
pub(crate) struct PacketBoxes<'a, S: Simd> {
    simd: S,
    rays: &'a Rays16<S>,
    near: [Bounds<S>; 3],
    far: [Bounds<S>; 3],
    /// Which of a node's bounds are met first and last.
    near_bounds: [usize; 3],
    far_bounds: [usize; 3],
    t_min: f32x16<S>,
}

/// The extremes of a slab's constants over the rays.
#[derive(Clone, Copy)]
struct Bounds<S: Simd> {
    /// The origin that gives the extreme parameter.
    origin: f32x16<S>,
    /// The least and the greatest scale.
    scales: [f32x16<S>; 2],
}

impl<'a, S: Simd> PacketBoxes<'a, S> {
    /// The rays of `members` are like ray `one`.
    #[inline(always)]
    pub(crate) fn new(simd: S, rays: &'a Rays16<S>, one: usize, members: u32) -> Self {
        let [x, y, z] = [
            rays.ways.is_backward(one, 0),
            rays.ways.is_backward(one, 1),
            rays.ways.is_backward(one, 2),
        ];
        let members = mask32x16::from_bitmask(simd, members.into());
        let [near, far] = [&rays.near, &rays.far];
        let near_x = Bounds::new(simd, &near[0], members, !x);
        let near_y = Bounds::new(simd, &near[1], members, !y);
        let near_z = Bounds::new(simd, &near[2], members, !z);
        Self {
            simd,
            rays,
            near: [near_x, near_y, near_z],
            far: [
                near_x.beyond(simd, &far[0], members, x),
                near_y.beyond(simd, &far[1], members, y),
                near_z.beyond(simd, &far[2], members, z),
            ],
            near_bounds: [
                3 * usize::from(x),
                1 + 3 * usize::from(y),
                2 + 3 * usize::from(z),
            ],
            far_bounds: [
                3 * usize::from(!x),
                1 + 3 * usize::from(!y),
                2 + 3 * usize::from(!z),
            ],
            t_min: extreme(simd, rays.t_min, members, false),
        }
    }

    /// Where the rays end.
    #[inline(always)]
    pub(crate) fn ends(&self) -> f32x16<S> {
        self.rays.t_max
    }

    /// A bit for each of sixteen boxes that any ray of the packet may meet before `t_max`, and lower bounds of the parameters of entry.
    #[inline(always)]
    pub(crate) fn meet_any(&self, boxes: &[[f32; WIDTH]; 6], t_max: f32) -> (u32, f32x16<S>) {
        let t_near = self.first(boxes, 0).max(self.first(boxes, 1));
        let t_near = t_near.max(self.first(boxes, 2).max(self.t_min));
        let t_far = self.last(boxes, 0).min(self.last(boxes, 1));
        let t_max = f32x16::splat(self.simd, t_max);
        let t_far = t_far.min(self.last(boxes, 2).min(t_max));
        (t_near.simd_le(t_far).to_bitmask() as u32, t_near)
    }

    #[inline(always)]
    fn first(&self, boxes: &[[f32; WIDTH]; 6], axis: usize) -> f32x16<S> {
        let (a, b) = self.near[axis].ends(self.simd, boxes, self.near_bounds[axis]);
        a.min(b)
    }

    #[inline(always)]
    fn last(&self, boxes: &[[f32; WIDTH]; 6], axis: usize) -> f32x16<S> {
        let (a, b) = self.far[axis].ends(self.simd, boxes, self.far_bounds[axis]);
        a.max(b)
    }

    /// A bit for each ray that meets box `place` of a node before its `t_max`.
    #[inline(always)]
    pub(crate) fn meet_box(&self, node: &Node, place: usize, t_max: f32x16<S>) -> u32 {
        let (near, far) = (&self.rays.near, &self.rays.far);
        let t_near = self
            .meet(&near[0], node, self.near_bounds[0], place)
            .max(self.meet(&near[1], node, self.near_bounds[1], place));
        let z = self.meet(&near[2], node, self.near_bounds[2], place);
        let t_near = t_near.max(z.max(self.rays.t_min));
        let t_far = self
            .meet(&far[0], node, self.far_bounds[0], place)
            .min(self.meet(&far[1], node, self.far_bounds[1], place));
        let z = self.meet(&far[2], node, self.far_bounds[2], place);
        let t_far = t_far.min(z.min(t_max));
        t_near.simd_le(t_far).to_bitmask() as u32
    }

    #[inline(always)]
    fn meet(&self, slab: &Slab16<S>, node: &Node, bounds: usize, place: usize) -> f32x16<S> {
        f32x16::splat(self.simd, node.bounds[bounds % 6][place % 16])
            .mul_sub(slab.scale, slab.shift)
    }

    /// The greatest lane among the members.
    #[inline(always)]
    pub(crate) fn greatest(&self, t: f32x16<S>, members: u32) -> f32 {
        mask32x16::from_bitmask(self.simd, members.into())
            .select(t, f32x16::splat(self.simd, f32::NEG_INFINITY))
            .reduce_max()
    }
}

impl<S: Simd> Bounds<S> {
    #[inline(always)]
    fn new(simd: S, slab: &Slab16<S>, members: mask32x16<S>, greatest_origin: bool) -> Self {
        Self {
            origin: extreme(simd, slab.origin, members, greatest_origin),
            scales: [
                extreme(simd, slab.scale, members, false),
                extreme(simd, slab.scale, members, true),
            ],
        }
    }

    /// For the far planes, whose scales are those of the near ones but for a factor of at most 1 + 10u.
    #[inline(always)]
    fn beyond(
        &self,
        simd: S,
        far: &Slab16<S>,
        members: mask32x16<S>,
        greatest_origin: bool,
    ) -> Self {
        let wider = f32x16::splat(simd, 1.0 + 16.0 * U);
        Self {
            origin: extreme(simd, far.origin, members, greatest_origin),
            scales: [self.scales[0] * wider, self.scales[1] * wider],
        }
    }

    /// Parameters between which, or beyond which, all rays meet the planes.
    #[inline(always)]
    fn ends(&self, simd: S, boxes: &[[f32; WIDTH]; 6], bounds: usize) -> (f32x16<S>, f32x16<S>) {
        let x = f32x16::<S>::simd_from(simd, boxes[bounds % 6]) - self.origin;
        (x * self.scales[0], x * self.scales[1])
    }
}

/// The least or the greatest lane among the members, in all lanes.
#[inline(always)]
fn extreme<S: Simd>(simd: S, x: f32x16<S>, members: mask32x16<S>, greatest: bool) -> f32x16<S> {
    let extreme = if greatest {
        members
            .select(x, f32x16::splat(simd, f32::NEG_INFINITY))
            .reduce_max()
    } else {
        members
            .select(x, f32x16::splat(simd, f32::INFINITY))
            .reduce_min()
    };
    f32x16::splat(simd, extreme)
}
