//! Whitted's adaptive anti-aliasing: divide a pixel whose corners differ.

use crate::{CameraFrame, render::Tile, trace::Tracer};
use umbriel_kernels::glam::{Vec2, Vec3};

/// A square of a pixel with the radiance at its corners: top left, top right, bottom left, bottom right.
#[derive(Clone, Copy, Debug)]
struct Cell {
    pixel: u32,
    /// Top left corner in the picture, in pixels.
    at: Vec2,
    corners: [Vec3; 4],
}

/// The mean radiance of each pixel of a tile, row by row.
///
/// A square whose corners are alike is the mean of its corners; any other is divided into four, which takes
/// five new samples, up to `levels` times. Each level of the whole tile is one batch.
/// What is smaller than a pixel and touches no corner is missed.
///
/// Source: Whitted, "An Improved Illumination Model for Shaded Display", Communications of the ACM 23(6), 1980.
pub(crate) fn render_tile(
    tracer: &mut Tracer,
    frame: &CameraFrame,
    tile: Tile,
    threshold: f32,
    levels: u32,
) -> Vec<Vec3> {
    let mut means = vec![Vec3::ZERO; tile.len()];
    let mut cells = pixel_cells(tracer, frame, tile);
    let mut size = 1.0;
    for level in 0..=levels {
        let mut divided = Vec::new();
        for cell in &cells {
            if level < levels && differ(&cell.corners, threshold) {
                divided.push(*cell);
            } else {
                let mean = cell.corners.iter().sum::<Vec3>() * 0.25;
                means[cell.pixel as usize] += mean * (size * size);
            }
        }
        size *= 0.5;
        cells = divide(tracer, frame, &divided, size);
    }
    means
}

/// Tells whether the contrast of the corners exceeds `threshold` in any channel.
///
/// ```text
/// contrast = (max − min) / (max + min)
/// ```
/// It does not depend on the exposure, so that dim and bright scenes are divided alike.
///
/// Source: Mitchell, "Generating Antialiased Images at Low Sampling Densities", SIGGRAPH 1987.
fn differ(corners: &[Vec3; 4], threshold: f32) -> bool {
    let [a, b, c, d] = *corners;
    let (least, most) = (a.min(b).min(c.min(d)), a.max(b).max(c.max(d)));
    (most - least).cmpgt((most + least) * threshold).any()
}

/// One cell a pixel; neighbours share their corner samples.
fn pixel_cells(tracer: &mut Tracer, frame: &CameraFrame, tile: Tile) -> Vec<Cell> {
    let corners = Tile {
        x1: tile.x1 + 1,
        y1: tile.y1 + 1,
        ..tile
    };
    let places: Vec<Vec2> = corners
        .pixels()
        .map(|(x, y)| Vec2::new(x as f32, y as f32))
        .collect();
    let radiance = trace(tracer, frame, &places);
    let width = tile.x1 - tile.x0;
    tile.pixels()
        .enumerate()
        .map(|(i, (x, y))| {
            let corner =
                |dx, dy| radiance[((y - tile.y0 + dy) * (width + 1) + x - tile.x0 + dx) as usize];
            Cell {
                pixel: i as u32,
                at: Vec2::new(x as f32, y as f32),
                corners: [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)],
            }
        })
        .collect()
}

/// Four cells of edge length `half` in the place of each.
fn divide(tracer: &mut Tracer, frame: &CameraFrame, cells: &[Cell], half: f32) -> Vec<Cell> {
    // Middle of the top, left, whole, right, bottom.
    let middles = [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [2.0, 1.0], [1.0, 2.0]].map(Vec2::from);
    let places: Vec<Vec2> = cells
        .iter()
        .flat_map(|cell| middles.map(|m| cell.at + m * half))
        .collect();
    let radiance = trace(tracer, frame, &places);
    let quarters = |(cell, new): (&Cell, &[Vec3])| {
        let [a, b, c, d] = cell.corners;
        let [top, left, middle, right, bottom] = [new[0], new[1], new[2], new[3], new[4]];
        [
            (Vec2::ZERO, [a, top, left, middle]),
            (Vec2::X, [top, b, middle, right]),
            (Vec2::Y, [left, middle, c, bottom]),
            (Vec2::ONE, [middle, right, bottom, d]),
        ]
        .map(|(step, corners)| Cell {
            pixel: cell.pixel,
            at: cell.at + step * half,
            corners,
        })
    };
    cells
        .iter()
        .zip(radiance.chunks_exact(5))
        .flat_map(quarters)
        .collect()
}

fn trace(tracer: &mut Tracer, frame: &CameraFrame, places: &[Vec2]) -> Vec<Vec3> {
    let mut radiance = vec![Vec3::ZERO; places.len()];
    tracer.trace(frame, places, &mut radiance);
    radiance
}
