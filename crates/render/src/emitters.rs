//! All that shines in a scene, and how a point chooses a ray towards it.

use crate::{
    AlphaMode, Geometry, Instance, Light, LightBounds, LightTree, Scene,
    light_sampling::{
        DirectionSample, pdf_disk, pdf_rectangle, pdf_sphere, pdf_triangle, sample_disk,
        sample_rectangle, sample_sphere, sample_triangle,
    },
    mesh_point::mesh_uvs,
};
use std::f32::consts::{FRAC_PI_2, PI, TAU};
use umbriel_kernels::{
    Aabb, Surface, Triangle,
    glam::{Affine3A, Vec2, Vec3},
};

/// A ray towards a light that was chosen at random.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightRay {
    /// Unit direction towards the light.
    pub(crate) wi: Vec3,
    /// From the lit point to the light, or the unit direction where the light has no end.
    pub(crate) to_light: Vec3,
    /// Where the ray ends, in lengths of `to_light`; infinite where the light has no end.
    pub(crate) t_max: f32,
    /// Arriving radiance over the density of the direction, or the illuminance over the probability for lights without extent.
    pub(crate) radiance: Vec3,
    /// Density of the direction in 1/sr, by all that was chosen; infinite for lights without extent.
    pub(crate) pdf: f32,
}

/// Rays end before the light that they are aimed at: by more than rounding errors, and less than anything that could stand there.
const ALMOST: f32 = 1.0 - 1e-4;

/// Something that shines from one place.
#[derive(Clone, Copy, Debug)]
enum Emitter {
    /// A light without extent, by its position in [`Scene::lights`].
    Light(u32),
    Sphere {
        center: Vec3,
        radius: f32,
    },
    Rectangle {
        center: Vec3,
        u: Vec3,
        v: Vec3,
    },
    Disk {
        center: Vec3,
        normal: Vec3,
        radius: f32,
    },
    Triangle(Triangle),
}

#[derive(Clone, Copy, Debug)]
struct Placed {
    emitter: Emitter,
    /// Instance and primitive of what is no [`Light`].
    instance: u32,
    primitive: u32,
}

/// The lights of a scene and its glowing surfaces.
#[derive(Debug, Default)]
pub(crate) struct Emitters {
    placed: Vec<Placed>,
    tree: LightTree,
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
        emitters
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
        let mut add = |emitter: Emitter, primitive, area: f32, axis: Vec3, cone, aabb| {
            self.placed.push(Placed {
                emitter,
                instance: number,
                primitive,
            });
            bounds.push(LightBounds {
                aabb,
                axis,
                normals: cone,
                emission: FRAC_PI_2,
                // A triangle without area keeps its place in the order, and is never chosen by much.
                power: (power * area * PI).max(f32::MIN_POSITIVE),
            });
        };
        match instance.geometry {
            Geometry::Mesh(id) => {
                let mesh = &scene.meshes[id.index()];
                for i in 0..mesh.indices.len() {
                    let t = world_triangle(&mesh.triangle(i), &instance.transform);
                    let cross = (t.b - t.a).cross(t.c - t.a);
                    // Glass and double-sided meshes shine on both sides; the tree takes all for such.
                    let normal = cross.normalize_or(Vec3::Z);
                    let aabb = Aabb {
                        min: t.a.min(t.b).min(t.c),
                        max: t.a.max(t.b).max(t.c),
                    };
                    let area = 0.5 * cross.length();
                    add(Emitter::Triangle(t), i as u32, area, normal, PI, aabb);
                }
            }
            Geometry::Surface(id) => {
                let surface = &scene.surfaces[id.index()];
                if let Some((emitter, area, axis)) = world_surface(surface, &instance.transform) {
                    let aabb = emitter_box(&emitter);
                    add(emitter, 0, area, axis, PI, aabb);
                }
            }
        }
    }

    /// Whether there is nothing to aim at.
    pub(crate) fn is_empty(&self) -> bool {
        self.placed.is_empty() && self.parallel.is_empty()
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
        let share = self.parallel_share();
        if choice < share {
            let count = self.parallel.len();
            let number = self.parallel[((choice / share * count as f32) as usize).min(count - 1)];
            return light_ray(&scene.lights[number as usize], p, share / count as f32);
        }
        let choice = ((choice - share) / (1.0 - share)).clamp(0.0, 1.0 - f32::EPSILON);
        let (chosen, probability) = self.tree.sample(p, n, choice)?;
        let placed = &self.placed[chosen as usize];
        let probability = probability * (1.0 - share);
        if let Emitter::Light(number) = placed.emitter {
            return light_ray(&scene.lights[number as usize], p, probability);
        }
        let found = placed.emitter.sample(p, u)?;
        let pdf = found.pdf * probability;
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
        density * choice * (1.0 - self.parallel_share())
    }
}

