//! Pictures of glass whose pixels have a closed form.

mod support;

use std::f32::consts::PI;
use support::{add_surface, close, eye, floor, look, matte, ray_cast, sky, sun};
use umbriel_render::{
    Environment, GlassShadows, Material, Scene, Settings, fresnel_dielectric,
    kernels::{Cuboid, Rectangle, Sphere, Surface, glam::Vec3},
};

/// A pane of clear glass with two parallel faces: the light of the sky behind and before it adds up to all of it.
#[test]
fn glass_loses_nothing() {
    let mut scene = Scene {
        environment: sky(Vec3::ONE),
        ..Scene::default()
    };
    let pane = Cuboid {
        min: Vec3::new(-5.0, -5.0, 0.0),
        max: Vec3::new(5.0, 5.0, 1.0),
    };
    let glass = Material {
        transmission: 1.0,
        roughness: 0.0,
        ..Material::default()
    };
    add_surface(&mut scene, Surface::Cuboid(pane), glass);
    let settings = Settings {
        depth: 30,
        min_weight: 0.0,
        ..Settings::default()
    };
    close(
        look(
            &scene,
            &eye(Vec3::new(1.0, 0.0, 5.0), Vec3::ZERO),
            &settings,
        ),
        Vec3::ONE,
    );
}

/// Without further rays only the direct reflection is left: Fresnel's formula.
#[test]
fn glass_reflects_by_fresnel() {
    let environment = Environment {
        zenith: Vec3::ONE * 2.0,
        nadir: Vec3::ZERO,
        ambient: Some(Vec3::ZERO),
        map: None,
    };
    let mut scene = Scene {
        environment,
        ..Scene::default()
    };
    let glass = Material {
        transmission: 1.0,
        roughness: 0.0,
        ior: 1.7,
        ..Material::default()
    };
    add_surface(
        &mut scene,
        Surface::Cuboid(Cuboid {
            min: Vec3::splat(-9.0),
            max: Vec3::new(9.0, 0.0, 9.0),
        }),
        glass,
    );
    let settings = Settings {
        depth: 1,
        ..Settings::default()
    };
    let from = Vec3::new(3.0, 4.0, 0.0);
    // The mirrored ray rises as steeply as the view falls; the refracted ray is inside and ends there.
    let expected = fresnel_dielectric(0.8, 1.7) * (1.0 + 0.8);
    close(
        look(&scene, &eye(from, Vec3::ZERO), &settings),
        Vec3::splat(expected),
    );
}

/// Beer and Lambert: glass that does not refract, seen through the middle of a sphere.
#[test]
fn absorption_follows_the_chord() {
    let mut scene = Scene {
        environment: sky(Vec3::ONE),
        ..Scene::default()
    };
    let color = Vec3::new(0.5, 0.2, 0.9);
    let medium = Material {
        transmission: 1.0,
        roughness: 0.0,
        ior: 1.0,
        attenuation_color: color,
        attenuation_distance: 0.5,
        ..Material::default()
    };
    add_surface(
        &mut scene,
        Surface::Sphere(Sphere {
            center: Vec3::ZERO,
            radius: 0.75,
        }),
        medium,
    );
    let expected = color.powf(1.5 / 0.5);
    close(
        look(
            &scene,
            &eye(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO),
            &Settings::default(),
        ),
        expected,
    );
}

/// A bubble in glass of the same surface distance: an inner sphere turned inside out is a hollow shell, and a shell of
/// ior 1 is invisible.
#[test]
fn hollow_sphere_absorbs_in_its_shell_only() {
    let mut scene = Scene {
        environment: sky(Vec3::ONE),
        ..Scene::default()
    };
    let medium = Material {
        transmission: 1.0,
        roughness: 0.0,
        ior: 1.0,
        attenuation_color: Vec3::splat(0.5),
        attenuation_distance: 0.25,
        ..Material::default()
    };
    for radius in [1.0, 0.75] {
        add_surface(
            &mut scene,
            Surface::Sphere(Sphere {
                center: Vec3::ZERO,
                radius,
            }),
            medium.clone(),
        );
    }
    scene.instances[1].inside_out = true;
    // Two walls of 0.25 each.
    close(
        look(
            &scene,
            &eye(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO),
            &Settings::default(),
        ),
        Vec3::splat(0.25),
    );
}

/// Past the critical angle everything is reflected: a view from inside the glass sees only the inside.
#[test]
fn total_internal_reflection() {
    let mut scene = Scene {
        environment: sky(Vec3::ZERO),
        ..Scene::default()
    };
    let glass = Material {
        transmission: 1.0,
        roughness: 0.0,
        ..Material::default()
    };
    let body = Cuboid {
        min: Vec3::new(-50.0, -50.0, -50.0),
        max: Vec3::new(50.0, 0.0, 50.0),
    };
    add_surface(&mut scene, Surface::Cuboid(body), glass);
    let lamp = Rectangle {
        center: Vec3::new(2.0, -2.0, 0.0),
        u: Vec3::new(0.0, 1.0, 0.0),
        v: Vec3::new(0.0, 0.0, 1.0),
    };
    let glow = Material {
        emission: Vec3::ONE,
        base_color: Vec3::ZERO,
        ior: 1.0,
        ..Material::default()
    };
    add_surface(&mut scene, Surface::Rectangle(lamp), glow);
    // 45 degrees is past the critical angle of 41.8 degrees: the water's surface is a perfect mirror.
    let camera = eye(Vec3::new(-2.0, -2.0, 0.0), Vec3::ZERO);
    close(look(&scene, &camera, &Settings::default()), Vec3::ONE);
}

/// Filtered light through a thin pane: what is not reflected, times the colour; opaque glass blocks it.
#[test]
fn shadow_of_a_thin_pane() {
    let mut scene = Scene::default();
    add_surface(&mut scene, floor(), matte(Vec3::ONE));
    let color = Vec3::new(1.0, 0.5, 0.25);
    let pane = Material {
        base_color: color,
        transmission: 1.0,
        roughness: 0.0,
        thin_walled: true,
        ..Material::default()
    };
    let rectangle = Rectangle {
        center: Vec3::Y,
        u: Vec3::X,
        v: Vec3::NEG_Z,
    };
    add_surface(&mut scene, Surface::Rectangle(rectangle), pane);
    scene.lights.push(sun(Vec3::NEG_Y, PI));
    let camera = eye(Vec3::new(-0.3, 0.9, 0.0), Vec3::ZERO);
    let f = 0.04_f32;
    close(
        look(&scene, &camera, &ray_cast()),
        color * (1.0 - 2.0 * f / (1.0 + f)),
    );
    let opaque = Settings {
        glass_shadows: Some(GlassShadows::Opaque),
        ..ray_cast()
    };
    close(look(&scene, &camera, &opaque), Vec3::ZERO);
}
