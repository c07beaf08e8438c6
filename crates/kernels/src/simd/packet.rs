//! Sixteen rays that keep together: against one box, and against sixteen boxes.

use super::rays16::{Rays16, Slab16};
use crate::bvh::{Node, WIDTH};
use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};

/// Rays with the same signs and longest axis, and bounds of their constants over all of them.
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
        Self {
            simd,
            rays,
            near: [
                Bounds::new(simd, &near[0], members, !x),
                Bounds::new(simd, &near[1], members, !y),
                Bounds::new(simd, &near[2], members, !z),
            ],
            far: [
                Bounds::new(simd, &far[0], members, x),
                Bounds::new(simd, &far[1], members, y),
                Bounds::new(simd, &far[2], members, z),
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
            t_min: f32x16::splat(simd, least(simd, rays.t_min, members)),
        }
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
        greatest(
            self.simd,
            t,
            mask32x16::from_bitmask(self.simd, members.into()),
        )
    }
}

impl<S: Simd> Bounds<S> {
    #[inline(always)]
    fn new(simd: S, slab: &Slab16<S>, members: mask32x16<S>, greatest_origin: bool) -> Self {
        let origin = if greatest_origin {
            greatest(simd, slab.origin, members)
        } else {
            least(simd, slab.origin, members)
        };
        Self {
            origin: f32x16::splat(simd, origin),
            scales: [
                f32x16::splat(simd, least(simd, slab.scale, members)),
                f32x16::splat(simd, greatest(simd, slab.scale, members)),
            ],
        }
    }

    /// Parameters between which, or beyond which, all rays meet the planes.
    #[inline(always)]
    fn ends(&self, simd: S, boxes: &[[f32; WIDTH]; 6], bounds: usize) -> (f32x16<S>, f32x16<S>) {
        let x = f32x16::<S>::simd_from(simd, boxes[bounds % 6]) - self.origin;
        (x * self.scales[0], x * self.scales[1])
    }
}

#[inline(always)]
fn least<S: Simd>(simd: S, x: f32x16<S>, members: mask32x16<S>) -> f32 {
    members
        .select(x, f32x16::splat(simd, f32::INFINITY))
        .reduce_min()
}

#[inline(always)]
fn greatest<S: Simd>(simd: S, x: f32x16<S>, members: mask32x16<S>) -> f32 {
    members
        .select(x, f32x16::splat(simd, f32::NEG_INFINITY))
        .reduce_max()
}
