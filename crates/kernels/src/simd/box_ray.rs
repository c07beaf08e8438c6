//! A ray prepared for boxes: the test against the sixteen boxes of a node.

use crate::bvh::{Node, WIDTH};
use crate::{Aabb, Ray};
use fearless_simd::{Simd, f32x16, prelude::*};

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
    near: [Axis<S>; 3],
    far: [Axis<S>; 3],
    /// Which of the node's bounds are met first and last.
    near_bounds: [usize; 3],
    far_bounds: [usize; 3],
    t_min: f32x16<S>,
}

#[derive(Clone, Copy)]
struct Axis<S: Simd> {
    scale: f32x16<S>,
    shift: f32x16<S>,
}

/// Half of an ulp of 1.
pub(super) const U: f32 = f32::EPSILON / 2.0;

impl<S: Simd> BoxRay<S> {
    /// The constants for a tree with these bounds. The ray must be finite, with a direction that is not zero.
    #[inline(always)]
    pub(crate) fn new(simd: S, ray: &Ray, bounds: Aabb) -> Self {
        let longest = ray.dir.abs().max_element();
        let reach = (bounds.min - ray.origin)
            .abs()
            .max((bounds.max - ray.origin).abs());
        let z = reach[ray.dir.abs().max_position()];
        let pad = (reach + ray.origin.abs()) * (8.0 * U) + z * (112.0 * U);
        let least = longest * 2.0_f32.powi(-40);
        let axis = |i: usize, pad: f32, widen: f32| {
            let d = ray.dir[i];
            let d = if d.abs() < least { least.copysign(d) } else { d };
            let scale = (1.0 / d) * widen;
            let shift = (ray.origin[i] + pad.copysign(d) * (1.0 - widen).signum()) * scale;
            if shift.is_finite() && scale.is_finite() {
                (scale, shift)
            } else {
                (0.0, f32::INFINITY * (1.0 - widen))
            }
        };
        let wide = |(scale, shift): (f32, f32)| Axis {
            scale: f32x16::splat(simd, scale),
            shift: f32x16::splat(simd, shift),
        };
        let backward = ray.dir.to_array().map(|d| d.is_sign_negative());
        Self {
            near: [0, 1, 2].map(|i| wide(axis(i, pad[i], 1.0 - 4.0 * U))),
            far: [0, 1, 2].map(|i| wide(axis(i, pad[i], 1.0 + 4.0 * U))),
            near_bounds: [0, 1, 2].map(|i| if backward[i] { i + 3 } else { i }),
            far_bounds: [0, 1, 2].map(|i| if backward[i] { i } else { i + 3 }),
            t_min: f32x16::splat(simd, ray.t.min),
        }
    }

    /// The twin of [`intersect_aabb`](crate::intersect_aabb) for a node's boxes: a bit for each that is met before `t_max`,
    /// and the parameters of entry.
    #[inline(always)]
    pub(crate) fn meet(&self, simd: S, node: &Node, t_max: f32x16<S>) -> (u32, f32x16<S>) {
        let plane = |axis: &Axis<S>, bounds: usize| {
            f32x16::<S>::simd_from(simd, node.bounds[bounds]).mul_sub(axis.scale, axis.shift)
        };
        let near = |i: usize| plane(&self.near[i], self.near_bounds[i]);
        let far = |i: usize| plane(&self.far[i], self.far_bounds[i]);
        let t_near = near(0).max(near(1)).max(near(2).max(self.t_min));
        let t_far = far(0).min(far(1)).min(far(2).min(t_max));
        (t_near.simd_le(t_far).to_bitmask() as u32, t_near)
    }
}

const _: () = assert!(WIDTH == 16);
