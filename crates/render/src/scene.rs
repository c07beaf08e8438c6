//! The scene: plain vectors, linked by typed indices.

use crate::{
    Camera, Environment, EnvironmentMap, Light, Material, MaterialId, Mesh, MeshId, SurfaceId,
    Texture,
};
use umbriel_kernels::{
    Surface,
    glam::{Affine3A, Vec3},
};

/// Everything that a picture is made of. One model for all algorithms.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// Views; the first is the default.
    pub cameras: Vec<Camera>,
    /// Triangle meshes, each in its own space.
    pub meshes: Vec<Mesh>,
    /// Analytic surfaces, each in its own space.
    pub surfaces: Vec<Surface>,
    /// What stands in the world: a mesh or surface with a transform and a material.
    pub instances: Vec<Instance>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Textures.
    pub textures: Vec<Texture>,
    /// Lights.
    pub lights: Vec<Light>,
    /// The sky.
    pub environment: Environment,
    /// What is around in place of the sky's colours; see [`Scene::surround`].
    pub environment_map: Option<EnvironmentMap>,
}

/// What an instance is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Geometry {
    /// A triangle mesh.
    Mesh(MeshId),
    /// An analytic surface.
    Surface(SurfaceId),
}

/// A mesh or surface that stands in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// Name in messages.
    pub name: String,
    /// What it is.
    pub geometry: Geometry,
    /// Object space to world space; invertible.
    pub transform: Affine3A,
    /// What it is made of.
    pub material: MaterialId,
    /// Turns the surface inside out: its outside counts as the inside of its material. A sphere so
    /// turned is a bubble in glass.
    pub inside_out: bool,
}

impl Scene {
    /// Puts a map around the scene, for all methods: seen, and as ambient light.
    pub fn surround(&mut self, map: EnvironmentMap) {
        self.environment.map = Some(map.irradiance());
        self.environment_map = Some(map);
    }

    /// The radiance that arrives from the unit direction `dir` where nothing stands, in nit.
    #[inline(always)]
    pub(crate) fn sky(&self, dir: Vec3) -> Vec3 {
        match &self.environment_map {
            Some(map) => map.radiance(dir),
            None => self.environment.radiance(dir),
        }
    }
}
