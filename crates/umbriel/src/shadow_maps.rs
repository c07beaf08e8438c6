//! Shadow maps as asked for: options over scene file over defaults, their memory, and what is said of them.

use crate::{
    args::ShadowMapArgs,
    errors::{Exit, Failure},
    plan::{available_memory, check_free, memory},
};
use serde_json::{Value, json};
use umbriel_formats::{
    Loaded, SceneSettings, ShadowMapOverrides, check_shadow_map_side,
    render::{Light, Method, Settings, ShadowFilter, ShadowMap, ShadowMapSettings},
};

/// The settings of each light of the scene.
pub(crate) fn choose_shadow_maps(
    args: &ShadowMapArgs,
    loaded: &Loaded,
) -> Result<Vec<ShadowMapSettings>, Failure> {
    let refuse = |message| Failure::new(Exit::Limit, message);
    let asked = ShadowMapOverrides {
        resolution: args
            .size
            .map(check_shadow_map_side)
            .transpose()
            .map_err(refuse)?,
        bias: args.bias,
        filter: args.filter,
        cascades: args.cascades,
        cascade_split: args.cascade_split,
    };
    let lights = loaded.scene.lights.iter();
    let own = loaded.settings.shadow_maps.iter();
    Ok(lights
        .zip(own)
        .map(|(light, own)| asked.apply(light, *own))
        .collect())
}

/// What a scene's own settings say of shadow maps.
pub(crate) fn own_settings(scene: &SceneSettings) -> Settings {
    let base = Settings::default();
    Settings {
        method: scene.method.unwrap_or(base.method),
        shadows: scene.shadows.unwrap_or(base.shadows),
        shadow_maps: scene.shadow_maps.clone(),
        ..base
    }
}

/// Each light with its settings, where shadow maps are drawn.
fn maps<'a>(
    settings: &'a Settings,
    lights: &'a [Light],
) -> impl Iterator<Item = (&'a Light, &'a ShadowMapSettings)> {
    let drawn = settings.method == Method::ShadowMap && settings.shadows;
    let lights = if drawn { lights } else { &[] };
    lights.iter().zip(&settings.shadow_maps)
}

/// Refuses shadow maps that do not fit into half of the free memory together: the picture needs some, too, and maps beyond that take minutes to draw.
pub(crate) fn check_shadow_memory(settings: &Settings, lights: &[Light]) -> Result<(), Failure> {
    let bytes = maps(settings, lights).fold(0_u64, |sum, (light, map)| {
        sum.saturating_add(ShadowMap::bytes(light, map))
    });
    let count = maps(settings, lights).count();
    let taker = match count {
        1 => "the shadow map of 1 light takes".to_owned(),
        _ => format!("the shadow maps of {count} lights take"),
    };
    check_free(bytes, &taker)?;
    match available_memory() {
        Some(free) if bytes >= 1 << 28 && bytes > free / 2 => {
            let (needed, free) = (memory(bytes as f64), memory(free as f64));
            let message = format!(
                "{taker} {needed} of memory; expected at most half of the {free} that are free, as with a smaller --shadow-map-size"
            );
            Err(Failure::new(Exit::Limit, message))
        }
        _ => Ok(()),
    }
}

/// A line for each way in which maps are made, with the lights that it is for.
pub(crate) fn shadow_map_lines(settings: &Settings, lights: &[Light]) -> Vec<String> {
    let mut groups: Vec<(String, Vec<String>)> = Vec::new();
    for (light, map) in maps(settings, lights) {
        let (words, name) = (map_words(light, map), format!("{:?}", light.name()));
        match groups.iter_mut().find(|(known, _)| *known == words) {
            Some((_, names)) => names.push(name),
            None => groups.push((words, vec![name])),
        }
    }
    let line = |(words, names): (String, Vec<String>)| {
        format!("shadow map of {}: {words}", names.join(", "))
    };
    groups.into_iter().map(line).collect()
}

