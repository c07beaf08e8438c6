//! A box and a cone around lights, and how much they may give to a point.

use std::f32::consts::{FRAC_PI_2, PI};
use umbriel_kernels::{Aabb, glam::Vec3};

/// Where a group of lights is, where it shines, and how much. Each light shines up to a right angle from its normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightBounds {
    /// A box around the lights.
    pub aabb: Aabb,
    /// Unit axis of the cone of their normals.
    pub axis: Vec3,
    /// The cosine of half of the angle of that cone, in `[-1, 1]`: 1 for one normal, -1 for all.
    pub cos_normals: f32,
    /// Power, in any unit that all have in common; greater than 0.
    pub power: f32,
}

impl LightBounds {
    /// About what the lights may send to a point `p` that faces `n`, over their distance squared; without `n`, to a point that takes
    /// light from all sides. It is 0 only where none of them shines.
    ///
    /// With `θ_u` the angle that the box fills as seen from `p`, `θ` between the axis and the way to `p`, `θ_o` that of the cone, `θ_i`
    /// between `n` and the way to the lights:
    /// ```text
    /// I = Φ max(0, cos max(0, θ − θ_o − θ_u)) max(0, cos max(0, θ_i − θ_u)) / d²
    /// ```
    /// The distance is at least a quarter of the box's diagonal, so that nothing in the box is taken for infinitely near.
    ///
    /// Source: Conty Estevez & Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", Proceedings of the ACM on Computer
    /// Graphics and Interactive Techniques 1(2), 2018, section 4.
    #[inline(always)]
    pub fn importance(&self, p: Vec3, n: Option<Vec3>) -> f32 {
        let half = 0.5 * (self.aabb.max - self.aabb.min);
        let to_light = self.aabb.min + half - p;
        let radius2 = half.length_squared();
        let distance2 = to_light.length_squared();
        let falloff = self.power / distance2.max(0.25 * radius2).max(f32::MIN_POSITIVE);
        let wi = to_light / distance2.sqrt();
        let uncertainty = CosSin::of_sine2(radius2 / distance2);
        let off_axis = CosSin::of_cosine(-self.axis.dot(wi))
            .less(CosSin::of_cosine(self.cos_normals))
            .less(uncertainty);
        let arriving = n.map_or(
            1.0,
            #[inline(always)]
            |n| CosSin::of_cosine(n.dot(wi)).less(uncertainty).cos.max(0.0),
        );
        let leaving = off_axis.cos.max(LEAST_COSINE);
        let leaving = if off_axis.cos > 0.0 { leaving } else { 0.0 };
        // Without branches, for loops over lanes. Within the ball around the box all angles are possible.
        if distance2 <= radius2 {
            falloff
        } else {
            falloff * leaving * arriving
        }
    }

    /// Both groups together.
    pub fn union(&self, other: &Self) -> Self {
        let cones = [self, other].map(|b| (b.axis, b.cos_normals.clamp(-1.0, 1.0).acos()));
        let (axis, normals) = cone_union(cones[0], cones[1]);
        Self {
            aabb: self.aabb.union(other.aabb),
            axis,
            cos_normals: normals.cos(),
            power: self.power + other.power,
        }
    }

    /// What a node costs: its power, times the sizes of its box and of its cone.
    ///
    /// Source: Conty Estevez & Kulla 2018, equation 1 (surface area orientation heuristic).
    pub(super) fn cost(&self) -> f32 {
        let size = self.aabb.max - self.aabb.min;
        let area = size.x * size.y + size.y * size.z + size.z * size.x;
        // Lights in one point have no area, and still differ in direction.
        self.power
            * (area + 1e-6 * size.length_squared()).max(f32::MIN_POSITIVE)
            * self.cone_measure()
    }

    /// The directions into which the lights shine, weighted by cosines.
    fn cone_measure(&self) -> f32 {
        let normals = self.cos_normals.clamp(-1.0, 1.0).acos();
        let open = (normals + FRAC_PI_2).min(PI);
        let (sin, cos) = normals.sin_cos();
        let rest = 2.0 * open * sin - (normals - 2.0 * open).cos() - 2.0 * normals * sin + cos;
        2.0 * PI * (1.0 - cos) + FRAC_PI_2 * rest
    }
}

