//! Files to scenes and pictures, and back.
//!
//! | from | to | with |
//! |---|---|---|
//! | scene TOML, or any model | [`Scene`](render::Scene), settings, [`Report`] | [`load_scene`] |
//! | glTF, GLB, OBJ, PLY, STL | [`Scene`](render::Scene) as it is in the file | [`import_model`] |
//! | a scene without camera or light | one with both | [`complete_scene`] |
//! | PNG, JPEG | texture | [`load_texture`] |
//! | Radiance HDR, EXR | surroundings | [`load_environment`] |
//! | picture | PNG, EXR | [`encode_png`], [`encode_exr`], then [`write_file`] |
//! | PNG, EXR | picture | [`read_image`] |
//!
//! Nothing here panics on any input, reads outside of the folder of the file it was given, or takes memory that a file
//! only claims to need. Every [`FileError`] names the file, the place and what was expected.

#![warn(clippy::print_stdout, clippy::print_stderr)]

mod complete;
mod environment_file;
mod error;
mod exr;
mod folder;
mod gltf;
mod import;
mod mtl;
mod obj;
mod ply;
mod ply_header;
mod png;
mod polygon;
mod read_image;
mod report;
mod scene_file;
mod sniff;
mod stl;
mod texture_file;
mod words;
mod write;

pub use self::exr::{ExrInfo, encode_exr};
pub use complete::complete_scene;
pub use environment_file::load_environment;
pub use error::{ErrorKind, FileError, Place};
pub use import::import_model;
pub use png::encode_png;
pub use read_image::{PictureKind, read_image};
pub use report::{Report, one_line};
pub use scene_file::{
    LoadOptions, Loaded, MAX_PIXELS, MAX_SIDE, SceneSettings, ShadowMapOverrides,
    check_shadow_map_side, load_scene, scene_schema,
};
pub use texture_file::load_texture;
pub use umbriel_render as render;
pub use write::{check_inputs, check_output, write_file};

/// The README's program must compile.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
