//! THE direct-light loop: every algorithm lights its surfaces here.

use crate::{
    Light, LightSample, SurfaceInteraction, bsdf::Plain, shade_block::SeenLanes,
    surface_lanes::SurfaceLanes,
};
use std::f32::consts::FRAC_1_PI;
use umbriel_kernels::{
    Interval, LANES, Lanes, Ray, Vec3Lanes, glam::Vec3, offset_origin, whole_vectors,
};

/// The second question of every picture: how much of this light reaches this point?
///
/// Shadow rays and "all of it" are answers to a batch of rays; shadow maps answer at once, for the points themselves
/// ([`ShadowMap::fraction`](crate::ShadowMap::fraction)), and so need no ray and no batch.
pub trait Visibility {
    /// For each ray from a surface towards the light of the same place in `lights` (positions in
    /// [`Scene::lights`](crate::Scene::lights)), the fraction of the light that arrives, by colour. All slices have one length.
    fn transmittance(&mut self, rays: &[Ray], lights: &[u32], fractions: &mut [Vec3]);
}

/// The same question for a block of surfaces at once, for answers that need no ray.
///
/// Its function is called within [`VectorUnit::run`](umbriel_kernels::VectorUnit::run), and is to be `#[inline(always)]`.
pub(crate) trait VisibilityLanes {
    /// The fraction of the light with this position in [`Scene::lights`](crate::Scene::lights) that arrives at each of
    /// `surfaces`. Lanes that reflect no greater `share` of the light than [`LEAST_SHARE`], and those behind the last surface, may be given any
    /// number.
    fn fractions(
        &mut self,
        light: usize,
        surfaces: &SurfaceLanes,
        share: &Lanes,
        fractions: &mut Lanes,
    );
}

/// Light on its way to the film, should nothing stand between surface and light.
#[derive(Clone, Copy, Debug)]
struct PendingLight {
    /// Which sample it belongs to.
    sample: u32,
    radiance: Vec3,
}

/// What a block of surfaces reflects of one light, and the rays towards it.
#[derive(Debug)]
pub(crate) struct LitLanes {
    /// Greatest share of the light in any colour.
    pub(crate) share: Lanes,
    pub(crate) radiance: Vec3Lanes,
    /// Of the light, by which it arrives.
    fraction: Lanes,
    origin: Vec3Lanes,
    dir: Vec3Lanes,
    t_max: Lanes,
}

impl Default for LitLanes {
    fn default() -> Self {
        Self {
            share: [0.0; LANES],
            radiance: Vec3Lanes::default(),
            fraction: [0.0; LANES],
            origin: Vec3Lanes::default(),
            dir: Vec3Lanes::default(),
            t_max: [0.0; LANES],
        }
    }
}

impl LitLanes {
    /// What each surface reflects of one light, without rays towards it.
    #[inline(always)]
    pub(crate) fn reflect_alone(
        &mut self,
        light: &Light,
        surfaces: &SurfaceLanes,
        weights: &Vec3Lanes,
    ) {
        self.reflect(
            light,
            surfaces,
            weights,
            #[inline(always)]
            |_, _, _, _| {},
        );
    }

    /// What each surface reflects of one light. `keep` is called for each lane with what arrives there.
    #[inline(always)]
    fn reflect(
        &mut self,
        light: &Light,
        surfaces: &SurfaceLanes,
        weights: &Vec3Lanes,
        keep: impl Fn(&mut Self, usize, &SurfaceInteraction, &LightSample),
    ) {
        match light {
            // The common kinds have loops of their own.
            Light::Point(light) => self.reflect_each(
                surfaces,
                weights,
                #[inline(always)]
                |p| light.sample(p),
                keep,
            ),
            Light::Directional(_) => {
                let everywhere = light.sample(Vec3::ZERO);
                self.reflect_each(
                    surfaces,
                    weights,
                    #[inline(always)]
                    |_| everywhere,
                    keep,
                );
            }
            Light::Spot(_) => self.reflect_each(surfaces, weights, |p| light.sample(p), keep),
        }
    }

    #[inline(always)]
    fn reflect_each(
        &mut self,
        surfaces: &SurfaceLanes,
        weights: &Vec3Lanes,
        light: impl Fn(Vec3) -> Option<LightSample>,
        keep: impl Fn(&mut Self, usize, &SurfaceInteraction, &LightSample),
    ) {
        if surfaces.is_plain {
            self.reflect_by(
                surfaces,
                weights,
                light,
                #[inline(always)]
                |s, wi| Plain::new(&s.bsdf, s.ns.dot(s.wo)).eval(s.ns, s.wo, wi),
                keep,
            );
        } else {
            self.reflect_by(
                surfaces,
                weights,
                light,
                |s, wi| s.bsdf.eval(s.ns, s.wo, wi),
                keep,
            );
        }
    }

