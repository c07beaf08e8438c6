//! The view of the light that all renderers share, from the JSON file beside the scene; `scene.py` states its rule.

use serde::Deserialize;
use std::{collections::HashMap, fs, path::Path};

/// What of the JSON file concerns a renderer that reads the scene file.
#[derive(Debug, Deserialize)]
struct Words {
    map: LightView,
}

/// An orthographic shadow map.
#[derive(Debug, Deserialize)]
#[expect(dead_code, reason = "for the passes to come")]
pub struct LightView {
    /// Texels along each side.
    pub size: u32,
    /// World to map, row by row: x and y in [-1, 1], y up, z from 0 at the light's side to 1.
    pub matrix: [[f64; 4]; 4],
    /// Width of a texel in metres.
    pub texel: f64,
    /// Metres from z = 0 to z = 1.
    pub depth: f64,
    /// How far compared depths are moved towards the light.
    pub bias: Bias,
}

/// In texels: `slope · min(tan θ, greatest_tan) + constant`, θ between the triangle's own normal and the light.
#[derive(Debug, Deserialize)]
#[expect(dead_code, reason = "for the passes to come")]
pub struct Bias {
    /// By the number of taps.
    pub slope: HashMap<u32, f32>,
    /// On every surface.
    pub constant: f32,
    /// Greatest tangent that counts.
    pub greatest_tan: f32,
}

impl LightView {
    /// Reads the file beside the scene file.
    pub fn read(scene: &Path) -> Result<Self, String> {
        let path = scene.with_extension("json");
        let text = fs::read(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        let words: Words = serde_json::from_slice(&text).map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(words.map)
    }
}
