//! What must not show: a moving eye, where images meet.

mod support;

use support::{
    add_mesh, add_surface, floor, matte, point_light,
    shadow_scene::{camera, cuboid, look_at, settings, tori},
    shadow_truth::{maps, truth},
    sun,
};
use umbriel_render::{
    GlassShadows, Material, Scene, SceneBvh, ShadowMapSettings, ShadowMaps,
    kernels::glam::{Quat, Vec3, Vec3A},
};

/// An eye that moves by parts of a texel: the maps' texels stay where they are in the world, and what was lit stays lit.
#[test]
fn shadows_do_not_swim_when_the_eye_moves() {
    let scene = tori([32, 16], true);
    let bvh = SceneBvh::build(&scene);
    let size = [640, 360];
    let truth = truth(&bvh, &camera(), size, GlassShadows::Opaque);
    for cascades in [1, 3] {
        let map = ShadowMapSettings {
            resolution: 1024,
            cascades,
            ..ShadowMapSettings::default()
        };
        let at = |moved: Vec3| {
            let mut camera = camera();
            camera.pose.translation += Vec3A::from(moved);
            maps(&bvh, &camera, size, map, GlassShadows::Opaque)
        };
        let still = at(Vec3::ZERO);
        let view = still.of(0).faces()[0].view;
        let texel = view.texel_width(1.0);
        let mut has_moved = false;
        for step in [0.1, 0.25, 0.5, 0.9, 3.3] {
            let moved = at(Vec3::new(0.8, 0.1, -0.6) * step * texel);
            has_moved |= moved.of(0).faces()[0].view != view;
            let (mut changed, mut near_edges) = (0, 0);
            for &(p, ng) in &truth.points {
                let (a, b) = (still.of(0).lookup(p, ng), moved.of(0).lookup(p, ng));
                let (Some(a), Some(b)) = (a, b) else { continue };
                // The first and the last points of a cascade go over to the next one.
                if a.face == b.face {
                    changed += u32::from(a.fraction != b.fraction);
                } else {
                    near_edges += u32::from(a.fraction != b.fraction);
                }
            }
            let share = |count: u32| count as f32 / truth.points.len() as f32;
            let (changed, near_edges) = (share(changed), share(near_edges));
            println!("{cascades} cascades, {step} texels: {changed}, at splits {near_edges}");
            assert!(
                changed < 1e-4 && near_edges < 1e-4,
                "{cascades}, {step}: {changed} {near_edges}"
            );
        }
        assert!(has_moved, "the map follows the eye");
    }
}

/// Where two faces of a point light's cube meet, blurred moments reach over the edge: both sides answer as alike as with comparisons. Not so EVSM, whose
/// warp depends on the range of depths of each face.
#[test]
fn blurred_moments_reach_over_the_edges_of_a_cube() {
    let mut scene = Scene::default();
    add_surface(&mut scene, floor(), matte(Vec3::ONE));
    // Posts whose shadows run along and across the diagonals where faces meet.
    for k in 0..9_u32 {
        let at = Vec3::new((k % 3) as f32 * 1.3 - 1.2, 0.0, (k / 3) as f32 * 1.3 - 1.4);
        let turn = Quat::from_rotation_y(k as f32);
        add_mesh(
            &mut scene,
            cuboid(Vec3::new(0.2, 2.2, 0.2), turn, at),
            Material::default(),
        );
    }
    scene
        .lights
        .push(point_light(Vec3::new(0.1, 2.9, 0.2), 1.0));
    let bvh = SceneBvh::build(&scene);
    for filter in ["vsm:4", "msm:4", "pcf:9"] {
        let map = ShadowMapSettings {
            resolution: 128,
            filter: filter.parse().unwrap(),
            ..ShadowMapSettings::default()
        };
        let maps = ShadowMaps::render(&bvh, &camera(), &settings(map), false);
        let map = maps.of(0);
        let light = Vec3::new(0.1, 2.9, 0.2);
        let (mut worst, mut sum, mut steps) = (0.0_f32, 0.0, 0);
        // Around the circle in which the floor's plane is cut by the lower edges of the sides' faces.
        for i in 0..4000 {
            let side = i as f32 / 500.0 - 4.0;
            for (along, across) in [(Vec3::X, Vec3::Z), (Vec3::Z, Vec3::X)] {
                let edge = light - Vec3::Y * light.y + along * light.y + across * side * 0.72;
                let [near, far] = [-1e-4, 1e-4].map(|d| map.fraction(edge + along * d, Vec3::Y));
                worst = worst.max((near - far).abs());
                sum += (near - far).abs();
                steps += 1;
            }
        }
        let mean = sum / steps as f32;
        println!("{filter}: {worst} at worst, {mean} in the mean");
        assert!(worst < 0.2 && mean < 0.02, "{filter}: {worst}, {mean}");
    }
}

/// Along the edge of a wall's shadow, from cascade to cascade: the penumbra grows with the texels, but its answers never jump.
#[test]
fn cascades_meet_without_a_jump() {
    let mut scene = Scene::default();
    add_surface(&mut scene, floor(), matte(Vec3::ONE));
    let wall = cuboid(
        Vec3::new(0.3, 1.5, 35.0),
        Quat::IDENTITY,
        Vec3::new(0.0, 0.0, -25.0),
    );
    add_mesh(&mut scene, wall, Material::default());
    scene.lights.push(sun(Vec3::new(1.0, -0.8, 0.0), 1.0));
    let bvh = SceneBvh::build(&scene);
    let eye = look_at(Vec3::new(2.0, 2.5, 12.0), Vec3::X);
    let map = ShadowMapSettings {
        resolution: 1024,
        cascades: 4,
        filter: "bilinear:15".parse().unwrap(),
        ..ShadowMapSettings::default()
    };
    let maps = maps(&bvh, &eye, [640, 360], map, GlassShadows::Opaque);
    let map = maps.of(0);
    let (mut worst, mut faces) = (0.0_f32, 0);
    for x in [1.9, 2.0, 2.1, 2.2, 2.3] {
        let along = (0..40_000).map(|i| Vec3::new(x, 0.0, 9.0 - i as f32 * 1e-3));
        let found: Vec<_> = along.filter_map(|p| map.lookup(p, Vec3::Y)).collect();
        for pair in found.windows(2) {
            faces += u32::from(pair[0].face != pair[1].face);
            worst = worst.max((pair[0].fraction - pair[1].fraction).abs());
        }
    }
    println!("{worst} at worst over {faces} seams");
    assert!(faces >= 10, "{faces} seams were passed");
    // A step of a millimetre is a fraction of a texel, whose weight is a fifteenth at most.
    assert!(worst < 0.02, "{worst}");
}
