//! The queue of weighted rays: the loop that all ray methods share.

use crate::{
    MaterialId, Method, SceneBvh, Settings, ShadowRays, SurfaceInteraction, Unshadowed,
    direct::DirectLight, ray_cast, surface::surface_interaction, whitted,
};
use umbriel_kernels::{Hit, Ray, glam::Vec3, offset_origin};

/// How many surfaces with alpha one ray may pass; what lies behind more is not seen.
const MAX_PASSES: u16 = 256;

/// What a queued ray carries beside its geometry.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RayState {
    /// By how much the radiance along the ray is multiplied in its sample.
    pub(crate) weight: Vec3,
    /// Which sample it belongs to.
    pub(crate) sample: u32,
    /// Number of mirrored and refracted rays before it.
    pub(crate) depth: u16,
    /// Number of transparent surfaces that it passed.
    pub(crate) passes: u16,
    /// What it travels in; `None` is air.
    pub(crate) medium: Option<MaterialId>,
}

/// Weighted rays in the order in which they were found.
#[derive(Debug, Default)]
pub(crate) struct Queue {
    rays: Vec<Ray>,
    states: Vec<RayState>,
}

impl Queue {
    pub(crate) fn push(&mut self, ray: Ray, state: RayState) {
        self.rays.push(ray);
        self.states.push(state);
    }

    fn clear(&mut self) {
        self.rays.clear();
        self.states.clear();
    }
}

/// Traces batches of eye rays; keeps its buffers between batches.
#[derive(Debug)]
pub(crate) struct Tracer<'a> {
    bvh: &'a SceneBvh<'a>,
    settings: &'a Settings,
    shadow_rays: ShadowRays<'a>,
    direct: DirectLight,
    queue: Queue,
    next: Queue,
    hits: Vec<Option<Hit>>,
    /// Eye, mirrored and refracted rays so far.
    pub(crate) rays: u64,
    /// Samples that were not finite and count as black.
    pub(crate) bad_samples: u64,
}

impl<'a> Tracer<'a> {
    pub(crate) fn new(bvh: &'a SceneBvh<'a>, settings: &'a Settings) -> Self {
        Self {
            bvh,
            settings,
            shadow_rays: ShadowRays::new(bvh, settings.glass_shadows),
            direct: DirectLight::default(),
            queue: Queue::default(),
            next: Queue::default(),
            hits: Vec::new(),
            rays: 0,
            bad_samples: 0,
        }
    }

    /// Number of visibility questions asked so far.
    pub(crate) fn shadow_rays(&self) -> u64 {
        self.direct.shadow_rays
    }

    /// The radiance along each ray, in nit. `eye` rays have unit directions; `radiance` is as long as `eye`.
    ///
    /// Contributions are added in the order of the queue, which does not depend on how a batch is run.
    pub(crate) fn trace(&mut self, eye: &[Ray], radiance: &mut [Vec3]) {
        radiance.fill(Vec3::ZERO);
        self.queue.clear();
        for (sample, &ray) in eye.iter().enumerate() {
            let state = RayState {
                weight: Vec3::ONE,
                sample: sample as u32,
                depth: 0,
                passes: 0,
                medium: None,
            };
            self.queue.push(ray, state);
        }
        while !self.queue.rays.is_empty() {
            self.intersect();
            self.next.clear();
            self.shade(radiance);
            self.light(radiance);
            std::mem::swap(&mut self.queue, &mut self.next);
        }
        for sample in radiance {
            if !sample.is_finite() {
                *sample = Vec3::ZERO;
                self.bad_samples += 1;
            }
        }
    }

    /// Step 1: what does each ray hit?
    fn intersect(&mut self) {
        self.hits.clear();
        self.hits.resize(self.queue.rays.len(), None);
        self.bvh.intersect(&self.queue.rays, &mut self.hits);
        self.rays += self.queue.rays.len() as u64;
    }

    /// Steps 2 and 4: evaluate each surface, add what it emits, take down its direct light, and push the rays that
    /// go on from it. Rays that hit nothing see the sky.
    fn shade(&mut self, radiance: &mut [Vec3]) {
        let scene = self.bvh.scene();
        for ((ray, state), hit) in self
            .queue
            .rays
            .iter()
            .zip(&self.queue.states)
            .zip(&self.hits)
        {
            let sum = &mut radiance[state.sample as usize];
            let Some(hit) = hit else {
                *sum += state.weight * scene.environment.radiance(ray.dir);
                continue;
            };
            let mut state = *state;
            if let Some(medium) = state.medium {
                state.weight *= scene.materials[medium.index()].absorption(hit.t);
            }
            let mut surface = surface_interaction(self.bvh, ray, hit);
            if surface.bsdf.alpha < 1.0 {
                pass(&surface, ray, &state, &mut self.next);
                state.weight *= surface.bsdf.alpha;
            }
            if surface.bsdf.unlit {
                *sum += state.weight * surface.bsdf.base_color;
                continue;
            }
            let ambient = match self.settings.method {
                Method::RayCast => ray_cast::shade(&scene.environment, &mut surface),
                Method::Whitted => {
                    let material = scene.instances[hit.instance as usize].material;
                    whitted::spawn(self.settings, &surface, &state, material, &mut self.next);
                    whitted::ambient(&scene.environment, &surface)
                }
            };
            *sum += state.weight * (surface.bsdf.emission + ambient);
            self.direct.add(
                scene,
                &surface,
                state.weight,
                state.sample,
                self.settings.min_weight,
            );
        }
    }

    /// Step 3: add the direct light where the batch of shadow queries says lit.
    fn light(&mut self, radiance: &mut [Vec3]) {
        if self.settings.shadows {
            self.direct.resolve(&mut self.shadow_rays, radiance);
        } else {
            self.direct.resolve(&mut Unshadowed, radiance);
        }
    }
}

/// Pushes what is left of a ray behind a partly transparent surface.
fn pass(surface: &SurfaceInteraction, ray: &Ray, state: &RayState, queue: &mut Queue) {
    if state.passes >= MAX_PASSES {
        return;
    }
    let behind = RayState {
        weight: state.weight * (1.0 - surface.bsdf.alpha),
        passes: state.passes + 1,
        ..*state
    };
    let origin = offset_origin(surface.p, surface.error, surface.ng, ray.dir);
    queue.push(Ray::new(origin, ray.dir), behind);
}
