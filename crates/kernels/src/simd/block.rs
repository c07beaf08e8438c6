//! Blocks of rays, component by component, and the twins that test them against one surface.

use crate::{Cuboid, Plane, Ray, Rectangle, Sphere};
use glam::{Affine3A, DVec3, Vec3};

/// Rays in a block.
pub(super) const BLOCK: usize = 64;

/// A block of rays.
pub(super) struct RayBlock {
    origin: [[f32; BLOCK]; 3],
    dir: [[f32; BLOCK]; 3],
    /// Excluded lower ends of the intervals.
    pub(super) t_min: [f32; BLOCK],
    /// Included upper ends, lowered as hits are found.
    pub(super) t_max: [f32; BLOCK],
}

/// Ray parameters of a block; `∞` for a miss.
pub(super) type Distances = [f32; BLOCK];

impl RayBlock {
    /// Fills the block with at most [`BLOCK`] rays; unused lanes hit nothing.
    #[inline(always)]
    pub(super) fn new(rays: &[Ray]) -> Self {
        let mut block = Self {
            origin: [[0.0; BLOCK]; 3],
            dir: [[0.0; BLOCK]; 3],
            t_min: [f32::INFINITY; BLOCK],
            t_max: [0.0; BLOCK],
        };
        for (i, ray) in rays.iter().enumerate() {
            for axis in 0..3 {
                block.origin[axis][i] = ray.origin[axis];
                block.dir[axis][i] = ray.dir[axis];
            }
            block.t_min[i] = ray.t.min;
            block.t_max[i] = ray.t.max;
        }
        block
    }

    /// The rays in another space; as [`Ray::transformed`], to the bit.
    #[inline(always)]
    pub(super) fn transformed(&self, transform: &Affine3A) -> Self {
        let [x, y, z] = [
            transform.matrix3.x_axis,
            transform.matrix3.y_axis,
            transform.matrix3.z_axis,
        ]
        .map(Vec3::from);
        let moved = Vec3::from(transform.translation);
        let mut block = Self {
            origin: [[0.0; BLOCK]; 3],
            dir: [[0.0; BLOCK]; 3],
            t_min: self.t_min,
            t_max: self.t_max,
        };
        for axis in 0..3 {
            for i in 0..BLOCK {
                let linear = |v: &[[f32; BLOCK]; 3]| {
                    x[axis] * v[0][i] + y[axis] * v[1][i] + z[axis] * v[2][i]
                };
                block.origin[axis][i] = linear(&self.origin) + moved[axis];
                block.dir[axis][i] = linear(&self.dir);
            }
        }
        block
    }

    /// Origin and direction of a lane in f64, the precision of the slides of analytic surfaces.
    #[inline(always)]
    fn lane(&self, i: usize) -> (DVec3, DVec3) {
        let wide = |v: &[[f32; BLOCK]; 3]| {
            DVec3::new(f64::from(v[0][i]), f64::from(v[1][i]), f64::from(v[2][i]))
        };
        (wide(&self.origin), wide(&self.dir))
    }

    /// [`Interval::contains`](crate::Interval::contains) of a lane.
    #[inline(always)]
    fn contains(&self, i: usize, t: f32) -> bool {
        (self.t_min[i] < t) & (t <= self.t_max[i]) & (t < f32::INFINITY)
    }

    /// `t` where the lane contains it and `hit` is true, `∞` elsewhere.
    #[inline(always)]
    fn accept(&self, i: usize, hit: bool, t: f32) -> f32 {
        if hit & self.contains(i, t) {
            t
        } else {
            f32::INFINITY
        }
    }
}

/// [`intersect_sphere`](crate::intersect_sphere) for a block.
#[inline(always)]
pub(super) fn intersect_sphere_block(rays: &RayBlock, sphere: &Sphere, t: &mut Distances) {
    let center = sphere.center.as_dvec3();
    let r = f64::from(sphere.radius);
    let (mut a, mut b, mut c) = ([0.0; BLOCK], [0.0; BLOCK], [0.0; BLOCK]);
    let mut delta = [0.0; BLOCK];
    let mut any = false;
    for i in 0..BLOCK {
        let (o, d) = rays.lane(i);
        let f = o - center;
        a[i] = d.dot(d);
        b[i] = f.dot(d);
        c[i] = f.dot(f) - r * r;
        // Negative for a miss.
        delta[i] = if (c[i] > 0.0) & (b[i] > 0.0) {
            -1.0
        } else {
            a[i] * (r * r) - f.cross(d).length_squared()
        };
        any |= delta[i] >= 0.0;
    }
    // Rays of a block often go the same way, and all past the sphere.
    if !any {
        *t = [f32::INFINITY; BLOCK];
        return;
    }
    for (i, t) in t.iter_mut().enumerate() {
        let q = -b[i] - delta[i].sqrt().copysign(b[i]);
        let (t1, t2) = (q / a[i], c[i] / q);
        let (near, far) = (t1.min(t2) as f32, t1.max(t2) as f32);
        let nearest = if rays.contains(i, near) { near } else { far };
        *t = rays.accept(i, delta[i] >= 0.0, nearest);
    }
}

