//! Triangle meshes.

use umbriel_kernels::{
    Aabb, Triangle,
    glam::{Vec2, Vec3, Vec4},
};

/// An indexed triangle mesh in its own space.
///
/// Every vertex attribute is either empty or as long as `positions`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Name in messages; need not be unique.
    pub name: String,
    /// Vertex positions.
    pub positions: Vec<Vec3>,
    /// Shading normals of unit length; when empty, faces are flat.
    pub normals: Vec<Vec3>,
    /// Tangents (xyz, unit length) with the sign of the bitangent (w = ±1), as in glTF; when empty and
    /// a normal map needs them, they come from the texture coordinates of each triangle.
    pub tangents: Vec<Vec4>,
    /// Two sets of texture coordinates; v grows downwards in the image, as in glTF.
    pub uvs: [Vec<Vec2>; 2],
    /// Linear colours with alpha, multiplied into the material's base colour.
    pub colors: Vec<Vec4>,
    /// Three vertex indices a triangle; the front is the side from which they run counter-clockwise.
    pub indices: Vec<[u32; 3]>,
}

impl Mesh {
    /// The corners of triangle `i`.
    #[inline]
    pub fn triangle(&self, i: usize) -> Triangle {
        let [a, b, c] = self.indices[i];
        Triangle {
            a: self.positions[a as usize],
            b: self.positions[b as usize],
            c: self.positions[c as usize],
        }
    }

    /// The box around all vertices that a triangle uses; empty for a mesh without triangles.
    pub fn bounds(&self) -> Aabb {
        Aabb::from_points(
            self.indices
                .iter()
                .flatten()
                .map(|&i| self.positions[i as usize]),
        )
    }
}
