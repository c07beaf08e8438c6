//! All that shines in a scene, and how a point chooses a ray towards it.

mod flat;
mod lanes;
mod radiance;
mod shape;

pub(crate) use lanes::LightLanes;

use crate::{AlphaMode, EnvironmentMap, Geometry, Instance, LightBounds, LightTree, Scene};
use flat::Flat;
use shape::{Emitter, emitter_box, light_bounds, light_ray, world_surface, world_triangle};
use std::f32::consts::PI;
use umbriel_kernels::glam::{Vec2, Vec3};

/// A ray towards a light that was chosen at random.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightRay {
    /// Unit direction towards the light.
    pub(crate) wi: Vec3,
    /// From the lit point to the light, or the unit direction where the light has no end.
    pub(crate) to_light: Vec3,
    /// Where the ray ends, in lengths of `to_light`; infinite where the light has no end.
    pub(crate) t_max: f32,
    /// Arriving radiance over the density of the direction and the probability of the light; for lights without extent the illuminance
    /// over the probability alone.
    pub(crate) radiance: Vec3,
    /// Density of the direction in 1/sr, by all that was chosen; infinite for point, spot and directional lights, of whatever extent, which no
    /// other way of sampling finds.
    pub(crate) pdf: f32,
}

/// Cosines of half of the angle of the cone of normals, of what shines on both sides and of what shines on one.
const BOTH_SIDES: f32 = -1.0;
const ONE_SIDE: f32 = 1.0;

/// Rays end before the light that they are aimed at: by more than rounding errors, and less than anything that could stand there.
const ALMOST: f32 = 1.0 - 1e-4;

#[derive(Clone, Copy, Debug)]
struct Placed {
    emitter: Emitter,
    /// Instance and primitive of what is no [`Light`](crate::Light), for which they are `u32::MAX` and 0.
    instance: u32,
    primitive: u32,
}

/// A light that was chosen.
#[derive(Clone, Copy, Debug)]
struct Chosen {
    light: Choice,
    probability: f32,
}

#[derive(Clone, Copy, Debug)]
enum Choice {
    /// A light without a place, by its position in [`Scene::lights`].
    Parallel(u32),
    /// By its position in [`Emitters::placed`].
    Placed(u32),
    /// The map around the scene.
    Sky,
}

/// The lights of a scene and its glowing surfaces.
#[derive(Debug, Default)]
pub(crate) struct Emitters {
    placed: Vec<Placed>,
    /// A row for each of `placed`.
    flat: Vec<Flat>,
    /// By kind, whether there is any such emitter.
    has_kind: [bool; 3],
    has_textures: bool,
    tree: LightTree,
    /// The probability with which the map around the scene is chosen.
    sky_share: f32,
    /// Lights without a place, by their position in [`Scene::lights`].
    parallel: Vec<u32>,
    /// The first of the emitters of each instance, which stand in the order of its primitives.
    first: Vec<Option<u32>>,
}

impl Emitters {
    /// Collects what shines. Glowing surfaces without a sampling formula of their own (cylinders, cones, tori, boxes, implicit surfaces, and
    /// scaled spheres and disks) are left to the rays that find them, as are those with holes.
    pub(crate) fn new(scene: &Scene) -> Self {
        let mut emitters = Self::default();
        let mut bounds = Vec::new();
        for (number, light) in (0..).zip(&scene.lights) {
            if light.is_dark() {
                continue;
            }
            match light_bounds(light) {
                Some(own) => {
                    bounds.push(own);
                    emitters.placed.push(Placed {
                        emitter: Emitter::Light(number),
                        instance: u32::MAX,
                        primitive: 0,
                    });
                }
                None => emitters.parallel.push(number),
            }
        }
        for (number, instance) in (0..).zip(&scene.instances) {
            let first = emitters.placed.len();
            emitters.add_instance(scene, number, instance, &mut bounds);
            let any = emitters.placed.len() > first;
            emitters.first.push(any.then_some(first as u32));
        }
        emitters.tree = LightTree::build(&bounds);
        emitters.tabulate(scene);
        let map = scene.environment_map.as_ref();
        if map.is_some_and(|map| !map.is_black()) {
            emitters.sky_share = if emitters.is_empty() { 1.0 } else { 0.5 };
        }
        emitters
    }

    fn tabulate(&mut self, scene: &Scene) {
        let flat = self.placed.iter().map(|placed| Flat::new(scene, placed));
        self.flat = flat.collect();
        for flat in &self.flat {
            self.has_kind[flat.kind as usize] = true;
            self.has_textures |= flat.is_textured;
        }
    }

    fn add_instance(
        &mut self,
        scene: &Scene,
        number: u32,
        instance: &Instance,
        bounds: &mut Vec<LightBounds>,
    ) {
        let material = &scene.materials[instance.material.index()];
        let power = material.emission.max_element();
        if !(power > 0.0) || material.unlit || material.alpha_mode != AlphaMode::Opaque {
            return;
        }
        let mut add = |primitive, (emitter, area, axis): (Emitter, f32, Vec3), cos_normals| {
            self.placed.push(Placed {
                emitter,
                instance: number,
                primitive,
            });
            bounds.push(LightBounds {
                aabb: emitter_box(&emitter),
                axis,
                cos_normals,
                // A triangle without area keeps its place in the order, and is never chosen by much.
                power: (power * area * PI).max(f32::MIN_POSITIVE),
            });
        };
        match instance.geometry {
            Geometry::Mesh(id) => {
                let is_double = material.shows_back();
                let sides = if is_double { BOTH_SIDES } else { ONE_SIDE };
                let mesh = &scene.meshes[id.index()];
                for i in 0..mesh.indices.len() {
                    add(i as u32, world_triangle(&mesh.triangle(i), instance), sides);
                }
            }
            Geometry::Surface(id) => {
                let surface = &scene.surfaces[id.index()];
                if let Some(found) = world_surface(surface, &instance.transform) {
                    add(0, found, BOTH_SIDES);
                }
            }
        }
    }

