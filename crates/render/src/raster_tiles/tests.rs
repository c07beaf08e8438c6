//! Whole pictures by patches against the way that takes any hits.

use super::*;
use crate::{
    Bias, Checker, Control, DirectionalLight, Environment, Geometry, Instance, Light, Material,
    MaterialId, Mesh, MeshId, Method, PointLight, Scene, Settings, ShadowMapSettings, Texture,
    TextureId, TextureRef, Tonemap, develop, render_bytes_into, render_with_maps,
};
use std::sync::atomic::AtomicBool;
use umbriel_kernels::glam::{Affine2, Affine3A, Vec2};

/// A hilly square of two `size²` triangles, with or without normals.
fn hills(size: u32, with_normals: bool) -> Mesh {
    let at = |i: u32, j: u32| {
        let (x, z) = (i as f32 / size as f32 - 0.5, j as f32 / size as f32 - 0.5);
        let (y, dx) = (0.1 * (12.0 * x).sin(), 1.2 * (12.0 * x).cos());
        (Vec3::new(x, y, z), Vec3::new(-dx, 1.0, 0.0).normalize())
    };
    let corners = (0..=size).flat_map(|j| (0..=size).map(move |i| (i, j)));
    let (positions, normals): (Vec<_>, Vec<_>) = corners.map(|(i, j)| at(i, j)).unzip();
    let squares = (0..size).flat_map(|j| (0..size).map(move |i| j * (size + 1) + i));
    let indices = squares.flat_map(|a| {
        let (b, c, d) = (a + 1, a + size + 1, a + size + 2);
        [[a, c, b], [b, c, d]]
    });
    Mesh {
        uvs: [
            positions.iter().map(|p| Vec2::new(p.x, p.z)).collect(),
            Vec::new(),
        ],
        indices: indices.collect(),
        normals: if with_normals { normals } else { Vec::new() },
        positions,
        ..Mesh::default()
    }
}

/// Hills over and within each other: smooth and flat, moved and mirrored, textured, seen from both sides, before the sky.
fn scene() -> Scene {
    let checker = Material {
        base_color_texture: Some(TextureRef {
            texture: TextureId(0),
            uv_set: 0,
            transform: Affine2::from_scale(Vec2::splat(8.0)),
        }),
        ..Material::default()
    };
    let rough = Material {
        base_color: Vec3::new(0.7, 0.5, 0.3),
        emission: Vec3::new(0.01, 0.0, 0.02),
        double_sided: true,
        ..Material::default()
    };
    let mut scene = Scene {
        meshes: vec![hills(40, true), hills(7, false)],
        materials: vec![rough, checker],
        textures: vec![Texture::Checker(Checker {
            even: Vec3::new(0.2, 0.3, 0.4).extend(1.0),
            odd: Vec3::new(0.9, 0.8, 0.7).extend(1.0),
        })],
        environment: Environment {
            zenith: Vec3::new(0.2, 0.3, 0.5),
            nadir: Vec3::splat(0.1),
            ambient: None,
            map: None,
        },
        lights: vec![
            Light::Directional(DirectionalLight {
                name: String::new(),
                direction: Vec3::new(0.3, -0.8, 0.2).normalize(),
                illuminance: Vec3::new(2.0, 1.9, 1.5),
                angle: 0.0,
            }),
            Light::Point(PointLight {
                name: String::new(),
                position: Vec3::new(0.5, 1.0, 1.0),
                intensity: Vec3::ONE,
                range: f32::INFINITY,
                diameter: 0.0,
            }),
        ],
        ..Scene::default()
    };
    for i in 0..6 {
        let turned = Affine3A::from_rotation_z(0.6 * i as f32)
            * Affine3A::from_scale(Vec3::new(
                2.0,
                1.0 + i as f32,
                if i == 4 { -2.0 } else { 2.0 },
            ));
        scene.instances.push(Instance {
            name: String::new(),
            geometry: Geometry::Mesh(MeshId(i % 2)),
            transform: if i == 0 { Affine3A::IDENTITY } else { turned },
            material: MaterialId(i / 2 % 2),
            inside_out: i == 5,
        });
    }
    scene
}

