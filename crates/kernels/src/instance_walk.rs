//! How rays walk a tree over instances: sixteen at a time, together where they keep together, and in every instance again.

use crate::bvh::{Child, Visit};
use crate::instances::{Filter, Inner, InstanceBvh, Placed, Scratch, Shape};
use crate::mesh_walk::{lanes_of, packet_of};
use crate::simd::{PacketBoxes, RAYS, Rays16};
use crate::{Hit, MeshBvh, MeshHit, Ray, Surface, Walk, intersect_surface};
use fearless_simd::{Simd, f32x16, prelude::*};

/// At most sixteen rays and the nearest hit of each so far.
struct Seekers<'a> {
    rays: &'a [Ray],
    /// Where the nearest hits lie, or the rays end.
    t_max: [f32; RAYS],
    hits: &'a mut [Option<Hit>],
    filter: &'a Filter<'a>,
}

impl Seekers<'_> {
    /// Takes the hit of a ray if it wins: nearer, or at equal `t` the lower (instance, primitive).
    #[inline]
    fn consider(&mut self, i: usize, hit: Hit) {
        let wins = |best: &Hit| {
            hit.t < best.t
                || (hit.t == best.t
                    && (hit.instance, hit.primitive) < (best.instance, best.primitive))
        };
        if self.hits[i].as_ref().is_none_or(wins) {
            self.t_max[i] = hit.t;
            self.hits[i] = Some(hit);
        }
    }
}

impl InstanceBvh {
    /// The nearest hit of each of at most sixteen rays.
    #[inline(always)]
    pub(crate) fn closest_16<S: Simd>(
        &self,
        simd: S,
        rays: &[Ray],
        scratch: &mut Scratch,
        hits: &mut [Option<Hit>],
        filter: &Filter,
    ) {
        hits.fill(None);
        if rays.is_empty() {
            return;
        }
        let ready = Rays16::new(simd, rays, self.bounds_for(rays));
        let mut seekers = Seekers {
            rays,
            t_max: ready.t_max.into(),
            hits,
            filter,
        };
        for &k in &self.unbounded {
            let sound = ready.ways.sound;
            self.closest_in(simd, k, sound, &mut seekers, &mut scratch.inner);
        }
        let lanes = ready.lanes();
        let mut left = ready.ways.sound;
        while left != 0 {
            let one = left.trailing_zeros() as usize & 15;
            let like = packet_of(Walk::Auto, left, &ready, one);
            if like != 0 {
                left &= !like;
                self.closest_packet(simd, &ready, one, like, &mut seekers, scratch);
                continue;
            }
            left &= left - 1;
            let box_ray = lanes.box_ray(one);
            self.tree.closest(
                simd,
                &box_ray,
                &mut { seekers.t_max[one] },
                Child::ROOT,
                &mut scratch.stacks.single,
                #[inline(always)]
                |leaf, t_max| {
                    for &k in &self.items[leaf.0..leaf.0 + leaf.1] {
                        self.closest_in(simd, k, 1 << one, &mut seekers, &mut scratch.inner);
                    }
                    *t_max = seekers.t_max[one];
                },
            );
        }
    }

    #[inline(always)]
    fn closest_packet<S: Simd>(
        &self,
        simd: S,
        ready: &Rays16<S>,
        one: usize,
        members: u32,
        seekers: &mut Seekers,
        scratch: &mut Scratch,
    ) {
        let boxes = PacketBoxes::new(simd, ready, one, members);
        let t_max = f32x16::simd_from(simd, seekers.t_max);
        let lanes = ready.lanes();
        let Scratch { stacks, inner } = scratch;
        self.tree.walk_packet(
            &boxes,
            true,
            members,
            t_max,
            &mut stacks.packet,
            #[inline(always)]
            |visit, here, _| {
                match visit {
                    Visit::Leaf((first, n)) => {
                        for &k in &self.items[first..first + n] {
                            self.closest_in(simd, k, here, seekers, inner);
                        }
                    }
                    Visit::Alone(child) => {
                        for i in lanes_of(here) {
                            self.tree.closest(
                                simd,
                                &lanes.box_ray(i),
                                &mut { seekers.t_max[i] },
                                child,
                                &mut stacks.single,
                                #[inline(always)]
                                |leaf, t_max| {
                                    for &k in &self.items[leaf.0..leaf.0 + leaf.1] {
                                        self.closest_in(simd, k, 1 << i, seekers, inner);
                                    }
                                    *t_max = seekers.t_max[i];
                                },
                            );
                        }
                    }
                }
                (0, f32x16::simd_from(simd, seekers.t_max))
            },
        );
    }

