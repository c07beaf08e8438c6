//! Path tracing: one ray goes on from each surface, at random, and one is sent to a light.
//!
//! Source: Kajiya, "The Rendering Equation", SIGGRAPH 1986; Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997,
//! chapter 9 (multiple importance sampling).

mod lanes;
mod scatter;
mod smooth;
mod start;
mod state;

use crate::{
    CameraFrame, Method, SceneBvh, Settings, ShadowRays, direct::Visibility, emitters::Emitters,
    film::is_light, hit_groups::HitGroups, sample_light::SampleLight, sobol::SamplePoint,
    surface_lanes::SurfaceLanes,
};
use lanes::ScatterLanes;
use smooth::SmoothLanes;
use start::StartLanes;
use state::{PathState, Unshadowed, power_share};
use umbriel_kernels::{Hit, LANES, Ray, VectorUnit, glam::Vec3};

/// Traces batches of paths; keeps its buffers between batches.
#[derive(Debug)]
pub(crate) struct PathTracer<'a> {
    bvh: &'a SceneBvh<'a>,
    settings: &'a Settings,
    emitters: &'a Emitters,
    unit: VectorUnit,
    shadow: ShadowRays<'a>,
    starts: Box<StartLanes>,
    /// Of each sample of the batch.
    points: Vec<SamplePoint>,
    rays: Vec<Ray>,
    states: Vec<PathState>,
    next_rays: Vec<Ray>,
    next_states: Vec<PathState>,
    hits: Vec<Option<Hit>>,
    groups: HitGroups,
    surfaces: Box<SurfaceLanes>,
    lanes: Box<ScatterLanes>,
    smooth: Box<SmoothLanes>,
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
            shadow: ShadowRays::new(bvh, settings.glass()),
            starts: Box::default(),
            points: Vec::new(),
            rays: Vec::new(),
            states: Vec::new(),
            next_rays: Vec::new(),
            next_states: Vec::new(),
            hits: Vec::new(),
            groups: HitGroups::default(),
            surfaces: Box::default(),
            lanes: Box::default(),
            smooth: Box::default(),
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
        self.points.clear();
        for (samples, slot) in samples.chunks(LANES).zip((0..).step_by(LANES)) {
            let (starts, seed) = (&mut *self.starts, self.settings.seed);
            self.unit.run(
                #[inline(always)]
                || starts.fill(frame, samples, count, seed),
            );
            self.points.extend(self.starts.points());
            self.starts.push(slot, &mut self.rays, &mut self.states);
        }
        while !self.rays.is_empty() {
            self.hits.clear();
            self.hits.resize(self.rays.len(), None);
            self.bvh.intersect(&self.rays, &mut self.hits);
            self.rays_traced += self.rays.len() as u64;
            let instances = self.bvh.scene().instances.len();
            self.groups.sort(&self.hits, instances);
            self.see_sky(radiance);
            self.scatter(radiance);
            self.light(radiance);
            std::mem::swap(&mut self.rays, &mut self.next_rays);
            std::mem::swap(&mut self.states, &mut self.next_states);
            self.next_rays.clear();
            self.next_states.clear();
        }
        for sample in radiance {
            if !is_light(sample.sum()) {
                *sample = SampleLight::default();
                self.bad_samples += 1;
            }
        }
    }

    /// The share of the sky's light that the path brings, where the rest comes from rays aimed at it.
    fn sky_share(&self, state: &PathState, dir: Vec3) -> f32 {
        if state.pdf == f32::INFINITY && !state.bent {
            return 1.0;
        }
        let aimed = self.emitters.sky_pdf(self.bvh.scene(), dir);
        match aimed > 0.0 {
            true if state.bent => 0.0,
            true => power_share(state.pdf, aimed),
            false => 1.0,
        }
    }

    fn see_sky(&self, radiance: &mut [SampleLight]) {
        let scene = self.bvh.scene();
        for i in self.groups.misses() {
            let (ray, state) = (&self.rays[i], &self.states[i]);
            let share = self.sky_share(state, ray.dir);
            let sky = state.weight * scene.sky(ray.dir) * share;
            radiance[state.slot as usize].add(state.depth, sky);
        }
    }

    /// Evaluates each surface, adds what it emits, and sends a ray to a light and one that goes on.
    fn scatter(&mut self, radiance: &mut [SampleLight]) {
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
                if self.settings.method == Method::Path {
                    if self.surfaces.scatter_plainly() {
                        self.scatter_lanes(members, radiance);
                        continue;
                    }
                    if self.surfaces.are_smooth() {
                        self.scatter_smooth(members, radiance);
                        continue;
                    }
                }
                for (lane, &(i, hit)) in members.iter().enumerate() {
                    self.scatter_one(i as usize, lane, &hit, radiance);
                }
            }
        }
        self.groups = groups;
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
