//! Rays towards lights for many points at once.

use super::{
    ALMOST, Choice, Chosen, Emitters, LightRay,
    flat::{FlatLanes, OTHER, RECTANGLE, TRIANGLE},
};
use crate::{
    Scene,
    light_sampling::{DirectionSample, sample_rectangle, sample_triangle},
    light_tree::LightChoices,
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
    distance: Lanes,
    choices: LightChoices,
    flat: FlatLanes,
    /// Lanes that chose what is not flat.
    others: Vec<(usize, Chosen)>,
}

impl Default for LightLanes {
    fn default() -> Self {
        Self {
            wi: Vec3Lanes::default(),
            to_light: Vec3Lanes::default(),
            t_max: [1.0; LANES],
            radiance: Vec3Lanes::default(),
            pdf: [1.0; LANES],
            distance: [1.0; LANES],
            choices: LightChoices::default(),
            flat: FlatLanes::default(),
            others: Vec::with_capacity(LANES),
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

    /// Directions in the lanes of one kind by its sampling function.
    #[expect(clippy::needless_range_loop, reason = "the plain loop runs in lanes")]
    #[inline(always)]
    fn sample(
        &mut self,
        kind: u32,
        surfaces: &SurfaceLanes,
        place: &[Lanes; 2],
        sample: impl Fn(Vec3, [Vec3; 3], Vec2) -> DirectionSample,
    ) {
        for i in 0..whole_vectors(surfaces.len) {
            let u = Vec2::new(place[0][i], place[1][i]);
            let found = sample(surfaces.p(i), self.flat.shape(i), u);
            let is_own = self.flat.kind[i] == kind;
            let pdf = found.pdf * self.choices.probability[i];
            let wi = self.wi.get(i);
            self.wi.set(i, if is_own { found.wi } else { wi });
            self.distance[i] = if is_own {
                found.distance
            } else {
                self.distance[i]
            };
            self.pdf[i] = if is_own { pdf } else { self.pdf[i] };
        }
    }

    /// What arrives from the flat lights.
    #[inline(always)]
    fn finish(&mut self, len: usize) {
        for i in 0..whole_vectors(len) {
            let (wi, pdf) = (self.wi.get(i), self.pdf[i]);
            let is_met = (pdf > 0.0) & (self.flat.kind[i] != OTHER);
            let radiance = self.flat.radiance(i, wi) / pdf;
            self.to_light.set(i, wi * self.distance[i]);
            self.t_max[i] = ALMOST;
            self.radiance
                .set(i, if is_met { radiance } else { Vec3::ZERO });
        }
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
        light.others.clear();
        if self.sky_share == 0.0 && self.parallel.is_empty() && self.tree.is_few() {
            self.choose_of_few(surfaces, choice, light);
        } else {
            self.choose_each(surfaces, choice, light);
        }
        if self.has_kind[RECTANGLE as usize] {
            light.sample(
                RECTANGLE,
                surfaces,
                place,
                #[inline(always)]
                |p, [center, u, v], random| sample_rectangle(p, center, u, v, random),
            );
        }
        if self.has_kind[TRIANGLE as usize] {
            light.sample(
                TRIANGLE,
                surfaces,
                place,
                #[inline(always)]
                |p, [a, b, c], random| sample_triangle(p, &Triangle { a, b, c }, random),
            );
        }
        light.finish(surfaces.len);
        if self.has_textures {
            self.look_up(scene, surfaces, light);
        }
        for k in 0..light.others.len() {
            let (i, chosen) = light.others[k];
            let u = Vec2::new(place[0][i], place[1][i]);
            if let Some(ray) = self.aim(scene, surfaces.p(i), chosen, u) {
                light.set(i, &ray);
            }
        }
    }

    /// Where all lights have a place and are a few.
    #[inline(always)]
    fn choose_of_few(&self, surfaces: &SurfaceLanes, choice: &Lanes, light: &mut LightLanes) {
        let (len, at) = (surfaces.len, surfaces.points_and_normals());
        self.tree.sample_lanes(len, at, choice, &mut light.choices);
        light.flat.select(len, &self.flat, &light.choices.number);
        if !self.has_kind[OTHER as usize] {
            return;
        }
        for i in 0..len.min(LANES) {
            let (number, probability) = (light.choices.number[i], light.choices.probability[i]);
            if light.flat.kind[i] == OTHER && probability > 0.0 {
                let chosen = Chosen {
                    light: Choice::Placed(number),
                    probability,
                };
                light.others.push((i, chosen));
            }
        }
    }

    /// Lane by lane.
    #[expect(clippy::needless_range_loop, reason = "the plain loop runs in lanes")]
    #[inline(always)]
    fn choose_each(&self, surfaces: &SurfaceLanes, choice: &Lanes, light: &mut LightLanes) {
        for i in 0..surfaces.len.min(LANES) {
            light.flat.kind[i] = OTHER;
            let chosen = self.choose(surfaces.p(i), Some(surfaces.ns(i)), choice[i]);
            match chosen {
                Some(Chosen {
                    light: Choice::Placed(number),
                    probability,
                }) if self.flat[number as usize].kind != OTHER => {
                    light.flat.set(i, &self.flat[number as usize]);
                    light.choices.number[i] = number;
                    light.choices.probability[i] = probability;
                }
                Some(chosen) => light.others.push((i, chosen)),
                None => {}
            }
        }
    }

    /// The radiance of flat lights with textures.
    fn look_up(&self, scene: &Scene, surfaces: &SurfaceLanes, light: &mut LightLanes) {
        for i in 0..surfaces.len.min(LANES) {
            let number = light.choices.number[i] as usize;
            if light.flat.kind[i] != OTHER && light.pdf[i] > 0.0 && self.flat[number].is_textured {
                let at = surfaces.p(i) + light.to_light.get(i);
                let radiance = self.placed[number].radiance(scene, at, -light.wi.get(i));
                light.radiance.set(i, radiance / light.pdf[i]);
            }
        }
    }
}

#[cfg(test)]
mod tests;
