//! Faults that only importers and callers from Rust can make; scene files have a test of their own.

use umbriel_render::kernels::glam::{Affine3A, Vec2, Vec3, Vec4};
use umbriel_render::{
    Camera, Element, Encoding, Filter, Geometry, ImageTexture, Instance, Material, MaterialId,
    Mesh, MeshId, Scene, Texture, TextureId, TextureRef, Wrap,
};

fn valid() -> Scene {
    let mesh = Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        normals: vec![Vec3::Z; 3],
        indices: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    let image = ImageTexture {
        name: String::new(),
        width: 2,
        height: 1,
        texels: vec![[0; 4]; 2],
        encoding: Encoding::Srgb,
        wrap: [Wrap::Repeat; 2],
        filter: Filter::Bilinear,
    };
    let used = TextureRef {
        texture: TextureId(0),
        uv_set: 0,
        transform: Default::default(),
    };
    Scene {
        cameras: vec![Camera::look_at("a", Vec3::Z, Vec3::ZERO, Vec3::Y, 1.0)],
        meshes: vec![mesh],
        instances: vec![Instance {
            name: String::new(),
            geometry: Geometry::Mesh(MeshId(0)),
            transform: Affine3A::from_scale(Vec3::new(1e-4, -1e4, 1.0)),
            material: MaterialId(0),
            inside_out: false,
        }],
        materials: vec![Material {
            base_color_texture: Some(used),
            ..Material::default()
        }],
        textures: vec![Texture::Image(image)],
        ..Scene::default()
    }
}

/// One change to the valid scene, the element at fault and its field.
type Case = (fn(&mut Scene), Element, &'static str);

#[test]
fn every_fault_is_found_and_named() {
    assert_eq!(valid().validate(), Ok(()));
    let cases: &[Case] = &[
        (
            |s| s.cameras[0].pose = Affine3A::from_scale(Vec3::splat(2.0)),
            Element::Camera(0),
            "pose",
        ),
        (
            |s| s.cameras[0].pose = Affine3A::from_scale(Vec3::new(1.0, 1.0, -1.0)),
            Element::Camera(0),
            "pose",
        ),
        (
            |s| {
                s.cameras
                    .push(Camera::look_at("b", Vec3::Y, Vec3::ZERO, Vec3::Y, 1.0))
            },
            Element::Camera(1),
            "pose",
        ),
        (|s| s.cameras[0].near = 0.0, Element::Camera(0), "near"),
        (|s| s.cameras[0].far = 0.0, Element::Camera(0), "far"),
        (
            |s| s.meshes[0].normals.truncate(2),
            Element::Mesh(0),
            "normals",
        ),
        (
            |s| s.meshes[0].uvs[1] = vec![Vec2::ZERO],
            Element::Mesh(0),
            "uvs",
        ),
        (
            |s| s.meshes[0].colors = vec![Vec4::NAN; 3],
            Element::Mesh(0),
            "attributes",
        ),
        (
            |s| s.meshes[0].positions[1].x = f32::NAN,
            Element::Mesh(0),
            "positions",
        ),
        (
            |s| s.meshes[0].indices.push([0, 1, 3]),
            Element::Mesh(0),
            "indices",
        ),
        (|s| s.meshes.clear(), Element::Instance(0), "geometry"),
        (|s| s.materials.clear(), Element::Instance(0), "material"),
        (
            |s| s.instances[0].transform = Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0)),
            Element::Instance(0),
            "transform",
        ),
        (
            |s| s.instances[0].transform.translation.y = f32::INFINITY,
            Element::Instance(0),
            "transform",
        ),
        (
            |s| s.textures.clear(),
            Element::Material(0),
            "base_color_texture",
        ),
        (
            |s| {
                s.textures[0] = Texture::Image(ImageTexture {
                    texels: vec![],
                    ..image(s)
                })
            },
            Element::Texture(0),
            "texels",
        ),
        (
            |s| {
                s.textures[0] = Texture::Image(ImageTexture {
                    width: 0,
                    texels: vec![],
                    ..image(s)
                })
            },
            Element::Texture(0),
            "texels",
        ),
        (
            |s| s.environment.nadir = Vec3::NEG_ONE,
            Element::Environment,
            "nadir",
        ),
    ];
    for (i, (change, element, field)) in cases.iter().enumerate() {
        let mut scene = valid();
        change(&mut scene);
        let error = scene.validate().expect_err(&format!("case {i}"));
        assert_eq!(
            (error.element, error.field),
            (*element, *field),
            "case {i}: {error}"
        );
        assert!(
            error.message.starts_with("is ") || error.message.starts_with("contain"),
            "{error}"
        );
    }
}

fn image(scene: &Scene) -> ImageTexture {
    match &scene.textures[0] {
        Texture::Image(image) => image.clone(),
        Texture::Checker(_) => unreachable!("the valid scene has an image"),
    }
}
