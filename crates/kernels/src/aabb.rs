//! Axis-aligned bounding boxes and the slab test.

use crate::Ray;
use glam::{Affine3A, Vec3};

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
        Self {
            min: self.min.min(point),
            max: self.max.max(point),
        }
    }

    /// The least box that holds both.
    #[inline]
    pub fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
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
        let reach = Vec3::from(m.x_axis).abs() * half.x
            + Vec3::from(m.y_axis).abs() * half.y
            + Vec3::from(m.z_axis).abs() * half.z;
        // Four rounded products and sums a component: 8 ulp is a safe bound of their error.
        let slack = (center.abs() + Vec3::from(transform.translation).abs() + reach) * (8.0 * f32::EPSILON);
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
/// `1 / ray.dir`, computed once for many boxes. The exit is enlarged by 2 ulp, so that rounding
/// never turns a hit into a miss: the test is conservative.
///
/// A ray parallel to a slab divides by zero: ±∞ give the right answer, and the `0·∞ = NaN` of an
/// origin in the slab's very face is dropped by the order of the comparisons (the slab then counts
/// as entered). Negative zero directions are covered.
///
/// Source: Kay & Kajiya, "Ray Tracing Complex Scenes", SIGGRAPH 1986; the 2 ulp: Ize, "Robust BVH
/// Ray Traversal", Journal of Computer Graphics Techniques 2(2), 2013.
#[inline]
pub fn intersect_aabb(ray: &Ray, inv_dir: Vec3, aabb: &Aabb) -> Option<(f32, f32)> {
    let t_a = (aabb.min - ray.origin) * inv_dir;
    let t_b = (aabb.max - ray.origin) * inv_dir;
    let mut t_near = ray.t.min;
    let mut t_far = ray.t.max;
    for i in 0..3 {
        let (near, far) = if inv_dir[i] >= 0.0 {
            (t_a[i], t_b[i])
        } else {
            (t_b[i], t_a[i])
        };
        let far = far * (1.0 + 2.0 * f32::EPSILON);
        // Comparisons with NaN are false: a NaN leaves the running interval as it is.
        t_near = if near > t_near { near } else { t_near };
        t_far = if far < t_far { far } else { t_far };
    }
    (t_near <= t_far).then_some((t_near, t_far))
}
