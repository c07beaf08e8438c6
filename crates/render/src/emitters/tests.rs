//! All kinds of lights in one scene: each is chosen as often as it says, and both ways of asking for a density agree.

use super::*;
use crate::{
    DirectionalLight, Instance, Light, Material, MaterialId, Mesh, MeshId, PixelSampler,
    PointLight, SpotLight, SurfaceId,
};
use std::{collections::BTreeMap, f32::consts::TAU};
use umbriel_kernels::{
    Disk, Rectangle, Sphere, Surface,
    glam::{Affine3A, Quat},
};

const SAMPLES: u32 = 1_000_000;

/// Independent numbers.
fn random(i: u32, pair: u32) -> Vec2 {
    PixelSampler::new(i & 1023, i >> 10, u32::MAX, 5).pair(0, pair)
}

fn lamp(scene: &mut Scene, geometry: Geometry, radiance: f32) {
    scene.materials.push(Material {
        emission: Vec3::splat(radiance),
        double_sided: true,
        ..Material::default()
    });
    let turn = Quat::from_rotation_x(0.3);
    scene.instances.push(Instance {
        name: String::new(),
        geometry,
        transform: Affine3A::from_rotation_translation(turn, Vec3::new(0.5, 2.0, -1.0)),
        material: MaterialId(scene.materials.len() as u32 - 1),
        inside_out: false,
    });
}

fn lights() -> Vec<Light> {
    let point = PointLight {
        name: String::new(),
        position: Vec3::new(-2.0, 3.0, 0.0),
        intensity: Vec3::splat(4.0),
        range: f32::INFINITY,
        diameter: 0.0,
    };
    let ball = PointLight {
        position: Vec3::new(2.0, 1.0, 4.0),
        diameter: 0.8,
        ..point.clone()
    };
    let spot = SpotLight {
        name: String::new(),
        position: Vec3::new(0.0, 5.0, 1.0),
        direction: Vec3::NEG_Y,
        intensity: Vec3::splat(9.0),
        range: f32::INFINITY,
        inner_angle: 0.3,
        outer_angle: 0.8,
        diameter: 0.0,
    };
    let sun = |angle: f32| {
        Light::Directional(DirectionalLight {
            name: String::new(),
            direction: Vec3::new(0.48, -0.8, 0.36),
            illuminance: Vec3::ONE,
            angle,
        })
    };
    vec![
        Light::Point(point),
        sun(0.0),
        Light::Point(ball),
        Light::Spot(spot),
        sun(0.6),
    ]
}

/// Lights without extent and with one, lamps of each shape, one of them a mesh with a triangle without area, and a bright map around.
fn all_lights() -> Scene {
    let mut scene = Scene {
        lights: lights(),
        ..Scene::default()
    };
    scene.surfaces = vec![
        Surface::Sphere(Sphere {
            center: Vec3::new(0.0, 1.0, 2.0),
            radius: 0.5,
        }),
        Surface::Rectangle(Rectangle {
            center: Vec3::X,
            u: Vec3::X,
            v: 0.5 * Vec3::Z,
        }),
        Surface::Disk(Disk {
            center: Vec3::NEG_X,
            normal: Vec3::Y,
            radius: 0.7,
        }),
    ];
    for i in 0..3 {
        lamp(&mut scene, Geometry::Surface(SurfaceId(i)), 2.0 + i as f32);
    }
    scene.meshes.push(Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Z, Vec3::new(-1.0, 1.0, 1.0)],
        indices: vec![[0, 1, 2], [1, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    });
    lamp(&mut scene, Geometry::Mesh(MeshId(0)), 3.0);
    let texels = (0..32).map(|i| Vec3::splat(if i == 11 { 50.0 } else { 0.5 }));
    scene.surround(EnvironmentMap::new(8, 4, texels.collect(), 0.3).expect("texels"));
    scene
}

/// Pearson's statistic, in standard deviations from its mean (Wilson & Hilferty 1931), of counts that are expected to be many.
fn deviations(pairs: &[(f64, f64)]) -> f64 {
    let sum: f64 = pairs.iter().map(|(n, e)| (n - e).powi(2) / e).sum();
    let k = f64::max(pairs.len() as f64 - 1.0, 1.0);
    let spread = 2.0 / (9.0 * k);
    ((sum / k).cbrt() - (1.0 - spread)) / spread.sqrt()
}

