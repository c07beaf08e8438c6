//! Positions and normals on implicit surfaces, also where the gradient vanishes.

use super::root::polish_in;
use super::{ImplicitSurface, Tape};
use crate::SurfacePoint;
use glam::{DMat3, DVec3, Vec2, Vec3};
use std::f64::consts::{PI, TAU};

/// Steps to the surface. Simple roots take three; roots of multiplicity `m` come nearer by `1 − 1/m` a step at first.
const MOST_STEPS: usize = 64;
/// How far the gradient's own change is looked at, over the extent.
const NEAR: f64 = 1.0 / (1 << 27) as f64;
/// How far neighbours are that stand in for a point without gradient, over the extent.
const BALL: f64 = 1.0 / (1 << 17) as f64;

impl ImplicitSurface {
    /// The point of the surface near `p`, found along the gradient, with the normal towards growing `f`.
    ///
    /// Where the gradient vanishes, at cusps and seams, the normal is the mean direction of the gradients of neighbours on
    /// the surface; where it vanishes on all of the surface (`f` a square) it points away from the middle of the bounds.
    ///
    /// `uv`: as on a [`Sphere`](crate::Sphere) around the middle of the bounds: longitude around +y from +x towards −z, and
    /// latitude from south to north, each mapped to `[0, 1]`.
    pub fn point_at(&self, p: Vec3) -> SurfacePoint {
        let (p, n) = self.settle(p);
        let from_middle = (p - self.middle()).normalize_or(DVec3::Y);
        let longitude = (-from_middle.z).atan2(from_middle.x).rem_euclid(TAU);
        let latitude = from_middle.y.clamp(-1.0, 1.0).asin();
        let east = DVec3::new(from_middle.z, 0.0, -from_middle.x);
        let tangent = (east - east.dot(n) * n).try_normalize();
        SurfacePoint {
            p: p.as_vec3(),
            n: n.as_vec3(),
            uv: Vec2::new((longitude / TAU) as f32, (0.5 + latitude / PI) as f32),
            tangent: tangent.unwrap_or(n.any_orthonormal_vector()).as_vec3(),
        }
    }

    /// `p` and `n` of [`ImplicitSurface::point_at`], without the cost of the angles.
    pub fn normal_at(&self, p: Vec3) -> (Vec3, Vec3) {
        let (p, n) = self.settle(p);
        (p.as_vec3(), n.as_vec3())
    }

    fn middle(&self) -> DVec3 {
        0.5 * (self.cell().min + self.cell().max)
    }

    fn settle(&self, p: Vec3) -> (DVec3, DVec3) {
        let extent = self.cell().diagonal();
        let start = p.as_dvec3();
        // Far beneath what an f32 can tell.
        let p = descend(self.tape(), start, 1e-13 * extent);
        let p = if p.is_finite() { p } else { start };
        let (_, gradient) = self.tape().gradient(p);
        let n = match gradient.try_normalize() {
            Some(n) if self.is_steady(p, gradient, n, extent) => n,
            _ => self.mean_normal(p, extent),
        };
        (p, n)
    }

    /// Whether the gradient hardly changes towards smaller `f`, across the surface. Where it does, it vanishes close by, or turns round.
    fn is_steady(&self, p: DVec3, gradient: DVec3, n: DVec3, extent: f64) -> bool {
        let (_, other) = self.tape().gradient(p - NEAR * extent * n);
        (other - gradient).length() <= 0.25 * gradient.length()
    }

    /// A normal for a point without gradient, from those of a ring of neighbours on the surface.
    ///
    /// The ring lies across the main direction of the gradients in a ball around the point; its points are moved along that
    /// direction onto the surface where `f` changes its sign. Where it does not, the main direction itself is the normal. It points to
    /// growing `f`, or, where `f` has the same sign on both sides, away from the middle of the bounds.
    fn mean_normal(&self, p: DVec3, extent: f64) -> DVec3 {
        let radius = BALL * extent;
        let outwards = (p - self.middle()).normalize_or(DVec3::Y);
        let ball = self.ball(p, radius);
        let across = main_direction(&ball).unwrap_or(outwards);
        let ring = self.ring(p, across, radius);
        let n = main_direction(&ring).unwrap_or(across);
        let value = |side: f64| self.tape().value(p + side * radius * n);
        let (before, behind) = (value(-1.0), value(1.0));
        let side = if before * behind < 0.0 {
            behind
        } else {
            outwards.dot(n)
        };
        if side < 0.0 { -n } else { n }
    }

