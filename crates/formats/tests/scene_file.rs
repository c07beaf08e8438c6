//! Scene files: our own scenes, the schema, and what every key does.

use std::path::{Path, PathBuf};
use umbriel_formats::render::{Light, Projection, Sampling, ShadowFilter, Texture};
use umbriel_formats::{LoadOptions, Loaded, load_scene, scene_schema};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn load(text: &str) -> Loaded {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).unwrap();
    load_scene(&path, &LoadOptions::default())
        .unwrap_or_else(|e| panic!("{e}\n{}", e.snippet.clone().unwrap_or_default()))
}

#[test]
fn all_scenes_load() {
    let mut count = 0;
    for entry in std::fs::read_dir(root().join("scenes")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "toml") {
            let loaded = load_scene(&path, &LoadOptions::default())
                .unwrap_or_else(|e| panic!("{e}\n{}", e.snippet.clone().unwrap_or_default()));
            assert!(
                loaded.report.ignored.is_empty() && loaded.report.notes.is_empty(),
                "{path:?}: {:?}",
                loaded.report
            );
            assert_eq!(loaded.scene.validate(), Ok(()));
            count += 1;
        }
    }
    assert!(count >= 15, "{count} scenes");
}

/// Regenerate with `UPDATE_SCHEMA=1 cargo test -p umbriel-formats --test scene_file`.
#[test]
fn the_schema_is_up_to_date() {
    let path = root().join("schema/scene.schema.json");
    let schema = scene_schema();
    if std::env::var_os("UPDATE_SCHEMA").is_some() {
        std::fs::write(&path, &schema).unwrap();
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        committed == schema,
        "schema/scene.schema.json is out of date; regenerate it: UPDATE_SCHEMA=1 cargo test -p umbriel-formats --test scene_file"
    );
}

/// Every key that the schema lists, in one file.
const EVERYTHING: &str = include_str!("everything.toml");

#[test]
fn every_key_is_understood() {
    let Loaded {
        scene, settings, ..
    } = load(EVERYTHING);
    assert_eq!(
        settings.sampling,
        Some(Sampling::Adaptive {
            threshold: 0.1,
            levels: 3
        })
    );
    assert_eq!(settings.resolution, Some([320, 200]));
    assert_eq!(
        (settings.depth, settings.seed, settings.exposure),
        (Some(4), Some(7), Some(-1.5))
    );
    assert_eq!(settings.min_weight, Some(0.001));
    assert_eq!(settings.shadows, Some(false));
    assert_eq!(
        (
            scene.surfaces.len(),
            scene.instances.len(),
            scene.lights.len()
        ),
        (9, 9, 4)
    );
    assert_eq!(scene.environment.zenith.to_array(), [0.1, 0.2, 0.3]);
    assert_eq!(scene.environment.nadir.to_array(), [0.5; 3]);
    let Projection::Orthographic { half_height } = scene.cameras[1].projection else {
        panic!()
    };
    assert_eq!(half_height, 2.0);
    let glass = &scene.materials[0];
    assert_eq!(
        (glass.ior, glass.transmission, glass.attenuation_distance),
        (1.33, 1.0, 2.0)
    );
    let used = glass.base_color_texture.unwrap();
    assert_eq!(used.uv_set, 1);
    assert_eq!(used.transform.translation.to_array(), [0.5, 0.25]);
    assert!(
        matches!(scene.textures[0], Texture::Checker(c) if c.odd.to_array() == [0.2, 0.2, 0.2, 1.0])
    );
    let Light::Spot(spot) = &scene.lights[1] else {
        panic!()
    };
    assert!(
        (spot.direction.y + 1.0).abs() < 1e-6
            && (spot.outer_angle.to_degrees() - 30.0).abs() < 1e-4
    );
    // Rotated about x by 90°, y becomes z; then scaled before, moved after.
    let p = scene.instances[0]
        .transform
        .transform_point3([0.0, 1.0, 0.0].into());
    assert!(
        (p - umbriel_formats::render::kernels::glam::Vec3::new(1.0, 2.0, 5.0)).length() < 1e-5,
        "{p}"
    );
    assert!(scene.instances[0].inside_out);
}

