//! A node of the hierarchy, and the test of a ray against its four boxes.

use super::build::BinaryNode;
use crate::{Interval, Ray};
use glam::Vec4;

/// Four boxes, component by component, and what is in them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Node {
    pub(super) min: [Vec4; 3],
    pub(super) max: [Vec4; 3],
    pub(super) children: [Child; 4],
}

impl Node {
    /// Four unused places, which no ray meets.
    pub(super) const EMPTY: Self = Self {
        min: [Vec4::INFINITY; 3],
        max: [Vec4::NEG_INFINITY; 3],
        children: [Child { first: 0, count: 0 }; 4],
    };

    pub(super) fn set(&mut self, place: usize, member: &BinaryNode) {
        for axis in 0..3 {
            self.min[axis][place] = member.aabb.min[axis];
            self.max[axis][place] = member.aabb.max[axis];
        }
        self.children[place] = Child {
            first: member.first,
            count: member.count,
        };
    }
}

/// A node or a leaf's items.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Child {
    /// Number of the node, or of the leaf's first item.
    pub(super) first: u32,
    /// Number of items in the leaf; [`INNER`] for a node, 0 for an unused place.
    pub(super) count: u32,
}

/// Marks a child that is a node.
pub(super) const INNER: u32 = u32::MAX;
/// Where every walk begins.
pub(super) const ROOT: Child = Child {
    first: 0,
    count: INNER,
};

/// What the slab test needs of a ray, each component four times.
pub(super) struct Slabs {
    origin: [Vec4; 3],
    inv_dir: [Vec4; 3],
    /// Which of the directions do not point backwards.
    forward: [bool; 3],
}

impl Slabs {
    #[inline]
    pub(super) fn new(ray: &Ray) -> Self {
        let inv_dir = ray.dir.recip();
        Self {
            origin: ray.origin.to_array().map(Vec4::splat),
            inv_dir: inv_dir.to_array().map(Vec4::splat),
            forward: inv_dir.to_array().map(|x| x >= 0.0),
        }
    }

    /// The twin of [`intersect_aabb`](crate::intersect_aabb) for four boxes: a bit for each box that is met, and
    /// the entry parameters.
    #[inline]
    pub(super) fn meet(&self, node: &Node, t: Interval) -> (u32, [f32; 4]) {
        const ULPS: f32 = 2.0 * f32::EPSILON;
        let mut t_near = Vec4::NEG_INFINITY;
        let mut t_far = Vec4::INFINITY;
        for i in 0..3 {
            let (near, far) = if self.forward[i] {
                (node.min[i], node.max[i])
            } else {
                (node.max[i], node.min[i])
            };
            let near = (near - self.origin[i]) * self.inv_dir[i];
            let far = (far - self.origin[i]) * self.inv_dir[i];
            // The comparison fails for NaN, which leaves the running interval as it is.
            t_near = Vec4::select(near.cmpgt(t_near), near, t_near);
            t_far = Vec4::select(far.cmplt(t_far), far, t_far);
        }
        let (min, max) = (Vec4::splat(t.min), Vec4::splat(t.max));
        let t_near = t_near * (1.0 - ULPS);
        let t_near = Vec4::select(t_near.cmpgt(min), t_near, min);
        let t_far = t_far * (1.0 + ULPS);
        let t_far = Vec4::select(t_far.cmplt(max), t_far, max);
        (t_near.cmple(t_far).bitmask(), t_near.to_array())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::tests::{random, random_boxes, random_ray};
    use crate::intersect_aabb;

    /// The node's test of four boxes is the slide, to the bit.
    #[test]
    fn meet_equals_the_slide() {
        let mut next = random();
        for _ in 0..2000 {
            let mut boxes = random_boxes(4, &mut next);
            let ray = random_ray(&mut next);
            // An origin in the plane of a face, where 0·∞ arises.
            boxes[0].min.x = ray.origin.x;
            let members: Vec<BinaryNode> = boxes
                .iter()
                .map(|&aabb| BinaryNode {
                    aabb,
                    first: 0,
                    count: 1,
                })
                .collect();
            let mut node = Node::EMPTY;
            for (place, member) in members.iter().enumerate() {
                node.set(place, member);
            }
            let (hits, t_near) = Slabs::new(&ray).meet(&node, ray.t);
            for (i, aabb) in boxes.iter().enumerate() {
                let expected = intersect_aabb(&ray, ray.dir.recip(), aabb);
                assert_eq!(hits >> i & 1 == 1, expected.is_some());
                if let Some((t, _)) = expected {
                    assert_eq!(t.to_bits(), t_near[i].to_bits());
                }
            }
        }
    }
}
