//! Why shadow maps are wrong: scenes that hold one fault each, and the sums.

mod support;

use std::{collections::HashSet, sync::atomic::AtomicBool};
use support::{
    add_mesh, add_surface, draw, floor, matte,
    shadow_scene::{camera, cuboid, look_at, mixed, square, tori},
    sun,
};
use umbriel_render::{
    Camera, Cause, Control, Image, LightErrors, LightTruth, Material, Mesh, Method, Scene,
    SceneBvh, SeenPoints, Settings, ShadowMapSettings, ShadowMaps, TruthSettings,
    kernels::{
        Sphere, Surface,
        glam::{Affine3A, Quat, Vec3},
    },
    truth_picture,
};

const SIZE: [u32; 2] = [320, 240];
/// Differences that count, in fractions of the light.
const TOLERANCE: f32 = 0.1;

fn map(text: &str) -> ShadowMapSettings {
    let [resolution, bias, filter, size] = text.split(' ').collect::<Vec<_>>()[..] else {
        panic!("{text}")
    };
    ShadowMapSettings {
        resolution: resolution.parse().unwrap(),
        bias: bias.parse().unwrap(),
        filter: filter.parse().unwrap(),
        light_size: size.parse().unwrap(),
        ..ShadowMapSettings::default()
    }
}

fn settings(map: ShadowMapSettings) -> Settings {
    Settings {
        method: Method::ShadowMap,
        resolution: SIZE,
        shadow_maps: vec![map; 4],
        ..Settings::default()
    }
}

fn watch<T>(work: impl FnOnce(&Control) -> T) -> T {
    work(&Control {
        stop: &AtomicBool::new(false),
        progress: &|_, _| {},
    })
}

struct Found {
    seen: SeenPoints,
    truth: LightTruth,
    errors: LightErrors,
}

fn find(scene: &Scene, camera: &Camera, settings: &Settings) -> Found {
    scene.validate().unwrap();
    let bvh = SceneBvh::build(scene);
    let maps = ShadowMaps::render(&bvh, camera, settings, true);
    let seen = SeenPoints::find(&bvh, camera, settings);
    let size = settings.shadow_maps[0].light_size;
    let how = TruthSettings {
        glass_shadows: settings.glass(),
        ..TruthSettings::default()
    };
    let truth = watch(|control| LightTruth::trace(&bvh, &seen, 0, size, &how, control));
    let glass = settings.glass();
    let errors = LightErrors::find(&bvh, &maps, &seen, &truth, glass, TOLERANCE);
    Found {
        seen,
        truth,
        errors,
    }
}

/// Holds that at least 99 of 100 wrong pixels, and at least `least` of them, have one cause.
fn all_are(cause: Cause, least: usize, scene: &Scene, camera: &Camera, map: ShadowMapSettings) {
    let found = find(scene, camera, &settings(map)).errors;
    let counts = Cause::ALL.map(|c| (c, found.count(c, true), found.count(c, false)));
    println!("{cause:?}: {counts:?} of {}", found.answers.len());
    let right = found.count(cause, true) + found.count(cause, false);
    assert!(
        right >= least && 100 * right >= 99 * found.wrong.len(),
        "{cause:?}: {counts:?}"
    );
    let sum: usize = counts.iter().map(|c| c.1 + c.2).sum();
    assert_eq!(sum, found.wrong.len());
}

fn lit_by_sun(direction: Vec3) -> Scene {
    Scene {
        lights: vec![sun(direction, 3.0)],
        ..Scene::default()
    }
}

#[test]
fn acne_on_a_tilted_plane() {
    let mut scene = lit_by_sun(Vec3::new(-0.7, -0.6, -0.2));
    add_mesh(&mut scene, square(5.0, 0.0), Material::default());
    scene.instances[0].transform = Affine3A::from_quat(Quat::from_rotation_x(0.3));
    let camera = look_at(Vec3::new(1.0, 6.0, 7.0), Vec3::ZERO);
    for filter in [
        "hard",
        "pcf:3",
        "bilinear:2",
        "vogel:9:2",
        "pcss:16",
        "evsm:1",
    ] {
        let map = map(&format!("256 none {filter} 0"));
        all_are(Cause::Acne, 1000, &scene, &camera, map);
    }
}

