//! Public test models, with their known numbers of triangles and boxes.

use std::{env, path::PathBuf};
use umbriel_formats::{Report, import_model};
use umbriel_render::{
    Geometry, Scene,
    kernels::{Aabb, glam::Vec3},
};

/// The folder of test models that `UMBRIEL_ASSETS` names; `None` where there is none.
fn assets() -> Option<PathBuf> {
    let folder = env::var_os("UMBRIEL_ASSETS").map(PathBuf::from);
    let folder = folder.filter(|folder| folder.is_dir());
    let required = env::var_os("UMBRIEL_REQUIRE_ASSETS").is_some();
    assert!(folder.is_some() || !required, "no test models");
    if folder.is_none() {
        println!("skipped: no test models; UMBRIEL_ASSETS names their folder");
    }
    folder
}

fn load(file: &str) -> Option<(Scene, Report)> {
    let mut report = Report::default();
    let path = assets()?.join(file);
    let scene = import_model(&path, &mut report).unwrap_or_else(|error| panic!("{error}"));
    Some((scene, report))
}

/// Triangles of all instances, and the box around them in the world.
fn facts(scene: &Scene) -> (usize, Aabb) {
    let mut bounds = Aabb::EMPTY;
    let mut triangles = 0;
    for instance in &scene.instances {
        let Geometry::Mesh(id) = instance.geometry else {
            continue;
        };
        let mesh = &scene.meshes[id.index()];
        triangles += mesh.indices.len();
        let points = mesh.indices.iter().flatten().map(|&i| {
            instance
                .transform
                .transform_point3(mesh.positions[i as usize])
        });
        bounds = bounds.union(Aabb::from_points(points));
    }
    (triangles, bounds)
}

const UNIT: Option<[[f32; 3]; 2]> = Some([[-0.5; 3], [0.5; 3]]);
const TWO: Option<[[f32; 3]; 2]> = Some([[-1.0; 3], [1.0; 3]]);

/// Least and greatest corner of a box.
type Corners = [[f32; 3]; 2];

/// File, triangles with the degenerate ones, box where it is known.
const MODELS: [(&str, usize, Option<Corners>); 45] = [
    ("gltf-box/Box.glb", 12, UNIT),
    ("gltf-box-textured/BoxTextured.glb", 12, None),
    ("gltf-box-vertex-colors/BoxVertexColors.glb", 12, None),
    ("gltf-box-interleaved/BoxInterleaved.glb", 12, UNIT),
    ("gltf-cube-quantized/cubeQuantized.glb", 12, None),
    (
        "gltf-simple-sparse-accessor/SimpleSparseAccessor.gltf",
        12,
        Some([[0.0; 3], [6.0, 4.0, 0.0]]),
    ),
    (
        "gltf-triangle-without-indices/TriangleWithoutIndices.gltf",
        1,
        None,
    ),
    ("gltf-cameras/Cameras.gltf", 2, None),
    ("gltf-simple-skin/SimpleSkin.gltf", 8, None),
    ("gltf-simple-morph/SimpleMorph.gltf", 1, None),
    (
        "gltf-texture-transform-test/TextureTransformTest.gltf",
        24,
        None,
    ),
    (
        "gltf-texture-settings-test/TextureSettingsTest.gltf",
        72,
        None,
    ),
    ("gltf-vertex-color-test/VertexColorTest.gltf", 36, None),
    ("gltf-unlit-test/UnlitTest.gltf", 88, None),
    ("gltf-two-sided-plane/TwoSidedPlane.gltf", 2, None),
    (
        "gltf-alpha-blend-mode-test/AlphaBlendModeTest.glb",
        61,
        None,
    ),
    ("gltf-alpha-mask/01_alpha_mask.gltf", 2, None),
    ("gltf-suzanne/02_suzanne.gltf", 3936, None),
    ("gltf-node-hierarchy/02_node_hierarchy.gltf", 60, None),
    (
        "gltf-emissive-strength/14_emission_strength.gltf",
        17_280,
        None,
    ),
    ("gltf-transmission/15_transmission.gltf", 4800, None),
    ("gltf-volume-attenuation/16_volume.gltf", 296, None),
    ("gltf-ior/17_ior.gltf", 60, None),
    ("gltf-gpu-instancing/24_gpu_instancing.gltf", 8066, None),
    ("gltf-lights-punctual/sphere_lights.gltf", 224, None),
    (
        "gltf-scaled-instances/spheres_scaled_instances.gltf",
        672,
        Some([[-3.0; 3], [3.0; 3]]),
    ),
    (
        "gltf-negative-scale/one_face_123_mirror.gltf",
        1,
        Some([[-3.0, -0.11, 0.0], [-1.0, -0.01, 0.0]]),
    ),
    ("gltf-fox/Fox.glb", 576, None),
    ("obj-spot/spot.obj", 5856, None),
    ("obj-spot/spot_quadrangulated.obj", 5856, None),
    (
        "obj-utah-teapot/teapot.obj",
        6320,
        Some([[-3.0, 0.0, -2.0], [3.434, 3.15, 2.0]]),
    ),
    (
        "obj-cornell-box/cornell_box.obj",
        36,
        Some([[0.0; 3], [556.0, 548.8, 559.2]]),
    ),
    (
        "obj-box-complex-material/box-complex-material.obj",
        12,
        None,
    ),
    ("obj-negative-indices/box-negative-indices.obj", 12, TWO),
    ("obj-concave/concave.obj", 16, None),
    ("ply-bob/bob_small.ply", 500, None),
    ("ply-icosahedron/icosahedron.ply", 20, None),
    ("ply-icosahedron/icosahedron_ascii.ply", 20, None),
    ("ply-pos-color/test_pos_color.ply", 224, TWO),
    ("ply-pos-color/test_pos_color_ascii.ply", 224, TWO),
    (
        "ply-cube-binary/cube_binary.ply",
        12,
        Some([[0.0; 3], [1.0; 3]]),
    ),
    ("stl-sphere/test_sphere.stl", 224, TWO),
    ("stl-sphere/test_sphere_ascii.stl", 224, TWO),
    (
        "stl-half-donut/HalfDonut_ascii.stl",
        288,
        Some([[0.0; 3], [3.0, 0.5, 3.0]]),
    ),
    (
        "stl-half-donut/HalfDonut_binary.stl",
        288,
        Some([[0.0; 3], [3.0, 0.5, 3.0]]),
    ),
];

