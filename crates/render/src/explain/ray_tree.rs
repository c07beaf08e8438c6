//! One sample ray by ray: the tree that ray tracing is taught with.

use crate::{
    InstanceId, LightSample, MaterialId, Method, SceneBvh, Settings, ShadowMaps, ShadowRays,
    SurfaceInteraction, Visibility,
    direct::{shadow_ray, share_of},
    ray_cast::ambient_reflection,
    shade_block::MAX_PASSES,
    surface_interaction,
    whitted::{
        ambient_shares, mirrored_direction, mirrored_share, refracted_direction, refracted_share,
    },
};
use umbriel_kernels::{Hit, Ray, glam::Vec3, offset_origin};

/// How a ray came to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayKind {
    /// From the eye.
    Eye,
    /// The rest of a ray behind a partly transparent surface.
    Passed,
    /// Mirrored.
    Mirrored,
    /// Refracted.
    Refracted,
}

/// A ray of a tree, and what it meets.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeRay {
    /// Position of the ray that it goes on from, in [`RayTree::rays`]; `None` for the eye's.
    pub parent: Option<u32>,
    /// How it came to be.
    pub kind: RayKind,
    /// Number of mirrored and refracted rays before it.
    pub depth: u32,
    /// The ray; its direction has unit length.
    pub ray: Ray,
    /// By how much the radiance that it starts with is multiplied on its way to the eye.
    pub weight: Vec3,
    /// What it meets; `None` for the sky.
    pub hit: Option<Hit>,
    /// The surface there.
    pub surface: Option<SurfaceInteraction>,
    /// By how much the radiance of the surface is multiplied: `weight` without what the glass on the way absorbs, and times the surface's alpha.
    pub seen_weight: Vec3,
    medium: Option<MaterialId>,
    passes: u16,
}

/// Where light comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TermSource {
    /// The ray meets nothing.
    Sky,
    /// What the surface sends out by itself, and reflects of the ambient light.
    Own,
    /// The light with this position in [`Scene::lights`](crate::Scene::lights).
    Light(u32),
}

/// A part of a sample's radiance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term {
    /// Position in [`RayTree::rays`] of the ray that brings it.
    pub ray: u32,
    /// Where it comes from.
    pub source: TermSource,
    /// The fraction of the light that arrives at the surface; 1 for other sources.
    pub fraction: Vec3,
    /// What it adds to the sample, in nit.
    pub radiance: Vec3,
}

/// All rays of one sample, in the order in which they are traced, and all that they bring.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RayTree {
    /// The eye's ray first, and each ray behind the one that it goes on from.
    pub rays: Vec<TreeRay>,
    /// In the order in which they are added.
    pub terms: Vec<Term>,
}

impl RayTree {
    /// The tree under the eye ray `ray`, which meets `hit`, by [`Method::RayCast`], [`Method::Whitted`] or, asking `maps`, [`Method::ShadowMap`].
    ///
    /// ```text
    /// L(ray) = own + Σ_lights f (n·l) E · transmittance + F L(mirrored) + (1 − F) t L(refracted)
    /// ```
    /// with the weights multiplied along the way, so that the sample is the sum of all terms. The scene's trees must have been built. This is the slide of
    /// the loop in `trace.rs`: its sum is that of the picture, to the bit.
    ///
    /// Source: Whitted, "An Improved Illumination Model for Shaded Display", Communications of the ACM 23(6), 1980.
    pub fn trace(
        bvh: &SceneBvh,
        settings: &Settings,
        maps: Option<&ShadowMaps>,
        ray: Ray,
        hit: Option<Hit>,
    ) -> Self {
        let mut tree = Self::default();
        tree.rays.push(TreeRay::eye(ray));
        let mut planter = Planter {
            bvh,
            settings,
            maps: maps.filter(|_| settings.method == Method::ShadowMap),
            shadow_rays: ShadowRays::new(bvh, settings.glass()),
        };
        let mut round = vec![0];
        planter.meet(&mut tree.rays[0], hit);
        while !round.is_empty() {
            round = planter.grow(&mut tree, &round);
            for &number in &round {
                let mut hits = [None];
                let ray = &mut tree.rays[number as usize];
                bvh.intersect(&[ray.ray], &mut hits);
                planter.meet(ray, hits[0]);
            }
        }
        tree
    }

