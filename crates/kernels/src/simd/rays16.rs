//! Sixteen rays made ready for boxes and triangles at once.

use super::box_ray::{BoxRay, Slab, U};
use super::triangle_leaf::LeafRay;
use super::ways::Ways;
use crate::{Aabb, Ray};
use fearless_simd::{Simd, f32x8, f32x16, mask32x16, prelude::*};

/// Rays made ready at a time.
pub(crate) const RAYS: usize = 16;

/// What the walks need of sixteen rays, component by component. The lanes left over by fewer rays repeat the first.
pub(crate) struct Rays16<S: Simd> {
    pub(super) origin: [f32x16<S>; 3],
    /// `d_i / d_kz`, with `kz` the longest axis.
    pub(super) slope: [f32x16<S>; 3],
    /// `1 / d_kz`.
    pub(super) scale: f32x16<S>,
    pub(super) near: [Slab16<S>; 3],
    pub(super) far: [Slab16<S>; 3],
    pub(super) t_min: f32x16<S>,
    pub(crate) t_max: f32x16<S>,
    pub(crate) ways: Ways,
}

/// The planes on one side along one axis: `t = plane·scale − shift`, or `(plane − origin)·scale`.
#[derive(Clone, Copy)]
pub(super) struct Slab16<S: Simd> {
    pub(super) scale: f32x16<S>,
    pub(super) shift: f32x16<S>,
    /// The ray's origin moved by the pad.
    pub(super) origin: f32x16<S>,
}

/// The vectors of one component of the rays, in the order of [`Ray`]'s fields.
#[inline(always)]
fn transpose<S: Simd>(simd: S, rays: &[Ray]) -> [f32x16<S>; 8] {
    let [a, b, c, d, e, f, g, h] = transpose_8(simd, rays, 0);
    let [i, j, k, l, m, n, o, p] = transpose_8(simd, rays, 8);
    [
        a.combine(i),
        b.combine(j),
        c.combine(k),
        d.combine(l),
        e.combine(m),
        f.combine(n),
        g.combine(o),
        h.combine(p),
    ]
}

/// Eight rays from `first` on: three rounds in which the first half is riffled with the second.
#[inline(always)]
fn transpose_8<S: Simd>(simd: S, rays: &[Ray], first: usize) -> [f32x8<S>; 8] {
    let rows = [
        row(simd, rays, first),
        row(simd, rays, first + 1),
        row(simd, rays, first + 2),
        row(simd, rays, first + 3),
        row(simd, rays, first + 4),
        row(simd, rays, first + 5),
        row(simd, rays, first + 6),
        row(simd, rays, first + 7),
    ];
    riffle(riffle(riffle(rows)))
}

#[inline(always)]
fn row<S: Simd>(simd: S, rays: &[Ray], i: usize) -> f32x8<S> {
    let ray = if i < rays.len() { &rays[i] } else { &rays[0] };
    let (o, d) = (ray.origin, ray.dir);
    f32x8::simd_from(simd, [o.x, o.y, o.z, d.x, d.y, d.z, ray.t.min, ray.t.max])
}

#[inline(always)]
fn riffle<S: Simd>([a, b, c, d, e, f, g, h]: [f32x8<S>; 8]) -> [f32x8<S>; 8] {
    [
        a.zip_low(e),
        a.zip_high(e),
        b.zip_low(f),
        b.zip_high(f),
        c.zip_low(g),
        c.zip_high(g),
        d.zip_low(h),
        d.zip_high(h),
    ]
}

