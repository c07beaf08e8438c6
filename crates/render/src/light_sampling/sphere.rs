//! Directions towards a sphere.

use super::DirectionSample;
use crate::angle::cos_sin_turn;
use std::f32::consts::TAU;
use umbriel_kernels::glam::{Vec2, Vec3};

/// A direction from `p` towards the sphere, uniform in the cone that it fills; `u` in `[0, 1)²`.
///
/// With `sin θ_max = r/|c − p|` the directions of the cone have
/// ```text
/// 1 − cos θ = u₀ (1 − cos θ_max)      φ = 2π u₁      p(ω) = 1/(2π (1 − cos θ_max))
/// ```
/// From inside the sphere fills all directions, which are then uniform on the whole sphere of directions. `radius` is greater than 0.
///
/// Source: Shirley, Wang & Zimmerman, "Monte Carlo Techniques for Direct Lighting Calculations", ACM Transactions on Graphics 15(1), 1996;
/// Pharr, Jakob & Humphreys, "Physically Based Rendering", 4th ed., 2023, section 6.2.4 (small angles).
#[inline(always)]
pub fn sample_sphere(p: Vec3, center: Vec3, radius: f32, u: Vec2) -> DirectionSample {
    let to_center = center - p;
    let height = cone_height(to_center, radius);
    let h = u.x * height;
    let cos = 1.0 - h;
    let sin = (h * (2.0 - h)).max(0.0).sqrt();
    let (cos_phi, sin_phi) = cos_sin_turn(u.y);
    let axis = to_center.normalize_or(Vec3::Z);
    let (x, y) = axis.any_orthonormal_pair();
    let wi = (x * (sin * cos_phi) + y * (sin * sin_phi) + axis * cos).normalize();
    DirectionSample {
        wi,
        distance: distance_to(p, to_center, radius, wi),
        pdf: 1.0 / (TAU * height),
    }
}

/// The density in 1/sr with which [`sample_sphere`] chooses any direction that meets the sphere.
#[inline(always)]
pub fn pdf_sphere(p: Vec3, center: Vec3, radius: f32) -> f32 {
    1.0 / (TAU * cone_height(center - p, radius))
}

/// `1 − cos θ_max`, without the cancellation of far spheres; 2 from inside.
#[inline(always)]
fn cone_height(to_center: Vec3, radius: f32) -> f32 {
    let sin2 = radius * radius / to_center.length_squared();
    if sin2 < 1.0 {
        sin2 / (1.0 + (1.0 - sin2).sqrt())
    } else {
        2.0
    }
}

/// The first distance of the sphere in the direction `wi`, less what rounding may take off it where the direction grazes the sphere: a ray that
/// ends there does not meet it. For directions that miss by rounding, that of the nearest approach.
#[inline(always)]
fn distance_to(p: Vec3, to_center: Vec3, radius: f32, wi: Vec3) -> f32 {
    let along = to_center.dot(wi);
    let aside2 = (to_center - wi * along).length_squared();
    let half = (radius * radius - aside2).max(0.0).sqrt();
    // Points are known to a few ulps of their coordinates; along a ray that is more by the inverse cosine, radius over half chord.
    let error = 4.0 * f32::EPSILON * (p.abs().max_element() + radius);
    let rounding = error * radius / half.max(error);
    // A point of the sphere itself sees the far side, on whichever side of it rounding left the point.
    let first = if along - half > rounding {
        along - half
    } else {
        along + half
    };
    (first - rounding).max(0.5 * first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::PI;

    #[test]
    fn far_spheres_keep_their_solid_angle() {
        let solid_angle = |to_center: Vec3| TAU * cone_height(to_center, 1.0);
        let angle = solid_angle(Vec3::new(0.0, 0.0, 1e4));
        assert!((angle / (PI * 1e-8) - 1.0).abs() < 1e-6, "{angle}");
        assert_eq!(solid_angle(Vec3::ZERO), 4.0 * PI);
    }

    #[test]
    fn samples_lie_on_the_sphere() {
        let center = Vec3::new(1.0, 2.0, -3.0);
        for p in [
            Vec3::ZERO,
            center + Vec3::splat(0.1),
            Vec3::new(1.0, 2.0, -1.4),
        ] {
            for i in 0..1000 {
                let u = Vec2::new(i as f32 / 1000.0, (i * 37 % 1000) as f32 / 1000.0);
                let sample = sample_sphere(p, center, 1.5, u);
                let on = p + sample.wi * sample.distance;
                assert!(((on - center).length() - 1.5).abs() < 2e-3, "{p} {u}");
                assert_eq!(sample.pdf, pdf_sphere(p, center, 1.5));
            }
        }
    }
}
