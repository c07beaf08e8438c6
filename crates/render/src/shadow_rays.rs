//! "Is it lit?" Asked by a ray to the light.

use crate::{
    AlphaMode, GlassShadows, Scene, SceneBvh, direct::Visibility, surface::surface_interaction,
};
use umbriel_kernels::{Hit, Interval, Ray, glam::Vec3, offset_origin};

/// How often a shadow ray may pass through something; what is left then counts as blocked.
const MAX_PASSES: usize = 64;

/// Shadow rays (Appel 1968), filtered by glass if asked for (Whitted 1980).
#[derive(Debug)]
pub struct ShadowRays<'a> {
    bvh: &'a SceneBvh<'a>,
    /// Glass weakens light instead of blocking it.
    filter_glass: bool,
    /// Something in the scene lets light through, so that a yes or no is not enough.
    translucent: bool,
    occluded: Vec<bool>,
    hits: Vec<Option<Hit>>,
}

impl<'a> ShadowRays<'a> {
    /// Shadow rays through a scene.
    pub fn new(bvh: &'a SceneBvh<'a>, glass: GlassShadows) -> Self {
        let filter_glass = glass == GlassShadows::Filtered;
        Self {
            bvh,
            filter_glass,
            translucent: is_translucent(bvh.scene(), filter_glass),
            occluded: Vec::new(),
            hits: Vec::new(),
        }
    }

    /// Follows each ray from surface to surface until the light or something opaque.
    ///
    /// A ray goes straight on: what passes a surface is `1 − alpha` of it, or for glass its
    /// [`Bsdf::split`](crate::Bsdf::split) and the absorption on the way inside.
    fn filter(&mut self, rays: &[Ray], fractions: &mut [Vec3]) {
        fractions.fill(Vec3::ONE);
        let mut active: Vec<(usize, Ray)> = rays.iter().copied().enumerate().collect();
        let mut batch: Vec<Ray> = Vec::new();
        for _ in 0..MAX_PASSES {
            batch.clear();
            batch.extend(active.iter().map(|(_, ray)| *ray));
            self.hits.clear();
            self.hits.resize(batch.len(), None);
            self.bvh.intersect(&batch, &mut self.hits);
            let mut next = Vec::new();
            for ((i, ray), hit) in active.iter().zip(&self.hits) {
                let Some(hit) = hit else { continue };
                let (passed, onward) = self.pass(ray, hit);
                fractions[*i] *= passed;
                if fractions[*i].max_element() > 0.0 {
                    next.push((*i, onward));
                }
            }
            active = next;
            if active.is_empty() {
                return;
            }
        }
        for (i, _) in active {
            fractions[i] = Vec3::ZERO;
        }
    }

    /// What passes the surface at `hit`, and the ray behind it.
    fn pass(&self, ray: &Ray, hit: &Hit) -> (Vec3, Ray) {
        let scene = self.bvh.scene();
        let length = ray.dir.length();
        let unit = Ray {
            dir: ray.dir / length,
            ..*ray
        };
        let unit_hit = Hit {
            t: hit.t * length,
            ..*hit
        };
        let surface = surface_interaction(self.bvh, &unit, &unit_hit);
        let mut through = Vec3::ZERO;
        if self.filter_glass {
            (_, through) = surface.bsdf.split(surface.wo.dot(surface.ns));
            if !surface.front {
                let material = scene.instances[hit.instance as usize].material;
                through *= scene.materials[material.index()].absorption(unit_hit.t);
            }
        }
        let alpha = surface.bsdf.alpha;
        let origin = offset_origin(surface.p, surface.error, surface.ng, unit.dir);
        let end = if ray.t.max <= 1.0 {
            ray.at(1.0) - origin
        } else {
            ray.dir
        };
        let onward = Ray {
            origin,
            dir: end,
            t: Interval { min: 0.0, ..ray.t },
        };
        (Vec3::splat(1.0 - alpha) + alpha * through, onward)
    }
}

impl Visibility for ShadowRays<'_> {
    fn transmittance(&mut self, rays: &[Ray], _lights: &[u32], fractions: &mut [Vec3]) {
        if self.translucent {
            self.filter(rays, fractions);
            return;
        }
        self.occluded.clear();
        self.occluded.resize(rays.len(), false);
        self.bvh.occluded(rays, &mut self.occluded);
        for (fraction, &occluded) in fractions.iter_mut().zip(&self.occluded) {
            *fraction = if occluded { Vec3::ZERO } else { Vec3::ONE };
        }
    }
}

fn is_translucent(scene: &Scene, filter_glass: bool) -> bool {
    scene.instances.iter().any(|instance| {
        let material = &scene.materials[instance.material.index()];
        material.alpha_mode == AlphaMode::Blend || (filter_glass && material.transmission > 0.0)
    })
}
