//! Shadow maps where the answer is known: depths, bias, penumbras, planes.

mod support;

use support::{
    Random, add_mesh, add_surface, floor, matte, point_light,
    shadow_scene::{self, look_at, mixed, settings, spot, square},
    sun,
};
use umbriel_render::{
    Material, Scene, SceneBvh, Settings, ShadowMap, ShadowMapSettings, ShadowMaps,
    kernels::{
        Plane, Rectangle, Sphere, Surface,
        glam::{Vec2, Vec3},
    },
};

/// A map's depths are those of the light's rays.
#[test]
fn depths_are_those_of_rays() {
    let mut scene = mixed();
    scene.lights.push(spot(
        Vec3::new(5.0, 9.0, 3.0),
        Vec3::new(-5.0, -9.0, -3.0),
        0.8,
    ));
    scene
        .lights
        .push(point_light(Vec3::new(1.0, 5.0, 2.0), 1.0));
    let bvh = SceneBvh::build(&scene);
    let map = ShadowMapSettings {
        resolution: 256,
        ..ShadowMapSettings::default()
    };
    let settings = Settings {
        shadow_maps: vec![map; 3],
        ..settings(map)
    };
    let maps = ShadowMaps::render(&bvh, &shadow_scene::camera(), &settings, true);
    for (light, face) in [(0, 0), (1, 0), (2, 0), (2, 3), (2, 5)] {
        let face_map = &maps.of(light).faces()[face];
        let view = face_map.view;
        let texels = (0..view.side * view.side).map(|i| [i % view.side, i / view.side]);
        let rays: Vec<_> = texels
            .clone()
            .map(|[x, y]| view.ray(Vec2::new(x as f32 + 0.5, y as f32 + 0.5)))
            .collect();
        let mut hits = vec![None; rays.len()];
        bvh.intersect(&rays, &mut hits);
        let mut wrong = 0;
        for ([x, y], hit) in texels.zip(&hits) {
            let depth = face_map.depth(x, y).unwrap();
            let expected = hit.map_or(f32::INFINITY, |hit| hit.t);
            let writer = maps.writer(light, face, x, y);
            let same = (depth - expected).abs() <= 1e-4 * expected || depth == expected;
            let known =
                writer.map(|(i, p)| (i.0, p)) == hit.map(|hit| (hit.instance, hit.primitive));
            wrong += u32::from(!(same && known));
        }
        let share = wrong as f32 / hits.len() as f32;
        println!("light {light} face {face}: {share}");
        assert!(share < 3e-3, "light {light} face {face}: {share}");
    }
}

/// The default bias on planes that light meets at 0 to 89 degrees: no acne, and light behind a wall's foot within two texels.
#[test]
fn the_default_bias_holds_on_planes() {
    for filter in ["hard", "pcf:3"] {
        for degrees in [
            0.0, 10.0, 30.0, 45.0, 60.0, 75.0, 80.0, 85.0, 88.0, 89.0_f32,
        ] {
            for scale in [1e-3, 1.0, 1e5] {
                let (acne, gap) = plane_at(degrees.to_radians(), scale, filter);
                assert!(acne < 1e-3, "{filter} {degrees}: {acne}");
                let most = if filter == "hard" { 2.0 } else { 3.0 };
                assert!(gap < most, "{filter} {degrees}: {gap} texels");
            }
        }
    }
}

/// The dark share of a lit floor, and how far behind a wall there is light, in texels.
fn plane_at(angle: f32, scale: f32, filter: &str) -> (f32, f32) {
    let mut scene = Scene::default();
    add_mesh(&mut scene, square(10.0 * scale, 0.0), Material::default());
    let wall = Surface::Rectangle(Rectangle {
        center: Vec3::new(0.0, 0.0, 0.0),
        u: Vec3::new(0.0, 0.05 * scale, 0.0),
        v: Vec3::new(0.0, 0.0, 2.0 * scale),
    });
    add_surface(&mut scene, wall, Material::default());
    scene
        .lights
        .push(sun(Vec3::new(angle.sin(), -angle.cos(), 0.0), 1.0));
    let bvh = SceneBvh::build(&scene);
    let map = ShadowMapSettings {
        resolution: 512,
        filter: filter.parse().unwrap(),
        ..ShadowMapSettings::default()
    };
    let camera = look_at(Vec3::new(0.0, 20.0, 15.0) * scale, Vec3::ZERO);
    let maps = ShadowMaps::render(&bvh, &camera, &settings(map), false);
    let map = maps.of(0);
    let texel = map.faces()[0].view.texel_width(1.0);
    let mut random = Random(7);
    let (mut dark, mut count) = (0, 0);
    for _ in 0..20_000 {
        let p = Vec3::new(random.range(-9.9, 9.9), 0.0, random.range(-9.9, 9.9)) * scale;
        if p.z.abs() < 2.2 * scale + texel && p.x > -3.0 * texel / angle.cos() {
            continue;
        }
        count += 1;
        dark += u32::from(map.fraction(p, Vec3::Y) < 0.99);
    }
    // Behind the wall, as far as its shadow goes.
    let length = 0.05 * scale * angle.tan();
    let (mut lit, rows) = (0.0, 50);
    for row in 0..rows {
        let z = random.range(-1.8, 1.8) * scale;
        let step = length / 500.0;
        for i in 0..500 {
            let p = Vec3::new((i as f32 + 0.5) * step, 0.0, z + row as f32 * 1e-6 * scale);
            // Half of it is far from the shadow's end.
            if i < 250 && p.x < 9.0 * scale {
                lit += map.fraction(p, Vec3::Y) * step * angle.cos() / texel;
            }
        }
    }
    (dark as f32 / count as f32, lit / rows as f32)
}