impl<S: Simd> Rays16<S> {
    /// At most sixteen rays, and at least one, for a tree with these bounds, taken to be wider on all sides by `stretch` times the
    /// greatest distance of a ray's origin from them.
    #[inline(always)]
    pub(crate) fn new(simd: S, rays: &[Ray], bounds: Aabb, stretch: f32) -> Self {
        let [ox, oy, oz, dx, dy, dz, t_min, t_max] = transpose(simd, rays);
        let (origin, dir) = ([ox, oy, oz], [dx, dy, dz]);
        let axis = LongestAxis::new(dir);
        let d_kz = axis.of(dir);
        let longest = d_kz.abs();
        let scale = f32x16::splat(simd, 1.0) / d_kz;
        let infinity = f32x16::splat(simd, f32::INFINITY);
        let sound = t_min.simd_lt(t_max)
            & are_finite(origin, infinity)
            & are_finite(dir, infinity)
            & are_in_proportion(simd, origin, longest);

        let reach = [
            reach(simd, ox, bounds.min.x, bounds.max.x),
            reach(simd, oy, bounds.min.y, bounds.max.y),
            reach(simd, oz, bounds.min.z, bounds.max.z),
        ];
        let more = reach[0].max(reach[1]).max(reach[2]) * f32x16::splat(simd, stretch);
        let reach = [reach[0] + more, reach[1] + more, reach[2] + more];
        let pad = axis.of(reach) * f32x16::splat(simd, 112.0 * U);
        let least = longest * f32x16::splat(simd, 2.0_f32.powi(-40));
        let (nx, fx) = slabs(simd, ox, dx, reach[0], pad, least);
        let (ny, fy) = slabs(simd, oy, dy, reach[1], pad, least);
        let (nz, fz) = slabs(simd, oz, dz, reach[2], pad, least);
        let (near, far) = ([nx, ny, nz], [fx, fy, fz]);
        let in_range = are_in_range(near, infinity) & are_in_range(far, infinity);
        let used = ((1_u64 << rays.len().min(RAYS)) - 1) as u32;
        Self {
            origin,
            slope: [dx / d_kz, dy / d_kz, dz / d_kz],
            scale,
            near,
            far,
            t_min,
            t_max,
            ways: Ways {
                backward: [backward(simd, dx), backward(simd, dy), backward(simd, dz)],
                longer_y: axis.longer_y.to_bitmask() as u32,
                longest_z: axis.longest_z.to_bitmask() as u32,
                sound: sound.to_bitmask() as u32 & used,
                in_range: in_range.to_bitmask() as u32,
            },
        }
    }

    /// Leaves out the rays from so far away that what is within `bounds` is smaller than the rounding of its distance.
    #[inline(always)]
    pub(crate) fn leave_out_far(mut self, simd: S, bounds: Aabb) -> Self {
        let extent = (bounds.max - bounds.min).max_element();
        let near = f32x16::splat(simd, extent * (1.0 / U));
        let x = reach(simd, self.origin[0], bounds.min.x, bounds.max.x).simd_le(near);
        let y = reach(simd, self.origin[1], bounds.min.y, bounds.max.y).simd_le(near);
        let z = reach(simd, self.origin[2], bounds.min.z, bounds.max.z).simd_le(near);
        self.ways.sound &= (x & y & z).to_bitmask() as u32;
        self
    }

    /// The rays apart.
    #[inline(always)]
    pub(crate) fn lanes(&self) -> RayLanes {
        RayLanes {
            origin: [
                self.origin[0].into(),
                self.origin[1].into(),
                self.origin[2].into(),
            ],
            slope: [
                self.slope[0].into(),
                self.slope[1].into(),
                self.slope[2].into(),
            ],
            scale: self.scale.into(),
            near: [
                self.near[0].lanes(),
                self.near[1].lanes(),
                self.near[2].lanes(),
            ],
            far: [
                self.far[0].lanes(),
                self.far[1].lanes(),
                self.far[2].lanes(),
            ],
            t_min: self.t_min.into(),
            ways: self.ways,
        }
    }
}

/// Along which axis each direction is the longest.
struct LongestAxis<S: Simd> {
    longer_y: mask32x16<S>,
    longest_z: mask32x16<S>,
}

impl<S: Simd> LongestAxis<S> {
    #[inline(always)]
    fn new([dx, dy, dz]: [f32x16<S>; 3]) -> Self {
        let (x, y, z) = (dx.abs(), dy.abs(), dz.abs());
        let longer_y = y.simd_gt(x);
        Self {
            longer_y,
            longest_z: z.simd_gt(longer_y.select(y, x)),
        }
    }

    /// That component of each vector.
    #[inline(always)]
    fn of(&self, [x, y, z]: [f32x16<S>; 3]) -> f32x16<S> {
        self.longest_z.select(z, self.longer_y.select(y, x))
    }
}

#[inline(always)]
fn are_finite<S: Simd>([x, y, z]: [f32x16<S>; 3], infinity: f32x16<S>) -> mask32x16<S> {
    x.abs().simd_lt(infinity) & y.abs().simd_lt(infinity) & z.abs().simd_lt(infinity)
}

/// Directions of at most 2¹²⁶ along their longest axis, not shorter than 2⁻⁸⁶ times the origin or 1.
#[inline(always)]
fn are_in_proportion<S: Simd>(
    simd: S,
    [x, y, z]: [f32x16<S>; 3],
    longest: f32x16<S>,
) -> mask32x16<S> {
    let furthest = x.abs().max(y.abs()).max(z.abs());
    let furthest = furthest.max(f32x16::splat(simd, 1.0));
    furthest.simd_lt(longest * f32x16::splat(simd, 2.0_f32.powi(86)))
        & longest.simd_le(f32x16::splat(simd, 2.0_f32.powi(126)))
}

