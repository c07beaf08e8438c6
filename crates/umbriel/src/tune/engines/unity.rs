//! Unity, Universal Render Pipeline: the main light.

use super::{
    ConstantUnit, Dialect, EngineFilter, EngineSettings, NormalUnit, Place, bilinear, digits,
    shares,
};
use umbriel_formats::render::{Light, NormalRule};

const fn filter(side: u32, name: &'static str, bias_factor: f32) -> EngineFilter {
    EngineFilter {
        own: bilinear(side),
        name,
        bias_factor,
    }
}

/// Casters are moved by `depthBias · texel · k` away from the light and by `(1 − N·L) · normalBias · texel · k` against their normal; `k` is 1 for hard shadows and the half of
/// the kernel's width, 1.5, 2.5 or 3.5, for soft ones. Here the receiver is moved the other way, which is the same on planes.
///
/// Source: Runtime/ShadowUtils.cs (GetShadowBias), ShaderLibrary/Shadows.hlsl (ApplyShadowBias) of com.unity.render-pipelines.universal (github.com/Unity-Technologies/Graphics).
pub(super) const DIALECT: Dialect = Dialect {
    name: "unity",
    title: "Unity (URP)",
    rule: NormalRule::Rest,
    constant: ConstantUnit::Texels,
    normal: NormalUnit::Texels(1.0),
    has_slope: false,
    cascades: &[1, 2, 3, 4],
    filters: &[
        filter(1, "Hard", 1.0),
        // Four bilinear taps; tents over 5x5 and 7x7 texels, whose standard deviations are nearest to these.
        filter(2, "Low", 1.5),
        filter(3, "Medium", 2.5),
        filter(5, "High", 3.5),
    ],
    has_local_lights: false,
    default,
    paste,
    units: "both biases are in texels, soft shadows multiply them by 1.5, 2.5 or 3.5 (low, medium, high), and the normal bias by 1 - cos of the light's angle; splits are \
            shares of the last distance; the asset's resolution is that of all cascades. Soft shadows are drawn here as bilinear:2, :3 and :5. Biases above 10 cannot be set.",
};

/// Source: UniversalRenderPipelineAsset.cs: m_MainLightShadowmapResolution 2048, m_ShadowCascadeCount 1, m_ShadowDepthBias 1, m_ShadowNormalBias 1,
/// m_SoftShadowsSupported false.
fn default(_: &Light, _: &Place) -> EngineSettings {
    EngineSettings {
        size: 2048,
        cascades: 1,
        splits: Vec::new(),
        constant: 1.0,
        slope: 0.0,
        normal: 1.0,
        filter: 0,
    }
}

fn paste(engine: &EngineSettings, place: &Place) -> Vec<String> {
    let size = engine.size * if engine.cascades > 1 { 2 } else { 1 };
    let splits = shares(&engine.splits, 0.0, place.far);
    let mut lines = vec![
        format!("asset.mainLightShadowmapResolution = {size};"),
        format!("asset.shadowDistance = {:?}f;", digits(place.far as f32, 5)),
        format!("asset.shadowCascadeCount = {};", engine.cascades),
    ];
    match splits[..] {
        [a] => lines.push(format!("asset.cascade2Split = {a:?}f;")),
        [a, b] => lines.push(format!(
            "asset.cascade3Split = new Vector2({a:?}f, {b:?}f);"
        )),
        [a, b, c] => lines.push(format!(
            "asset.cascade4Split = new Vector3({a:?}f, {b:?}f, {c:?}f);"
        )),
        _ => {}
    }
    lines.push(format!("asset.shadowDepthBias = {:?}f;", engine.constant));
    lines.push(format!("asset.shadowNormalBias = {:?}f;", engine.normal));
    lines.push(match DIALECT.filters[engine.filter].name {
        "Hard" => "light.shadows = LightShadows.Hard;".to_owned(),
        quality => format!(
            "light.shadows = LightShadows.Soft; lightData.softShadowQuality = SoftShadowQuality.{quality};"
        ),
    });
    lines
}