#[test]
fn acne_on_curved_surfaces() {
    let mut ball = lit_by_sun(Vec3::new(-0.7, -0.6, -0.2));
    let sphere = Sphere {
        center: Vec3::Y,
        radius: 2.0,
    };
    add_surface(&mut ball, Surface::Sphere(sphere), Material::default());
    let camera = look_at(Vec3::new(3.0, 5.0, 5.0), Vec3::Y);
    all_are(Cause::Acne, 1000, &ball, &camera, map("128 none hard 0"));
    // From within: a bowl, which rises above the planes of its points.
    let mut bowl = lit_by_sun(Vec3::new(-0.2, -0.9, -0.1));
    let height = |i: u32| i as f32 / 10.0 - 2.0;
    let corners = (0..41 * 41).map(|k| (height(k % 41), height(k / 41)));
    let at = |x: u32, z: u32| 41 * z + x;
    let cells = (0..1600).map(|k| (k % 40, k / 40));
    let halves = cells.flat_map(|(x, z)| {
        let [a, b, c, d] = [at(x, z), at(x, z + 1), at(x + 1, z + 1), at(x + 1, z)];
        [[a, b, c], [a, c, d]]
    });
    let paraboloid = Mesh {
        positions: corners
            .map(|(x, z)| Vec3::new(x, 0.2 * (x * x + z * z), z))
            .collect(),
        indices: halves.collect(),
        ..Mesh::default()
    };
    add_mesh(&mut bowl, paraboloid, Material::default());
    let camera = look_at(Vec3::new(1.0, 6.0, 1.0), Vec3::ZERO);
    all_are(Cause::Acne, 300, &bowl, &camera, map("64 none hard 0"));
}

/// A wall of 4 cm; the eye looks at its shadow on the ground where it stands, and nowhere near the shadow's end.
#[test]
fn peter_panning_under_a_thin_wall() {
    let mut scene = lit_by_sun(Vec3::new(0.0, -0.5, -0.9));
    add_surface(&mut scene, floor(), Material::default());
    let wall = cuboid(Vec3::new(30.0, 2.0, 0.02), Quat::IDENTITY, Vec3::ZERO);
    add_mesh(&mut scene, wall, Material::default());
    let camera = Camera::look_at(
        "eye",
        Vec3::new(0.3, 3.0, -5.0),
        Vec3::new(0.0, 0.0, -0.8),
        Vec3::Y,
        0.5,
    );
    for filter in ["hard", "pcf:3", "bilinear:2"] {
        let map = map(&format!("1024 constant:0.6m {filter} 0"));
        all_are(Cause::Leak, 1000, &scene, &camera, map);
    }
}

/// A closed box around the eye, with thin walls: inside it is dark, but where a bias reaches through the walls at the corners.
#[test]
fn a_leak_at_a_corner() {
    let mut scene = lit_by_sun(Vec3::new(-0.6, -0.7, -0.4));
    let slabs = [
        (Vec3::new(3.1, 0.04, 3.1), Vec3::new(0.0, 0.0, 0.0)),
        (Vec3::new(3.1, 0.04, 3.1), Vec3::new(0.0, 3.0, 0.0)),
        (Vec3::new(0.02, 3.04, 3.1), Vec3::new(3.0, 0.0, 0.0)),
        (Vec3::new(0.02, 3.04, 3.1), Vec3::new(-3.0, 0.0, 0.0)),
        (Vec3::new(3.1, 3.04, 0.02), Vec3::new(0.0, 0.0, 3.0)),
        (Vec3::new(3.1, 3.04, 0.02), Vec3::new(0.0, 0.0, -3.0)),
    ];
    for (half, at) in slabs {
        add_mesh(
            &mut scene,
            cuboid(half, Quat::IDENTITY, at),
            Material::default(),
        );
    }
    let camera = look_at(Vec3::new(-1.0, 1.5, -1.0), Vec3::new(3.0, 0.3, 3.0));
    all_are(
        Cause::Leak,
        100,
        &scene,
        &camera,
        map("512 constant:0.3m hard 0"),
    );
    all_are(
        Cause::Leak,
        100,
        &scene,
        &camera,
        map("512 slope-scaled:12 hard 0"),
    );
}

#[test]
fn edges_alone() {
    let mut scene = lit_by_sun(Vec3::new(-0.5, -0.8, -0.3));
    add_surface(&mut scene, floor(), Material::default());
    for k in 0..5 {
        let (turn, at) = (k as f32, Vec3::new(2.0 * k as f32 - 4.0, 1.0, 0.0));
        let slab = cuboid(Vec3::new(0.7, 0.05, 0.5), Quat::from_rotation_y(turn), at);
        add_mesh(&mut scene, slab, Material::default());
    }
    let camera = look_at(Vec3::new(0.0, 7.0, 9.0), Vec3::ZERO);
    for filter in [
        "hard",
        "pcf:5",
        "bilinear:1",
        "poisson:12:2",
        "msm:2",
        "pcss:16",
    ] {
        let map = map(&format!("32 adaptive {filter} 0"));
        all_are(Cause::Edge, 300, &scene, &camera, map);
    }
}

#[test]
fn a_penumbra_alone() {
    let mut scene = lit_by_sun(Vec3::new(-0.5, -0.8, -0.3));
    add_surface(&mut scene, floor(), Material::default());
    let ball = Sphere {
        center: Vec3::new(0.0, 3.0, 0.0),
        radius: 1.0,
    };
    add_surface(&mut scene, Surface::Sphere(ball), Material::default());
    let camera = look_at(Vec3::new(-2.0, 6.0, 4.0), Vec3::new(-2.0, 0.0, -1.0));
    all_are(
        Cause::Penumbra,
        1000,
        &scene,
        &camera,
        map("4096 adaptive hard 0.2"),
    );
    let pcss = map("2048 adaptive pcss:64 0.2");
    all_are(Cause::Penumbra, 1, &scene, &camera, pcss);
}

