//! From a hit to everything that shading needs: position, normals, material at the point.

use crate::{AlphaMode, Bsdf, Geometry, Instance, Material, Mesh, Scene, SceneBvh, TextureRef};
use umbriel_kernels::{
    Hit, Ray, gamma,
    glam::{Affine3A, Mat3, Vec2, Vec3, Vec4},
};

/// A point of a surface, seen along a ray; all vectors in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceInteraction {
    /// Position.
    pub p: Vec3,
    /// Bound of the distance of `p` from the true surface along each axis.
    pub error: Vec3,
    /// Where shadow rays start from: `p`, or for smooth meshes a point on the curved surface that the
    /// normals describe, so that the flat triangles cast no shadows on each other.
    pub shadow_p: Vec3,
    /// Unit geometric normal, on the side of `wo`.
    pub ng: Vec3,
    /// Unit shading normal, turned with `ng`.
    pub ns: Vec3,
    /// Unit direction back along the ray.
    pub wo: Vec3,
    /// Whether the ray came from outside of the body, or onto the front of an open surface.
    pub front: bool,
    /// The material here.
    pub bsdf: Bsdf,
}

/// Attributes of a point in the instance's own space.
struct ObjectPoint {
    p: Vec3,
    error: Vec3,
    /// Added to `p` for shadow rays.
    lift: Vec3,
    ng: Vec3,
    ns: Vec3,
    /// Along growing u, with the bitangent's sign.
    tangent: Vec4,
    uvs: [Vec2; 2],
    color: Vec4,
}

/// Evaluates the surface at a hit. `ray` is the world-space ray of unit direction that found it.
pub fn surface_interaction(bvh: &SceneBvh, ray: &Ray, hit: &Hit) -> SurfaceInteraction {
    let scene = bvh.scene();
    let instance = &scene.instances[hit.instance as usize];
    let material = &scene.materials[instance.material.index()];
    let to_object = bvh.placed(crate::InstanceId(hit.instance)).to_object;
    let object_ray = to_object.as_ref().map_or(*ray, |m| ray.transformed(m));
    let mut point = object_point(scene, instance, &object_ray, hit);
    if let Some(to_object) = &to_object {
        to_world(&mut point, &instance.transform, to_object);
    }
    if let Some(texture) = &material.normal_texture {
        point.ns = bend_normal(scene, material, texture, &point);
    }
    if instance.inside_out {
        point.ng = -point.ng;
        point.ns = -point.ns;
        point.lift = Vec3::ZERO;
    }
    let wo = -ray.dir;
    let side = side_of(wo, point.ng);
    let front = side > 0.0;
    SurfaceInteraction {
        p: point.p,
        error: point.error,
        shadow_p: point.p + side * point.lift,
        ng: side * point.ng,
        ns: side * point.ns,
        wo,
        front,
        bsdf: material_at(scene, material, &point.uvs, point.color, front),
    }
}

/// 1 if `wo` is on the side of the normal `n`, or in its plane, −1 behind.
#[inline(always)]
pub(crate) fn side_of(wo: Vec3, n: Vec3) -> f32 {
    if wo.dot(n) >= 0.0 { 1.0 } else { -1.0 }
}

/// The material's alpha at a hit of an object-space ray.
pub(crate) fn alpha_at(scene: &Scene, object_ray: &Ray, hit: &Hit) -> f32 {
    let instance = &scene.instances[hit.instance as usize];
    let material = &scene.materials[instance.material.index()];
    let point = object_point(scene, instance, object_ray, hit);
    material.alpha * point.color.w * sample(scene, &material.base_color_texture, &point.uvs).w
}

