//! Images that models name: too large, cut, missing.

use crate::{
    gltf::{glb, triangle_bytes, triangle_json},
    import_in,
};
use std::fs;
use umbriel_formats::ErrorKind;

/// A PNG whose header promises 60,000 x 60,000 texels.
pub(crate) fn bomb() -> Vec<u8> {
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
