//! How are the files of `scenes/courtyard.toml` made? Writes an arcade and a fence as PLY files, and leaves as a PNG file
//! with holes.
//!
//! `cargo run -p umbriel-formats --example courtyard -- FOLDER`

use std::{env, f32::consts::PI, fs, path::Path};
use umbriel_formats::encode_png;
use umbriel_render::kernels::glam::{BVec3, Vec3};

/// A mesh without normals: its faces are flat.
#[derive(Default)]
struct Faces {
    points: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl Faces {
    /// A triangle, counter-clockwise as seen from its front.
    fn triangle(&mut self, corners: [Vec3; 3]) {
        let first = self.points.len() as u32;
        self.points.extend(corners);
        self.triangles.push([first, first + 1, first + 2]);
    }

    /// A flat quadrilateral, counter-clockwise as seen from its front.
    fn quad(&mut self, [a, b, c, d]: [Vec3; 4]) {
        self.triangle([a, b, c]);
        self.triangle([a, c, d]);
    }

    /// A box between two corners.
    fn cuboid(&mut self, min: Vec3, max: Vec3) {
        let p = |i: usize| {
            let is_max = |bit: usize| i >> bit & 1 == 1;
            Vec3::select(BVec3::new(is_max(0), is_max(1), is_max(2)), max, min)
        };
        for face in [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ] {
            self.quad(face.map(p));
        }
    }

    fn write(&self, path: &Path) {
        let mut file = format!(
            "ply\nformat binary_little_endian 1.0\ncomment made by the example courtyard\n\
             element vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
             element face {}\nproperty list uchar int vertex_indices\nend_header\n",
            self.points.len(),
            self.triangles.len()
        )
        .into_bytes();
        let numbers = self.points.iter().flat_map(|p| p.to_array());
        file.extend(numbers.flat_map(f32::to_le_bytes));
        for triangle in &self.triangles {
            file.push(3);
            file.extend(triangle.iter().flat_map(|k| k.to_le_bytes()));
        }
        fs::write(path, file).expect("the file can be written");
    }
}

/// Arches side by side along x, from 0 on, one `BAY` each; they stand on what bears them at the height `SPRING`.
const ARCHES: u32 = 11;
const BAY: f32 = 3.0;
const RADIUS: f32 = 1.25;
const SPRING: f32 = 2.6;
const TOP: f32 = 4.5;
/// Half of the wall's thickness, along z.
const HALF: f32 = 0.35;
/// Straight pieces of an arch.
const PIECES: u32 = 32;

/// Walls over round arches, with a cornice.
fn arcade() -> Faces {
    let mut faces = Faces::default();
    let width = BAY * ARCHES as f32;
    for arch in 0..ARCHES {
        let middle = BAY * (arch as f32 + 0.5);
        let on_arch = |i: u32| {
            let (sin, cos) = (PI * i as f32 / PIECES as f32).sin_cos();
            [middle - RADIUS * cos, SPRING + RADIUS * sin]
        };
        for i in 0..PIECES {
            let ([x0, y0], [x1, y1]) = (on_arch(i), on_arch(i + 1));
            wall(&mut faces, [x0, y0], [x1, y1]);
        }
        let (left, right) = (middle - 0.5 * BAY, middle + 0.5 * BAY);
        wall(&mut faces, [left, SPRING], [middle - RADIUS, SPRING]);
        wall(&mut faces, [middle + RADIUS, SPRING], [right, SPRING]);
    }
    for (x, z) in [(0.0, HALF), (width, -HALF)] {
        faces.quad([
            Vec3::new(x, SPRING, -z),
            Vec3::new(x, SPRING, z),
            Vec3::new(x, TOP, z),
            Vec3::new(x, TOP, -z),
        ]);
    }
    let cornice = Vec3::new(0.12, 0.0, HALF + 0.12);
    faces.cuboid(
        Vec3::Y * TOP - cornice,
        Vec3::new(width, TOP + 0.22, 0.0) + cornice,
    );
    faces
}

/// The wall over a straight piece of its lower edge: front, back and underside.
fn wall(faces: &mut Faces, [x0, y0]: [f32; 2], [x1, y1]: [f32; 2]) {
    let p = Vec3::new;
    faces.quad([
        p(x0, y0, HALF),
        p(x1, y1, HALF),
        p(x1, TOP, HALF),
        p(x0, TOP, HALF),
    ]);
    faces.quad([
        p(x1, y1, -HALF),
        p(x0, y0, -HALF),
        p(x0, TOP, -HALF),
        p(x1, TOP, -HALF),
    ]);
    faces.quad([
        p(x0, y0, -HALF),
        p(x1, y1, -HALF),
        p(x1, y1, HALF),
        p(x0, y0, HALF),
    ]);
}

/// Thin bars with tips along x, from 0 to 4 m, on two rails.
fn fence() -> Faces {
    let mut faces = Faces::default();
    for i in 0..=32 {
        let post = i % 8 == 0;
        let (half, height) = if post { (0.035, 1.5) } else { (0.011, 1.3) };
        let x = 0.125 * i as f32;
        let (min, max) = (
            Vec3::new(x - half, 0.0, -half),
            Vec3::new(x + half, height, half),
        );
        faces.cuboid(min, max);
        let (tip, wide) = (Vec3::new(x, height + 7.0 * half + 0.06, 0.0), 1.9 * half);
        let ring = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
            .map(|[u, v]| Vec3::new(x + u * wide, height, v * wide));
        for k in 0..4 {
            faces.triangle([ring[(k + 1) % 4], ring[k], tip]);
        }
    }
    for y in [0.18, 1.15] {
        faces.cuboid(Vec3::new(0.0, y, -0.018), Vec3::new(4.0, y + 0.035, 0.018));
    }
    faces
}

/// Leaves around their stalks, no two alike; between them are holes. The picture joins with itself on all sides.
fn leaves(side: usize) -> Vec<[u8; 4]> {
    let mut pixels = vec![[52, 82, 30, 0]; side * side];
    let mut state = 1_u32;
    let mut random = move || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 8) as f32 / (1 << 24) as f32
    };
    for _ in 0..170 {
        let (x, y, turn) = (random(), random(), 2.0 * PI * random());
        let (length, shade) = (0.05 + 0.035 * random(), 0.55 + 0.45 * random());
        let color = [96.0, 128.0, 44.0].map(|c: f32| (c * shade) as u8);
        for (i, pixel) in pixels.iter_mut().enumerate() {
            let at = |k: usize, middle: f32| {
                let d = (k as f32 + 0.5) / side as f32 - middle;
                d - d.round()
            };
            let (dx, dy) = (at(i % side, x), at(i / side, y));
            let along = (dx * turn.cos() + dy * turn.sin()) / length;
            let across = (dy * turn.cos() - dx * turn.sin()) / length;
            // Two arcs that meet in points.
            if along.abs() < 1.0 && across.abs() < 0.42 * (1.0 - along * along) {
                *pixel = [color[0], color[1], color[2], 255];
            }
        }
    }
    pixels
}

fn main() {
    let args: Vec<String> = env::args().collect();
    let [_, folder] = &args[..] else {
        eprintln!("usage: courtyard FOLDER");
        std::process::exit(2);
    };
    let folder = Path::new(folder);
    arcade().write(&folder.join("arcade.ply"));
    fence().write(&folder.join("fence.ply"));
    let side = 256;
    let png = encode_png(side, side, &leaves(side));
    fs::write(folder.join("leaves.png"), png).expect("the file can be written");
}