/// The width of soft shadows is that of similar triangles.
#[test]
fn penumbras_are_as_wide_as_similar_triangles_say() {
    for (blocker, size) in [(1.0, 0.1), (2.0, 0.1), (4.0, 0.1), (2.0, 0.2), (3.0, 0.05)] {
        // A half-plane at a height above the floor, under the sun and under a lamp.
        let mut scene = Scene::default();
        let edge = Surface::Rectangle(Rectangle {
            center: Vec3::new(-5.0, blocker, 0.0),
            u: Vec3::X * 5.0,
            v: Vec3::Z * 5.0,
        });
        add_surface(&mut scene, edge, Material::default());
        add_mesh(&mut scene, square(5.0, 0.0), Material::default());
        let lamp = 10.0;
        scene.lights = vec![
            sun(Vec3::NEG_Y, 1.0),
            spot(Vec3::new(0.0, lamp, 0.0), Vec3::NEG_Y, 0.5),
            point_light(Vec3::new(0.0, lamp, 0.0), 1.0),
        ];
        let map = ShadowMapSettings {
            resolution: 1024,
            filter: "pcss:256".parse().unwrap(),
            light_size: size,
            ..ShadowMapSettings::default()
        };
        let diameter = ShadowMapSettings {
            light_size: 10.0 * size,
            ..map
        };
        let bvh = SceneBvh::build(&scene);
        let camera = look_at(Vec3::new(0.0, 12.0, 6.0), Vec3::ZERO);
        let settings = Settings {
            shadow_maps: vec![map, diameter, diameter],
            ..settings(map)
        };
        let maps = ShadowMaps::render(&bvh, &camera, &settings, false);
        let sun_width = 2.0 * (0.5 * size).tan() * blocker;
        let lamp_width = 10.0 * size * blocker / (lamp - blocker);
        for (light, expected) in [(0, sun_width), (1, lamp_width), (2, lamp_width)] {
            let width = penumbra(maps.of(light));
            println!("{blocker} {size} light {light}: {width} for {expected}");
            assert!(
                (width / expected - 1.0).abs() < 0.15,
                "{width} for {expected}"
            );
        }
    }
}

/// From a tenth to nine tenths of the light, as the width of the disk whose shadow has them that far apart.
fn penumbra(map: &ShadowMap) -> f32 {
    const TENTHS: f32 = 0.687;
    let at = |x: f32| map.fraction(Vec3::new(x, 0.0, 0.1), Vec3::Y);
    let places = (0..20_000).map(|i| -2.5 + i as f32 * 2.5e-4);
    let low = places.clone().find(|&x| at(x) > 0.1).unwrap();
    let high = places.clone().find(|&x| at(x) > 0.9).unwrap();
    (high - low) / TENTHS
}

/// A plane above the floor keeps all light from it, within the maps and beyond.
#[test]
fn planes_cast_shadows() {
    let mut scene = Scene::default();
    add_surface(&mut scene, floor(), matte(Vec3::ONE));
    let roof = Surface::Plane(Plane {
        point: Vec3::new(0.0, 5.0, 0.0),
        normal: Vec3::new(0.1, 1.0, 0.0),
    });
    add_surface(&mut scene, roof, matte(Vec3::ONE));
    scene.lights = vec![
        sun(Vec3::new(0.2, -1.0, 0.1), 1.0),
        spot(Vec3::new(0.0, 9.0, 0.0), Vec3::NEG_Y, 1.0),
        point_light(Vec3::new(0.0, 9.0, 0.0), 1.0),
    ];
    let ball = |scene: &mut Scene| {
        let ball = Sphere {
            center: Vec3::new(0.0, 1.0, 0.0),
            radius: 1.0,
        };
        add_surface(scene, Surface::Sphere(ball), matte(Vec3::ONE));
    };
    for with_ball in [false, true] {
        if with_ball {
            ball(&mut scene);
        }
        let bvh = SceneBvh::build(&scene);
        let camera = look_at(Vec3::new(3.0, 2.0, 8.0), Vec3::ZERO);
        let maps = ShadowMaps::render(
            &bvh,
            &camera,
            &settings(ShadowMapSettings::default()),
            false,
        );
        for (light, far) in [(0, 30.0), (1, 5.0), (2, 30.0)] {
            for x in [-1.0, -0.4, 0.3, 1.0] {
                let p = Vec3::new(x * far, 0.0, 0.3 * far);
                assert_eq!(
                    maps.of(light).fraction(p, Vec3::Y),
                    0.0,
                    "light {light} at {p}"
                );
                let above = p + Vec3::Y * (5.0 - 0.1 * p.x);
                assert!(
                    maps.of(light).fraction(above, Vec3::Y) > 0.9,
                    "light {light} at {above}"
                );
            }
        }
    }
}
