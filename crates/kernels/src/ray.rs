//! Rays and the intervals of their parameter `t`.

use glam::{Affine3A, Vec3};

/// The part `(min, max]` of a ray that may be hit.
///
/// The lower end is excluded, so that a ray that starts on a surface with `min = 0`
/// does not hit the point it starts from; the upper end belongs to the interval.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Interval {
    /// Excluded lower end, 0 or greater.
    pub min: f32,
    /// Included upper end; may be infinite.
    pub max: f32,
}

impl Interval {
    /// Everything in front of the origin: `(0, ∞)`.
    pub const POSITIVE: Self = Self {
        min: 0.0,
        max: f32::INFINITY,
    };

    /// Tells whether `min < t ≤ max` and `t` is finite: NaN and ±∞ are in no interval.
    #[inline]
    pub fn contains(self, t: f32) -> bool {
        self.min < t && t <= self.max && t < f32::INFINITY
    }
}

/// The half-line `origin + t·dir` for `t` in an [`Interval`].
///
/// `dir` need not be of unit length; `t` counts in units of `|dir|`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Ray {
    /// Start, at `t = 0`.
    pub origin: Vec3,
    /// Direction, of any length but zero.
    pub dir: Vec3,
    /// The part of the ray that may be hit.
    pub t: Interval,
}

impl Ray {
    /// The ray from `origin` along `dir` over `t` in `(0, ∞)`.
    #[inline]
    pub fn new(origin: Vec3, dir: Vec3) -> Self {
        Self {
            origin,
            dir,
            t: Interval::POSITIVE,
        }
    }

    /// The point `origin + t·dir`.
    #[inline]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + t * self.dir
    }

    /// The same ray in another space; `t` keeps its meaning, since `dir` is not normalised.
    #[inline]
    pub fn transformed(&self, transform: &Affine3A) -> Self {
        Self {
            origin: transform.transform_point3(self.origin),
            dir: transform.transform_vector3(self.dir),
            t: self.t,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_exclude_min_and_include_max() {
        let t = Interval { min: 1.0, max: 2.0 };
        assert!(!t.contains(1.0) && t.contains(1.0_f32.next_up()));
        assert!(t.contains(2.0) && !t.contains(2.0_f32.next_up()));
        assert!(!t.contains(f32::NAN));
        assert!(!Interval::POSITIVE.contains(0.0) && !Interval::POSITIVE.contains(-0.0));
        assert!(
            Interval::POSITIVE.contains(f32::MAX) && !Interval::POSITIVE.contains(f32::INFINITY)
        );
    }

    #[test]
    fn t_keeps_its_meaning_in_another_space() {
        let ray = Ray::new(Vec3::X, Vec3::NEG_Z);
        let transform = Affine3A::from_scale(Vec3::new(2.0, 3.0, 4.0));
        let moved = ray.transformed(&transform);
        assert_eq!(moved.at(0.5), transform.transform_point3(ray.at(0.5)));
        assert_eq!(moved.t, ray.t);
    }
}