#[test]
fn models_have_their_triangles_and_boxes() {
    if assets().is_none() {
        return;
    }
    let mut wrong = Vec::new();
    for (file, triangles, bounds) in MODELS {
        let (scene, report) = load(file).expect("the folder exists");
        let (found, found_bounds) = facts(&scene);
        let degenerate: usize = report
            .ignored
            .get("degenerate triangle")
            .copied()
            .unwrap_or(0);
        if found + degenerate != triangles {
            wrong.push(format!(
                "{file}: {found} triangles and {degenerate} degenerate ones; expected {triangles}"
            ));
        }
        let Some([min, max]) = bounds.map(|b| b.map(Vec3::from)) else {
            continue;
        };
        let off = (found_bounds.min - min)
            .abs()
            .max((found_bounds.max - max).abs())
            .max_element();
        if !(off <= 1e-3 * (max - min).max_element()) {
            wrong.push(format!("{file}: box {found_bounds:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn unsupported_compression_is_named() {
    let Some(folder) = assets() else { return };
    for (file, name) in [
        ("gltf-box-draco/Box_Draco.glb", "KHR_draco_mesh_compression"),
        ("gltf-box-meshopt/BoxMeshopt.glb", "EXT_meshopt_compression"),
    ] {
        let error = import_model(&folder.join(file), &mut Report::default()).unwrap_err();
        assert!(
            error.message.contains(name) && error.to_string().contains("/extensionsRequired/"),
            "{error}"
        );
    }
}

#[test]
fn lights_cameras_textures_and_instancing() {
    let Some((lights, _)) = load("gltf-lights-punctual/sphere_lights.gltf") else {
        return;
    };
    assert_eq!(lights.lights.len(), 4);
    let (cameras, _) = load("gltf-cameras/Cameras.gltf").unwrap();
    assert_eq!(cameras.cameras.len(), 2);
    let (instanced, report) = load("gltf-gpu-instancing/24_gpu_instancing.gltf").unwrap();
    assert!(!instanced.instances.is_empty());
    assert!(
        report
            .ignored
            .contains_key("extension EXT_mesh_gpu_instancing"),
        "{report:?}"
    );
    let (spheres, _) = load("gltf-scaled-instances/spheres_scaled_instances.gltf").unwrap();
    assert_eq!((spheres.meshes.len(), spheres.instances.len()), (1, 3));
    let (suzanne, _) = load("gltf-suzanne/02_suzanne.gltf").unwrap();
    assert_eq!(suzanne.textures.len(), 3);
    let (obj, report) = load("obj-box-complex-material/box-complex-material.obj").unwrap();
    assert!(
        obj.materials[0].base_color_texture.is_some()
            && obj.materials[0].emission_texture.is_some(),
        "{report:?}"
    );
}

/// The fox stands on its feet, as long as it is.
#[test]
fn the_fox_is_skinned() {
    let Some((fox, _)) = load("gltf-fox/Fox.glb") else {
        return;
    };
    let (_, bounds) = facts(&fox);
    let size = bounds.extent();
    assert!(
        size.z > 2.0 * size.x && size.z > size.y && bounds.min.y > -3.0,
        "{bounds:?}"
    );
}

#[test]
fn both_forms_of_a_mesh_agree() {
    let Some((binary, _)) = load("ply-pos-color/test_pos_color.ply") else {
        return;
    };
    let (ascii, _) = load("ply-pos-color/test_pos_color_ascii.ply").unwrap();
    assert_eq!(binary.meshes[0].indices, ascii.meshes[0].indices);
    assert_eq!(binary.meshes[0].colors, ascii.meshes[0].colors);
    let (binary, _) = load("stl-half-donut/HalfDonut_binary.stl").unwrap();
    let (ascii, _) = load("stl-half-donut/HalfDonut_ascii.stl").unwrap();
    assert_eq!(facts(&binary).0, facts(&ascii).0);
}
