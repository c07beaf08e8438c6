//! THE direct-light loop: every algorithm lights its surfaces here.

use crate::{Scene, SurfaceInteraction};
use umbriel_kernels::{Interval, Ray, glam::Vec3, offset_origin};

/// The second question of every picture: how much of this light reaches this point?
///
/// Shadow rays, shadow maps and "all of it" are the answers.
pub trait Visibility {
    /// For each ray from a surface towards light number `light` of the scene, the fraction of the
    /// light that arrives, by colour; `fractions` is as long as `rays`.
    fn transmittance(&mut self, light: usize, rays: &[Ray], fractions: &mut [Vec3]);
}

/// Buffers of [`DirectLight::add`], kept to be used again.
#[derive(Debug, Default)]
pub(crate) struct DirectLight {
    rays: Vec<Ray>,
    /// For each ray, which surface it starts from and what arrives there without shadow.
    unshadowed: Vec<(u32, Vec3)>,
    fractions: Vec<Vec3>,
    /// Number of visibility questions asked.
    pub(crate) shadow_rays: u64,
}

impl DirectLight {
    /// Adds the light that each surface reflects towards the viewer from all lights of the scene:
    ///
    /// ```text
    /// L_o = Σ_lights  f(wo, wi) (ns·wi) · E_light · transmittance
    /// ```
    /// `radiance` is as long as `surfaces`. Lights are taken in their order, so sums are the same on every run.
    pub(crate) fn add(
        &mut self,
        scene: &Scene,
        surfaces: &[SurfaceInteraction],
        visibility: &mut impl Visibility,
        radiance: &mut [Vec3],
    ) {
        for (number, light) in scene.lights.iter().enumerate() {
            self.rays.clear();
            self.unshadowed.clear();
            for (i, surface) in surfaces.iter().enumerate() {
                let Some(sample) = light.sample(surface.p) else {
                    continue;
                };
                let reflected =
                    surface.bsdf.eval(surface.ns, surface.wo, sample.wi) * sample.illuminance;
                if !surface.bsdf.unlit && reflected.max_element() > 0.0 {
                    self.rays
                        .push(shadow_ray(surface, sample.to_light, sample.t_max));
                    self.unshadowed.push((i as u32, reflected));
                }
            }
            self.fractions.clear();
            self.fractions.resize(self.rays.len(), Vec3::ZERO);
            visibility.transmittance(number, &self.rays, &mut self.fractions);
            self.shadow_rays += self.rays.len() as u64;
            for (&(i, reflected), &fraction) in self.unshadowed.iter().zip(&self.fractions) {
                radiance[i as usize] += reflected * fraction;
            }
        }
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