fn object_point(scene: &Scene, instance: &Instance, object_ray: &Ray, hit: &Hit) -> ObjectPoint {
    match instance.geometry {
        Geometry::Mesh(id) => mesh_point(&scene.meshes[id.index()], hit),
        Geometry::Surface(id) if !scene.materials[instance.material.index()].is_textured() => {
            let (p, n) = scene.surfaces[id.index()].normal_at(hit.primitive, object_ray.at(hit.t));
            ObjectPoint {
                p,
                error: surface_error(p),
                lift: Vec3::ZERO,
                ng: n,
                ns: n,
                tangent: Vec4::ZERO,
                uvs: [Vec2::ZERO; 2],
                color: Vec4::ONE,
            }
        }
        Geometry::Surface(id) => {
            let at = scene.surfaces[id.index()].point_at(hit.primitive, object_ray.at(hit.t));
            ObjectPoint {
                p: at.p,
                error: surface_error(at.p),
                lift: Vec3::ZERO,
                ng: at.n,
                ns: at.n,
                tangent: at.tangent.extend(1.0),
                uvs: [at.uv; 2],
                color: Vec4::ONE,
            }
        }
    }
}

/// Moved onto the surface in f64 and rounded once; the rest is for the normal's rounding.
#[inline(always)]
pub(crate) fn surface_error(p: Vec3) -> Vec3 {
    p.abs() * gamma(4) + Vec3::splat(f32::MIN_POSITIVE)
}

fn mesh_point(mesh: &Mesh, hit: &Hit) -> ObjectPoint {
    let corners = mesh.indices[hit.primitive as usize].map(|i| i as usize);
    let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
    let triangle = mesh.triangle(hit.primitive as usize);
    let positions = [triangle.a, triangle.b, triangle.c];
    let parts: [Vec3; 3] = std::array::from_fn(|k| weights[k] * positions[k]);
    let p = parts[0] + parts[1] + parts[2];
    let ng = triangle.normal().normalize();

    let (mut ns, mut lift) = (ng, Vec3::ZERO);
    if !mesh.normals.is_empty() {
        let normals = corners.map(|i| mesh.normals[i]);
        ns = interpolate(&normals, weights).normalize_or(ng);
        lift = terminator_lift(p, positions, normals, weights);
    }
    let uvs = [0, 1].map(|set| match &mesh.uvs[set] {
        uvs if uvs.is_empty() => Vec2::ZERO,
        uvs => corners.iter().zip(weights).map(|(&i, w)| w * uvs[i]).sum(),
    });
    ObjectPoint {
        p,
        // Three products, two sums and the rounding of the weights, whose sum is not quite 1.
        error: (parts[0].abs() + parts[1].abs() + parts[2].abs()) * gamma(8)
            + Vec3::splat(f32::MIN_POSITIVE),
        lift,
        ng,
        ns,
        tangent: mesh_tangent(mesh, corners, weights, positions),
        uvs,
        color: match &mesh.colors {
            colors if colors.is_empty() => Vec4::ONE,
            colors => corners
                .iter()
                .zip(weights)
                .map(|(&i, w)| w * colors[i])
                .sum(),
        },
    }
}

fn interpolate(values: &[Vec3; 3], weights: [f32; 3]) -> Vec3 {
    values[0] * weights[0] + values[1] * weights[1] + values[2] * weights[2]
}

/// From the flat triangle to the curved surface that its vertex normals describe.
///
/// Each vertex's tangent plane lifts `p` by its distance below the plane; the three are interpolated. Without it the
/// faces of a smooth mesh shadow each other in bands where light grazes.
///
/// Source: Hanika, "Hacking the Shadow Terminator", Ray Tracing Gems II, chapter 4, 2021.
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
fn mesh_tangent(mesh: &Mesh, corners: [usize; 3], weights: [f32; 3], positions: [Vec3; 3]) -> Vec4 {
    if !mesh.tangents.is_empty() {
        let tangents = corners.map(|i| mesh.tangents[i]);
        let direction = interpolate(&tangents.map(Vec4::truncate), weights);
        return direction.extend(tangents[0].w);
    }
    if mesh.uvs[0].is_empty() {
        return Vec3::X.extend(1.0);
    }
    let [a, b, c] = corners.map(|i| mesh.uvs[0][i]);
    let (e1, e2) = (positions[1] - positions[0], positions[2] - positions[0]);
    let (d1, d2) = (b - a, c - a);
    // v grows downwards in the image, so a picture that is not mirrored has a negative determinant.
    let determinant = d1.perp_dot(d2);
    let direction = (e1 * d2.y - e2 * d1.y) * determinant.signum();
    direction.extend(if determinant < 0.0 { 1.0 } else { -1.0 })
}

