//! What mirrors and clear glass do to many paths at once: [`PathTracer::scatter_one`] in lanes.

use super::{
    PathTracer,
    state::{LIGHT_PAIR, LOBE_PAIR, PathState, SURE_SURFACES},
};
use crate::{
    Bsdf, bsdf::Smooth, hit_groups::NumberedHit, sample_light::SampleLight, sobol::SamplePoint,
    surface_lanes::SurfaceLanes,
};
use umbriel_kernels::{LANES, Lanes, Ray, Vec3Lanes, glam::Vec3, offset_origin, whole_vectors};

/// The buffers of a block of paths.
#[derive(Debug)]
pub(super) struct SmoothLanes {
    index: [u32; LANES],
    key: [u32; LANES],
    first_pair: [u32; LANES],
    depth: [u32; LANES],
    /// 0 for paths that end.
    weight: Vec3Lanes,
    lobe: Lanes,
    survival: Lanes,
    dir: Vec3Lanes,
    origin: Vec3Lanes,
    transmitted: [u32; LANES],
}

impl Default for SmoothLanes {
    fn default() -> Self {
        let (vectors, zeros) = (Vec3Lanes::default(), [0; LANES]);
        Self {
            index: zeros,
            key: zeros,
            first_pair: zeros,
            depth: zeros,
            weight: vectors.clone(),
            lobe: [0.0; LANES],
            survival: [0.0; LANES],
            dir: vectors.clone(),
            origin: vectors,
            transmitted: zeros,
        }
    }
}

impl SmoothLanes {
    #[inline(always)]
    fn load<'a>(
        &mut self,
        points: &[SamplePoint],
        states: impl Iterator<Item = (&'a PathState, Vec3)>,
    ) {
        for (i, (state, weight)) in states.enumerate().take(LANES) {
            let point = points[state.slot as usize];
            (self.index[i], self.key[i]) = (point.index, point.key);
            self.first_pair[i] = state.first_pair();
            self.depth[i] = u32::from(state.depth);
            self.weight.set(i, weight);
        }
    }

    #[inline(always)]
    fn draw(&mut self, len: usize) {
        for i in 0..whole_vectors(len) {
            let (index, key) = (self.index[i], self.key[i]);
            let (point, first) = (SamplePoint { index, key }, self.first_pair[i]);
            self.lobe[i] = point.pair(first + LOBE_PAIR).x;
            self.survival[i] = point.pair(first + LIGHT_PAIR).y;
        }
    }

    /// The rays that go on; `depth` surfaces scatter at most. `bsdf` is all lanes', but for its `eta`.
    #[inline(always)]
    fn go_on(&mut self, surfaces: &SurfaceLanes, bsdf: &Bsdf, depth: u32) {
        for i in 0..whole_vectors(surfaces.len) {
            let surface = surfaces.get_base(i);
            let (ns, ng, wo) = (surface.ns, surface.ng, surface.wo);
            let bsdf = Bsdf {
                eta: surface.bsdf.eta,
                ..*bsdf
            };
            let smooth = Smooth::new(&bsdf, ns.dot(wo));
            let found = smooth.sample(&bsdf, ns, wo, self.lobe[i]);
            let scattered = self.weight.get(i) * found.weight;
            let most = scattered.max_element();
            let is_sure = self.depth[i] < u32::from(SURE_SURFACES);
            let survival = if is_sure { 1.0 } else { most.min(1.0) };
            let survives = (self.depth[i] < depth)
                & (most > 0.0)
                & (found.transmitted != (found.wi.dot(ng) > 0.0))
                & (self.survival[i] < survival);
            let weight = scattered / survival;
            self.weight
                .set(i, if survives { weight } else { Vec3::ZERO });
            self.transmitted[i] = u32::from(found.transmitted);
            self.dir.set(i, found.wi);
            let origin = offset_origin(surface.p, surface.error, ng, found.wi);
            self.origin.set(i, origin);
        }
    }
}

impl PathTracer<'_> {
    /// [`PathTracer::scatter_one`] for smooth surfaces of one material that stand in lanes.
    pub(super) fn scatter_smooth(&mut self, members: &[NumberedHit], radiance: &mut [SampleLight]) {
        self.emit_lanes(members, radiance);
        let Some(bsdf) = self.surfaces.uniform else {
            return;
        };
        let bsdf = Bsdf {
            layers: None,
            ..bsdf
        };
        let (scene, depth) = (self.bvh.scene(), self.settings.depth);
        let (lanes, surfaces, states) = (&mut *self.smooth, &*self.surfaces, &self.states);
        let points = &self.points[..];
        let states = members.iter().map(|(i, hit)| {
            let state = &states[*i as usize];
            (state, state.weight * state.absorption(scene, hit.t))
        });
        self.unit.run(
            #[inline(always)]
            || {
                lanes.load(points, states);
                lanes.draw(surfaces.len);
                lanes.go_on(surfaces, &bsdf, depth);
            },
        );
        self.push_smooth(members, &bsdf);
    }

    /// Sends the rays that go on.
    fn push_smooth(&mut self, members: &[NumberedHit], bsdf: &Bsdf) {
        let instances = &self.bvh.scene().instances;
        for (lane, (i, hit)) in members.iter().enumerate().take(LANES) {
            let weight = self.smooth.weight.get(lane);
            if !(weight.max_element() > 0.0) {
                continue;
            }
            let state = self.states[*i as usize];
            let medium = if self.smooth.transmitted[lane] == 1 {
                let material = instances[hit.instance as usize].material;
                self.surfaces.medium_behind(lane, material, state.medium)
            } else {
                state.medium
            };
            let (origin, dir) = (self.smooth.origin.get(lane), self.smooth.dir.get(lane));
            self.next_rays.push(Ray::new(origin, dir));
            self.next_states.push(PathState {
                weight,
                depth: state.depth + 1,
                medium,
                bent: self.is_bent(&state, bsdf),
                pdf: f32::INFINITY,
                from: self.surfaces.p(lane),
                from_normal: (bsdf.transmission == 0.0).then_some(self.surfaces.ns(lane)),
                ..state
            });
        }
    }
}
