//! Sixteen rays that keep together: against one box, against sixteen boxes, against one triangle.

use super::box_ray::U;
use crate::bvh::Node;
use crate::{Aabb, Ray};
use fearless_simd::{Simd, f32x16, mask32x16, prelude::*};

/// Rays in a packet.
pub(crate) const RAYS: usize = 16;

/// Sixteen rays, component by component.
pub(crate) struct Rays16<S: Simd> {
    simd: S,
    origin: [f32x16<S>; 3],
    dir: [f32x16<S>; 3],
    t_min: f32x16<S>,
    /// Lowered as hits are found.
    pub(crate) t_max: f32x16<S>,
}

impl<S: Simd> Rays16<S> {
    /// At most sixteen rays; the lanes left over repeat the first.
    #[inline(always)]
    pub(crate) fn new(simd: S, rays: &[Ray]) -> Self {
        let mut lanes = [[0.0_f32; RAYS]; 8];
        for i in 0..RAYS {
            let ray = rays.get(i).unwrap_or(&rays[0]);
            for axis in 0..3 {
                lanes[axis][i] = ray.origin[axis];
                lanes[3 + axis][i] = ray.dir[axis];
            }
            lanes[6][i] = ray.t.min;
            lanes[7][i] = ray.t.max;
        }
        let [ox, oy, oz, dx, dy, dz, t_min, t_max] =
            lanes.map(#[inline(always)] |lane| f32x16::simd_from(simd, lane));
        Self {
            simd,
            origin: [ox, oy, oz],
            dir: [dx, dy, dz],
            t_min,
            t_max,
        }
    }

    #[inline(always)]
    pub(super) fn origin(&self, axis: usize) -> f32x16<S> {
        self.origin[axis % 3]
    }

    #[inline(always)]
    pub(super) fn dir(&self, axis: usize) -> f32x16<S> {
        self.dir[axis % 3]
    }

    #[inline(always)]
    pub(super) fn t_min(&self) -> f32x16<S> {
        self.t_min
    }

    /// The rays that go the same way as each other: for each ray its sign bits and its longest axis, as bit masks.
    #[inline(always)]
    pub(crate) fn ways(&self) -> Ways {
        let zero = f32x16::splat(self.simd, 0.0);
        let [x, y, z] = self.dir.map(#[inline(always)] |d| d.abs());
        let longest_y = y.simd_gt(x);
        let xy = longest_y.select(y, x);
        let longest_z = z.simd_gt(xy);
        let longest = longest_z.select(z, xy);
        let infinity = f32x16::splat(self.simd, f32::INFINITY);
        let one = f32x16::splat(self.simd, 1.0);
        let mut sound = longest.simd_lt(infinity) & (one / longest).simd_lt(infinity);
        for axis in 0..3 {
            sound = sound
                & self.origin[axis].abs().simd_lt(infinity)
                & self.dir[axis].abs().simd_lt(infinity);
        }
        Ways {
            // By the sign bit, which -0 has too.
            backward: self.dir.map(#[inline(always)] |d| one.copysign(d).simd_lt(zero).to_bitmask() as u32),
            longest_y: longest_y.to_bitmask() as u32,
            longest_z: longest_z.to_bitmask() as u32,
            sound: sound.to_bitmask() as u32,
        }
    }
}

/// Bit masks over the rays of a packet.
#[derive(Clone, Copy)]
pub(crate) struct Ways {
    backward: [u32; 3],
    longest_y: u32,
    longest_z: u32,
    /// Finite rays that go somewhere.
    pub(crate) sound: u32,
}

/// A direction's signs and longest axis.
#[derive(Clone, Copy)]
pub(crate) struct Way {
    backward: [bool; 3],
    longest: usize,
}

impl Way {
    pub(super) fn longest(self) -> usize {
        self.longest
    }

    pub(super) fn points_back(self, axis: usize) -> bool {
        self.backward[axis]
    }
}

impl Ways {
    /// The way of ray `i`, and the rays that go the same way.
    #[inline(always)]
    pub(crate) fn like(&self, i: u32) -> (Way, u32) {
        let bit = |mask: u32| mask >> i & 1 == 1;
        let same = |mask: u32| if bit(mask) { mask } else { !mask };
        let way = Way {
            backward: self.backward.map(bit),
            longest: if bit(self.longest_z) {
                2
            } else {
                usize::from(bit(self.longest_y))
            },
        };
        let [x, y, z] = self.backward.map(same);
        // Where z is the longest, it does not matter which of x and y is longer.
        let axis = if bit(self.longest_z) {
            self.longest_z
        } else {
            !self.longest_z & same(self.longest_y)
        };
        (way, x & y & z & axis)
    }
}

/// Rays of one way, prepared for boxes: the constants of [`BoxRay`](super::BoxRay) for each, and their bounds over all.
pub(crate) struct PacketBoxes<S: Simd> {
    simd: S,
    near: [Slab<S>; 3],
    far: [Slab<S>; 3],
    near_bounds: [usize; 3],
    far_bounds: [usize; 3],
    t_min: f32x16<S>,
    least_t_min: f32x16<S>,
    /// Rays whose constants did not overflow.
    pub(crate) sound: u32,
}

/// One side of a slab for sixteen rays.
#[derive(Clone, Copy)]
struct Slab<S: Simd> {
    scale: f32x16<S>,
    shift: f32x16<S>,
    /// The origin, moved by the pad, of the ray that gives the extreme parameter; the least and the greatest scale.
    origin: f32x16<S>,
    scales: [f32x16<S>; 2],
}

impl<S: Simd> PacketBoxes<S> {
    #[inline(always)]
    pub(crate) fn new(simd: S, rays: &Rays16<S>, way: Way, members: u32, bounds: Aabb) -> Self {
        let splat = |x: f32| f32x16::splat(simd, x);
        let members = mask32x16::from_bitmask(simd, members.into());
        let reach: [f32x16<S>; 3] = [0, 1, 2].map(#[inline(always)] |i| {
            let to_min = (splat(bounds.min[i]) - rays.origin[i]).abs();
            let to_max = (splat(bounds.max[i]) - rays.origin[i]).abs();
            to_min.max(to_max)
        });
        let z_pad = reach[way.longest % 3] * splat(112.0 * U);
        let least = rays.dir[way.longest % 3].abs() * splat(2.0_f32.powi(-40));
        let mut sound = mask32x16::splat(simd, true);
        let mut slab = |i: usize, widen: f32| {
            let pad = (reach[i] + rays.origin[i].abs()) * splat(8.0 * U) + z_pad;
            let d = rays.dir[i];
            let d = d.abs().simd_lt(least).select(least.copysign(d), d);
            let scale = (splat(1.0) / d) * splat(widen);
            // The near planes move towards the origin, the far ones away from it.
            let near = widen < 1.0;
            let outwards = if near == way.backward[i] { -1.0 } else { 1.0 };
            let origin = rays.origin[i] + pad * splat(outwards);
            let shift = origin * scale;
            let infinity = splat(f32::INFINITY);
            sound = sound & shift.abs().simd_lt(infinity) & scale.abs().simd_lt(infinity);
            let least = |x: f32x16<S>| members.select(x, splat(f32::INFINITY)).reduce_min();
            let greatest = |x: f32x16<S>| members.select(x, splat(f32::NEG_INFINITY)).reduce_max();
            let extreme = if outwards > 0.0 { greatest(origin) } else { least(origin) };
            Slab {
                scale,
                shift,
                origin: splat(extreme),
                scales: [splat(least(scale)), splat(greatest(scale))],
            }
        };
        let near = [0, 1, 2].map(#[inline(always)] |i| slab(i, 1.0 - 4.0 * U));
        let far = [0, 1, 2].map(#[inline(always)] |i| slab(i, 1.0 + 4.0 * U));
        Self {
            simd,
            near,
            far,
            near_bounds: [0, 1, 2].map(|i| if way.backward[i] { i + 3 } else { i }),
            far_bounds: [0, 1, 2].map(|i| if way.backward[i] { i } else { i + 3 }),
            t_min: rays.t_min,
            least_t_min: splat(members.select(rays.t_min, splat(f32::INFINITY)).reduce_min()),
            sound: sound.to_bitmask() as u32,
        }
    }

    /// A bit for each box of a node that any ray of the packet may meet before `t_max`, and bounds of the parameters of entry.
    #[inline(always)]
    pub(crate) fn meet_any(&self, node: &Node, t_max: f32) -> (u32, f32x16<S>) {
        let ends = |slab: &Slab<S>, bounds: usize| {
            let x = f32x16::<S>::simd_from(self.simd, node.bounds[bounds]) - slab.origin;
            (x * slab.scales[0], x * slab.scales[1])
        };
        let near = |i: usize| {
            let (a, b) = ends(&self.near[i], self.near_bounds[i]);
            a.min(b)
        };
        let far = |i: usize| {
            let (a, b) = ends(&self.far[i], self.far_bounds[i]);
            a.max(b)
        };
        let t_near = near(0).max(near(1)).max(near(2).max(self.least_t_min));
        let t_far = far(0).min(far(1)).min(far(2).min(f32x16::splat(self.simd, t_max)));
        (t_near.simd_le(t_far).to_bitmask() as u32, t_near)
    }

    /// A bit for each ray that meets box `place` of a node before its `t_max`.
    #[inline(always)]
    pub(crate) fn meet_box(&self, node: &Node, place: usize, t_max: f32x16<S>) -> u32 {
        let plane = |slab: &Slab<S>, bounds: usize| {
            f32x16::splat(self.simd, node.bounds[bounds][place]).mul_sub(slab.scale, slab.shift)
        };
        let near = |i: usize| plane(&self.near[i], self.near_bounds[i]);
        let far = |i: usize| plane(&self.far[i], self.far_bounds[i]);
        let t_near = near(0).max(near(1)).max(near(2).max(self.t_min));
        let t_far = far(0).min(far(1)).min(far(2).min(t_max));
        t_near.simd_le(t_far).to_bitmask() as u32
    }

    /// The greatest lane among the members.
    #[inline(always)]
    pub(crate) fn greatest(&self, t: f32x16<S>, members: u32) -> f32 {
        mask32x16::from_bitmask(self.simd, members.into())
            .select(t, f32x16::splat(self.simd, f32::NEG_INFINITY))
            .reduce_max()
    }
}
