//! Directions towards a triangle.

use super::{DirectionSample, LEAST_SOLID_ANGLE, by_area};
use crate::angle::{acos, cos_sin_turn};
use std::f32::consts::{PI, TAU};
use umbriel_kernels::{
    Triangle,
    glam::{Vec2, Vec3},
};

/// A triangle as it is seen from a point: unit directions to its corners and the angles between the great circles at them.
struct SphericalTriangle {
    a: Vec3,
    b: Vec3,
    c: Vec3,
    alpha: f32,
    cos_alpha: f32,
    sin_alpha: f32,
    solid_angle: f32,
}

impl SphericalTriangle {
    /// Its solid angle is 0 where a corner is at `p`, or two corners are seen in one direction or in opposite ones.
    #[inline(always)]
    fn new(p: Vec3, triangle: &Triangle) -> Self {
        let a = (triangle.a - p).normalize_or_zero();
        let b = (triangle.b - p).normalize_or_zero();
        let c = (triangle.c - p).normalize_or_zero();
        let ab = a.cross(b).normalize_or_zero();
        let bc = b.cross(c).normalize_or_zero();
        let ca = c.cross(a).normalize_or_zero();
        let cos_alpha = -ab.dot(ca);
        let (alpha, beta, gamma) = (acos(cos_alpha), acos(-bc.dot(ab)), acos(-ca.dot(bc)));
        let is_seen = ab != Vec3::ZERO && bc != Vec3::ZERO && ca != Vec3::ZERO;
        Self {
            a,
            b,
            c,
            alpha,
            cos_alpha,
            sin_alpha: (1.0 - cos_alpha * cos_alpha).max(0.0).sqrt(),
            solid_angle: if is_seen {
                alpha + beta + gamma - PI
            } else {
                0.0
            },
        }
    }

    /// A unit direction into the triangle, uniform by solid angle.
    ///
    /// The corner `C` is moved along its side `AC` so that the part `A B C'` has the fraction `u₀` of the area; the direction is then on the
    /// arc from `B` to `C'`. With `φ = u₀ Ω − α`, `s, t = sin φ, cos φ`:
    /// ```text
    /// cos b' = ((v t − u s) cos α − v) / ((v s + u t) sin α)       u = t − cos α,  v = s + sin α (A·B)
    /// ```
    ///
    /// Source: Arvo, "Stratified Sampling of Spherical Triangles", SIGGRAPH 1995.
    #[inline(always)]
    fn sample(&self, random: Vec2) -> Vec3 {
        let phi = random.x * self.solid_angle - self.alpha;
        let (t, s) = cos_sin_turn(phi / TAU);
        let u = t - self.cos_alpha;
        let v = s + self.sin_alpha * self.a.dot(self.b);
        let below = (v * s + u * t) * self.sin_alpha;
        let cos_b = (((v * t - u * s) * self.cos_alpha - v) / below).clamp(-1.0, 1.0);
        let sin_b = (1.0 - cos_b * cos_b).sqrt();
        let towards_c = (self.c - self.a * self.c.dot(self.a)).normalize_or(self.b);
        let moved = self.a * cos_b + towards_c * sin_b;
        let cos_theta = 1.0 - random.y * (1.0 - moved.dot(self.b));
        let sin_theta = (1.0 - cos_theta * cos_theta).max(0.0).sqrt();
        let towards_moved = (moved - self.b * moved.dot(self.b)).normalize_or(self.a);
        self.b * cos_theta + towards_moved * sin_theta
    }
}

/// A direction from `p` towards the triangle, uniform by solid angle; `random` in `[0, 1)²`.
///
/// Very small solid angles, and triangles of which a corner is at `p`, are sampled by area. The density is 0 for a triangle without area and
/// one seen edge-on.
#[inline(always)]
pub fn sample_triangle(p: Vec3, triangle: &Triangle, random: Vec2) -> DirectionSample {
    let (normal, area) = plane_of(triangle);
    let seen = SphericalTriangle::new(p, triangle);
    let wi = seen.sample(random);
    let distance = (triangle.a - p).dot(normal) / wi.dot(normal);
    let reaches = distance > 0.0 && distance < f32::INFINITY;
    let large = DirectionSample {
        wi,
        distance,
        pdf: if reaches { 1.0 / seen.solid_angle } else { 0.0 },
    };
    let root = random.x.sqrt();
    let (b, c) = (root * (1.0 - random.y), root * random.y);
    let at = triangle.a + (triangle.b - triangle.a) * b + (triangle.c - triangle.a) * c;
    let small = by_area(at - p, normal, area);
    DirectionSample::select(seen.solid_angle > LEAST_SOLID_ANGLE, large, small)
}

/// The density in 1/sr with which [`sample_triangle`] chooses the direction of `to_light`, from `p` to a point of the triangle; 0 edge-on.
#[inline(always)]
pub fn pdf_triangle(p: Vec3, triangle: &Triangle, to_light: Vec3) -> f32 {
    let seen = SphericalTriangle::new(p, triangle);
    if seen.solid_angle > LEAST_SOLID_ANGLE {
        return 1.0 / seen.solid_angle;
    }
    let (normal, area) = plane_of(triangle);
    by_area(to_light, normal, area).pdf
}

/// The unit normal and the area; both 0 without an area.
#[inline(always)]
fn plane_of(triangle: &Triangle) -> (Vec3, f32) {
    let cross = (triangle.b - triangle.a).cross(triangle.c - triangle.a);
    (cross.normalize_or_zero(), 0.5 * cross.length())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: Triangle = Triangle {
        a: Vec3::new(-1.0, 0.0, 2.0),
        b: Vec3::new(2.0, 0.5, 1.0),
        c: Vec3::new(0.0, 1.5, 3.0),
    };

    /// An octant's face fills an eighth of the sphere.
    #[test]
    fn octant_has_an_eighth_of_the_sphere() {
        let octant = Triangle {
            a: Vec3::X,
            b: Vec3::Y,
            c: Vec3::Z,
        };
        let seen = SphericalTriangle::new(Vec3::ZERO, &octant);
        assert!((seen.solid_angle - PI / 2.0).abs() < 1e-5);
    }

    #[test]
    fn samples_lie_in_the_triangle() {
        let (normal, area) = plane_of(&TRIANGLE);
        for p in [
            Vec3::ZERO,
            Vec3::new(0.3, 0.6, 1.8),
            Vec3::new(50.0, -30.0, 80.0),
        ] {
            for i in 0..1000 {
                let random = Vec2::new((i as f32 + 0.5) / 1000.0, (i * 37 % 1000) as f32 / 1000.0);
                let sample = sample_triangle(p, &TRIANGLE, random);
                let at = p + sample.wi * sample.distance;
                let part = |q: Vec3, r: Vec3| 0.5 * (q - at).cross(r - at).dot(normal) / area;
                let weights = [
                    part(TRIANGLE.b, TRIANGLE.c),
                    part(TRIANGLE.c, TRIANGLE.a),
                    part(TRIANGLE.a, TRIANGLE.b),
                ];
                assert!(
                    weights.iter().all(|w| *w > -2e-3),
                    "{p} {random}: {weights:?}"
                );
            }
        }
    }
}
