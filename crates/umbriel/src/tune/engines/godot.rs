//! Godot 4: `DirectionalLight3D` under Forward+.

use super::{
    ConstantUnit, Dialect, EngineFilter, EngineSettings, NormalUnit, Place, bilinear, digits,
    shares,
};
use umbriel_formats::render::{Light, NormalRule, ShadowFilter};

const fn vogel(taps: u32, radius: f32) -> ShadowFilter {
    ShadowFilter::Vogel { taps, radius }
}

const fn filter(own: ShadowFilter, name: &'static str) -> EngineFilter {
    EngineFilter {
        own,
        name,
        bias_factor: 1.0,
    }
}

/// `p + l · shadow_bias / 100 · range + aside(n (1 − cos θ) · shadow_normal_bias · texel)`, where `aside` takes away what goes along the light.
///
/// Source: servers/rendering/renderer_rd/shaders/forward_clustered/scene_forward_clustered.glsl (BIAS_FUNC), storage_rd/light_storage.cpp
/// (`/ 100.0 * bias_scale`), renderer_scene_cull.cpp (`bias_scale = z_max - z_min_cam`), renderer_scene_render_rd.cpp (taps and radii of each quality)
/// (github.com/godotengine/godot).
pub(super) const DIALECT: Dialect = Dialect {
    name: "godot",
    title: "Godot",
    rule: NormalRule::Aside,
    constant: ConstantUnit::RangePercent,
    normal: NormalUnit::Texels(1.0),
    has_slope: false,
    cascades: &[1, 4],
    filters: &[
        filter(vogel(4, 2.0), "SHADOW_QUALITY_SOFT_LOW"),
        filter(bilinear(1), "SHADOW_QUALITY_HARD"),
        filter(vogel(8, 2.0), "SHADOW_QUALITY_SOFT_MEDIUM"),
        filter(vogel(16, 3.0), "SHADOW_QUALITY_SOFT_HIGH"),
        filter(vogel(32, 4.0), "SHADOW_QUALITY_SOFT_ULTRA"),
    ],
    has_local_lights: false,
    default,
    paste,
    units: "shadow_bias is in hundredths of the depths that a map holds: the sphere around what the eye sees, and 20 metres of pancake (nearer splits hold less); shadow_normal_bias is in texels times 1 - cos and sin of the light's \
            angle, aside; splits are shares of the last distance. The soft qualities turn their disk from pixel to pixel, here it stands still.",
};

/// Metres of depth that the map of the last split holds: the sphere around what the eye sees, and the pancake of 20 metres before it. Maps of nearer splits hold less.
///
/// Source: renderer_scene_cull.cpp (`z_max`, `pancake_size`), DirectionalLight3D.xml (directional_shadow_pancake_size 20).
pub(super) fn range(place: &Place) -> f32 {
    place.view_range + 20.0
}

/// Source: doc/classes/Light3D.xml (shadow_bias 0.1, shadow_normal_bias 2.0), DirectionalLight3D.xml (four splits at 0.1, 0.2, 0.5), and the project setting
/// rendering/lights_and_shadows/directional_shadow (size 4096 for all four, quality low). The last distance counts as that of the scene's end.
fn default(_: &Light, place: &Place) -> EngineSettings {
    EngineSettings {
        size: 2048,
        cascades: 4,
        splits: [0.1, 0.2, 0.5].map(|share| share * place.far).into(),
        constant: 0.1,
        slope: 0.0,
        normal: 2.0,
        filter: 0,
    }
}

fn paste(engine: &EngineSettings, place: &Place) -> Vec<String> {
    let (mode, atlas) = match engine.cascades {
        1 => ("SHADOW_ORTHOGONAL", engine.size),
        _ => ("SHADOW_PARALLEL_4_SPLITS", 2 * engine.size),
    };
    let mut lines = vec![
        format!("light.shadow_bias = {:?}", engine.constant),
        format!("light.shadow_normal_bias = {:?}", engine.normal),
        "light.directional_shadow_pancake_size = 20.0".to_owned(),
        format!("light.directional_shadow_mode = DirectionalLight3D.{mode}"),
        format!(
            "light.directional_shadow_max_distance = {:?}",
            digits(place.far as f32, 5)
        ),
    ];
    for (i, share) in shares(&engine.splits, 0.0, place.far).iter().enumerate() {
        lines.push(format!(
            "light.directional_shadow_split_{} = {share:?}",
            i + 1
        ));
    }
    let quality = DIALECT.filters[engine.filter].name;
    lines.push(format!(
        "RenderingServer.directional_shadow_atlas_set_size({atlas}, false)"
    ));
    lines.push(format!(
        "RenderingServer.directional_soft_shadow_filter_set_quality(RenderingServer.{quality})"
    ));
    lines
}
