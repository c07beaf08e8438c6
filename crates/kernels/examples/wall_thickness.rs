//! How thick is a body where a ray passes through it? The distances from each way in to the next way out.

use umbriel_kernels::glam::Vec3;
use umbriel_kernels::{Body, Crossing, Ray, Surface, Torus};

fn main() {
    let ring = Surface::Torus(Torus {
        center: Vec3::ZERO,
        axis: Vec3::Y,
        major_radius: 2.0,
        minor_radius: 0.5,
    });
    let rays: Vec<Ray> = (0..=10)
        .map(|i| Ray::new(Vec3::new(-5.0, 0.0, 0.25 * i as f32), Vec3::X))
        .collect();

    let crossings = Body::from(&ring).all_hits(&rays);
    for (ray, crossings) in rays.iter().zip(crossings.iter()) {
        // From outside, enter and leave take turns.
        let walls: Vec<String> = crossings
            .chunks_exact(2)
            .map(|wall: &[Crossing]| format!("{:.3}", wall[1].t - wall[0].t))
            .collect();
        println!("z = {:.2}: {}", ray.origin.z, walls.join(" + "));
    }
}
