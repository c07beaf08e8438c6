//! How often a mesh, closed or not, goes around a point.

use crate::Triangle;
use glam::{DMat3, DVec3};
use std::f64::consts::PI;

/// The signed solid angle under which a triangle is seen from `p`, in `[-2π, 2π]`; positive from behind its front.
///
/// With the vectors `a`, `b`, `c` from `p` to the corners
/// ```text
/// tan(Ω/2) = a·(b × c) / (|a||b||c| + (a·b)|c| + (b·c)|a| + (c·a)|b|)
/// ```
/// 0 for a triangle without area, and from a point in its plane outside of it. Computed in f64.
///
/// Source: Van Oosterom & Strackee, "The Solid Angle of a Plane Triangle", IEEE Transactions on Biomedical
/// Engineering 30(2), 1983.
pub fn solid_angle(triangle: &Triangle, p: DVec3) -> f64 {
    let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(|corner| corner.as_dvec3() - p);
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let numerator = a.dot(b.cross(c));
    if numerator == 0.0 {
        return 0.0;
    }
    let denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * numerator.atan2(denominator)
}

/// Triangles in clusters that count as one from afar.
#[derive(Clone, Debug, Default)]
pub(super) struct WindingTree {
    /// Depth first: the first child of a node follows it.
    nodes: Vec<Cluster>,
    /// Cluster by cluster.
    triangles: Vec<Triangle>,
    area: f64,
}

/// The expansion of the solid angle of some triangles around their centre.
#[derive(Clone, Copy, Debug)]
struct Cluster {
    center: DVec3,
    /// Greatest distance of a corner from the centre.
    radius: f64,
    area: f64,
    /// `Σ A n`.
    normal: DVec3,
    /// `Σ (x − center) (A n)ᵀ` over the centroids `x`.
    moment: DMat3,
    /// Bounds `∫ |x − center|² dA`.
    spread: f64,
    triangles: (usize, usize),
    /// Node that comes after this one and all below it.
    next: usize,
}

const LEAF: usize = 8;

impl WindingTree {
    pub(super) fn new(mut triangles: Vec<Triangle>) -> Self {
        let mut nodes = Vec::new();
        let len = triangles.len();
        if len > 0 {
            divide(&mut triangles, 0..len, &mut nodes);
        }
        let area = nodes.first().map_or(0.0, |root: &Cluster| root.area);
        Self {
            nodes,
            triangles,
            area,
        }
    }

    pub(super) fn memory(&self) -> usize {
        self.nodes.capacity() * size_of::<Cluster>()
            + self.triangles.capacity() * size_of::<Triangle>()
    }

    /// Whether the mesh goes around `p` by more than half, in either sense.
    ///
    /// The winding number `w = Σ Ω / 4π` of a closed mesh is 1 inside and 0 outside; across the holes of an open one it
    /// changes smoothly, and `|w| > ½` is the inside of the surface that would close it. Three times as exactly as it takes: with an error
    /// bound of 0.1, of 0.01, and to f64's rounding.
    ///
    /// Source: Jacobson, Kavan & Sorkine-Hornung, "Robust Inside-Outside Segmentation using Generalized
    /// Winding Numbers", ACM Transactions on Graphics 32(4), 2013.
    pub(super) fn contains(&self, p: DVec3) -> bool {
        for error in [0.1, 0.01] {
            let beyond = self.number(p, error).abs() - 0.5;
            if beyond.abs() > error {
                return beyond > 0.0;
            }
        }
        self.number(p, 0.0).abs() > 0.5
    }

    /// The winding number around `p`, to an error of `error` at most.
    ///
    /// From `x = center − p` far away a cluster counts as
    /// ```text
    /// 4π w ≈ N·x/|x|³ + tr M/|x|³ − 3 xᵀM x/|x|⁵
    /// ```
    /// with `N` the sum of its area vectors and `M` their moments. The third derivatives of `1/|x|` are `6/|x|⁴` at most, so
    /// this is wrong by `3 ∫|x − center|² dA / (|x| − radius)⁴` at most; a cluster may use up as much of the
    /// error as it has of the area.
    ///
    /// Source: Barill, Dickson, Schmidt, Levin & Jacobson, "Fast Winding Numbers for Soups and Clouds", ACM
    /// Transactions on Graphics 37(4), 2018 (there with a criterion of distance only).
    pub(super) fn number(&self, p: DVec3, error: f64) -> f64 {
        let allowed = 4.0 * PI * error / self.area;
        let mut sum = 0.0;
        let mut i = 0;
        while let Some(node) = self.nodes.get(i) {
            let x = node.center - p;
            let l = x.length();
            let gap = l - node.radius;
            if gap > 0.0 && 3.0 * node.spread <= allowed * node.area * gap.powi(4) {
                let dipole = node.normal.dot(x) + node.trace();
                sum += (dipole - 3.0 * x.dot(node.moment * x) / (l * l)) / (l * l * l);
                i = node.next;
                continue;
            }
            if i + 1 == node.next {
                let (first, n) = node.triangles;
                for triangle in &self.triangles[first..first + n] {
                    sum += solid_angle(triangle, p);
                }
            }
            i += 1;
        }
        sum / (4.0 * PI)
    }
}

