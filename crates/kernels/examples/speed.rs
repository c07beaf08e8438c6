//! How fast are the queries on a mesh? `cargo run --release --example speed [rows]` on a bumpy ball.

use std::f32::consts::{PI, TAU};
use std::time::Instant;
use umbriel_kernels::glam::{Vec3, Vec3Swizzles};
use umbriel_kernels::{Body, BuildQuality, Ray, TriangleMesh};

/// A ball of `2·rows²` squares, without its poles if it is to be open.
fn ball(rows: u32, open: bool) -> TriangleMesh {
    let columns = 2 * rows;
    let point = |i: u32, j: u32| {
        let (u, v) = (i as f32 / columns as f32, j as f32 / rows as f32);
        let (u, v) = ((u * TAU).sin_cos(), (v * PI).sin_cos());
        let v = if j == rows { (0.0, -1.0) } else { v };
        let p = Vec3::new(v.0 * u.1, v.1, -v.0 * u.0);
        p * (1.0 + 0.05 * (20.0 * p.x).sin() * (17.0 * p.y).sin())
    };
    let rim = u32::from(open);
    let positions = (0..=rows).flat_map(|j| (0..columns).map(move |i| point(i, j)));
    let squares = (rim..rows - rim).flat_map(|j| (0..columns).map(move |i| (i, j)));
    let indices = squares.flat_map(|(i, j)| {
        let at = |i: u32, j: u32| j * columns + i % columns;
        let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
        [[a, b, c], [a, c, d]]
    });
    TriangleMesh::new(positions.collect(), indices.collect(), BuildQuality::Fast)
}

fn timed<T>(name: &str, n: usize, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    let seconds = start.elapsed().as_secs_f64();
    println!("  {name:13} {:9.1} k/s", n as f64 / seconds / 1e3);
    result
}

fn main() {
    let rows = std::env::args().nth(1).and_then(|n| n.parse().ok());
    let step = Vec3::new(0.819_172_5, 0.671_043_6, 0.549_700_5);
    let point = |i| 2.4 * (i as f32 * step).fract() - 1.2;
    let points: Vec<Vec3> = (1..=200_000).map(point).collect();
    let ray = |p: &Vec3| Ray::new(-2.0 * *p, 3.0 * p.yzx());
    let rays: Vec<Ray> = points.iter().map(ray).collect();
    for open in [false, true] {
        let start = Instant::now();
        let mesh = ball(rows.unwrap_or(500), open);
        let body = Body::from(&mesh);
        println!(
            "{:?}, made in {:.2} s",
            body.method(),
            start.elapsed().as_secs_f64()
        );
        timed("closest_hits", rays.len(), || body.closest_hits(&rays));
        timed("any_hits", rays.len(), || body.any_hits(&rays));
        timed("all_hits", rays.len(), || body.all_hits(&rays));
        timed("count_hits", rays.len(), || body.count_hits(&rays));
        timed("contains", points.len(), || body.contains(&points));
    }
}