fn settings(resolution: [u32; 2], filter: &str) -> Settings {
    let map = ShadowMapSettings {
        resolution: 256,
        bias: Bias::default(),
        filter: filter.parse().unwrap(),
        ..ShadowMapSettings::default()
    };
    Settings {
        method: Method::ShadowMap,
        resolution,
        shadow_maps: vec![map; 2],
        ..Settings::default()
    }
}

/// The bits of one sample of each pixel, by patches or not.
fn sample(
    bvh: &SceneBvh,
    camera: &Camera,
    settings: &Settings,
    place: Vec2,
    by_patches: bool,
) -> (Vec<[u32; 4]>, Stats) {
    let maps = ShadowMaps::render(bvh, camera, settings, false);
    let control = Control {
        stop: &AtomicBool::new(false),
        progress: &|_, _| (),
    };
    let job = Job::new(camera, settings, &control);
    let reach = Extent::of(bvh).reach(camera.pose.translation.into());
    let mut eye = EyeRaster::new(bvh, camera, settings.resolution, place, reach);
    if !by_patches {
        eye.forget_plain();
    }
    let raster = eye.raster(least_w(camera, reach));
    let exposure = Exposure {
        eye: &eye,
        raster: &raster,
        job: &job,
    };
    let [width, height] = settings.resolution.map(|side| side as usize);
    let mut pixels = vec![[0.0; 4]; width * height];
    let idle = Mutex::new(Vec::new());
    let mut stats = Stats::default();
    for mut tile in picture_tiles(&raster, &job, &mut pixels) {
        stats = stats
            + with_worker(&idle, bvh, &job, Some(&maps), |worker| {
                exposure.add_sample(&mut tile, worker, true)
            });
    }
    let bits = pixels.iter().map(|pixel| pixel.map(f32::to_bits));
    (bits.collect(), stats)
}

#[test]
fn patches_equal_the_general_way_to_the_bit() {
    let scene = scene();
    let bvh = SceneBvh::build(&scene);
    let camera = Camera::look_at("", Vec3::new(0.4, 1.4, 2.2), Vec3::ZERO, Vec3::Y, 1.0);
    let orthographic = Camera {
        projection: crate::Projection::Orthographic { half_height: 1.2 },
        ..camera.clone()
    };
    for (camera, resolution, filter, place) in [
        (&camera, [261, 157], "pcf:3", Vec2::new(0.3, 0.7)),
        (&camera, [128, 64], "hard", Vec2::splat(0.5)),
        (&orthographic, [130, 67], "vogel:5:2", Vec2::splat(0.5)),
    ] {
        let settings = settings(resolution, filter);
        let (fast, fast_stats) = sample(&bvh, camera, &settings, place, true);
        let (slow, slow_stats) = sample(&bvh, camera, &settings, place, false);
        assert!(fast == slow, "{resolution:?} {filter}");
        assert_eq!(fast_stats, slow_stats);
        assert!(fast_stats.shadow_rays > u64::from(resolution[0] * resolution[1]) / 4);
    }
}

#[test]
fn bytes_are_those_of_the_developed_film() {
    let scene = scene();
    let bvh = SceneBvh::build(&scene);
    let camera = Camera::look_at("", Vec3::new(0.4, 1.4, 2.2), Vec3::ZERO, Vec3::Y, 1.0);
    let control = Control {
        stop: &AtomicBool::new(false),
        progress: &|_, _| (),
    };
    let mut bytes = Vec::new();
    for (exposure, tonemap) in [
        (0.0, Tonemap::Linear),
        (0.5, Tonemap::Linear),
        (1.0, Tonemap::Aces),
    ] {
        let settings = settings([261, 157], "pcf:3");
        let maps = ShadowMaps::render(&bvh, &camera, &settings, false);
        let film = render_with_maps(&bvh, &camera, &settings, Some(&maps), &control);
        let development = Development { exposure, tonemap };
        let stats = render_bytes_into(
            &bvh,
            &camera,
            &settings,
            Some(&maps),
            &control,
            &development,
            &mut bytes,
        );
        assert_eq!(stats, film.stats);
        assert!(bytes == develop(&film.image, exposure, tonemap));
    }
}
