//! What surfaces of plain materials do to many paths at once: [`PathTracer::scatter_one`] in lanes.

use super::{
    PathTracer,
    scatter::shadow_ray,
    state::{
        DIRECTION_PAIR, LIGHT_PAIR, LOBE_PAIR, PLACE_PAIR, PathState, SURE_SURFACES, Unshadowed,
        power_share,
    },
};
use crate::{
    Scene,
    bsdf::Plain,
    emitters::{Emitters, LightLanes},
    hit_groups::NumberedHit,
    sample_light::SampleLight,
    sobol::SamplePoint,
    surface_lanes::SurfaceLanes,
};
use umbriel_kernels::{
    Interval, LANES, Lanes, Ray, Vec3Lanes,
    glam::{Vec2, Vec3},
    offset_origin, whole_vectors,
};

/// The buffers of a block of paths; its functions are to be called within [`VectorUnit::run`](umbriel_kernels::VectorUnit::run).
#[derive(Debug)]
pub(super) struct ScatterLanes {
    /// 0 for paths that end here.
    weight: Vec3Lanes,
    depth: [u32; LANES],
    numbers: Numbers,
    plain: PlainLanes,
    light: LightLanes,
    arriving: Arriving,
    onward: Onward,
}

/// Random numbers of each path.
#[derive(Debug)]
struct Numbers {
    index: [u32; LANES],
    key: [u32; LANES],
    first_pair: [u32; LANES],
    lobe: Lanes,
    direction: [Lanes; 2],
    choice: Lanes,
    survival: Lanes,
    place: [Lanes; 2],
}

/// A [`Plain`] a lane.
#[derive(Debug)]
struct PlainLanes {
    diffuse: Vec3Lanes,
    f0: Vec3Lanes,
    f90: Lanes,
    compensation: Vec3Lanes,
    alpha: Lanes,
    diffuse_share: Lanes,
}

/// Light that is reflected, should nothing stand between.
#[derive(Debug)]
struct Arriving {
    radiance: Vec3Lanes,
    origin: Vec3Lanes,
    dir: Vec3Lanes,
}

/// The rays that go on.
#[derive(Debug)]
struct Onward {
    /// 0 for paths that end.
    weight: Vec3Lanes,
    dir: Vec3Lanes,
    origin: Vec3Lanes,
    pdf: Lanes,
}

impl Default for ScatterLanes {
    fn default() -> Self {
        let (vectors, zeros) = (Vec3Lanes::default(), [0.0; LANES]);
        Self {
            weight: vectors.clone(),
            depth: [0; LANES],
            numbers: Numbers {
                index: [0; LANES],
                key: [0; LANES],
                first_pair: [0; LANES],
                lobe: zeros,
                direction: [zeros; 2],
                choice: zeros,
                survival: zeros,
                place: [zeros; 2],
            },
            plain: PlainLanes {
                diffuse: vectors.clone(),
                f0: vectors.clone(),
                f90: zeros,
                compensation: vectors.clone(),
                alpha: zeros,
                diffuse_share: zeros,
            },
            light: LightLanes::default(),
            arriving: Arriving {
                radiance: vectors.clone(),
                origin: vectors.clone(),
                dir: vectors.clone(),
            },
            onward: Onward {
                weight: vectors.clone(),
                dir: vectors.clone(),
                origin: vectors,
                pdf: zeros,
            },
        }
    }
}

impl Numbers {
    #[inline(always)]
    fn set(&mut self, i: usize, state: &PathState, point: SamplePoint) {
        (self.index[i], self.key[i]) = (point.index, point.key);
        self.first_pair[i] = state.first_pair();
    }

    #[inline(always)]
    fn draw(&mut self, len: usize) {
        for i in 0..whole_vectors(len) {
            let (index, key) = (self.index[i], self.key[i]);
            let (point, first) = (SamplePoint { index, key }, self.first_pair[i]);
            self.lobe[i] = point.pair(first + LOBE_PAIR).x;
            let direction = point.pair(first + DIRECTION_PAIR);
            (self.direction[0][i], self.direction[1][i]) = (direction.x, direction.y);
            let light = point.pair(first + LIGHT_PAIR);
            (self.choice[i], self.survival[i]) = (light.x, light.y);
            let place = point.pair(first + PLACE_PAIR);
            (self.place[0][i], self.place[1][i]) = (place.x, place.y);
        }
    }
}

