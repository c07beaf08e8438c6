//! Broken and hostile models: a clean error with a place, never a panic.

use proptest::prelude::*;
use std::{fs, path::Path};
use umbriel_formats::{ErrorKind, FileError, Place, Report, import_model};
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

/// Three vertices and three indices: the JSON and the 42 bytes of its buffer (44 with padding).
fn triangle_json() -> String {
    r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
"buffers":[{"byteLength":42}]}"#
        .to_owned()
}

fn triangle_bytes() -> Vec<u8> {
    let positions = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let mut bytes: Vec<u8> = positions.iter().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend([0_u16, 1, 2].iter().flat_map(|i| i.to_le_bytes()));
    bytes.extend([0, 0]);
    bytes
}

fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let word = |n: usize| (n as u32).to_le_bytes();
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend(word(28 + json.len() + binary.len()));
    file.extend(word(json.len()));
    file.extend(b"JSON");
    file.extend(json);
    file.extend(word(binary.len()));
    file.extend(b"BIN\0");
    file.extend(binary);
    file
}

/// The message for the triangle with one text replaced by another.
fn fault(from: &str, to: &str) -> String {
    let json = triangle_json();
    assert!(json.contains(from), "{from}");
    let error = import("t.glb", glb(&json.replacen(from, to, 1), &triangle_bytes()));
    let error = error.map(|_| ()).expect_err(to);
    error
        .to_string()
        .split_once("t.glb:")
        .expect("names the file")
        .1
        .to_owned()
}

#[test]
fn the_triangle_itself_is_fine() {
    let (scene, report) = import("t.glb", glb(&triangle_json(), &triangle_bytes())).unwrap();
    assert_eq!(scene.meshes[0].indices, [[0, 1, 2]]);
    assert_eq!(
        (report.ignored.len(), report.notes.len(), report.files.len()),
        (0, 0, 1)
    );
}

#[test]
fn a_truncated_glb_is_an_error_at_every_byte() {
    let whole = glb(&triangle_json(), &triangle_bytes());
    for length in 0..whole.len() {
        let error = import("t.glb", &whole[..length])
            .map(|_| ())
            .expect_err("truncated");
        assert_eq!(error.kind, ErrorKind::Input, "{length}: {error}");
        assert!(matches!(error.place, Place::Byte(_)), "{length}: {error}");
    }
}

#[test]
fn glb_lengths_and_chunks_are_checked() {
    let whole = glb(&triangle_json(), &triangle_bytes());
    for (at, value) in [
        (4, 1_u32),
        (4, 3),
        (8, u32::MAX),
        (8, 13),
        (12, u32::MAX),
        (12, 1),
        (16, 0),
    ] {
        let mut broken = whole.clone();
        broken[at..at + 4].copy_from_slice(&value.to_le_bytes());
        let error = import("t.glb", broken).map(|_| ()).expect_err("broken");
        assert!(
            matches!(error.place, Place::Byte(_) | Place::Line(..)),
            "{at} {value}: {error}"
        );
    }
}