/// A light's own table goes first, then that of all lights, then the default; models have the latter two.
#[test]
fn shadow_maps_follow_the_lights() {
    let Loaded {
        scene, settings, ..
    } = load(EVERYTHING);
    let said = |i: usize| {
        let map = settings.shadow_maps[i];
        let (name, degrees) = (scene.lights[i].name(), map.light_size.to_degrees());
        let size = if name == "d" { degrees } else { map.light_size };
        let (resolution, cascades) = (map.resolution, map.cascades);
        format!(
            "{name} {resolution} {} {} {cascades} {size:.3}",
            map.bias, map.filter
        )
    };
    assert_eq!(settings.shadow_maps.len(), scene.lights.len());
    let splits: Vec<f32> = (settings.shadow_maps.iter())
        .map(|map| map.cascade_split)
        .collect();
    assert!(
        splits.contains(&0.5) && splits.contains(&0.75),
        "{splits:?}"
    );
    assert_eq!(said(0), "p 256 constant:0.02m pcf:3 2 0.250");
    assert_eq!(said(1), "s 512 slope-scaled:1.5 pcf:3 2 0.500");
    assert_eq!(said(3), "d 1024 slope-scaled:1.5 pcss:64 4 0.530");
    // Daylight comes from no table, and an included file goes after the one that includes it.
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let base = "[render.shadow_map]\nresolution = 64\nfilter = \"pcf:5\"\n";
    write("base.toml", base);
    let scene = "include = [\"base.toml\"]\nrender.shadow_map.resolution = 32\n[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n";
    write("scene.toml", scene);
    let options = LoadOptions {
        light_size: Some(1000.0),
        ..LoadOptions::default()
    };
    let loaded = load_scene(&folder.path().join("scene.toml"), &options).unwrap();
    let [map] = loaded.settings.shadow_maps[..] else {
        panic!("one sun")
    };
    assert_eq!(
        (map.resolution, map.filter),
        (32, ShadowFilter::Pcf { side: 5 })
    );
    assert_eq!(
        map.light_size,
        LoadOptions::MAX_LIGHT_DEGREES.to_radians(),
        "less than half of the sky"
    );
}

/// The names of the schema's properties all stand in the file of the test above.
#[test]
fn the_everything_file_has_every_key() {
    let schema: serde_json::Value = serde_json::from_str(&scene_schema()).unwrap();
    let mut missing = Vec::new();
    let tables = schema["$defs"]
        .as_object()
        .unwrap()
        .values()
        .chain([&schema]);
    for key in tables
        .filter_map(|t| t["properties"].as_object())
        .flat_map(|p| p.keys())
    {
        let written = EVERYTHING
            .split(|c: char| !c.is_alphanumeric() && c != '_')
            .any(|word| word == key);
        // These need files, and have tests of their own.
        if !written
            && ![
                "include", "file", "image", "encoding", "wrap", "filter", "mesh", "model", "spp",
                "color", "map", "strength",
            ]
            .contains(&key.as_str())
        {
            missing.push(key.clone());
        }
    }
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn an_empty_file_is_a_background() {
    for text in ["", "\u{feff}", "\u{feff}# nothing\r\n", "\r\n\t\r\n"] {
        let loaded = load(text);
        assert!(loaded.scene.instances.is_empty());
        assert!(
            loaded.report.notes[0].contains("background"),
            "{:?}",
            loaded.report
        );
        assert_eq!(loaded.scene.cameras.len(), 1);
    }
}

#[test]
fn included_and_imported_files_join_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let triangle = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                    element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    write("t.ply", triangle);
    write(
        "materials.toml",
        "[render]\ndepth = 2\nspp = 9\n[[material]]\nname = \"red\"\n",
    );
    write(
        "scene.toml",
        "include = [\"materials.toml\"]\n[render]\ndepth = 5\n[[sphere]]\ncenter = [0,0,0]\nradius = 1\nmaterial = \"red\"\n\
         [[mesh]]\nname = \"m\"\nfile = \"t.ply\"\nmaterial = \"red\"\ntransform = { translate = [1, 2, 3] }\n\
         [[model]]\nfile = \"t.ply\"\n",
    );
    let loaded = load_scene(&folder.path().join("scene.toml"), &LoadOptions::default()).unwrap();
    let scene = &loaded.scene;
    assert_eq!(
        (loaded.settings.depth, loaded.settings.sampling),
        (Some(5), Some(Sampling::Fixed { spp: 9 }))
    );
    assert_eq!((scene.meshes.len(), scene.instances.len()), (2, 3));
    assert_eq!(scene.instances[0].material, scene.instances[1].material);
    assert!(scene.instances[1].name.starts_with('m'));
    assert_eq!(
        scene.instances[1].transform.translation.to_array(),
        [1.0, 2.0, 3.0]
    );
    assert_ne!(scene.instances[2].material, scene.instances[1].material);
}

/// A scene file is rendered as it says; for a model nobody has said anything.
#[test]
fn models_are_smooth_unless_asked_otherwise() {
    assert_eq!(load("").settings.sampling, None);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("triangle.obj");
    std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let loaded = load_scene(&path, &LoadOptions::default()).unwrap();
    assert_eq!(loaded.settings.sampling, Some(Sampling::Fixed { spp: 4 }));
    assert_eq!(loaded.settings.shadow_maps.len(), loaded.scene.lights.len());
    assert_eq!(loaded.report.files.into_iter().collect::<Vec<_>>(), [path]);
}
