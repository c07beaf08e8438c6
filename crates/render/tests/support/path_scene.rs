//! Small scenes for path tracing: a room with a lamp, and a lamp above a plane.

use super::{add_surface, matte, sky};
use umbriel_render::{
    Camera, Material, Method, Sampling, Scene, Settings,
    kernels::{Disk, Rectangle, Sphere, Surface, glam::Vec3},
};

fn wall(center: Vec3, u: Vec3, v: Vec3) -> Surface {
    Surface::Rectangle(Rectangle { center, u, v })
}

fn ball(center: Vec3, radius: f32) -> Surface {
    Surface::Sphere(Sphere { center, radius })
}

/// A room of two metres, open to the eye and the sky, with a lamp, a glass ball, a rough metal ball and a matte one.
pub(crate) fn room() -> Scene {
    let mut scene = Scene {
        environment: sky(Vec3::new(0.05, 0.07, 0.1)),
        ..Scene::default()
    };
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    let white = || matte(Vec3::splat(0.7));
    add_surface(&mut scene, wall(-y, z, x), white());
    add_surface(&mut scene, wall(y, x, z), white());
    add_surface(&mut scene, wall(-z, x, y), white());
    add_surface(&mut scene, wall(-x, y, z), matte(Vec3::new(0.6, 0.1, 0.1)));
    add_surface(&mut scene, wall(x, z, y), matte(Vec3::new(0.1, 0.5, 0.1)));
    let lamp = Material {
        emission: Vec3::new(9.0, 8.0, 7.0),
        ..matte(Vec3::ZERO)
    };
    add_surface(&mut scene, wall(y * 0.98, x * 0.3, z * 0.3), lamp);
    let glass = Material {
        transmission: 1.0,
        roughness: 0.0,
        ..Material::default()
    };
    add_surface(&mut scene, ball(Vec3::new(-0.45, -0.65, 0.3), 0.35), glass);
    let metal = Material {
        metallic: 1.0,
        roughness: 0.6,
        base_color: Vec3::new(0.9, 0.7, 0.4),
        ..Material::default()
    };
    add_surface(&mut scene, ball(Vec3::new(0.45, -0.6, -0.2), 0.4), metal);
    add_surface(&mut scene, ball(Vec3::new(0.3, -0.85, 0.6), 0.15), white());
    scene
}

/// Where [`room`] is seen from.
pub(crate) fn room_eye() -> Camera {
    Camera::look_at("eye", Vec3::new(0.0, 0.0, 3.6), Vec3::ZERO, Vec3::Y, 0.75)
}

/// A plane that a lamp outside of the picture lights, half of it in the soft shadow of a disk; the rest is a quiet sky.
pub(crate) fn half_noisy() -> (Scene, Camera) {
    let mut scene = Scene {
        environment: sky(Vec3::splat(0.3)),
        ..Scene::default()
    };
    let floor = wall(Vec3::ZERO, Vec3::Z * 1.5, Vec3::X * 1.5);
    add_surface(&mut scene, floor, matte(Vec3::splat(0.6)));
    let shade = Surface::Disk(Disk {
        center: Vec3::new(-0.4, 1.0, 0.0),
        normal: Vec3::Y,
        radius: 0.5,
    });
    add_surface(&mut scene, shade, matte(Vec3::splat(0.4)));
    let lamp = Material {
        emission: Vec3::splat(30.0),
        ..matte(Vec3::ZERO)
    };
    add_surface(&mut scene, ball(Vec3::new(0.0, 3.0, 0.0), 0.4), lamp);
    let (from, to) = (Vec3::new(0.0, 3.0, 5.0), Vec3::new(0.0, 0.2, 0.0));
    (scene, Camera::look_at("eye", from, to, Vec3::Y, 0.7))
}

/// Paths of `spp` samples in a small picture.
pub(crate) fn paths(resolution: [u32; 2], spp: u32, seed: u64) -> Settings {
    Settings {
        method: Method::Path,
        resolution,
        sampling: Sampling::Fixed { spp },
        seed,
        ..Settings::default()
    }
}
