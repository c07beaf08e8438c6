//! Whitted's recursive ray tracing: mirrored and refracted rays with Fresnel weights.
//!
//! Source: Whitted, "An Improved Illumination Model for Shaded Display", Communications of the ACM 23(6), 1980.

use crate::{
    Bsdf, Environment, SurfaceInteraction,
    fresnel::{reflect, refract},
    ray_cast::ambient_reflection,
    ray_queue::RayState,
    surface_lanes::{SurfaceLanes, for_lanes},
};
use umbriel_kernels::{Ray, Vec3Lanes, glam::Vec3, offset_origin, whole_vectors};

/// The share of the specular lobe that one mirrored ray stands for, in `[0, 1]`.
///
/// A mirrored ray is sharp, so it can stand for a narrow lobe only: 1 up to roughness 0.1, falling smoothly to 0 at 0.4.
/// The rest of the lobe reflects the ambient light.
#[inline(always)]
fn mirror_share(roughness: f32) -> f32 {
    let x = ((roughness - 0.1) / 0.3).clamp(0.0, 1.0);
    1.0 - x * x * (3.0 - 2.0 * x)
}

/// The shares of the specular lobe, and of the coat's, that no mirrored ray stands for.
#[inline(always)]
pub(crate) fn ambient_shares(bsdf: &Bsdf) -> (f32, f32) {
    let share = mirror_share(bsdf.roughness);
    let coat = bsdf.layers;
    let coat = coat.map_or(0.0, |coat| mirror_share(coat.clearcoat_roughness));
    (1.0 - share, 1.0 - coat)
}

/// Whitted's ambient term, for what no ray is sent after; false where there is none.
#[inline(always)]
pub(crate) fn ambient(
    environment: &Environment,
    surfaces: &SurfaceLanes,
    ambient: &mut Vec3Lanes,
) -> bool {
    if let Some(bsdf) = surfaces.uniform
        && bsdf.layers.is_none()
        && bsdf.diffuse_color() == Vec3::ZERO
        && mirror_share(bsdf.roughness) == 1.0
    {
        *ambient = Vec3Lanes::default();
        return false;
    }
    for_lanes(
        surfaces,
        ambient,
        #[inline(always)]
        |_, surface| {
            let (specular, coat) = ambient_shares(&surface.bsdf);
            ambient_reflection(environment, surface, specular, coat)
        },
    );
    true
}

/// Rays that go on from a block of surfaces.
#[derive(Debug, Default)]
pub(crate) struct OnwardLanes {
    any: bool,
    pub(crate) weight: Vec3Lanes,
    origin: Vec3Lanes,
    dir: Vec3Lanes,
}

impl OnwardLanes {
    #[inline(always)]
    pub(crate) fn ray(&self, i: usize) -> Ray {
        Ray::new(self.origin.get(i), self.dir.get(i))
    }

    /// The state of lane `i` where `parent` is that of the ray which came here.
    #[inline(always)]
    pub(crate) fn state(&self, i: usize, parent: &RayState) -> RayState {
        RayState {
            weight: self.weight.get(i),
            depth: parent.depth + 1,
            ..*parent
        }
    }

    /// Whether any lane has enough weight to go on.
    #[inline(always)]
    pub(crate) fn any(&self) -> bool {
        self.any
    }

    #[inline(always)]
    pub(crate) fn has_weight(&self, i: usize, least: f32) -> bool {
        self.weight.get(i).max_element() >= least
    }

    /// Starts the rays of all lanes, unless none has enough weight; a lane without direction loses its weight.
    #[inline(always)]
    fn start(
        &mut self,
        surfaces: &SurfaceLanes,
        least: f32,
        direction: impl Fn(&SurfaceInteraction) -> Option<Vec3>,
    ) {
        let mut any = false;
        for i in 0..whole_vectors(surfaces.len) {
            any |= self.has_weight(i, least);
        }
        self.any = any;
        if !any {
            return;
        }
        for i in 0..whole_vectors(surfaces.len) {
            let surface = surfaces.get(i);
            let found = direction(&surface);
            let dir = found.unwrap_or(surface.wo);
            let kept = if found.is_some() { 1.0 } else { 0.0 };
            self.weight.set(i, self.weight.get(i) * kept);
            self.dir.set(i, dir);
            let origin = offset_origin(surface.p, surface.error, surface.ng, dir);
            self.origin.set(i, origin);
        }
    }
}

/// The mirrored and the refracted rays of surfaces that are seen with `weights`.
///
/// ```text
/// weight_r = weight · F · mirror share      weight_t = weight · (1 − F) · transmission · base colour
/// ```
/// Total internal reflection has `F = 1`, so its refracted ray has no weight. Only rays with a weight of `least` in
/// some channel have an origin and a direction.
#[allow(
    clippy::redundant_closure,
    reason = "a function passed by name is not inlined into the copy for the vector unit"
)]
#[inline(always)]
pub(crate) fn spawn(
    surfaces: &SurfaceLanes,
    weights: &Vec3Lanes,
    least: f32,
    mirrored: &mut OnwardLanes,
    refracted: &mut OnwardLanes,
) {
    for_lanes(
        surfaces,
        &mut mirrored.weight,
        #[inline(always)]
        |i, surface| weights.get(i) * mirrored_share(surface),
    );
    for_lanes(
        surfaces,
        &mut refracted.weight,
        #[inline(always)]
        |i, surface| weights.get(i) * refracted_share(surface),
    );
    mirrored.start(
        surfaces,
        least,
        #[inline(always)]
        |s| Some(mirrored_direction(s)),
    );
    refracted.start(
        surfaces,
        least,
        #[inline(always)]
        |s| refracted_direction(s),
    );
}

/// What the mirrored ray stands for, by colour: of the base, and of its coat.
#[inline(always)]
pub(crate) fn mirrored_share(surface: &SurfaceInteraction) -> Vec3 {
    let (bsdf, cos_o) = (&surface.bsdf, surface.ns.dot(surface.wo));
    let (reflected, _) = bsdf.split(cos_o);
    let base = reflected * mirror_share(bsdf.roughness);
    bsdf.layers.map_or(base, |layers| {
        let coat = layers.coat(cos_o) * mirror_share(layers.clearcoat_roughness);
        base * layers.beneath(cos_o) + Vec3::splat(coat)
    })
}

/// What the refracted ray stands for, by colour.
#[inline(always)]
pub(crate) fn refracted_share(surface: &SurfaceInteraction) -> Vec3 {
    let cos_o = surface.ns.dot(surface.wo);
    let (_, transmitted) = surface.bsdf.split(cos_o);
    surface.bsdf.beneath(cos_o) * transmitted
}

/// Mirrors at the shading normal, or at the geometric normal where that would point into the surface.
#[inline(always)]
pub(crate) fn mirrored_direction(surface: &SurfaceInteraction) -> Vec3 {
    let dir = reflect(surface.wo, surface.ns);
    if dir.dot(surface.ng) > 0.0 {
        dir
    } else {
        reflect(surface.wo, surface.ng)
    }
}

/// Refracts at the shading normal, or at the geometric normal where that would not pass the surface.
#[inline(always)]
pub(crate) fn refracted_direction(surface: &SurfaceInteraction) -> Option<Vec3> {
    let eta = surface.bsdf.eta;
    refract(surface.wo, surface.ns, eta)
        .filter(|dir| dir.dot(surface.ng) < 0.0)
        .or_else(|| refract(surface.wo, surface.ng, eta))
}
