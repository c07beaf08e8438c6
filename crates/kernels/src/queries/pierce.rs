//! A ray through triangles that share edges and corners: each sheet of a surface is pierced once.

use super::Way;
use crate::{Ray, ShearedRay, Triangle};

/// A triangle that a ray's line goes through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pierced {
    /// Ray parameter.
    pub(super) t: f64,
    /// Bound of the rounding error of `t`.
    pub(super) slack: f64,
    /// Weights of the second and the third corner.
    pub(super) weights: [f64; 2],
    pub(super) way: Way,
}

/// The line of a ray, sheared into the z axis by the operations of the leaf tests, which so leave out no triangle that is pierced.
pub(super) struct Needle(ShearedRay);

impl Needle {
    pub(super) fn new(ray: &Ray) -> Self {
        Self(ShearedRay::new(ray))
    }

    /// Whether, where and which way the line goes through a triangle.
    ///
    /// In the sheared space, where the ray is the z axis, the edge functions of the corners `A`, `B`, `C` are
    /// ```text
    /// U = Cx By − Cy Bx      V = Ax Cy − Ay Cx      W = Bx Ay − By Ax
    /// t = (U Az + V Bz + W Cz) / (U + V + W) / d_kz
    /// ```
    /// and the line goes through where they have one sign: positive on the way in. The corners are f32 and the products
    /// exact in f64, so the signs are. A zero is decided as if the line lay at `(ε, ε²)` for an infinitely small `ε`, beside every
    /// edge and corner: of the triangles at an edge or a corner it then goes through one for each sheet of
    /// the surface, and through the two sides of a fold both or neither. So the ways in and out of a closed mesh, along a whole line,
    /// are equal in number, without a tolerance.
    ///
    /// A triangle seen edge-on, or of numbers that are not finite, is not pierced.
    ///
    /// Source: Woop, Benthin & Wald, "Watertight Ray/Triangle Intersection", Journal of Computer Graphics
    /// Techniques 2(1), 2013; Edelsbrunner & Mücke, "Simulation of Simplicity", ACM Transactions on
    /// Graphics 9(1), 1990.
    pub(super) fn pierce(&self, triangle: &Triangle) -> Option<Pierced> {
        let [a, b, c] =
            [triangle.a, triangle.b, triangle.c].map(|p| self.0.shear(p).as_dvec3().to_array());
        let length = f64::from(self.0.length());
        let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
        let sign = is_positive(c, b, u);
        if is_positive(a, c, v) != sign || is_positive(b, a, w) != sign {
            return None;
        }
        let det = u + v + w;
        let t = (u * a[2] + v * b[2] + w * c[2]) / det / length;
        let reach = a[2].abs().max(b[2].abs()).max(c[2].abs());
        (det != 0.0 && t.is_finite()).then(|| Pierced {
            t,
            slack: 16.0 * f64::EPSILON * reach / length.abs(),
            weights: [v / det, w / det],
            way: if sign { Way::Enter } else { Way::Leave },
        })
    }
}

fn edge(p: [f64; 3], q: [f64; 3]) -> f64 {
    p[0] * q[1] - p[1] * q[0]
}

/// The sign of an edge function as seen from `(ε, ε²)`, which makes it `e + ε (py − qy) + ε² (qx − px)`.
fn is_positive(p: [f64; 3], q: [f64; 3], e: f64) -> bool {
    if e != 0.0 {
        e > 0.0
    } else if p[1] != q[1] {
        p[1] > q[1]
    } else {
        q[0] > p[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// A square of four triangles around its centre, which the ray goes through; turned to every corner.
    #[test]
    fn a_ray_through_a_corner_pierces_one_triangle() {
        let corner = |i: usize| {
            [Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::NEG_Y][i % 4] + Vec3::new(0.25, 0.5, 0.0)
        };
        let center = Vec3::new(0.25, 0.5, 0.0);
        for aim in [center, center + 0.5 * Vec3::X, center + 0.25 * Vec3::Y] {
            for (from, way) in [(Vec3::Z, Way::Enter), (Vec3::NEG_Z, Way::Leave)] {
                let needle = Needle::new(&Ray::new(aim + 2.0 * from, -from));
                let pierced: Vec<Pierced> = (0..4)
                    .filter_map(|i| {
                        needle.pierce(&Triangle {
                            a: center,
                            b: corner(i),
                            c: corner(i + 1),
                        })
                    })
                    .collect();
                assert_eq!(pierced.len(), 1);
                assert_eq!((pierced[0].t, pierced[0].way), (2.0, way));
            }
        }
    }
}
