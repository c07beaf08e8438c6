//! What is inside a bowl? A mesh with a hole has a winding number that falls from 1 to 0 across it.

use umbriel_kernels::glam::Vec3;
use umbriel_kernels::{Body, BuildQuality, TriangleMesh};

/// A cube's five faces, without the one at y = 1.
fn tray() -> TriangleMesh {
    let positions = (0..8)
        .map(|i| 2.0 * Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) - 1.0)
        .collect();
    let faces = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let indices = faces
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    TriangleMesh::new(positions, indices, BuildQuality::Fast)
}

fn main() {
    let tray = tray();
    let points: Vec<Vec3> = (-5..=5).map(|y| Vec3::Y * (0.25 * y as f32)).collect();
    let found = Body::from(&tray).contains(&points);
    println!(
        "closed: {}, decided by {:?}",
        tray.is_closed(),
        found.method
    );
    for (p, inside) in points.iter().zip(found.inside) {
        println!(
            "y = {:5.2} {}",
            p.y,
            if inside { "inside" } else { "outside" }
        );
    }
}
