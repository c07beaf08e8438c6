//! The queue of weighted rays: the loop that all ray methods share.

use crate::{
    CameraFrame, Light, Method, SceneBvh, Settings, ShadowMaps, ShadowRays, Unshadowed,
    color::Developer,
    direct::DirectLight,
    eye_lanes::{EyeLanes, Patch, SeenMesh},
    eye_raster::EyeRaster,
    film::is_light,
    hit_groups::HitGroups,
    ray_queue::{Onward, Queue, RayState},
    shade_block::ShadeBlock,
    shadow_map::MapVisibility,
};
use umbriel_kernels::{
    Hit, LANES, Ray, Vec3Lanes, VectorUnit,
    glam::{Vec2, Vec3},
};

/// Traces batches of eye rays; keeps its buffers between batches.
#[derive(Debug)]
pub(crate) struct Tracer<'a> {
    bvh: &'a SceneBvh<'a>,
    settings: &'a Settings,
    unit: VectorUnit,
    shadow_rays: ShadowRays<'a>,
    maps: Option<MapVisibility<'a>>,
    direct: DirectLight,
    queue: Queue,
    next: Queue,
    onward: Onward,
    hits: Vec<Option<Hit>>,
    groups: HitGroups,
    block: Box<ShadeBlock>,
    eye: Box<EyeLanes>,
    /// Eye, mirrored and refracted rays so far.
    pub(crate) rays: u64,
    /// Samples that were not finite and count as black.
    pub(crate) bad_samples: u64,
}

impl<'a> Tracer<'a> {
    /// `maps` answer the second question of [`Method::ShadowMap`].
    pub(crate) fn new(
        bvh: &'a SceneBvh<'a>,
        settings: &'a Settings,
        maps: Option<&'a ShadowMaps>,
    ) -> Self {
        let unit = bvh.unit();
        Self {
            bvh,
            settings,
            unit,
            shadow_rays: ShadowRays::new(bvh, settings.glass()),
            maps: maps
                .filter(|_| settings.shadows)
                .map(|maps| MapVisibility::new(maps, unit)),
            direct: DirectLight::default(),
            queue: Queue::default(),
            next: Queue::default(),
            onward: Onward::default(),
            hits: Vec::new(),
            groups: HitGroups::default(),
            block: Box::default(),
            eye: Box::default(),
            rays: 0,
            bad_samples: 0,
        }
    }

    /// Number of visibility questions asked so far.
    pub(crate) fn shadow_rays(&self) -> u64 {
        self.direct.shadow_rays
    }

    /// The radiance that the camera sees at each of `places` in the picture, in nit. `radiance` is as long as `places`.
    ///
    /// Contributions are added in an order that is the sample's own: it depends neither on the rest of the batch nor on how that is run.
    pub(crate) fn trace(&mut self, frame: &CameraFrame, places: &[Vec2], radiance: &mut [Vec3]) {
        radiance.fill(Vec3::ZERO);
        self.queue.clear();
        for places in places.chunks(LANES) {
            self.unit.run(
                #[inline(always)]
                || self.queue.push_eye_rays(frame, places),
            );
        }
        self.intersect();
        self.follow(radiance);
    }

    /// The radiance along eye rays of which it is known what they see. All slices have one length.
    pub(crate) fn trace_seen(&mut self, rays: &[Ray], hits: &[Option<Hit>], radiance: &mut [Vec3]) {
        radiance.fill(Vec3::ZERO);
        self.queue.clear();
        self.queue.rays.extend_from_slice(rays);
        self.queue.states.resize(rays.len(), RayState::EYE);
        for (number, state) in (0..).zip(&mut self.queue.states) {
            state.sample = number;
        }
        self.hits.clear();
        self.hits.extend_from_slice(hits);
        self.follow(radiance);
    }

    /// Shades what the queued rays hit, and follows the rays that go on from it.
    fn follow(&mut self, radiance: &mut [Vec3]) {
        loop {
            self.see_sky(radiance);
            self.next.clear();
            self.shade(radiance);
            self.light(radiance);
            std::mem::swap(&mut self.queue, &mut self.next);
            if self.queue.rays.is_empty() {
                break;
            }
            self.intersect();
        }
        self.drop_bad(radiance);
    }

    /// Step 1: what does each ray hit?
    fn intersect(&mut self) {
        self.hits.resize(self.queue.rays.len(), None);
        self.bvh.intersect(&self.queue.rays, &mut self.hits);
        self.rays += self.queue.rays.len() as u64;
    }

    /// Rays that hit nothing see the sky.
    fn see_sky(&self, radiance: &mut [Vec3]) {
        let scene = self.bvh.scene();
        let rays = self.queue.rays.iter().zip(&self.queue.states);
        for ((ray, state), hit) in rays.zip(&self.hits) {
            if hit.is_none() {
                radiance[state.sample as usize] += state.weight * scene.sky(ray.dir);
            }
        }
    }

