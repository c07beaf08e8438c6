//! The light of what shines with an area, on a white floor, against closed forms.

mod support;

use std::f32::consts::PI;
use support::{add_mesh, add_surface, floor, look, matte, path_scene::paths, sky};
use umbriel_render::{
    Camera, DirectionalLight, EnvironmentMap, Light, Material, Mesh, PointLight, Scene, Settings,
    SpotLight,
    kernels::{
        Disk, Plane, Rectangle, Sphere, Surface,
        glam::{DVec3, Vec3},
    },
};

/// Samples of the one pixel.
const SAMPLES: u32 = 16_384;

fn lamp(radiance: f32) -> Material {
    Material {
        emission: Vec3::splat(radiance),
        ..matte(Vec3::ZERO)
    }
}

fn white_floor() -> Scene {
    let mut scene = Scene::default();
    add_surface(&mut scene, floor(), matte(Vec3::ONE));
    scene
}

/// The illuminance that the floor takes at the origin.
fn illuminance(scene: &Scene) -> f32 {
    // From below every lamp of these tests, and so near that only the origin is seen.
    let eye = Vec3::new(0.0, 1e-3, 1e-3);
    let camera = Camera::look_at("eye", eye, Vec3::ZERO, Vec3::Y, 1e-3);
    let settings = Settings {
        depth: 1,
        ..paths([1, 1], SAMPLES, 3)
    };
    PI * look(scene, &camera, &settings).x
}

fn assert_lit(scene: &Scene, expected: f32, name: &str) {
    let found = illuminance(scene);
    assert!(
        (found / expected - 1.0).abs() < 2e-3,
        "{name}: {found} should be {expected}"
    );
}

/// What a polygon of radiance 1 gives a point at the origin whose normal is `n`, all of it above the horizon.
///
/// ```text
/// E = ½ Σ γ_i (n · (v_i × v_{i+1})/|v_i × v_{i+1}|)       γ_i the angle between v_i and v_{i+1}
/// ```
///
/// Source: Lambert, "Photometria", 1760, paragraph 152.
fn polygon_illuminance(corners: &[Vec3], n: Vec3) -> f32 {
    let corners: Vec<DVec3> = corners.iter().map(|v| v.as_dvec3()).collect();
    let sum: f64 = (0..corners.len())
        .map(|i| {
            let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
            a.angle_between(b) * a.cross(b).normalize().dot(n.as_dvec3())
        })
        .sum();
    (0.5 * sum.abs()) as f32
}

#[test]
fn rectangles() {
    for (center, u, v) in [
        (Vec3::new(0.0, 1.0, 0.0), Vec3::X * 0.5, Vec3::Z * 0.7),
        (Vec3::new(2.0, 1.0, 0.5), Vec3::Y * 0.9, Vec3::Z),
        (Vec3::new(-3.0, 8.0, 5.0), Vec3::X * 0.1, Vec3::Z * 0.2),
        (Vec3::new(0.2, 0.4, 0.1), Vec3::X * 3.0, Vec3::Z * 2.0),
    ] {
        let mut scene = white_floor();
        add_surface(
            &mut scene,
            Surface::Rectangle(Rectangle { center, u, v }),
            lamp(5.0),
        );
        let corners = [
            center - u - v,
            center + u - v,
            center + u + v,
            center - u + v,
        ];
        let expected = 5.0 * polygon_illuminance(&corners, Vec3::Y);
        assert_lit(&scene, expected, &format!("rectangle at {center}"));
    }
}

