//! What `bench/shadow.py` asks for and is answered, one JSON object a line; see `peer.py`.

use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// One picture to draw, several times.
#[derive(Debug, Deserialize)]
pub struct Request {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Shadow map comparisons a pixel: 1, or 9 for 3x3.
    pub taps: u32,
    /// Whether triangles seen from behind are left out, in both passes.
    pub cull: bool,
    /// Frames to time, after one that is not.
    pub frames: usize,
    /// PNG file to write.
    pub picture: Option<PathBuf>,
}

/// Milliseconds of each frame.
#[derive(Debug, Default, Serialize)]
pub struct Times {
    /// The pass from the light.
    pub map: Vec<f64>,
    /// The pass from the eye, to sRGB bytes.
    pub eye: Vec<f64>,
    /// Both.
    pub frame: Vec<f64>,
    /// CPU time of both, all threads together.
    pub cpu: Vec<f64>,
}

/// The answer to a request.
#[derive(Debug, Serialize)]
#[serde(untagged)]
pub enum Answer {
    /// The frames were drawn.
    Drawn(Times),
    /// They were not.
    Refused {
        /// Why.
        error: String,
    },
}
