//! Path tracing: one ray goes on from each surface, at random, and one is sent to a light.
//!
//! Source: Kajiya, "The Rendering Equation", SIGGRAPH 1986; Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997,
//! chapter 9 (multiple importance sampling).

use crate::{
    CameraFrame, MaterialId, PixelSampler, SceneBvh, Settings, ShadowRays, SurfaceInteraction,
    direct::Visibility, emitters::Emitters, hit_groups::HitGroups, sample_light::SampleLight,
    surface_lanes::SurfaceLanes,
};
use umbriel_kernels::{
    Hit, Interval, LANES, Ray, VectorUnit,
    glam::{Vec2, Vec3},
    offset_origin,
};

/// Pairs of dimensions of a sample: that of the place in the pixel, that of the lens, and four a surface.
const PIXEL_PAIR: u32 = 0;
const FIRST_SURFACE_PAIR: u32 = 2;
const PAIRS_A_SURFACE: u32 = 4;
/// Surfaces after which paths of little weight may end.
const SURE_SURFACES: u16 = 3;

/// What a path carries beside its ray.
#[derive(Clone, Copy, Debug)]
struct PathState {
    /// By how much the radiance along the ray is multiplied in its sample.
    weight: Vec3,
    sampler: PixelSampler,
    /// Number of the sample in its pixel.
    sample: u32,
    /// Where its radiance is summed.
    slot: u32,
    /// Surfaces that scattered before.
    depth: u16,
    /// Surfaces of partial alpha that it passed.
    passes: u16,
    /// What it travels in; `None` is air.
    medium: Option<MaterialId>,
    /// The density with which its direction was chosen; infinite where no light could be aimed at in its place.
    pdf: f32,
    /// Where it comes from, and the normal there.
    from: Vec3,
    from_normal: Option<Vec3>,
}

impl PathState {
    /// Two random numbers for the surface that the path meets now.
    fn pair(&self, number: u32) -> Vec2 {
        let surface = u32::from(self.depth) + u32::from(self.passes);
        let pair = FIRST_SURFACE_PAIR + PAIRS_A_SURFACE * surface + number;
        self.sampler.pair(self.sample, pair)
    }
}

/// Light on its way, should nothing stand between.
#[derive(Clone, Copy, Debug)]
struct Unshadowed {
    slot: u32,
    /// By which it will have been scattered.
    surfaces: u16,
    radiance: Vec3,
}

/// Traces batches of paths; keeps its buffers between batches.
#[derive(Debug)]
pub(crate) struct PathTracer<'a> {
    bvh: &'a SceneBvh<'a>,
    settings: &'a Settings,
    emitters: &'a Emitters,
    unit: VectorUnit,
    shadow: ShadowRays<'a>,
    rays: Vec<Ray>,
    states: Vec<PathState>,
    next_rays: Vec<Ray>,
    next_states: Vec<PathState>,
    hits: Vec<Option<Hit>>,
    groups: HitGroups,
    surfaces: Box<SurfaceLanes>,
    shadow_rays: Vec<Ray>,
    unshadowed: Vec<Unshadowed>,
    fractions: Vec<Vec3>,
    pub(crate) rays_traced: u64,
    pub(crate) shadow_rays_traced: u64,
    pub(crate) bad_samples: u64,
}

impl<'a> PathTracer<'a> {
    pub(crate) fn new(
        bvh: &'a SceneBvh<'a>,
        settings: &'a Settings,
        emitters: &'a Emitters,
    ) -> Self {
        Self {
            bvh,
            settings,
            emitters,
            unit: bvh.unit(),
            shadow: ShadowRays::new(bvh, settings.glass_shadows),
            rays: Vec::new(),
            states: Vec::new(),
            next_rays: Vec::new(),
            next_states: Vec::new(),
            hits: Vec::new(),
            groups: HitGroups::default(),
            surfaces: Box::default(),
            shadow_rays: Vec::new(),
            unshadowed: Vec::new(),
            fractions: Vec::new(),
            rays_traced: 0,
            shadow_rays_traced: 0,
            bad_samples: 0,
        }
    }

    /// The radiance of the samples `(x, y, number)`, of pixels with `count` samples each; `radiance` is as long.
    pub(crate) fn trace(
        &mut self,
        frame: &CameraFrame,
        samples: &[(u32, u32, u32)],
        count: u32,
        radiance: &mut [SampleLight],
    ) {
        radiance.fill(SampleLight::default());
        self.rays.clear();
        self.states.clear();
        for (slot, &(x, y, sample)) in (0..).zip(samples) {
            let sampler = PixelSampler::new(x, y, count, self.settings.seed);
            let place = Vec2::new(x as f32, y as f32) + sampler.pair(sample, PIXEL_PAIR);
            let ray = frame.ray(place);
            self.rays.push(ray);
            self.states.push(PathState {
                weight: Vec3::ONE,
                sampler,
                sample,
                slot,
                depth: 0,
                passes: 0,
                medium: None,
                pdf: f32::INFINITY,
                from: ray.origin,
                from_normal: None,
            });
        }
        while !self.rays.is_empty() {
            self.hits.clear();
            self.hits.resize(self.rays.len(), None);
            self.bvh.intersect(&self.rays, &mut self.hits);
            self.rays_traced += self.rays.len() as u64;
            self.see_sky(radiance);
            self.scatter(radiance);
            self.light(radiance);
            std::mem::swap(&mut self.rays, &mut self.next_rays);
            std::mem::swap(&mut self.states, &mut self.next_states);
            self.next_rays.clear();
            self.next_states.clear();
        }
        for sample in radiance {
            if !sample.sum().is_finite() {
                *sample = SampleLight::default();
                self.bad_samples += 1;
            }
        }
    }