    /// The sample's radiance in nit: the sum of its terms; nothing where that is no number.
    pub fn radiance(&self) -> Vec3 {
        let sum = self
            .terms
            .iter()
            .fold(Vec3::ZERO, |sum, term| sum + term.radiance);
        if sum.is_finite() { sum } else { Vec3::ZERO }
    }

    /// What a ray and all that go on from it bring, in nit.
    pub fn brought_by(&self, ray: u32) -> Vec3 {
        let mut below = vec![false; self.rays.len()];
        for (i, candidate) in self.rays.iter().enumerate() {
            let parent = candidate.parent.is_some_and(|p| below[p as usize]);
            below[i] = i as u32 == ray || parent;
        }
        let own = self.terms.iter().filter(|term| below[term.ray as usize]);
        own.map(|term| term.radiance).sum()
    }
}

impl TreeRay {
    fn eye(ray: Ray) -> Self {
        Self {
            parent: None,
            kind: RayKind::Eye,
            depth: 0,
            ray,
            weight: Vec3::ONE,
            hit: None,
            surface: None,
            seen_weight: Vec3::ONE,
            medium: None,
            passes: 0,
        }
    }
}

/// Grows a tree, round by round.
struct Planter<'a> {
    bvh: &'a SceneBvh<'a>,
    settings: &'a Settings,
    maps: Option<&'a ShadowMaps>,
    shadow_rays: ShadowRays<'a>,
}

