//! Directions towards a disk.

use super::{DirectionSample, by_area};
use crate::angle::cos_sin_turn;
use std::f32::consts::PI;
use umbriel_kernels::glam::{Vec2, Vec3};

/// A point of the unit disk, uniform, and near for near `u` in `[0, 1)²`.
///
/// With `a, b = 2u − 1` the square's rings become the disk's:
/// ```text
/// |a| > |b|:  r = a, φ = π/4 · b/a         else  r = b, φ = π/2 − π/4 · a/b
/// ```
///
/// Source: Shirley & Chiu, "A Low Distortion Map Between Disk and Square", Journal of Graphics Tools 2(3), 1997.
#[inline(always)]
pub fn sample_concentric(u: Vec2) -> Vec2 {
    let square = 2.0 * u - Vec2::ONE;
    let wide = square.x.abs() > square.y.abs();
    let (r, other) = if wide {
        (square.x, square.y)
    } else {
        (square.y, square.x)
    };
    // In the centre any angle will do.
    let ratio = if r == 0.0 { 0.0 } else { other / r };
    let (cos, sin) = cos_sin_turn(0.125 * ratio);
    r * if wide {
        Vec2::new(cos, sin)
    } else {
        Vec2::new(sin, cos)
    }
}

/// A direction from `p` towards the disk with the unit normal `normal`, uniform by area; `u` in `[0, 1)²`.
///
/// The solid angle of a disk seen aslant needs elliptic integrals, so there is no closed form by solid angle. The density is 0 where the
/// disk is seen edge-on. `radius` is greater than 0.
#[inline(always)]
pub fn sample_disk(p: Vec3, center: Vec3, normal: Vec3, radius: f32, u: Vec2) -> DirectionSample {
    let (x, y) = normal.any_orthonormal_pair();
    let at = radius * sample_concentric(u);
    let to_light = center + x * at.x + y * at.y - p;
    by_area(to_light, normal, PI * radius * radius)
}

/// The density in 1/sr with which [`sample_disk`] chooses the direction of `to_light`, from the lit point to a point of the disk; 0 edge-on.
#[inline(always)]
pub fn pdf_disk(to_light: Vec3, normal: Vec3, radius: f32) -> f32 {
    by_area(to_light, normal, PI * radius * radius).pdf
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Equal parts of the square become equal parts of the disk: rings by their radius and sectors by their angle hold their share of a
    /// fine grid.
    #[test]
    fn concentric_map_keeps_areas() {
        let n = 512;
        let points: Vec<Vec2> = (0..n * n)
            .map(|i| Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32)
            .map(sample_concentric)
            .collect();
        for r in [0.25_f32, 0.5, 0.875] {
            let inside = points.iter().filter(|p| p.length() < r).count() as f32;
            assert!((inside / (n * n) as f32 - r * r).abs() < 2e-3, "{r}");
        }
        for k in 0..8 {
            let sector = |p: &&Vec2| (p.y.atan2(p.x) + PI) / (2.0 * PI) * 8.0;
            let inside = points.iter().filter(|p| sector(p) as i32 == k).count() as f32;
            assert!((inside / (n * n) as f32 - 0.125).abs() < 2e-3, "{k}");
        }
    }
}
