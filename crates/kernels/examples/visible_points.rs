//! Which points can one point see? One any-hit ray for each, up to just before it.

use umbriel_kernels::glam::Vec3;
use umbriel_kernels::{Body, Interval, Ray, Sphere, Surface};

fn main() {
    let ball = Surface::Sphere(Sphere {
        center: Vec3::ZERO,
        radius: 1.0,
    });
    let eye = Vec3::new(0.0, 0.0, 5.0);
    let points: Vec<Vec3> = (-8..=8)
        .map(|x| Vec3::new(0.25 * x as f32, 0.0, -3.0))
        .collect();

    let between = Interval { min: 0.0, max: 1.0 };
    let rays: Vec<Ray> = points
        .iter()
        .map(|&p| Ray {
            origin: eye,
            dir: p - eye,
            t: between,
        })
        .collect();
    let hidden = Body::from(&ball).any_hits(&rays);

    for (p, hidden) in points.iter().zip(hidden) {
        println!(
            "{:6.2} {}",
            p.x,
            if hidden {
                "behind the ball"
            } else {
                "in sight"
            }
        );
    }
}
