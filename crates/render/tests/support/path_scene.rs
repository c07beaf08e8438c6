//! Small scenes for path tracing: a room with a lamp, and a lamp above a plane.

use super::{Random, add_mesh, add_surface, matte, point_light, sky};
use umbriel_render::{
    Camera, DirectionalLight, EnvironmentMap, Layers, Light, Material, Mesh, Method, Sampling,
    Scene, Settings,
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

/// The room's things beside rough glass, brushed metal and a coated ball, lit by a map, a sun with an angle, points and four hundred triangles, and
/// seen through a lens.
pub(crate) fn everything() -> (Scene, Camera) {
    let mut scene = room();
    let (width, height) = (64, 32);
    let texels = (0..width * height).map(|i| match (i % width, i / width) {
        (40, 9) => Vec3::new(900.0, 800.0, 500.0),
        (x, y) => Vec3::new(0.2, 0.01 * y as f32, 0.01 * x as f32),
    });
    scene.surround(EnvironmentMap::new(width, height, texels.collect(), 0.4).expect("texels"));
    let rough_glass = Material {
        transmission: 0.9,
        roughness: 0.4,
        attenuation_color: Vec3::new(0.4, 0.9, 0.6),
        attenuation_distance: 0.5,
        ..Material::default()
    };
    let layers = |anisotropy, clearcoat| Layers {
        anisotropy,
        clearcoat,
        clearcoat_roughness: 0.1,
        ..Layers::NONE
    };
    let brushed = Material {
        metallic: 1.0,
        roughness: 0.3,
        layers: layers(0.8, 0.0),
        ..Material::default()
    };
    let coated = Material {
        roughness: 0.7,
        layers: layers(0.0, 1.0),
        ..matte(Vec3::new(0.7, 0.1, 0.2))
    };
    for (x, material) in [(-0.3, rough_glass), (0.15, brushed), (0.65, coated)] {
        add_surface(&mut scene, ball(Vec3::new(x, -0.2, 0.4), 0.2), material);
    }
    let mut random = Random(5);
    let mut mesh = Mesh::default();
    for i in 0..400 {
        let corner = random.vec3(-0.95, 0.95);
        let edges = [Vec3::ZERO, random.vec3(0.0, 0.03), random.vec3(-0.03, 0.0)];
        mesh.positions.extend(edges.map(|edge| corner + edge));
        mesh.indices.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    let glow = Material {
        emission: Vec3::new(20.0, 15.0, 30.0),
        ..matte(Vec3::ZERO)
    };
    add_mesh(&mut scene, mesh, glow);
    scene
        .lights
        .push(point_light(Vec3::new(0.2, 0.5, 0.9), 1.0));
    scene.lights.push(Light::Directional(DirectionalLight {
        name: String::new(),
        direction: Vec3::new(-0.36, -0.48, -0.8),
        illuminance: Vec3::splat(2.0),
        angle: 0.1,
    }));
    let camera = Camera {
        lens_radius: 0.1,
        ..room_eye()
    };
    (scene, camera)
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
