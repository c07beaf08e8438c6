//! What a glowing surface sends, and where its texture is read.

use super::{
    Placed,
    shape::{Emitter, outward_sign},
};
use crate::{Geometry, Instance, Scene, mesh_point::mesh_uvs, surface::image_uv};
use umbriel_kernels::{
    Triangle,
    glam::{Vec2, Vec3},
};

impl Placed {
    /// The radiance that the surface sends from `at` into the direction `wo`.
    pub(super) fn radiance(&self, scene: &Scene, at: Vec3, wo: Vec3) -> Vec3 {
        let instance = &scene.instances[self.instance as usize];
        let material = &scene.materials[instance.material.index()];
        if let Emitter::Triangle(t) = &self.emitter
            && !material.shows_back()
            && (t.b - t.a).cross(t.c - t.a).dot(wo) * outward_sign(instance) <= 0.0
        {
            return Vec3::ZERO;
        }
        let Some(texture) = &material.emission_texture else {
            return material.emission;
        };
        let uvs = self.uvs(scene, instance, at);
        let uv = texture
            .transform
            .transform_point2(uvs[usize::from(texture.uv_set & 1)]);
        material.emission * scene.textures[texture.texture.index()].eval(uv).truncate()
    }

    /// Texture coordinates at a world point of the primitive.
    fn uvs(&self, scene: &Scene, instance: &Instance, at: Vec3) -> [Vec2; 2] {
        match (instance.geometry, &self.emitter) {
            (Geometry::Mesh(id), Emitter::Triangle(t)) => {
                let mesh = &scene.meshes[id.index()];
                let corners = mesh.indices[self.primitive as usize].map(|i| i as usize);
                mesh_uvs(mesh, corners, weights_at(t, at))
            }
            (Geometry::Surface(id), _) => {
                let local = instance.transform.inverse().transform_point3(at);
                let uv = scene.surfaces[id.index()].point_at(0, local).uv;
                [image_uv(uv); 2]
            }
            _ => [Vec2::ZERO; 2],
        }
    }
}

/// The weights of the corners at a point of a triangle.
fn weights_at(t: &Triangle, at: Vec3) -> [f32; 3] {
    let n = (t.b - t.a).cross(t.c - t.a);
    let whole = n.length_squared().max(f32::MIN_POSITIVE);
    let v = (t.c - t.b).cross(at - t.b).dot(n) / whole;
    let w = (t.a - t.c).cross(at - t.c).dot(n) / whole;
    [v, w, 1.0 - v - w]
}
