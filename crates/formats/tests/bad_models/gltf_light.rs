//! Light in glTF that is none: below 0, or beyond what a number can hold.

use crate::{
    gltf::{glb, triangle_bytes, triangle_json},
    import,
};
use umbriel_formats::{FileError, render::kernels::glam::Vec3};

/// A triangle of a material.
fn with_material(material: &str) -> String {
    let start = format!(r#"{{"asset":{{"version":"2.0"}},"materials":[{material}],"#);
    triangle_json()
        .replace(r#"{"asset":{"version":"2.0"},"#, &start)
        .replace(r#""primitives":[{"#, r#""primitives":[{"material":0,"#)
}

#[test]
fn light_is_no_less_than_none() {
    let strength = |factor: &str, strength: &str| {
        format!(
            r#"{{"emissiveFactor":{factor},"extensions":{{"KHR_materials_emissive_strength":{{"emissiveStrength":{strength}}}}}}}"#
        )
    };
    let emission = |material: &str| {
        let file = glb(&with_material(material), &triangle_bytes());
        let (scene, report) = import("t.glb", file)?;
        let said: Vec<String> = report.ignored.into_keys().collect();
        let glow = scene.materials.iter().map(|m| m.emission);
        Ok::<_, FileError>((glow.fold(Vec3::ZERO, Vec3::max), said.join(", ")))
    };
    let found = |material: &str| emission(material).unwrap();
    let bright = (Vec3::new(2.0, 4.0, 0.0), String::new());
    assert_eq!(found(&strength("[0.5,1,0]", "4")), bright);
    let mended = (Vec3::Y, "emissiveFactor below 0".to_owned());
    assert_eq!(found(r#"{"emissiveFactor":[-0.5,1,0]}"#), mended);
    let none = (Vec3::ZERO, "emissiveStrength below 0".to_owned());
    assert_eq!(found(&strength("[0.5,1,0]", "-3")), none);
    for (material, expected) in [
        (
            strength("[1e30,1,0]", "1e30"),
            "/materials/0/emissiveFactor: times its strength is [inf",
        ),
        (
            r#"{"emissiveFactor":[1e39,0,0]}"#.to_owned(),
            "/materials/0/emissiveFactor: is",
        ),
        (
            r#"{"emissiveFactor":[1,"NaN",0]}"#.to_owned(),
            "/materials/0/emissiveFactor: is",
        ),
    ] {
        let message = emission(&material).unwrap_err().to_string();
        assert!(message.contains(expected), "{material}: {message}");
    }
}

#[test]
fn lights_of_gltf_are_light() {
    for (light, expected) in [
        (
            r#"{"type":"point","intensity":-2}"#,
            "/intensity: is -2; expected at least 0",
        ),
        (
            r#"{"type":"point","intensity":1e30,"color":[1e30,1,1]}"#,
            "/intensity: times `color` is [inf",
        ),
        (r#"{"type":"sun"}"#, "/type: is unknown"),
        (r#"{"type":"spot","intensity":1e39}"#, "/intensity: is"),
    ] {
        let lights = format!(
            r#"{{"asset":{{"version":"2.0"}},"extensions":{{"KHR_lights_punctual":{{"lights":[{light}]}}}},"#
        );
        let node = r#""nodes":[{"extensions":{"KHR_lights_punctual":{"light":0}},"#;
        let json = triangle_json()
            .replace(r#"{"asset":{"version":"2.0"},"#, &lights)
            .replace(r#""nodes":[{"#, node);
        let message = import("t.glb", glb(&json, &triangle_bytes()))
            .unwrap_err()
            .to_string();
        assert!(message.contains(expected), "{light}: {message}");
    }
}
