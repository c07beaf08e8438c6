//! How often a mesh, closed or not, goes around a point.

use crate::Triangle;
use arrayvec::ArrayVec;
use glam::{DMat3, DVec3};
use std::f64::consts::PI;

/// The signed solid angle under which a triangle is seen from `p`, in `[-2π, 2π]`; positive from behind its front.
///
/// With the vectors `a`, `b`, `c` from `p` to the corners
/// ```text
/// tan(Ω/2) = a·(b × c) / (|a||b||c| + (a·b)|c| + (b·c)|a| + (c·a)|b|)
/// ```
/// 0 for a triangle without area, and from any point in its plane. Computed in f64.
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

/// Triangles in the lowest clusters.
const LEAF: usize = 8;

/// Smaller ranges are not worth a thread of their own.
const ALONE: usize = 1 << 14;

impl WindingTree {
    pub(super) fn new(mut triangles: Vec<Triangle>) -> Self {
        let mut nodes = vec![Cluster::NONE; clusters_of(triangles.len())];
        if !triangles.is_empty() {
            divide(&mut triangles, &mut nodes, (0, 0));
        }
        Self { nodes, triangles }
    }

    pub(super) fn memory(&self) -> usize {
        self.nodes.capacity() * size_of::<Cluster>()
            + self.triangles.capacity() * size_of::<Triangle>()
    }

    /// Whether the mesh goes around `p` by more than half, in either sense.
    ///
    /// The winding number `w = Σ Ω / 4π` of a closed mesh is 1 inside and 0 outside; across the holes of an open one it
    /// changes smoothly, and `|w| > ½` is the inside of the surface that would close it. Taken as exactly as it needs to be told
    /// from ½, in the end to f64's rounding.
    ///
    /// Source: Jacobson, Kavan & Sorkine-Hornung, "Robust Inside-Outside Segmentation using Generalized
    /// Winding Numbers", ACM Transactions on Graphics 32(4), 2013.
    pub(super) fn contains(&self, p: DVec3) -> bool {
        for tolerance in [0.1, 0.02, 0.004] {
            let (number, error) = self.number(p, tolerance);
            let beyond = number.abs() - 0.5;
            if beyond.abs() > error {
                return beyond > 0.0;
            }
        }
        self.number(p, 0.0).0.abs() > 0.5
    }