    /// `Σ n nᵀ` over the directions `n` of the gradients towards the faces and corners of a cube.
    fn ball(&self, p: DVec3, radius: f64) -> DMat3 {
        let mut sum = DMat3::ZERO;
        for i in 0..27 {
            let place = DVec3::new((i % 3) as f64, (i / 3 % 3) as f64, (i / 9) as f64) - 1.0;
            if place.length_squared() % 2.0 == 1.0 {
                let (_, g) = self.tape().gradient(p + radius * place.normalize());
                sum += squared(g.normalize_or_zero());
            }
        }
        sum
    }

    /// `Σ ∇f ∇fᵀ` on a ring of the surface around the line along `across`: near a point without gradient, the longer it is, the
    /// less it is blurred by rounding.
    fn ring(&self, p: DVec3, across: DVec3, radius: f64) -> DMat3 {
        let (u, v) = across.any_orthonormal_pair();
        let mut sum = DMat3::ZERO;
        for i in 0..8 {
            let angle = (f64::from(i) + 0.3) * (TAU / 8.0);
            let q = p + radius * (angle.cos() * u + angle.sin() * v);
            let at = |s: f64| {
                let (f, g) = self.tape().gradient(q + s * across);
                (f, g.dot(across))
            };
            let (low, high) = (at(-2.0 * radius).0, at(2.0 * radius).0);
            if low * high < 0.0 {
                let s = polish_in(at, (-2.0 * radius, low), (2.0 * radius, high));
                sum += squared(self.tape().gradient(q + s * across).1);
            }
        }
        sum
    }
}

/// `v vᵀ`; 0 for what is not finite.
fn squared(v: DVec3) -> DMat3 {
    if v.is_finite() {
        DMat3::from_cols(v * v.x, v * v.y, v * v.z)
    } else {
        DMat3::ZERO
    }
}

/// The eigenvector of the greatest eigenvalue of a symmetric positive matrix, by the power iteration.
fn main_direction(tensor: &DMat3) -> Option<DVec3> {
    let columns = [tensor.x_axis, tensor.y_axis, tensor.z_axis];
    let longest =
        columns.into_iter().fold(
            DVec3::ZERO,
            |a, b| {
                if b.length() > a.length() { b } else { a }
            },
        );
    let mut n = longest.try_normalize()?;
    for _ in 0..32 {
        n = (*tensor * n).normalize_or(n);
    }
    Some(n)
}

/// Follows the gradient to a root of `f` until a step is at most `least`, or none lowers `|f|` any more.
///
/// Newton's step along the gradient is `s = −f ∇f/|∇f|²`. At a root of multiplicity `m` steps shrink by `ρ = 1 − 1/m` only; as soon as two
/// in a row tell `ρ`, a step of `m s` is tried, which converges quadratically again. Steps that do not lower `|f|` are shortened.
///
/// Source: Schröder, "Über unendlich viele Algorithmen zur Auflösung der Gleichungen", Mathematische Annalen 2, 1870.
fn descend(tape: &Tape, mut p: DVec3, least: f64) -> DVec3 {
    let (mut f, mut gradient) = tape.gradient(p);
    let mut last = f64::INFINITY;
    for _ in 0..MOST_STEPS {
        let step = -f / gradient.length_squared() * gradient;
        let length = step.length();
        if !(length > least) || !length.is_finite() {
            break;
        }
        let multiplicity = 1.0 / (1.0 - length / last);
        let longest = if (1.5..20.0).contains(&multiplicity) {
            multiplicity.round()
        } else {
            1.0
        };
        // Shorter ones where the function bends too much.
        let lower = [longest, 1.0, 0.5, 0.25, 0.125]
            .into_iter()
            .find_map(|scale| {
                let next = p + scale * step;
                let at_next = tape.gradient(next);
                (at_next.0.abs() < f.abs()).then_some((next, at_next))
            });
        let Some((next, at_next)) = lower else {
            break;
        };
        last = length;
        p = next;
        (f, gradient) = at_next;
    }
    p
}
