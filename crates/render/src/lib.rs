//! One scene, drawn by rays. (Under construction.)

#![warn(clippy::print_stdout, clippy::print_stderr)]

mod camera;
mod environment;
mod ids;
mod image;
mod light;
mod material;
mod mesh;
mod scene;
mod settings;
mod texture;
mod validate;

pub use camera::{Camera, Projection};
pub use environment::Environment;
pub use image::{Aov, Image, Layer};
pub use ids::{InstanceId, MaterialId, MeshId, SurfaceId, TextureId};
pub use light::{DirectionalLight, Light, PointLight, SpotLight};
pub use material::{AlphaMode, Material, TextureRef};
pub use mesh::Mesh;
pub use scene::{Geometry, Instance, Scene};
pub use settings::{GlassShadows, Method, Sampling, Settings};
pub use texture::{Checker, Encoding, Filter, ImageTexture, Texture, Wrap};
pub use umbriel_kernels as kernels;
pub use validate::{Element, SceneError};