#[test]
fn gltf_faults_have_pointers() {
    for (from, to, expected) in [
        ("\"2.0\"", "\"1.0\"", "/asset/version"),
        (
            "\"2.0\"",
            "\"2.0\",\"minVersion\":\"2.1\"",
            "/asset/minVersion",
        ),
        ("\"asset\"", "\"asset2\"", "/: has no `asset`"),
        (
            "\"scene\":0",
            "\"scene\":7",
            "/scene: is 7; expected an index below 1",
        ),
        ("\"mesh\":0", "\"mesh\":1", "/nodes/0/mesh"),
        (
            "\"indices\":1",
            "\"indices\":-1",
            "/meshes/0/primitives/0/indices",
        ),
        (
            "\"indices\":1",
            "\"indices\":1,\"mode\":7",
            "/meshes/0/primitives/0/mode",
        ),
        (
            "\"indices\":1",
            "\"indices\":1,\"material\":0",
            "/meshes/0/primitives/0/material",
        ),
        (
            "\"count\":3",
            "\"count\":4611686018427387904",
            "/accessors/0/count",
        ),
        ("\"count\":3", "\"count\":4294967295", "/accessors/0: needs"),
        ("\"count\":3", "\"count\":-1", "/accessors/0/count"),
        ("\"count\":3", "\"count\":1.5", "/accessors/0/count"),
        ("\"count\":3", "\"count\":1e300", "/accessors/0/count"),
        (
            "\"count\":3",
            "\"count\":4",
            "/accessors/0: needs 48 bytes; its buffer view has only 36",
        ),
        (
            "\"count\":3",
            "\"count\":3,\"byteOffset\":1",
            "/accessors/0: needs 37 bytes",
        ),
        (
            "\"count\":3",
            "\"count\":3,\"byteOffset\":18446744073709551615",
            "/accessors/0: needs more than 2^64",
        ),
        ("5126", "5130", "/accessors/0/componentType"),
        ("VEC3", "VEC2", "/accessors/0/type"),
        (
            "\"byteLength\":36",
            "\"byteLength\":36,\"byteStride\":4",
            "/accessors/0: has elements of 12 bytes",
        ),
        (
            "\"byteLength\":36",
            "\"byteLength\":36,\"byteStride\":0",
            "/accessors/0",
        ),
        ("\"byteLength\":36", "\"byteLength\":99", "/bufferViews/0"),
        (
            "\"byteLength\":42",
            "\"byteLength\":45",
            "/buffers/0/byteLength: is 45; the buffer has only 44",
        ),
        (
            "\"byteOffset\":36",
            "\"byteOffset\":12",
            "/accessors/1: has index",
        ),
        (
            "[{\"mesh\":0}]",
            "[{\"mesh\":0,\"children\":[0]}]",
            "/nodes/0: is part of a cycle",
        ),
        (
            "[{\"mesh\":0}]",
            "[{\"children\":[1]},{\"children\":[0]}]",
            "/nodes/0: is part of a cycle",
        ),
        (
            "[{\"mesh\":0}]",
            "[{\"children\":[2]},{\"children\":[2]},{}]",
            "two parents",
        ),
        (
            "[{\"mesh\":0}]",
            "[{\"matrix\":[1,2]}]",
            "/nodes/0/matrix: is an array of 2; expected an array of 16",
        ),
        (
            "[{\"mesh\":0}]",
            "[{\"rotation\":[0,0,0,0]}]",
            "/nodes/0/rotation",
        ),
        (
            "\"scene\":0",
            "\"extensionsRequired\":[\"EXT_nothing\"]",
            "extension EXT_nothing is required",
        ),
        (
            "\"scene\":0",
            "\"cameras\":[5]",
            "/cameras/0: is 5; expected an object",
        ),
    ] {
        let message = fault(from, to);
        assert!(message.contains(expected), "{to}: {message}");
    }
}

#[test]
fn sparse_accessors_are_checked() {
    let sparse = |count: u32, extra: &str| {
        let part = format!(
            "\"count\":3,\"sparse\":{{\"count\":{count},\"indices\":{{\"bufferView\":1,\"componentType\":5123{extra}}},\
             \"values\":{{\"bufferView\":0}}}}"
        );
        import(
            "t.glb",
            glb(
                &triangle_json().replacen("\"count\":3", &part, 1),
                &triangle_bytes(),
            ),
        )
        .map(|_| ())
    };
    assert!(sparse(3, "").is_ok());
    assert!(sparse(4, "").is_err());
    assert!(sparse(2, ",\"byteOffset\":4").is_err());
    assert!(sparse(1, ",\"byteOffset\":18446744073709551615").is_err());
}

