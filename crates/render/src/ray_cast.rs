//! Ray casting: one eye ray, one shadow ray a light, local shading.
//!
//! Source: Appel, "Some Techniques for Shading Machine Renderings of Solids", AFIPS 1968.

use crate::{
    Environment, SurfaceInteraction,
    fresnel::reflect,
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
        |_, surface| ambient_reflection(&environment, surface, 1.0, 1.0),
    );
}

/// The reflection of the ambient light, as if nothing stood in its way: all of the diffuse lobe and of the sheen, and the shares
/// `specular` and `coat` of the specular lobe and of the coat's.
#[inline(always)]
pub(crate) fn ambient_reflection(
    environment: &Environment,
    surface: &SurfaceInteraction,
    specular: f32,
    coat: f32,
) -> Vec3 {
    let bsdf = &surface.bsdf;
    let cos_o = surface.ns.dot(surface.wo).clamp(0.0, 1.0);
    let (diffuse, reflected) = bsdf.albedos(cos_o);
    let beneath = bsdf.beneath(cos_o);
    let mut sum = Vec3::ZERO;
    if diffuse != Vec3::ZERO {
        sum += diffuse * beneath * environment.ambient(surface.ns);
    }
    if specular > 0.0 {
        let mirrored = environment.ambient(reflect(surface.wo, surface.ns));
        sum += reflected * (beneath * specular) * mirrored;
    }
    if let Some(layers) = &bsdf.layers {
        let on_top = layers.coat(cos_o);
        let sheen = layers.sheen(cos_o) * (1.0 - on_top);
        let mirrored = environment.ambient(reflect(surface.wo, surface.ns));
        sum += sheen * environment.ambient(surface.ns) + mirrored * (on_top * coat);
    }
    sum
}
