//! Pictures of opaque things whose pixels have a closed form.

mod support;

use std::f32::consts::PI;
use support::{
    add_mesh, add_surface, close, eye, floor, look, matte, point_light, ray_cast, sky, sun,
};
use umbriel_render::{
    AlphaMode, Material, Mesh, Scene, Settings,
    kernels::{
        Plane, Rectangle, Sphere, Surface,
        glam::{Vec3, Vec4},
    },
};

/// `L = albedo/π · I cos θ / d²`
#[test]
fn lambert_under_a_point_light() {
    let mut scene = Scene::default();
    add_surface(&mut scene, floor(), matte(Vec3::new(0.8, 0.4, 0.2)));
    let position = Vec3::new(3.0, 4.0, 0.0);
    scene.lights.push(point_light(position, 50.0));
    let expected = Vec3::new(0.8, 0.4, 0.2) / PI * 50.0 * (4.0 / 5.0) / 25.0;
    for settings in [ray_cast(), Settings::default()] {
        close(
            look(
                &scene,
                &eye(Vec3::new(-1.0, 2.0, 1.0), Vec3::ZERO),
                &settings,
            ),
            expected,
        );
    }
}

/// The inside of a sphere with a light in the middle: the same everywhere, `albedo/π · I/r²`.
#[test]
fn sphere_around_a_light() {
    let mut scene = Scene::default();
    add_surface(
        &mut scene,
        Surface::Sphere(Sphere {
            center: Vec3::ZERO,
            radius: 2.0,
        }),
        matte(Vec3::splat(0.5)),
    );
    scene.lights.push(point_light(Vec3::ZERO, 8.0 * PI));
    for to in [
        Vec3::X,
        Vec3::new(1.0, 2.0, -0.5),
        Vec3::new(-0.2, -1.0, 0.7),
    ] {
        close(
            look(&scene, &eye(Vec3::new(0.3, 0.2, -0.4), to), &ray_cast()),
            Vec3::ONE,
        );
    }
}

#[test]
fn shadow_is_black_and_can_be_turned_off() {
    let mut scene = Scene::default();
    add_surface(&mut scene, floor(), matte(Vec3::ONE));
    add_surface(
        &mut scene,
        Surface::Sphere(Sphere {
            center: Vec3::new(0.0, 2.0, 0.0),
            radius: 0.5,
        }),
        matte(Vec3::ONE),
    );
    scene.lights.push(sun(Vec3::NEG_Y, PI));
    let camera = eye(Vec3::new(-1.0, 3.0, 0.0), Vec3::ZERO);
    close(look(&scene, &camera, &ray_cast()), Vec3::ZERO);
    let unshadowed = Settings {
        shadows: false,
        ..ray_cast()
    };
    close(look(&scene, &camera, &unshadowed), Vec3::ONE);
}

/// A light just beneath a ceiling is not shadowed by it, and one behind a wall is.
#[test]
fn point_light_beyond_and_before_a_wall() {
    let mut scene = Scene::default();
    add_surface(&mut scene, floor(), matte(Vec3::ONE));
    let ceiling = Plane {
        point: Vec3::new(0.0, 5.0, 0.0),
        normal: Vec3::NEG_Y,
    };
    add_surface(&mut scene, Surface::Plane(ceiling), matte(Vec3::ONE));
    let camera = eye(Vec3::new(-3.0, 1.0, 0.0), Vec3::ZERO);
    for (height, lit) in [(5.0, true), (4.999, true), (5.001, false)] {
        scene.lights = vec![point_light(Vec3::new(0.0, height, 0.0), 25.0 * PI)];
        assert_eq!(look(&scene, &camera, &ray_cast()).x > 0.5, lit, "{height}");
    }
}

/// A metal mirror shows the sky times its reflectance at normal incidence.
#[test]
fn mirror_reflects_the_sky() {
    let mut scene = Scene {
        environment: sky(Vec3::new(1.0, 2.0, 3.0)),
        ..Scene::default()
    };
    let color = Vec3::new(0.9, 0.6, 0.3);
    let gold = Material {
        base_color: color,
        metallic: 1.0,
        roughness: 0.0,
        ..Material::default()
    };
    add_surface(&mut scene, floor(), gold);
    let down = eye(Vec3::new(0.0, 3.0, 0.0), Vec3::ZERO);
    close(
        look(&scene, &down, &Settings::default()),
        color * Vec3::new(1.0, 2.0, 3.0),
    );
    let no_rays = Settings {
        depth: 0,
        ..Settings::default()
    };
    close(look(&scene, &down, &no_rays), Vec3::ZERO);
}