    /// Steps 2 and 4: evaluate each surface, add what it emits, take down its direct light, and push the rays that
    /// go on from it. The hits of one instance are shaded together.
    fn shade(&mut self, radiance: &mut [Vec3]) {
        let instances = self.bvh.scene().instances.len();
        // Where a sample may have many rays, its sum has an order that only a batch can keep.
        let at_once = match self.settings.method {
            Method::ShadowMap => true,
            Method::RayCast => !self.settings.shadows,
            Method::Whitted | Method::Path | Method::Distributed => false,
        };
        let lights = &self.bvh.scene().lights;
        self.groups.sort(&self.hits, instances);
        for (instance, members) in self.groups.iter() {
            for members in members.chunks(LANES) {
                self.unit.run(
                    #[inline(always)]
                    || {
                        let block = &mut *self.block;
                        block.evaluate(self.bvh, &self.queue, instance, members);
                        block.pass(members, &self.queue, &mut self.onward.passed);
                        let goes_on = block.shade(
                            self.bvh.scene(),
                            self.settings,
                            #[inline(always)]
                            |seen, own, len| seen.add(own, len, radiance),
                        );
                        if !goes_on {
                            return;
                        }
                        let material = self.bvh.scene().instances[instance as usize].material;
                        block.push(
                            self.settings,
                            material,
                            members,
                            &self.queue,
                            &mut self.onward,
                        );
                        if at_once {
                            light_now(
                                lights,
                                block,
                                &mut self.maps,
                                &mut self.direct,
                                #[inline(always)]
                                |arriving| block.seen.add(arriving, block.surfaces.len, radiance),
                            );
                        } else {
                            self.direct
                                .add(instance, lights, &block.surfaces, &block.seen);
                        }
                    },
                );
            }
            self.onward.leave(&mut self.next);
        }
    }

    /// The radiance of the pixels of a plain patch, see [`EyeRaster::is_plain`]: what [`Tracer::trace_seen`] gives, to the bit, under
    /// [`Method::ShadowMap`].
    pub(crate) fn trace_patch(&mut self, eye: &EyeRaster, patch: &Patch) {
        let unit = self.unit;
        unit.run(
            #[inline(always)]
            || self.eye.aim(patch),
        );
        let mut covered = 0;
        eye.for_meshes(unit, patch.ids, |mesh| {
            covered |= self.shade_mesh(patch, mesh);
        });
        self.bad_samples += unit.run(
            #[inline(always)]
            || {
                if covered != u64::MAX {
                    self.eye.see_sky(self.bvh.scene(), !covered);
                }
                self.eye.drop_bad(patch)
            },
        );
    }

    /// Shades the pixels of a patch that see a mesh; gives their lanes, the first one in the lowest bit.
    fn shade_mesh(&mut self, patch: &Patch, mesh: &SeenMesh) -> u64 {
        let met = self.eye.meet(self.unit, patch, mesh, &mut self.block);
        if met == 0 {
            return 0;
        }
        self.unit.run(
            #[inline(always)]
            || {
                let (scene, block) = (self.bvh.scene(), &mut *self.block);
                let (surfaces, sum) = (&mut block.surfaces, &mut self.eye.sum);
                surfaces.fill_met(self.bvh, mesh.instance, mesh.mesh, &self.eye.dir);
                block.see(met);
                *sum = Vec3Lanes::default();
                let is_lit = block.shade(
                    scene,
                    self.settings,
                    #[inline(always)]
                    |_, own, _| add_lanes(sum, own),
                );
                if is_lit {
                    light_now(
                        &scene.lights,
                        block,
                        &mut self.maps,
                        &mut self.direct,
                        #[inline(always)]
                        |arriving| add_lanes(sum, arriving),
                    );
                }
                self.eye.take(met);
            },
        );
        met
    }

    /// Adds what [`Tracer::trace_patch`] found to rows of pixels, see [`EyeLanes::write`].
    pub(crate) fn write_patch<'p>(
        &self,
        is_first: bool,
        rows: impl Iterator<Item = &'p mut [[f32; 4]]>,
    ) {
        self.unit.run(
            #[inline(always)]
            || self.eye.write(is_first, rows),
        );
    }

    /// Develops what [`Tracer::trace_patch`] found into rows of pixels, see [`EyeLanes::develop`].
    pub(crate) fn develop_patch<'p>(
        &mut self,
        developer: &Developer,
        rows: impl Iterator<Item = &'p mut [[u8; 4]]>,
    ) {
        self.unit.run(
            #[inline(always)]
            || self.eye.develop(developer, rows),
        );
    }

    /// The vector unit that it runs on.
    pub(crate) fn unit(&self) -> VectorUnit {
        self.unit
    }

    fn drop_bad(&mut self, radiance: &mut [Vec3]) {
        for sample in radiance {
            if !is_light(*sample) {
                *sample = Vec3::ZERO;
                self.bad_samples += 1;
            }
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

/// Calls `add` with the direct light of a block, light by light, without a queue of questions.
#[inline(always)]
fn light_now(
    lights: &[Light],
    block: &ShadeBlock,
    maps: &mut Option<MapVisibility>,
    direct: &mut DirectLight,
    add: impl FnMut(&Vec3Lanes),
) {
    let (surfaces, seen) = (&block.surfaces, &block.seen);
    if let Some(maps) = maps {
        direct.add_now(lights, surfaces, seen, maps, add);
    } else {
        direct.add_now(lights, surfaces, seen, &mut Unshadowed, add);
    }
}

#[inline(always)]
fn add_lanes(sum: &mut Vec3Lanes, lanes: &Vec3Lanes) {
    for i in 0..LANES {
        sum.set(i, sum.get(i) + lanes.get(i));
    }
}