    #[inline(always)]
    fn reflect_by(
        &mut self,
        surfaces: &SurfaceLanes,
        weights: &Vec3Lanes,
        light: impl Fn(Vec3) -> Option<LightSample>,
        eval: impl Fn(&SurfaceInteraction, Vec3) -> Vec3,
        keep: impl Fn(&mut Self, usize, &SurfaceInteraction, &LightSample),
    ) {
        for i in 0..whole_vectors(surfaces.len) {
            let surface = surfaces.get(i);
            let sample = light(surface.p);
            let arriving = sample.unwrap_or(LightSample::DARK);
            let reflected = eval(&surface, arriving.wi);
            let share = weights.get(i) * reflected;
            // Beneath a surface there is no light, but for the band that the terminator's lift opens.
            let above = (arriving.wi.dot(surface.ng) > 0.0) | (surface.shadow_p != surface.p);
            self.share[i] = if sample.is_some() & above {
                share.max_element()
            } else {
                0.0
            };
            self.radiance.set(i, share * arriving.illuminance);
            keep(self, i, &surface, &arriving);
        }
    }

    /// Sets the ray of lane `i` towards the light.
    #[inline(always)]
    fn aim(&mut self, i: usize, surface: &SurfaceInteraction, arriving: &LightSample) {
        let ray = shadow_ray(surface, arriving.to_light, arriving.t_max);
        self.origin.set(i, ray.origin);
        self.dir.set(i, ray.dir);
        self.t_max[i] = ray.t.max;
    }

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

    /// How many of the first `len` lanes reflect enough of the light to ask for its visibility. Those behind have no weight.
    #[inline(always)]
    fn questions(&self, len: usize) -> u32 {
        let lanes = self.share[..whole_vectors(len)].iter();
        lanes.map(|&share| u32::from(share > LEAST_SHARE)).sum()
    }

    /// Leaves the fractions that arrive of the first `len` lanes' radiance, and nothing of what is too little to ask for.
    #[inline(always)]
    fn arrive(&mut self, len: usize) {
        for i in 0..whole_vectors(len) {
            let arriving = self.radiance.get(i) * self.fraction[i];
            let is_lit = self.share[i] > LEAST_SHARE;
            self.radiance
                .set(i, if is_lit { arriving } else { Vec3::ZERO });
        }
    }
}

/// Light of which a surface reflects less than this is left out: a 65,536th of what a white diffuse surface reflects
/// when it faces the light. Most of the tail of a highlight on glass is below.
pub(crate) const LEAST_SHARE: f32 = FRAC_1_PI / 65_536.0;

/// What was taken down of one block of an instance's surfaces and one light. In this order, by instance and light before block, contributions are
/// added, so that a sample's sum does not depend on how surfaces were cut into blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Run {
    instance: u32,
    light: u32,
    start: usize,
    end: usize,
}

/// The lit surfaces of one round, waiting for the answers of one batch of visibility questions.
#[derive(Debug, Default)]
pub(crate) struct DirectLight {
    rays: Vec<Ray>,
    lights: Vec<u32>,
    unshadowed: Vec<PendingLight>,
    runs: Vec<Run>,
    fractions: Vec<Vec3>,
    lit: LitLanes,
    /// Number of visibility questions asked so far.
    pub(crate) shadow_rays: u64,
}

impl DirectLight {
    /// Takes down what surfaces of an instance reflect of each light, times their weights:
    ///
    /// ```text
    /// L_o = Σ_lights  f(wo, wi) (ns·wi) · E_light · transmittance
    /// ```
    /// [`DirectLight::resolve`] asks for the transmittance.
    #[inline(always)]
    pub(crate) fn add(
        &mut self,
        instance: u32,
        lights: &[Light],
        surfaces: &SurfaceLanes,
        seen: &SeenLanes,
    ) {
        if is_mirror(surfaces) {
            return;
        }
        for (light, number) in lights.iter().zip(0..) {
            let start = self.rays.len();
            self.lit.reflect(
                light,
                surfaces,
                &seen.weight,
                #[inline(always)]
                |lit, i, surface, arriving| lit.aim(i, surface, arriving),
            );
            for i in 0..surfaces.len {
                if self.lit.share[i] > LEAST_SHARE {
                    self.rays.push(self.lit.ray(i));
                    self.lights.push(number);
                    self.unshadowed.push(PendingLight {
                        sample: seen.sample[i],
                        radiance: self.lit.radiance.get(i),
                    });
                }
            }
            self.runs.push(Run {
                instance,
                light: number,
                start,
                end: self.rays.len(),
            });
        }
    }

