//! From a hit to everything that shading needs: position, normals, material at the point.

use crate::{
    AlphaMode, Bsdf, Geometry, Instance, Layers, Material, Scene, SceneBvh, TextureRef,
    mesh_point::mesh_point,
};
use umbriel_kernels::{
    Hit, Ray, SurfaceList, gamma,
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

/// Where a point is and how the surface lies there; normals point out of the body, or out of the front.
#[derive(Clone, Copy)]
pub(crate) struct Place {
    pub(crate) p: Vec3,
    pub(crate) error: Vec3,
    /// Added to `p` for shadow rays.
    pub(crate) lift: Vec3,
    pub(crate) ng: Vec3,
    pub(crate) ns: Vec3,
}

impl Place {
    /// A point of an analytic surface.
    #[inline(always)]
    pub(crate) fn on_surface(p: Vec3, n: Vec3) -> Self {
        Self {
            p,
            error: surface_error(p),
            lift: Vec3::ZERO,
            ng: n,
            ns: n,
        }
    }
}

/// Attributes of a point in the instance's own space.
pub(crate) struct ObjectPoint {
    pub(crate) place: Place,
    /// Along growing u, with the bitangent's sign.
    pub(crate) tangent: Vec4,
    pub(crate) uvs: [Vec2; 2],
    pub(crate) color: Vec4,
}

/// Evaluates the surface at a hit. `ray` is the world-space ray of unit direction that found it.
pub fn surface_interaction(bvh: &SceneBvh, ray: &Ray, hit: &Hit) -> SurfaceInteraction {
    let scene = bvh.scene();
    let instance = &scene.instances[hit.instance as usize];
    let material = &scene.materials[instance.material.index()];
    let to_object = bvh.to_object(crate::InstanceId(hit.instance));
    let object_ray = to_object.map_or(*ray, |m| ray.transformed(m));
    let mut point = object_point(scene, instance, &object_ray, hit);
    if let Some(to_object) = to_object {
        let to_world = ToWorld::new(&instance.transform, to_object);
        point.place = to_world.place(point.place);
        point.tangent = to_world.tangent(point.tangent);
    }
    if let Some(texture) = &material.normal_texture {
        point.place.ns = bend_normal(scene, material, texture, &point);
    }
    let brush = brush_direction(material, &point);
    let wo = -ray.dir;
    let (place, side) = face_viewer(point.place, instance.inside_out, wo);
    let front = side > 0.0;
    let mut bsdf = material_at(scene, material, &point.uvs, point.color, front);
    if let Some(layers) = &mut bsdf.layers {
        layers.tangent = brush;
    }
    SurfaceInteraction {
        p: place.p,
        error: place.error,
        shadow_p: place.p + place.lift,
        ng: place.ng,
        ns: place.ns,
        wo,
        front,
        bsdf,
    }
}

/// Along which highlights of a brushed material are drawn out; 0 for other materials.
fn brush_direction(material: &Material, point: &ObjectPoint) -> Vec3 {
    if material.layers.anisotropy == 0.0 {
        return Vec3::ZERO;
    }
    let n = point.place.ns;
    let tangent = point.tangent.truncate();
    let along = (tangent - n * n.dot(tangent)).normalize_or_zero();
    let across = n.cross(along) * point.tangent.w;
    let (sin, cos) = material.layers.anisotropy_rotation.sin_cos();
    along * cos + across * sin
}

/// Turns the normals to the side of `wo`; 1 if that is the outside or the front, −1 if not.
#[inline(always)]
pub(crate) fn face_viewer(place: Place, inside_out: bool, wo: Vec3) -> (Place, f32) {
    let (place, side) = turn_to_viewer(place, inside_out, wo);
    let ns = towards_viewer(place.ns, place.ng, wo);
    (Place { ns, ..place }, side)
}

/// [`face_viewer`] but for shading normals that point away from the viewer.
#[inline(always)]
pub(crate) fn turn_to_viewer(place: Place, inside_out: bool, wo: Vec3) -> (Place, f32) {
    let outwards = if inside_out { -1.0 } else { 1.0 };
    let (ng, ns) = (outwards * place.ng, outwards * place.ns);
    let side = side_of(wo, ng);
    let (ng, ns) = (side * ng, side * ns);
    (Place { ng, ns, ..place }, side)
}

/// The shading normal, or where it points away from the viewer, as it may near silhouettes of smooth meshes, the nearest
/// direction that does not.
#[inline(always)]
pub(crate) fn towards_viewer(ns: Vec3, ng: Vec3, wo: Vec3) -> Vec3 {
    let cos_o = ns.dot(wo);
    if cos_o >= 0.0 {
        return ns;
    }
    (ns - wo * cos_o).normalize_or(ng)
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

/// The first hit from `hit` on of an object-space ray with an analytic surface, alone in its list, where alpha is not below `cutoff`.
pub(crate) fn first_opaque(
    scene: &Scene,
    surface: &SurfaceList,
    ray: &Ray,
    mut hit: Hit,
    cutoff: f32,
) -> Option<Hit> {
    // A ray meets a torus four times, and nothing more often.
    for _ in 0..8 {
        if alpha_at(scene, ray, &hit) >= cutoff {
            return Some(hit);
        }
        let mut rest = *ray;
        rest.t.min = hit.t;
        let mut next = [None];
        surface.closest(&[rest], &mut next);
        hit = next[0]?;
    }
    None
}

fn object_point(scene: &Scene, instance: &Instance, object_ray: &Ray, hit: &Hit) -> ObjectPoint {
    match instance.geometry {
        Geometry::Mesh(id) => {
            let material = &scene.materials[instance.material.index()];
            let uv_set = material.normal_texture.map_or(0, |texture| texture.uv_set);
            mesh_point(&scene.meshes[id.index()], object_ray, hit, uv_set)
        }
        Geometry::Surface(id)
            if !scene.materials[instance.material.index()].is_textured()
                && scene.materials[instance.material.index()].layers.anisotropy == 0.0 =>
        {
            let (p, n) = scene.surfaces[id.index()].normal_at(hit.primitive, object_ray.at(hit.t));
            ObjectPoint {
                place: Place::on_surface(p, n),
                tangent: Vec4::ZERO,
                uvs: [Vec2::ZERO; 2],
                color: Vec4::ONE,
            }
        }
        Geometry::Surface(id) => {
            let at = scene.surfaces[id.index()].point_at(hit.primitive, object_ray.at(hit.t));
            ObjectPoint {
                place: Place::on_surface(at.p, at.n),
                tangent: at.tangent.extend(1.0),
                uvs: [image_uv(at.uv); 2],
                color: Vec4::ONE,
            }
        }
    }
}

/// From a surface's coordinates, whose v grows upwards, to an image's, whose v grows downwards.
#[inline(always)]
pub(crate) fn image_uv(uv: Vec2) -> Vec2 {
    Vec2::new(uv.x, 1.0 - uv.y)
}

/// Moved onto the surface in f64 and rounded once; the rest is for the normal's rounding.
#[inline(always)]
pub(crate) fn surface_error(p: Vec3) -> Vec3 {
    p.abs() * gamma(4) + Vec3::splat(f32::MIN_POSITIVE)
}

/// From the space of an instance to the world's.
pub(crate) struct ToWorld {
    matrix: Mat3,
    translation: Vec3,
    absolute: Mat3,
    inverse: Mat3,
    absolute_inverse: Mat3,
    /// Of the way back.
    absolute_translation: Vec3,
    /// Normals transform by the inverse transpose, which keeps the outside outside under mirroring, too.
    normals: Mat3,
}

impl ToWorld {
    /// `to_object` is the inverse of `transform`.
    pub(crate) fn new(transform: &Affine3A, to_object: &Affine3A) -> Self {
        let matrix = Mat3::from(transform.matrix3);
        let inverse = Mat3::from(to_object.matrix3);
        let absolute = |m: &Mat3| Mat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs());
        Self {
            matrix,
            translation: transform.translation.into(),
            absolute: absolute(&matrix),
            inverse,
            absolute_inverse: absolute(&inverse),
            absolute_translation: Vec3::from(to_object.translation).abs(),
            normals: inverse.transpose(),
        }
    }

    /// Moves a point, and adds to its error what the rounding of the transform, and of the way back that rays take, can
    /// move it.
    #[inline(always)]
    pub(crate) fn place(&self, of: Place) -> Place {
        let reach = self.absolute * of.p.abs() + self.translation.abs();
        let p = self.matrix * of.p + self.translation;
        let way_back = self.absolute_inverse * p.abs() + self.absolute_translation;
        let ng = (self.normals * of.ng).normalize();
        Place {
            p,
            error: self.absolute * (of.error + gamma(8) * way_back) + gamma(8) * reach,
            lift: self.matrix * of.lift,
            ng,
            ns: (self.normals * of.ns).normalize_or(ng),
        }
    }

    /// The direction in the instance's space; not of unit length.
    #[inline(always)]
    pub(crate) fn way_back(&self, dir: Vec3) -> Vec3 {
        self.inverse * dir
    }

    /// A direction on the surface with the sign of its bitangent.
    fn tangent(&self, tangent: Vec4) -> Vec4 {
        (self.matrix * tangent.truncate()).extend(tangent.w * self.matrix.determinant().signum())
    }
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
    let n = point.place.ns;
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
#[inline(always)]
fn sample(scene: &Scene, texture: &Option<TextureRef>, uvs: &[Vec2; 2]) -> Vec4 {
    match texture {
        Some(t) => scene.textures[t.texture.index()]
            .eval(t.transform.transform_point2(uvs[usize::from(t.uv_set & 1)])),
        None => Vec4::ONE,
    }
}

/// Looks the material's textures up; `front` decides whether light enters or leaves.
#[inline(always)]
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
        is_glossy: false,
        layers: material
            .has_layers()
            .then(|| layers_at(scene, material, uvs)),
    }
}

/// Looks the textures of the layers up.
fn layers_at(scene: &Scene, material: &Material, uvs: &[Vec2; 2]) -> Layers {
    let (layers, textures) = (&material.layers, &material.layer_textures);
    let at = |texture| sample(scene, texture, uvs);
    Layers {
        specular: layers.specular * at(&textures.specular).w,
        specular_color: layers.specular_color * at(&textures.specular_color).truncate(),
        clearcoat: layers.clearcoat * at(&textures.clearcoat).x,
        clearcoat_roughness: layers.clearcoat_roughness * at(&textures.clearcoat_roughness).y,
        sheen_color: layers.sheen_color * at(&textures.sheen_color).truncate(),
        sheen_roughness: layers.sheen_roughness * at(&textures.sheen_roughness).w,
        iridescence: layers.iridescence * at(&textures.iridescence).x,
        ..*layers
    }
}
