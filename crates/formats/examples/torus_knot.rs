//! How are the scenes' meshes made? Writes a (2, 3) torus knot as a binary PLY file.
//!
//! `cargo run -p umbriel-formats --example torus_knot -- PATH SEGMENTS SIDES`: a tube of SEGMENTS rings of
//! SIDES vertices, which is 2 · SEGMENTS · SIDES triangles.

use std::{env, f32::consts::TAU, fs};
use umbriel_render::kernels::glam::Vec3;

/// The middle line: twice around the axis y, three times through the hole; within about ±1.
fn knot(t: f32) -> Vec3 {
    let (long, short) = ((2.0 * t).sin_cos(), (3.0 * t).sin_cos());
    let radius = 0.62 + 0.24 * short.1;
    Vec3::new(radius * long.1, 0.3 * short.0, radius * long.0)
}

fn main() {
    let args: Vec<String> = env::args().collect();
    let [_, path, segments, sides] = &args[..] else {
        eprintln!("usage: torus_knot PATH SEGMENTS SIDES");
        std::process::exit(2);
    };
    let (segments, sides): (u32, u32) = (
        segments.parse().expect("a number"),
        sides.parse().expect("a number"),
    );

    let mut file = format!(
        "ply\nformat binary_little_endian 1.0\ncomment torus knot, {segments} x {sides}\n\
         element vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         property float nx\nproperty float ny\nproperty float nz\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        segments * sides,
        2 * segments * sides
    )
    .into_bytes();
    for i in 0..segments {
        let t = TAU * i as f32 / segments as f32;
        let along = (knot(t + 1e-3) - knot(t - 1e-3)).normalize();
        // A frame that closes after a turn, because it depends on the place alone: y is never along the tube.
        let side = along.cross(Vec3::Y).normalize();
        let up = side.cross(along);
        for j in 0..sides {
            let (sin, cos) = (TAU * j as f32 / sides as f32).sin_cos();
            let normal = side * cos + up * sin;
            let position = knot(t) + 0.13 * normal;
            let numbers = position.to_array().into_iter().chain(normal.to_array());
            file.extend(numbers.flat_map(f32::to_le_bytes));
        }
    }
    for i in 0..segments {
        for j in 0..sides {
            let vertex = |i: u32, j: u32| (i % segments) * sides + j % sides;
            let [a, b, c, d] = [
                vertex(i, j),
                vertex(i + 1, j),
                vertex(i + 1, j + 1),
                vertex(i, j + 1),
            ];
            for triangle in [[a, b, c], [a, c, d]] {
                file.push(3);
                file.extend(triangle.iter().flat_map(|k| k.to_le_bytes()));
            }
        }
    }
    fs::write(path, file).expect("the file can be written");
}
