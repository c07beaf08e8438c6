//! Broken and hostile models: a clean error with a place, never a panic.

mod gltf;
mod gltf_light;
mod images;
mod obj;
mod ply;
mod stl;

use crate::{
    gltf::{glb, triangle_bytes, triangle_json},
    images::bomb,
    ply::PLY,
    stl::stl,
};
use proptest::{prelude::*, test_runner::RngSeed};
use std::{fs, path::Path};
use umbriel_formats::{ErrorKind, FileError, Report, import_model};
use umbriel_render::Scene;

/// Imports `bytes` as a file of that name in a folder of its own.
fn import(name: &str, bytes: impl AsRef<[u8]>) -> Result<(Scene, Report), FileError> {
    let folder = tempfile::tempdir().unwrap();
    import_in(folder.path(), name, bytes)
}

fn import_in(
    folder: &Path,
    name: &str,
    bytes: impl AsRef<[u8]>,
) -> Result<(Scene, Report), FileError> {
    let path = folder.join(name);
    fs::write(&path, bytes).unwrap();
    let mut report = Report::default();
    import_model(&path, &mut report).map(|scene| (scene, report))
}

#[test]
fn the_content_decides_what_a_file_is() {
    let message = |name: &str, bytes: &[u8]| import(name, bytes).map(|_| ()).unwrap_err().message;
    assert!(message("a.glb", &bomb()).contains("is a PNG image"));
    assert!(message("a.obj", b"glTF\x02\0\0\0").contains("binary glTF"));
    assert!(message("a.xyz", b"").contains(".gltf, .glb, .obj, .ply or .stl"));
    let folder = tempfile::tempdir().unwrap();
    let error = import_model(folder.path(), &mut Report::default()).unwrap_err();
    assert!(error.message.contains("folder"), "{error}");
    let error = import_model(&folder.path().join("none.glb"), &mut Report::default()).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Io);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    /// Any few bytes of a small file are changed: it is read or refused.
    #[test]
    fn changed_bytes_never_panic(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)) {
        let obj = "mtllib a.mtl\nv 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 1\nvn 0 0 1\no a\nusemtl m\nf 1/1/1 2//1 3/1 -1\n";
        let text_stl = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid";
        let binary_ply = [PLY.split_once("0 0 0").unwrap().0.replace("ascii", "binary_little_endian").as_bytes(), &[7; 49]].concat();
        for (name, mut bytes) in [
            ("t.glb", glb(&triangle_json(), &triangle_bytes())),
            ("t.obj", obj.as_bytes().to_vec()),
            ("t.ply", PLY.as_bytes().to_vec()),
            ("t.ply", binary_ply),
            ("t.stl", text_stl.as_bytes().to_vec()),
            ("t.stl", stl(2, 2)),
        ] {
            for (place, value) in &changes {
                let i = place.index(bytes.len());
                bytes[i] = *value;
            }
            let _ = import(name, bytes);
        }
    }
}
