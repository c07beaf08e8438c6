//! What casts shadows, by shadow map against shadow rays: holes, single-sided meshes, glass, veils.

mod support;

use std::f32::consts::PI;
use support::{
    add_mesh, add_surface, floor, matte, point_light,
    shadow_scene::{look_at, spot, square},
    shadow_truth::{Errors, errors, maps, truth},
    sun,
};
use umbriel_render::{
    AlphaMode, Camera, Encoding, Filter, GlassShadows, ImageTexture, Light, Material, Mesh, Scene,
    SceneBvh, ShadowMapSettings, Texture, TextureId, TextureRef, Wrap,
    kernels::{
        Rectangle, Sphere, Surface,
        glam::{Affine2, Affine3A, Vec2, Vec3},
    },
};

const SIZE: [u32; 2] = [320, 240];

/// Squares of alpha 0 and 1 in turn.
fn chessboard() -> Texture {
    let texel = |i: u32| {
        [
            255,
            255,
            255,
            if (i + i / 8).is_multiple_of(2) {
                0
            } else {
                255
            },
        ]
    };
    Texture::Image(ImageTexture {
        name: String::new(),
        width: 8,
        height: 8,
        texels: (0..64).map(texel).collect(),
        encoding: Encoding::Srgb,
        wrap: [Wrap::Repeat; 2],
        filter: Filter::Nearest,
    })
}

fn holed() -> Material {
    Material {
        base_color_texture: Some(TextureRef {
            texture: TextureId(0),
            uv_set: 0,
            transform: Affine2::IDENTITY,
        }),
        alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
        ..Material::default()
    }
}

/// A floor under lights of all kinds, that something is to be put between.
fn stage() -> Scene {
    let mut scene = Scene {
        textures: vec![chessboard()],
        ..Scene::default()
    };
    add_surface(&mut scene, floor(), matte(Vec3::ONE));
    scene
}

fn lights() -> [Light; 3] {
    let lamp = Vec3::new(1.0, 6.0, 2.0);
    [
        sun(Vec3::new(-0.3, -1.0, -0.4), 1.0),
        spot(lamp, -lamp, 0.9),
        point_light(lamp, 1.0),
    ]
}

fn camera() -> Camera {
    look_at(Vec3::new(0.5, 6.0, 9.0), Vec3::new(0.0, 0.5, 0.0))
}

/// A square with texture coordinates, seen from above.
fn sheet(half: f32, y: f32) -> Mesh {
    let mut mesh = square(half, y);
    mesh.uvs[0] = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]
        .map(Vec2::from)
        .to_vec();
    mesh
}

/// The greatest errors under each light in turn, in percent of all that faces it, and of what lies two pixels off the edges of shadows.
fn worst(scene: &Scene, glass: GlassShadows) -> [Errors; 2] {
    let mut worst = [Errors {
        acne: 0.0,
        leak: 0.0,
    }; 2];
    for light in lights() {
        let mut scene = scene.clone();
        scene.lights = vec![light];
        scene.validate().expect("a sound scene");
        let bvh = SceneBvh::build(&scene);
        let truth = truth(&bvh, &camera(), SIZE, glass);
        let dark = truth.lit.iter().filter(|&&lit| !lit).count();
        assert!(dark > 300, "the shadow is seen: {dark}");
        let maps = maps(&bvh, &camera(), SIZE, ShadowMapSettings::default(), glass);
        for (worst, truth) in worst
            .iter_mut()
            .zip([0, 2].map(|reach| truth.off_edges(reach)))
        {
            let found = errors(&maps, &truth);
            worst.acne = worst.acne.max(found.acne);
            worst.leak = worst.leak.max(found.leak);
        }
    }
    println!("{worst:?}");
    worst
}