/// A light at a right angle to its direction still has edges that are seen.
const LEAST_COSINE: f32 = 1e-3;

/// An angle in `[0, π]` by its cosine and sine: no inverse functions are needed to compare and subtract.
#[derive(Clone, Copy)]
struct CosSin {
    cos: f32,
    sin: f32,
}

impl CosSin {
    #[inline(always)]
    fn of_cosine(cos: f32) -> Self {
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        Self { cos, sin }
    }

    /// An acute angle.
    #[inline(always)]
    fn of_sine2(sine2: f32) -> Self {
        Self {
            cos: (1.0 - sine2).max(0.0).sqrt(),
            sin: sine2.sqrt(),
        }
    }

    /// This angle less `b`, at least 0.
    #[inline(always)]
    fn less(self, b: Self) -> Self {
        let none = self.cos >= b.cos;
        let cos = self.cos * b.cos + self.sin * b.sin;
        let sin = self.sin * b.cos - self.cos * b.sin;
        Self {
            cos: if none { 1.0 } else { cos },
            sin: if none { 0.0 } else { sin },
        }
    }
}

fn angle_between(a: Vec3, b: Vec3) -> f32 {
    a.dot(b).clamp(-1.0, 1.0).acos()
}

/// The least cone around two, each given by its axis and half of its angle.
///
/// Source: Conty Estevez & Kulla 2018, algorithm 1.
fn cone_union(a: (Vec3, f32), b: (Vec3, f32)) -> (Vec3, f32) {
    let (a, b) = if a.1 >= b.1 { (a, b) } else { (b, a) };
    let between = angle_between(a.0, b.0);
    if (between + b.1).min(PI) <= a.1 {
        return a;
    }
    let half = 0.5 * (a.1 + between + b.1);
    if half >= PI {
        return (a.0, PI);
    }
    let Some(across) = a.0.cross(b.0).cross(a.0).try_normalize() else {
        return (a.0, PI);
    };
    let (sin, cos) = (half - a.1).sin_cos();
    ((a.0 * cos + across * sin).normalize(), half)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cone_holds_both_of_which_it_is_the_union() {
        let cones = [
            (Vec3::X, 0.3),
            (Vec3::Y, 0.1),
            (Vec3::NEG_X, 0.0),
            (Vec3::Z, 2.0),
        ];
        for a in cones {
            for b in cones {
                let (axis, half) = cone_union(a, b);
                for (inner, own) in [a, b] {
                    assert!(
                        (angle_between(axis, inner) + own).min(PI) <= half + 1e-5,
                        "{a:?} {b:?}"
                    );
                }
            }
        }
    }

    /// The cosines give what the angles do.
    #[test]
    fn importance_is_that_of_the_angles() {
        let bounds = LightBounds {
            aabb: Aabb {
                min: Vec3::new(-0.5, 1.0, 0.0),
                max: Vec3::new(0.5, 1.5, 1.0),
            },
            axis: Vec3::new(0.6, -0.8, 0.0),
            cos_normals: 0.4_f32.cos(),
            power: 3.0,
        };
        for k in 0..200 {
            let angle = 0.1 * k as f32;
            let p = Vec3::new(4.0 * angle.sin(), 0.02 * k as f32 - 2.0, 4.0 * angle.cos());
            let n = Vec3::new(0.3, angle.cos(), angle.sin()).normalize();
            let to_light = Vec3::new(0.0, 1.25, 0.5) - p;
            let wi = to_light.normalize();
            let seen = (0.75 / to_light.length()).asin();
            let off_axis = (angle_between(bounds.axis, -wi) - 0.4 - seen).max(0.0);
            let arriving = (angle_between(n, wi) - seen).max(0.0).cos().max(0.0);
            let leaving = if off_axis >= FRAC_PI_2 {
                0.0
            } else {
                off_axis.cos().max(LEAST_COSINE)
            };
            let expected = 3.0 * leaving * arriving / to_light.length_squared();
            let found = bounds.importance(p, Some(n));
            assert!(
                (found - expected).abs() < 1e-4 * (expected + 1e-2),
                "{k}: {found} {expected}"
            );
        }
    }
}
