//! Lights without extent: point, spot and directional, in the units of glTF.

use umbriel_kernels::glam::Vec3;

/// A source of direct light.
#[derive(Clone, Debug, PartialEq)]
pub enum Light {
    /// Shines from a point in all directions.
    Point(PointLight),
    /// Shines from a point into a cone.
    Spot(SpotLight),
    /// Shines from infinitely far away, as the sun does.
    Directional(DirectionalLight),
}

/// Shines from a point equally in all directions.
#[derive(Clone, Debug, PartialEq)]
pub struct PointLight {
    /// Name in messages.
    pub name: String,
    /// World position.
    pub position: Vec3,
    /// Luminous intensity for red, green and blue, in candela (lm/sr): the illuminance at 1 m, in lux.
    pub intensity: Vec3,
    /// Distance in metres beyond which there is no light; infinite for the pure inverse square law.
    pub range: f32,
}

/// Shines from a point into a cone.
#[derive(Clone, Debug, PartialEq)]
pub struct SpotLight {
    /// Name in messages.
    pub name: String,
    /// World position.
    pub position: Vec3,
    /// Unit direction into which the light shines.
    pub direction: Vec3,
    /// Luminous intensity on the axis, in candela.
    pub intensity: Vec3,
    /// Distance in metres beyond which there is no light; may be infinite.
    pub range: f32,
    /// Angle from the axis, in radians, up to which the light has full intensity; at least 0.
    pub inner_angle: f32,
    /// Angle from the axis, in radians, at which the light ends; greater than `inner_angle`, at most π/2.
    pub outer_angle: f32,
}

/// Parallel light from infinitely far away.
#[derive(Clone, Debug, PartialEq)]
pub struct DirectionalLight {
    /// Name in messages.
    pub name: String,
    /// Unit direction into which the light shines.
    pub direction: Vec3,
    /// Illuminance on a surface that faces the light, in lux.
    pub illuminance: Vec3,
}
