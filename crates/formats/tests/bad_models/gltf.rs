//! Broken glTF: every fault has a JSON pointer, or a byte of the GLB file.

use crate::import;
use umbriel_formats::{ErrorKind, Place};

/// Three vertices and three indices: the JSON and the 42 bytes of its buffer (44 with padding).
pub(crate) fn triangle_json() -> String {
    r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
"buffers":[{"byteLength":42}]}"#
        .to_owned()
}

pub(crate) fn triangle_bytes() -> Vec<u8> {
    let positions = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let mut bytes: Vec<u8> = positions.iter().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend([0_u16, 1, 2].iter().flat_map(|i| i.to_le_bytes()));
    bytes.extend([0, 0]);
    bytes
}

pub(crate) fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
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

/// Factors out of their ranges are brought into them, and said.
#[test]
fn layers_are_read_and_brought_into_their_ranges() {
    let material = r#"{"asset":{"version":"2.0"},"materials":[{"pbrMetallicRoughness":{"roughnessFactor":-2},"extensions":{
"KHR_materials_clearcoat":{"clearcoatFactor":0.5,"clearcoatRoughnessFactor":7},
"KHR_materials_sheen":{"sheenColorFactor":[0.1,2,0.3],"sheenRoughnessFactor":0.4},
"KHR_materials_specular":{"specularFactor":0.25,"specularColorFactor":[3,1,-1]},
"KHR_materials_iridescence":{"iridescenceFactor":1,"iridescenceIor":1.8,"iridescenceThicknessMaximum":250},
"KHR_materials_anisotropy":{"anisotropyStrength":0.6,"anisotropyRotation":1.5}}}],"#;
    let json = triangle_json()
        .replace(r#"{"asset":{"version":"2.0"},"#, material)
        .replace(r#""primitives":[{"#, r#""primitives":[{"material":0,"#);
    let (scene, report) = import("t.glb", glb(&json, &triangle_bytes())).unwrap();
    let made = scene.materials.iter().find(|m| m.layers.clearcoat == 0.5);
    let material = made.expect("the material of the triangle");
    let layers = &material.layers;
    assert_eq!((material.roughness, layers.clearcoat_roughness), (0.0, 1.0));
    assert_eq!(layers.sheen_color.to_array(), [0.1, 1.0, 0.3]);
    assert_eq!((layers.sheen_roughness, layers.specular), (0.4, 0.25));
    assert_eq!(layers.specular_color.to_array(), [3.0, 1.0, 0.0]);
    assert_eq!(
        (layers.iridescence_ior, layers.iridescence_thickness),
        (1.8, 250.0)
    );
    assert_eq!((layers.anisotropy, layers.anisotropy_rotation), (0.6, 1.5));
    let said: Vec<&str> = report.ignored.keys().map(String::as_str).collect();
    assert_eq!(
        said,
        [
            "clearcoatRoughnessFactor outside of 0 to 1",
            "roughnessFactor outside of 0 to 1"
        ]
    );
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
