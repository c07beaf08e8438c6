//! Shading of a block of hits of one instance: local light, and the rays that go on.

use crate::{
    Bsdf, MaterialId, Method, Scene, SceneBvh, Settings,
    hit_groups::NumberedHit,
    ray_cast,
    ray_queue::{Onward, Queue, RayState},
    surface_lanes::SurfaceLanes,
    whitted::{self, OnwardLanes},
};
use umbriel_kernels::{LANES, Ray, Vec3Lanes, glam::Vec3, offset_origin, whole_vectors};

/// How many surfaces with alpha one ray may pass; what lies behind more is not seen.
pub(crate) const MAX_PASSES: u16 = 256;

/// By what weight and in which sample the surfaces of a block are seen.
#[derive(Debug)]
pub(crate) struct SeenLanes {
    pub(crate) weight: Vec3Lanes,
    pub(crate) sample: [u32; LANES],
}

impl SeenLanes {
    /// Adds the first `len` lanes to their samples, which need not differ.
    #[inline(always)]
    pub(crate) fn add(&self, lanes: &Vec3Lanes, len: usize, radiance: &mut [Vec3]) {
        for (i, &sample) in self.sample[..len.min(LANES)].iter().enumerate() {
            radiance[sample as usize] += lanes.get(i);
        }
    }
}

/// The buffers of a block; its functions are to be called one after the other, in their order, within
/// [`VectorUnit::run`](umbriel_kernels::VectorUnit::run).
#[derive(Debug)]
pub(crate) struct ShadeBlock {
    pub(crate) surfaces: SurfaceLanes,
    pub(crate) seen: SeenLanes,
    ambient: Vec3Lanes,
    /// What the surfaces send out without direct light.
    own: Vec3Lanes,
    mirrored: OnwardLanes,
    refracted: OnwardLanes,
}

impl Default for ShadeBlock {
    fn default() -> Self {
        Self {
            surfaces: SurfaceLanes::default(),
            seen: SeenLanes {
                weight: Vec3Lanes::default(),
                sample: [0; LANES],
            },
            ambient: Vec3Lanes::default(),
            own: Vec3Lanes::default(),
            mirrored: OnwardLanes::default(),
            refracted: OnwardLanes::default(),
        }
    }
}

impl ShadeBlock {
    /// Evaluates the surfaces where the rays `members` of `queue`, which are at most [`LANES`], hit `instance`, and what
    /// is left of the rays' weights there.
    #[inline(always)]
    pub(crate) fn evaluate(
        &mut self,
        bvh: &SceneBvh,
        queue: &Queue,
        instance: u32,
        members: &[NumberedHit],
    ) {
        let members = &members[..members.len().min(LANES)];
        let (rays, states) = (queue.rays.as_slice(), queue.states.as_slice());
        let hits = members.iter().map(|(i, hit)| (rays[*i as usize], *hit));
        self.surfaces.fill(bvh, instance, hits);
        for (lane, (i, hit)) in members.iter().enumerate() {
            let state = &states[*i as usize];
            let mut weight = state.weight;
            if let Some(medium) = state.medium {
                weight *= bvh.scene().materials[medium.index()].absorption(hit.t);
            }
            self.seen.weight.set(lane, weight);
            self.seen.sample[lane] = state.sample;
        }
        for lane in members.len()..whole_vectors(members.len()) {
            self.seen.weight.set(lane, Vec3::ZERO);
        }
    }

    /// Says that the lanes of a mask, the first one in the lowest bit, are seen with their full weight, and the others not at all.
    #[inline(always)]
    pub(crate) fn see(&mut self, lanes: u64) {
        for lane in 0..LANES {
            let weight = if lanes >> lane & 1 == 1 { 1.0 } else { 0.0 };
            self.seen.weight.set(lane, Vec3::splat(weight));
        }
    }

