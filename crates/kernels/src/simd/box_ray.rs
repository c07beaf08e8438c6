//! A ray prepared for boxes: the test against the sixteen boxes of a node.

use crate::bvh::{Child, Node, WIDTH};
use fearless_simd::{Simd, f32x16, mask32x16, prelude::*, u32x16};

/// A ray as the slab test wants it: `t = plane·scale − shift`, apart for the near and the far planes, with all
/// that rounding may do moved into the constants.
///
/// With the unit roundoff `u = 2⁻²⁴`, the greatest distances `X_i` of the tree's box from the origin along each axis, and
/// `Z` that along the longest component of the direction, the planes are moved outwards by
/// ```text
/// pad_i = 8u (X_i + |o_i|) + 112u Z
/// ```
/// which covers the 5u (X_i + Z) by which the shear of the watertight test moves corners, the 96u Z by which its edge functions
/// move the hit, and, 3u (X_i + |o_i|) at most, the rounding of the origin moved by the pad, of `shift`, and of `plane·scale` where the vector unit does not fuse.
/// The factors `1 ∓ 4u` in `scale` cover the rounding of the reciprocal, of `t` and of the hit's own `t`. So the box of every
/// triangle that the watertight test reports at `t` is entered at or before `t` and left at or after it, and no ray slips
/// between boxes.
///
/// Components shorter than `2⁻⁴⁰` of the longest count as that long: over the length of the tree the ray moves by less than
/// the pad. A ray whose constants overflow, by the coordinates of the tree, meets all boxes.
///
/// This holds for hits at `t > 0` and for `max |dᵢ| ≤ 2¹²⁶`, whose reciprocals are not subnormal.
///
/// Source: Woop, Benthin & Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, section 3.4 (the moved origins);
/// Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BoxRay {
    pub(super) near: [Slab; 3],
    pub(super) far: [Slab; 3],
    /// Where the near planes are among a node's bounds: 0 for the least, 3 for the greatest.
    pub(super) first: [u32; 3],
    pub(super) t_min: f32,
    /// The constants are out of range: all boxes count as met.
    pub(super) everywhere: bool,
}

/// The planes on one side along one axis.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slab {
    pub(super) scale: f32,
    pub(super) shift: f32,
}

/// Half of an ulp of 1.
pub(super) const U: f32 = f32::EPSILON / 2.0;

impl BoxRay {
    /// The twin of [`intersect_aabb`](crate::intersect_aabb) for a node's boxes: which are met before `t_max`,
    /// and the parameters of entry.
    #[inline(always)]
    pub(crate) fn meet<S: Simd>(
        &self,
        simd: S,
        node: &Node,
        t_max: f32,
    ) -> (mask32x16<S>, f32x16<S>) {
        if self.everywhere {
            let children = u32x16::simd_from(simd, node.children.map(|child| child.0));
            let nothing = u32x16::splat(simd, Child::NOTHING.0);
            return (!children.simd_eq(nothing), f32x16::splat(simd, self.t_min));
        }
        let t_near = self.near(simd, node, 0).max(self.near(simd, node, 1));
        let t_min = f32x16::splat(simd, self.t_min);
        let t_near = t_near.max(self.near(simd, node, 2).max(t_min));
        let t_far = self.far(simd, node, 0).min(self.far(simd, node, 1));
        let t_max = f32x16::splat(simd, t_max);
        let t_far = t_far.min(self.far(simd, node, 2).min(t_max));
        (t_near.simd_le(t_far), t_near)
    }

    #[inline(always)]
    fn near<S: Simd>(&self, simd: S, node: &Node, axis: usize) -> f32x16<S> {
        let planes = &node.bounds[axis + (self.first[axis] & 3) as usize];
        self.near[axis].meet(simd, planes)
    }

    #[inline(always)]
    fn far<S: Simd>(&self, simd: S, node: &Node, axis: usize) -> f32x16<S> {
        let planes = &node.bounds[axis + (self.first[axis] & 3 ^ 3) as usize];
        self.far[axis].meet(simd, planes)
    }
}

impl Slab {
    #[inline(always)]
    fn meet<S: Simd>(&self, simd: S, planes: &[f32; WIDTH]) -> f32x16<S> {
        f32x16::<S>::simd_from(simd, *planes).mul_sub(
            f32x16::splat(simd, self.scale),
            f32x16::splat(simd, self.shift),
        )
    }
}