#[test]
fn deep_trees_are_refused_and_wide_ones_are_not() {
    let nodes = |f: &dyn Fn(usize) -> String| {
        let list: Vec<String> = (0..20_000).map(f).collect();
        triangle_json().replacen("[{\"mesh\":0}]", &format!("[{}]", list.join(",")), 1)
    };
    let chain = nodes(&|i| {
        if i < 19_999 {
            format!("{{\"children\":[{}]}}", i + 1)
        } else {
            "{}".to_owned()
        }
    });
    let error = import("t.glb", glb(&chain, &triangle_bytes()))
        .map(|_| ())
        .unwrap_err();
    assert!(error.message.contains("deeper than 1024"), "{error}");
    let wide = nodes(&|_| "{\"mesh\":0}".to_owned());
    assert!(import("t.glb", glb(&wide, &triangle_bytes())).is_ok());
}

#[test]
fn files_outside_the_folder_are_not_read() {
    for uri in [
        "../secret.bin",
        "/etc/passwd",
        "file:///etc/passwd",
        "http://example.org/a.bin",
        "C:\\\\x",
        "%2e%2e%2fx",
        "a%00b",
    ] {
        let json = triangle_json().replace(
            "\"byteLength\":42",
            &format!("\"byteLength\":42,\"uri\":\"{uri}\""),
        );
        let error = import("t.gltf", json).map(|_| ()).unwrap_err();
        assert_eq!(
            error.place,
            Place::Pointer("/buffers/0/uri".to_owned()),
            "{error}"
        );
        assert_eq!(error.kind, ErrorKind::Input, "{error}");
    }
    for uri in ["data:,x", "data:;base64,!!!!", "data:;base64,AAAA"] {
        let json = triangle_json().replace(
            "\"byteLength\":42",
            &format!("\"byteLength\":42,\"uri\":\"{uri}\""),
        );
        assert!(import("t.gltf", json).is_err(), "{uri}");
    }
}

/// OBJ files carry the paths of the machine they were made on; they are shown without what lies there.
#[test]
fn obj_files_do_without_what_is_outside_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    let library =
        "newmtl a\nmap_Kd C:\\wood.png\nmap_Ke ../glow.png\nnewmtl b\nmap_Kd /etc/passwd\n";
    fs::write(folder.path().join("a.mtl"), library).unwrap();
    let text = "mtllib ../x.mtl\nmtllib a.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let (scene, report) = import_in(folder.path(), "t.obj", text).unwrap();
    assert_eq!((scene.textures.len(), scene.meshes.len()), (0, 1));
    let ignored: Vec<&str> = report.ignored.keys().map(String::as_str).collect();
    let starts = [
        "material library \"../x.mtl\"",
        "texture \"../glow.png\"",
        "texture \"/etc/passwd\"",
        "texture \"C:\\wood.png\"",
    ];
    assert!(
        ignored.len() == 4
            && ignored
                .iter()
                .zip(starts)
                .all(|(name, start)| name.starts_with(start)),
        "{ignored:?}"
    );
}

/// Areas and distances of such vertices are no numbers any more.
#[test]
fn vertices_too_far_away_are_left_out() {
    for (far, count) in [("1e8", 0), ("1e10", 1), ("3e38", 1)] {
        let text = format!("v {far} 0 {far}\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        let (_, report) = import("t.obj", text).unwrap();
        assert_eq!(
            report
                .ignored
                .get("triangle with a vertex farther than 1e9")
                .copied()
                .unwrap_or(0),
            count,
            "{far}"
        );
    }
}

/// A PNG whose header promises 60,000 x 60,000 texels.
fn bomb() -> Vec<u8> {
    let mut png = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\xea\x60\0\0\xea\x60\x08\x06\0\0\0".to_vec();
    let mut crc = u32::MAX;
    for &byte in &png[12..] {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 {
                crc >> 1 ^ 0xEDB8_8320
            } else {
                crc >> 1
            };
        }
    }
    png.extend((!crc).to_be_bytes());
    png.extend(b"\0\0\0\0IDAT\x35\xaf\x06\x1e\0\0\0\0IEND\xaeB`\x82");
    png
}

