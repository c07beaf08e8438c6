//! Rays towards lights for many points at once.

use super::{ALMOST, Choice, Emitters, LightRay, shape::Emitter};
use crate::{
    Scene,
    light_sampling::{DirectionSample, sample_rectangle, sample_triangle},
    surface_lanes::SurfaceLanes,
};
use umbriel_kernels::{
    LANES, Lanes, Triangle, Vec3Lanes,
    glam::{Vec2, Vec3},
    whole_vectors,
};

/// A [`LightRay`] a lane; without radiance where there is none.
#[derive(Debug)]
pub(crate) struct LightLanes {
    pub(crate) wi: Vec3Lanes,
    pub(crate) to_light: Vec3Lanes,
    pub(crate) t_max: Lanes,
    pub(crate) radiance: Vec3Lanes,
    pub(crate) pdf: Lanes,
    rectangles: FlatLanes,
    triangles: FlatLanes,
}

/// Flat shapes that were chosen, packed: each with the lane that chose it.
#[derive(Debug)]
struct FlatLanes {
    len: usize,
    lane: [usize; LANES],
    p: Vec3Lanes,
    /// Centre and half edges of a rectangle, or the corners of a triangle.
    shape: [Vec3Lanes; 3],
    random: [Lanes; 2],
    /// By which the density of the direction is multiplied.
    probability: Lanes,
    wi: Vec3Lanes,
    distance: Lanes,
    pdf: Lanes,
}

impl Default for FlatLanes {
    fn default() -> Self {
        let zeros = [0.0; LANES];
        Self {
            len: 0,
            lane: [0; LANES],
            p: Vec3Lanes::default(),
            shape: Default::default(),
            random: [zeros; 2],
            probability: zeros,
            wi: Vec3Lanes::default(),
            distance: zeros,
            pdf: zeros,
        }
    }
}

impl FlatLanes {
    #[inline(always)]
    fn push(&mut self, lane: usize, p: Vec3, shape: [Vec3; 3], u: Vec2, probability: f32) {
        let k = self.len;
        self.lane[k] = lane;
        self.p.set(k, p);
        for (corner, own) in self.shape.iter_mut().zip(shape) {
            corner.set(k, own);
        }
        (self.random[0][k], self.random[1][k]) = (u.x, u.y);
        self.probability[k] = probability;
        self.len += 1;
    }

    /// Directions by the sampling function of the shape; a density of 0 where there is none.
    #[inline(always)]
    fn sample(&mut self, sample: impl Fn(Vec3, [Vec3; 3], Vec2) -> DirectionSample) {
        for k in 0..whole_vectors(self.len) {
            let shape = [
                self.shape[0].get(k),
                self.shape[1].get(k),
                self.shape[2].get(k),
            ];
            let u = Vec2::new(self.random[0][k], self.random[1][k]);
            let found = sample(self.p.get(k), shape, u);
            self.wi.set(k, found.wi);
            self.distance[k] = found.distance;
            self.pdf[k] = found.pdf * self.probability[k];
        }
    }
}

impl Default for LightLanes {
    fn default() -> Self {
        Self {
            wi: Vec3Lanes::default(),
            to_light: Vec3Lanes::default(),
            t_max: [1.0; LANES],
            radiance: Vec3Lanes::default(),
            pdf: [1.0; LANES],
            rectangles: FlatLanes::default(),
            triangles: FlatLanes::default(),
        }
    }
}

impl LightLanes {
    #[inline(always)]
    fn set(&mut self, i: usize, ray: &LightRay) {
        self.wi.set(i, ray.wi);
        self.to_light.set(i, ray.to_light);
        self.t_max[i] = ray.t_max;
        self.radiance.set(i, ray.radiance);
        self.pdf[i] = ray.pdf;
    }
}

impl Emitters {
    /// [`Emitters::sample`] for surfaces that take light on the side of their normals.
    #[inline(always)]
    pub(crate) fn sample_lanes(
        &self,
        scene: &Scene,
        surfaces: &SurfaceLanes,
        choice: &Lanes,
        place: &[Lanes; 2],
        light: &mut LightLanes,
    ) {
        (light.rectangles.len, light.triangles.len) = (0, 0);
        // Where each flat shape's emitter is in the list.
        let mut numbers = [0; LANES];
        for i in 0..surfaces.len.min(LANES) {
            light.radiance.set(i, Vec3::ZERO);
            let p = surfaces.p(i);
            let Some(chosen) = self.choose(p, Some(surfaces.ns(i)), choice[i]) else {
                continue;
            };
            let u = Vec2::new(place[0][i], place[1][i]);
            if let Choice::Placed(number) = chosen.light {
                numbers[i] = number;
                match self.placed[number as usize].emitter {
                    Emitter::Rectangle { center, u: a, v: b } => {
                        let shape = [center, a, b];
                        light.rectangles.push(i, p, shape, u, chosen.probability);
                        continue;
                    }
                    Emitter::Triangle(t) => {
                        let shape = [t.a, t.b, t.c];
                        light.triangles.push(i, p, shape, u, chosen.probability);
                        continue;
                    }
                    _ => {}
                }
            }
            if let Some(ray) = self.aim(scene, p, chosen, u) {
                light.set(i, &ray);
            }
        }
        light.rectangles.sample(
            #[inline(always)]
            |p, [center, u, v], random| sample_rectangle(p, center, u, v, random),
        );
        light.triangles.sample(
            #[inline(always)]
            |p, [a, b, c], random| sample_triangle(p, &Triangle { a, b, c }, random),
        );
        self.keep(scene, light, &numbers);
    }

    /// Takes the flat shapes' directions to the lanes that chose them.
    #[inline(always)]
    fn keep(&self, scene: &Scene, light: &mut LightLanes, numbers: &[u32; LANES]) {
        for flat in [&light.rectangles, &light.triangles] {
            for k in 0..flat.len.min(LANES) {
                let (i, pdf) = (flat.lane[k], flat.pdf[k]);
                if !(pdf > 0.0) {
                    continue;
                }
                let (wi, distance) = (flat.wi.get(k), flat.distance[k]);
                let placed = &self.placed[numbers[i] as usize];
                let radiance = placed.radiance(scene, flat.p.get(k) + wi * distance, -wi);
                light.wi.set(i, wi);
                light.to_light.set(i, wi * distance);
                light.t_max[i] = ALMOST;
                light.radiance.set(i, radiance / pdf);
                light.pdf[i] = pdf;
            }
        }
    }
}