#[test]
fn triangles_of_a_mesh() {
    let corners = [
        Vec3::new(-0.5, 1.0, 0.2),
        Vec3::new(1.5, 0.7, -0.3),
        Vec3::new(0.1, 1.8, 1.0),
        Vec3::new(-2.0, 2.0, 2.0),
    ];
    let mut scene = white_floor();
    let glow = Material {
        double_sided: true,
        ..lamp(2.0)
    };
    let mesh = Mesh {
        positions: corners.to_vec(),
        indices: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    add_mesh(&mut scene, mesh, glow);
    let parts = [[0, 1, 2], [0, 2, 3]].map(|t: [usize; 3]| t.map(|i| corners[i]));
    let expected = parts.map(|t| 2.0 * polygon_illuminance(&t, Vec3::Y));
    assert_lit(&scene, expected[0] + expected[1], "mesh");
}

/// `E = π L (r/d)² cos θ` while all of the ball is above the horizon.
#[test]
fn balls() {
    for (center, radius) in [
        (Vec3::new(0.0, 2.0, 0.0), 1.0_f32),
        (Vec3::new(3.0, 2.0, -1.0), 0.5),
        (Vec3::new(20.0, 30.0, 5.0), 0.1),
    ] {
        let d2 = center.length_squared();
        let share = radius * radius / d2 * center.normalize().y;
        let mut glowing = white_floor();
        add_surface(
            &mut glowing,
            Surface::Sphere(Sphere { center, radius }),
            lamp(4.0),
        );
        assert_lit(&glowing, PI * 4.0 * share, "glowing sphere");
        // A light of the same radiance: its intensity is π r² L.
        let mut lit = white_floor();
        lit.lights.push(Light::Point(PointLight {
            name: String::new(),
            position: center,
            intensity: Vec3::splat(4.0 * PI * radius * radius),
            range: f32::INFINITY,
            diameter: 2.0 * radius,
        }));
        assert_lit(&lit, PI * 4.0 * share, "point light");
    }
}

/// A spot light's ball gives on its axis what the light without extent gives.
#[test]
fn spots() {
    let position = Vec3::new(1.0, 3.0, 0.0);
    let mut scene = white_floor();
    scene.lights.push(Light::Spot(SpotLight {
        name: String::new(),
        position,
        direction: -position.normalize(),
        intensity: Vec3::splat(7.0),
        range: f32::INFINITY,
        inner_angle: 0.2,
        outer_angle: 0.4,
        diameter: 0.8,
    }));
    let expected = 7.0 / position.length_squared() * position.normalize().y;
    assert_lit(&scene, expected, "spot");
}

/// `E = E₀ cos θ` whatever the angle, while all of the disk is above the horizon.
#[test]
fn suns() {
    for degrees in [0.0_f32, 0.53, 20.0, 80.0] {
        let mut scene = white_floor();
        let direction = Vec3::new(0.3, -0.9, 0.1).normalize();
        scene.lights.push(Light::Directional(DirectionalLight {
            name: String::new(),
            direction,
            illuminance: Vec3::splat(2.0),
            angle: degrees.to_radians(),
        }));
        assert_lit(&scene, 2.0 * -direction.y, &format!("{degrees} degrees"));
    }
}

/// `E = π L r²/(h² + r²)` in the middle below a disk.
#[test]
fn disks() {
    let mut scene = white_floor();
    let disk = Disk {
        center: Vec3::new(0.0, 1.5, 0.0),
        normal: Vec3::NEG_Y,
        radius: 0.8,
    };
    add_surface(&mut scene, Surface::Disk(disk), lamp(3.0));
    let expected = PI * 3.0 * 0.64 / (2.25 + 0.64);
    assert_lit(&scene, expected, "disk");
}

/// The sky gives `πL`, and half of it beside an endless black wall.
#[test]
fn skies() {
    let mut scene = white_floor();
    scene.environment = sky(Vec3::splat(0.7));
    assert_lit(&scene, PI * 0.7, "open sky");
    let wall = Surface::Plane(Plane {
        point: Vec3::new(-0.5, 0.0, 0.0),
        normal: Vec3::X,
    });
    add_surface(&mut scene, wall, matte(Vec3::ZERO));
    assert_lit(&scene, 0.5 * PI * 0.7, "half of the sky");
}

/// Glowing walls of albedo ρ around everything: the radiance is `e/(1 − ρ)` everywhere, on a ball inside that neither adds nor takes, too.
#[test]
fn closed_furnace() {
    let mut scene = Scene::default();
    let walls = Material {
        emission: Vec3::splat(0.7),
        ..matte(Vec3::splat(0.3))
    };
    let ball = |radius| {
        Surface::Sphere(Sphere {
            center: Vec3::ZERO,
            radius,
        })
    };
    add_surface(&mut scene, ball(2.0), walls);
    add_surface(&mut scene, ball(0.5), matte(Vec3::ONE));
    for target in [Vec3::ZERO, Vec3::new(0.0, 1.5, 0.0)] {
        let camera = Camera::look_at("eye", Vec3::new(0.0, 0.3, 1.5), target, Vec3::X, 0.1);
        let settings = Settings {
            depth: 64,
            ..paths([1, 1], 4 * SAMPLES, 5)
        };
        let found = look(&scene, &camera, &settings);
        assert!((found.x - 1.0).abs() < 1e-3, "{target}: {found}");
    }
}

/// A map of one bright texel gives what a sun of the same illuminance gives; one of a single colour what a sky gives.
#[test]
fn maps() {
    let (width, height) = (64, 32);
    let mut texels = vec![Vec3::ZERO; width * height];
    let (x, y) = (40, 9);
    texels[y * width + x] = Vec3::splat(1000.0);
    let map = EnvironmentMap::new(width, height, texels, 0.4).expect("it has texels");
    // The bilinear image of a texel is a pyramid over two by two: as much light as the texel alone, but for the curve of the sphere.
    let mut scene = white_floor();
    let expected: f64 = (0..1_000_000)
        .map(|i| {
            let (u, v) = ((i % 1000) as f32 + 0.5, (i / 1000) as f32 + 0.5);
            let (sin, cos) = (PI / 1000.0 * v / 2.0).sin_cos();
            let (sin_phi, cos_phi) = (2.0 * PI / 1000.0 * u).sin_cos();
            let dir = Vec3::new(sin * sin_phi, cos, sin * cos_phi);
            let area = (PI / 2000.0) * (2.0 * PI / 1000.0) * sin;
            f64::from(map.radiance(dir).x * cos * area)
        })
        .sum();
    scene.surround(map);
    assert_lit(&scene, expected as f32, "one texel");
    let mut scene = white_floor();
    let even = EnvironmentMap::new(2, 1, vec![Vec3::splat(0.7); 2], 0.0);
    scene.surround(even.expect("it has texels"));
    assert_lit(&scene, PI * 0.7, "one colour");
}
