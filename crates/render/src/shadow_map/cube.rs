//! The views of point and spot lights: a cube of six faces, or one face.

use super::{LightView, ShadowMapSettings, fit::widened, view::axes};
use crate::{Light, SpotLight};
use umbriel_kernels::glam::{DMat3, DVec3, Vec3};

/// The nearest distance of which a perspective picture knows, from a light or an eye, as a share of the furthest thing's; what is nearer casts no shadow and
/// is not seen. Stored depths are as fine at any share: it must only be so small that a far dome, or a plane given by a far point, takes nothing near away.
pub(crate) const LEAST_DISTANCE: f32 = 1.0 / (1_u64 << 40) as f32;
/// Spot lights with wider cones (about 63°) have a cube: one face would spend its texels on the rim.
const WIDEST_FACE: f32 = 1.1;

/// How many views a light has with these settings, where anything is visible.
pub(crate) fn images(light: &Light, settings: &ShadowMapSettings) -> u32 {
    match light {
        Light::Directional(_) => settings.cascades,
        Light::Spot(light) if light.outer_angle <= WIDEST_FACE => 1,
        Light::Spot(_) | Light::Point(_) => 6,
    }
}

/// The views of a spot light whose furthest caster is `reach` away.
pub(crate) fn spot(light: &SpotLight, reach: f32, settings: &ShadowMapSettings) -> Vec<LightView> {
    let side = settings.resolution.max(1);
    if light.outer_angle > WIDEST_FACE {
        return cube(light.position, reach, side);
    }
    let axes = axes(light.direction.as_dvec3().normalize());
    let half = widened(f64::from(light.outer_angle).tan(), settings);
    let near = reach * LEAST_DISTANCE;
    vec![LightView::perspective(
        light.position,
        &axes,
        half as f32,
        side,
        near,
    )]
}

/// The faces of a cube in the order +x, −x, +y, −y, +z, −z.
pub(crate) fn cube(position: Vec3, reach: f32, side: u32) -> Vec<LightView> {
    let near = reach * LEAST_DISTANCE;
    let face = |n: usize| {
        let sign = if n.is_multiple_of(2) { 1.0 } else { -1.0 };
        let forward = sign * DMat3::IDENTITY.col(n / 2);
        let mut axes = axes(forward);
        // Exact zeros, so that the faces meet without gaps.
        for column in [&mut axes.x_axis, &mut axes.y_axis] {
            *column = DVec3::round(*column);
        }
        LightView::perspective(position, &axes, 1.0, side, near)
    };
    (0..6).map(face).collect()
}

/// Which face of [`cube`] a direction meets.
#[inline(always)]
pub(crate) fn face_of(direction: Vec3) -> usize {
    let a = direction.abs();
    if a.x >= a.y && a.x >= a.z {
        usize::from(direction.x < 0.0)
    } else if a.y >= a.z {
        2 + usize::from(direction.y < 0.0)
    } else {
        4 + usize::from(direction.z < 0.0)
    }
}
