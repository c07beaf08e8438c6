//! What a scene takes up: the box of all finite things, and the infinite planes.

use crate::{Geometry, Scene, SceneBvh};
use umbriel_kernels::{
    Aabb, Plane, Surface,
    glam::{DVec3, Mat3, Vec3},
};

/// The box of all finite instances, and the planes in world space.
#[derive(Clone, Debug)]
pub(crate) struct Extent {
    /// Empty if nothing is finite.
    pub(crate) finite: Aabb,
    pub(crate) planes: Vec<Plane>,
}

/// Instance `i` in world space, if it is a plane.
pub(crate) fn world_plane(scene: &Scene, i: usize) -> Option<Plane> {
    let instance = &scene.instances[i];
    let Geometry::Surface(id) = instance.geometry else {
        return None;
    };
    let Surface::Plane(plane) = scene.surfaces[id.index()] else {
        return None;
    };
    let to_object = Mat3::from(instance.transform.matrix3.inverse());
    Some(Plane {
        point: instance.transform.transform_point3(plane.point),
        normal: (to_object.transpose() * plane.normal).normalize_or(Vec3::Y),
    })
}

impl Extent {
    pub(crate) fn of(bvh: &SceneBvh) -> Self {
        let scene = bvh.scene();
        let all = 0..scene.instances.len();
        let bounds = all.clone().filter_map(|i| bvh.world_bounds(i));
        Self {
            finite: bounds.fold(Aabb::EMPTY, Aabb::union),
            planes: all.filter_map(|i| world_plane(scene, i)).collect(),
        }
    }

    /// Greatest distance of a finite thing, or of a plane's point, from `p`; 1 if there is nothing.
    pub(crate) fn reach(&self, p: Vec3) -> f32 {
        let corner = |c: Vec3| (c - p).length();
        let planes = self.planes.iter().map(|plane| corner(plane.point));
        let furthest = (p - self.finite.min).abs().max((p - self.finite.max).abs());
        let finite = if self.finite.is_empty() {
            0.0
        } else {
            furthest.length()
        };
        let reach = planes.fold(finite, f32::max);
        if reach > 0.0 && reach.is_finite() {
            reach
        } else {
            1.0
        }
    }
}

/// How far along `direction` from `p` a plane lies; `None` if they are parallel.
pub(crate) fn distance_to(plane: &Plane, p: DVec3, direction: DVec3) -> Option<f64> {
    let n = plane.normal.as_dvec3();
    let along = n.dot(direction);
    (along != 0.0).then(|| n.dot(plane.point.as_dvec3() - p) / along)
}