    fn see_sky(&self, radiance: &mut [SampleLight]) {
        let environment = &self.bvh.scene().environment;
        for ((ray, state), hit) in self.rays.iter().zip(&self.states).zip(&self.hits) {
            if hit.is_none() {
                let sky = state.weight * environment.radiance(ray.dir);
                radiance[state.slot as usize].add(state.depth, sky);
            }
        }
    }

    /// Evaluates each surface, adds what it emits, and sends a ray to a light and one that goes on.
    fn scatter(&mut self, radiance: &mut [SampleLight]) {
        self.groups
            .sort(&self.hits, self.bvh.scene().instances.len());
        let groups = std::mem::take(&mut self.groups);
        for (instance, members) in groups.iter() {
            for members in members.chunks(LANES) {
                let rays = &self.rays;
                let surfaces = &mut *self.surfaces;
                let hits = members.iter().map(|(i, hit)| (rays[*i as usize], *hit));
                self.unit.run(
                    #[inline(always)]
                    || surfaces.fill(self.bvh, instance, hits),
                );
                for (lane, &(i, hit)) in members.iter().enumerate() {
                    self.scatter_one(i as usize, lane, &hit, radiance);
                }
            }
        }
        self.groups = groups;
    }

    fn scatter_one(&mut self, i: usize, lane: usize, hit: &Hit, radiance: &mut [SampleLight]) {
        let (scene, surface) = (self.bvh.scene(), self.surfaces.get(lane));
        let mut state = self.states[i];
        if let Some(medium) = state.medium {
            state.weight *= scene.materials[medium.index()].absorption(hit.t);
        }
        let choices = state.pair(0);
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
        if u32::from(state.depth) >= self.settings.depth {
            return;
        }
        self.aim(&state, &surface);
        self.go_on(&state, &surface, choices.x, lane, hit.instance);
    }

    /// The path goes straight on behind a surface of partial alpha.
    fn pass(&mut self, i: usize, surface: &SurfaceInteraction, state: PathState) {
        if state.passes >= 256 {
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
    ///
    /// Source: Veach & Guibas, "Optimally Combining Sampling Techniques for Monte Carlo Rendering", SIGGRAPH 1995 (balance heuristic).
    fn emission_share(&self, state: &PathState, hit: &Hit, p: Vec3) -> f32 {
        if state.pdf == f32::INFINITY {
            return 1.0;
        }
        let to_light = p - state.from;
        let normal = state.from_normal;
        let aimed = self
            .emitters
            .pdf(hit.instance, hit.primitive, state.from, normal, to_light);
        state.pdf / (state.pdf + aimed)
    }

    /// Takes down what a light gives, chosen at random, and the ray that asks for it.
    fn aim(&mut self, state: &PathState, surface: &SurfaceInteraction) {
        let bsdf = &surface.bsdf;
        if self.emitters.is_empty() || bsdf.is_smooth() {
            return;
        }
        let normal = facing(surface);
        let choice = state.pair(2).x;
        let scene = self.bvh.scene();
        let found = self
            .emitters
            .sample(scene, surface.p, normal, choice, state.pair(3));
        let Some(light) = found else {
            return;
        };
        let above = light.wi.dot(surface.ng) > 0.0;
        if above != (light.wi.dot(surface.ns) > 0.0) {
            return;
        }
        let f = bsdf.eval_through(surface.ns, surface.wo, light.wi);
        let share = if light.pdf == f32::INFINITY {
            1.0
        } else {
            light.pdf / (light.pdf + bsdf.pdf(surface.ns, surface.wo, light.wi))
        };
        let radiance = state.weight * f * light.radiance * share;
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
        lobe: f32,
        lane: usize,
        instance: u32,
    ) {
        let sampled = surface
            .bsdf
            .sample(surface.ns, surface.wo, lobe, state.pair(1));
        let Some(sampled) = sampled else {
            return;
        };
        if sampled.transmitted == (sampled.wi.dot(surface.ng) > 0.0) {
            return;
        }
        let mut weight = state.weight * sampled.weight;
        if state.depth >= SURE_SURFACES {
            let survival = weight.max_element().min(1.0);
            if state.pair(2).y >= survival {
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

    fn light(&mut self, radiance: &mut [SampleLight]) {
        self.fractions.clear();
        self.fractions.resize(self.shadow_rays.len(), Vec3::ONE);
        if self.settings.shadows {
            let rays = &self.shadow_rays;
            self.shadow.transmittance(rays, &[], &mut self.fractions);
            self.shadow_rays_traced += rays.len() as u64;
        }
        for (light, fraction) in self.unshadowed.iter().zip(&self.fractions) {
            radiance[light.slot as usize].add(light.surfaces, light.radiance * *fraction);
        }
        self.shadow_rays.clear();
        self.unshadowed.clear();
    }
}

/// The normal of the side that takes light; `None` where both do.
fn facing(surface: &SurfaceInteraction) -> Option<Vec3> {
    (surface.bsdf.transmission == 0.0).then_some(surface.ns)
}

fn shadow_ray(surface: &SurfaceInteraction, to_light: Vec3, t_max: f32) -> Ray {
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
