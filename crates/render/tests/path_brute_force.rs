//! Path-traced pixels against the rendering equation by its definition, for each kind of material and of light.

mod support;

use support::{
    Random, add_mesh, add_surface, brute_force::brute_force, draw, matte, path_scene::paths, sky,
    z_test::Estimate,
};
use umbriel_render::{
    Camera, DirectionalLight, Environment, EnvironmentMap, Layers, Light, Material, Mesh, Scene,
    SceneBvh, Settings,
    kernels::{
        Disk, Rectangle, Sphere, Surface,
        glam::{Vec2, Vec3},
    },
};

const SIZE: [u32; 2] = [20, 14];
const DEPTH: u32 = 4;
/// Pictures on each side, and samples of one of brute force and one of paths.
const PICTURES: u64 = 64;
const SAMPLES: [u32; 2] = [256, 16];

fn camera() -> Camera {
    let (from, to) = (Vec3::new(0.0, 1.7, 5.0), Vec3::new(0.0, 0.4, 0.0));
    Camera::look_at("eye", from, to, Vec3::Y, 0.62)
}

/// The mean of many pictures of 16 samples is that of the brute force.
fn assert_true(scene: &Scene, camera: &Camera, name: &str) {
    let bvh = SceneBvh::build(scene);
    let reference = Estimate::new(PICTURES, SAMPLES[0], |part| {
        brute_force(&bvh, camera, SIZE, SAMPLES[0], DEPTH, part)
    });
    let found = Estimate::new(PICTURES, SAMPLES[1], |seed| {
        let settings = Settings {
            depth: DEPTH,
            ..paths(SIZE, SAMPLES[1], seed)
        };
        let film = draw(scene, camera, &settings);
        assert_eq!(film.stats.bad_samples, 0, "{name}");
        let pixels = film.image.pixels.iter();
        pixels.map(|&[r, g, b, _]| [r, g, b]).collect()
    });
    found.assert_is(&reference, name);
}

fn ball(x: f32, z: f32, radius: f32) -> Surface {
    let center = Vec3::new(x, radius, z);
    Surface::Sphere(Sphere { center, radius })
}

/// A floor, a matte ball, and two more of the materials under test.
fn things(first: Material, second: Material) -> Scene {
    let mut scene = Scene::default();
    let floor = Rectangle {
        center: Vec3::ZERO,
        u: 4.0 * Vec3::Z,
        v: 4.0 * Vec3::X,
    };
    add_surface(
        &mut scene,
        Surface::Rectangle(floor),
        matte(Vec3::new(0.6, 0.5, 0.4)),
    );
    add_surface(&mut scene, ball(-0.9, 0.2, 0.6), first);
    add_surface(&mut scene, ball(0.6, 0.1, 0.7), second);
    add_surface(
        &mut scene,
        ball(-0.1, 1.3, 0.25),
        matte(Vec3::new(0.2, 0.5, 0.7)),
    );
    scene
}

fn lamp(radiance: Vec3) -> Material {
    Material {
        emission: radiance,
        ..matte(Vec3::ZERO)
    }
}

/// A large lamp above and beside, in a dim sky: brute force finds it often enough.
fn add_lamp(scene: &mut Scene) {
    let panel = Rectangle {
        center: Vec3::new(1.0, 3.0, 1.0),
        u: 1.6 * Vec3::X,
        v: Vec3::new(0.0, -0.7, 1.2),
    };
    add_surface(
        scene,
        Surface::Rectangle(panel),
        lamp(Vec3::new(4.0, 3.5, 3.0)),
    );
    scene.environment = sky(Vec3::new(0.1, 0.15, 0.2));
}

fn metal(roughness: f32) -> Material {
    Material {
        metallic: 1.0,
        roughness,
        base_color: Vec3::new(0.9, 0.7, 0.4),
        ..Material::default()
    }
}

fn glass(roughness: f32) -> Material {
    Material {
        transmission: 1.0,
        roughness,
        base_color: Vec3::new(0.9, 1.0, 0.95),
        ..Material::default()
    }
}

fn coated() -> Material {
    Material {
        base_color: Vec3::new(0.7, 0.1, 0.1),
        roughness: 0.7,
        layers: Layers {
            clearcoat: 1.0,
            clearcoat_roughness: 0.25,
            ..Layers::NONE
        },
        ..Material::default()
    }
}

