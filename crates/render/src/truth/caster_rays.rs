//! What a ray to the light says if there is nothing but what shadow maps hold.

use crate::{
    AlphaMode, GlassShadows, SceneBvh,
    shadow_map::{Casts, casts, cutoff},
    surface::{alpha_at, surface_interaction},
};
use umbriel_kernels::{Hit, Interval, Ray, glam::Vec3, offset_origin};

/// How many surfaces without a place in the maps a ray may pass; the next one counts as a blocker.
const MAX_PASSES: usize = 64;

/// Where a ray to the light first meets what casts a shadow in maps: no glass that filters light, and of what is partly transparent
/// what is opaque by half.
pub(crate) fn first_caster(bvh: &SceneBvh, ray: &Ray, glass: GlassShadows) -> Option<Vec3> {
    let mut rest = *ray;
    let end = ray.at(1.0);
    let mut hits = [None];
    for _ in 0..MAX_PASSES {
        bvh.first_blockers(&[rest], &mut hits);
        let hit = hits[0]?;
        if is_caster(bvh, &rest, &hit, glass) {
            return Some(rest.at(hit.t));
        }
        let length = rest.dir.length();
        let unit = Ray {
            dir: rest.dir / length,
            ..rest
        };
        let met = Hit {
            t: hit.t * length,
            ..hit
        };
        let surface = surface_interaction(bvh, &unit, &met);
        let origin = offset_origin(surface.p, surface.error, surface.ng, unit.dir);
        rest = Ray {
            origin,
            dir: if ray.t.max <= 1.0 {
                end - origin
            } else {
                ray.dir
            },
            t: Interval { min: 0.0, ..ray.t },
        };
    }
    Some(rest.origin)
}

fn is_caster(bvh: &SceneBvh, ray: &Ray, hit: &Hit, glass: GlassShadows) -> bool {
    let scene = bvh.scene();
    let instance = &scene.instances[hit.instance as usize];
    let material = &scene.materials[instance.material.index()];
    match (casts(material, glass), material.alpha_mode) {
        (Casts::Nothing, _) => false,
        (_, AlphaMode::Blend) => {
            let to_object = bvh.to_object(crate::InstanceId(hit.instance));
            let object_ray = to_object.map_or(*ray, |m| ray.transformed(m));
            alpha_at(scene, &object_ray, hit) >= cutoff(material)
        }
        // Holes were left out before.
        _ => true,
    }
}
