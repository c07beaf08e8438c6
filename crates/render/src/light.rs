//! Lights: point, spot and directional, in the units of glTF, with or without extent.

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
    /// Diameter in metres of the ball that shines, at least 0; see [`Light::size`].
    pub diameter: f32,
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
    /// Diameter in metres of the ball that shines, at least 0; see [`Light::size`].
    pub diameter: f32,
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
    /// Angle that the light fills in the sky, in radians, from 0 and below π; see [`Light::size`].
    pub angle: f32,
}

/// Light that arrives at a point from one light, before any shadow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// Unit direction towards the light.
    pub wi: Vec3,
    /// Vector from the point to the light, or a unit vector towards a directional light.
    pub to_light: Vec3,
    /// Length of the shadow ray in units of `to_light`: 1, or infinite for directional lights.
    pub t_max: f32,
    /// Illuminance on a surface that faces the light, in lux.
    pub illuminance: Vec3,
}

impl LightSample {
    /// No light.
    pub(crate) const DARK: Self = Self {
        wi: Vec3::ZERO,
        to_light: Vec3::ZERO,
        t_max: 0.0,
        illuminance: Vec3::ZERO,
    };
}

impl PointLight {
    /// See [`Light::sample`].
    #[inline(always)]
    pub(crate) fn sample(&self, p: Vec3) -> Option<LightSample> {
        sample_point(self.position, self.range, self.intensity, p)
    }
}

impl Light {
    /// Name in messages.
    pub fn name(&self) -> &str {
        match self {
            Self::Point(light) => &light.name,
            Self::Spot(light) => &light.name,
            Self::Directional(light) => &light.name,
        }
    }

    /// The light's extent: the diameter in metres of a point or spot light, the angular diameter in radians of a directional light; 0 for a
    /// light without extent, whose shadows have sharp edges.
    ///
    /// Paths find the light on the whole of it, PCSS and comparisons take shadows for as soft as it makes them; ray casting and Whitted's
    /// method see its centre alone. The light itself is not seen, in no mirror either.
    pub fn size(&self) -> f32 {
        match self {
            Self::Point(light) => light.diameter,
            Self::Spot(light) => light.diameter,
            Self::Directional(light) => light.angle,
        }
    }

    /// Changes [`Light::size`].
    pub fn set_size(&mut self, size: f32) {
        match self {
            Self::Point(light) => light.diameter = size,
            Self::Spot(light) => light.diameter = size,
            Self::Directional(light) => light.angle = size,
        }
    }

    /// Whether it gives no light at all.
    pub(crate) fn is_dark(&self) -> bool {
        let most = match self {
            Self::Point(light) => light.intensity,
            Self::Spot(light) => light.intensity,
            Self::Directional(light) => light.illuminance,
        };
        !(most.max_element() > 0.0)
    }

    /// The light that arrives at the world point `p`; `None` where there is none.
    #[inline]
    pub fn sample(&self, p: Vec3) -> Option<LightSample> {
        match self {
            Self::Point(light) => light.sample(p),
            Self::Spot(light) => {
                let sample = sample_point(light.position, light.range, light.intensity, p)?;
                let fade = spot_fade(light, -sample.wi);
                (fade > 0.0).then_some(LightSample {
                    illuminance: sample.illuminance * fade,
                    ..sample
                })
            }
            Self::Directional(light) => Some(LightSample {
                wi: -light.direction,
                to_light: -light.direction,
                t_max: f32::INFINITY,
                illuminance: light.illuminance,
            }),
        }
    }
}

/// The inverse square law with glTF's smooth end at `range`.
///
/// ```text
/// E = I / d² · clamp(1 − (d/range)⁴, 0, 1)
/// ```
/// A point at the light itself gets no light: the direction is undefined there.
///
/// Source: Khronos, KHR_lights_punctual, "Range Property".
#[inline(always)]
fn sample_point(position: Vec3, range: f32, intensity: Vec3, p: Vec3) -> Option<LightSample> {
    let to_light = position - p;
    let d2 = to_light.length_squared();
    if !(d2 > 0.0) {
        return None;
    }
    let ratio = d2 / (range * range);
    let window = (1.0 - ratio * ratio).min(1.0);
    (window > 0.0).then(|| LightSample {
        wi: to_light / d2.sqrt(),
        to_light,
        // The light is no surface, but may stand on one: stop a rounding error before it.
        t_max: 1.0 - 4.0 * f32::EPSILON,
        illuminance: intensity * (window / d2),
    })
}

/// Full up to the inner angle, 0 from the outer angle; `dir` is the unit direction from the light.
///
/// ```text
/// s = clamp((cos θ − cos outer) / (cos inner − cos outer), 0, 1)      fade = s²
/// ```
///
/// Source: Khronos, KHR_lights_punctual, "Inner and Outer Cone Angles".
fn spot_fade(light: &SpotLight, dir: Vec3) -> f32 {
    let (inner, outer) = (light.inner_angle.cos(), light.outer_angle.cos());
    let s = ((dir.dot(light.direction) - outer) / (inner - outer).max(f32::MIN_POSITIVE))
        .clamp(0.0, 1.0);
    s * s
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(range: f32) -> Light {
        Light::Point(PointLight {
            name: String::new(),
            position: Vec3::new(1.0, 2.0, 3.0),
            intensity: Vec3::splat(8.0),
            range,
            diameter: 0.0,
        })
    }

    #[test]
    fn point_light_follows_the_inverse_square_law() {
        let sample = point(f32::INFINITY)
            .sample(Vec3::new(1.0, 0.0, 3.0))
            .unwrap();
        assert_eq!(sample.illuminance, Vec3::splat(2.0));
        assert_eq!(sample.wi, Vec3::Y);
        assert!(
            point(f32::INFINITY)
                .sample(Vec3::new(1.0, 2.0, 3.0))
                .is_none()
        );
    }

    #[test]
    fn range_ends_the_light() {
        let at = |y: f32| {
            point(4.0)
                .sample(Vec3::new(1.0, y, 3.0))
                .map(|s| s.illuminance.x)
        };
        assert!(at(-2.0).is_none());
        let expected = 8.0 / 4.0 * (1.0 - 0.5_f32.powi(4));
        assert!((at(0.0).unwrap() - expected).abs() < 1e-6);
    }

    #[test]
    fn spot_is_full_inside_and_dark_outside() {
        let spot = Light::Spot(SpotLight {
            name: String::new(),
            position: Vec3::ZERO,
            direction: Vec3::NEG_Z,
            intensity: Vec3::ONE,
            range: f32::INFINITY,
            inner_angle: 0.2,
            outer_angle: 0.5,
            diameter: 0.0,
        });
        let at = |angle: f32| {
            spot.sample(Vec3::new(angle.sin(), 0.0, -angle.cos()))
                .map(|s| s.illuminance.x)
        };
        assert!((at(0.0).unwrap() - 1.0).abs() < 1e-6);
        assert!((at(0.19).unwrap() - 1.0).abs() < 1e-5);
        assert!(at(0.51).is_none());
        let s = (0.35_f32.cos() - 0.5_f32.cos()) / (0.2_f32.cos() - 0.5_f32.cos());
        assert!((at(0.35).unwrap() - s * s).abs() < 1e-5);
    }
}
