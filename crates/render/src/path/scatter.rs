//! What one surface does to a path, whatever its material.

use super::{
    PathTracer,
    state::{
        DIRECTION_PAIR, LIGHT_PAIR, LOBE_PAIR, PLACE_PAIR, PathState, SURE_SURFACES, Unshadowed,
        power_share,
    },
};
use crate::{
    Bsdf, GlassShadows, Method, SurfaceInteraction, ray_cast::ambient_reflection,
    sample_light::SampleLight, shade_block::MAX_PASSES,
};
use umbriel_kernels::{
    Hit, Interval, Ray,
    glam::{Vec2, Vec3},
    offset_origin,
};

impl PathTracer<'_> {
    pub(super) fn scatter_one(
        &mut self,
        i: usize,
        lane: usize,
        hit: &Hit,
        radiance: &mut [SampleLight],
    ) {
        let surface = self.surfaces.get(lane);
        let mut state = self.states[i];
        state.weight *= state.absorption(self.bvh.scene(), hit.t);
        let choices = self.pair(&state, LOBE_PAIR);
        if choices.y >= surface.bsdf.alpha {
            self.pass(i, &surface, state);
            return;
        }
        if surface.bsdf.unlit {
            radiance[state.slot as usize].add(state.depth, state.weight * surface.bsdf.base_color);
            return;
        }
        if surface.bsdf.emission != Vec3::ZERO {
            let share = self.emission_share(&state, hit, surface.p);
            let emitted = state.weight * surface.bsdf.emission * share;
            radiance[state.slot as usize].add(state.depth, emitted);
        }
        if u32::from(state.depth) >= self.depth() {
            return;
        }
        state.bent = self.is_bent(&state, &surface.bsdf);
        let onward = self.onward(&surface, &state, radiance);
        if !state.bent {
            self.aim(&state, &surface, &onward);
        }
        self.go_on(&state, &surface, &onward, choices.x, lane, hit.instance);
    }

    /// Two random numbers for the surface that a path meets now.
    fn pair(&self, state: &PathState, number: u32) -> Vec2 {
        self.points[state.slot as usize].pair(state.first_pair() + number)
    }

    /// Surfaces that scatter at most. Whitted's depth, which counts the rays between them, is one less.
    pub(super) fn depth(&self) -> u32 {
        let rays_counted = self.settings.method == Method::Distributed;
        self.settings.depth.saturating_add(u32::from(rays_counted))
    }

    /// The lobes that rays go on after: all of a path's. A distributed tree has the glossy ones alone, and takes what the others would bring
    /// from the sky's irradiance; a map around the scene is a light, and is aimed at instead.
    fn onward(
        &self,
        surface: &SurfaceInteraction,
        state: &PathState,
        radiance: &mut [SampleLight],
    ) -> Bsdf {
        if self.settings.method != Method::Distributed {
            return surface.bsdf;
        }
        let sky = &self.bvh.scene().environment;
        if sky.map.is_none() || sky.ambient.is_some() {
            let ambient = ambient_reflection(sky, surface, 0.0, 0.0);
            radiance[state.slot as usize].add(state.depth + 1, state.weight * ambient);
        }
        surface.bsdf.glossy()
    }

    /// Whether the light that the path finds from here on comes straight to where the path comes from, by a filtered shadow ray.
    pub(super) fn is_bent(&self, state: &PathState, bsdf: &Bsdf) -> bool {
        let aimed_before = state.bent || state.pdf < f32::INFINITY;
        bsdf.transmission > 0.0 && aimed_before && self.settings.glass() == GlassShadows::Filtered
    }

    /// The path goes straight on behind a surface of partial alpha.
    fn pass(&mut self, i: usize, surface: &SurfaceInteraction, state: PathState) {
        if state.passes >= MAX_PASSES {
            return;
        }
        let dir = self.rays[i].dir;
        let origin = offset_origin(surface.p, surface.error, surface.ng, dir);
        self.next_rays.push(Ray::new(origin, dir));
        self.next_states.push(PathState {
            passes: state.passes + 1,
            ..state
        });
    }

    /// The share of a glowing surface's light that the path brings, where the rest comes from rays aimed at it.
    pub(super) fn emission_share(&self, state: &PathState, hit: &Hit, p: Vec3) -> f32 {
        if state.bent {
            return 0.0;
        }
        if state.pdf == f32::INFINITY {
            return 1.0;
        }
        let to_light = p - state.from;
        let normal = state.from_normal;
        let aimed = self
            .emitters
            .pdf(hit.instance, hit.primitive, state.from, normal, to_light);
        power_share(state.pdf, aimed)
    }

    /// Takes down what a light gives, chosen at random, and the ray that asks for it.
    /// `onward` are the lobes by which rays that go on may find it, too.
    fn aim(&mut self, state: &PathState, surface: &SurfaceInteraction, onward: &Bsdf) {
        let bsdf = &surface.bsdf;
        if self.emitters.is_empty() || bsdf.is_smooth() {
            return;
        }
        let normal = facing(surface);
        let choice = self.pair(state, LIGHT_PAIR).x;
        let scene = self.bvh.scene();
        let found = self.emitters.sample(
            scene,
            surface.p,
            normal,
            choice,
            self.pair(state, PLACE_PAIR),
        );
        let Some(light) = found else {
            return;
        };
        let above = light.wi.dot(surface.ng) > 0.0;
        if above != (light.wi.dot(surface.ns) > 0.0) {
            return;
        }
        let (n, wo) = (surface.ns, surface.wo);
        let f = bsdf.eval_through(n, wo, light.wi);
        let share = power_share(light.pdf, onward.pdf(n, wo, light.wi));
        let weighted = if onward.is_glossy {
            let shared = onward.eval_through(n, wo, light.wi);
            (f - shared).max(Vec3::ZERO) + shared * share
        } else {
            f * share
        };
        let radiance = state.weight * weighted * light.radiance;
        if radiance.max_element() > 0.0 {
            self.shadow_rays
                .push(shadow_ray(surface, light.to_light, light.t_max));
            self.unshadowed.push(Unshadowed {
                slot: state.slot,
                surfaces: state.depth + 1,
                radiance,
            });
        }
    }

    /// Sends the ray that goes on.
    fn go_on(
        &mut self,
        state: &PathState,
        surface: &SurfaceInteraction,
        onward: &Bsdf,
        lobe: f32,
        lane: usize,
        instance: u32,
    ) {
        let u = self.pair(state, DIRECTION_PAIR);
        let sampled = onward.sample(surface.ns, surface.wo, lobe, u);
        let Some(sampled) = sampled else {
            return;
        };
        if sampled.transmitted == (sampled.wi.dot(surface.ng) > 0.0) {
            return;
        }
        let mut weight = state.weight * sampled.weight;
        if state.depth >= SURE_SURFACES {
            let survival = weight.max_element().min(1.0);
            if self.pair(state, LIGHT_PAIR).y >= survival {
                return;
            }
            weight /= survival;
        }
        if !(weight.max_element() > 0.0) {
            return;
        }
        let medium = if sampled.transmitted {
            let material = self.bvh.scene().instances[instance as usize].material;
            self.surfaces.medium_behind(lane, material, state.medium)
        } else {
            state.medium
        };
        let origin = offset_origin(surface.p, surface.error, surface.ng, sampled.wi);
        self.next_rays.push(Ray::new(origin, sampled.wi));
        self.next_states.push(PathState {
            weight,
            depth: state.depth + 1,
            medium,
            pdf: sampled.pdf,
            from: surface.p,
            from_normal: facing(surface),
            ..*state
        });
    }
}

/// The normal of the side that takes light; `None` where both do.
#[inline(always)]
fn facing(surface: &SurfaceInteraction) -> Option<Vec3> {
    (surface.bsdf.transmission == 0.0).then_some(surface.ns)
}

#[inline(always)]
pub(super) fn shadow_ray(surface: &SurfaceInteraction, to_light: Vec3, t_max: f32) -> Ray {
    let origin = offset_origin(surface.shadow_p, surface.error, surface.ng, to_light);
    let dir = if t_max <= 1.0 {
        surface.p + to_light - origin
    } else {
        to_light
    };
    Ray {
        origin,
        dir,
        t: Interval {
            min: 0.0,
            max: t_max,
        },
    }
}
