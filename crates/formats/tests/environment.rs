//! Pictures around a scene: what is read, and what is said of what is wrong.

use image::{Rgb, codecs::hdr::HdrEncoder};
use std::{fs, path::Path};
use umbriel_formats::{
    ExrInfo, FileError, LoadOptions, Loaded, encode_exr, load_scene,
    render::{EnvironmentMap, Image, kernels::glam::Vec3},
};

const MAPPED: &str = include_str!("mapped.toml");

fn load(folder: &Path, text: &str) -> Result<Loaded, FileError> {
    let path = folder.join("scene.toml");
    fs::write(&path, text).unwrap();
    load_scene(&path, &LoadOptions::default())
}

fn write_hdr(folder: &Path, colors: &[[f32; 3]], width: usize) {
    let texels: Vec<Rgb<f32>> = colors.iter().map(|c| Rgb(*c)).collect();
    let mut bytes = Vec::new();
    let encoder = HdrEncoder::new(&mut bytes);
    encoder
        .encode(&texels, width, colors.len() / width)
        .unwrap();
    fs::write(folder.join("sky.hdr"), bytes).unwrap();
}

fn map(loaded: Loaded) -> EnvironmentMap {
    loaded.scene.environment_map.expect("a map")
}

/// Ahead in the file is on the left after a quarter of a turn, and twice as bright by its strength.
#[test]
fn maps_are_turned_and_scaled() {
    let folder = tempfile::tempdir().unwrap();
    let colors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.5; 3]];
    write_hdr(folder.path(), &colors, 4);
    let found = map(load(folder.path(), MAPPED).unwrap());
    let at = |x: f32, z: f32| found.radiance(Vec3::new(x, 0.0, z).normalize());
    // The second texel is ahead on the left; it goes to behind on the left.
    assert!(
        (at(-1.0, 1.0) - 2.0 * Vec3::Y).length() < 0.05,
        "{}",
        at(-1.0, 1.0)
    );
    assert!((at(-1.0, -1.0) - 2.0 * Vec3::Z).length() < 0.05);
}

/// EXR too; what is no light is mended, and counted.
#[test]
fn wrong_texels_are_counted() {
    let folder = tempfile::tempdir().unwrap();
    let pixels = vec![
        [f32::INFINITY, 1.0, 1.0, 1.0],
        [f32::NAN, 1.0, 1.0, 1.0],
        [-1.0, 0.0, 0.0, 1.0],
        [0.25, 0.5, 1.0, 1.0],
    ];
    let image = Image {
        width: 4,
        height: 1,
        pixels,
    };
    let bytes = encode_exr(&image, &[], &ExrInfo::default());
    fs::write(folder.path().join("sky.hdr"), bytes).unwrap();
    let loaded = load(folder.path(), MAPPED).unwrap();
    let notes = loaded.report.notes.join("\n");
    assert!(
        notes.contains("2 texels were negative or no numbers"),
        "{notes}"
    );
    assert!(notes.contains("1 texels were above 65504"), "{notes}");
    let found = map(loaded);
    for x in [-1.0, 1.0] {
        for z in [-1.0, 1.0] {
            assert!(found.radiance(Vec3::new(x, 0.0, z).normalize()).is_finite());
        }
    }
}

#[test]
fn faults_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let error = |text: &str| load(folder.path(), text).err().unwrap().to_string();
    assert!(error(MAPPED).contains("sky.hdr"));
    fs::write(folder.path().join("sky.hdr"), b"no picture").unwrap();
    assert!(error(MAPPED).contains("expected a Radiance HDR or an EXR picture"));
    let huge = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 100000 +X 100000\n";
    fs::write(folder.path().join("sky.hdr"), huge).unwrap();
    assert!(
        error(MAPPED).contains("expected at most 67108864"),
        "{}",
        error(MAPPED)
    );
    let short = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 64 +X 128\n";
    fs::write(folder.path().join("sky.hdr"), short).unwrap();
    assert!(error(MAPPED).contains("bad Radiance HDR"));
    for (text, words) in [
        ("environment.strength = 2", "`strength` belongs to a `map`"),
        ("environment.rotation = 2", "`rotation` belongs to a `map`"),
        (
            "environment = { map = \"sky.hdr\", color = 1 }",
            "`map` stands for `color`, `zenith` and `nadir`",
        ),
        (
            "environment = { map = \"sky.hdr\", strength = -1 }",
            "`strength` is -1; must be from 0 to 1000000",
        ),
        ("environment = { map = \"../sky.hdr\" }", "folder"),
    ] {
        assert!(error(text).contains(words), "{text}: {}", error(text));
    }
}

/// A scene in the dark but for a black map is told so as any other; nothing is divided by 0.
#[test]
fn black_maps_light_nothing() {
    let folder = tempfile::tempdir().unwrap();
    write_hdr(folder.path(), &[[0.0; 3]; 8], 4);
    assert!(map(load(folder.path(), MAPPED).unwrap()).is_black());
}
