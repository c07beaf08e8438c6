//! Places on a light of some size.

use std::f32::consts::TAU;
use umbriel_kernels::{
    glam::{Vec2, Vec3},
    mix_bits,
};

/// The place number `sample` in the unit disk, for a point whose pattern is turned by `turn` of a full turn.
///
/// The first places of any number cover the disk evenly, with equal areas: a sequence of low discrepancy in polar coordinates,
/// ```text
/// (u, v)_i = (i + ½)·(1/g, 1/g²)  mod 1,   g³ = g + 1
/// r = √u      φ = 2π (v + turn)
/// ```
/// Source: Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018 (the sequence); Shirley & Chiu, "A Low Distortion Map
/// Between Disk and Square", Journal of Graphics Tools 2(3), 1997 (equal areas in polar coordinates).
pub fn disk_point(sample: u32, turn: f32) -> Vec2 {
    // 2³²/g and 2³²/g².
    const STEP: [u32; 2] = [3_242_174_889, 2_447_445_414];
    let [u, v] = STEP.map(|step| {
        let bits = sample.wrapping_mul(step).wrapping_add(step / 2);
        (bits >> 8) as f32 / (1 << 24) as f32
    });
    Vec2::from_angle(TAU * (v + turn)) * u.sqrt()
}

/// A number in `[0, 1)` of each pixel's own.
pub(crate) fn turn_of(pixel: u32) -> f32 {
    (mix_bits(u64::from(pixel)) >> 40) as f32 / (1 << 24) as f32
}

/// The disk of a light of some size, as a point sees it: across the way to the light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightDisk {
    to_light: Vec3,
    /// Radius times two unit vectors across.
    across: [Vec3; 2],
}

impl LightDisk {
    /// `radius` in the units of `to_light`.
    pub(crate) fn new(to_light: Vec3, radius: f32) -> Self {
        let (u, v) = to_light.normalize_or(Vec3::Y).any_orthonormal_pair();
        Self {
            to_light,
            across: [u * radius, v * radius],
        }
    }

    /// The way to a place in the unit disk.
    pub(crate) fn towards(&self, place: Vec2) -> Vec3 {
        self.to_light + self.across[0] * place.x + self.across[1] * place.y
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TruthSettings;

    /// The part of the unit disk with x below `edge`.
    fn segment(edge: f32) -> f32 {
        let x = edge.clamp(-1.0, 1.0);
        (x * (1.0 - x * x).sqrt() + x.asin()) / std::f32::consts::PI + 0.5
    }

    /// The error that is stated for the truth in penumbras: straight edges across the disk, from all sides.
    #[test]
    fn the_covered_part_is_known_to_the_stated_error() {
        for rays in [32, 256, 1024] {
            let settings = TruthSettings {
                rays,
                ..TruthSettings::default()
            };
            let mut worst = 0.0_f32;
            for pixel in 0..200 {
                let turn = turn_of(pixel);
                for step in -10..=10 {
                    let edge = step as f32 / 10.5;
                    let below = (0..rays).filter(|&i| disk_point(i, turn).x < edge);
                    let part = below.count() as f32 / rays as f32;
                    worst = worst.max((part - segment(edge)).abs());
                }
            }
            assert!(worst <= settings.error(), "{worst} with {rays}");
        }
    }

    #[test]
    fn places_are_in_the_disk_and_ways_end_on_the_light() {
        assert!((0..1000).all(|i| disk_point(i, 0.3).length() <= 1.0));
        let disk = LightDisk::new(Vec3::new(0.0, 3.0, 4.0), 0.5);
        let way = disk.towards(Vec2::new(0.6, -0.8)) - Vec3::new(0.0, 3.0, 4.0);
        assert!(
            (way.length() - 0.5).abs() < 1e-6 && way.dot(Vec3::new(0.0, 3.0, 4.0)).abs() < 1e-5
        );
    }
}