impl PlainLanes {
    #[inline(always)]
    fn fill<const MATTE: bool>(&mut self, surfaces: &SurfaceLanes) {
        if MATTE {
            for i in 0..whole_vectors(surfaces.len) {
                self.diffuse.set(i, surfaces.get_base(i).bsdf.base_color);
            }
            return;
        }
        for i in 0..whole_vectors(surfaces.len) {
            let surface = surfaces.get_base(i);
            let plain = Plain::new(&surface.bsdf, surface.ns.dot(surface.wo));
            self.diffuse.set(i, plain.diffuse);
            self.f0.set(i, plain.f0);
            self.f90[i] = plain.f90;
            self.compensation.set(i, plain.compensation);
            self.alpha[i] = plain.alpha;
            self.diffuse_share[i] = plain.diffuse_share;
        }
    }

    /// The material of lane `i`; of one that has no lobe but the diffuse one if `MATTE`.
    #[inline(always)]
    fn get<const MATTE: bool>(&self, i: usize) -> Plain {
        if MATTE {
            return Plain::matte(self.diffuse.get(i));
        }
        Plain {
            diffuse: self.diffuse.get(i),
            f0: self.f0.get(i),
            f90: self.f90[i],
            compensation: self.compensation.get(i),
            alpha: self.alpha[i],
            diffuse_share: self.diffuse_share[i],
        }
    }
}

impl ScatterLanes {
    /// Takes up the paths `states`.
    #[inline(always)]
    fn load<'a>(
        &mut self,
        points: &[SamplePoint],
        states: impl Iterator<Item = (&'a PathState, Vec3)>,
        depth: u32,
    ) {
        for (i, (state, weight)) in states.enumerate().take(LANES) {
            let goes_on = u32::from(state.depth) < depth;
            self.weight
                .set(i, if goes_on { weight } else { Vec3::ZERO });
            self.depth[i] = u32::from(state.depth);
            self.numbers.set(i, state, points[state.slot as usize]);
        }
    }

    #[inline(always)]
    fn choose_lights(&mut self, emitters: &Emitters, scene: &Scene, surfaces: &SurfaceLanes) {
        let (choice, place) = (&self.numbers.choice, &self.numbers.place);
        emitters.sample_lanes(scene, surfaces, choice, place, &mut self.light);
    }

    #[inline(always)]
    fn scatter<const MATTE: bool>(&mut self, surfaces: &SurfaceLanes) {
        self.plain.fill::<MATTE>(surfaces);
        self.reflect::<MATTE>(surfaces);
        self.go_on::<MATTE>(surfaces);
    }

    /// What the surfaces reflect of the chosen lights, and the rays that ask for it.
    #[inline(always)]
    fn reflect<const MATTE: bool>(&mut self, surfaces: &SurfaceLanes) {
        for i in 0..whole_vectors(surfaces.len) {
            let (surface, plain) = (surfaces.get_base(i), self.plain.get::<MATTE>(i));
            let wi = self.light.wi.get(i);
            let f = plain.eval(surface.ns, surface.wo, wi);
            let density = plain.pdf(surface.ns, surface.wo, wi);
            let share = power_share(self.light.pdf[i], density);
            let share = if wi.dot(surface.ng) > 0.0 { share } else { 0.0 };
            let radiance = self.weight.get(i) * f * self.light.radiance.get(i) * share;
            self.arriving.radiance.set(i, radiance);
            let ray = shadow_ray(&surface, self.light.to_light.get(i), self.light.t_max[i]);
            self.arriving.origin.set(i, ray.origin);
            self.arriving.dir.set(i, ray.dir);
        }
    }

