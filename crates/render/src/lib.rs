//! One scene, drawn by shadow maps (Williams 1978) and by rays: ray casting (Appel 1968), Whitted's ray tracing (1980) and path tracing
//! (Kajiya 1986).
//!
//! A [`Scene`] is plain data. [`SceneBvh::build`] makes it ready for rays, [`render()`] draws it with a [`Camera`] and
//! [`Settings`] into a [`Film`], and [`develop`] turns that into bytes for a screen. `ARCHITECTURE.md` says how the
//! algorithms share one queue of weighted rays. Files of the table without a folder stand in `src/`, those of shadow maps in `src/shadow_map/`.
//!
//! | topic | function | source |
//! |---|---|---|
//! | ray casting, Whitted's ray tracing, shadow mapping | [`render()`] with a [`Method`] | Appel 1968; Whitted 1980; Williams 1978 |
//! | path tracing, distributed ray tracing | [`render()`] with [`Method::Path`], [`Method::Distributed`]: `path/` | Kajiya 1986; Cook, Porter & Carpenter 1984; Veach & Guibas 1995 (rays to lights and rays that find them) |
//! | one light of many | [`LightTree::sample`]; twin `light_tree/few.rs` | Conty Estevez & Kulla 2018 |
//! | directions towards lights with area | [`sample_sphere`], [`sample_disk`], [`sample_rectangle`], [`sample_triangle`] | Shirley, Wang & Zimmerman 1996; Ureña, Fajardo & King 2013; Arvo 1995 |
//! | directions towards the bright parts of the sky | [`EnvironmentMap::sample`] | Pharr, Jakob & Humphreys 2023 |
//! | well-spread random numbers | [`PixelSampler`] | Burley 2020; Ahmed & Wonka 2020 |
//! | when a picture of samples stops | [`PathFilm`] | Schmeiser 1982 (its noise); Kirk & Arvo 1991 (bias) |
//! | adaptive anti-aliasing | [`Sampling::Adaptive`] | Whitted 1980; Mitchell 1987 |
//! | pinhole camera: rays, projection | [`CameraFrame::ray`], [`Camera::view_projection`] | |
//! | a hit becomes a point of a surface | [`surface_interaction`] | Pharr, Jakob & Humphreys 2023 (error bounds) |
//! | tangent-space normal maps | in [`surface_interaction`] | glTF 2.0, 2021 |
//! | shadow terminator of smooth meshes | in [`surface_interaction`] | Hanika 2021 |
//! | reflection, refraction | [`reflect`], [`refract`] | Heckbert 1989 |
//! | Fresnel | [`fresnel_dielectric`], [`fresnel_schlick`] | Hecht; Schlick 1994 |
//! | diffuse lobe | [`eval_diffuse`] | Lambert 1760 |
//! | rough specular lobe | [`eval_ggx`], [`sample_ggx`], [`pdf_ggx`] | Walter et al. 2007; Heitz 2014; Eto & Tokuyoshi 2023 |
//! | its light from facet to facet, and what it leaves to the lobes beneath | [`Albedo`] | Kulla & Conty 2017; Turquin 2019 |
//! | rough transmission | [`eval_ggx_transmission`], [`sample_ggx_visible`] | Walter et al. 2007; Dupuy & Benyoub 2023 |
//! | brushed surfaces | [`Brush`] | Heitz 2014 |
//! | sheen | [`eval_sheen`], [`sample_sheen`] | Estevez & Kulla 2017 |
//! | thin films | [`reflect_film`] | Belcour & Barla 2017 |
//! | coat, sheen and base on top of each other | [`Layers`], [`Bsdf::eval`], [`Bsdf::sample`] | Khronos, KHR_materials_* |
//! | absorption | [`Material::absorption`] | Beer 1852 |
//! | point, spot, directional light | [`Light::sample`] | KHR_lights_punctual |
//! | light of the sky on a surface | [`Environment::ambient`] | Ramamoorthi & Hanrahan 2001 |
//! | is it lit? By a ray | [`Visibility`]: [`ShadowRays`], [`Unshadowed`] | Appel 1968; Whitted 1980 |
//! | is it lit? By a depth image | [`ShadowMaps::render`], [`ShadowMap::fraction`], [`ShadowMap::lookup`] | Williams 1978 |
//! | what the eye sees, by rasterisation | [`draw_triangle`](umbriel_kernels::draw_triangle); twin `eye_raster.rs` | Pineda 1988 |
//! | maps of parallel light, cascades | `fit.rs` | Zhang et al. 2006; Valient 2008 |
//! | what keeps a map from shadowing its own surfaces | [`Bias`]: `receiver` in `bias.rs` | Dou et al. 2014; Holbert 2011; Isidoro 2006 |
//! | comparisons in a square | [`ShadowFilter::Pcf`], [`ShadowFilter::Bilinear`]: `filter/pcf.rs`, `filter/bilinear.rs` | Reeves, Salesin & Cook 1987 |
//! | comparisons in a disk | [`ShadowFilter::Poisson`], [`ShadowFilter::Vogel`]: `filter/disk.rs` | Mitchell 1991; Vogel 1979 |
//! | shadows as soft as the light is large | [`ShadowFilter::Pcss`]: `filter/pcss.rs` | Fernando 2005 |
//! | prefiltered shadows | [`ShadowFilter::Vsm`], [`ShadowFilter::Evsm`], [`ShadowFilter::Msm`]: `filter/vsm.rs`, `evsm.rs`, `msm.rs` | Donnelly & Lauritzen 2006; Lauritzen & McCool 2008; Peters & Klein 2015 |
//! | places of samples | [`sample_pixel`] | Hammersley 1960; Cranley & Patterson 1976 |
//! | tone curves, sRGB | [`develop`] | Khronos 2024; Hill 2016; Sobotka 2022; IEC 61966-2-1 |
//! | the pictures of shadow mapping | [`show()`] with a [`Show`] | |
//! | how much of a light arrives, by rays; where a map is wrong, and why | [`LightTruth::trace`], [`LightErrors::find`], [`cause_of`]: `truth/` | |
//! | the shimmer of a shadow under a moving camera | [`shimmer()`] | |
//! | cameras around a camera | [`camera_around`] | Halton 1960 |
//! | places on a light with size | [`disk_point`] | Roberts 2018; Shirley & Chiu 1997 |
//! | Whitted's recursive picture, ray by ray | [`RayTree::trace`]; twin `trace.rs` | Whitted 1980 |
//! | why a pixel is as it is | [`explain()`] | |
//! | how two pictures differ | [`compare()`] | Wang et al. 2004 (SSIM) |

