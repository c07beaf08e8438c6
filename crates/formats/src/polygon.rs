//! Polygons to triangles.

use umbriel_kernels::glam::{Vec2, Vec3};

/// Most corners of a concave polygon that is cut exactly; the method's time grows with the square.
const MAX_EARS: usize = 1024;

/// Cuts a polygon of `n ≥ 3` corners into `n − 2` triangles of corner numbers, in the same winding.
///
/// A convex polygon becomes a fan around its first corner. From any other one, ears are cut: corners
/// whose triangle with both neighbours bulges outwards and contains no other corner. The polygon is seen along its
/// area vector (Newell), so slightly bent ones are fine. Where no ear is left (self-crossing polygons),
/// or above 1024 corners, the rest becomes a fan.
///
/// Source: Meisters, "Polygons Have Ears", American Mathematical Monthly 82(6), 1975;
/// Sutherland, Sproull & Schumacker, ACM Computing Surveys 6(1), 1974 (Newell's normal).
pub(crate) fn triangulate(corners: &[Vec3]) -> Vec<[usize; 3]> {
    let n = corners.len();
    if n < 3 {
        return Vec::new();
    }
    let fan = |rest: &[usize]| -> Vec<[usize; 3]> {
        (1..rest.len() - 1)
            .map(|i| [rest[0], rest[i], rest[i + 1]])
            .collect()
    };
    let all: Vec<usize> = (0..n).collect();
    if n == 3 || n > MAX_EARS {
        return fan(&all);
    }
    let flat = project(corners);
    let bulges = |a: usize, b: usize, c: usize| (flat[b] - flat[a]).perp_dot(flat[c] - flat[b]);
    if (0..n).all(|i| bulges((i + n - 1) % n, i, (i + 1) % n) >= 0.0) {
        return fan(&all);
    }

    let mut rest = all;
    let mut triangles = Vec::with_capacity(n - 2);
    while rest.len() > 3 {
        let m = rest.len();
        let ear = (0..m).find(|&i| {
            let [a, b, c] = [rest[(i + m - 1) % m], rest[i], rest[(i + 1) % m]];
            bulges(a, b, c) > 0.0
                && !rest
                    .iter()
                    .any(|&p| ![a, b, c].contains(&p) && inside(&flat, [a, b, c], p))
        });
        let Some(i) = ear else { break };
        triangles.push([rest[(i + m - 1) % m], rest[i], rest[(i + 1) % m]]);
        rest.remove(i);
    }
    triangles.extend(fan(&rest));
    triangles
}

/// The polygon seen along its area vector, counter-clockwise.
fn project(corners: &[Vec3]) -> Vec<Vec2> {
    let n = corners.len();
    let origin = corners[0];
    let area: Vec3 = (0..n)
        .map(|i| (corners[i] - origin).cross(corners[(i + 1) % n] - origin))
        .sum();
    let size = area.abs();
    corners
        .iter()
        .map(|&p| {
            let p = p - origin;
            if size.x >= size.y && size.x >= size.z {
                Vec2::new(p.y, p.z * area.x.signum())
            } else if size.y >= size.z {
                Vec2::new(p.z, p.x * area.y.signum())
            } else {
                Vec2::new(p.x, p.y * area.z.signum())
            }
        })
        .collect()
}

/// Tells whether corner `p` lies in the triangle or on its edges, other than at a corner.
fn inside(flat: &[Vec2], [a, b, c]: [usize; 3], p: usize) -> bool {
    let [a, b, c, p] = [flat[a], flat[b], flat[c], flat[p]];
    let side = |u: Vec2, v: Vec2| (v - u).perp_dot(p - u) >= 0.0;
    ![a, b, c].contains(&p) && side(a, b) && side(b, c) && side(c, a)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(corners: &[Vec3], triangles: &[[usize; 3]]) -> f32 {
        let each = triangles.iter().map(|&[a, b, c]| {
            0.5 * (corners[b] - corners[a])
                .cross(corners[c] - corners[a])
                .length()
        });
        each.sum()
    }

    /// An L, from each of its corners, in both windings and seen along each axis: exact area without overlap.
    #[test]
    fn concave_polygons_keep_their_area() {
        let l = [
            [0.0, 0.0],
            [2.0, 0.0],
            [2.0, 1.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [0.0, 3.0],
        ];
        for start in 0..6 {
            for axis in 0..3 {
                for flip in [false, true] {
                    let mut corners: Vec<Vec3> = (0..6)
                        .map(|i| {
                            let [x, y] = l[(i + start) % 6];
                            [
                                Vec3::new(x, y, 1.0),
                                Vec3::new(1.0, x, y),
                                Vec3::new(y, 1.0, x),
                            ][axis]
                        })
                        .collect();
                    if flip {
                        corners.reverse();
                    }
                    let triangles = triangulate(&corners);
                    assert_eq!(triangles.len(), 4);
                    assert!((area(&corners, &triangles) - 4.0).abs() < 1e-5);
                }
            }
        }
    }

    #[test]
    fn any_polygon_gives_n_minus_two_triangles() {
        let star: Vec<Vec3> = (0..5)
            .map(|i| Vec3::new((i as f32 * 2.513).cos(), (i as f32 * 2.513).sin(), 0.0))
            .collect();
        assert_eq!(triangulate(&star).len(), 3);
        assert_eq!(triangulate(&[Vec3::ZERO; 7]).len(), 5);
        assert_eq!(triangulate(&[Vec3::NAN; 5]).len(), 3);
        assert!(triangulate(&star[..2]).is_empty());
        let many: Vec<Vec3> = (0..100_000)
            .map(|i| Vec3::new(i as f32, (i % 2) as f32, 0.0))
            .collect();
        assert_eq!(triangulate(&many).len(), 99_998);
    }
}