impl Cluster {
    fn trace(&self) -> f64 {
        self.moment.x_axis.x + self.moment.y_axis.y + self.moment.z_axis.z
    }

    fn new(triangles: &[Triangle], first: usize) -> Self {
        let mut node = Self {
            center: DVec3::ZERO,
            radius: 0.0,
            area: 0.0,
            normal: DVec3::ZERO,
            moment: DMat3::ZERO,
            spread: 0.0,
            triangles: (first, triangles.len()),
            next: 0,
        };
        for triangle in triangles {
            let n = area_vector(triangle);
            node.normal += n;
            node.area += n.length();
            node.center += n.length() * centroid(triangle);
        }
        node.center /= node.area;
        for triangle in triangles {
            let n = area_vector(triangle);
            let x = centroid(triangle) - node.center;
            node.moment += DMat3::from_cols(x * n.x, x * n.y, x * n.z);
            for corner in [triangle.a, triangle.b, triangle.c] {
                let d = (corner.as_dvec3() - node.center).length_squared();
                node.radius = node.radius.max(d.sqrt());
                // The mean of a convex function over a triangle is that over its corners at most.
                node.spread += n.length() * d / 3.0;
            }
        }
        node
    }
}

/// Builds the clusters of a range by halves along the longest side of the centroids' box.
fn divide(triangles: &mut [Triangle], range: std::ops::Range<usize>, nodes: &mut Vec<Cluster>) {
    let part = &mut triangles[range.clone()];
    let place = nodes.len();
    nodes.push(Cluster::new(part, range.start));
    if part.len() > LEAF {
        let least = part.iter().map(centroid).fold(DVec3::INFINITY, DVec3::min);
        let most = part.iter().map(centroid).fold(-DVec3::INFINITY, DVec3::max);
        let axis = (most - least).max_position();
        let half = part.len() / 2;
        part.select_nth_unstable_by(half, |p, q| centroid(p)[axis].total_cmp(&centroid(q)[axis]));
        let middle = range.start + half;
        divide(triangles, range.start..middle, nodes);
        divide(triangles, middle..range.end, nodes);
    }
    nodes[place].next = nodes.len();
}

fn centroid(triangle: &Triangle) -> DVec3 {
    (triangle.a.as_dvec3() + triangle.b.as_dvec3() + triangle.c.as_dvec3()) / 3.0
}

/// Unit normal times area.
fn area_vector(triangle: &Triangle) -> DVec3 {
    let a = triangle.a.as_dvec3();
    0.5 * (triangle.b.as_dvec3() - a).cross(triangle.c.as_dvec3() - a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// Seen from the middle of a cube half of one of its faces, which has 4π/6.
    #[test]
    fn half_a_face_of_a_cube_fills_a_twelfth_of_the_sphere() {
        let face = Triangle {
            a: Vec3::new(1.0, -1.0, -1.0),
            b: Vec3::new(1.0, 1.0, -1.0),
            c: Vec3::new(1.0, 1.0, 1.0),
        };
        assert!((solid_angle(&face, DVec3::ZERO) - PI / 3.0).abs() < 1e-14);
        let seen_from_the_front = solid_angle(&face, DVec3::X * 2.0);
        assert!((seen_from_the_front + PI / 3.0).abs() < 1e-14);
        assert_eq!(solid_angle(&face, face.a.as_dvec3()), 0.0);
    }

    /// A bumpy sheet of triangles: the error stays below what was allowed.
    #[test]
    fn the_error_keeps_its_bound() {
        let z = |i: i32, j: i32| 0.3 * ((i as f32 * 0.7).sin() + (j as f32 * 1.3).cos());
        let corner = |i: i32, j: i32| Vec3::new(i as f32 * 0.1, j as f32 * 0.1, z(i, j));
        let mut triangles = Vec::new();
        for i in 0..40 {
            for j in 0..40 {
                let [a, b, c] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1)];
                let d = corner(i, j + 1);
                triangles.push(Triangle { a, b, c });
                triangles.push(Triangle { a, b: c, c: d });
            }
        }
        let tree = WindingTree::new(triangles);
        for k in 0..200 {
            let k = f64::from(k);
            let p = DVec3::new(k * 0.37 % 6.0 - 1.0, k * 0.59 % 6.0 - 1.0, k * 0.17 % 3.0);
            let exact = tree.number(p, 0.0);
            for error in [0.3, 0.1, 0.01, 0.001] {
                let found = tree.number(p, error);
                assert!((found - exact).abs() <= error, "{p} {error}");
            }
        }
    }
}
