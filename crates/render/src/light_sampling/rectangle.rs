//! Directions towards a rectangle.

use super::{DirectionSample, LEAST_SOLID_ANGLE, by_area};
use crate::angle::{acos, cos_sin_turn};
use std::f32::consts::TAU;
use umbriel_kernels::glam::{Vec2, Vec3};

/// The rectangle as it is seen from a point: its corners in a frame whose z axis points away from it along its normal.
///
/// Symbols as in the source: the rectangle spans `[x0, x1] x [y0, y1]` at `z0 < 0`; `b0`, `b1` are the z components of the normals of the
/// pyramid's sides below and above, `k` turns the area of a strip into an angle, and `solid_angle` is in steradian.
struct SphericalRectangle {
    x: Vec3,
    y: Vec3,
    z: Vec3,
    x0: f32,
    x1: f32,
    y0: f32,
    y1: f32,
    z0: f32,
    b0: f32,
    b1: f32,
    k: f32,
    solid_angle: f32,
}

impl SphericalRectangle {
    /// `center ± u ± v` are the corners; `u` and `v` are half of the edges, at a right angle.
    ///
    /// Source: Ureña, Fajardo & King, "An Area-Preserving Parametrization for Spherical Rectangles", Computer Graphics Forum 32(4), 2013.
    #[inline(always)]
    fn new(p: Vec3, center: Vec3, u: Vec3, v: Vec3) -> Self {
        let (half_x, half_y) = (u.length(), v.length());
        let (x, y) = (u / half_x, v / half_y);
        let normal = x.cross(y);
        let d = center - p;
        let above = d.dot(normal);
        let z = if above > 0.0 { -normal } else { normal };
        let z0 = -above.abs();
        let (x0, x1) = (d.dot(x) - half_x, d.dot(x) + half_x);
        let (y0, y1) = (d.dot(y) - half_y, d.dot(y) + half_y);
        // The normals of the four sides lie in the planes of their edges and the eye: n = (0, z0, −y0) and so on, of unit length.
        let b0 = -y0 / (z0 * z0 + y0 * y0).sqrt();
        let b1 = y1 / (z0 * z0 + y1 * y1).sqrt();
        let c0 = x1 / (z0 * z0 + x1 * x1).sqrt();
        let c1 = -x0 / (z0 * z0 + x0 * x0).sqrt();
        let (g0, g1) = (acos(-b0 * c0), acos(-c0 * b1));
        let (g2, g3) = (acos(-b1 * c1), acos(-c1 * b0));
        let k = TAU - g2 - g3;
        Self {
            x,
            y,
            z,
            x0,
            x1,
            y0,
            y1,
            z0,
            b0,
            b1,
            k,
            solid_angle: g0 + g1 - k,
        }
    }

    /// The vector from the eye to a point of the rectangle, uniform by solid angle.
    #[inline(always)]
    fn sample(&self, u: Vec2) -> Vec3 {
        let (cos_au, sin_au) = cos_sin_turn((u.x * self.solid_angle + self.k) / TAU);
        let fu = (cos_au * self.b0 - self.b1) / sin_au;
        let cu = (fu.signum() / (fu * fu + self.b0 * self.b0).sqrt()).clamp(-1.0, 1.0);
        let xu = -(cu * self.z0) / (1.0 - cu * cu).max(1e-12).sqrt();
        // Not `clamp`, which panics for what is no number: lanes that are not in use may hold anything.
        let xu = xu.max(self.x0).min(self.x1);
        let d2 = xu * xu + self.z0 * self.z0;
        let h0 = self.y0 / (d2 + self.y0 * self.y0).sqrt();
        let h1 = self.y1 / (d2 + self.y1 * self.y1).sqrt();
        let hv = h0 + u.y * (h1 - h0);
        let yv = hv * (d2 / (1.0 - hv * hv).max(1e-12)).sqrt();
        let yv = yv.max(self.y0).min(self.y1);
        self.x * xu + self.y * yv + self.z * self.z0
    }
}

/// A direction from `p` towards the rectangle of the corners `center ± u ± v`, uniform by solid angle; `random` in `[0, 1)²`.
///
/// `u` and `v` are at a right angle and longer than 0. Very small solid angles are sampled by area. The density is 0 where the
/// rectangle is seen edge-on.
#[inline(always)]
pub fn sample_rectangle(p: Vec3, center: Vec3, u: Vec3, v: Vec3, random: Vec2) -> DirectionSample {
    let seen = SphericalRectangle::new(p, center, u, v);
    let to_point = center + u * (2.0 * random.x - 1.0) + v * (2.0 * random.y - 1.0) - p;
    let small = by_area(to_point, seen.z, 4.0 * u.length() * v.length());
    let to_light = seen.sample(random);
    let distance = to_light.length();
    let large = DirectionSample {
        wi: to_light / distance,
        distance,
        pdf: 1.0 / seen.solid_angle,
    };
    DirectionSample::select(seen.solid_angle > LEAST_SOLID_ANGLE, large, small)
}

/// The density in 1/sr with which [`sample_rectangle`] chooses the direction of `to_light`, from `p` to a point of the rectangle; 0 edge-on.
#[inline(always)]
pub fn pdf_rectangle(p: Vec3, center: Vec3, u: Vec3, v: Vec3, to_light: Vec3) -> f32 {
    let seen = SphericalRectangle::new(p, center, u, v);
    if seen.solid_angle > LEAST_SOLID_ANGLE {
        return 1.0 / seen.solid_angle;
    }
    by_area(to_light, seen.z, 4.0 * u.length() * v.length()).pdf
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::PI;

    /// A cube's face fills a sixth of the directions around its middle.
    #[test]
    fn face_of_a_cube_has_a_sixth_of_the_sphere() {
        let seen = SphericalRectangle::new(Vec3::ZERO, Vec3::Y, Vec3::X, Vec3::Z);
        assert!(
            (seen.solid_angle - 4.0 * PI / 6.0).abs() < 1e-5,
            "{}",
            seen.solid_angle
        );
    }

    #[test]
    fn samples_lie_in_the_rectangle() {
        let (center, u, v) = (
            Vec3::new(0.5, 2.0, 1.0),
            Vec3::new(1.5, 0.0, 0.0),
            0.25 * Vec3::Z,
        );
        for p in [
            Vec3::ZERO,
            Vec3::new(0.5, 1.9, 1.0),
            Vec3::new(-4.0, 3.0, 2.0),
            100.0 * Vec3::X,
        ] {
            for i in 0..1000 {
                let random = Vec2::new(i as f32 / 1000.0, (i * 37 % 1000) as f32 / 1000.0);
                let sample = sample_rectangle(p, center, u, v, random);
                let at = p + sample.wi * sample.distance - center;
                let scale = 1e-5 * (1.0 + sample.distance);
                assert!(at.y.abs() < scale, "{p} {random}: {at}");
                assert!(
                    at.x.abs() <= 1.5 + scale && at.z.abs() <= 0.25 + scale,
                    "{p}: {at}"
                );
                let pdf = pdf_rectangle(p, center, u, v, sample.wi * sample.distance);
                assert!((pdf / sample.pdf - 1.0).abs() < 1e-3);
            }
        }
    }
}
