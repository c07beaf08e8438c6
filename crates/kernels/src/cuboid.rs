//! Axis-aligned solid boxes. (`Box` is a name of Rust's own.)

use crate::{Aabb, Ray, SurfaceHit, SurfacePoint};
use glam::{Vec2, Vec3};

/// The solid box between two corners; every component of `max` is greater than that of `min`.
///
/// Its faces, and the `part` of a hit, are −x, +x, −y, +y, −z, +z, numbered 0 to 5.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    /// Least corner.
    pub min: Vec3,
    /// Greatest corner.
    pub max: Vec3,
}

impl Cuboid {
    /// Bounding box: exactly the cuboid.
    pub fn bounds(&self) -> Aabb {
        Aabb {
            min: self.min,
            max: self.max,
        }
    }

    /// The point of face `part` nearest to `p`; parts above 5 count as 5.
    ///
    /// `uv`: the face seen from outside, (0, 0) at its lower left and (1, 1) at its upper right.
    /// +y is up on the four sides; −z is up on the top and +z on the bottom, both with +x to the
    /// right.
    pub fn point_at(&self, part: u32, p: Vec3) -> SurfacePoint {
        let (_, u_axis, v_axis) = FACES[part.min(5) as usize];
        let (p, n) = self.normal_at(part, p);
        let x = ((p - self.min) / (self.max - self.min)).clamp(Vec3::ZERO, Vec3::ONE);
        // Along a negative axis the coordinate runs the other way.
        let along = |axis: Vec3| {
            let x = x.dot(axis);
            if axis.element_sum() < 0.0 { 1.0 + x } else { x }
        };
        SurfacePoint {
            p,
            n,
            uv: Vec2::new(along(u_axis), along(v_axis)),
            tangent: u_axis,
        }
    }

    /// `p` and `n` of [`Cuboid::point_at`], without branches.
    #[inline(always)]
    pub fn normal_at(&self, part: u32, p: Vec3) -> (Vec3, Vec3) {
        let axis = part.min(5) / 2;
        let is_least = part.min(5) & 1 == 0;
        let (face, sign) = if is_least {
            (self.min, -1.0)
        } else {
            (self.max, 1.0)
        };
        let p = p.max(self.min).min(self.max);
        let (x, y, z) = (axis == 0, axis == 1, axis == 2);
        let at = Vec3::new(
            if x { face.x } else { p.x },
            if y { face.y } else { p.y },
            if z { face.z } else { p.z },
        );
        let n = Vec3::new(
            if x { sign } else { 0.0 },
            if y { sign } else { 0.0 },
            if z { sign } else { 0.0 },
        );
        (at, n)
    }
}

/// Normal, `u` axis and `v` axis of each face, with `u × v = n`.
const FACES: [(Vec3, Vec3, Vec3); 6] = [
    (Vec3::NEG_X, Vec3::Z, Vec3::Y),
    (Vec3::X, Vec3::NEG_Z, Vec3::Y),
    (Vec3::NEG_Y, Vec3::X, Vec3::Z),
    (Vec3::Y, Vec3::X, Vec3::NEG_Z),
    (Vec3::NEG_Z, Vec3::NEG_X, Vec3::Y),
    (Vec3::Z, Vec3::X, Vec3::Y),
];

/// Intersects a ray with a solid box; gives the nearest `t` in the ray's interval and its face.
///
/// The box is the intersection of three slabs. The ray is in slab `i` between
/// ```text
/// (min_i − o_i) / d_i      and      (max_i − o_i) / d_i
/// ```
/// and in the box from the last entry to the first exit, if these come in that order. A ray
/// parallel to a slab is always or never in it; the faces belong to the box. An origin inside hits
/// the far wall. On an edge the lower axis wins. Computed in f64.
///
/// Source: Kay & Kajiya, "Ray Tracing Complex Scenes", SIGGRAPH 1986.
#[inline]
pub fn intersect_cuboid(ray: &Ray, cuboid: &Cuboid) -> Option<SurfaceHit> {
    let o = ray.origin.as_dvec3();
    let d = ray.dir.as_dvec3();
    let to_min = cuboid.min.as_dvec3() - o;
    let to_max = cuboid.max.as_dvec3() - o;
    if !(d.is_finite() && to_min.is_finite() && to_max.is_finite()) {
        return None;
    }
    let mut near = (f64::NEG_INFINITY, 0);
    let mut far = (f64::INFINITY, 0);
    for i in 0..3 {
        if d[i] == 0.0 {
            if to_min[i] > 0.0 || to_max[i] < 0.0 {
                return None;
            }
            continue;
        }
        let part = 2 * i as u32;
        let mut enter = (to_min[i] / d[i], part);
        let mut leave = (to_max[i] / d[i], part + 1);
        if d[i] < 0.0 {
            (enter, leave) = (leave, enter);
        }
        near = if enter.0 > near.0 { enter } else { near };
        far = if leave.0 < far.0 { leave } else { far };
    }
    if near.0 > far.0 {
        return None;
    }
    [near, far]
        .map(|(t, part)| SurfaceHit { t: t as f32, part })
        .into_iter()
        .find(|hit| ray.t.contains(hit.t))
}
