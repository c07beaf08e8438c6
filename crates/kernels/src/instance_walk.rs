//! How rays walk a tree over instances: sixteen at a time, as packets where they keep together.

use crate::bvh::{Child, Order, Stack, Visit};
use crate::instance_visit::{Seekers, Shadows};
use crate::instances::{Filter, Inner, InstanceBvh, Scratch};
use crate::mesh_walk::{Party, divide, lanes_of};
use crate::simd::{PacketBoxes, RayLanes, Rays16};
use crate::{Hit, Ray, Walk};
use fearless_simd::{Simd, f32x16, prelude::*};

impl InstanceBvh {
    /// The nearest hit of each of at most sixteen rays. To be called where the compiler knows what `simd` can do.
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
        let ready = Rays16::new(simd, rays, self.tree.bounds(), self.stretch);
        let mut seekers = Seekers {
            rays,
            t_max: ready.t_max.into(),
            hits,
            filter,
        };
        let (ways, lanes) = (ready.ways, ready.lanes());
        for &k in &self.unbounded {
            self.closest_in(simd, k, ways.sound, &mut seekers, &mut scratch.inner);
        }
        divide(
            Walk::Auto,
            ways,
            ways.sound,
            #[inline(always)]
            |party| match party {
                Party::Packet(one, like) => {
                    let boxes = PacketBoxes::new(simd, &ready, one, like);
                    self.closest_packet(simd, &boxes, &lanes, like, &mut seekers, scratch);
                }
                Party::Alone(i) => {
                    let (stack, inner) = scratch.single();
                    self.closest_alone(simd, &lanes, i, Child::ROOT, &mut seekers, stack, inner);
                }
            },
        );
    }

    #[inline(always)]
    fn closest_packet<S: Simd>(
        &self,
        simd: S,
        boxes: &PacketBoxes<S>,
        lanes: &RayLanes,
        members: u32,
        seekers: &mut Seekers,
        scratch: &mut Scratch,
    ) {
        let t_max = f32x16::simd_from(simd, seekers.t_max);
        let Scratch { stacks, inner } = scratch;
        self.tree.walk_packet(
            boxes,
            Order::Nearest,
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
                            let stack = &mut stacks.single;
                            self.closest_alone(simd, lanes, i, child, seekers, stack, inner);
                        }
                    }
                }
                (0, f32x16::simd_from(simd, seekers.t_max))
            },
        );
    }

    /// Looks under `from` for a nearer hit of ray `i`.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "the state of one walk")]
    fn closest_alone<S: Simd>(
        &self,
        simd: S,
        lanes: &RayLanes,
        i: usize,
        from: Child,
        seekers: &mut Seekers,
        stack: &mut Stack,
        inner: &mut Inner,
    ) {
        self.tree.closest(
            simd,
            &lanes.box_ray(i),
            &mut { seekers.t_max[i] },
            from,
            stack,
            #[inline(always)]
            |(first, n), t_max| {
                for &k in &self.items[first..first + n] {
                    self.closest_in(simd, k, 1 << i, seekers, inner);
                }
                *t_max = seekers.t_max[i];
            },
        );
    }

    /// Whether anything meets each of at most sixteen rays. To be called where the compiler knows what `simd` can do.
    #[inline(always)]
    pub(crate) fn any_16<S: Simd>(
        &self,
        simd: S,
        rays: &[Ray],
        scratch: &mut Scratch,
        occluded: &mut [bool],
        filter: &Filter,
    ) {
        if rays.is_empty() {
            return;
        }
        let ready = Rays16::new(simd, rays, self.tree.bounds(), self.stretch);
        let mut shadows = Shadows {
            rays,
            met: 0,
            filter,
        };
        let (ways, lanes) = (ready.ways, ready.lanes());
        for &k in &self.unbounded {
            self.any_in(simd, k, ways.sound, &mut shadows, &mut scratch.inner);
        }
        divide(
            Walk::Auto,
            ways,
            ways.sound & !shadows.met,
            #[inline(always)]
            |party| match party {
                Party::Packet(one, like) => {
                    let boxes = PacketBoxes::new(simd, &ready, one, like);
                    self.any_packet(simd, &boxes, &lanes, like, &mut shadows, scratch);
                }
                Party::Alone(i) => {
                    let (stack, inner) = scratch.single();
                    self.any_alone(simd, &lanes, i, Child::ROOT, &mut shadows, stack, inner);
                }
            },
        );
        for (i, occluded) in occluded.iter_mut().enumerate() {
            *occluded = shadows.met >> i & 1 == 1;
        }
    }

    #[inline(always)]
    fn any_packet<S: Simd>(
        &self,
        simd: S,
        boxes: &PacketBoxes<S>,
        lanes: &RayLanes,
        members: u32,
        shadows: &mut Shadows,
        scratch: &mut Scratch,
    ) {
        let t_max = boxes.ends();
        let Scratch { stacks, inner } = scratch;
        self.tree.walk_packet(
            boxes,
            Order::Smallest,
            members,
            t_max,
            &mut stacks.packet,
            #[inline(always)]
            |visit, here, _| {
                match visit {
                    Visit::Leaf((first, n)) => {
                        for &k in &self.items[first..first + n] {
                            self.any_in(simd, k, here, shadows, inner);
                        }
                    }
                    Visit::Alone(child) => {
                        for i in lanes_of(here) {
                            let stack = &mut stacks.single;
                            self.any_alone(simd, lanes, i, child, shadows, stack, inner);
                        }
                    }
                }
                (shadows.met, t_max)
            },
        );
    }

    /// Looks under `from` for anything that ray `i` meets.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "the state of one walk")]
    fn any_alone<S: Simd>(
        &self,
        simd: S,
        lanes: &RayLanes,
        i: usize,
        from: Child,
        shadows: &mut Shadows,
        stack: &mut Stack,
        inner: &mut Inner,
    ) {
        self.tree.any(
            simd,
            &lanes.box_ray(i),
            shadows.rays[i].t.max,
            from,
            stack,
            #[inline(always)]
            |(first, n)| {
                for &k in &self.items[first..first + n] {
                    self.any_in(simd, k, 1 << i, shadows, inner);
                }
                shadows.met >> i & 1 == 1
            },
        );
    }
}
