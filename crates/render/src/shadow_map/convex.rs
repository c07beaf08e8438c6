//! The part of a view that a box holds: convex bodies cut by each other.

use umbriel_kernels::{Aabb, glam::DVec3};

/// The half-space `n·p + d ≥ 0`.
#[derive(Clone, Copy, Debug)]
struct HalfSpace {
    n: DVec3,
    d: f64,
}

/// A body with six faces, each a quadrilateral of its eight corners; the first four corners are the near end, in a circle, the
/// others lie behind them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hexahedron(pub(crate) [DVec3; 8]);

const FACES: [[usize; 4]; 6] = [
    [0, 1, 2, 3],
    [4, 5, 6, 7],
    [0, 1, 5, 4],
    [1, 2, 6, 5],
    [2, 3, 7, 6],
    [3, 0, 4, 7],
];

impl Hexahedron {
    pub(crate) fn from_box(bounds: &Aabb) -> Self {
        let (a, b) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let end = |z| {
            [
                DVec3::new(a.x, a.y, z),
                DVec3::new(b.x, a.y, z),
                DVec3::new(b.x, b.y, z),
                DVec3::new(a.x, b.y, z),
            ]
        };
        let [[p, q, r, s], [t, u, v, w]] = [end(a.z), end(b.z)];
        Self([p, q, r, s, t, u, v, w])
    }

    /// The half-spaces of the faces that have an area.
    fn half_spaces(&self) -> Vec<HalfSpace> {
        let middle = self.0.iter().sum::<DVec3>() / 8.0;
        let half_space = |face: &[usize; 4]| {
            let [a, b, c, d] = face.map(|i| self.0[i]);
            // The diagonals: right where one edge has no length, too.
            let n = (c - a).cross(d - b).try_normalize()?;
            let n = if n.dot(middle - a) < 0.0 { -n } else { n };
            Some(HalfSpace { n, d: -n.dot(a) })
        };
        FACES.iter().filter_map(half_space).collect()
    }
}

/// The corners of the intersection of two bodies, some of them more than once; none where they do not meet.
pub(crate) fn intersection(a: &Hexahedron, b: &Hexahedron) -> Vec<DVec3> {
    let mut corners = Vec::new();
    for (body, cutter) in [(a, b), (b, a)] {
        let half_spaces = cutter.half_spaces();
        for face in &FACES {
            let mut polygon = face.map(|i| body.0[i]).to_vec();
            for half_space in &half_spaces {
                polygon = cut(&polygon, half_space);
            }
            corners.extend(polygon);
        }
    }
    corners
}

/// The part of a convex polygon in a half-space.
///
/// Source: Sutherland & Hodgman, "Reentrant Polygon Clipping", Communications of the ACM 17(1), 1974.
fn cut(polygon: &[DVec3], half_space: &HalfSpace) -> Vec<DVec3> {
    let height = |p: DVec3| half_space.n.dot(p) + half_space.d;
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, &p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        let (hp, hq) = (height(p), height(q));
        if hp >= 0.0 {
            kept.push(p);
        }
        if (hp < 0.0) != (hq < 0.0) {
            kept.push(p + (q - p) * (hp / (hp - hq)));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use umbriel_kernels::glam::Vec3;

    fn cube(min: f32, max: f32) -> Hexahedron {
        Hexahedron::from_box(&Aabb {
            min: Vec3::splat(min),
            max: Vec3::splat(max),
        })
    }

    #[test]
    fn boxes_cut_each_other() {
        let corners = intersection(&cube(0.0, 2.0), &cube(1.0, 5.0));
        assert!(!corners.is_empty());
        let (min, max) = corners
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), &p| {
                (min.min(p), max.max(p))
            });
        assert!((min - 1.0).abs().max_element() < 1e-12);
        assert!((max - 2.0).abs().max_element() < 1e-12);
        assert!(intersection(&cube(0.0, 1.0), &cube(2.0, 3.0)).is_empty());
        // One within the other.
        assert!(!intersection(&cube(0.0, 9.0), &cube(2.0, 3.0)).is_empty());
    }
}
