//! The part of a ray within the bounds of a surface, and the function along it.

use super::root::Line;
use super::{Interval64, Scratch, Tape};
use crate::Ray;
use glam::DVec3;

/// A part of a ray, with `t` counted from its point nearest to the middle of a box.
///
/// So coordinates stay of the box's size: what a far origin costs is one rounding of `origin + shift·dir`, in f64.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    /// The ray's point at `t = shift`.
    origin: DVec3,
    dir: DVec3,
    shift: f64,
    /// Where it begins and ends, counted from `shift`.
    pub(super) t: Interval64,
}

impl Segment {
    /// The part of the ray within a box, if any. Its ends are an f32 ulp beyond those of the ray's interval: roots that round into
    /// it belong to it.
    ///
    /// Source: Kay & Kajiya, "Ray Tracing Complex Scenes", SIGGRAPH 1986.
    pub(super) fn new(ray: &Ray, min: DVec3, max: DVec3) -> Option<Self> {
        let (o, d) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
        let inverse = d.recip();
        let (a, b) = ((min - o) * inverse, (max - o) * inverse);
        let mut t = Interval64 {
            lo: f64::from(ray.t.min.next_down()).max(0.0),
            hi: f64::from(ray.t.max.next_up()),
        };
        for i in 0..3 {
            // A ray along the slab: within it from −∞ to ∞, or, in one of its walls, NaN, which counts as inside.
            if (a[i] + b[i]).is_nan() {
                continue;
            }
            t.lo = t.lo.max(a[i].min(b[i]));
            t.hi = t.hi.min(a[i].max(b[i]));
        }
        // False for NaN, too.
        if !(t.lo <= t.hi && t.hi < f64::INFINITY && o.is_finite()) {
            return None;
        }
        let center = 0.5 * (min + max);
        let shift = ((center - o).dot(d) / d.length_squared()).clamp(t.lo, t.hi);
        let t = Interval64 {
            lo: t.lo - shift,
            hi: t.hi - shift,
        };
        let origin = o + shift * d;
        (t.lo <= t.hi && origin.is_finite()).then_some(Self {
            origin,
            dir: d,
            shift,
            t,
        })
    }

    /// The point at `t`, counted from the shift.
    #[inline]
    pub(super) fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.dir
    }

    /// The ray's own parameter.
    #[inline]
    pub(super) fn ray_t(&self, t: f64) -> f32 {
        (self.shift + t) as f32
    }

    /// The parts of `t` that the length `length` takes.
    pub(super) fn duration(&self, length: f64) -> f64 {
        length / self.dir.length()
    }

    pub(super) fn origin(&self) -> DVec3 {
        self.origin
    }

    pub(super) fn dir(&self) -> DVec3 {
        self.dir
    }
}

/// A function along a part of a ray.
pub(super) struct TapeLine<'a> {
    pub(super) tape: &'a Tape,
    pub(super) segment: Segment,
    pub(super) scratch: &'a mut Scratch,
}

impl Line for TapeLine<'_> {
    fn bounds(&mut self, t: Interval64) -> (Interval64, Interval64) {
        let Segment { origin, dir, .. } = self.segment;
        self.tape.along(origin, dir, t, self.scratch)
    }

    fn at(&mut self, t: f64) -> (f64, f64) {
        let (f, gradient) = self.tape.gradient(self.segment.at(t));
        (f, gradient.dot(self.segment.dir))
    }
}
