//! A ray prepared for boxes: the test against the sixteen boxes of a node.

use crate::bvh::Node;
use crate::{Aabb, Ray};
use fearless_simd::{Simd, f32x16, prelude::*};
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
pub(crate) struct BoxRay<S: Simd> {
    near: [Planes<S>; 3],
    far: [Planes<S>; 3],
    t_min: f32x16<S>,
}

/// The planes on one side of the boxes along one axis.
struct Planes<S: Simd> {
    scale: f32x16<S>,
    shift: f32x16<S>,
    /// Which of a node's bounds they are.
    bounds: usize,
}

/// Half of an ulp of 1.
pub(super) const U: f32 = f32::EPSILON / 2.0;

impl<S: Simd> BoxRay<S> {
    /// The constants for a tree with these bounds. The ray must be finite, with a direction that is not zero.
    #[inline(always)]
    pub(crate) fn new(simd: S, ray: &Ray, bounds: Aabb) -> Self {
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
        let (first, last) = (ray.origin + pad, ray.origin - pad);
        let (near_shift, far_shift) = (first * near, last * far);
        Self {
            near: [
                Planes::near(simd, near.x, near_shift.x, 0),
                Planes::near(simd, near.y, near_shift.y, 1),
                Planes::near(simd, near.z, near_shift.z, 2),
            ],
            far: [
                Planes::far(simd, far.x, far_shift.x, 0),
                Planes::far(simd, far.y, far_shift.y, 1),
                Planes::far(simd, far.z, far_shift.z, 2),
            ],
            t_min: f32x16::splat(simd, ray.t.min),
        }
    }

    /// The twin of [`intersect_aabb`](crate::intersect_aabb) for a node's boxes: a bit for each that is met before `t_max`,
    /// and the parameters of entry.
    #[inline(always)]
    pub(crate) fn meet(&self, simd: S, node: &Node, t_max: f32x16<S>) -> (u32, f32x16<S>) {
        let [x, y, z] = &self.near;
        let t_near = x.meet(simd, node).max(y.meet(simd, node));
        let t_near = t_near.max(z.meet(simd, node).max(self.t_min));
        let [x, y, z] = &self.far;
        let t_far = x.meet(simd, node).min(y.meet(simd, node));
        let t_far = t_far.min(z.meet(simd, node).min(t_max));
        (t_near.simd_le(t_far).to_bitmask() as u32, t_near)
    }
}

impl<S: Simd> Planes<S> {
    #[inline(always)]
    fn near(simd: S, scale: f32, shift: f32, axis: usize) -> Self {
        let bounds = if scale.is_sign_negative() { axis + 3 } else { axis };
        Self::new(simd, scale, shift, bounds, f32::INFINITY)
    }

    #[inline(always)]
    fn far(simd: S, scale: f32, shift: f32, axis: usize) -> Self {
        let bounds = if scale.is_sign_negative() { axis } else { axis + 3 };
        Self::new(simd, scale, shift, bounds, f32::NEG_INFINITY)
    }

    #[inline(always)]
    fn new(simd: S, scale: f32, shift: f32, bounds: usize, inside: f32) -> Self {
        let sound = scale.is_finite() && shift.is_finite();
        let (scale, shift) = if sound { (scale, shift) } else { (0.0, inside) };
        Self {
            scale: f32x16::splat(simd, scale),
            shift: f32x16::splat(simd, shift),
            bounds,
        }
    }

    #[inline(always)]
    fn meet(&self, simd: S, node: &Node) -> f32x16<S> {
        f32x16::<S>::simd_from(simd, node.bounds[self.bounds]).mul_sub(self.scale, self.shift)
    }
}
