//! The scenes of the experiments with shadow maps: 25 tori over a ground, with boxes and thin walls that stand on it; and what such tests share.

use super::{Random, add_mesh, add_surface, sky};
use std::f32::consts::TAU;
use umbriel_render::{
    Camera, DirectionalLight, Film, Light, Material, Mesh, Method, Scene, Settings,
    ShadowMapSettings, SpotLight,
    kernels::{
        Cuboid, Plane, Sphere, Surface, Torus,
        glam::{Affine3A, Quat, Vec3},
    },
};

/// About 100,000 triangles.
pub(crate) const SEGMENTS: [u32; 2] = [64, 31];

/// The rings of a torus around z, major radius 1, minor radius 0.42.
fn torus([u, v]: [u32; 2]) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..u * v {
        let (a, b) = (
            TAU * (i / v) as f32 / u as f32,
            TAU * (i % v) as f32 / v as f32,
        );
        let n = Vec3::new(a.cos() * b.cos(), a.sin() * b.cos(), b.sin());
        mesh.positions
            .push(Vec3::new(a.cos(), a.sin(), 0.0) + 0.42 * n);
        mesh.normals.push(n);
        let at = |x: u32, y: u32| (x % u) * v + y % v;
        let (x, y) = (i / v, i % v);
        mesh.indices
            .push([at(x, y), at(x + 1, y), at(x + 1, y + 1)]);
        mesh.indices
            .push([at(x, y), at(x + 1, y + 1), at(x, y + 1)]);
    }
    mesh
}

/// A box that stands on the ground.
pub(crate) fn cuboid(half: Vec3, turn: Quat, at: Vec3) -> Mesh {
    let corner = |k: u32| {
        let side = |axis: u32| if k >> axis & 1 == 0 { -1.0 } else { 1.0 };
        at + turn * (half * Vec3::new(side(0), 1.0 + side(1), side(2)) * Vec3::new(1.0, 0.5, 1.0))
    };
    let quad = |a, b, c, d| [[a, b, c], [a, c, d]];
    Mesh {
        positions: (0..8).map(corner).collect(),
        indices: [
            quad(0, 2, 3, 1),
            quad(4, 5, 7, 6),
            quad(0, 1, 5, 4),
            quad(2, 6, 7, 3),
            quad(0, 4, 6, 2),
            quad(1, 3, 7, 5),
        ]
        .concat(),
        ..Mesh::default()
    }
}

/// The scene, with smooth normals or flat ones.
pub(crate) fn tori(segments: [u32; 2], boxes: bool) -> Scene {
    let mut scene = Scene::default();
    let ring = torus(segments);
    for k in 0..25_u32 {
        let turn = Quat::from_rotation_y(0.7 * k as f32);
        let at = Vec3::new(
            (k % 5) as f32 * 3.6 - 7.2,
            1.45 + 0.5 * (k % 3) as f32,
            (k / 5) as f32 * 3.6 - 7.2,
        );
        let mut mesh = ring.clone();
        mesh.positions.iter_mut().for_each(|p| *p = turn * *p + at);
        mesh.normals.iter_mut().for_each(|n| *n = turn * *n);
        add_mesh(&mut scene, mesh, Material::default());
    }
    let ground = |x: f32, z: f32| Vec3::new(12.0 * x, 0.0, 12.0 * z);
    let ground = Mesh {
        positions: vec![
            ground(-1.0, -1.0),
            ground(-1.0, 1.0),
            ground(1.0, 1.0),
            ground(1.0, -1.0),
        ],
        indices: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    add_mesh(&mut scene, ground, Material::default());
    let mut random = Random(1);
    for k in 0..if boxes { 200 } else { 0 } {
        let mut half = Vec3::new(
            random.range(0.05, 0.3),
            random.range(0.1, 0.8),
            random.range(0.05, 0.3),
        );
        if k % 3 == 0 {
            half.x = 0.02;
        }
        let turn = Quat::from_rotation_y(random.range(0.0, TAU));
        let at = Vec3::new(random.range(-11.0, 11.0), 0.0, random.range(-11.0, 11.0));
        add_mesh(&mut scene, cuboid(half, turn, at), Material::default());
    }
    scene.lights.push(Light::Directional(DirectionalLight {
        name: String::new(),
        direction: -Vec3::new(8.0, 14.0, 6.0).normalize(),
        illuminance: Vec3::splat(3.0),
        angle: 0.0,
    }));
    scene
}

/// The eye of the experiments.
pub(crate) fn camera() -> Camera {
    Camera::look_at(
        "eye",
        Vec3::new(0.0, 9.0, 15.0),
        Vec3::new(0.0, 0.5, 0.0),
        Vec3::Y,
        50_f32.to_radians(),
    )
}

pub(crate) fn settings(map: ShadowMapSettings) -> Settings {
    Settings {
        method: Method::ShadowMap,
        resolution: [320, 240],
        shadow_maps: vec![map],
        ..Settings::default()
    }
}

pub(crate) fn look_at(eye: Vec3, target: Vec3) -> Camera {
    Camera::look_at("eye", eye, target, Vec3::new(0.1, 1.0, 0.2), 1.0)
}

pub(crate) fn square(half: f32, y: f32) -> Mesh {
    let corner = |x: f32, z: f32| Vec3::new(half * x, y, half * z);
    Mesh {
        positions: vec![
            corner(-1.0, -1.0),
            corner(-1.0, 1.0),
            corner(1.0, 1.0),
            corner(1.0, -1.0),
        ],
        indices: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

pub(crate) fn spot(position: Vec3, direction: Vec3, outer_angle: f32) -> Light {
    Light::Spot(SpotLight {
        name: String::new(),
        position,
        direction: direction.normalize(),
        intensity: Vec3::ONE,
        range: f32::INFINITY,
        inner_angle: 0.1,
        outer_angle,
        diameter: 0.0,
    })
}

/// The share of pixels whose colour differs at all, or by more than a share of it.
pub(crate) fn differing(a: &Film, b: &Film, tolerance: f32) -> f32 {
    let differ = |(a, b): &(&[f32; 4], &[f32; 4])| {
        (0..3).any(|k| (a[k] - b[k]).abs() > tolerance * a[k].abs().max(b[k].abs()))
    };
    let pairs = a.image.pixels.iter().zip(&b.image.pixels);
    pairs.filter(differ).count() as f32 / a.image.pixels.len() as f32
}

/// Rings, boxes, and one of each analytic surface.
pub(crate) fn mixed() -> Scene {
    let mut scene = tori([32, 16], true);
    let v = Vec3::new;
    let surfaces = [
        Surface::Sphere(Sphere {
            center: v(2.0, 1.0, 9.0),
            radius: 0.8,
        }),
        Surface::Torus(Torus {
            center: v(-2.0, 1.0, 9.0),
            axis: v(0.3, 1.0, 0.1),
            major_radius: 0.8,
            minor_radius: 0.3,
        }),
        Surface::Cuboid(Cuboid {
            min: v(5.0, 0.0, 8.0),
            max: v(6.0, 1.0, 9.0),
        }),
        Surface::Plane(Plane {
            point: v(0.0, -0.5, 0.0),
            normal: Vec3::Y,
        }),
    ];
    for surface in surfaces {
        add_surface(&mut scene, surface, Material::default());
    }
    let last = scene.instances.len() - 4;
    scene.instances[last].transform = Affine3A::from_scale(v(1.0, 1.3, 0.9));
    scene.environment = sky(Vec3::splat(0.1));
    scene
}
