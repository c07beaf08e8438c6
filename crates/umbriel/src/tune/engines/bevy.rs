//! Bevy: `DirectionalLight`, `PointLight`, `SpotLight` and `CascadeShadowConfigBuilder`.

use super::{
    ConstantUnit, Dialect, EngineFilter, EngineSettings, NormalUnit, Place, bilinear, digits,
};
use std::f32::consts::SQRT_2;
use umbriel_formats::render::{Light, NormalRule};

/// `p + n · shadow_normal_bias · √2 · texel + l · shadow_depth_bias`, the texel that of the cascade, or of the distance for other lights.
///
/// Source: crates/bevy_pbr/src/render/shadows.wgsl, crates/bevy_pbr/src/render/light.rs (the √2: «worst-case diagonal offset»),
/// crates/bevy_light/src/cascade.rs (github.com/bevyengine/bevy).
pub(super) const DIALECT: Dialect = Dialect {
    name: "bevy",
    title: "Bevy",
    rule: NormalRule::Whole,
    constant: ConstantUnit::Metres,
    normal: NormalUnit::Texels(SQRT_2),
    has_slope: false,
    cascades: &[1, 2, 3, 4],
    filters: &[
        // Castaño's 5x5 texels in nine bilinear taps, whose standard deviation of 1.08 texels lies between those of bilinear:3 and bilinear:4.
        EngineFilter {
            own: bilinear(4),
            name: "Gaussian",
            bias_factor: 1.0,
        },
        EngineFilter {
            own: bilinear(1),
            name: "Hardware2x2",
            bias_factor: 1.0,
        },
    ],
    has_local_lights: true,
    default,
    paste,
    units: "shadow_depth_bias is in metres, shadow_normal_bias in texels over the square root of 2, whatever the light's angle. Gaussian is drawn here as bilinear:4. \
            With three or four cascades the inner bounds are Bevy's own, logarithmic ones.",
};

/// Source: DirectionalLight, SpotLight (0.02, 1.8), PointLight (0.08, 0.6): DEFAULT_SHADOW_DEPTH_BIAS and DEFAULT_SHADOW_NORMAL_BIAS;
/// DirectionalLightShadowMap (2048), PointLightShadowMap (1024); CascadeShadowConfigBuilder (4 cascades, the first to 10 of 150 metres);
/// ShadowFilteringMethod (Gaussian). The last distance counts as that of the scene's end.
fn default(light: &Light, place: &Place) -> EngineSettings {
    let is_point = matches!(light, Light::Point(_));
    let cascades = if place.is_parallel { 4 } else { 1 };
    let bound = |i: i32| place.far * (10.0_f64 / 150.0).powf(1.0 - f64::from(i) / 3.0);
    EngineSettings {
        size: if is_point { 1024 } else { 2048 },
        cascades,
        splits: (0..cascades as i32 - 1).map(bound).collect(),
        constant: if is_point { 0.08 } else { 0.02 },
        slope: 0.0,
        normal: if is_point { 0.6 } else { 1.8 },
        filter: 0,
    }
}

fn paste(engine: &EngineSettings, place: &Place) -> Vec<String> {
    let map = match place.is_parallel {
        true => "DirectionalLightShadowMap",
        false => "PointLightShadowMap, or DirectionalLightShadowMap for spot lights",
    };
    let mut lines = vec![
        format!("{map}: size: {},", engine.size),
        format!("shadow_depth_bias: {:?},", engine.constant),
        format!("shadow_normal_bias: {:?},", engine.normal),
    ];
    if place.is_parallel {
        let first = engine.splits.first().copied().unwrap_or(place.far);
        lines.push(format!(
            "CascadeShadowConfigBuilder {{ num_cascades: {}, first_cascade_far_bound: {:?}, maximum_distance: {:?}, ..default() }}",
            engine.cascades,
            digits(first as f32, 5),
            digits(place.far as f32, 5)
        ));
    }
    let filter = DIALECT.filters[engine.filter].name;
    lines.push(format!("ShadowFilteringMethod::{filter}"));
    lines
}
