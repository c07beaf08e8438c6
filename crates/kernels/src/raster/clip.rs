//! Cuts triangles that cross the near plane or leave the guard band.

use super::Corner;
use super::projection::{GUARD, Projection};
use arrayvec::ArrayVec;
use glam::{DVec4, Vec4};

/// A corner of a cut triangle.
#[derive(Clone, Copy)]
struct Vertex {
    clip: DVec4,
    /// Where an original corner lies that needs no cut.
    whole: Option<Corner>,
}

/// Three corners and one more for each plane.
type Polygon = ArrayVec<Vertex, 8>;

/// The triangles that are left of a triangle of clip space, on the picture; none if a corner is not finite.
///
/// In homogeneous coordinates and f64, before the division, so that `w = 0` does no harm. Two triangles that share an edge cut
/// it at the same point, to the bit: a cut depends on nothing but the edge's ends and goes from the end inside. Corners that need no
/// cut keep the position that they have in whole triangles.
///
/// Source: Sutherland & Hodgman, "Reentrant Polygon Clipping", Communications of the ACM 17(1), 1974; Blinn & Newell,
/// "Clipping Using Homogeneous Coordinates", SIGGRAPH 1978.
pub(super) fn cut_triangle(
    projection: &Projection,
    corners: [Vec4; 3],
    mut emit: impl FnMut([Corner; 3]),
) {
    if !corners.iter().all(|corner| corner.is_finite()) {
        return;
    }
    let whole = corners.map(|corner| projection.corner(corner));
    if let [Some(a), Some(b), Some(c)] = whole {
        return emit([a, b, c]);
    }
    let mut polygon: Polygon = corners
        .iter()
        .zip(whole)
        .map(|(clip, whole)| Vertex {
            clip: clip.as_dvec4(),
            whole,
        })
        .collect();
    for (plane, least) in planes(projection) {
        polygon = cut(&polygon, plane, least);
    }
    let corners: ArrayVec<Corner, 8> = polygon.iter().map(|v| place(projection, v)).collect();
    for i in 2..corners.len() {
        emit([corners[0], corners[i - 1], corners[i]]);
    }
}

/// The near plane and the four sides of the guard band: `plane · v ≥ least`.
fn planes(projection: &Projection) -> [(DVec4, f64); 5] {
    let guard = f64::from(GUARD);
    let [sx, sy] = projection.scale.map(f64::from);
    let [cx, cy] = projection.center.map(f64::from);
    [
        (DVec4::W, f64::from(projection.least_w)),
        (DVec4::new(sx, 0.0, 0.0, guard + cx), 0.0),
        (DVec4::new(-sx, 0.0, 0.0, guard - cx), 0.0),
        (DVec4::new(0.0, sy, 0.0, guard + cy), 0.0),
        (DVec4::new(0.0, -sy, 0.0, guard - cy), 0.0),
    ]
}

/// The part of a convex polygon on the inner side of a plane.
fn cut(polygon: &Polygon, plane: DVec4, least: f64) -> Polygon {
    let distance = |v: &Vertex| {
        let d = plane.dot(v.clip) - least;
        // What whole triangles take for inside is inside.
        if v.whole.is_some() { d.max(0.0) } else { d }
    };
    let mut left = Polygon::new();
    for (i, b) in polygon.iter().enumerate() {
        let a = &polygon[(i + polygon.len() - 1) % polygon.len()];
        let (da, db) = (distance(a), distance(b));
        let between = match (da >= 0.0, db >= 0.0) {
            (true, false) => Some((a, b, da / (da - db))),
            (false, true) => Some((b, a, db / (db - da))),
            _ => None,
        };
        left.extend(between.map(|(inside, outside, t)| Vertex {
            clip: inside.clip + (outside.clip - inside.clip) * t,
            whole: None,
        }));
        if db >= 0.0 {
            left.push(*b);
        }
    }
    left
}

/// Where a corner of what is left lies on the picture.
fn place(projection: &Projection, vertex: &Vertex) -> Corner {
    vertex.whole.unwrap_or_else(|| {
        let v = vertex.clip;
        let guard = f64::from(GUARD);
        let on_axis = |at: f64, axis: usize| {
            let [scale, center] = [projection.scale[axis], projection.center[axis]].map(f64::from);
            (at / v.w * scale + center)
                .round_ties_even()
                .clamp(-guard, guard) as i32
        };
        let [low, high] = [f32::MIN, f32::MAX].map(f64::from);
        Corner {
            x: on_axis(v.x, 0),
            y: on_axis(v.y, 1),
            z: (v.z / v.w).clamp(low, high) as f32,
        }
    })
}