impl Placed {
    /// The radiance that the surface sends from `at` into the direction `wo`.
    fn radiance(&self, scene: &Scene, at: Vec3, wo: Vec3) -> Vec3 {
        let instance = &scene.instances[self.instance as usize];
        let material = &scene.materials[instance.material.index()];
        if let Emitter::Triangle(t) = &self.emitter
            && !material.shows_back()
        {
            let outwards = if instance.inside_out { -1.0 } else { 1.0 };
            // The order of the corners turns with a mirroring transform.
            let turned = instance.transform.matrix3.determinant().signum();
            if (t.b - t.a).cross(t.c - t.a).dot(wo) * outwards * turned <= 0.0 {
                return Vec3::ZERO;
            }
        }
        let Some(texture) = &material.emission_texture else {
            return material.emission;
        };
        let uvs = self.uvs(scene, instance, at);
        let uv = texture
            .transform
            .transform_point2(uvs[usize::from(texture.uv_set & 1)]);
        material.emission * scene.textures[texture.texture.index()].eval(uv).truncate()
    }

    /// Texture coordinates at a world point of the primitive.
    fn uvs(&self, scene: &Scene, instance: &Instance, at: Vec3) -> [Vec2; 2] {
        match (instance.geometry, &self.emitter) {
            (Geometry::Mesh(id), Emitter::Triangle(t)) => {
                let mesh = &scene.meshes[id.index()];
                let corners = mesh.indices[self.primitive as usize].map(|i| i as usize);
                mesh_uvs(mesh, corners, weights_at(t, at))
            }
            (Geometry::Surface(id), _) => {
                let local = instance.transform.inverse().transform_point3(at);
                let uv = scene.surfaces[id.index()].point_at(0, local).uv;
                [crate::surface::image_uv(uv); 2]
            }
            _ => [Vec2::ZERO; 2],
        }
    }
}

impl Emitter {
    fn sample(&self, p: Vec3, u: Vec2) -> Option<DirectionSample> {
        match self {
            Self::Light(_) => None,
            Self::Sphere { center, radius } => Some(sample_sphere(p, *center, *radius, u)),
            Self::Rectangle { center, u: a, v: b } => sample_rectangle(p, *center, *a, *b, u),
            Self::Disk {
                center,
                normal,
                radius,
            } => sample_disk(p, *center, *normal, *radius, u),
            Self::Triangle(triangle) => sample_triangle(p, triangle, u),
        }
    }

    fn pdf(&self, p: Vec3, to_light: Vec3) -> f32 {
        match self {
            Self::Light(_) => 0.0,
            Self::Sphere { center, radius } => pdf_sphere(p, *center, *radius),
            Self::Rectangle { center, u, v } => pdf_rectangle(p, *center, *u, *v, to_light),
            Self::Disk { normal, radius, .. } => pdf_disk(to_light, *normal, *radius),
            Self::Triangle(triangle) => pdf_triangle(p, triangle, to_light),
        }
    }
}

/// Where a light without extent is and how much it gives; `None` for parallel light.
fn light_bounds(light: &Light) -> Option<LightBounds> {
    let at = |position: Vec3, intensity: Vec3, axis, normals, emission, sphere: f32| LightBounds {
        aabb: Aabb {
            min: position,
            max: position,
        },
        axis,
        normals,
        emission,
        power: (intensity.max_element() * sphere).max(f32::MIN_POSITIVE),
    };
    match light {
        Light::Point(l) => Some(at(
            l.position,
            l.intensity,
            Vec3::Z,
            PI,
            FRAC_PI_2,
            2.0 * TAU,
        )),
        Light::Spot(l) => {
            let cap = TAU * (1.0 - l.outer_angle.cos());
            Some(at(
                l.position,
                l.intensity,
                l.direction,
                l.outer_angle,
                FRAC_PI_2,
                cap,
            ))
        }
        Light::Directional(_) => None,
    }
}