/// [`intersect_plane`](crate::intersect_plane) for a block.
#[inline(always)]
pub(super) fn intersect_plane_block(rays: &RayBlock, plane: &Plane, t: &mut Distances) {
    let point = plane.point.as_dvec3();
    let n = plane.normal.as_dvec3();
    for (i, t) in t.iter_mut().enumerate() {
        let (o, d) = rays.lane(i);
        let denominator = d.dot(n);
        let hit = (denominator != 0.0) & (denominator.abs() < f64::INFINITY);
        *t = rays.accept(i, hit, ((point - o).dot(n) / denominator) as f32);
    }
}

/// Whether any ray of a block crosses the plane of a rectangle in its interval, or nearly does. Without divisions: shadow rays in a room
/// end before most of its walls.
#[inline(always)]
pub(super) fn may_cross_rectangle(rays: &RayBlock, rectangle: &Rectangle) -> bool {
    let center = rectangle.center.as_dvec3();
    let n = rectangle.u.as_dvec3().cross(rectangle.v.as_dvec3());
    let mut any = 0;
    for i in 0..BLOCK {
        let (o, d) = rays.lane(i);
        // With the same operations as below: t = above / along, for t > 0 of at most t_max and its rounding to f32.
        let (above, along) = (-(o - center).dot(n), d.dot(n));
        let same_side = (above > 0.0) == (along > 0.0);
        let end = f64::from(rays.t_max[i]) * (1.0 + 1e-6) + f64::from(f32::MIN_POSITIVE);
        any |= u32::from(same_side & (above.abs() <= along.abs() * end));
    }
    any != 0
}

/// [`intersect_rectangle`](crate::intersect_rectangle) for a block.
#[inline(always)]
pub(super) fn intersect_rectangle_block(rays: &RayBlock, rectangle: &Rectangle, t: &mut Distances) {
    let center = rectangle.center.as_dvec3();
    let (u, v) = (rectangle.u.as_dvec3(), rectangle.v.as_dvec3());
    let n = u.cross(v);
    let (to_x, to_y) = rectangle.axes();
    for (i, t) in t.iter_mut().enumerate() {
        let (o, d) = rays.lane(i);
        let f = o - center;
        let denominator = d.dot(n);
        let along = -f.dot(n) / denominator;
        let p = f + along * d;
        let x = p.dot(to_x);
        let y = p.dot(to_y);
        let hit = (denominator != 0.0)
            & (denominator.abs() < f64::INFINITY)
            & (x.abs() <= 1.0)
            & (y.abs() <= 1.0);
        *t = rays.accept(i, hit, along as f32);
    }
}

/// [`intersect_cuboid`](crate::intersect_cuboid) for a block.
#[inline(always)]
pub(super) fn intersect_cuboid_block(
    rays: &RayBlock,
    cuboid: &Cuboid,
    t: &mut Distances,
    part: &mut [u32; BLOCK],
) {
    let (min, max) = (cuboid.min.as_dvec3(), cuboid.max.as_dvec3());
    for i in 0..BLOCK {
        let (o, d) = rays.lane(i);
        let (to_min, to_max) = (min - o, max - o);
        let mut inside = is_finite(d) & is_finite(to_min) & is_finite(to_max);
        let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
        let (mut near_part, mut far_part) = (0, 0);
        for axis in 0..3 {
            let parallel = d[axis] == 0.0;
            inside &= !(parallel & ((to_min[axis] > 0.0) | (to_max[axis] < 0.0)));
            let (low, high) = (to_min[axis] / d[axis], to_max[axis] / d[axis]);
            let turned = d[axis] < 0.0;
            let (enter, leave) = if turned { (high, low) } else { (low, high) };
            let first = 2 * axis as u32;
            let (enters, leaves) = (!parallel & (enter > near), !parallel & (leave < far));
            near = if enters { enter } else { near };
            far = if leaves { leave } else { far };
            near_part = if enters {
                first + u32::from(turned)
            } else {
                near_part
            };
            far_part = if leaves {
                first + u32::from(!turned)
            } else {
                far_part
            };
        }
        inside &= near <= far;
        let is_near = rays.contains(i, near as f32);
        t[i] = rays.accept(i, inside, if is_near { near } else { far } as f32);
        part[i] = if is_near { near_part } else { far_part };
    }
}

#[inline(always)]
fn is_finite(v: DVec3) -> bool {
    (v.x.abs() < f64::INFINITY) & (v.y.abs() < f64::INFINITY) & (v.z.abs() < f64::INFINITY)
}
