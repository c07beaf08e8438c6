//! The rays that are traced, the same for every peer.

use crate::mesh::noise::{scramble, unit};
use crate::mesh::{Mesh, View};
use std::f32::consts::TAU;
use umbriel_kernels::glam::Vec3;
use umbriel_kernels::{Interval, MeshHit, Ray, gamma, offset_origin};

/// Rays in a block.
pub const BLOCK: usize = 16;

/// Sixteen rays for peers that take them as rows of numbers.
#[repr(C, align(64))]
#[derive(Clone, Copy)]
pub struct RayBlock {
    pub origin: [[f32; BLOCK]; 3],
    pub dir: [[f32; BLOCK]; 3],
    pub min: [f32; BLOCK],
    pub max: [f32; BLOCK],
}

/// What rays are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Primary,
    Shadow,
    Bounce,
    Occlusion,
}

impl Kind {
    pub const ALL: [(&str, Self); 4] =
        [("primary", Self::Primary), ("shadow", Self::Shadow), ("bounce", Self::Bounce), ("ao", Self::Occlusion)];

    /// Whether neighbouring rays run side by side.
    pub fn coherent(self) -> bool {
        matches!(self, Self::Primary | Self::Shadow)
    }

    /// Whether any hit is enough.
    pub fn any(self) -> bool {
        matches!(self, Self::Shadow | Self::Occlusion)
    }
}

/// Rays of one kind in both forms.
pub struct Rays {
    pub rays: Vec<Ray>,
    pub blocks: Vec<RayBlock>,
}

impl Rays {
    fn new(rays: Vec<Ray>) -> Self {
        let blocks = rays.chunks(BLOCK).map(block).collect();
        Self { rays, blocks }
    }
}

fn block(rays: &[Ray]) -> RayBlock {
    // The last block is filled with copies of its first ray, which nobody asks for.
    let ray = |k: usize| rays.get(k).unwrap_or(&rays[0]);
    RayBlock {
        origin: [0, 1, 2].map(|axis| std::array::from_fn(|k| ray(k).origin[axis])),
        dir: [0, 1, 2].map(|axis| std::array::from_fn(|k| ray(k).dir[axis])),
        min: std::array::from_fn(|k| ray(k).t.min),
        max: std::array::from_fn(|k| ray(k).t.max),
    }
}

/// Even bits of `code`: one coordinate along a Morton curve.
pub fn even_bits(code: u32) -> u32 {
    (0..16).map(|bit| (code >> (2 * bit) & 1) << bit).sum()
}

/// A pinhole camera's rays through the middles of `side` x `side` pixels (a power of two) along a Morton curve.
pub fn primary(view: &View, side: u32) -> Rays {
    let forward = (view.target - view.eye).normalize();
    let right = forward.cross(Vec3::Y).normalize();
    let up = right.cross(forward);
    let extent = (view.angle.to_radians() / 2.0).tan();
    let ray = |code: u32| {
        let at = |k: u32| extent * ((2 * k + 1) as f32 / side as f32 - 1.0);
        let (x, y) = (at(even_bits(code)), -at(even_bits(code >> 1)));
        Ray::new(view.eye, (forward + x * right + y * up).normalize())
    };
    Rays::new((0..side * side).map(ray).collect())
}

/// A generous bound for the distance of a hit point from its triangle, in every peer's arithmetic.
///
/// The same along all axes: a plane through the origin would have none along its normal, and `t` would underflow.
fn error_bound(terms: Vec3) -> Vec3 {
    Vec3::splat(gamma(32) * terms.max_element())
}

/// A point that was seen, with the normal on the seen side.
struct Point {
    p: Vec3,
    error: Vec3,
    normal: Vec3,
    number: u32,
}

impl Point {
    fn new(mesh: &Mesh, ray: &Ray, hit: &MeshHit, number: u32) -> Option<Self> {
        let [a, b, c] = mesh.indices[hit.primitive as usize].map(|i| mesh.positions[i as usize]);
        let (a, b, c) = ((1.0 - hit.u - hit.v) * a, hit.u * b, hit.v * c);
        let [pa, pb, pc] = mesh.indices[hit.primitive as usize].map(|i| mesh.positions[i as usize]);
        let normal = (pb - pa).cross(pc - pa).try_normalize()?;
        Some(Self {
            p: a + b + c,
            error: error_bound(a.abs() + b.abs() + c.abs()),
            normal: if normal.dot(ray.dir) > 0.0 { -normal } else { normal },
            number,
        })
    }

    fn ray(&self, dir: Vec3, max: f32) -> Ray {
        let origin = offset_origin(self.p, self.error, self.normal, dir);
        Ray { origin, dir, t: Interval { min: 0.0, max } }
    }

    /// From here to the light; none where the surface turns away from it.
    fn shadow(&self, light: Vec3) -> Option<Ray> {
        let dir = light - self.p;
        (dir.dot(self.normal) > 0.0).then(|| {
            let ray = self.ray(dir, 1.0);
            Ray { dir: light - ray.origin, ..ray }
        })
    }

    /// A random direction with density `cos θ / π`: a point of the unit sphere around the tip of the normal.
    fn diffuse(&self, seed: u32, max: f32) -> Ray {
        let first = scramble(self.number.wrapping_mul(2).wrapping_add(seed));
        let (z, turn) = (2.0 * unit(first) - 1.0, TAU * unit(scramble(first ^ 0x5bd1_e995)));
        let radius = (1.0 - z * z).max(0.0).sqrt();
        let dir = self.normal + 0.9999 * Vec3::new(radius * turn.cos(), radius * turn.sin(), z);
        self.ray(dir.normalize(), max)
    }
}

/// Rays of a kind that start where primary rays ended.
pub fn secondary(kind: Kind, mesh: &Mesh, primary: &Rays, hits: &[Option<MeshHit>]) -> Rays {
    let seen = primary.rays.iter().zip(hits).enumerate();
    let points = seen.filter_map(|(number, (ray, hit))| Point::new(mesh, ray, hit.as_ref()?, number as u32));
    Rays::new(match kind {
        Kind::Primary => primary.rays.clone(),
        Kind::Shadow => points.filter_map(|point| point.shadow(mesh.view.light)).collect(),
        Kind::Bounce => points.map(|point| point.diffuse(0x1000_0001, f32::INFINITY)).collect(),
        Kind::Occlusion => points.map(|point| point.diffuse(0x7000_0000, mesh.view.occlusion_length)).collect(),
    })
}
