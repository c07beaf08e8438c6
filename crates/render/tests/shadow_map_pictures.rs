//! Whole pictures by shadow maps: against rays, at any scale, on any number of threads.

mod support;

use support::{
    draw, point_light,
    shadow_scene::{self, differing, mixed, settings},
};
use umbriel_render::{
    Camera, Light, Method, Sampling, Settings, ShadowMapSettings,
    kernels::glam::{Affine3A, Vec3},
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
        projection: umbriel_render::Projection::Orthographic { half_height: 8.0 },
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

#[test]
fn threads_change_no_byte() {
    let scene = mixed();
    let camera = shadow_scene::camera();
    let map = ShadowMapSettings {
        resolution: 512,
        filter: "pcf:3".parse().unwrap(),
        ..ShadowMapSettings::default()
    };
    for spp in [1, 3] {
        let settings = Settings {
            sampling: Sampling::Fixed { spp },
            ..settings(map)
        };
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| draw(&scene, &camera, &settings))
        };
        let one = on(1);
        for threads in [2, 3, 8] {
            assert_eq!(on(threads), one);
        }
    }
}
