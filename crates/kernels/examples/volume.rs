//! How much space does a mesh take up? The part of random points that is inside, times their box.

use umbriel_kernels::glam::Vec3;
use umbriel_kernels::{Body, BuildQuality, TriangleMesh};

/// An octahedron with corners at distance 1: its volume is 4/3.
fn octahedron() -> TriangleMesh {
    let positions = vec![
        Vec3::X,
        Vec3::Y,
        Vec3::Z,
        Vec3::NEG_X,
        Vec3::NEG_Y,
        Vec3::NEG_Z,
    ];
    let indices = vec![
        [0, 1, 2],
        [1, 3, 2],
        [3, 4, 2],
        [4, 0, 2],
        [1, 0, 5],
        [3, 1, 5],
        [4, 3, 5],
        [0, 4, 5],
    ];
    TriangleMesh::new(positions, indices, BuildQuality::Fast)
}

fn main() {
    let mesh = octahedron();
    // The additive sequence of the plastic number's cousin in three dimensions fills the cube evenly.
    let step = Vec3::new(0.819_172_5, 0.671_043_6, 0.549_700_5);
    let points: Vec<Vec3> = (1..=100_000)
        .map(|i| 2.0 * (i as f32 * step).fract() - 1.0)
        .collect();

    let found = Body::from(&mesh).contains(&points);
    let inside = found.inside.iter().filter(|&&inside| inside).count();
    let volume = 8.0 * inside as f64 / points.len() as f64;
    println!(
        "volume {volume:.3} (exactly 1.333), decided by {:?}",
        found.method
    );
}
