//! Scenes that nobody would want: every method draws them without a number that is none.

mod support;

use support::{add_mesh, add_surface, draw, floor, matte, point_light, sky, sun};
use umbriel_render::{
    Camera, DirectionalLight, Film, Layers, Light, Material, Mesh, Method, PointLight, Sampling,
    Scene, Settings, ShadowMapSettings, SpotLight,
    kernels::{Disk, Rectangle, Sphere, Surface, glam::Vec3},
};

const METHODS: [Method; 5] = [
    Method::RayCast,
    Method::ShadowMap,
    Method::Whitted,
    Method::Distributed,
    Method::Path,
];

fn camera() -> Camera {
    let (from, to) = (Vec3::new(0.0, 1.5, 5.0), Vec3::new(0.0, 0.5, 0.0));
    Camera::look_at("eye", from, to, Vec3::Y, 0.7)
}

/// Draws by all methods; every value is finite and at least 0, and no sample was thrown away.
fn draw_all(name: &str, scene: &Scene, camera: &Camera) -> Vec<Film> {
    let map = ShadowMapSettings {
        resolution: 64,
        ..ShadowMapSettings::default()
    };
    METHODS
        .iter()
        .map(|&method| {
            let settings = Settings {
                method,
                resolution: [24, 16],
                sampling: Sampling::Fixed { spp: 8 },
                shadow_maps: vec![map; scene.lights.len()],
                ..Settings::default()
            };
            let film = draw(scene, camera, &settings);
            assert_eq!(film.stats.bad_samples, 0, "{name}: {method:?}");
            let values = film.image.pixels.iter().flatten();
            for value in values {
                assert!(value.is_finite() && *value >= 0.0, "{name}: {method:?}");
            }
            film
        })
        .collect()
}

fn ball(center: Vec3, radius: f32) -> Surface {
    Surface::Sphere(Sphere { center, radius })
}

fn lamp(radiance: f32) -> Material {
    Material {
        emission: Vec3::splat(radiance),
        ..matte(Vec3::ZERO)
    }
}

/// A floor and a ball of a material, in a dim sky.
fn ball_of(material: Material) -> Scene {
    let mut scene = Scene {
        environment: sky(Vec3::splat(0.1)),
        ..Scene::default()
    };
    add_surface(&mut scene, floor(), matte(Vec3::splat(0.5)));
    add_surface(&mut scene, ball(Vec3::new(0.0, 0.7, 0.0), 0.7), material);
    scene
}

fn all_materials() -> Vec<(&'static str, Material)> {
    let glass = |roughness, thin_walled| Material {
        transmission: 1.0,
        roughness,
        thin_walled,
        ..Material::default()
    };
    let metal = |roughness| Material {
        metallic: 1.0,
        roughness,
        ..Material::default()
    };
    let full = Material {
        roughness: 0.3,
        layers: Layers {
            clearcoat: 1.0,
            sheen_color: Vec3::ONE,
            iridescence: 1.0,
            anisotropy: 1.0,
            ..Layers::NONE
        },
        ..Material::default()
    };
    vec![
        ("matte", matte(Vec3::ONE)),
        ("mirror", metal(0.0)),
        ("least rough metal", metal(f32::MIN_POSITIVE)),
        ("rough metal", metal(1.0)),
        ("glass", glass(0.0, false)),
        ("least rough glass", glass(1e-20, false)),
        ("rough glass", glass(1.0, false)),
        ("thin glass", glass(0.5, true)),
        ("layers", full),
    ]
}

/// A sun and a point beside sizes that a square makes 0 of.
#[test]
fn lights_of_no_size() {
    let size = [0.0, f32::MIN_POSITIVE, 1e-30, 1e-20, 1e-10];
    for size in size {
        let mut scene = ball_of(matte(Vec3::splat(0.5)));
        let point = PointLight {
            name: String::new(),
            position: Vec3::new(1.0, 3.0, 1.0),
            intensity: Vec3::ONE,
            range: f32::INFINITY,
            diameter: size,
        };
        scene.lights = vec![
            Light::Point(point.clone()),
            Light::Spot(SpotLight {
                name: String::new(),
                position: point.position,
                direction: Vec3::NEG_Y,
                intensity: Vec3::ONE,
                range: f32::INFINITY,
                inner_angle: 0.0,
                outer_angle: 0.5,
                diameter: size,
            }),
            Light::Directional(DirectionalLight {
                name: String::new(),
                direction: Vec3::NEG_Y,
                illuminance: Vec3::ONE,
                angle: size,
            }),
        ];
        let films = draw_all("lights of no size", &scene, &camera());
        let sum = |film: &Film| film.image.pixels.iter().map(|p| p[0]).sum::<f32>();
        // Paths see as much of a light that small as ray casting does of a point: half as much again comes by the floor.
        let ratio = sum(&films[4]) / sum(&films[0]);
        assert!((0.8..2.0).contains(&ratio), "{size}: {ratio}");
    }
}