    /// Whether anything meets each of at most sixteen rays.
    #[inline(always)]
    pub(crate) fn any_16<S: Simd>(
        &self,
        simd: S,
        rays: &[Ray],
        scratch: &mut Scratch,
        occluded: &mut [bool],
        filter: &Filter,
    ) {
        occluded.fill(false);
        if rays.is_empty() {
            return;
        }
        let ready = Rays16::new(simd, rays, self.bounds_for(rays));
        let mut left = ready.ways.sound;
        let mut done = 0;
        for &k in &self.unbounded {
            done |= self.any_in(simd, k, left & !done, rays, filter, &mut scratch.inner);
        }
        left &= !done;
        let lanes = ready.lanes();
        while left != 0 {
            let one = left.trailing_zeros() as usize & 15;
            let like = packet_of(Walk::Auto, left, &ready, one);
            if like != 0 {
                left &= !like;
                done |= self.any_packet(simd, &ready, one, like, rays, filter, scratch);
                continue;
            }
            left &= left - 1;
            let Scratch { stacks, inner } = scratch;
            let met = self.tree.any(
                simd,
                &lanes.box_ray(one),
                rays[one].t.max,
                Child::ROOT,
                &mut stacks.single,
                #[inline(always)]
                |leaf| self.any_in_leaf(simd, leaf, 1 << one, rays, filter, inner) != 0,
            );
            done |= u32::from(met) << one;
        }
        for i in lanes_of(done) {
            occluded[i] = true;
        }
    }

