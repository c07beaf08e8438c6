//! Shadow maps where near and far lie very far apart.

mod support;

use support::{add_surface, draw, floor, matte, point_light, shadow_scene::spot, sun};
use umbriel_render::{
    Camera, Film, Method, Scene, Settings, ShadowMapSettings,
    kernels::{Plane, Sphere, Surface, glam::Vec3},
};

const SIZE: [u32; 2] = [160, 120];

fn ball(center: Vec3, radius: f32) -> Surface {
    Surface::Sphere(Sphere { center, radius })
}

fn picture(scene: &Scene, method: Method) -> Film {
    let map = ShadowMapSettings {
        resolution: 512,
        ..ShadowMapSettings::default()
    };
    let settings = Settings {
        method,
        resolution: SIZE,
        shadow_maps: vec![map; scene.lights.len()],
        ..Settings::default()
    };
    let eye = Vec3::new(0.0, 3.0, 8.0);
    let camera = Camera::look_at("eye", eye, Vec3::Y, Vec3::Y, 0.7);
    draw(scene, &camera, &settings)
}

/// The share of pixels whose colour differs between maps and rays.
fn differing(scene: &Scene) -> f32 {
    let (maps, rays) = (
        picture(scene, Method::ShadowMap),
        picture(scene, Method::RayCast),
    );
    let pairs = maps.image.pixels.iter().zip(&rays.image.pixels);
    let wrong = pairs.filter(|(a, b)| (0..3).any(|k| (a[k] - b[k]).abs() > 0.02 * a[k].max(b[k])));
    wrong.count() as f32 / rays.image.pixels.len() as f32
}

/// A far ball, a far dome, and a plane given by a far point hide nothing near from the eye or from lights.
#[test]
fn far_things_hide_nothing_near() {
    let far_floor = Surface::Plane(Plane {
        point: Vec3::new(1e9, 0.0, 0.0),
        normal: Vec3::Y,
    });
    for (ground, far) in [
        (far_floor, None),
        (floor(), Some(ball(Vec3::X * 1e8, 1.0))),
        (floor(), Some(ball(Vec3::ZERO, 1e8))),
    ] {
        let mut scene = Scene::default();
        add_surface(&mut scene, ground, matte(Vec3::ONE));
        add_surface(&mut scene, ball(Vec3::Y, 1.0), matte(Vec3::ONE));
        if let Some(far) = far {
            add_surface(&mut scene, far, matte(Vec3::ONE));
        }
        scene
            .lights
            .push(point_light(Vec3::new(2.0, 4.0, 2.0), 30.0));
        let share = differing(&scene);
        assert!(share < 0.01, "{share}");
    }
}

/// A lamp that lies in a plane lights what stands on it.
#[test]
fn a_light_in_a_plane_is_not_in_its_own_shadow() {
    let mut scene = Scene::default();
    add_surface(&mut scene, floor(), matte(Vec3::ONE));
    add_surface(&mut scene, ball(Vec3::Y, 1.0), matte(Vec3::ONE));
    scene.lights = vec![
        point_light(Vec3::new(2.0, 0.0, 2.0), 30.0),
        sun(Vec3::X, 0.5),
    ];
    let share = differing(&scene);
    assert!(share < 0.01, "{share}");
}

/// A lamp far away lights like the sun: the further, the more alike, at any distance.
#[test]
fn far_lights_are_like_suns() {
    for with_floor in [false, true] {
        for distance in [30.0, 1e3, 1e5, 1e7, 1e10_f32] {
            let mut scene = Scene::default();
            if with_floor {
                add_surface(&mut scene, floor(), matte(Vec3::ONE));
            }
            add_surface(&mut scene, ball(Vec3::Y, 1.0), matte(Vec3::ONE));
            add_surface(
                &mut scene,
                ball(Vec3::new(0.8, 2.3, 0.5), 0.4),
                matte(Vec3::ONE),
            );
            let way = Vec3::new(0.5, 0.8, 0.3).normalize();
            let light = point_light(way * distance, 10.0 * distance * distance);
            let cone = spot(way * distance, -way, 0.3);
            for light in [light, cone] {
                scene.lights = vec![light];
                let share = differing(&scene);
                println!("{distance} m, floor {with_floor}: {share}");
                assert!(share < 0.01, "{distance} m: {share}");
            }
        }
    }
}
