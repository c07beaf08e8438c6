//! Axis-aligned bounding boxes and the slab test.

use crate::Ray;
use glam::{Affine3A, DVec3, Vec3};

/// A closed axis-aligned box; empty when `min > max` in any component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Least corner.
    pub min: Vec3,
    /// Greatest corner.
    pub max: Vec3,
}

impl Aabb {
    /// The box that holds nothing: the neutral element of [`Aabb::union`].
    pub const EMPTY: Self = Self {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    /// The least box that holds all points; empty for none. NaN points are ignored.
    pub fn from_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::including)
    }

    /// This box grown to hold `point`.
    #[inline]
    pub fn including(self, point: Vec3) -> Self {
        self.union(Self {
            min: point,
            max: point,
        })
    }

    /// The least box that holds both. NaN bounds in `other` are ignored.
    #[inline]
    pub fn union(self, other: Self) -> Self {
        // The comparisons are false for NaN, and the select keeps what was there.
        Self {
            min: Vec3::select(other.min.cmplt(self.min), other.min, self.min),
            max: Vec3::select(other.max.cmpgt(self.max), other.max, self.max),
        }
    }

    /// The box from `center − reach` to `center + reach`, rounded outwards by an f32 ulp on either side.
    pub(crate) fn from_reach(center: DVec3, reach: DVec3) -> Self {
        // Covers the few f64 roundings in `center` and `reach`, where the sum cancels.
        let reach = reach + (center.abs() + reach) * (8.0 * f64::EPSILON);
        let (min, max) = ((center - reach).as_vec3(), (center + reach).as_vec3());
        Self {
            min: Vec3::new(min.x.next_down(), min.y.next_down(), min.z.next_down()),
            max: Vec3::new(max.x.next_up(), max.y.next_up(), max.z.next_up()),
        }
    }

    /// Tells whether the box holds no point.
    pub fn is_empty(self) -> bool {
        !(self.min.cmple(self.max).all())
    }

    /// Middle of the box.
    #[inline]
    pub fn center(self) -> Vec3 {
        0.5 * self.min + 0.5 * self.max
    }

    /// Edge lengths; negative for an empty box.
    #[inline]
    pub fn extent(self) -> Vec3 {
        self.max - self.min
    }

    /// Half of the surface area, the measure of the surface area heuristic; 0 for an empty box.
    #[inline]
    pub fn half_area(self) -> f32 {
        if self.is_empty() {
            return 0.0;
        }
        let e = self.extent();
        e.x * e.y + e.y * e.z + e.z * e.x
    }

    /// The box of the transformed box, widened by the rounding of the transform.
    ///
    /// Source: Arvo, "Transforming Axis-Aligned Bounding Boxes", Graphics Gems, 1990.
    pub fn transformed(self, transform: &Affine3A) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let center = transform.transform_point3(self.center());
        let half = 0.5 * self.extent();
        let m = transform.matrix3;
        let reach_of = |v: Vec3| {
            Vec3::from(m.x_axis).abs() * v.x
                + Vec3::from(m.y_axis).abs() * v.y
                + Vec3::from(m.z_axis).abs() * v.z
        };
        let reach = reach_of(half);
        // Up to eight roundings of half an ulp, each relative to the terms before they cancel.
        let terms = reach_of(self.center().abs() + half) + Vec3::from(transform.translation).abs();
        let slack = terms * (8.0 * f32::EPSILON);
        Self {
            min: center - reach - slack,
            max: center + reach + slack,
        }
    }
}

/// Intersects a ray with a box; gives the entry and exit parameters, clipped to the ray's interval.
///
/// The box is the intersection of three slabs; a ray is inside slab `i` for
/// ```text
/// t ∈ [ (min_i − o_i)/d_i , (max_i − o_i)/d_i ]      (ends swapped for d_i < 0)
/// ```
/// and inside the box where all three intervals and the ray's own overlap. `inv_dir` is
/// `1 / ray.dir`, computed once for many boxes.
///
/// Rounding never turns a hit into a miss, for rays with `t.min ≥ 0`, where no product underflows and no direction is longer than 2¹²⁶: an end has three roundings, and its
/// widening by 2 ulp = 4u = 4·2⁻²⁴ (itself rounded) covers all four, `(1 + u)⁴ ≤ 1 + 4u` short of u².
/// So every f32 `t` at which the exact ray is in the box lies between the two results.
///
/// A ray parallel to a slab divides by zero: ±∞ give the right answer, and the `0·∞ = NaN` of an
/// origin in the slab's very face is dropped by the order of the comparisons (the slab then counts
/// as entered). Negative zero directions are covered. Components below 2⁻¹²⁸, whose reciprocal
/// overflows, count as zero.
///
/// Source: Kay & Kajiya, "Ray Tracing Complex Scenes", SIGGRAPH 1986; the widening: Ize, "Robust BVH
/// Ray Traversal", Journal of Computer Graphics Techniques 2(2), 2013.
#[inline]
pub fn intersect_aabb(ray: &Ray, inv_dir: Vec3, aabb: &Aabb) -> Option<(f32, f32)> {
    const ULPS: f32 = 2.0 * f32::EPSILON;
    let t_a = (aabb.min - ray.origin) * inv_dir;
    let t_b = (aabb.max - ray.origin) * inv_dir;
    let mut t_near = f32::NEG_INFINITY;
    let mut t_far = f32::INFINITY;
    for i in 0..3 {
        let (near, far) = if inv_dir[i] >= 0.0 {
            (t_a[i], t_b[i])
        } else {
            (t_b[i], t_a[i])
        };
        // Comparisons with NaN are false: a NaN leaves the running interval as it is.
        t_near = if near > t_near { near } else { t_near };
        t_far = if far < t_far { far } else { t_far };
    }
    let t_near = (t_near * (1.0 - ULPS)).max(ray.t.min);
    let t_far = (t_far * (1.0 + ULPS)).min(ray.t.max);
    (t_near <= t_far).then_some((t_near, t_far))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entry_and_exit_of_a_known_box() {
        let b = Aabb {
            min: Vec3::NEG_ONE,
            max: Vec3::ONE,
        };
        let ray = Ray::new(Vec3::new(-3.0, 0.0, 0.0), Vec3::X);
        let (near, far) = intersect_aabb(&ray, ray.dir.recip(), &b).expect("through the middle");
        assert!(near <= 2.0 && near > 1.999_999 && (4.0..4.000_002).contains(&far));
        let beside = Ray::new(Vec3::new(-3.0, 1.000_000_1, 0.0), Vec3::X);
        assert!(intersect_aabb(&beside, beside.dir.recip(), &b).is_none());
        let behind = Ray::new(Vec3::new(3.0, 0.0, 0.0), Vec3::X);
        assert!(intersect_aabb(&behind, behind.dir.recip(), &b).is_none());
        assert_eq!(b.half_area(), 12.0);
    }

    #[test]
    fn reach_is_rounded_outwards() {
        let b = Aabb::from_reach(DVec3::splat(0.1), DVec3::splat(0.2));
        assert!(f64::from(b.max.x) > 0.1 + 0.2 && f64::from(b.min.x) < 0.1 - 0.2);
    }
}
