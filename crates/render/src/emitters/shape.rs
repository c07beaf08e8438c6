//! One thing that shines from one place: its shape in the world, its bounds, and directions towards it.

use super::{ALMOST, LightRay};
use crate::{
    Instance, Light, LightBounds, LightSample,
    light_sampling::{
        DirectionSample, pdf_disk, pdf_rectangle, pdf_sphere, pdf_triangle, sample_disk,
        sample_rectangle, sample_sphere, sample_triangle,
    },
};
use std::f32::consts::{PI, TAU};
use umbriel_kernels::{
    Aabb, Surface, Triangle,
    glam::{Affine3A, Vec2, Vec3},
};

/// Something that shines from one place.
#[derive(Clone, Copy, Debug)]
pub(super) enum Emitter {
    /// A point or spot light, by its position in [`Scene::lights`](crate::Scene::lights).
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

impl Emitter {
    pub(super) fn sample(&self, p: Vec3, u: Vec2) -> DirectionSample {
        match self {
            // Of those that rays cannot meet, `light_ray` makes directions of no density.
            Self::Light(_) => DirectionSample::NONE,
            Self::Sphere { center, radius } => sample_sphere(p, *center, *radius, u),
            Self::Rectangle { center, u: a, v: b } => sample_rectangle(p, *center, *a, *b, u),
            Self::Disk {
                center,
                normal,
                radius,
            } => sample_disk(p, *center, *normal, *radius, u),
            Self::Triangle(triangle) => sample_triangle(p, triangle, u),
        }
    }

    pub(super) fn pdf(&self, p: Vec3, to_light: Vec3) -> f32 {
        match self {
            Self::Light(_) => 0.0,
            Self::Sphere { center, radius } => pdf_sphere(p, *center, *radius),
            Self::Rectangle { center, u, v } => pdf_rectangle(p, *center, *u, *v, to_light),
            Self::Disk { normal, radius, .. } => pdf_disk(to_light, *normal, *radius),
            Self::Triangle(triangle) => pdf_triangle(p, triangle, to_light),
        }
    }
}

/// Where a point or spot light is, where it shines and how much; `None` for parallel light.
pub(super) fn light_bounds(light: &Light) -> Option<LightBounds> {
    let reach = Vec3::splat(0.5 * light.size());
    let at = |position: Vec3, intensity: Vec3, axis, cos_normals, sphere: f32| LightBounds {
        aabb: Aabb {
            min: position - reach,
            max: position + reach,
        },
        axis,
        cos_normals,
        power: (intensity.max_element() * sphere).max(f32::MIN_POSITIVE),
    };
    match light {
        Light::Point(l) => Some(at(l.position, l.intensity, Vec3::Z, -1.0, 2.0 * TAU)),
        Light::Spot(l) => {
            let cap = TAU * (1.0 - l.outer_angle.cos());
            Some(at(
                l.position,
                l.intensity,
                l.direction,
                l.outer_angle.cos(),
                cap,
            ))
        }
        Light::Directional(_) => None,
    }
}

/// A ray towards a light that was chosen with `probability`; towards a place on one with extent, by `u`.
///
/// A point or spot light's ball has the radiance that gives the light's intensity, and a directional light's disk in the sky the one that
/// gives its illuminance, with `α` half of its angle:
/// ```text
/// L = I/(π r²)        L = E/(π sin² α)
/// ```
/// No ray that goes on meets them, so that they need no weighting against other ways of sampling.
pub(super) fn light_ray(light: &Light, p: Vec3, probability: f32, u: Vec2) -> Option<LightRay> {
    let center = light.sample(p)?;
    let sine = match light {
        Light::Directional(light) => (0.5 * light.angle).sin(),
        Light::Point(_) | Light::Spot(_) => 0.5 * light.size() / center.to_light.length(),
    };
    if sine > LEAST_SINE {
        return Some(ray_to_body(light, &center, p, probability, u));
    }
    Some(LightRay {
        wi: center.wi,
        to_light: center.to_light,
        t_max: center.t_max,
        radiance: center.illuminance / probability,
        pdf: f32::INFINITY,
    })
}

/// Of half of the angle that a light with extent fills: below it, directions do not tell its rim from its centre, and squares come to be 0.
const LEAST_SINE: f32 = 1e-8;

fn ray_to_body(
    light: &Light,
    center: &LightSample,
    p: Vec3,
    probability: f32,
    u: Vec2,
) -> LightRay {
    let (found, radiance, t_max) = match light {
        Light::Directional(light) => {
            // The ball of this radius around the end of the unit vector fills the cone.
            let radius = (0.5 * light.angle).sin();
            let found = sample_sphere(Vec3::ZERO, center.wi, radius, u);
            let radiance = center.illuminance / (PI * radius * radius);
            (
                DirectionSample {
                    distance: 1.0,
                    ..found
                },
                radiance,
                f32::INFINITY,
            )
        }
        Light::Point(_) | Light::Spot(_) => {
            let radius = 0.5 * light.size();
            let found = sample_sphere(p, p + center.to_light, radius, u);
            let intensity = center.illuminance * center.to_light.length_squared();
            (found, intensity / (PI * radius * radius), ALMOST)
        }
    };
    LightRay {
        wi: found.wi,
        to_light: found.wi * found.distance,
        t_max,
        radiance: radiance / (found.pdf * probability),
        pdf: f32::INFINITY,
    }
}

/// A triangle of a mesh in the world, its area and its outward normal.
pub(super) fn world_triangle(t: &Triangle, instance: &Instance) -> (Emitter, f32, Vec3) {
    let [a, b, c] = [t.a, t.b, t.c].map(|p| instance.transform.transform_point3(p));
    let cross = (b - a).cross(c - a);
    let normal = outward_sign(instance) * cross.normalize_or(Vec3::Z);
    let emitter = Emitter::Triangle(Triangle { a, b, c });
    (emitter, 0.5 * cross.length(), normal)
}

/// A surface in the world, its area and its normal; `None` for those without a sampling formula.
pub(super) fn world_surface(
    surface: &Surface,
    transform: &Affine3A,
) -> Option<(Emitter, f32, Vec3)> {
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

/// The box around what glows; for lights see [`light_bounds`].
pub(super) fn emitter_box(emitter: &Emitter) -> Aabb {
    let around = |center: Vec3, reach: Vec3| Aabb {
        min: center - reach,
        max: center + reach,
    };
    match *emitter {
        Emitter::Sphere { center, radius } | Emitter::Disk { center, radius, .. } => {
            around(center, Vec3::splat(radius))
        }
        Emitter::Rectangle { center, u, v } => around(center, u.abs() + v.abs()),
        Emitter::Triangle(t) => Aabb {
            min: t.a.min(t.b).min(t.c),
            max: t.a.max(t.b).max(t.c),
        },
        Emitter::Light(_) => around(Vec3::ZERO, Vec3::ZERO),
    }
}

/// 1 where the normals of a mesh's triangles in the world point outwards, -1 where inwards: the order of the corners turns with a
/// mirroring transform.
pub(super) fn outward_sign(instance: &Instance) -> f32 {
    let outwards = if instance.inside_out { -1.0 } else { 1.0 };
    outwards * instance.transform.matrix3.determinant().signum()
}
