//! Rays towards lights for many points at once.

use super::{Emitters, LightRay};
use crate::{Scene, surface_lanes::SurfaceLanes};
use umbriel_kernels::{
    LANES, Lanes, Vec3Lanes,
    glam::{Vec2, Vec3},
};

/// A [`LightRay`] a lane; without radiance where there is none.
#[derive(Debug)]
pub(crate) struct LightLanes {
    pub(crate) wi: Vec3Lanes,
    pub(crate) to_light: Vec3Lanes,
    pub(crate) t_max: Lanes,
    pub(crate) radiance: Vec3Lanes,
    pub(crate) pdf: Lanes,
}

impl Default for LightLanes {
    fn default() -> Self {
        Self {
            wi: Vec3Lanes::default(),
            to_light: Vec3Lanes::default(),
            t_max: [1.0; LANES],
            radiance: Vec3Lanes::default(),
            pdf: [1.0; LANES],
        }
    }
}

impl LightLanes {
    #[inline(always)]
    fn set(&mut self, i: usize, ray: &LightRay) {
        self.wi.set(i, ray.wi);
        self.to_light.set(i, ray.to_light);
        self.t_max[i] = ray.t_max;
        self.radiance.set(i, ray.radiance);
        self.pdf[i] = ray.pdf;
    }
}

impl Emitters {
    /// [`Emitters::sample`] for surfaces that take light on the side of their normals.
    #[inline(always)]
    pub(crate) fn sample_lanes(
        &self,
        scene: &Scene,
        surfaces: &SurfaceLanes,
        choice: &Lanes,
        place: &[Lanes; 2],
        light: &mut LightLanes,
    ) {
        for i in 0..surfaces.len.min(LANES) {
            let (p, n) = (surfaces.p(i), surfaces.ns(i));
            let u = Vec2::new(place[0][i], place[1][i]);
            match self.sample(scene, p, Some(n), choice[i], u) {
                Some(ray) => light.set(i, &ray),
                None => light.radiance.set(i, Vec3::ZERO),
            }
        }
    }
}
