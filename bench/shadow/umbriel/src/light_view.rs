//! The views of the light that all renderers share: Umbriel's own, told to the peers through the JSON file beside the scene.

use serde_json::{Value, json};
use umbriel_render::{DepthMap, LightView, kernels::glam::{DMat4, DVec3}};

/// What the JSON file says of a map of parallel light; `scene.py` states the meaning.
pub fn words(map: &DepthMap) -> Value {
    let view = &map.view;
    json!({
        "size": view.side,
        "matrix": matrix(view),
        "texel": view.texel_width(1.0),
        "depth": view.far,
    })
}

/// World to map, row by row: x and y in [-1, 1], y up, z from 0 at the light's side to 1.
fn matrix(view: &LightView) -> [[f64; 4]; 4] {
    let from_origin = DMat4::from_translation(-view.origin.as_dvec3());
    // Umbriel stores 1 - z.
    let turned = DMat4::from_translation(DVec3::Z) * DMat4::from_scale(DVec3::new(1.0, 1.0, -1.0));
    let matrix = turned * view.matrix().as_dmat4() * from_origin;
    matrix.transpose().to_cols_array_2d()
}