fn light_ray(light: &Light, p: Vec3, probability: f32) -> Option<LightRay> {
    light.sample(p).map(|sample| LightRay {
        wi: sample.wi,
        to_light: sample.to_light,
        t_max: sample.t_max,
        radiance: sample.illuminance / probability,
        pdf: f32::INFINITY,
    })
}

fn world_triangle(t: &Triangle, transform: &Affine3A) -> Triangle {
    let [a, b, c] = [t.a, t.b, t.c].map(|p| transform.transform_point3(p));
    Triangle { a, b, c }
}

/// A surface in the world, its area and its normal; `None` for those without a sampling formula.
fn world_surface(surface: &Surface, transform: &Affine3A) -> Option<(Emitter, f32, Vec3)> {
    let point = |p: Vec3| transform.transform_point3(p);
    let vector = |v: Vec3| transform.transform_vector3(v);
    match surface {
        Surface::Sphere(s) => {
            let scale = uniform_scale(transform)?;
            let radius = s.radius * scale;
            let emitter = Emitter::Sphere {
                center: point(s.center),
                radius,
            };
            Some((emitter, 2.0 * TAU * radius * radius, Vec3::Z))
        }
        Surface::Rectangle(s) => {
            let (u, v) = (vector(s.u), vector(s.v));
            // A sheared rectangle is none.
            if u.dot(v).abs() > 1e-5 * u.length() * v.length() {
                return None;
            }
            let emitter = Emitter::Rectangle {
                center: point(s.center),
                u,
                v,
            };
            Some((
                emitter,
                4.0 * u.length() * v.length(),
                u.cross(v).normalize_or(Vec3::Z),
            ))
        }
        Surface::Disk(s) => {
            let radius = s.radius * uniform_scale(transform)?;
            let normal = vector(s.normal).normalize_or(Vec3::Z);
            let emitter = Emitter::Disk {
                center: point(s.center),
                normal,
                radius,
            };
            Some((emitter, PI * radius * radius, normal))
        }
        _ => None,
    }
}

/// The factor of a transform that keeps shapes, of either hand; `None` for any other.
fn uniform_scale(transform: &Affine3A) -> Option<f32> {
    let columns = [
        transform.matrix3.x_axis,
        transform.matrix3.y_axis,
        transform.matrix3.z_axis,
    ];
    let scale = columns[0].length();
    let even = columns
        .iter()
        .all(|c| (c.length() / scale - 1.0).abs() < 1e-5);
    let square = (0..3).all(|i| columns[i].dot(columns[(i + 1) % 3]).abs() < 1e-5 * scale * scale);
    (even && square).then_some(scale)
}

fn emitter_box(emitter: &Emitter) -> Aabb {
    let around = |center: Vec3, reach: Vec3| Aabb {
        min: center - reach,
        max: center + reach,
    };
    match *emitter {
        Emitter::Sphere { center, radius } | Emitter::Disk { center, radius, .. } => {
            around(center, Vec3::splat(radius))
        }
        Emitter::Rectangle { center, u, v } => around(center, u.abs() + v.abs()),
        Emitter::Light(_) | Emitter::Triangle(_) => around(Vec3::ZERO, Vec3::ZERO),
    }
}

/// The weights of the corners at a point of a triangle.
fn weights_at(t: &Triangle, at: Vec3) -> [f32; 3] {
    let n = (t.b - t.a).cross(t.c - t.a);
    let whole = n.length_squared().max(f32::MIN_POSITIVE);
    let v = (t.c - t.b).cross(at - t.b).dot(n) / whole;
    let w = (t.a - t.c).cross(at - t.c).dot(n) / whole;
    [v, w, 1.0 - v - w]
}