/// `6 of 2048x2048, 96.0 MiB, bias adaptive:1, filter pcss:64, light of 0.1 m`.
pub(crate) fn map_words(light: &Light, map: &ShadowMapSettings) -> String {
    let (side, bytes) = (map.resolution, memory(ShadowMap::bytes(light, map) as f64));
    let count = match ShadowMap::images(light, map) {
        1 => String::new(),
        n => format!("{n} of "),
    };
    let mut words = format!(
        "{count}{side}x{side}, {bytes}, bias {}, filter {}",
        map.bias, map.filter
    );
    let default = ShadowMapSettings::default().cascade_split;
    let is_cascaded = matches!(light, Light::Directional(_)) && map.cascades > 1;
    if is_cascaded && map.cascade_split != default {
        words += &format!(", split {}", map.cascade_split);
    }
    if let ShadowFilter::Pcss { .. } = map.filter {
        words += &match light {
            Light::Directional(_) => format!(", light of {} degrees", shown_size(light, map)),
            Light::Point(_) | Light::Spot(_) => format!(", light of {} m", map.light_size),
        };
    }
    words
}

/// The light's size in the unit in which it is written.
pub(crate) fn shown_size(light: &Light, map: &ShadowMapSettings) -> f32 {
    match light {
        // As many digits as f32 keeps through the conversion: what was written comes back.
        Light::Directional(_) => (map.light_size.to_degrees() * 1e4).round() / 1e4,
        Light::Point(_) | Light::Spot(_) => map.light_size,
    }
}

/// The maps for programs: null under another method.
pub(crate) fn shadow_maps_json(settings: &Settings, lights: &[Light]) -> Value {
    if settings.method != Method::ShadowMap {
        return Value::Null;
    }
    let one = |(light, map): (&Light, &ShadowMapSettings)| {
        json!({
            "light": light.name(),
            "images": ShadowMap::images(light, map),
            "resolution": map.resolution,
            "bias": map.bias.to_string(),
            "filter": map.filter.to_string(),
            "size": shown_size(light, map),
            "memory": ShadowMap::bytes(light, map),
        })
    };
    maps(settings, lights).map(one).collect()
}

/// What is said of options for shadow maps that change nothing here.
pub(crate) fn idle_shadow_options(
    args: &ShadowMapArgs,
    settings: &Settings,
    lights: &[Light],
) -> Option<String> {
    let given = [
        (args.size.is_some(), "--shadow-map-size"),
        (args.bias.is_some(), "--shadow-bias"),
        (args.filter.is_some(), "--shadow-filter"),
        (args.cascades.is_some(), "--cascades"),
        (args.cascade_split.is_some(), "--cascade-split"),
        (
            args.light_size.is_some() && !settings.method.is_random(),
            "--light-size",
        ),
    ];
    let given: Vec<&str> = given.iter().filter(|(is, _)| *is).map(|g| g.1).collect();
    let sun = |light: &Light| matches!(light, Light::Directional(_));
    let soft = |map: &ShadowMapSettings| matches!(map.filter, ShadowFilter::Pcss { .. });
    let (names, reason) = if settings.method != Method::ShadowMap {
        (given, "without --method shadow-map")
    } else if !settings.shadows {
        (given, "without shadows")
    } else if given.iter().any(|name| name.starts_with("--cascade")) && !lights.iter().any(sun) {
        let given = given.into_iter();
        let names = given.filter(|name| name.starts_with("--cascade")).collect();
        (names, "without a directional light")
    } else if args.light_size.is_some() && !settings.shadow_maps.iter().any(soft) {
        (vec!["--light-size"], "without --shadow-filter pcss:TAPS")
    } else {
        return None;
    };
    let verb = if names.len() == 1 { "has" } else { "have" };
    (!names.is_empty()).then(|| format!("{} {verb} no effect {reason}", names.join(", ")))
}