#![warn(clippy::print_stdout, clippy::print_stderr)]

mod adaptive;
mod angle;
mod aov;
mod bsdf;
mod camera;
mod color;
mod compare;
mod direct;
mod emitters;
mod environment;
mod environment_map;
mod exact_sum;
mod explain;
mod eye_lanes;
mod eye_raster;
mod eye_solid;
mod film;
mod fresnel;
mod hit_groups;
mod ids;
mod image;
mod light;
mod light_sampling;
mod light_tree;
mod material;
mod mesh;
mod mesh_lanes;
mod mesh_point;
mod path;
mod path_film;
mod raster_tiles;
mod ray_cast;
mod ray_queue;
mod render;
mod sample_light;
mod sampler;
mod scene;
mod scene_bvh;
mod scene_draws;
mod settings;
mod shade_block;
mod shadow_map;
mod shadow_rays;
mod show;
mod sobol;
mod srgb;
mod surface;
mod surface_lanes;
mod texture;
mod trace;
mod truth;
mod tune;
mod unshadowed;
mod validate;
mod validate_parts;
mod whitted;

pub use aov::{Aov, render_aovs};
pub use bsdf::{
    Albedo, Brush, Bsdf, BsdfSample, Layers, albedo_sheen, eval_diffuse, eval_ggx,
    eval_ggx_transmission, eval_sheen, pdf_diffuse, pdf_ggx, pdf_ggx_transmission, pdf_sheen,
    reflect_film, refracting_half, sample_diffuse, sample_ggx, sample_ggx_visible, sample_sheen,
};
pub use camera::{Camera, CameraFrame, Projection};
pub use color::{Development, LUMINANCE, Tonemap, auto_exposure, develop};
pub use compare::{Comparison, compare, difference_picture};
pub use direct::Visibility;
pub use environment::Environment;
pub use environment_map::{EnvironmentMap, Irradiance};
pub use explain::{
    Blocker, CutTexel, Dash, Explanation, LightAnswer, LightExplanation, MapAnswer, RayKind,
    RayTree, Section, Term, TermSource, TreeRay, Unasked, explain,
};
pub use film::{Film, SamplingReport, Stats, StopReason};
pub use fresnel::{fresnel_dielectric, fresnel_schlick, normal_reflectance, reflect, refract};
pub use ids::{InstanceId, MaterialId, MeshId, SurfaceId, TextureId};
pub use image::{Image, Layer};
pub use light::{DirectionalLight, Light, LightSample, PointLight, SpotLight};
pub use light_sampling::{
    DirectionSample, pdf_disk, pdf_rectangle, pdf_sphere, pdf_triangle, sample_concentric,
    sample_disk, sample_rectangle, sample_sphere, sample_triangle,
};
pub use light_tree::{LightBounds, LightTree};
pub use material::{AlphaMode, LayerTextures, Material, TextureRef};
pub use mesh::Mesh;
pub use path_film::{MOST_SAMPLES, PathFilm};
pub use render::{Control, build_needed_trees, render, render_bytes_into, render_with_maps};
pub use sampler::sample_pixel;
pub use scene::{Geometry, Instance, Scene};
pub use scene_bvh::SceneBvh;
pub use settings::{GlassShadows, Method, Sampling, Settings};
pub use shadow_map::{
    Bias, BiasParts, BiasSum, BiasUnit, DepthMap, Footprint, LightView, NormalRule,
    ShadowComparison, ShadowFilter, ShadowMap, ShadowMapSettings, ShadowMaps, ShadowTextError, Tap,
    split_distance,
};
pub use shadow_rays::ShadowRays;
pub use show::{Fact, Show, ShowContext, Shown, show};
pub use sobol::PixelSampler;
pub use srgb::{linear_to_srgb, srgb_to_linear};
pub use surface::{SurfaceInteraction, surface_interaction};
pub use texture::{Checker, Encoding, Filter, ImageTexture, Texture, Wrap};
pub use truth::{
    Cause, Evidence, LightErrors, LightTruth, Question, SeenPoint, SeenPoints, TruthSettings,
    WrongPixel, cause_of, disk_point, error_picture, gather_evidence, truth_picture,
};
pub use tune::{
    BiasOf, BiasRule, Budget, DrawnMaps, Found, Mends, Score, Search, Shimmer, Sides, TuneBench,
    TuneSpace, TuneView, camera_around, mends, shimmer,
};
pub use umbriel_kernels as kernels;
pub use unshadowed::Unshadowed;
pub use validate::{Element, SceneError};