#[inline(always)]
fn are_in_range<S: Simd>([x, y, z]: [Slab16<S>; 3], infinity: f32x16<S>) -> mask32x16<S> {
    x.in_range(infinity) & y.in_range(infinity) & z.in_range(infinity)
}

/// Lanes with the sign bit.
#[inline(always)]
fn backward<S: Simd>(simd: S, d: f32x16<S>) -> u32 {
    let sign = f32x16::splat(simd, 1.0).copysign(d);
    sign.simd_lt(f32x16::splat(simd, 0.0)).to_bitmask() as u32
}

/// The greatest distance from the origin to the bounds along an axis.
#[inline(always)]
fn reach<S: Simd>(simd: S, origin: f32x16<S>, min: f32, max: f32) -> f32x16<S> {
    let to_min = (f32x16::splat(simd, min) - origin).abs();
    to_min.max((f32x16::splat(simd, max) - origin).abs())
}

/// The near and the far planes along an axis; `pad` without the axis's own part.
#[inline(always)]
fn slabs<S: Simd>(
    simd: S,
    origin: f32x16<S>,
    dir: f32x16<S>,
    reach: f32x16<S>,
    pad: f32x16<S>,
    least: f32x16<S>,
) -> (Slab16<S>, Slab16<S>) {
    let pad = (reach + origin.abs()) * f32x16::splat(simd, 8.0 * U) + pad;
    let d = dir.abs().simd_lt(least).select(least.copysign(dir), dir);
    let pad = pad.copysign(d);
    let inv = f32x16::splat(simd, 1.0) / d;
    (
        Slab16::new(origin + pad, inv * f32x16::splat(simd, 1.0 - 4.0 * U)),
        Slab16::new(origin - pad, inv * f32x16::splat(simd, 1.0 + 4.0 * U)),
    )
}

impl<S: Simd> Slab16<S> {
    #[inline(always)]
    fn new(origin: f32x16<S>, scale: f32x16<S>) -> Self {
        Self {
            scale,
            shift: origin * scale,
            origin,
        }
    }

    #[inline(always)]
    fn in_range(&self, infinity: f32x16<S>) -> mask32x16<S> {
        self.shift.abs().simd_lt(infinity) & self.scale.abs().simd_lt(infinity)
    }

    #[inline(always)]
    fn lanes(&self) -> [[f32; RAYS]; 2] {
        [self.scale.into(), self.shift.into()]
    }
}

/// Sixteen rays that are ready, to be taken one by one.
pub(crate) struct RayLanes {
    origin: [[f32; RAYS]; 3],
    slope: [[f32; RAYS]; 3],
    scale: [f32; RAYS],
    near: [[[f32; RAYS]; 2]; 3],
    far: [[[f32; RAYS]; 2]; 3],
    t_min: [f32; RAYS],
    ways: Ways,
}

impl RayLanes {
    /// Ray `i` for boxes.
    #[inline(always)]
    pub(crate) fn box_ray(&self, i: usize) -> BoxRay {
        let i = i % RAYS;
        let bit = |mask: u32| mask >> i & 1;
        let slab = |[scale, shift]: &[[f32; RAYS]; 2]| Slab {
            scale: scale[i],
            shift: shift[i],
        };
        BoxRay {
            near: [
                slab(&self.near[0]),
                slab(&self.near[1]),
                slab(&self.near[2]),
            ],
            far: [slab(&self.far[0]), slab(&self.far[1]), slab(&self.far[2])],
            first: [
                3 * bit(self.ways.backward[0]),
                3 * bit(self.ways.backward[1]),
                3 * bit(self.ways.backward[2]),
            ],
            t_min: self.t_min[i],
            everywhere: bit(self.ways.in_range) == 0,
        }
    }

    /// Ray `i` for leaves.
    #[inline(always)]
    pub(crate) fn leaf_ray(&self, i: usize) -> LeafRay {
        let i = i % RAYS;
        let axes = self.ways.axes(i);
        let [x, y, z] = axes;
        LeafRay {
            axes,
            origin: [self.origin[x][i], self.origin[y][i], self.origin[z][i]],
            shear: [self.slope[x][i], self.slope[y][i], self.scale[i]],
            t_min: self.t_min[i],
        }
    }
}
