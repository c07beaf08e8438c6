//! Small scenes and random numbers for the tests.
#![allow(dead_code, reason = "each test program uses its own part")]

pub(crate) mod brute_force;
pub(crate) mod path_scene;
pub(crate) mod shadow_scene;
pub(crate) mod shadow_truth;
pub(crate) mod z_test;

use std::sync::atomic::AtomicBool;
use umbriel_render::{
    Camera, Control, DirectionalLight, Environment, Film, Geometry, Instance, Light, Material,
    MaterialId, Mesh, MeshId, Method, PointLight, Scene, SceneBvh, Settings, SurfaceId,
    kernels::{
        Plane, Surface,
        glam::{Affine3A, Vec3},
        mix_bits,
    },
    render,
};

/// Adds a surface of its own material to a scene.
pub(crate) fn add_surface(scene: &mut Scene, surface: Surface, material: Material) {
    scene.surfaces.push(surface);
    let geometry = Geometry::Surface(SurfaceId(scene.surfaces.len() as u32 - 1));
    add_instance(scene, geometry, material, Affine3A::IDENTITY);
}

/// Adds a mesh of its own material to a scene.
pub(crate) fn add_mesh(scene: &mut Scene, mesh: Mesh, material: Material) {
    scene.meshes.push(mesh);
    let geometry = Geometry::Mesh(MeshId(scene.meshes.len() as u32 - 1));
    add_instance(scene, geometry, material, Affine3A::IDENTITY);
}

pub(crate) fn add_instance(
    scene: &mut Scene,
    geometry: Geometry,
    material: Material,
    transform: Affine3A,
) {
    scene.materials.push(material);
    scene.instances.push(Instance {
        name: String::new(),
        geometry,
        transform,
        material: MaterialId(scene.materials.len() as u32 - 1),
        inside_out: false,
    });
}

/// Renders without anybody watching.
pub(crate) fn draw(scene: &Scene, camera: &Camera, settings: &Settings) -> Film {
    scene.validate().expect("test scenes are valid");
    let control = Control {
        stop: &AtomicBool::new(false),
        progress: &|_, _| {},
    };
    render(&SceneBvh::build(scene), camera, settings, &control)
}

/// The radiance in the middle of a picture of one pixel.
pub(crate) fn look(scene: &Scene, camera: &Camera, settings: &Settings) -> Vec3 {
    let settings = Settings {
        resolution: [1, 1],
        ..settings.clone()
    };
    let [r, g, b, _] = draw(scene, camera, &settings).image.pixels[0];
    Vec3::new(r, g, b)
}

/// A small generator for tests: SplitMix64, [`mix_bits`] of a counter.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn bits(&mut self) -> u64 {
        let bits = mix_bits(self.0);
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        bits
    }

    /// In `[0, 1)`.
    pub(crate) fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1 << 24) as f32
    }

    pub(crate) fn range(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// Equally likely on every logarithmic scale.
    pub(crate) fn log_range(&mut self, low: f32, high: f32) -> f32 {
        self.range(low.ln(), high.ln()).exp()
    }

    pub(crate) fn vec3(&mut self, low: f32, high: f32) -> Vec3 {
        Vec3::new(
            self.range(low, high),
            self.range(low, high),
            self.range(low, high),
        )
    }

    /// Uniform on the unit sphere.
    pub(crate) fn direction(&mut self) -> Vec3 {
        let z = self.range(-1.0, 1.0);
        let (sin, cos) = self.range(0.0, std::f32::consts::TAU).sin_cos();
        let r = (1.0 - z * z).max(0.0).sqrt();
        Vec3::new(r * cos, r * sin, z)
    }
}

/// Rounding of f32 through a whole picture.
const TOLERANCE: f32 = 2e-5;

pub(crate) fn close(a: Vec3, b: Vec3) {
    assert!(
        (a - b).abs().max_element() <= TOLERANCE * (1.0 + b.max_element()),
        "{a} should be {b}"
    );
}

pub(crate) fn matte(color: Vec3) -> Material {
    // An index of refraction of 1 reflects nothing but at grazing angles (Schlick's fifth power), where no test looks.
    Material {
        base_color: color,
        ior: 1.0,
        ..Material::default()
    }
}

pub(crate) fn floor() -> Surface {
    Surface::Plane(Plane {
        point: Vec3::ZERO,
        normal: Vec3::Y,
    })
}

pub(crate) fn point_light(position: Vec3, intensity: f32) -> Light {
    Light::Point(PointLight {
        name: String::new(),
        position,
        intensity: Vec3::splat(intensity),
        range: f32::INFINITY,
        diameter: 0.0,
    })
}

pub(crate) fn sun(direction: Vec3, illuminance: f32) -> Light {
    Light::Directional(DirectionalLight {
        name: String::new(),
        direction: direction.normalize(),
        illuminance: Vec3::splat(illuminance),
        angle: 0.0,
    })
}

pub(crate) fn sky(radiance: Vec3) -> Environment {
    Environment {
        zenith: radiance,
        nadir: radiance,
        ambient: Some(Vec3::ZERO),
        map: None,
    }
}

pub(crate) fn eye(from: Vec3, to: Vec3) -> Camera {
    Camera::look_at("eye", from, to, Vec3::new(0.1, 0.2, 1.0), 1e-3)
}

pub(crate) fn ray_cast() -> Settings {
    Settings {
        method: Method::RayCast,
        ..Settings::default()
    }
}