/// As small as scenes may have them, and triangles without area or with the corners in one point.
#[test]
fn lamps_of_no_area() {
    for size in [2e-18_f32, 1e-12, 1e-6] {
        for scale in [1.0, 1e25] {
            let mut scene = ball_of(matte(Vec3::splat(0.5)));
            let at = Vec3::new(0.5, 2.0, 0.5);
            let (u, v) = (size * Vec3::X, size * Vec3::Z);
            let glow = || lamp(scale);
            add_surface(
                &mut scene,
                Surface::Rectangle(Rectangle { center: at, u, v }),
                glow(),
            );
            let disk = Disk {
                center: -at,
                normal: Vec3::Y,
                radius: size,
            };
            add_surface(&mut scene, Surface::Disk(disk), glow());
            add_surface(&mut scene, ball(at + Vec3::X, size), glow());
            let triangles = Mesh {
                positions: vec![at, at, at + u, at + v, Vec3::ONE, 2.0 * Vec3::ONE],
                indices: vec![[0, 1, 2], [0, 0, 0], [0, 2, 3], [0, 4, 5], [4, 5, 4]],
                ..Mesh::default()
            };
            add_mesh(&mut scene, triangles, glow());
            draw_all(&format!("lamps of {size}"), &scene, &camera());
        }
    }
}

#[test]
fn black_materials_and_no_light() {
    for (name, material) in all_materials() {
        let black = Material {
            base_color: Vec3::ZERO,
            ..material.clone()
        };
        let mut scene = ball_of(black);
        scene
            .lights
            .push(point_light(Vec3::new(1.0, 3.0, 2.0), 5.0));
        scene.lights.push(sun(Vec3::NEG_Y, 1.0));
        draw_all(&format!("black {name}"), &scene, &camera());
        let mut dark = ball_of(material);
        dark.environment = sky(Vec3::ZERO);
        for film in draw_all(&format!("{name} without light"), &dark, &camera()) {
            let pixels = film.image.pixels.iter();
            assert!(pixels.map(|p| p[0] + p[1] + p[2]).all(|sum| sum == 0.0));
        }
        // Lights that give nothing are none.
        dark.lights.push(point_light(Vec3::ONE, 0.0));
        dark.lights.push(sun(Vec3::NEG_Y, 0.0));
        draw_all(&format!("{name} in no light"), &dark, &camera());
    }
    draw_all("nothing at all", &Scene::default(), &camera());
}

/// In the middle of the ball, on its surface, and in the plane of the floor.
#[test]
fn lights_and_cameras_inside_of_things() {
    let places = [
        Vec3::new(0.0, 0.7, 0.0),
        Vec3::new(0.0, 1.4, 0.0),
        Vec3::ZERO,
        Vec3::new(0.1, 0.0, 3.0),
        Vec3::new(0.2, -1.0, 0.1),
    ];
    for (name, material) in all_materials() {
        for place in places {
            let mut scene = ball_of(material.clone());
            scene.lights.push(point_light(place, 5.0));
            let large = PointLight {
                name: String::new(),
                position: place,
                intensity: Vec3::ONE,
                range: f32::INFINITY,
                diameter: 0.6,
            };
            scene.lights.push(Light::Point(large));
            add_surface(&mut scene, ball(place, 0.2), lamp(3.0));
            let panel = Rectangle {
                center: place,
                u: Vec3::X,
                v: 0.5 * Vec3::Y,
            };
            add_surface(&mut scene, Surface::Rectangle(panel), lamp(2.0));
            let name = format!("{name} at {place}");
            draw_all(&format!("light in {name}"), &scene, &camera());
            let target = place + Vec3::new(0.3, -0.2, -1.0);
            let inside = Camera {
                lens_radius: 0.05,
                ..Camera::look_at("inside", place, target, Vec3::Y, 1.2)
            };
            draw_all(&format!("eye in {name}"), &scene, &inside);
        }
    }
}

/// Light that no number can hold is thrown away sample by sample, and counted.
#[test]
fn light_beyond_measure() {
    for light in [1e30, f32::MAX] {
        let mut scene = ball_of(matte(Vec3::splat(0.5)));
        scene
            .lights
            .push(point_light(Vec3::new(0.0, 1.5, 0.0), light));
        scene.lights.push(sun(Vec3::NEG_Y, light));
        add_surface(&mut scene, ball(Vec3::new(1.0, 2.0, 1.0), 0.3), lamp(light));
        scene.environment = sky(Vec3::splat(light));
        for method in METHODS {
            let settings = Settings {
                method,
                resolution: [24, 16],
                sampling: Sampling::Fixed { spp: 8 },
                ..Settings::default()
            };
            let film = draw(&scene, &camera(), &settings);
            let values = film.image.pixels.iter().flatten();
            for value in values {
                assert!(value.is_finite() && *value >= 0.0, "{light}: {method:?}");
            }
            assert!(light < f32::MAX || film.stats.bad_samples > 0, "{method:?}");
        }
    }
}

/// A lamp around everything, seen from inside.
#[test]
fn the_eye_in_a_lamp() {
    let mut scene = ball_of(matte(Vec3::splat(0.5)));
    add_surface(&mut scene, ball(Vec3::ZERO, 50.0), lamp(1.0));
    let films = draw_all("eye in a lamp", &scene, &camera());
    assert!(films[4].image.pixels.iter().all(|p| p[0] > 0.1));
}
