//! three.js: `DirectionalLightShadow`.

use super::{ConstantUnit, Dialect, EngineFilter, EngineSettings, NormalUnit, Place, digits};
use umbriel_formats::render::{Light, NormalRule, ShadowFilter};

const fn pcf(radius: f32, name: &'static str) -> EngineFilter {
    EngineFilter {
        own: ShadowFilter::Vogel { taps: 5, radius },
        name,
        bias_factor: 1.0,
    }
}

/// `p + n · normalBias`, and `bias` added to the depth from 0 at `camera.near` to 1 at `camera.far`.
///
/// Source: src/renderers/shaders/ShaderChunk/shadowmap_vertex.glsl.js, shadowmap_pars_fragment.glsl.js (five taps on Vogel's disk of `radius` texels)
/// (github.com/mrdoob/three.js).
pub(super) const DIALECT: Dialect = Dialect {
    name: "three",
    title: "three.js",
    rule: NormalRule::Whole,
    constant: ConstantUnit::MinusRange,
    normal: NormalUnit::Metres,
    has_slope: false,
    cascades: &[1],
    filters: &[
        pcf(1.0, "1"),
        EngineFilter {
            own: ShadowFilter::Hard,
            name: "basic",
            bias_factor: 1.0,
        },
        pcf(0.5, "0.5"),
        pcf(2.0, "2"),
        pcf(4.0, "4"),
    ],
    has_local_lights: false,
    default,
    paste,
    units: "bias is in lengths of camera.near to camera.far, below 0 towards the light; normalBias is in metres, whatever the light's angle; radius is in texels. three.js turns its \
            disk from pixel to pixel, here it stands still; it draws the back faces of single-sided meshes into its map, here both sides are in it.",
};

/// Source: src/lights/LightShadow.js: bias 0, normalBias 0, radius 1, mapSize 512x512; WebGLShadowMap's type PCFShadowMap.
fn default(_: &Light, _: &Place) -> EngineSettings {
    EngineSettings {
        size: 512,
        cascades: 1,
        splits: Vec::new(),
        constant: 0.0,
        slope: 0.0,
        normal: 0.0,
        filter: 0,
    }
}

fn paste(engine: &EngineSettings, place: &Place) -> Vec<String> {
    let size = engine.size;
    let mut lines = vec![
        format!("light.shadow.mapSize.set({size}, {size});"),
        format!("light.shadow.bias = {:?};", engine.constant),
        format!("light.shadow.normalBias = {:?};", engine.normal),
        format!(
            "light.shadow.camera.far = light.shadow.camera.near + {:?};",
            digits(place.range, 5)
        ),
    ];
    lines.push(match DIALECT.filters[engine.filter].name {
        "basic" => "renderer.shadowMap.type = THREE.BasicShadowMap;".to_owned(),
        radius => {
            format!("renderer.shadowMap.type = THREE.PCFShadowMap; light.shadow.radius = {radius};")
        }
    });
    lines
}