    /// Pushes what is left of the rays behind partly transparent surfaces, and takes it off their weights.
    #[inline(always)]
    pub(crate) fn pass(&mut self, members: &[NumberedHit], queue: &Queue, passed: &mut Queue) {
        if self.surfaces.uniform.is_some_and(|bsdf| bsdf.alpha == 1.0) {
            return;
        }
        for (lane, (i, _)) in members.iter().enumerate().take(LANES) {
            let (surface, weight) = (self.surfaces.get(lane), self.seen.weight.get(lane));
            let (ray, state) = (&queue.rays[*i as usize], &queue.states[*i as usize]);
            if surface.bsdf.alpha < 1.0 && state.passes < MAX_PASSES {
                let behind = RayState {
                    weight: weight * (1.0 - surface.bsdf.alpha),
                    passes: state.passes + 1,
                    ..*state
                };
                let origin = offset_origin(surface.p, surface.error, surface.ng, ray.dir);
                passed.push(Ray::new(origin, ray.dir), behind);
            }
            self.seen.weight.set(lane, weight * surface.bsdf.alpha);
        }
    }

    /// Finds the light that needs no further ray, and calls `add` with it if there is any. Gives false if that is all there is.
    #[inline(always)]
    pub(crate) fn shade(
        &mut self,
        scene: &Scene,
        settings: &Settings,
        add: impl FnOnce(&SeenLanes, &Vec3Lanes, usize),
    ) -> bool {
        let unlit = self.surfaces.is_unlit();
        let glows = |bsdf: &Bsdf| bsdf.emission != Vec3::ZERO;
        let mut shines = unlit || self.surfaces.uniform.as_ref().is_none_or(glows);
        if !unlit {
            shines |= match settings.method {
                Method::RayCast | Method::ShadowMap => {
                    ray_cast::shade(&scene.environment, &mut self.surfaces, &mut self.ambient);
                    true
                }
                Method::Whitted | Method::Path | Method::Distributed => {
                    whitted::ambient(&scene.environment, &self.surfaces, &mut self.ambient)
                }
            };
        }
        if !shines {
            return true;
        }
        for lane in 0..whole_vectors(self.surfaces.len) {
            let bsdf = self.surfaces.get(lane).bsdf;
            let own = if unlit {
                bsdf.base_color
            } else {
                bsdf.emission + self.ambient.get(lane)
            };
            self.own.set(lane, self.seen.weight.get(lane) * own);
        }
        add(&self.seen, &self.own, self.surfaces.len);
        !unlit
    }

    /// Pushes the mirrored and the refracted rays of Whitted's method. `material` is that of the surfaces.
    #[inline(always)]
    pub(crate) fn push(
        &mut self,
        settings: &Settings,
        material: MaterialId,
        members: &[NumberedHit],
        queue: &Queue,
        next: &mut Onward,
    ) {
        let depth = settings.depth.min(u32::from(u16::MAX));
        let may_go_on = |state: &RayState| u32::from(state.depth) < depth;
        let states = || members.iter().map(|m| &queue.states[m.0 as usize]);
        if settings.method != Method::Whitted || !states().any(may_go_on) {
            return;
        }
        let least = settings.min_weight;
        let (weights, onward) = (&self.seen.weight, (&mut self.mirrored, &mut self.refracted));
        whitted::spawn(&self.surfaces, weights, least, onward.0, onward.1);
        let on_their_way = |onward: &OnwardLanes| {
            let lanes = if onward.any() { LANES } else { 0 };
            states().enumerate().take(lanes)
        };
        for (lane, state) in on_their_way(&self.mirrored) {
            if may_go_on(state) && self.mirrored.has_weight(lane, least) {
                let state = self.mirrored.state(lane, state);
                next.mirrored.push(self.mirrored.ray(lane), state);
            }
        }
        for (lane, state) in on_their_way(&self.refracted) {
            if may_go_on(state) && self.refracted.has_weight(lane, least) {
                let medium = self.surfaces.medium_behind(lane, material, state.medium);
                let state = RayState {
                    medium,
                    ..self.refracted.state(lane, state)
                };
                next.refracted.push(self.refracted.ray(lane), state);
            }
        }
    }
}