#[test]
fn glass_and_alpha() {
    let mut scene = lit_by_sun(Vec3::new(-0.5, -0.8, -0.3));
    add_surface(&mut scene, floor(), Material::default());
    let clear = Material {
        base_color: Vec3::new(0.9, 0.4, 0.3),
        transmission: 1.0,
        ..matte(Vec3::ONE)
    };
    let pane = cuboid(Vec3::new(1.5, 0.05, 1.5), Quat::IDENTITY, 2.0 * Vec3::Y);
    add_mesh(&mut scene, pane, clear);
    let camera = look_at(Vec3::new(-2.0, 6.0, 4.0), Vec3::new(-1.0, 0.0, -1.0));
    all_are(
        Cause::Glass,
        1000,
        &scene,
        &camera,
        map("2048 adaptive hard 0"),
    );
    for alpha in [0.3, 0.6] {
        let veil = Material {
            alpha_mode: umbriel_render::AlphaMode::Blend,
            alpha,
            ..Material::default()
        };
        let last = scene.materials.len() - 1;
        scene.materials[last] = veil;
        // The veil's own edge is an edge as any.
        all_are(
            Cause::Glass,
            1000,
            &scene,
            &camera,
            map("4096 adaptive hard 0"),
        );
    }
}

/// With hard shadows the wrong pixels are those where the pictures by shadow maps and by rays differ, and truth put in place of the map's
/// answers gives the picture by rays.
#[test]
fn wrong_pixels_are_those_that_differ() {
    let scene = tori([32, 16], true);
    let settings = settings(map("512 adaptive hard 0"));
    let found = find(&scene, &camera(), &settings);
    let by_maps = draw(&scene, &camera(), &settings).image;
    let by_rays = Settings {
        method: Method::RayCast,
        ..settings.clone()
    };
    let by_rays = draw(&scene, &camera(), &by_rays).image;
    let lit = |method| {
        let (shadows, base) = (false, settings.clone());
        draw(
            &scene,
            &camera(),
            &Settings {
                method,
                shadows,
                ..base
            },
        )
        .image
    };
    let [lit_by_maps, lit_by_rays] = [Method::ShadowMap, Method::RayCast].map(lit);
    let differ = |a: &Image, b: &Image, i: usize| {
        let (a, b) = (a.pixels[i], b.pixels[i]);
        (0..3).any(|k| (a[k] - b[k]).abs() > 1e-5 * (a[k] + b[k]))
    };
    let wrong: HashSet<usize> = found
        .errors
        .wrong
        .iter()
        .map(|w| w.pixel as usize)
        .collect();
    assert_eq!(wrong.len(), found.errors.wrong.len(), "a pixel counts once");
    let mended = truth_picture(&by_maps, &found.seen, &[(&found.truth, &found.errors)]);
    for i in 0..by_maps.pixels.len() {
        // The rasteriser's silhouettes are not those of rays.
        if !differ(&lit_by_maps, &lit_by_rays, i) {
            assert_eq!(
                differ(&by_maps, &by_rays, i),
                wrong.contains(&i),
                "pixel {i}"
            );
            assert!(!differ(&mended, &by_rays, i), "pixel {i}");
        }
    }
    assert!(wrong.len() > 300);
}

#[test]
fn any_number_of_threads_finds_the_same() {
    let scene = mixed();
    let settings = Settings {
        resolution: [160, 120],
        ..settings(map("256 adaptive bilinear:2 0.05"))
    };
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let found = pool
            .build()
            .unwrap()
            .install(|| find(&scene, &camera(), &settings));
        (found.seen, found.truth, found.errors)
    };
    assert!(with(1) == with(3));
}

#[test]
fn a_crop_has_the_errors_of_its_part() {
    let scene = mixed();
    let whole = settings(map("512 adaptive hard 0"));
    let part = Settings {
        crop: Some([40, 30, 200, 150]),
        ..whole.clone()
    };
    let (all, some) = (
        find(&scene, &camera(), &whole),
        find(&scene, &camera(), &part),
    );
    let within = |pixel: u32| {
        (40..200).contains(&(pixel % SIZE[0])) && (30..150).contains(&(pixel / SIZE[0]))
    };
    let expected: Vec<_> = all
        .errors
        .wrong
        .iter()
        .filter(|w| within(w.pixel))
        .map(|w| (w.pixel, w.cause))
        .collect();
    let found: Vec<_> = some
        .errors
        .wrong
        .iter()
        .map(|w| (w.pixel, w.cause))
        .collect();
    // The maps follow what the whole picture shows.
    assert_eq!(found, expected);
}