    /// The rays that go on.
    #[inline(always)]
    fn go_on<const MATTE: bool>(&mut self, surfaces: &SurfaceLanes) {
        for i in 0..whole_vectors(surfaces.len) {
            let (surface, plain) = (surfaces.get_base(i), self.plain.get::<MATTE>(i));
            let (ns, ng, wo) = (surface.ns, surface.ng, surface.wo);
            let numbers = &self.numbers;
            let u = Vec2::new(numbers.direction[0][i], numbers.direction[1][i]);
            let wi = plain.direction(ns, wo, numbers.lobe[i], u);
            let pdf = plain.pdf(ns, wo, wi);
            let scattered = self.weight.get(i) * (plain.eval(ns, wo, wi) / pdf);
            let most = scattered.max_element();
            let is_sure = self.depth[i] < u32::from(SURE_SURFACES);
            let survival = if is_sure { 1.0 } else { most.min(1.0) };
            let survives = pdf > 0.0
                && most > 0.0
                && most < f32::INFINITY
                && wi.dot(ng) > 0.0
                && ns.dot(wo) > 0.0
                && numbers.survival[i] < survival;
            let weight = scattered / survival;
            let onward = &mut self.onward;
            onward
                .weight
                .set(i, if survives { weight } else { Vec3::ZERO });
            onward.dir.set(i, wi);
            onward.pdf[i] = pdf;
            onward
                .origin
                .set(i, offset_origin(surface.p, surface.error, ng, wi));
        }
    }
}

impl PathTracer<'_> {
    /// [`PathTracer::scatter_one`] for the surfaces of plain, opaque materials that stand in lanes.
    pub(super) fn scatter_lanes(&mut self, members: &[NumberedHit], radiance: &mut [SampleLight]) {
        self.emit_lanes(members, radiance);
        if self.surfaces.are_black() {
            return;
        }
        let (scene, depth) = (self.bvh.scene(), self.settings.depth);
        let (lanes, surfaces, states) = (&mut *self.lanes, &*self.surfaces, &self.states);
        let points = &self.points[..];
        let states = members.iter().map(|(i, hit)| {
            let state = &states[*i as usize];
            (state, state.weight * state.absorption(scene, hit.t))
        });
        self.unit.run(
            #[inline(always)]
            || {
                lanes.load(points, states, depth);
                lanes.numbers.draw(surfaces.len);
                lanes.choose_lights(self.emitters, scene, surfaces);
                if surfaces.are_matte() {
                    lanes.scatter::<true>(surfaces);
                } else {
                    lanes.scatter::<false>(surfaces);
                }
            },
        );
        self.push_lanes(members);
    }

    /// What glowing surfaces send.
    pub(super) fn emit_lanes(&self, members: &[NumberedHit], radiance: &mut [SampleLight]) {
        if self.surfaces.are_dark() {
            return;
        }
        for (lane, (i, hit)) in members.iter().enumerate() {
            let state = &self.states[*i as usize];
            let surface = self.surfaces.get_base(lane);
            if surface.bsdf.emission != Vec3::ZERO {
                let share = self.emission_share(state, hit, surface.p);
                let weight = state.weight * state.absorption(self.bvh.scene(), hit.t);
                let emitted = weight * surface.bsdf.emission * share;
                radiance[state.slot as usize].add(state.depth, emitted);
            }
        }
    }

    /// Sends the shadow rays and the rays that go on.
    fn push_lanes(&mut self, members: &[NumberedHit]) {
        let lanes = &*self.lanes;
        for (lane, (i, _)) in members.iter().enumerate().take(LANES) {
            let state = &self.states[*i as usize];
            let radiance = lanes.arriving.radiance.get(lane);
            if radiance.max_element() > 0.0 {
                self.shadow_rays.push(Ray {
                    origin: lanes.arriving.origin.get(lane),
                    dir: lanes.arriving.dir.get(lane),
                    t: Interval {
                        min: 0.0,
                        max: lanes.light.t_max[lane],
                    },
                });
                self.unshadowed.push(Unshadowed {
                    slot: state.slot,
                    surfaces: state.depth + 1,
                    radiance,
                });
            }
            let weight = lanes.onward.weight.get(lane);
            if weight.max_element() > 0.0 {
                let ray = Ray::new(lanes.onward.origin.get(lane), lanes.onward.dir.get(lane));
                self.next_rays.push(ray);
                self.next_states.push(PathState {
                    weight,
                    depth: state.depth + 1,
                    bent: false,
                    pdf: lanes.onward.pdf[lane],
                    from: self.surfaces.p(lane),
                    from_normal: Some(self.surfaces.ns(lane)),
                    ..*state
                });
            }
        }
    }
}
