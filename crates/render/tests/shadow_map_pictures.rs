//! Whole pictures by shadow maps: against rays, at any scale, on any number of threads.

mod support;

use std::sync::atomic::AtomicBool;
use support::{
    add_mesh, draw, point_light,
    shadow_scene::{self, differing, look_at, mixed, settings, spot},
};
use umbriel_render::{
    Camera, Control, Light, Material, Mesh, Method, Projection, Sampling, Scene, SceneBvh,
    Settings, ShadowMapSettings,
    kernels::{
        VectorUnit,
        glam::{Affine3A, Quat, Vec3, Vec3A},
    },
    render,
};

/// The first rung: what is rasterised is what rays see, but for silhouettes.
#[test]
fn the_lit_picture_is_that_of_ray_casting() {
    let scene = mixed();
    let raster = Settings {
        shadows: false,
        resolution: [640, 360],
        ..settings(ShadowMapSettings::default())
    };
    let rays = Settings {
        method: Method::RayCast,
        ..raster.clone()
    };
    let camera = shadow_scene::camera();
    let orthographic = Camera {
        projection: Projection::Orthographic { half_height: 8.0 },
        far: 100.0,
        ..camera.clone()
    };
    for camera in [camera, orthographic] {
        let (a, b) = (draw(&scene, &camera, &raster), draw(&scene, &camera, &rays));
        let share = differing(&a, &b, 0.0);
        println!("{share} of the pixels differ");
        assert!(share <= 1e-3, "{share}");
    }
}

/// With shadows pictures differ at the shadows' edges only, and less so on greater maps.
#[test]
fn shadows_come_nearer_to_rays_as_maps_grow() {
    let scene = mixed();
    let camera = shadow_scene::camera();
    let rays = Settings {
        method: Method::RayCast,
        resolution: [640, 360],
        ..Settings::default()
    };
    let truth = draw(&scene, &camera, &rays);
    let mut before = 1.0;
    for resolution in [256, 512, 1024, 2048] {
        let map = ShadowMapSettings {
            resolution,
            ..ShadowMapSettings::default()
        };
        let settings = Settings {
            resolution: [640, 360],
            ..settings(map)
        };
        let share = differing(&draw(&scene, &camera, &settings), &truth, 1e-3);
        println!("{resolution}: {share}");
        assert!(share < 0.7 * before, "{share} after {before}");
        before = share;
    }
    assert!(before < 0.006, "{before}");
}

/// The same scene at other sizes and places gives the same picture with the default settings.
#[test]
fn scale_and_place_change_nothing() {
    let base = mixed();
    let resolution = [320, 180];
    let map = settings(ShadowMapSettings {
        resolution: 1024,
        ..ShadowMapSettings::default()
    });
    let picture = |scale: f32, moved: Vec3| {
        let mut scene = base.clone();
        scene
            .lights
            .push(point_light(Vec3::new(1.0, 5.0, 2.0), 50.0));
        let place = Affine3A::from_translation(moved) * Affine3A::from_scale(Vec3::splat(scale));
        for instance in &mut scene.instances {
            instance.transform = place * instance.transform;
        }
        for light in &mut scene.lights {
            if let Light::Point(light) = light {
                light.position = place.transform_point3(light.position);
                light.intensity *= scale * scale;
            }
        }
        let mut camera = shadow_scene::camera();
        camera.pose.translation = place.transform_point3a(camera.pose.translation);
        let settings = Settings {
            resolution,
            ..map.clone()
        };
        draw(&scene, &camera, &settings)
    };
    let expected = picture(1.0, Vec3::ZERO);
    for (scale, moved) in [
        (1e-3, Vec3::ZERO),
        (1e5, Vec3::ZERO),
        (1.0, Vec3::new(1000.0, -200.0, 3000.0)),
        (1e-2, Vec3::new(3.0, 5.0, -7.0)),
    ] {
        let share = differing(&picture(scale, moved), &expected, 0.02);
        println!("{scale} {moved}: {share}");
        assert!(share < 0.01, "{scale} {moved}: {share}");
    }
}