#[test]
fn rough_metals() {
    let mut brushed = metal(0.3);
    brushed.layers.anisotropy = 0.7;
    let mut scene = things(metal(0.45), brushed);
    add_lamp(&mut scene);
    assert_true(&scene, &camera(), "rough metals");
}

#[test]
fn rough_glass() {
    let sheet = Material {
        thin_walled: true,
        ..glass(0.4)
    };
    let mut scene = things(glass(0.5), sheet);
    add_lamp(&mut scene);
    assert_true(&scene, &camera(), "rough glass");
}

/// A smooth coat, which shows the lamp to rays that go on alone, and cloth.
#[test]
fn coats_and_cloth() {
    let mut smooth = coated();
    smooth.layers.clearcoat_roughness = 0.0;
    let mut cloth = matte(Vec3::new(0.2, 0.1, 0.3));
    cloth.layers.sheen_color = Vec3::new(0.8, 0.8, 1.0);
    cloth.layers.sheen_roughness = 0.4;
    let mut scene = things(coated(), smooth);
    add_surface(&mut scene, ball(0.1, -0.9, 0.5), cloth);
    add_lamp(&mut scene);
    assert_true(&scene, &camera(), "coats and cloth");
}

/// Through a lens, too.
#[test]
fn environment_maps() {
    let (width, height) = (32, 16);
    let texels = (0..width * height).map(|i| match (i % width, i / width) {
        (18..22, 3..=5) => Vec3::new(12.0, 10.0, 7.0),
        (x, 7 | 8) => Vec3::new(1.5, 1.0, 0.1 * (x % 8) as f32),
        (_, 9..) => Vec3::splat(0.1),
        _ => Vec3::new(0.2, 0.4, 0.9),
    });
    let mut scene = things(metal(0.35), coated());
    scene.surround(EnvironmentMap::new(width, height, texels.collect(), 2.0).expect("texels"));
    let through_lens = Camera {
        lens_radius: 0.15,
        ..camera()
    };
    assert_true(&scene, &through_lens, "environment map");
}

#[test]
fn suns() {
    let mut scene = things(metal(0.4), glass(0.5));
    scene.lights.push(Light::Directional(DirectionalLight {
        name: String::new(),
        direction: Vec3::new(-0.48, -0.8, -0.36),
        illuminance: Vec3::new(3.0, 2.8, 2.4),
        angle: 40_f32.to_radians(),
    }));
    scene.environment = Environment {
        zenith: Vec3::new(0.2, 0.3, 0.6),
        nadir: Vec3::splat(0.1),
        ambient: None,
        map: None,
    };
    assert_true(&scene, &camera(), "suns");
}

/// Balls, disks, sheets and a mesh: a hundred and twenty lights all around, from within which one is chosen.
#[test]
fn many_lights() {
    let mut scene = things(metal(0.5), coated());
    let mut random = Random(3);
    for i in 0..60 {
        let center = 3.0 * random.direction() + Vec3::new(0.0, 3.2, 0.0);
        let normal = random.direction();
        let (u, v) = normal.any_orthonormal_pair();
        let surface = match i % 3 {
            0 => Surface::Sphere(Sphere {
                center,
                radius: 0.2,
            }),
            1 => Surface::Disk(Disk {
                center,
                normal,
                radius: 0.35,
            }),
            _ => Surface::Rectangle(Rectangle {
                center,
                u: 0.4 * u,
                v: 0.2 * v,
            }),
        };
        add_surface(&mut scene, surface, lamp(random.vec3(0.5, 6.0)));
    }
    let mut mesh = Mesh::default();
    for i in 0..60 {
        let turn = i as f32 / 60.0 * std::f32::consts::TAU;
        let at = Vec2::from_angle(turn);
        let corner = Vec3::new(2.8 * at.x, 0.3, 2.8 * at.y);
        mesh.positions.extend([
            corner,
            corner + 0.4 * Vec3::Y,
            corner + Vec3::new(0.3 * at.y, 0.2, -0.3 * at.x),
        ]);
        mesh.indices.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    add_mesh(&mut scene, mesh, lamp(Vec3::new(1.0, 3.0, 4.0)));
    assert_true(&scene, &camera(), "many lights");
}
