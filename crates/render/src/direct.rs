//! THE direct-light loop: every algorithm lights its surfaces here.

use crate::{Scene, SurfaceInteraction};
use std::f32::consts::PI;
use umbriel_kernels::{Interval, Ray, glam::Vec3, offset_origin};

/// The second question of every picture: how much of this light reaches this point?
///
/// Shadow rays, shadow maps and "all of it" are the answers.
pub trait Visibility {
    /// For each ray from a surface towards the light of the same place in `lights` (positions in
    /// [`Scene::lights`]), the fraction of the light that arrives, by colour. All slices have one length.
    fn transmittance(&mut self, rays: &[Ray], lights: &[u32], fractions: &mut [Vec3]);
}

/// Light on its way to the film, should nothing stand between surface and light.
#[derive(Clone, Copy, Debug)]
struct Unshadowed {
    /// Which sample it belongs to.
    sample: u32,
    radiance: Vec3,
}

/// The lit surfaces of one round, waiting for the answers of one batch of visibility questions.
#[derive(Debug, Default)]
pub(crate) struct DirectLight {
    rays: Vec<Ray>,
    lights: Vec<u32>,
    unshadowed: Vec<Unshadowed>,
    fractions: Vec<Vec3>,
    /// Number of visibility questions asked so far.
    pub(crate) shadow_rays: u64,
}

impl DirectLight {
    /// Takes down what a surface reflects of each light, times `weight`:
    ///
    /// ```text
    /// L_o = Σ_lights  f(wo, wi) (ns·wi) · E_light · transmittance
    /// ```
    /// [`DirectLight::resolve`] asks for the transmittance. Light of which the surface reflects less than `min_weight`
    /// of what a white diffuse surface would, weight included, is left out, like rays of too little weight.
    #[inline]
    pub(crate) fn add(
        &mut self,
        scene: &Scene,
        surface: &SurfaceInteraction,
        weight: Vec3,
        sample: u32,
        min_weight: f32,
    ) {
        for (number, light) in scene.lights.iter().enumerate() {
            let Some(arriving) = light.sample(surface.p) else {
                continue;
            };
            let reflected = surface.bsdf.eval(surface.ns, surface.wo, arriving.wi);
            let share = weight * reflected;
            if share.max_element() * PI > min_weight {
                self.rays
                    .push(shadow_ray(surface, arriving.to_light, arriving.t_max));
                self.lights.push(number as u32);
                let radiance = share * arriving.illuminance;
                self.unshadowed.push(Unshadowed { sample, radiance });
            }
        }
    }

    /// Adds what arrives to each sample's radiance, in the order in which it was taken down, and forgets it.
    pub(crate) fn resolve(&mut self, visibility: &mut impl Visibility, radiance: &mut [Vec3]) {
        self.fractions.clear();
        self.fractions.resize(self.rays.len(), Vec3::ZERO);
        visibility.transmittance(&self.rays, &self.lights, &mut self.fractions);
        self.shadow_rays += self.rays.len() as u64;
        for (light, &fraction) in self.unshadowed.iter().zip(&self.fractions) {
            radiance[light.sample as usize] += light.radiance * fraction;
        }
        self.rays.clear();
        self.lights.clear();
        self.unshadowed.clear();
    }
}

/// The ray from a surface to the end of `to_light`.
#[inline]
fn shadow_ray(surface: &SurfaceInteraction, to_light: Vec3, t_max: f32) -> Ray {
    let origin = offset_origin(surface.shadow_p, surface.error, surface.ng, to_light);
    Ray {
        origin,
        // The offset moved the origin: aim at the light again.
        dir: if t_max <= 1.0 {
            surface.p + to_light - origin
        } else {
            to_light
        },
        t: Interval {
            min: 0.0,
            max: t_max,
        },
    }
}
