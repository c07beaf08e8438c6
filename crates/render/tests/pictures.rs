//! Properties of whole pictures: orientation of images and normals, what is there from which side, holes.

mod support;

use std::f32::consts::PI;
use support::{
    add_instance, add_mesh, add_surface, close, eye, look, matte, point_light, ray_cast, sky, sun,
};
use umbriel_render::{
    Camera, Encoding, Filter, Geometry, ImageTexture, Light, Material, Mesh, MeshId, Scene,
    SpotLight, Texture, TextureId, TextureRef, Wrap,
    kernels::{
        Cuboid, Plane, Rectangle, Sphere, Surface,
        glam::{Affine2, Affine3A, Vec2, Vec3},
    },
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
        diameter: 0.0,
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