/// Two facing mirrors of reflectance R: a ray that is stopped after n mirrored rays has seen the lamp
/// between them with weights R + R² + ...
#[test]
fn recursion_is_a_geometric_series() {
    let mut scene = Scene::default();
    let mirror = |color: f32| Material {
        base_color: Vec3::splat(color),
        metallic: 1.0,
        roughness: 0.0,
        emission: Vec3::ONE,
        ..Material::default()
    };
    add_surface(&mut scene, floor(), mirror(0.5));
    let ceiling = Plane {
        point: Vec3::new(0.0, 2.0, 0.0),
        normal: Vec3::NEG_Y,
    };
    add_surface(&mut scene, Surface::Plane(ceiling), mirror(0.5));
    for depth in [0, 1, 2, 5] {
        let settings = Settings {
            depth,
            ..Settings::default()
        };
        let expected: f32 = (0..=depth as i32).map(|k| 0.5_f32.powi(k)).sum();
        close(
            look(&scene, &eye(Vec3::Y, Vec3::ZERO), &settings),
            Vec3::splat(expected),
        );
    }
}

/// A surface of opacity alpha covers alpha of what is behind, in view and in shadow.
#[test]
fn blend_covers_a_fraction() {
    let mut scene = Scene {
        environment: sky(Vec3::new(0.0, 0.0, 1.0)),
        ..Scene::default()
    };
    let veil = Material {
        base_color: Vec3::ZERO,
        emission: Vec3::X,
        ior: 1.0,
        alpha: 0.25,
        alpha_mode: AlphaMode::Blend,
        ..Material::default()
    };
    for z in [0.0, 1.0] {
        let rectangle = Rectangle {
            center: Vec3::Z * z,
            u: Vec3::X * 9.0,
            v: Vec3::Y * 9.0,
        };
        add_surface(&mut scene, Surface::Rectangle(rectangle), veil.clone());
    }
    let seen = look(&scene, &eye(Vec3::Z * 5.0, Vec3::ZERO), &ray_cast());
    close(seen, Vec3::new(0.25 + 0.75 * 0.25, 0.0, 0.75 * 0.75));
    add_surface(
        &mut scene,
        Surface::Plane(Plane {
            point: Vec3::NEG_Z,
            normal: Vec3::Z,
        }),
        matte(Vec3::ONE),
    );
    scene.lights.push(sun(Vec3::NEG_Z, PI));
    let lit = look(
        &scene,
        &eye(Vec3::new(0.0, 0.5, -0.5), Vec3::new(0.0, 0.0, -1.0)),
        &ray_cast(),
    );
    close(lit, Vec3::splat(0.75 * 0.75));
}

/// A masked texel is a hole, for eyes and for light.
#[test]
fn mask_makes_holes() {
    let mut scene = Scene {
        environment: sky(Vec3::Z),
        ..Scene::default()
    };
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let mesh = Mesh {
        positions: corners.iter().map(|&[x, y]| Vec3::new(x, y, 0.0)).collect(),
        // Opaque on the left, clear on the right.
        colors: corners
            .iter()
            .map(|&[x, _]| Vec4::new(1.0, 1.0, 1.0, 0.5 - 0.5 * x))
            .collect(),
        indices: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let material = Material {
        base_color: Vec3::ZERO,
        emission: Vec3::X,
        ior: 1.0,
        alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
        ..Material::default()
    };
    add_mesh(&mut scene, mesh, material);
    let at = |x: f32| {
        look(
            &scene,
            &eye(Vec3::new(x, 0.3, 3.0), Vec3::new(x, 0.3, 0.0)),
            &ray_cast(),
        )
    };
    close(at(-0.5), Vec3::X);
    close(at(0.5), Vec3::Z);
}
