//! Analytic surfaces in a picture by rasterisation: they are met by the pixels' rays.

use crate::{
    Geometry, InstanceId, Scene, SceneBvh,
    shadow_map::{LightView, covered},
    surface::first_opaque,
};
use umbriel_kernels::{
    Hit, LANES, Listed, Ray, SurfaceList,
    glam::{Affine3A, Vec3},
};

/// An analytic surface and the pixels it may cover.
#[derive(Debug)]
pub(crate) struct EyeSolid {
    list: SurfaceList,
    to_object: Option<Affine3A>,
    /// Alpha below which it has holes.
    cutoff: Option<f32>,
    /// `x0, y0` (included), `x1, y1` (excluded).
    rect: [u32; 4],
}

impl EyeSolid {
    /// That of an instance, if it is one, in a picture of `size`.
    pub(crate) fn new(
        bvh: &SceneBvh,
        view: &LightView,
        instance: usize,
        size: [u32; 2],
        cutoff: Option<f32>,
    ) -> Option<Self> {
        let scene = bvh.scene();
        let Geometry::Surface(id) = scene.instances[instance].geometry else {
            return None;
        };
        let number = instance as u32;
        Some(Self {
            list: SurfaceList::with_unit(
                bvh.unit(),
                vec![Listed::in_world(number, scene.surfaces[id.index()].clone())],
            ),
            to_object: bvh.to_object(InstanceId(number)).copied(),
            cutoff,
            rect: covered(view, bvh, instance, size),
        })
    }

    /// Whether it may be seen within `x0, y0` (included), `x1, y1` (excluded).
    pub(crate) fn is_near(&self, [x0, y0, x1, y1]: [u32; 4]) -> bool {
        let [l, t, r, b] = self.rect;
        l < x1 && r > x0 && t < y1 && b > y0
    }

    /// Puts it before what lies behind it, in the pixels of a rectangle whose rays and hits are given row by row.
    pub(crate) fn see(
        &self,
        scene: &Scene,
        [x0, y0, x1, y1]: [u32; 4],
        rays: &[Ray],
        hits: &mut [Option<Hit>],
    ) {
        let [left, top, right, bottom] = self.rect;
        let (left, right) = (left.max(x0), right.min(x1));
        let mut object_rays = [Ray::new(Vec3::ZERO, Vec3::Z); LANES];
        let mut found = [None; LANES];
        for y in top.max(y0)..bottom.min(y1) {
            for start in (left..right).step_by(LANES) {
                let len = (right - start).min(LANES as u32) as usize;
                let first = ((y - y0) * (x1 - x0) + start - x0) as usize;
                for (ray, world) in object_rays.iter_mut().zip(&rays[first..first + len]) {
                    *ray = self.to_object.map_or(*world, |m| world.transformed(&m));
                }
                self.list.closest(&object_rays[..len], &mut found[..len]);
                for i in 0..len {
                    let found = self.first(scene, &object_rays[i], found[i]);
                    let before = &mut hits[first + i];
                    if let Some(hit) = found
                        && before.is_none_or(|b| (hit.t, hit.instance) < (b.t, b.instance))
                    {
                        *before = Some(hit);
                    }
                }
            }
        }
    }

    /// The first hit of an object-space ray that is no hole.
    fn first(&self, scene: &Scene, ray: &Ray, hit: Option<Hit>) -> Option<Hit> {
        match self.cutoff {
            None => hit,
            Some(cutoff) => first_opaque(scene, &self.list, ray, hit?, cutoff),
        }
    }
}
