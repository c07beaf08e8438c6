//! Point and spot lights far outside of all that casts shadows: one image of it, or parallel light.

use super::{LightView, fit::widened, settings::ShadowMapSettings, view::axes};
use umbriel_kernels::{
    Aabb,
    glam::{DVec3, Vec3},
};

/// Distance, in radii of the ball around all casters, from which on a light has one image of that ball: on a side of a cube it would be an eighth wide.
const FAR: f64 = 8.0;
/// Distance in radii from which on rays count as parallel. They lean by less than half a texel of 2048, and f32 could not tell depths apart.
const PARALLEL: f64 = 4096.0;

/// A light far from all that casts shadows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum FarLight {
    /// The casters lie within this angle around the direction to their middle.
    Narrow {
        direction: DVec3,
        tan: f64,
        distance: f64,
    },
    /// Its rays are parallel.
    Parallel { direction: Vec3, distance: f32 },
}

impl FarLight {
    /// `None` for a light that is near, and where nothing finite casts shadows.
    pub(crate) fn of(position: Vec3, casters: &Aabb) -> Option<Self> {
        let (min, max) = (casters.min.as_dvec3(), casters.max.as_dvec3());
        let radius = 0.5 * (max - min).length();
        let way = 0.5 * (min + max) - position.as_dvec3();
        let distance = way.length();
        if casters.is_empty() || !distance.is_finite() || distance <= FAR * radius {
            return None;
        }
        let direction = way / distance;
        if distance > PARALLEL * radius {
            return Some(Self::Parallel {
                direction: direction.as_vec3(),
                distance: distance as f32,
            });
        }
        Some(Self::Narrow {
            direction,
            tan: radius / (distance * distance - radius * radius).sqrt(),
            distance,
        })
    }
}

/// The image of all casters, as wide as they and the filter need.
pub(crate) fn narrow(
    position: Vec3,
    direction: DVec3,
    tan: f64,
    near: f32,
    settings: &ShadowMapSettings,
) -> LightView {
    let half = widened(tan, settings);
    LightView::perspective(
        position,
        &axes(direction),
        half as f32,
        settings.resolution.max(1),
        near,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_decides() {
        let unit = Aabb {
            min: Vec3::splat(-1.0),
            max: Vec3::splat(1.0),
        };
        assert_eq!(FarLight::of(Vec3::X * 10.0, &unit), None);
        assert_eq!(FarLight::of(Vec3::X * 1e3, &Aabb::EMPTY), None);
        assert_eq!(
            FarLight::of(Vec3::splat(f32::MAX), &unit),
            Some(FarLight::Parallel {
                direction: Vec3::splat(-1.0).normalize(),
                distance: f32::INFINITY,
            })
        );
        let Some(FarLight::Narrow { direction, tan, .. }) = FarLight::of(Vec3::X * 100.0, &unit)
        else {
            panic!("100 m are far from a metre");
        };
        assert_eq!(direction, DVec3::NEG_X);
        assert!((tan - 3_f64.sqrt() / 100.0).abs() < 1e-5);
    }
}
