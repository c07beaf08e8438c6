//! The point of a triangle mesh at a hit: attributes interpolated, the terminator mended.

use crate::{
    Mesh,
    surface::{ObjectPoint, Place, side_of},
};
use umbriel_kernels::{
    Hit, Ray, gamma,
    glam::{Vec2, Vec3, Vec4},
};

/// The point of a mesh at the hit of an object-space ray. Tangents follow the texture coordinates `uv_set`.
pub(crate) fn mesh_point(mesh: &Mesh, object_ray: &Ray, hit: &Hit, uv_set: u8) -> ObjectPoint {
    let corners = mesh.indices[hit.primitive as usize].map(|i| i as usize);
    let weights = corner_weights(hit.u, hit.v);
    let triangle = mesh.triangle(hit.primitive as usize);
    let positions = [triangle.a, triangle.b, triangle.c];
    let ng = triangle.unit_normal();
    let mut place = flat_place(positions, weights, ng);
    if !mesh.normals.is_empty() {
        // Seen from behind, the body is on the other side.
        let side = side_of(-object_ray.dir, ng);
        place = smooth_place(
            place,
            positions,
            corners.map(|i| mesh.normals[i]),
            weights,
            side,
        );
    }
    ObjectPoint {
        place,
        tangent: mesh_tangent(mesh, uv_set, corners, weights),
        uvs: mesh_uvs(mesh, corners, weights),
        color: mesh_color(mesh, corners, weights),
    }
}

/// The barycentric weights of a triangle's corners.
#[inline(always)]
pub(crate) fn corner_weights(u: f32, v: f32) -> [f32; 3] {
    [1.0 - u - v, u, v]
}

/// A point of the flat triangle with unit normal `ng`.
#[inline(always)]
pub(crate) fn flat_place(positions: [Vec3; 3], weights: [f32; 3], ng: Vec3) -> Place {
    let parts: [Vec3; 3] = std::array::from_fn(|k| weights[k] * positions[k]);
    Place {
        p: parts[0] + parts[1] + parts[2],
        // Three products, two sums and the rounding of the weights, whose sum is not quite 1.
        error: (parts[0].abs() + parts[1].abs() + parts[2].abs()) * gamma(8)
            + Vec3::splat(f32::MIN_POSITIVE),
        lift: Vec3::ZERO,
        ng,
        ns: ng,
    }
}

/// A point of the flat triangle, made smooth by the normals of its corners. `side` is 1 in front, −1 behind.
#[inline(always)]
pub(crate) fn smooth_place(
    flat: Place,
    positions: [Vec3; 3],
    normals: [Vec3; 3],
    weights: [f32; 3],
    side: f32,
) -> Place {
    Place {
        lift: terminator_lift(flat.p, positions, normals.map(|n| side * n), weights),
        ns: interpolate(&normals, weights).normalize_or(flat.ng),
        ..flat
    }
}

/// Both sets of texture coordinates; 0 where the mesh has none.
#[inline(always)]
pub(crate) fn mesh_uvs(mesh: &Mesh, corners: [usize; 3], weights: [f32; 3]) -> [Vec2; 2] {
    [0, 1].map(|set| match &mesh.uvs[set] {
        uvs if uvs.is_empty() => Vec2::ZERO,
        uvs => corners.iter().zip(weights).map(|(&i, w)| w * uvs[i]).sum(),
    })
}

/// The vertices' colour; white where the mesh has none.
#[inline(always)]
pub(crate) fn mesh_color(mesh: &Mesh, corners: [usize; 3], weights: [f32; 3]) -> Vec4 {
    match &mesh.colors {
        colors if colors.is_empty() => Vec4::ONE,
        colors => corners
            .iter()
            .zip(weights)
            .map(|(&i, w)| w * colors[i])
            .sum(),
    }
}

#[inline(always)]
fn interpolate(values: &[Vec3; 3], weights: [f32; 3]) -> Vec3 {
    values[0] * weights[0] + values[1] * weights[1] + values[2] * weights[2]
}

/// From the flat triangle to the curved surface that its vertex normals, on the side that is seen, describe.
///
/// Each vertex's tangent plane lifts `p` by its distance below the plane; the three are interpolated. Without it the
/// faces of a smooth mesh shadow each other in bands where light grazes.
///
/// Source: Hanika, "Hacking the Shadow Terminator", Ray Tracing Gems II, chapter 4, 2021.
#[inline(always)]
fn terminator_lift(p: Vec3, positions: [Vec3; 3], normals: [Vec3; 3], weights: [f32; 3]) -> Vec3 {
    let lifts = std::array::from_fn(|k| {
        let below = (p - positions[k]).dot(normals[k]).min(0.0);
        normals[k] * -below
    });
    interpolate(&lifts, weights)
}

/// The mesh's own tangent, or the direction in which u grows on the triangle; +x where neither is known.
///
/// Source of the second: Lengyel, "Foundations of Game Engine Development 2", 2019, section 7.5.
fn mesh_tangent(mesh: &Mesh, uv_set: u8, corners: [usize; 3], weights: [f32; 3]) -> Vec4 {
    if !mesh.tangents.is_empty() {
        let tangents = corners.map(|i| mesh.tangents[i]);
        let direction = interpolate(&tangents.map(Vec4::truncate), weights);
        return direction.extend(tangents[0].w);
    }
    let uvs = &mesh.uvs[usize::from(uv_set & 1)];
    if uvs.is_empty() {
        return Vec3::X.extend(1.0);
    }
    let [a, b, c] = corners.map(|i| uvs[i]);
    let [p, q, r] = corners.map(|i| mesh.positions[i]);
    let (e1, e2) = (q - p, r - p);
    let (d1, d2) = (b - a, c - a);
    // v grows downwards in the image, so a picture that is not mirrored has a negative determinant.
    let determinant = d1.perp_dot(d2);
    let direction = (e1 * d2.y - e2 * d1.y) * determinant.signum();
    direction.extend(if determinant < 0.0 { 1.0 } else { -1.0 })
}
