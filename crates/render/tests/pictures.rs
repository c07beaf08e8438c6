//! Properties of whole pictures: orientation of images and normals, layers, sampling, parts.

mod support;

use std::{f32::consts::PI, sync::atomic::AtomicBool};
use support::{
    add_instance, add_mesh, add_surface, close, draw, eye, look, matte, point_light, ray_cast, sky,
    sun,
};
use umbriel_render::{
    Aov, Camera, Control, Encoding, Filter, Geometry, ImageTexture, Light, Material, Mesh, MeshId,
    Sampling, Scene, SceneBvh, Settings, SpotLight, Texture, TextureId, TextureRef, Wrap,
    kernels::{
        Cuboid, Plane, Rectangle, Sphere, Surface,
        glam::{Affine2, Affine3A, Vec2, Vec3},
    },
    render, render_aovs,
};

const RED: [u8; 4] = [255, 0, 0, 255];
const BLUE: [u8; 4] = [0, 0, 255, 255];

fn image(width: u32, texels: Vec<[u8; 4]>, encoding: Encoding) -> Texture {
    Texture::Image(ImageTexture {
        name: String::new(),
        width,
        height: texels.len() as u32 / width,
        texels,
        encoding,
        wrap: [Wrap::Clamp; 2],
        filter: Filter::Nearest,
    })
}

fn textured() -> TextureRef {
    TextureRef {
        texture: TextureId(0),
        uv_set: 0,
        transform: Affine2::IDENTITY,
    }
}

