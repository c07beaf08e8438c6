//! One scene, drawn by rays. (Under construction.)

#![warn(clippy::print_stdout, clippy::print_stderr)]

mod adaptive;
mod aov;
mod bsdf;
mod camera;
mod color;
mod compare;
mod direct;
mod environment;
mod film;
mod fresnel;
mod ids;
mod image;
mod light;
mod material;
mod mesh;
mod ray_cast;
mod render;
mod sampler;
mod scene;
mod scene_bvh;
mod settings;
mod shadow_rays;
mod surface;
mod texture;
mod trace;
mod unshadowed;
mod validate;
mod validate_parts;
mod whitted;

pub use aov::render_aovs;
pub use bsdf::{Bsdf, albedo_ggx, eval_diffuse, eval_ggx};
pub use camera::{Camera, CameraFrame, Projection};
pub use color::{LUMINANCE, Tonemap, auto_exposure, develop, linear_to_srgb, srgb_to_linear};
pub use compare::{Comparison, compare, difference_picture};
pub use direct::Visibility;
pub use environment::Environment;
pub use film::{Film, Stats};
pub use fresnel::{fresnel_dielectric, fresnel_schlick, normal_reflectance, reflect, refract};
pub use ids::{InstanceId, MaterialId, MeshId, SurfaceId, TextureId};
pub use image::{Aov, Image, Layer};
pub use light::{DirectionalLight, Light, LightSample, PointLight, SpotLight};
pub use material::{AlphaMode, Material, TextureRef};
pub use mesh::Mesh;
pub use render::{Control, render};
pub use sampler::sample_pixel;
pub use scene::{Geometry, Instance, Scene};
pub use scene_bvh::SceneBvh;
pub use settings::{GlassShadows, Method, Sampling, Settings};
pub use shadow_rays::ShadowRays;
pub use surface::{SurfaceInteraction, surface_interaction};
pub use texture::{Checker, Encoding, Filter, ImageTexture, Texture, Wrap};
pub use umbriel_kernels as kernels;
pub use unshadowed::Unshadowed;
pub use validate::{Element, SceneError};