/// Sizes and places that leave little or much over: one pixel, parallel eye rays, an eye within a mesh, in the plane of one and beside a triangle
/// that reaches around it, and scenes far off the origin. Without shadows pictures are those of ray casting but for silhouettes, with shadows also but
/// for their edges, which are as wide as f32 knows places: 1 mm, 8 mm and 6 cm at 10, 100 and 1000 km, where a texel is 12 mm.
#[test]
fn odd_views_agree_with_rays() {
    let mut room = Scene::default();
    let [half, at] = [Vec3::new(3.0, 2.5, 3.0), Vec3::ZERO];
    add_mesh(
        &mut room,
        shadow_scene::cuboid(half, Quat::IDENTITY, at),
        Material::default(),
    );
    let small = shadow_scene::cuboid(Vec3::splat(0.4), Quat::from_rotation_y(0.4), at);
    add_mesh(&mut room, small, Material::default());
    room.lights
        .push(point_light(Vec3::new(1.2, 2.2, 0.9), 10.0));
    let within = look_at(Vec3::new(-2.0, 1.4, 2.1), Vec3::new(0.3, 0.4, -0.2));

    // The eye lies in the floor's plane, and a millimetre beside a triangle that reaches around it.
    let mut cut = mixed();
    let eye = Vec3::new(0.0, 0.0, 14.0);
    let beside = eye + Vec3::X * 1e-3;
    let blade = Mesh {
        positions: vec![
            beside + Vec3::new(-1.0, -2.0, 1.0),
            beside + Vec3::new(1.0, -2.0, -1.0),
            beside + Vec3::Y * 2.0,
        ],
        indices: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    add_mesh(&mut cut, blade, Material::default());
    let on_it = look_at(eye, Vec3::new(0.5, 2.0, 0.0));

    let far = |moved: Vec3| {
        let (mut scene, mut camera) = (mixed(), shadow_scene::camera());
        for instance in &mut scene.instances {
            instance.transform = Affine3A::from_translation(moved) * instance.transform;
        }
        camera.pose.translation += Vec3A::from(moved);
        (scene, camera)
    };
    let (far4, away4) = far(Vec3::new(1e4, -1e4, 1e4));
    let (far5, away5) = far(Vec3::new(1e5, -1e5, 1e5));
    let (far6, away6) = far(Vec3::new(1e6, -1e6, 1e6));
    let orthographic = Camera {
        projection: Projection::Orthographic { half_height: 8.0 },
        far: 100.0,
        ..shadow_scene::camera()
    };
    let (base, eye) = (mixed(), shadow_scene::camera());
    for (name, scene, camera, resolution, most_lit, most) in [
        ("one pixel", &base, &eye, [1, 1], 0.0, 0.0),
        ("one row", &base, &eye, [640, 1], 2e-3, 0.03),
        (
            "parallel eye rays",
            &base,
            &orthographic,
            [640, 360],
            1e-3,
            0.003,
        ),
        ("within a mesh", &room, &within, [640, 360], 1e-3, 0.003),
        ("through the eye", &cut, &on_it, [640, 360], 1e-3, 0.003),
        (
            "far off the origin, 1e4",
            &far4,
            &away4,
            [640, 360],
            1e-3,
            0.01,
        ),
        (
            "far off the origin, 1e5",
            &far5,
            &away5,
            [640, 360],
            1e-3,
            0.03,
        ),
        (
            "far off the origin, 1e6",
            &far6,
            &away6,
            [640, 360],
            1e-3,
            0.12,
        ),
    ] {
        for (shadows, most) in [(false, most_lit), (true, most)] {
            let raster = Settings {
                shadows,
                resolution,
                ..settings(ShadowMapSettings::default())
            };
            let rays = Settings {
                method: Method::RayCast,
                ..raster.clone()
            };
            let (a, b) = (draw(scene, camera, &raster), draw(scene, camera, &rays));
            let share = differing(&a, &b, if shadows { 1e-3 } else { 0.0 });
            println!("{name}, shadows {shadows}: {share}");
            assert!(share <= most, "{name}, shadows {shadows}: {share}");
        }
    }
}

/// Whole frames of meshes and surfaces under a sun with cascades, a spot light and a point light: the same bytes by every vector unit and on any
/// number of threads.
#[test]
fn machines_change_no_byte() {
    let mut scene = mixed();
    let lamp = Vec3::new(5.0, 9.0, 3.0);
    scene.lights.push(spot(lamp, -lamp, 0.8));
    scene
        .lights
        .push(point_light(Vec3::new(1.0, 5.0, 2.0), 50.0));
    let picture = |unit, threads, settings: &Settings| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let bvh = SceneBvh::without_trees(&scene).with_unit(unit);
        let control = Control {
            stop: &AtomicBool::new(false),
            progress: &|_, _| {},
        };
        let work = || render(&bvh, &shadow_scene::camera(), settings, &control);
        pool.build().unwrap().install(work)
    };
    let units = VectorUnit::available();
    for (filter, cascades, spp) in [
        ("hard", 1, 3),
        ("pcf:3", 2, 1),
        ("bilinear:2", 1, 1),
        ("vogel:8:2", 1, 1),
        ("pcss:16", 4, 1),
        ("evsm:2", 1, 1),
        ("msm:1", 2, 1),
    ] {
        let map = ShadowMapSettings {
            resolution: 160,
            filter: filter.parse().unwrap(),
            light_size: 0.2,
            cascades,
            ..ShadowMapSettings::default()
        };
        let settings = Settings {
            resolution: [130, 90],
            sampling: Sampling::Fixed { spp },
            shadow_maps: vec![map; 3],
            ..settings(map)
        };
        let expected = picture(units[0], 1, &settings);
        for threads in [2, 3, 8] {
            let found = picture(units[0], threads, &settings);
            assert!(found == expected, "{filter} on {threads} threads");
        }
        for (number, &unit) in units.iter().enumerate() {
            let found = picture(unit, 1 + number, &settings);
            assert!(found == expected, "{filter} on {unit:?}");
        }
    }
}