impl Planter<'_> {
    /// Takes down what a ray meets.
    fn meet(&self, ray: &mut TreeRay, hit: Option<Hit>) {
        ray.hit = hit;
        ray.seen_weight = ray.weight;
        let Some(hit) = hit else { return };
        if let Some(medium) = ray.medium {
            let glass = &self.bvh.scene().materials[medium.index()];
            ray.seen_weight *= glass.absorption(hit.t);
        }
        ray.surface = Some(surface_interaction(self.bvh, &ray.ray, &hit));
    }

    /// Adds the light of the rays of a round, and gives the rays that go on from them: the rest behind what is partly transparent, mirrored, refracted, each
    /// instance's after the other's.
    fn grow(&mut self, tree: &mut RayTree, round: &[u32]) -> Vec<u32> {
        let instance = |number: u32| tree.rays[number as usize].hit.map(|hit| hit.instance);
        let mut met: Vec<u32> = round
            .iter()
            .copied()
            .filter(|&n| instance(n).is_some())
            .collect();
        met.sort_by_key(|&number| instance(number));
        let first = tree.rays.len() as u32;
        let mut lit = Vec::new();
        for &number in round {
            let ray = &tree.rays[number as usize];
            if ray.hit.is_none() {
                let radiance = ray.weight * self.bvh.scene().sky(ray.ray.dir);
                tree.add(number, TermSource::Sky, Vec3::ONE, radiance);
            }
        }
        let same = |a: &u32, b: &u32| {
            let instance = |n: u32| tree.rays[n as usize].hit.map(|hit| hit.instance);
            instance(*a) == instance(*b)
        };
        let groups: Vec<Vec<u32>> = met.chunk_by(same).map(<[u32]>::to_vec).collect();
        for group in groups {
            for &number in &group {
                self.pass(tree, number);
            }
            let shaded: Vec<u32> = group.into_iter().filter(|&n| self.shade(tree, n)).collect();
            for kind in [RayKind::Mirrored, RayKind::Refracted] {
                shaded.iter().for_each(|&n| self.spawn(tree, n, kind));
            }
            lit.push(shaded);
        }
        lit.iter().for_each(|group| self.light(tree, group));
        (first..tree.rays.len() as u32).collect()
    }

    /// Sends what is left of a ray on behind a partly transparent surface.
    fn pass(&self, tree: &mut RayTree, number: u32) {
        let ray = &mut tree.rays[number as usize];
        let Some(surface) = &ray.surface else { return };
        let alpha = surface.bsdf.alpha;
        let origin = offset_origin(surface.p, surface.error, surface.ng, ray.ray.dir);
        let behind = TreeRay {
            parent: Some(number),
            kind: RayKind::Passed,
            ray: Ray::new(origin, ray.ray.dir),
            weight: ray.seen_weight * (1.0 - alpha),
            hit: None,
            surface: None,
            passes: ray.passes + 1,
            ..ray.clone()
        };
        let goes_on = alpha < 1.0 && ray.passes < MAX_PASSES;
        ray.seen_weight *= alpha;
        if goes_on {
            tree.rays.push(behind);
        }
    }

    /// Adds the light that needs no further ray. Gives false if that is all there is.
    fn shade(&self, tree: &mut RayTree, number: u32) -> bool {
        let ray = &mut tree.rays[number as usize];
        let Some(surface) = &mut ray.surface else {
            return false;
        };
        let unlit = surface.bsdf.unlit;
        let own = if unlit {
            surface.bsdf.base_color
        } else {
            let (specular, coat) = match self.settings.method {
                Method::RayCast | Method::ShadowMap => {
                    surface.bsdf.transmission = 0.0;
                    (1.0, 1.0)
                }
                _ => ambient_shares(&surface.bsdf),
            };
            let environment = &self.bvh.scene().environment;
            surface.bsdf.emission + ambient_reflection(environment, surface, specular, coat)
        };
        let radiance = ray.seen_weight * own;
        tree.add(number, TermSource::Own, Vec3::ONE, radiance);
        !unlit
    }

    /// Sends the mirrored or the refracted ray of Whitted's method, if it has weight.
    fn spawn(&self, tree: &mut RayTree, number: u32, kind: RayKind) {
        let ray = &tree.rays[number as usize];
        let (Some(surface), Some(hit)) = (&ray.surface, &ray.hit) else {
            return;
        };
        if self.settings.method != Method::Whitted || ray.depth >= self.settings.depth {
            return;
        }
        let (share, dir, medium) = match kind {
            RayKind::Refracted => {
                let inside = self.bvh.scene().instances[hit.instance as usize].material;
                let medium = if surface.bsdf.thin_walled {
                    ray.medium
                } else {
                    surface.front.then_some(inside)
                };
                let dir = refracted_direction(surface);
                (refracted_share(surface), dir, medium)
            }
            _ => {
                let dir = Some(mirrored_direction(surface));
                (mirrored_share(surface), dir, ray.medium)
            }
        };
        let weight = ray.seen_weight * share;
        let Some(dir) = dir.filter(|_| weight.max_element() >= self.settings.min_weight) else {
            return;
        };
        let origin = offset_origin(surface.p, surface.error, surface.ng, dir);
        let spawned = TreeRay {
            parent: Some(number),
            kind,
            depth: ray.depth + 1,
            ray: Ray::new(origin, dir),
            weight,
            hit: None,
            surface: None,
            medium,
            ..ray.clone()
        };
        tree.rays.push(spawned);
    }

    /// Adds the direct light of the surfaces of one instance, light by light.
    fn light(&mut self, tree: &mut RayTree, group: &[u32]) {
        for (light, number) in self.bvh.scene().lights.iter().zip(0..) {
            for &ray in group {
                let seen = &tree.rays[ray as usize];
                let Some(surface) = &seen.surface else {
                    continue;
                };
                if let Some((arriving, share)) = share_of(light, surface, seen.seen_weight) {
                    let unshadowed = share * arriving.illuminance;
                    let fraction = self.fraction(number, surface, &arriving);
                    let source = TermSource::Light(number);
                    tree.add(ray, source, fraction, unshadowed * fraction);
                }
            }
        }
    }

    /// The fraction of a light that arrives at a surface.
    fn fraction(
        &mut self,
        light: u32,
        surface: &SurfaceInteraction,
        arriving: &LightSample,
    ) -> Vec3 {
        if !self.settings.shadows {
            return Vec3::ONE;
        }
        if let Some(maps) = self.maps {
            let map = maps.of(light as usize);
            return Vec3::splat(map.fraction(surface.shadow_p, surface.ng));
        }
        let ray = shadow_ray(surface, arriving.to_light, arriving.t_max);
        let mut fractions = [Vec3::ZERO];
        self.shadow_rays
            .transmittance(&[ray], &[light], &mut fractions);
        fractions[0]
    }
}

impl RayTree {
    fn add(&mut self, ray: u32, source: TermSource, fraction: Vec3, radiance: Vec3) {
        self.terms.push(Term {
            ray,
            source,
            fraction,
            radiance,
        });
    }

    /// The instance that a ray meets.
    pub fn instance(&self, ray: u32) -> Option<InstanceId> {
        let hit = self.rays.get(ray as usize)?.hit?;
        Some(InstanceId(hit.instance))
    }
}