#[test]
fn lights_are_chosen_as_often_as_they_say() {
    let scene = all_lights();
    let emitters = Emitters::new(&scene);
    for (p, n) in [
        (Vec3::ZERO, Some(Vec3::Y)),
        (Vec3::new(9.0, 1.0, 0.0), None),
    ] {
        let mut found: BTreeMap<(u8, u32), (f64, f64)> = BTreeMap::new();
        let mut nothing = 0.0;
        for i in 0..SAMPLES {
            let Some(chosen) = emitters.choose(p, n, random(i, 0).x) else {
                nothing += 1.0;
                continue;
            };
            let key = match chosen.light {
                Choice::Sky => (0, 0),
                Choice::Parallel(number) => (1, number),
                Choice::Placed(number) => (2, number),
            };
            let stated = f64::from(chosen.probability);
            let entry = found.entry(key).or_insert((0.0, stated));
            entry.0 += 1.0;
            assert!((entry.1 / stated - 1.0).abs() < 1e-4, "{key:?}");
        }
        let total: f64 = found.values().map(|(_, stated)| stated).sum();
        let count = f64::from(SAMPLES);
        assert!((total + nothing / count - 1.0).abs() < 2e-3, "{total}");
        let pairs: Vec<_> = found.values().map(|(n, p)| (*n, p * count)).collect();
        assert!(found.len() >= 9 && deviations(&pairs) < 5.0, "{found:?}");
    }
}

/// Where a ray could meet what was aimed at, the density that the ray would ask for is that with which it was aimed at.
#[test]
fn densities_are_those_of_the_samples() {
    let scene = all_lights();
    let emitters = Emitters::new(&scene);
    let mut seen = [0; 2];
    for i in 0..120_000 {
        let p = 4.0 * (random(i, 1).extend(random(i, 2).x) - Vec3::splat(0.5));
        let n = (i % 2 == 0).then_some(Vec3::new(0.0, 0.6, 0.8));
        let Some(chosen) = emitters.choose(p, n, random(i, 0).x) else {
            continue;
        };
        let Some(ray) = emitters.aim(&scene, p, chosen, random(i, 3)) else {
            continue;
        };
        let stated = match chosen.light {
            Choice::Sky => emitters.sky_pdf(&scene, ray.wi),
            Choice::Placed(number) => {
                let placed = &emitters.placed[number as usize];
                if placed.instance == u32::MAX {
                    // No other ray meets it.
                    assert_eq!(ray.pdf, f32::INFINITY);
                    continue;
                }
                emitters.pdf(placed.instance, placed.primitive, p, n, ray.to_light)
            }
            Choice::Parallel(_) => continue,
        };
        let is_sky = matches!(chosen.light, Choice::Sky);
        seen[usize::from(is_sky)] += 1;
        let ratio = ray.pdf / stated;
        assert!((ratio - 1.0).abs() < 0.02, "{i}: {p} {chosen:?} {ratio}");
    }
    assert!(seen[0] > 10_000 && seen[1] > 10_000, "{seen:?}");
}

/// Directions fill the cone of a sun evenly, and the radiance over their density is the illuminance over the probability.
#[test]
fn suns_fill_their_cones() {
    for degrees in [0.53_f32, 20.0, 120.0] {
        let direction = Vec3::new(0.48, -0.8, 0.36);
        let half = 0.5 * degrees.to_radians();
        let light = Light::Directional(DirectionalLight {
            name: String::new(),
            direction,
            illuminance: Vec3::splat(2.0),
            angle: 2.0 * half,
        });
        let (x, y) = (-direction).any_orthonormal_pair();
        let mut counts = vec![0.0; 16 * 32];
        for i in 0..SAMPLES {
            let ray = light_ray(&light, Vec3::splat(7.0), 0.5, random(i, 0)).expect("light");
            let expected = 2.0 / 0.5 * (TAU * (1.0 - half.cos())) / (PI * half.sin().powi(2));
            assert!((ray.radiance.x / expected - 1.0).abs() < 1e-2, "{degrees}");
            // Rings of equal solid angle, by the chord: 1 − cos θ = c²/2.
            let chord2 = (ray.wi + direction).length_squared();
            let ring = (chord2 / (4.0 * (0.5 * half).sin().powi(2)) * 16.0) as usize;
            let ring = ring.min(15);
            let turn = (ray.wi.dot(y).atan2(ray.wi.dot(x)) / TAU).rem_euclid(1.0);
            counts[ring * 32 + ((turn * 32.0) as usize).min(31)] += 1.0;
        }
        let expected = f64::from(SAMPLES) / counts.len() as f64;
        let pairs: Vec<_> = counts.iter().map(|&n| (n, expected)).collect();
        let z = deviations(&pairs);
        assert!(z < 5.0, "{degrees}: {z}");
    }
}
