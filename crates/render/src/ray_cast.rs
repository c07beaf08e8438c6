//! Ray casting: one eye ray, one shadow ray a light, local shading.
//!
//! Source: Appel, "Some Techniques for Shading Machine Renderings of Solids", AFIPS 1968.

use crate::{
    Environment, SurfaceInteraction,
    bsdf::albedo_ggx,
    fresnel::{normal_reflectance, reflect},
    surface_lanes::{SurfaceLanes, for_lanes},
};
use umbriel_kernels::{Vec3Lanes, glam::Vec3};

/// Light from the surroundings in place of indirect light: all of the specular lobe reflects the ambient light.
///
/// Ray casting sees one surface, so glass is drawn as if it let nothing through.
#[inline(always)]
pub(crate) fn shade(
    environment: &Environment,
    surfaces: &mut SurfaceLanes,
    ambient: &mut Vec3Lanes,
) {
    surfaces.make_opaque();
    // A copy cannot be changed by the loop, so nothing of it is read again in each lane.
    let environment = *environment;
    for_lanes(
        surfaces,
        ambient,
        #[inline(always)]
        |_, surface| ambient_reflection(&environment, surface, 1.0),
    );
}

/// The reflection of the ambient light, as if nothing stood in its way: all of the diffuse lobe and the share
/// `specular` of the specular one.
#[inline(always)]
pub(crate) fn ambient_reflection(
    environment: &Environment,
    surface: &SurfaceInteraction,
    specular: f32,
) -> Vec3 {
    let bsdf = &surface.bsdf;
    let diffuse = bsdf.diffuse_color();
    let cos_o = surface.ns.dot(surface.wo).clamp(0.0, 1.0);
    // Without conditions: the formulas share most of their numbers, and 0 times them is 0.
    let coat = albedo_ggx(
        cos_o,
        bsdf.roughness,
        Vec3::splat(normal_reflectance(bsdf.ior)),
    );
    let mirrored = environment.ambient(reflect(surface.wo, surface.ns));
    diffuse * (Vec3::ONE - coat) * environment.ambient(surface.ns)
        + albedo_ggx(cos_o, bsdf.roughness, bsdf.f0()) * mirrored * specular
}
