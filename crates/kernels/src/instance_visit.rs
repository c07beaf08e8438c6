//! What rays do at one instance: they are moved to its space, and meet its mesh together or its surface one by one.

use crate::instances::{Filter, Inner, InstanceBvh, Placed, Shape};
use crate::mesh_walk::{Keep, lanes_of};
use crate::simd::RAYS;
use crate::surface::meets_surface;
use crate::{Hit, MeshBvh, MeshHit, Ray, Surface, Walk, intersect_surface};
use fearless_simd::Simd;

/// At most sixteen rays and the nearest hit of each so far.
pub(crate) struct Seekers<'a> {
    pub(crate) rays: &'a [Ray],
    /// Where the nearest hits lie, or the rays end.
    pub(crate) t_max: [f32; RAYS],
    pub(crate) hits: &'a mut [Option<Hit>],
    pub(crate) filter: &'a Filter<'a>,
}

/// At most sixteen rays and which of them have met anything so far.
pub(crate) struct Shadows<'a> {
    pub(crate) rays: &'a [Ray],
    pub(crate) met: u32,
    pub(crate) filter: &'a Filter<'a>,
}

impl Seekers<'_> {
    /// Takes the hit of a ray if it wins: nearer, or at equal `t` the lower (instance, primitive).
    #[inline]
    fn consider(&mut self, i: usize, hit: Hit) {
        let number = |hit: &Hit| (hit.instance, hit.primitive);
        let wins = |best: &Hit| hit.t < best.t || (hit.t == best.t && number(&hit) < number(best));
        if self.hits[i].as_ref().is_none_or(wins) {
            self.t_max[i] = hit.t;
            self.hits[i] = Some(hit);
        }
    }
}

impl InstanceBvh {
    /// Looks in instance `k` for nearer hits of the rays `here`.
    #[inline(always)]
    pub(crate) fn closest_in<S: Simd>(
        &self,
        simd: S,
        k: u32,
        here: u32,
        seekers: &mut Seekers,
        inner: &mut Inner,
    ) {
        let placed = &self.placed[k as usize];
        match &placed.shape {
            Shape::Surface(surface) => closest_on_surface(placed, surface, k, here, seekers),
            Shape::Mesh(mesh) => {
                closest_in_mesh(simd, placed, &self.meshes[*mesh], k, here, seekers, inner);
            }
        }
    }

    /// Notes which of the rays `here` meet instance `k`.
    #[inline(always)]
    pub(crate) fn any_in<S: Simd>(
        &self,
        simd: S,
        k: u32,
        here: u32,
        shadows: &mut Shadows,
        inner: &mut Inner,
    ) {
        let placed = &self.placed[k as usize];
        let here = here & !shadows.met;
        match &placed.shape {
            Shape::Surface(surface) => any_on_surface(placed, surface, k, here, shadows),
            Shape::Mesh(mesh) if here != 0 => {
                any_in_mesh(simd, placed, &self.meshes[*mesh], k, here, shadows, inner);
            }
            Shape::Mesh(_) => {}
        }
    }
}

/// The nearest hit on a surface that is there. Behind a hole the surface may be hit again.
fn first_on_surface(
    placed: &Placed,
    surface: &Surface,
    instance: u32,
    object_ray: &Ray,
    filter: &Filter,
) -> Option<Hit> {
    let mut rest = *object_ray;
    while let Some(found) = intersect_surface(&rest, surface) {
        let hit = Hit {
            instance,
            primitive: found.part,
            u: 0.0,
            v: 0.0,
            t: found.t,
        };
        if !placed.filtered || filter(object_ray, &hit) {
            return Some(hit);
        }
        rest.t.min = found.t;
    }
    None
}

fn closest_on_surface(
    placed: &Placed,
    surface: &Surface,
    k: u32,
    here: u32,
    seekers: &mut Seekers,
) {
    for i in lanes_of(here) {
        let mut ray = placed.object_ray(&seekers.rays[i]);
        ray.t.max = seekers.t_max[i];
        if let Some(hit) = first_on_surface(placed, surface, k, &ray, seekers.filter) {
            seekers.consider(i, hit);
        }
    }
}

fn any_on_surface(placed: &Placed, surface: &Surface, k: u32, here: u32, shadows: &mut Shadows) {
    for i in lanes_of(here) {
        let ray = placed.object_ray(&shadows.rays[i]);
        let met = if placed.filtered {
            first_on_surface(placed, surface, k, &ray, shadows.filter).is_some()
        } else {
            meets_surface(&ray, surface)
        };
        shadows.met |= u32::from(met) << i;
    }
}

/// A function of its own for each vector unit, since the walks come by in many places.
#[inline(never)]
fn closest_in_mesh<S: Simd>(
    simd: S,
    placed: &Placed,
    mesh: &MeshBvh,
    k: u32,
    here: u32,
    seekers: &mut Seekers,
    inner: &mut Inner,
) {
    let n = inner.gather(placed, here, seekers.rays);
    for (ray, &i) in inner.rays[..n].iter_mut().zip(&inner.numbers) {
        ray.t.max = seekers.t_max[i];
    }
    let (rays, hits) = (&inner.rays[..n], &mut inner.hits[..n]);
    let stacks = &mut inner.stacks;
    let filter = |i: usize, hit: &MeshHit| (seekers.filter)(&rays[i], &hit.on(k));
    let keep: Keep = if placed.filtered { Some(&filter) } else { None };
    simd.vectorize(
        #[inline(always)]
        || mesh.closest_16(simd, Walk::Auto, rays, stacks, hits, keep),
    );
    for (&i, hit) in inner.numbers.iter().zip(&inner.hits[..n]) {
        if let Some(hit) = hit {
            seekers.consider(i, hit.on(k));
        }
    }
}

/// A function of its own for each vector unit, since the walks come by in many places.
#[inline(never)]
fn any_in_mesh<S: Simd>(
    simd: S,
    placed: &Placed,
    mesh: &MeshBvh,
    k: u32,
    here: u32,
    shadows: &mut Shadows,
    inner: &mut Inner,
) {
    let n = inner.gather(placed, here, shadows.rays);
    let (rays, occluded) = (&inner.rays[..n], &mut inner.occluded[..n]);
    let stacks = &mut inner.stacks;
    let filter = |i: usize, hit: &MeshHit| (shadows.filter)(&rays[i], &hit.on(k));
    let keep: Keep = if placed.filtered { Some(&filter) } else { None };
    simd.vectorize(
        #[inline(always)]
        || mesh.any_16(simd, Walk::Auto, rays, stacks, occluded, keep),
    );
    for (&i, &met) in inner.numbers.iter().zip(&inner.occluded[..n]) {
        shadows.met |= u32::from(met) << i;
    }
}

impl Inner {
    /// Moves the rays `here` to object space; gives how many they are.
    fn gather(&mut self, placed: &Placed, here: u32, rays: &[Ray]) -> usize {
        let mut n = 0;
        for i in lanes_of(here) {
            self.rays[n % RAYS] = placed.object_ray(&rays[i]);
            self.numbers[n % RAYS] = i;
            n += 1;
        }
        n
    }
}
