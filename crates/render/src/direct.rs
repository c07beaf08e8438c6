//! THE direct-light loop: every algorithm lights its surfaces here.

use crate::{
    Light, LightSample, SurfaceInteraction, shade_block::SeenLanes, surface_lanes::SurfaceLanes,
};
use std::f32::consts::FRAC_1_PI;
use umbriel_kernels::{
    Interval, LANES, Lanes, Ray, Vec3Lanes, glam::Vec3, offset_origin, whole_vectors,
};

/// The second question of every picture: how much of this light reaches this point?
///
/// Shadow rays, shadow maps and "all of it" are the answers.
pub trait Visibility {
    /// For each ray from a surface towards the light of the same place in `lights` (positions in
    /// [`Scene::lights`](crate::Scene::lights)), the fraction of the light that arrives, by colour. All slices have one length.
    fn transmittance(&mut self, rays: &[Ray], lights: &[u32], fractions: &mut [Vec3]);
}

/// Light on its way to the film, should nothing stand between surface and light.
#[derive(Clone, Copy, Debug)]
struct Unshadowed {
    /// Which sample it belongs to.
    sample: u32,
    radiance: Vec3,
}

/// What a block of surfaces reflects of one light, and the rays towards it.
#[derive(Debug)]
struct LitLanes {
    /// Greatest share of the light in any colour.
    share: Lanes,
    radiance: Vec3Lanes,
    origin: Vec3Lanes,
    dir: Vec3Lanes,
    t_max: Lanes,
}

impl Default for LitLanes {
    fn default() -> Self {
        Self {
            share: [0.0; LANES],
            radiance: Vec3Lanes::default(),
            origin: Vec3Lanes::default(),
            dir: Vec3Lanes::default(),
            t_max: [0.0; LANES],
        }
    }
}

impl LitLanes {
    #[inline(always)]
    fn ray(&self, i: usize) -> Ray {
        Ray {
            origin: self.origin.get(i),
            dir: self.dir.get(i),
            t: Interval {
                min: 0.0,
                max: self.t_max[i],
            },
        }
    }
}

/// Light of which a surface reflects less than this is left out: a 65,536th of what a white diffuse surface reflects
/// when it faces the light. Most of the tail of a highlight on glass is below.
const LEAST_SHARE: f32 = FRAC_1_PI / 65_536.0;

/// The lit surfaces of one round, waiting for the answers of one batch of visibility questions.
#[derive(Debug, Default)]
pub(crate) struct DirectLight {
    rays: Vec<Ray>,
    lights: Vec<u32>,
    unshadowed: Vec<Unshadowed>,
    fractions: Vec<Vec3>,
    lit: LitLanes,
    /// Number of visibility questions asked so far.
    pub(crate) shadow_rays: u64,
}

impl DirectLight {
    /// Takes down what surfaces reflect of each light, times their weights:
    ///
    /// ```text
    /// L_o = Σ_lights  f(wo, wi) (ns·wi) · E_light · transmittance
    /// ```
    /// [`DirectLight::resolve`] asks for the transmittance.
    #[inline(always)]
    pub(crate) fn add(&mut self, lights: &[Light], surfaces: &SurfaceLanes, seen: &SeenLanes) {
        // A perfect mirror shows no lights without extent.
        if let Some(bsdf) = surfaces.uniform
            && bsdf.diffuse_color() == Vec3::ZERO
            && bsdf.roughness == 0.0
        {
            return;
        }
        for (number, light) in lights.iter().enumerate() {
            match light {
                // The common kind has a loop of its own.
                Light::Point(light) => self.reflect(
                    surfaces,
                    &seen.weight,
                    #[inline(always)]
                    |p| light.sample(p),
                ),
                light => self.reflect(surfaces, &seen.weight, |p| light.sample(p)),
            }
            for i in 0..surfaces.len {
                if self.lit.share[i] > LEAST_SHARE {
                    self.rays.push(self.lit.ray(i));
                    self.lights.push(number as u32);
                    self.unshadowed.push(Unshadowed {
                        sample: seen.sample[i],
                        radiance: self.lit.radiance.get(i),
                    });
                }
            }
        }
    }

    /// What each surface reflects of one light, and the ray towards it.
    #[inline(always)]
    fn reflect(
        &mut self,
        surfaces: &SurfaceLanes,
        weights: &Vec3Lanes,
        light: impl Fn(Vec3) -> Option<LightSample>,
    ) {
        for i in 0..whole_vectors(surfaces.len) {
            let surface = surfaces.get(i);
            let sample = light(surface.p);
            let arriving = sample.unwrap_or(LightSample::DARK);
            let reflected = surface.bsdf.eval(surface.ns, surface.wo, arriving.wi);
            let share = weights.get(i) * reflected;
            // Beneath a surface there is no light, but for the band that the terminator's lift opens.
            let above = (arriving.wi.dot(surface.ng) > 0.0) | (surface.shadow_p != surface.p);
            self.lit.share[i] = if sample.is_some() & above {
                share.max_element()
            } else {
                0.0
            };
            self.lit.radiance.set(i, share * arriving.illuminance);
            let ray = shadow_ray(&surface, arriving.to_light, arriving.t_max);
            self.lit.origin.set(i, ray.origin);
            self.lit.dir.set(i, ray.dir);
            self.lit.t_max[i] = ray.t.max;
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
#[inline(always)]
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
