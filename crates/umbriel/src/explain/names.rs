//! How things and numbers are called.

use umbriel_formats::render::{
    Blocker, Geometry, InstanceId, Material, Scene,
    kernels::{Surface, glam::Vec3},
};

/// Four digits, without zeros at the end.
pub(super) fn short(value: f32) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value:.0}").replace("-0", "0");
    }
    let digits = 3 - value.abs().log10().floor() as i32;
    if !(-3..=8).contains(&digits) {
        return format!("{value:.3e}");
    }
    let text = format!("{value:.*}", digits.max(0) as usize);
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// `x, y, z`.
pub(super) fn vector(v: Vec3) -> String {
    // What is far below the greatest component is rounding.
    let least = 1e-6 * v.abs().max_element();
    let component = |c: f32| short(if c.abs() <= least { 0.0 } else { c });
    let [x, y, z] = v.to_array().map(component);
    format!("{x}, {y}, {z}")
}

/// A part of a light, in percent.
pub(super) fn percent(fraction: f32) -> String {
    format!("{} %", short((1e5 * fraction).round() * 1e-3))
}

/// An instance by its name, or by its number.
pub(super) fn instance(scene: &Scene, id: InstanceId) -> String {
    match scene.instances[id.index()].name.as_str() {
        "" => format!("instance {}", id.0),
        name => format!("{name:?}"),
    }
}

/// What an instance is made of, in a word.
pub(super) fn kind(scene: &Scene, id: InstanceId) -> &'static str {
    let Geometry::Surface(id) = scene.instances[id.index()].geometry else {
        return "mesh";
    };
    match &scene.surfaces[id.index()] {
        Surface::Sphere(_) => "sphere",
        Surface::Plane(_) => "plane",
        Surface::Disk(_) => "disk",
        Surface::Rectangle(_) => "rectangle",
        Surface::Cuboid(_) => "box",
        Surface::Cylinder(_) => "cylinder",
        Surface::Cone(_) => "cone",
        Surface::Torus(_) => "torus",
        Surface::Implicit(_) => "implicit surface",
    }
}

/// An instance and, of meshes, its triangle.
pub(super) fn part(scene: &Scene, id: InstanceId, primitive: u32) -> String {
    let name = instance(scene, id);
    match scene.instances[id.index()].geometry {
        Geometry::Mesh(_) => format!("{name}, triangle {primitive}"),
        Geometry::Surface(_) => format!("{name}, {}", kind(scene, id)),
    }
}

/// What stands somewhere.
pub(super) fn blocker(scene: &Scene, blocker: &Blocker) -> String {
    part(scene, blocker.instance, blocker.primitive)
}

/// The material of an instance.
pub(super) fn material(scene: &Scene, id: InstanceId) -> &Material {
    &scene.materials[scene.instances[id.index()].material.index()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_keep_four_digits() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (12.0, "12"),
            (0.012_345, "0.01235"),
            (-1234.56, "-1235"),
            (1.5e9, "1.500e9"),
            (1e-7, "1.000e-7"),
            (f32::INFINITY, "inf"),
        ] {
            assert_eq!(short(value), text);
        }
        assert_eq!(vector(Vec3::new(1.0, 1e-9, -2.5)), "1, 0, -2.5");
        assert_eq!(percent(1.0), "100 %");
        assert_eq!(percent(0.123_456), "12.35 %");
    }
}