/// Moves a point to world space and adds what the rounding of the transform, and of the way back that
/// rays take, can move it.
fn to_world(point: &mut ObjectPoint, transform: &Affine3A, to_object: &Affine3A) {
    let m = Mat3::from(transform.matrix3);
    let inverse = Mat3::from(to_object.matrix3);
    let absolute = |m: &Mat3| Mat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs());
    let reach = absolute(&m) * point.p.abs() + Vec3::from(transform.translation).abs();
    let p = transform.transform_point3(point.p);
    let way_back = absolute(&inverse) * p.abs() + Vec3::from(to_object.translation).abs();
    point.error = absolute(&m) * (point.error + gamma(8) * way_back) + gamma(8) * reach;
    point.p = p;
    point.lift = m * point.lift;
    // Normals transform by the inverse transpose, which keeps the outside outside under mirroring, too.
    let normals = inverse.transpose();
    point.ng = (normals * point.ng).normalize();
    point.ns = (normals * point.ns).normalize_or(point.ng);
    point.tangent =
        (m * point.tangent.truncate()).extend(point.tangent.w * m.determinant().signum());
}

/// The normal of a tangent-space normal map; the smooth normal where the tangent vanishes.
///
/// Source: Khronos, glTF 2.0 specification, section 3.9.3, 2021.
fn bend_normal(
    scene: &Scene,
    material: &Material,
    texture: &TextureRef,
    point: &ObjectPoint,
) -> Vec3 {
    let n = point.ns;
    let Some(tangent) =
        (point.tangent.truncate() - n * n.dot(point.tangent.truncate())).try_normalize()
    else {
        return n;
    };
    let bitangent = n.cross(tangent) * point.tangent.w;
    let texel = sample(scene, &Some(*texture), &point.uvs).truncate() * 2.0 - 1.0;
    let bent = tangent * (texel.x * material.normal_scale)
        + bitangent * (texel.y * material.normal_scale)
        + n * texel.z;
    bent.normalize_or(n)
}

/// A texture's value, or all ones where there is none.
#[inline]
fn sample(scene: &Scene, texture: &Option<TextureRef>, uvs: &[Vec2; 2]) -> Vec4 {
    match texture {
        Some(t) => scene.textures[t.texture.index()]
            .eval(t.transform.transform_point2(uvs[usize::from(t.uv_set & 1)])),
        None => Vec4::ONE,
    }
}

/// Looks the material's textures up; `front` decides whether light enters or leaves.
#[inline]
pub(crate) fn material_at(
    scene: &Scene,
    material: &Material,
    uvs: &[Vec2; 2],
    color: Vec4,
    front: bool,
) -> Bsdf {
    let base = sample(scene, &material.base_color_texture, uvs) * color;
    let rough = sample(scene, &material.metallic_roughness_texture, uvs);
    let emission = sample(scene, &material.emission_texture, uvs).truncate();
    let transmission = sample(scene, &material.transmission_texture, uvs).x;
    Bsdf {
        base_color: material.base_color * base.truncate(),
        alpha: match material.alpha_mode {
            AlphaMode::Blend => material.alpha * base.w,
            AlphaMode::Opaque | AlphaMode::Mask { .. } => 1.0,
        },
        metallic: material.metallic * rough.z,
        roughness: material.roughness * rough.y,
        emission: material.emission * emission,
        transmission: material.transmission * transmission,
        ior: material.ior,
        eta: match (material.thin_walled, front) {
            (true, _) => 1.0,
            (false, true) => material.ior,
            (false, false) => 1.0 / material.ior,
        },
        thin_walled: material.thin_walled,
        unlit: material.unlit,
    }
}
