//! What may stand in a scene file. The doc comments become the descriptions in the JSON Schema.

use super::implicit::ImplicitTable;
use super::material_table::MaterialTable;
use super::shadow_map::ShadowMapTable;
use super::shapes::TransformTable;
use super::shapes::{
    BoxTable, ConeTable, CylinderTable, DiskTable, PlaneTable, RectangleTable, SphereTable,
    TorusTable,
};
use super::values::{Color, Resolution, Vec3};
use schemars::JsonSchema;
use serde::Deserialize;

/// A scene of Umbriel.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(title = "Umbriel scene")]
pub(super) struct Document {
    /// Other scene files, beside or below this one, whose content is added.
    pub include: Vec<String>,
    /// How the picture is made.
    pub render: RenderTable,
    /// The sky.
    pub environment: EnvironmentTable,
    /// Views; the first is the default.
    pub camera: Vec<CameraTable>,
    /// What things are made of.
    pub material: Vec<MaterialTable>,
    /// Checker textures.
    pub checker: Vec<CheckerTable>,
    /// Image textures.
    pub image: Vec<ImageTable>,
    /// Lights that shine from a point in all directions.
    pub point_light: Vec<PointLightTable>,
    /// Lights that shine from a point into a cone.
    pub spot_light: Vec<SpotLightTable>,
    /// Parallel light from infinitely far away.
    pub directional_light: Vec<DirectionalLightTable>,
    /// Spheres.
    pub sphere: Vec<SphereTable>,
    /// Infinite planes.
    pub plane: Vec<PlaneTable>,
    /// Flat disks.
    pub disk: Vec<DiskTable>,
    /// Flat rectangles.
    pub rectangle: Vec<RectangleTable>,
    /// Solid boxes.
    #[serde(rename = "box")]
    pub cuboid: Vec<BoxTable>,
    /// Solid cylinders.
    pub cylinder: Vec<CylinderTable>,
    /// Solid cones and truncated cones.
    pub cone: Vec<ConeTable>,
    /// Rings.
    pub torus: Vec<TorusTable>,
    /// Surfaces given by a formula.
    pub implicit: Vec<ImplicitTable>,
    /// Triangle meshes from files.
    pub mesh: Vec<MeshTable>,
    /// Whole scenes from files, with their materials, lights and cameras.
    pub model: Vec<ModelTable>,
}

/// How the picture is made; the command line goes first.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(super) struct RenderTable {
    /// The algorithm.
    pub method: Option<MethodName>,
    /// Width and height in pixels.
    pub resolution: Option<Resolution>,
    /// Samples a pixel, at least 1.
    pub spp: Option<u32>,
    /// Adaptive sampling in place of `spp`.
    pub adaptive: Option<AdaptiveTable>,
    /// Greatest number of mirrored or refracted rays one after the other, from 0 to 64.
    pub depth: Option<u32>,
    /// Rays whose weight falls below this are not traced, from 0 to 1; 1/256 unless given.
    pub min_weight: Option<f32>,
    /// Whether lights cast shadows.
    pub shadows: Option<bool>,
    /// What a shadow ray does at glass.
    pub glass_shadows: Option<GlassShadowsName>,
    /// The shadow maps of all lights, as far as a light has no table of its own.
    pub shadow_map: Option<ShadowMapTable>,
    /// Changes the places of the samples in the pixels.
    pub seed: Option<u64>,
    /// Exposure in stops: 1 doubles the brightness.
    pub exposure: Option<f32>,
    /// How radiance becomes a displayed colour.
    pub tonemap: Option<TonemapName>,
}

/// Adaptive sampling: a pixel whose corners differ is divided, again and again.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct AdaptiveTable {
    /// Greatest difference of two corners, in any channel clipped to 0..1, that is not divided.
    pub threshold: f32,
    /// How often a pixel may be divided, 1 to 6.
    pub levels: u32,
}

/// The algorithm.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum MethodName {
    /// One eye ray and one shadow ray a light (Appel 1968).
    RayCast,
    /// Mirrored and refracted rays (Whitted 1980).
    Whitted,
    /// Depth images from the lights tell what is lit (Williams 1978).
    ShadowMap,
    /// Rays that go on at random, from surface to surface (Kajiya 1986).
    Path,
    /// Whitted's rays spread over lights and rough lobes (Cook 1984).
    Distributed,
}

/// What a shadow ray does at glass.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum GlassShadowsName {
    /// Light passes straight through, weakened.
    Filtered,
    /// Glass blocks light.
    Opaque,
}

/// How radiance becomes a displayed colour.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum TonemapName {
    /// Khronos PBR Neutral.
    Neutral,
    /// Clipped at 1.
    Linear,
    /// ACES.
    Aces,
    /// AgX.
    Agx,
}

/// The sky: radiance changes linearly with the height of the direction.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(super) struct EnvironmentTable {
    /// Radiance in all directions, in place of `zenith` and `nadir`.
    pub color: Option<Color>,
    /// Radiance straight up, in nit.
    pub zenith: Option<Color>,
    /// Radiance straight down, in nit.
    pub nadir: Option<Color>,
    /// Uniform radiance in place of indirect light; by default it is taken from the sky.
    pub ambient: Option<Color>,
    /// Path of a picture of all directions in place of colours: Radiance HDR or EXR, latitude by longitude, its middle straight ahead (−z).
    pub map: Option<String>,
    /// By how much the map's radiance is multiplied; 1 by default.
    pub strength: Option<f32>,
    /// Degrees by which the map is turned about the upright axis; positive takes what is ahead to the left. 0 by default.
    pub rotation: Option<f32>,
}

