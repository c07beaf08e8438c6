//! A ray prepared for boxes: the test against the sixteen boxes of a node.

use crate::bvh::{Node, WIDTH};
use crate::{Aabb, Ray};
use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};
use glam::Vec3;

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
/// the pad. An axis whose constants overflow counts as always inside.
///
/// Source: Woop, Benthin & Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, section 3.4 (the moved origins);
/// Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BoxRay {
    near: [Slab; 3],
    far: [Slab; 3],
    /// Where the near planes are among a node's bounds: 0 for the least, 3 for the greatest.
    first: [u32; 3],
    t_min: f32,
}

/// The planes on one side along one axis.
#[derive(Clone, Copy, Debug, Default)]
struct Slab {
    scale: f32,
    shift: f32,
}

/// Half of an ulp of 1.
pub(super) const U: f32 = f32::EPSILON / 2.0;

impl BoxRay {
    /// The constants for a tree with these bounds. The ray must be finite, with a direction that is not zero.
    #[inline(always)]
    pub(crate) fn new(ray: &Ray, bounds: Aabb) -> Self {
        let length = ray.dir.abs();
        let reach = (bounds.min - ray.origin)
            .abs()
            .max((bounds.max - ray.origin).abs());
        let z = reach[length.max_position()];
        let pad = (reach + ray.origin.abs()) * (8.0 * U) + z * (112.0 * U);
        let least = Vec3::splat(length.max_element() * 2.0_f32.powi(-40));
        let dir = Vec3::select(length.cmplt(least), least.copysign(ray.dir), ray.dir);
        let pad = pad.copysign(dir);
        let inv = dir.recip();
        let (near, far) = (inv * (1.0 - 4.0 * U), inv * (1.0 + 4.0 * U));
        let near_shift = (ray.origin + pad) * near;
        let far_shift = (ray.origin - pad) * far;
        let (entry, exit) = (f32::INFINITY, f32::NEG_INFINITY);
        Self {
            near: [
                Slab::new(near.x, near_shift.x, entry),
                Slab::new(near.y, near_shift.y, entry),
                Slab::new(near.z, near_shift.z, entry),
            ],
            far: [
                Slab::new(far.x, far_shift.x, exit),
                Slab::new(far.y, far_shift.y, exit),
                Slab::new(far.z, far_shift.z, exit),
            ],
            first: [
                3 * u32::from(dir.x.is_sign_negative()),
                3 * u32::from(dir.y.is_sign_negative()),
                3 * u32::from(dir.z.is_sign_negative()),
            ],
            t_min: ray.t.min,
        }
    }

    /// The twin of [`intersect_aabb`](crate::intersect_aabb) for a node's boxes: which are met before `t_max`,
    /// and the parameters of entry.
    #[inline(always)]
    pub(crate) fn meet<S: Simd>(
        &self,
        simd: S,
        node: &Node,
        t_max: f32,
    ) -> (mask32x16<S>, f32x16<S>) {
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
    /// Constants that overflow give way to those of a ray that is always `inside`.
    #[inline(always)]
    fn new(scale: f32, shift: f32, inside: f32) -> Self {
        if scale.is_finite() && shift.is_finite() {
            Self { scale, shift }
        } else {
            Self {
                scale: 0.0,
                shift: inside,
            }
        }
    }

    #[inline(always)]
    fn meet<S: Simd>(&self, simd: S, planes: &[f32; WIDTH]) -> f32x16<S> {
        f32x16::<S>::simd_from(simd, *planes).mul_sub(
            f32x16::splat(simd, self.scale),
            f32x16::splat(simd, self.shift),
        )
    }
}
