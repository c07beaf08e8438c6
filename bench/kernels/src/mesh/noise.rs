//! Smooth noise that is the same on every machine: sums and products only.

use umbriel_kernels::glam::{IVec3, Vec3};

/// A number in `[0, 2³²)` that depends on every bit of `x`: the finaliser of MurmurHash3.
///
/// Source: Appleby, "MurmurHash3", 2011.
pub fn scramble(mut x: u32) -> u32 {
    x = (x ^ x >> 16).wrapping_mul(0x85eb_ca6b);
    x = (x ^ x >> 13).wrapping_mul(0xc2b2_ae35);
    x ^ x >> 16
}

/// A number in `[0, 1)`.
pub fn unit(x: u32) -> f32 {
    (x >> 8) as f32 / (1 << 24) as f32
}

fn lattice(p: IVec3) -> f32 {
    let row = scramble(p.z as u32 ^ 0x9e37_79b9);
    2.0 * unit(scramble(p.x as u32 ^ scramble(p.y as u32 ^ row))) - 1.0
}

/// Value noise in `[-1, 1]`: random values at whole numbers, between them by a quintic with two continuous derivatives.
fn value(p: Vec3) -> f32 {
    let (cell, f) = (p.floor().as_ivec3(), p - p.floor());
    let w = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    let mix = |a: f32, b: f32, w: f32| a + (b - a) * w;
    let along = |y, z| mix(lattice(cell + IVec3::new(0, y, z)), lattice(cell + IVec3::new(1, y, z)), w.x);
    mix(mix(along(0, 0), along(1, 0), w.y), mix(along(0, 1), along(1, 1), w.y), w.z)
}

/// Sum of `octaves` of noise, each twice as fine and half as strong.
pub fn fractal(p: Vec3, octaves: u32) -> f32 {
    (0..octaves).map(|k| value(p * (1 << k) as f32 + k as f32 * 17.31) / (1 << k) as f32).sum()
}

/// Ridges: octaves of `(1 - |noise|)²`, each weighted by the one before, so that valleys stay smooth.
///
/// Source: Musgrave, "Texturing and Modeling: A Procedural Approach", 3rd ed., 2003, chapter 16.
pub fn ridged(p: Vec3, octaves: u32) -> f32 {
    let (mut sum, mut weight) = (0.0, 1.0);
    for k in 0..octaves {
        let ridge = 1.0 - value(p * (1 << k) as f32 + k as f32 * 17.31).abs();
        let signal = ridge * ridge * weight;
        sum += signal / (1 << k) as f32;
        weight = (2.0 * signal).clamp(0.0, 1.0);
    }
    sum
}
