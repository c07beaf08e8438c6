//! Rays and the intervals of their parameter `t`.

use glam::{Affine3A, Vec3};

/// The part `(min, max]` of a ray that may be hit.
///
/// The lower end is excluded, so that a ray that starts on a surface with `min = 0`
/// does not hit the point it starts from; the upper end belongs to the interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Excluded lower end.
    pub min: f32,
    /// Included upper end; may be infinite.
    pub max: f32,
}

impl Interval {
    /// Everything in front of the origin: `(0, ∞]`.
    pub const POSITIVE: Self = Self {
        min: 0.0,
        max: f32::INFINITY,
    };

    /// Tells whether `min < t ≤ max`. NaN is in no interval.
    #[inline]
    pub fn contains(self, t: f32) -> bool {
        self.min < t && t <= self.max
    }
}

/// The half-line `origin + t·dir` for `t` in an [`Interval`].
///
/// `dir` need not be of unit length; `t` counts in units of `|dir|`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Start, at `t = 0`.
    pub origin: Vec3,
    /// Direction, of any length but zero.
    pub dir: Vec3,
    /// The part of the ray that may be hit.
    pub t: Interval,
}

impl Ray {
    /// The ray from `origin` along `dir` over `t` in `(0, ∞]`.
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