    /// Which of the members meet anything.
    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "the state of one walk, all of it in registers or on the stack"
    )]
    fn any_packet<S: Simd>(
        &self,
        simd: S,
        ready: &Rays16<S>,
        one: usize,
        members: u32,
        rays: &[Ray],
        filter: &Filter,
        scratch: &mut Scratch,
    ) -> u32 {
        let boxes = PacketBoxes::new(simd, ready, one, members);
        let lanes = ready.lanes();
        let Scratch { stacks, inner } = scratch;
        let mut all = 0;
        self.tree.walk_packet(
            &boxes,
            false,
            members,
            ready.t_max,
            &mut stacks.packet,
            #[inline(always)]
            |visit, here, _| {
                let mut done = 0;
                match visit {
                    Visit::Leaf(leaf) => {
                        done = self.any_in_leaf(simd, leaf, here, rays, filter, inner);
                    }
                    Visit::Alone(child) => {
                        for i in lanes_of(here) {
                            let met = self.tree.any(
                                simd,
                                &lanes.box_ray(i),
                                rays[i].t.max,
                                child,
                                &mut stacks.single,
                                #[inline(always)]
                                |leaf| {
                                    self.any_in_leaf(simd, leaf, 1 << i, rays, filter, inner) != 0
                                },
                            );
                            done |= u32::from(met) << i;
                        }
                    }
                }
                all |= done;
                (done, ready.t_max)
            },
        );
        all
    }

    /// Which of the rays `here` meet anything in a leaf.
    #[inline(always)]
    fn any_in_leaf<S: Simd>(
        &self,
        simd: S,
        (first, n): (usize, usize),
        here: u32,
        rays: &[Ray],
        filter: &Filter,
        inner: &mut Inner,
    ) -> u32 {
        let mut done = 0;
        for &k in &self.items[first..first + n] {
            done |= self.any_in(simd, k, here & !done, rays, filter, inner);
        }
        done
    }

    /// Looks in instance `k` for nearer hits of the rays `here`.
    #[inline(always)]
    fn closest_in<S: Simd>(
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

    /// Which of the rays `here` meet instance `k`.
    #[inline(always)]
    fn any_in<S: Simd>(
        &self,
        simd: S,
        k: u32,
        here: u32,
        rays: &[Ray],
        filter: &Filter,
        inner: &mut Inner,
    ) -> u32 {
        let placed = &self.placed[k as usize];
        match &placed.shape {
            Shape::Surface(surface) => {
                let mut done = 0;
                for i in lanes_of(here) {
                    let ray = placed.object_ray(&rays[i]);
                    let met = first_on_surface(placed, surface, k, &ray, filter).is_some();
                    done |= u32::from(met) << i;
                }
                done
            }
            Shape::Mesh(mesh) => {
                let mesh = &self.meshes[*mesh];
                any_in_mesh(simd, placed, mesh, k, here, rays, filter, inner)
            }
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
        let mut ray = seekers.rays[i];
        ray.t.max = seekers.t_max[i];
        let ray = placed.object_ray(&ray);
        if let Some(hit) = first_on_surface(placed, surface, k, &ray, seekers.filter) {
            seekers.consider(i, hit);
        }
    }
}

/// Compiled once for each vector unit, and called from all walks.
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
    let n = inner.gather(placed, here, seekers.rays, &seekers.t_max);
    let Inner {
        stacks,
        rays,
        numbers,
        hits,
        ..
    } = inner;
    let (rays, found) = (&rays[..n], &mut hits[..n]);
    let filter = seekers.filter;
    let keep = |i: usize, hit: &MeshHit| filter(&rays[i], &hit.on(k));
    let keep: Option<&dyn Fn(usize, &MeshHit) -> bool> =
        if placed.filtered { Some(&keep) } else { None };
    simd.vectorize(
        #[inline(always)]
        || mesh.closest_16(simd, Walk::Auto, rays, stacks, found, keep),
    );
    for (&i, hit) in numbers.iter().zip(found) {
        if let Some(hit) = hit {
            seekers.consider(i, hit.on(k));
        }
    }
}

/// Compiled once for each vector unit, and called from all walks.
#[inline(never)]
#[expect(
    clippy::too_many_arguments,
    reason = "the state of one walk, all of it in registers or on the stack"
)]
fn any_in_mesh<S: Simd>(
    simd: S,
    placed: &Placed,
    mesh: &MeshBvh,
    k: u32,
    here: u32,
    rays: &[Ray],
    filter: &Filter,
    inner: &mut Inner,
) -> u32 {
    let mut t_max = [0.0; RAYS];
    for i in lanes_of(here) {
        t_max[i] = rays[i].t.max;
    }
    let n = inner.gather(placed, here, rays, &t_max);
    let Inner {
        stacks,
        rays,
        numbers,
        occluded,
        ..
    } = inner;
    let (rays, occluded) = (&rays[..n], &mut occluded[..n]);
    let keep = |i: usize, hit: &MeshHit| filter(&rays[i], &hit.on(k));
    let keep: Option<&dyn Fn(usize, &MeshHit) -> bool> =
        if placed.filtered { Some(&keep) } else { None };
    simd.vectorize(
        #[inline(always)]
        || mesh.any_16(simd, Walk::Auto, rays, stacks, occluded, keep),
    );
    let bit = |(&i, &met): (&usize, &bool)| u32::from(met) << i;
    numbers
        .iter()
        .zip(&*occluded)
        .map(bit)
        .fold(0, |a, b| a | b)
}

impl Inner {
    /// Moves the rays `here` to object space, up to `t_max`; gives how many they are.
    fn gather(&mut self, placed: &Placed, here: u32, rays: &[Ray], t_max: &[f32; RAYS]) -> usize {
        let mut n = 0;
        for i in lanes_of(here) {
            let mut ray = rays[i];
            ray.t.max = t_max[i];
            self.rays[n % RAYS] = placed.object_ray(&ray);
            self.numbers[n % RAYS] = i;
            n += 1;
        }
        n
    }
}