#[test]
fn images_are_bounded_named_and_may_be_missing() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("bomb.png"), bomb()).unwrap();
    fs::write(folder.path().join("cut.png"), &bomb()[..40]).unwrap();
    let with = |image: &str| {
        let add = format!(
            "\"scene\":0,\"images\":[{{\"uri\":\"{image}\"}}],\"textures\":[{{\"source\":0}}],\
             \"materials\":[{{\"emissiveTexture\":{{\"index\":0}}}}]"
        );
        import_in(
            folder.path(),
            "t.glb",
            glb(
                &triangle_json().replacen("\"scene\":0", &add, 1),
                &triangle_bytes(),
            ),
        )
    };
    let error = with("bomb.png").map(|_| ()).unwrap_err();
    assert!(
        error.message.contains("bomb.png") && error.kind == ErrorKind::Limit,
        "{error}"
    );
    let error = with("cut.png").map(|_| ()).unwrap_err();
    assert!(error.to_string().contains("/images/0: cut.png"), "{error}");
    let (_, report) = with("none.png").unwrap();
    assert!(
        report.ignored.contains_key("missing texture none.png"),
        "{report:?}"
    );
}

#[test]
fn obj_faults_have_lines_and_columns() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (line, place) in [
        ("f 0 1 2", "4:3"),
        ("f 1 2", "4:1"),
        ("f 1", "4:1"),
        ("f 1 2 99", "4:1"),
        ("f -9 -8 -7", "4:3"),
        ("f 1 2 x", "4:7"),
        ("f 1/2/3/4 2 3", "4:3"),
        ("v 1 2", "4:6"),
        ("v a b c", "4:3"),
        ("v 1,0 2,0 3,0", "4:3"),
        ("  vn 1 2 z", "4:10"),
        ("\u{1}\u{2}", "4:1"),
    ] {
        let error = import("t.obj", format!("{vertices}{line}\n"))
            .map(|_| ())
            .expect_err(line);
        assert!(
            error.to_string().contains(&format!("t.obj:{place}: ")),
            "{line}: {error}"
        );
    }
}

#[test]
fn odd_obj_files_are_read() {
    let vertices = "\u{feff}v 0 0 0\r\nv 1 0 0 # c\r\nv 1 1 0\rv 0 \\\n 1 0\n";
    let count = |rest: &str| {
        let (scene, report) = import("t.obj", format!("{vertices}{rest}")).unwrap();
        (
            scene
                .meshes
                .iter()
                .map(|mesh| mesh.indices.len())
                .sum::<usize>(),
            report,
        )
    };
    assert_eq!(count("f 1 2 3 4").0, 2);
    assert_eq!(count("f -4 -3 -2\\").0, 1);
    assert_eq!(count("f 1/ 2/ 3/").0, 1);
    assert_eq!(count("f 1// 2// 3//").0, 1);
    let (n, report) = count("usemtl nothing\nf 1 2 3\nf 1 1 2\nmtllib none.mtl");
    assert_eq!(n, 1);
    for what in [
        "undefined material nothing",
        "degenerate triangle",
        "missing material library none.mtl",
    ] {
        assert_eq!(report.ignored.get(what), Some(&1), "{report:?}");
    }
    let (_, report) = count("l 1 2\np 1");
    assert!(report.notes[0].contains("no triangles"), "{report:?}");
    let (n, report) = count("v nan 0 0\nf 1 2 5");
    assert_eq!(
        (n, report.ignored.get("triangle with a non-finite vertex")),
        (0, Some(&1))
    );
}

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

