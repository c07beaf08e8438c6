//! Writes `evening.hdr`, the sky of `scenes/evening.toml`: a low sun in a clear evening above dark ground, 128x64 texels.
//!
//! `cargo run --release -p umbriel-formats --example evening -- scenes`

use image::{Rgb, codecs::hdr::HdrEncoder};
use std::{f32::consts::PI, fs, path::PathBuf};
use umbriel_formats::render::kernels::glam::Vec3;

const WIDTH: usize = 128;
const HEIGHT: usize = 64;
/// Right of what is ahead, 14 degrees above the horizon.
const SUN: Vec3 = Vec3::new(0.55, 0.25, -0.8);

/// The radiance from a unit direction.
fn sky(dir: Vec3) -> Vec3 {
    let sun = SUN.normalize();
    let towards = dir.dot(sun).max(0.0);
    if dir.y < 0.0 {
        return Vec3::new(0.05, 0.045, 0.04);
    }
    let horizon = (1.0 - dir.y).powi(6);
    let clear = Vec3::new(0.09, 0.16, 0.34).lerp(Vec3::new(0.75, 0.5, 0.38), horizon);
    let glow = Vec3::new(1.5, 0.75, 0.3) * (0.6 * towards.powi(24) + horizon * towards.powi(4));
    // Wider than the true sun, so that it fills a few texels, and so much darker.
    let disk = if towards > 0.9985 { 900.0 } else { 0.0 };
    clear + glow + Vec3::new(1.0, 0.72, 0.42) * disk
}

fn main() {
    let folder = PathBuf::from(std::env::args().nth(1).expect("a folder to write into"));
    let texels: Vec<Rgb<f32>> = (0..WIDTH * HEIGHT)
        .map(|i| {
            let phi = 2.0 * PI * ((i % WIDTH) as f32 + 0.5) / WIDTH as f32 - PI;
            let theta = PI * ((i / WIDTH) as f32 + 0.5) / HEIGHT as f32;
            let dir = Vec3::new(
                theta.sin() * phi.sin(),
                theta.cos(),
                -theta.sin() * phi.cos(),
            );
            Rgb(sky(dir).to_array())
        })
        .collect();
    let mut bytes = Vec::new();
    HdrEncoder::new(&mut bytes)
        .encode(&texels, WIDTH, HEIGHT)
        .expect("memory takes any picture");
    fs::write(folder.join("evening.hdr"), bytes).expect("the file can be written");
}