    /// The winding number around `p`, and a bound of its error.
    ///
    /// From `x = center − p` far away a cluster counts as
    /// ```text
    /// 4π w ≈ N·x/|x|³ + tr M/|x|³ − 3 xᵀM x/|x|⁵
    /// ```
    /// with `N` the sum of its area vectors and `M` their moments. The third derivatives of `1/|x|` are `6/|x|⁴` at most, so
    /// this is wrong by `3 ∫|x − center|² dA / (|x| − radius)⁴` at most; that may be `tolerance` times the solid angle that the
    /// area could fill from that near.
    ///
    /// Source: Barill, Dickson, Schmidt, Levin & Jacobson, "Fast Winding Numbers for Soups and Clouds", ACM
    /// Transactions on Graphics 37(4), 2018 (there without a bound of the error).
    fn number(&self, p: DVec3, tolerance: f64) -> (f64, f64) {
        let (mut sum, mut error) = (0.0, 0.0);
        let mut i = 0;
        while let Some(node) = self.nodes.get(i) {
            let x = node.center - p;
            let l = x.length();
            let gap = l - node.radius;
            if gap > 0.0 && 3.0 * node.spread <= tolerance * node.area * gap * gap {
                sum += node.solid_angle(x, l);
                error += 3.0 * node.spread / gap.powi(4);
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
        (sum / (4.0 * PI), error / (4.0 * PI))
    }
}

impl Cluster {
    const NONE: Self = Self {
        center: DVec3::ZERO,
        radius: 0.0,
        area: 0.0,
        normal: DVec3::ZERO,
        moment: DMat3::ZERO,
        spread: 0.0,
        triangles: (0, 0),
        next: 0,
    };

    /// The expansion of [`solid_angle`] at `x`, of length `l`.
    fn solid_angle(&self, x: DVec3, l: f64) -> f64 {
        let m = &self.moment;
        let trace = m.x_axis.x + m.y_axis.y + m.z_axis.z;
        let ll = l * l;
        (self.normal.dot(x) + trace - 3.0 * x.dot(*m * x) / ll) / (ll * l)
    }

    fn of_triangles(triangles: &[Triangle], first: usize) -> Self {
        let parts = triangles.iter().map(|triangle| {
            let normal = area_vector(triangle);
            let center = centroid(triangle);
            let corners = [triangle.a, triangle.b, triangle.c];
            let distances = corners.map(|p| (p.as_dvec3() - center).length_squared());
            let area = normal.length();
            Self {
                center,
                radius: distances.into_iter().fold(0.0, f64::max).sqrt(),
                area,
                normal,
                // The mean of a convex function over a triangle is that over its corners at most.
                spread: area * distances.iter().sum::<f64>() / 3.0,
                ..Self::NONE
            }
        });
        let parts: ArrayVec<Self, LEAF> = parts.take(LEAF).collect();
        Self {
            triangles: (first, triangles.len()),
            ..Self::of_parts(&parts)
        }
    }

    /// The parts as one, each moved to the common centre.
    fn of_parts(parts: &[Self]) -> Self {
        let area: f64 = parts.iter().map(|part| part.area).sum();
        let weighted: DVec3 = parts.iter().map(|part| part.area * part.center).sum();
        let center = weighted / area;
        let mut whole = Self {
            center,
            area,
            ..Self::NONE
        };
        for part in parts {
            let (x, n) = (part.center - center, part.normal);
            whole.normal += n;
            whole.radius = whole.radius.max(x.length() + part.radius);
            whole.moment += part.moment + DMat3::from_cols(x * n.x, x * n.y, x * n.z);
            whole.spread += part.spread + part.area * x.length_squared();
        }
        whole
    }
}

/// Number of clusters over so many triangles.
fn clusters_of(triangles: usize) -> usize {
    if triangles <= LEAF {
        return triangles.min(1);
    }
    let half = triangles / 2;
    1 + clusters_of(half) + clusters_of(triangles - half)
}

/// Builds the clusters by halves along the longest side of the centroids' box; `triangles` and `nodes` begin at the places
/// `(first, place)` among all.
fn divide(triangles: &mut [Triangle], nodes: &mut [Cluster], (first, place): (usize, usize)) {
    let len = triangles.len();
    let next = place + nodes.len();
    let Some((node, below)) = nodes.split_first_mut() else {
        return;
    };
    if len <= LEAF {
        *node = Cluster::of_triangles(triangles, first);
        node.next = next;
        return;
    }
    let centroids = triangles.iter().map(centroid);
    let least = centroids.clone().fold(DVec3::INFINITY, DVec3::min);
    let most = centroids.fold(DVec3::NEG_INFINITY, DVec3::max);
    let axis = (most - least).max_position();
    let half = len / 2;
    triangles.select_nth_unstable_by(half, |p, q| centroid(p)[axis].total_cmp(&centroid(q)[axis]));

    let (left, right) = triangles.split_at_mut(half);
    let nodes_left = clusters_of(half);
    let (below_left, below_right) = below.split_at_mut(nodes_left);
    let from_right = (first + half, place + 1 + nodes_left);
    let mut do_left = || divide(left, below_left, (first, place + 1));
    let mut do_right = || divide(right, below_right, from_right);
    if len > ALONE {
        rayon::join(do_left, do_right);
    } else {
        do_left();
        do_right();
    }
    *node = Cluster {
        triangles: (first, len),
        next,
        ..Cluster::of_parts(&[below[0], below[nodes_left]])
    };
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

    /// A bumpy sheet of triangles: the error keeps to its bound.
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
            let (exact, none) = tree.number(p, 0.0);
            assert_eq!(none, 0.0);
            for tolerance in [1.0, 0.1, 0.01, 0.001] {
                let (found, error) = tree.number(p, tolerance);
                assert!((found - exact).abs() <= error + 1e-12, "{p} {tolerance}");
            }
        }
    }
}
