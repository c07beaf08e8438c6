//! Lights and cameras that stand at a node.

use super::json::Json;
use crate::FileError;
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use umbriel_kernels::glam::{Affine3A, Vec3};
use umbriel_render::{Camera, DirectionalLight, Light, PointLight, Projection, SpotLight};

/// Reads an entry of `/cameras` for a node with the transform `world`. The picture's shape is the
/// user's: aspect ratio and width are not used.
pub(super) fn read_camera(json: &Json, world: &Affine3A) -> Result<Camera, FileError> {
    let kind = json.text("type")?.unwrap_or_default();
    let body = json.object(kind)?;
    let (projection, body) = match (kind, body) {
        ("perspective", Some(body)) => {
            let vertical_fov = body.number("yfov")?.unwrap_or(0.0);
            if !(vertical_fov > 0.0 && vertical_fov < PI) {
                return Err(body.error_at(
                    "yfov",
                    format!("is {vertical_fov}; expected more than 0 and less than pi"),
                ));
            }
            (Projection::Perspective { vertical_fov }, body)
        }
        ("orthographic", Some(body)) => {
            let half_height = body.number("ymag")?.unwrap_or(0.0).abs();
            if half_height == 0.0 {
                return Err(body.error_at("ymag", "is 0; expected more"));
            }
            (Projection::Orthographic { half_height }, body)
        }
        _ => {
            return Err(json.error(
                "is no camera; expected `type` perspective or orthographic, and its object",
            ));
        }
    };
    let perspective = matches!(projection, Projection::Perspective { .. });
    let near = body.number("znear")?.unwrap_or(0.0);
    let far = body
        .number("zfar")?
        .unwrap_or(if perspective { f32::INFINITY } else { 1e4 });
    if near < 0.0 || (perspective && near == 0.0) {
        return Err(body.error_at("znear", format!("is {near}; expected more than 0")));
    }
    if !(far > near) {
        return Err(body.error_at(
            "zfar",
            format!("is {far}; expected more than znear, {near}"),
        ));
    }
    Ok(Camera {
        name: json.name("camera"),
        pose: pose(world),
        projection,
        near,
        far,
        lens_radius: 0.0,
        focus: 1.0,
    })
}

/// The transform without scale and shear: the view direction stays, and up stays above.
fn pose(world: &Affine3A) -> Affine3A {
    let m = &world.matrix3;
    let back = Vec3::from(m.z_axis).try_normalize().unwrap_or(Vec3::Z);
    let right = Vec3::from(m.y_axis)
        .cross(back)
        .try_normalize()
        .unwrap_or_else(|| back.any_orthonormal_vector());
    Affine3A::from_cols(
        right.into(),
        back.cross(right).into(),
        back.into(),
        world.translation,
    )
}

/// Reads a light of KHR_lights_punctual; it shines along −z of its node, whose scale does not count.
///
/// Source: Khronos, KHR_lights_punctual.
pub(super) fn read_light(json: &Json, world: &Affine3A) -> Result<Light, FileError> {
    let name = json.name("light");
    let color = json.color("color", Vec3::ONE)?.max(Vec3::ZERO);
    let strength = json.number("intensity")?.unwrap_or(1.0);
    if strength < 0.0 {
        return Err(json.error_at("intensity", format!("is {strength}; expected at least 0")));
    }
    let intensity = color * strength;
    if !intensity.is_finite() {
        let message = format!("times `color` is {intensity}; expected finite numbers");
        return Err(json.error_at("intensity", message));
    }
    let range = json
        .number("range")?
        .filter(|range| *range > 0.0)
        .unwrap_or(f32::INFINITY);
    let position = Vec3::from(world.translation);
    let direction = (-Vec3::from(world.matrix3.z_axis))
        .try_normalize()
        .unwrap_or(Vec3::NEG_Z);
    match json.text("type")? {
        Some("point") => Ok(Light::Point(PointLight {
            name,
            position,
            intensity,
            range,
            diameter: 0.0,
        })),
        Some("directional") => Ok(Light::Directional(DirectionalLight {
            name,
            direction,
            illuminance: intensity,
            angle: 0.0,
        })),
        Some("spot") => {
            let (inner_angle, outer_angle) = read_cone(json)?;
            Ok(Light::Spot(SpotLight {
                name,
                position,
                direction,
                intensity,
                range,
                inner_angle,
                outer_angle,
                diameter: 0.0,
            }))
        }
        _ => Err(json.error_at("type", "is unknown; expected point, spot or directional")),
    }
}

fn read_cone(json: &Json) -> Result<(f32, f32), FileError> {
    let spot = json.object("spot")?;
    let angle = |key: &str, default: f32| {
        spot.as_ref()
            .map_or(Ok(None), |s| s.number(key))
            .map(|a| a.unwrap_or(default))
    };
    let (inner, outer) = (
        angle("innerConeAngle", 0.0)?,
        angle("outerConeAngle", FRAC_PI_4)?,
    );
    if !(inner >= 0.0 && inner < outer && outer <= FRAC_PI_2 + 1e-4) {
        let message =
            format!("has the angles {inner} and {outer}; expected 0 <= inner < outer <= pi/2");
        return Err(json.error_at("spot", message));
    }
    Ok((inner, outer.min(FRAC_PI_2)))
}