#[test]
fn ply_faults_are_found() {
    assert_eq!(
        import("t.ply", PLY).unwrap().0.meshes[0].indices,
        [[0, 1, 2]]
    );
    assert_eq!(
        import("t.ply", PLY.trim_end()).unwrap().0.meshes[0].indices,
        [[0, 1, 2]]
    );
    for (from, to, expected) in [
        ("vertex 3", "vertex 4294967295", "4294967295 elements"),
        ("vertex 3", "vertex 18446744073709551615", "elements"),
        ("vertex 3", "vertex -1", "t.ply:3:16"),
        ("3 0 1 2", "3 0 1 3", "uses vertex 3"),
        ("3 0 1 2", "3 0 1 -1", "does not exist"),
        ("3 0 1 2", "-3 0 1 2", "length -3"),
        ("3 0 1 2", "4 0 1 2", "the file ends here"),
        ("3 0 1 2", "3 0 1 q", "t.ply:13:7"),
        ("float x", "int64 x", "a type"),
        ("list uchar", "list float", "whole number type"),
        ("property float x", "property float q", "no x, y and z"),
        ("end_header", "end", "header line"),
        ("ascii", "utf8", "unknown format"),
        (
            "float x",
            "float x\nproperty float f_dc_0",
            "Gaussian splat",
        ),
    ] {
        let error = import("t.ply", PLY.replacen(from, to, 1))
            .map(|_| ())
            .expect_err(to);
        assert!(error.to_string().contains(expected), "{to}: {error}");
    }
}

/// A binary STL file that says it has `count` triangles, and has `bodies`.
fn stl(count: u32, bodies: usize) -> Vec<u8> {
    let mut file = vec![b' '; 80];
    file.extend(count.to_le_bytes());
    for _ in 0..bodies {
        let numbers = [
            0.0_f32, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0,
        ];
        file.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
        file.extend([0, 0]);
    }
    file
}

#[test]
fn stl_faults_are_found() {
    assert_eq!(
        import("t.stl", stl(2, 2)).unwrap().0.meshes[0]
            .indices
            .len(),
        2
    );
    assert_eq!(
        import("t.stl", stl(1, 2)).unwrap().0.meshes[0]
            .indices
            .len(),
        1
    );
    assert!(import("t.stl", stl(0, 0)).unwrap().1.notes[0].contains("no triangles"));
    for bad in [stl(3, 2), stl(u32::MAX, 2), vec![0; 83], Vec::new()] {
        let error = import("t.stl", bad).map(|_| ()).unwrap_err();
        assert!(matches!(error.place, Place::Byte(_)), "{error}");
    }
    let text = "SOLID a b\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid";
    assert_eq!(import("t.stl", text).unwrap().0.meshes[0].indices.len(), 1);
    for (from, to, place) in [
        ("endloop", "vertex 1 1 1\nendloop", "7:1"),
        ("vertex 1 0 0", "vertex 1 0 q", "5:12"),
        ("endloop\n", "", "7:1"),
        ("\nendsolid", "", "8:9"),
    ] {
        let error = import("t.stl", text.replacen(from, to, 1))
            .map(|_| ())
            .expect_err(to);
        assert!(
            error.to_string().contains(&format!("t.stl:{place}: ")),
            "{to}: {error}"
        );
    }
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
    #![proptest_config(ProptestConfig::with_cases(300))]

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

/// A file of 1 KB that asks for 25 GB: attributes without bytes, shared by many primitives.
#[test]
fn a_small_gltf_does_not_unfold_to_much_memory() {
    let accessor = |kind: &str, count: u32| {
        format!("{{\"componentType\":5126,\"type\":\"{kind}\",\"count\":{count}}}")
    };
    let file = |count: u32, primitives: usize| {
        let one = "{\"attributes\":{\"POSITION\":0,\"NORMAL\":0,\"TANGENT\":1,\"COLOR_0\":1}}";
        format!(
            "{{\"asset\":{{\"version\":\"2.0\"}},\"nodes\":[{{\"mesh\":0}}],\"accessors\":[{},{}],\"meshes\":[{{\"primitives\":[{}]}}]}}",
            accessor("VEC3", count),
            accessor("VEC4", count),
            vec![one; primitives].join(",")
        )
    };
    assert!(import("t.gltf", file(3, 4)).is_ok());
    for (count, primitives) in [(1 << 24, 1), (1 << 20, 2), (u32::MAX, 1)] {
        let error = import("t.gltf", file(count, primitives))
            .map(|_| ())
            .unwrap_err();
        assert_eq!(error.kind, ErrorKind::Limit, "{error}");
    }
}