/// At most half a percent of all pixels is wrong, and off the edges one in two thousand: what is curved and grazed by light.
fn agree(scene: &Scene, glass: GlassShadows) {
    let [all, off_edges] = worst(scene, glass);
    assert!(all.sum() < 0.5, "{all:?}");
    assert!(off_edges.sum() < 0.05, "{off_edges:?}");
}

#[test]
fn holes_let_light_through() {
    let mut scene = stage();
    add_mesh(&mut scene, sheet(1.5, 1.5), holed());
    let last = scene.instances.len() - 1;
    scene.instances[last].transform = Affine3A::from_rotation_x(0.3);
    let ball = Sphere {
        center: Vec3::new(-2.5, 1.2, 0.0),
        radius: 1.0,
    };
    add_surface(&mut scene, Surface::Sphere(ball), holed());
    let pane = Rectangle {
        center: Vec3::new(2.5, 1.0, 0.0),
        u: Vec3::new(0.8, 0.0, 0.2),
        v: Vec3::new(-0.1, 0.7, 0.4),
    };
    add_surface(&mut scene, Surface::Rectangle(pane), holed());
    agree(&scene, GlassShadows::Filtered);
}

/// Both sides of single-sided meshes stop light, though an eye sees but one.
#[test]
fn single_sided_meshes_stop_light_from_both_sides() {
    let one_sided = Material {
        double_sided: false,
        ..Material::default()
    };
    for turned in [0.0, PI] {
        for inside_out in [false, true] {
            let mut scene = stage();
            add_mesh(&mut scene, square(1.5, 1.5), one_sided.clone());
            let sheet = &mut scene.instances[1];
            sheet.inside_out = inside_out;
            let turn = Affine3A::from_rotation_x(turned + 0.2);
            sheet.transform = Affine3A::from_translation(Vec3::Y * 1.5)
                * turn
                * Affine3A::from_translation(Vec3::Y * -1.5);
            agree(&scene, GlassShadows::Filtered);
        }
    }
}

/// Opaque glass stops light in both; of glass that filters light, a map knows nothing.
#[test]
fn glass_is_in_the_map_where_it_is_opaque() {
    let glass = Material {
        transmission: 1.0,
        ..Material::default()
    };
    let mut scene = stage();
    let ball = Sphere {
        center: Vec3::new(-1.5, 1.0, 0.0),
        radius: 1.0,
    };
    add_surface(&mut scene, Surface::Sphere(ball), glass.clone());
    add_mesh(&mut scene, square(1.0, 1.5), glass);
    agree(&scene, GlassShadows::Opaque);
    for light in lights() {
        scene.lights = vec![light];
        let bvh = SceneBvh::build(&scene);
        let glass = GlassShadows::Filtered;
        let maps = maps(&bvh, &camera(), SIZE, ShadowMapSettings::default(), glass);
        let below = Vec3::new(-1.9, 0.0, -0.3);
        assert_eq!(maps.of(0).fraction(below, Vec3::Y), 1.0);
    }
}

/// What is partly transparent stops light where it holds back half of it.
#[test]
fn veils_are_in_the_map_from_one_half_on() {
    for (alpha, dark) in [(0.45, false), (0.55, true)] {
        let veil = Material {
            alpha,
            alpha_mode: AlphaMode::Blend,
            ..Material::default()
        };
        let mut scene = stage();
        add_mesh(&mut scene, square(1.5, 1.5), veil);
        if dark {
            agree(&scene, GlassShadows::Filtered);
            continue;
        }
        for light in lights() {
            scene.lights = vec![light];
            let bvh = SceneBvh::build(&scene);
            let truth = truth(&bvh, &camera(), SIZE, GlassShadows::Filtered);
            assert!(truth.lit.iter().all(|&lit| lit), "{alpha}");
            let settings = ShadowMapSettings::default();
            let maps = maps(&bvh, &camera(), SIZE, settings, GlassShadows::Filtered);
            // What the light grazes at the horizon.
            assert!(errors(&maps, &truth).sum() < 0.1, "{alpha}");
        }
    }
}
