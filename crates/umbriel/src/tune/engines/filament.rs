//! Filament: `LightManager::ShadowOptions`.

use super::{
    ConstantUnit, Dialect, EngineFilter, EngineSettings, NormalUnit, Place, bilinear, digits,
    shares,
};
use umbriel_formats::render::{Light, NormalRule};

/// Normal bias: `p + n · sin θ · normalBias · texel` (the texel is that of the cascade).
/// Constant bias: metres away from the light. Slope: polygon offset of the map.
///
/// Source: filament/include/filament/LightManager.h, filament/src/ShadowMapManager.cpp, computeLightSpacePosition of shaders/src (github.com/google/filament).
pub(super) const DIALECT: Dialect = Dialect {
    name: "filament",
    title: "Filament",
    rule: NormalRule::Sine,
    constant: ConstantUnit::Metres,
    normal: NormalUnit::Texels(1.0),
    has_slope: true,
    cascades: &[1, 2, 3, 4],
    // SHADOW_SAMPLING_PCF_LOW: 3x3 texels in four bilinear taps.
    filters: &[EngineFilter {
        own: bilinear(2),
        name: "PCF",
        bias_factor: 1.0,
    }],
    has_local_lights: true,
    default,
    paste,
    units: "constantBias is in metres, normalBias in texels times the sine of the light's angle, polygonOffsetSlope in texels times its tangent; \
            splits are shares of near to shadowFar. PCF is drawn here as bilinear:2. lispsm is off, for it changes the width of texels.",
};

/// Source: the initialisers of ShadowOptions in LightManager.h: mapSize 1024, shadowCascades 1, constantBias 0.001, normalBias 1.0, polygonOffsetSlope 2.0.
fn default(_: &Light, _: &Place) -> EngineSettings {
    EngineSettings {
        size: 1024,
        cascades: 1,
        splits: Vec::new(),
        constant: 0.001,
        slope: 2.0,
        normal: 1.0,
        filter: 0,
    }
}

fn paste(engine: &EngineSettings, place: &Place) -> Vec<String> {
    let mut lines = vec![
        "LightManager::ShadowOptions options;".to_owned(),
        format!("options.mapSize = {};", engine.size),
        format!("options.constantBias = {:?}f;", engine.constant),
        format!("options.normalBias = {:?}f;", engine.normal),
        format!("options.polygonOffsetSlope = {:?}f;", engine.slope),
        "options.lispsm = false;".to_owned(),
    ];
    if place.is_parallel {
        lines.push(format!("options.shadowCascades = {};", engine.cascades));
        lines.push(format!(
            "options.shadowFar = {:?}f;",
            digits(place.far as f32, 5)
        ));
    }
    for (i, share) in shares(&engine.splits, place.near, place.far)
        .iter()
        .enumerate()
    {
        lines.push(format!("options.cascadeSplitPositions[{i}] = {share:?}f;"));
    }
    lines.push("view->setShadowType(ShadowType::PCF);".to_owned());
    lines
}
