//! Whitted's recursive ray tracing: mirrored and refracted rays with Fresnel weights.
//!
//! Source: Whitted, "An Improved Illumination Model for Shaded Display", Communications of the ACM 23(6), 1980.

use crate::{
    Environment, MaterialId, Settings, SurfaceInteraction,
    fresnel::{reflect, refract},
    ray_cast::ambient_reflection,
    trace::{Queue, RayState},
};
use umbriel_kernels::{Ray, glam::Vec3, offset_origin};

/// The share of the specular lobe that one mirrored ray stands for, in `[0, 1]`.
///
/// A mirrored ray is sharp, so it can stand for a narrow lobe only: 1 up to roughness 0.1, falling smoothly to 0 at 0.4.
/// The rest of the lobe reflects the ambient light.
fn mirror_share(roughness: f32) -> f32 {
    let x = ((roughness - 0.1) / 0.3).clamp(0.0, 1.0);
    1.0 - x * x * (3.0 - 2.0 * x)
}

/// Whitted's ambient term, for what no ray is sent after.
pub(crate) fn ambient(environment: &Environment, surface: &SurfaceInteraction) -> Vec3 {
    ambient_reflection(
        environment,
        surface,
        1.0 - mirror_share(surface.bsdf.roughness),
    )
}

/// Pushes the mirrored and the refracted ray of a surface point.
///
/// ```text
/// weight_r = weight · F · mirror share      weight_t = weight · (1 − F) · transmission · base colour
/// ```
/// Total internal reflection has `F = 1`, so its refracted ray has no weight. `material` is the surface's.
pub(crate) fn spawn(
    settings: &Settings,
    surface: &SurfaceInteraction,
    state: &RayState,
    material: MaterialId,
    queue: &mut Queue,
) {
    if u32::from(state.depth) >= settings.depth {
        return;
    }
    let bsdf = &surface.bsdf;
    let (reflected, transmitted) = bsdf.split(surface.ns.dot(surface.wo));
    let child = RayState {
        depth: state.depth + 1,
        ..*state
    };
    let enough = |weight: Vec3| weight.max_element() >= settings.min_weight;
    let mut push = |dir: Vec3, child: RayState| {
        let origin = offset_origin(surface.p, surface.error, surface.ng, dir);
        queue.push(Ray::new(origin, dir), child);
    };
    let weight = state.weight * reflected * mirror_share(bsdf.roughness);
    if enough(weight) {
        push(mirrored_direction(surface), RayState { weight, ..child });
    }
    let weight = state.weight * transmitted;
    if enough(weight)
        && let Some(dir) = refracted_direction(surface)
    {
        let medium = if bsdf.thin_walled {
            state.medium
        } else {
            surface.front.then_some(material)
        };
        let through = RayState {
            weight,
            medium,
            ..child
        };
        push(dir, through);
    }
}

/// Mirrors at the shading normal, or at the geometric normal where that would point into the surface.
fn mirrored_direction(surface: &SurfaceInteraction) -> Vec3 {
    let dir = reflect(surface.wo, surface.ns);
    if dir.dot(surface.ng) > 0.0 {
        dir
    } else {
        reflect(surface.wo, surface.ng)
    }
}

/// Refracts at the shading normal, or at the geometric normal where that would not pass the surface.
fn refracted_direction(surface: &SurfaceInteraction) -> Option<Vec3> {
    let eta = surface.bsdf.eta;
    refract(surface.wo, surface.ns, eta)
        .filter(|dir| dir.dot(surface.ng) < 0.0)
        .or_else(|| refract(surface.wo, surface.ng, eta))
}