    /// Whether there is nothing to aim at.
    pub(crate) fn is_empty(&self) -> bool {
        self.placed.is_empty() && self.parallel.is_empty() && self.sky_share == 0.0
    }

    /// The share of the choices that goes to lights without a place.
    fn parallel_share(&self) -> f32 {
        let parallel = self.parallel.len() as f32;
        parallel / (parallel + if self.placed.is_empty() { 0.0 } else { 1.0 })
    }

    /// Chooses a ray from the point `p` towards a light. `n` is the normal of the side that takes light, `None` if both do; `choice` in
    /// `[0, 1)` chooses the light, `u` in `[0, 1)²` the place on it.
    pub(crate) fn sample(
        &self,
        scene: &Scene,
        p: Vec3,
        n: Option<Vec3>,
        choice: f32,
        u: Vec2,
    ) -> Option<LightRay> {
        self.aim(scene, p, self.choose(p, n, choice)?, u)
    }

    /// Chooses the light.
    #[inline(always)]
    fn choose(&self, p: Vec3, n: Option<Vec3>, choice: f32) -> Option<Chosen> {
        if choice < self.sky_share {
            return Some(Chosen {
                light: Choice::Sky,
                probability: self.sky_share,
            });
        }
        let rest = 1.0 - self.sky_share;
        let choice = rescale(choice - self.sky_share, rest);
        let share = self.parallel_share();
        if choice < share {
            let count = self.parallel.len();
            let number = self.parallel[((choice / share * count as f32) as usize).min(count - 1)];
            return Some(Chosen {
                light: Choice::Parallel(number),
                probability: rest * share / count as f32,
            });
        }
        let choice = rescale(choice - share, 1.0 - share);
        let (number, probability) = self.tree.sample(p, n, choice)?;
        Some(Chosen {
            light: Choice::Placed(number),
            probability: probability * (rest * (1.0 - share)),
        })
    }

    /// Chooses a ray towards the chosen light.
    fn aim(&self, scene: &Scene, p: Vec3, chosen: Chosen, u: Vec2) -> Option<LightRay> {
        let probability = chosen.probability;
        let placed = match chosen.light {
            Choice::Parallel(number) => {
                return light_ray(&scene.lights[number as usize], p, probability, u);
            }
            Choice::Placed(number) => &self.placed[number as usize],
            Choice::Sky => return sky_ray(scene.environment_map.as_ref()?, probability, u),
        };
        if let Emitter::Light(number) = placed.emitter {
            return light_ray(&scene.lights[number as usize], p, probability, u);
        }
        let found = placed.emitter.sample(p, u);
        let pdf = found.pdf * probability;
        if !(pdf > 0.0) {
            return None;
        }
        let radiance = placed.radiance(scene, p + found.wi * found.distance, -found.wi);
        Some(LightRay {
            wi: found.wi,
            to_light: found.wi * found.distance,
            t_max: ALMOST,
            radiance: radiance / pdf,
            pdf,
        })
    }

    /// The density in 1/sr with which [`Emitters::sample`] chooses the direction of `to_light`, from `p` to a point of a primitive; 0 if
    /// it never does.
    pub(crate) fn pdf(
        &self,
        instance: u32,
        primitive: u32,
        p: Vec3,
        n: Option<Vec3>,
        to_light: Vec3,
    ) -> f32 {
        let Some(first) = self.first[instance as usize] else {
            return 0.0;
        };
        let number = first + primitive;
        let density = self.placed[number as usize].emitter.pdf(p, to_light);
        if density == 0.0 {
            return 0.0;
        }
        let choice = self.tree.probability(p, n, number);
        density * choice * ((1.0 - self.sky_share) * (1.0 - self.parallel_share()))
    }

    /// The density in 1/sr with which [`Emitters::sample`] chooses the unit direction `dir` for the map around the scene.
    pub(crate) fn sky_pdf(&self, scene: &Scene, dir: Vec3) -> f32 {
        let map = scene.environment_map.as_ref();
        self.sky_share * map.map_or(0.0, |map| map.pdf(dir))
    }
}

/// A random number in `[0, whole)` as one in `[0, 1)`, whatever rounding makes of it.
#[inline(always)]
fn rescale(number: f32, whole: f32) -> f32 {
    (number / whole).clamp(0.0, 1.0 - f32::EPSILON)
}

fn sky_ray(map: &EnvironmentMap, probability: f32, u: Vec2) -> Option<LightRay> {
    let (wi, density) = map.sample(u)?;
    let pdf = density * probability;
    Some(LightRay {
        wi,
        to_light: wi,
        t_max: f32::INFINITY,
        radiance: map.radiance(wi) / pdf,
        pdf,
    })
}

#[cfg(test)]
mod tests;