    /// Calls `add` with what surfaces reflect of each light at once: [`DirectLight::add`] and [`DirectLight::resolve`] in one, where no ray
    /// need be sent.
    ///
    /// Gives the same sums to the bit where each sample has one ray in the queue, as it has without mirrored and refracted
    /// rays; otherwise the order is another, that of the blocks.
    #[inline(always)]
    pub(crate) fn add_now(
        &mut self,
        lights: &[Light],
        surfaces: &SurfaceLanes,
        seen: &SeenLanes,
        visibility: &mut impl VisibilityLanes,
        mut add: impl FnMut(&Vec3Lanes),
    ) {
        if is_mirror(surfaces) {
            return;
        }
        let lit = &mut self.lit;
        for (number, light) in lights.iter().enumerate() {
            lit.reflect_alone(light, surfaces, &seen.weight);
            let questions = lit.questions(surfaces.len);
            if questions == 0 {
                continue;
            }
            self.shadow_rays += u64::from(questions);
            visibility.fractions(number, surfaces, &lit.share, &mut lit.fraction);
            lit.arrive(surfaces.len);
            add(&lit.radiance);
        }
    }

    /// Adds what arrives to each sample's radiance, and forgets it.
    pub(crate) fn resolve(&mut self, visibility: &mut impl Visibility, radiance: &mut [Vec3]) {
        self.fractions.clear();
        self.fractions.resize(self.rays.len(), Vec3::ZERO);
        visibility.transmittance(&self.rays, &self.lights, &mut self.fractions);
        self.shadow_rays += self.rays.len() as u64;
        self.runs.sort_unstable();
        for run in self.runs.drain(..) {
            let run = run.start..run.end;
            let fractions = &self.fractions[run.clone()];
            for (light, &fraction) in self.unshadowed[run].iter().zip(fractions) {
                radiance[light.sample as usize] += light.radiance * fraction;
            }
        }
        self.rays.clear();
        self.lights.clear();
        self.unshadowed.clear();
    }
}

/// Whether all surfaces are perfect mirrors, which show no lights without extent.
#[inline(always)]
fn is_mirror(surfaces: &SurfaceLanes) -> bool {
    surfaces.uniform.is_some_and(|bsdf| bsdf.is_smooth())
}

/// The light that arrives at a surface, unless something stands in its way, and the share of it that is seen, times `weight`; `None` where that is too little
/// to ask for its visibility. The slide of [`DirectLight::add`].
pub(crate) fn share_of(
    light: &Light,
    surface: &SurfaceInteraction,
    weight: Vec3,
) -> Option<(LightSample, Vec3)> {
    let arriving = light.sample(surface.p)?;
    let above = arriving.wi.dot(surface.ng) > 0.0 || surface.shadow_p != surface.p;
    let share = weight * surface.bsdf.eval(surface.ns, surface.wo, arriving.wi);
    (above && share.max_element() > LEAST_SHARE).then_some((arriving, share))
}

/// The ray from a surface to the end of `to_light`.
#[inline(always)]
pub(crate) fn shadow_ray(surface: &SurfaceInteraction, to_light: Vec3, t_max: f32) -> Ray {
    let SurfaceInteraction {
        p,
        shadow_p,
        error,
        ng,
        ..
    } = *surface;
    ray_to_light([p, shadow_p], error, ng, to_light, t_max)
}

/// The ray from the points `[p, shadow_p]` of a surface to the end of `to_light`; see [`SurfaceInteraction`] for the others.
#[inline(always)]
pub(crate) fn ray_to_light(
    [p, shadow_p]: [Vec3; 2],
    error: Vec3,
    ng: Vec3,
    to_light: Vec3,
    t_max: f32,
) -> Ray {
    let origin = offset_origin(shadow_p, error, ng, to_light);
    Ray {
        origin,
        // The offset moved the origin: aim at the light again.
        dir: if t_max <= 1.0 {
            p + to_light - origin
        } else {
            to_light
        },
        t: Interval {
            min: 0.0,
            max: t_max,
        },
    }
}

#[cfg(test)]
mod tests;