/// A view.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraTable {
    /// Name for `--camera`.
    pub name: Option<String>,
    /// Where the camera is.
    pub eye: Vec3,
    /// The point in the middle of the picture.
    pub look_at: Vec3,
    /// What is upright in the picture; [0, 1, 0] by default.
    pub up: Option<Vec3>,
    /// Vertical field of view in degrees, between 0 and 180; 45 by default.
    pub fov: Option<f32>,
    /// Height of the picture in metres, for an orthographic camera; in place of `fov`.
    pub height: Option<f32>,
    /// Diameter of the lens in metres, which blurs what is not in focus under the methods `path` and `distributed`; 0, a pinhole, by default.
    pub aperture: Option<f32>,
    /// Distance of what is in focus in metres; that of `look_at` by default.
    pub focus: Option<f32>,
}

/// Unit squares in texture space, alternating in both directions.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct CheckerTable {
    /// Name by which materials refer to it.
    pub name: String,
    /// Colour of the square from (0, 0) to (1, 1); white by default.
    pub even: Option<Color>,
    /// Colour of its neighbours; black by default.
    pub odd: Option<Color>,
}

/// An image as texture.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ImageTable {
    /// Name by which materials refer to it.
    pub name: String,
    /// A PNG or JPEG file beside or below the scene file.
    pub file: String,
    /// How the stored bytes become numbers: "srgb" (default, colours) or "linear" (normals and factors).
    pub encoding: Option<EncodingName>,
    /// What is outside of the image.
    pub wrap: Option<WrapName>,
    /// What is between texel centres.
    pub filter: Option<FilterName>,
}

/// How stored bytes become numbers.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum EncodingName {
    /// Colours in the sRGB curve.
    Srgb,
    /// Numbers.
    Linear,
}

/// What is outside of an image.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum WrapName {
    /// The image again.
    Repeat,
    /// The image again, every other time mirrored.
    Mirror,
    /// Its edge.
    Clamp,
}

/// What is between texel centres.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum FilterName {
    /// The nearest texel.
    Nearest,
    /// The four nearest texels, weighted.
    Bilinear,
}

/// A light that shines from a point in all directions.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct PointLightTable {
    /// Name in messages.
    pub name: Option<String>,
    /// Where it is.
    pub position: Vec3,
    /// Luminous intensity in candela: the illuminance in lux at 1 m.
    pub intensity: Color,
    /// Distance in metres at which the light ends; infinite by default.
    pub range: Option<f32>,
    /// Diameter in metres of the ball that shines, for soft shadows; 0 by default.
    pub diameter: Option<f32>,
    /// Its shadow map.
    pub shadow_map: Option<ShadowMapTable>,
}

/// A light that shines from a point into a cone, towards `direction` or `look_at`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SpotLightTable {
    /// Name in messages.
    pub name: Option<String>,
    /// Where it is.
    pub position: Vec3,
    /// Direction into which it shines, of any length.
    pub direction: Option<Vec3>,
    /// Point at which it shines, in place of `direction`.
    pub look_at: Option<Vec3>,
    /// Luminous intensity on the axis, in candela.
    pub intensity: Color,
    /// Distance in metres at which the light ends; infinite by default.
    pub range: Option<f32>,
    /// Degrees from the axis up to which the light has full intensity; 0 by default.
    pub inner_angle: Option<f32>,
    /// Degrees from the axis at which the light ends, at most 90; 45 by default.
    pub outer_angle: Option<f32>,
    /// Diameter in metres of the ball that shines, for soft shadows; 0 by default.
    pub diameter: Option<f32>,
    /// Its shadow map.
    pub shadow_map: Option<ShadowMapTable>,
}

/// Parallel light, towards `direction`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct DirectionalLightTable {
    /// Name in messages.
    pub name: Option<String>,
    /// Direction into which it shines, of any length.
    pub direction: Vec3,
    /// Illuminance in lux on a surface that faces the light; π makes a white diffuse surface have radiance 1.
    pub illuminance: Color,
    /// Degrees that the light fills in the sky, for soft shadows: 0.53 for the sun; 0 by default.
    pub angle: Option<f32>,
    /// Its shadow map.
    pub shadow_map: Option<ShadowMapTable>,
}

/// All triangle meshes of a file.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct MeshTable {
    /// Name in messages.
    pub name: Option<String>,
    /// A .ply, .stl, .obj, .gltf or .glb file beside or below the scene file.
    pub file: String,
    /// One material for all of it; by default the file's.
    pub material: Option<String>,
    /// Where it stands.
    pub transform: Option<TransformTable>,
    /// Turns it inside out.
    pub inside_out: Option<bool>,
}

/// A whole scene from a file, with its materials, lights and cameras.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ModelTable {
    /// Name in messages.
    pub name: Option<String>,
    /// A .gltf, .glb, .obj, .ply or .stl file beside or below the scene file.
    pub file: String,
    /// Where it stands.
    pub transform: Option<TransformTable>,
}