fn quad() -> Mesh {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    Mesh {
        positions: corners.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec(),
        // glTF: v is 0 at the top of the image.
        uvs: [
            corners
                .map(|[x, y]| Vec2::new(0.5 + 0.5 * x, 0.5 - 0.5 * y))
                .to_vec(),
            Vec::new(),
        ],
        indices: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// From the front, as a picture on a wall is seen.
fn wall_eye(x: f32, y: f32) -> Camera {
    Camera::look_at(
        "wall",
        Vec3::new(x, y, 3.0),
        Vec3::new(x, y, 0.0),
        Vec3::Y,
        1e-3,
    )
}

/// A picture of two rows, red above blue, stands upright on every kind of surface.
#[test]
fn images_are_upright() {
    let rectangle = Rectangle {
        center: Vec3::ZERO,
        u: Vec3::X,
        v: Vec3::Y,
    };
    let cuboid = Cuboid {
        min: Vec3::splat(-1.0),
        max: Vec3::splat(1.0),
    };
    let sphere = Sphere {
        center: Vec3::ZERO,
        radius: 1.0,
    };
    let material = Material {
        base_color_texture: Some(textured()),
        unlit: true,
        ..Material::default()
    };
    let surfaces = [
        Surface::Rectangle(rectangle),
        Surface::Cuboid(cuboid),
        Surface::Sphere(sphere),
    ];
    for surface in surfaces.map(Some).into_iter().chain([None]) {
        let mut scene = Scene::default();
        scene
            .textures
            .push(image(1, vec![RED, BLUE], Encoding::Srgb));
        match surface {
            Some(surface) => add_surface(&mut scene, surface, material.clone()),
            None => add_mesh(&mut scene, quad(), material.clone()),
        }
        close(look(&scene, &wall_eye(0.0, 0.5), &ray_cast()), Vec3::X);
        close(look(&scene, &wall_eye(0.0, -0.5), &ray_cast()), Vec3::Z);
    }
}

/// A normal map that leans the surface up (+y in the image) and right (+x) faces light from there.
#[test]
fn normal_maps_lean_to_the_right_side() {
    // (0.6, 0, 0.8) and (0, 0.6, 0.8) in the encoding (n + 1)/2.
    let [right, up] = [[204, 128, 230, 255], [128, 204, 230, 255]];
    let rectangle = Surface::Rectangle(Rectangle {
        center: Vec3::ZERO,
        u: Vec3::X,
        v: Vec3::Y,
    });
    for (texel, lean) in [(right, Vec3::X), (up, Vec3::Y)] {
        for surface in [Some(rectangle.clone()), None] {
            let mut scene = Scene::default();
            scene.textures.push(image(1, vec![texel], Encoding::Linear));
            let material = Material {
                normal_texture: Some(textured()),
                ..matte(Vec3::ONE)
            };
            match surface {
                Some(surface) => add_surface(&mut scene, surface, material),
                None => add_mesh(&mut scene, quad(), material),
            }
            for (side, cos) in [
                (lean, 0.8 * 0.8 + 0.6 * 0.6),
                (-lean, 0.8 * 0.8 - 0.6 * 0.6),
            ] {
                scene.lights = vec![sun(-(Vec3::Z * 0.8 + side * 0.6), PI)];
                let found = look(&scene, &wall_eye(0.0, 0.0), &ray_cast()).x;
                assert!(
                    (found - cos).abs() < 0.02,
                    "{lean} from {side}: {found} for {cos}"
                );
            }
        }
    }
}

/// Mirroring an instance mirrors its picture: its outside stays outside, its lit side lit.
#[test]
fn mirrored_instances_keep_their_outside() {
    let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.3], [0.0, 1.0, -0.2]]
        .map(Vec3::from)
        .to_vec();
    let mesh = Mesh {
        positions,
        indices: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    for double_sided in [false, true] {
        let material = Material {
            double_sided,
            ..matte(Vec3::ONE)
        };
        let picture = |sign: f32| {
            let mut scene = Scene::default();
            scene.meshes.push(mesh.clone());
            let mirror = Affine3A::from_scale(Vec3::new(sign, 1.0, 1.0));
            add_instance(
                &mut scene,
                Geometry::Mesh(MeshId(0)),
                material.clone(),
                mirror,
            );
            scene
                .lights
                .push(sun(Vec3::new(-0.3 * sign, -0.2, -1.0), PI));
            look(&scene, &wall_eye(0.3 * sign, 0.3), &ray_cast())
        };
        assert!(picture(1.0).x > 0.8);
        close(picture(-1.0), picture(1.0));
    }
}

/// No ray meets a single-sided triangle from behind.
#[test]
fn backs_of_single_sided_meshes_are_not_there() {
    let mut scene = Scene {
        environment: sky(Vec3::Z),
        ..Scene::default()
    };
    let material = Material {
        double_sided: false,
        emission: Vec3::X,
        ..matte(Vec3::ZERO)
    };
    add_mesh(&mut scene, quad(), material);
    let from = |z: f32| {
        look(
            &scene,
            &eye(Vec3::new(0.1, 0.2, z), Vec3::ZERO),
            &ray_cast(),
        )
    };
    close(from(3.0), Vec3::X);
    close(from(-3.0), Vec3::Z);
}

/// Through a hole in a sphere its far wall is seen from inside.
#[test]
fn holes_show_the_far_wall() {
    let mut scene = Scene {
        environment: sky(Vec3::Z),
        ..Scene::default()
    };
    // Clear where u is below a half, which is the side of −z.
    scene.textures.push(image(
        2,
        vec![[255, 255, 255, 0], [255, 255, 255, 255]],
        Encoding::Srgb,
    ));
    let material = Material {
        base_color_texture: Some(textured()),
        alpha_mode: umbriel_render::AlphaMode::Mask { cutoff: 0.5 },
        emission: Vec3::X,
        ..matte(Vec3::ZERO)
    };
    add_surface(
        &mut scene,
        Surface::Sphere(Sphere {
            center: Vec3::ZERO,
            radius: 1.0,
        }),
        material,
    );
    let from = |z: f32| {
        look(
            &scene,
            &eye(Vec3::new(0.1, 0.2, z), Vec3::ZERO),
            &ray_cast(),
        )
    };
    close(from(3.0), Vec3::X);
    close(from(-3.0), Vec3::X);
    // Beside the far wall: through the hole and out again.
    scene.instances[0].transform = Affine3A::from_rotation_y(0.5 * PI);
    let beside = eye(Vec3::new(-0.9, 0.0, 3.0), Vec3::new(-0.9, 0.0, 0.0));
    close(look(&scene, &beside, &ray_cast()), Vec3::Z);
}

/// A normal map cannot catch light from beneath its surface.
#[test]
fn nothing_is_lit_from_beneath() {
    let mut scene = Scene::default();
    scene
        .textures
        .push(image(1, vec![[218, 128, 218, 255]], Encoding::Linear));
    let material = Material {
        normal_texture: Some(textured()),
        ..matte(Vec3::ONE)
    };
    add_surface(
        &mut scene,
        Surface::Plane(Plane {
            point: Vec3::ZERO,
            normal: Vec3::Y,
        }),
        material,
    );
    scene
        .lights
        .push(point_light(Vec3::new(5.0, -0.5, 0.0), 100.0));
    close(
        look(
            &scene,
            &eye(Vec3::new(0.0, 2.0, 0.5), Vec3::ZERO),
            &ray_cast(),
        ),
        Vec3::ZERO,
    );
}

/// A spot light through the whole pipeline: full in its inner cone, dark outside.
#[test]
fn spot_light_has_an_edge() {
    let mut scene = Scene::default();
    add_surface(
        &mut scene,
        Surface::Plane(Plane {
            point: Vec3::ZERO,
            normal: Vec3::Y,
        }),
        matte(Vec3::ONE),
    );
    scene.lights.push(Light::Spot(SpotLight {
        name: String::new(),
        position: Vec3::Y * 2.0,
        direction: Vec3::NEG_Y,
        intensity: Vec3::splat(4.0 * PI),
        range: f32::INFINITY,
        inner_angle: 0.3,
        outer_angle: 0.4,
    }));
    let at = |x: f32| {
        look(
            &scene,
            &eye(Vec3::new(x, 1.5, 0.1), Vec3::new(x, 0.0, 0.0)),
            &ray_cast(),
        )
    };
    close(at(0.0), Vec3::ONE);
    close(at(2.0 * 0.41_f32.tan()), Vec3::ZERO);
}

/// Some spheres, a mesh and a floor, enough for the tree; `few` is a handful of surfaces.
fn busy_scene(few: bool) -> Scene {
    let mut scene = Scene {
        environment: sky(Vec3::new(0.2, 0.3, 0.5)),
        ..Scene::default()
    };
    add_surface(
        &mut scene,
        Surface::Plane(Plane {
            point: Vec3::NEG_Y,
            normal: Vec3::Y,
        }),
        matte(Vec3::splat(0.5)),
    );
    for i in 0..if few { 5 } else { 20 } {
        let angle = 0.9 * i as f32;
        let center = Vec3::new(angle.cos() * 2.0, 0.1 * i as f32 - 0.8, angle.sin() * 2.0);
        let material = Material {
            base_color: Vec3::new(0.9, 0.5, 0.3),
            metallic: if i % 2 == 0 { 1.0 } else { 0.0 },
            transmission: if i % 3 == 1 { 1.0 } else { 0.0 },
            roughness: 0.05,
            ..Material::default()
        };
        add_surface(
            &mut scene,
            Surface::Sphere(Sphere {
                center,
                radius: 0.5,
            }),
            material,
        );
    }
    scene
        .lights
        .push(point_light(Vec3::new(4.0, 6.0, 3.0), 300.0));
    scene
}

fn busy_camera() -> Camera {
    Camera::look_at("busy", Vec3::new(0.5, 1.0, 7.0), Vec3::ZERO, Vec3::Y, 0.7)
}

/// A part of a picture has the bytes that it has in the whole.
#[test]
fn crop_equals_its_part_of_the_whole() {
    for few in [true, false] {
        for sampling in [
            Sampling::Fixed { spp: 3 },
            Sampling::Adaptive {
                threshold: 0.1,
                levels: 2,
            },
        ] {
            let whole = Settings {
                resolution: [90, 60],
                sampling,
                ..Settings::default()
            };
            let [x0, y0, x1, y1] = [13, 7, 71, 52];
            let part = Settings {
                crop: Some([x0, y0, x1, y1]),
                ..whole.clone()
            };
            let scene = busy_scene(few);
            let (a, b) = (
                draw(&scene, &busy_camera(), &whole),
                draw(&scene, &busy_camera(), &part),
            );
            for y in 0..60 {
                for x in 0..90 {
                    let inside = (x0..x1).contains(&x) && (y0..y1).contains(&y);
                    let i = (y * 90 + x) as usize;
                    let expected = if inside { a.image.pixels[i] } else { [0.0; 4] };
                    assert_eq!(
                        b.image.pixels[i], expected,
                        "{x},{y} few {few} {sampling:?}"
                    );
                }
            }
        }
    }
}

/// A handful of surfaces gives the picture that the tree gives.
#[test]
fn a_list_is_as_good_as_a_tree() {
    let scene = busy_scene(true);
    let mut with_tree = scene.clone();
    // An instance that no ray meets, but that no list can hold.
    add_mesh(&mut with_tree, Mesh::default(), Material::default());
    let settings = Settings {
        resolution: [90, 60],
        ..Settings::default()
    };
    let picture = |scene: &Scene| draw(scene, &busy_camera(), &settings).image;
    assert!(picture(&scene) == picture(&with_tree));
}

/// Whitted's adaptive sampling comes near many samples a pixel, nearer than one sample does, at any exposure.
#[test]
fn adaptive_sampling_smooths_edges() {
    for scale in [1.0, 1e4] {
        let mut scene = Scene {
            environment: sky(Vec3::splat(scale)),
            ..Scene::default()
        };
        add_surface(
            &mut scene,
            Surface::Sphere(Sphere {
                center: Vec3::ZERO,
                radius: 1.0,
            }),
            matte(Vec3::ZERO),
        );
        let picture = |sampling| {
            let settings = Settings {
                resolution: [64, 48],
                sampling,
                ..Settings::default()
            };
            draw(&scene, &busy_camera(), &settings).image.pixels
        };
        let truth = picture(Sampling::Fixed { spp: 400 });
        let error = |sampling| {
            let squares = picture(sampling)
                .iter()
                .zip(&truth)
                .map(|(a, b)| ((a[0] - b[0]) / scale).powi(2))
                .sum::<f32>();
            (squares / truth.len() as f32).sqrt()
        };
        let adaptive = error(Sampling::Adaptive {
            threshold: 0.1,
            levels: 3,
        });
        let single = error(Sampling::Fixed { spp: 1 });
        assert!(
            adaptive < 0.01 && single > 5.0 * adaptive,
            "{adaptive} against {single}"
        );
    }
}

/// The layers state the closed forms of a sphere in front of the eye.
#[test]
fn layers_hold_what_is_hit() {
    let mut scene = Scene::default();
    add_surface(
        &mut scene,
        Surface::Plane(Plane {
            point: Vec3::ZERO,
            normal: Vec3::Z,
        }),
        matte(Vec3::ONE),
    );
    add_surface(
        &mut scene,
        Surface::Sphere(Sphere {
            center: Vec3::Z,
            radius: 0.5,
        }),
        matte(Vec3::new(0.1, 0.2, 0.3)),
    );
    scene.validate().expect("valid");
    let settings = Settings {
        resolution: [3, 3],
        ..Settings::default()
    };
    let camera = Camera::look_at("front", Vec3::Z * 5.0, Vec3::ZERO, Vec3::Y, 0.5 * PI);
    let layers = render_aovs(&SceneBvh::build(&scene), &camera, &settings, &Aov::ALL);
    let at = |aov: Aov, pixel: usize| {
        let layer = layers
            .iter()
            .find(|layer| layer.names == aov.channels())
            .expect("all layers were asked for");
        layer
            .channels
            .iter()
            .map(|channel| channel[pixel])
            .collect::<Vec<f32>>()
    };
    // The middle pixel sees the sphere's front, the first one the plane: at the same depth everywhere.
    assert_eq!(at(Aov::Depth, 4), [3.5]);
    assert_eq!(at(Aov::Normal, 4), [0.0, 0.0, 1.0]);
    assert_eq!(at(Aov::Position, 4), [0.0, 0.0, 1.5]);
    assert_eq!(at(Aov::Albedo, 4), [0.1, 0.2, 0.3]);
    assert_eq!(
        [
            at(Aov::Instance, 4),
            at(Aov::Primitive, 4),
            at(Aov::Material, 4)
        ],
        [[2.0], [1.0], [2.0]]
    );
    assert!((at(Aov::Depth, 0)[0] - 5.0).abs() < 1e-5);
    let p = at(Aov::Position, 0);
    // A third of the picture from its middle, at 45 degrees to the edge: 2/3 · 5 m.
    assert!(
        (p[0] + 10.0 / 3.0).abs() < 1e-4 && (p[1] - 10.0 / 3.0).abs() < 1e-4,
        "{p:?}"
    );
    assert_eq!([at(Aov::Instance, 0), at(Aov::Material, 0)], [[1.0], [1.0]]);
}

/// A render that is told to stop leaves what it did, and nothing where it did not get.
#[test]
fn stopping_keeps_what_is_done() {
    let scene = busy_scene(false);
    let stop = AtomicBool::new(false);
    let control = Control {
        stop: &stop,
        progress: &|_, _| stop.store(true, std::sync::atomic::Ordering::Relaxed),
    };
    let settings = Settings {
        resolution: [640, 480],
        ..Settings::default()
    };
    let film = render(
        &SceneBvh::build(&scene),
        &busy_camera(),
        &settings,
        &control,
    );
    let done = film.image.pixels.iter().filter(|p| p[3] == 1.0).count();
    assert!(done > 0 && done < 640 * 480, "{done}");
    assert_eq!(done as u64, film.stats.pixels);
    assert!(
        film.image
            .pixels
            .iter()
            .all(|p| p[3] == 1.0 || *p == [0.0; 4])
    );
}
