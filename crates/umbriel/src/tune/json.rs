//! What was found, for programs.

use super::{
    measure::{Job, Measured, TunedEngine, TunedLight},
    words::flags,
};
use crate::shadow_maps::shown_size;
use serde_json::{Map, Value, json};
use umbriel_formats::render::{Found, Light, Mends, Score, ShadowMap, ShadowMapSettings, Shimmer};

/// All numbers. Times are in `phases`, and in `milliseconds` where they were limited.
pub(super) fn to_json(job: &Job, tuned: &[TunedLight], seconds: f64, total: f64) -> Value {
    let path =
        |path: &Option<std::path::PathBuf>| path.as_ref().map(|path| path.display().to_string());
    let lights: Vec<Value> = tuned.iter().map(|light| light_json(job, light)).collect();
    json!({
        "scene": job.args.truth.scene.display().to_string(),
        "camera": job.camera.name,
        "cameras": job.args.cameras,
        "width": job.settings.resolution[0],
        "height": job.settings.resolution[1],
        "tolerance": job.args.truth.tolerance,
        "output": path(&job.args.output),
        "plot": path(&job.args.plot),
        "lights": lights,
        "phases": { "tune": seconds, "total": total },
    })
}

fn light_json(job: &Job, tuned: &TunedLight) -> Value {
    let light = &job.bvh.scene().lights[tuned.light];
    let is_timed = tuned.budget.seconds.is_some();
    let found = |(found, mends): &(Found, Mends)| {
        let mut value = measured_json(light, &found.map, found.texels, &found.score, is_timed);
        value.insert("mend_pixels".to_owned(), mends_json(mends));
        Value::Object(value)
    };
    let own: &Measured = &tuned.own;
    json!({
        "light": light.name(),
        "pixels": own.score.asked,
        "tried": tuned.tried,
        "budget": {
            "texels": tuned.budget.texels,
            "milliseconds": tuned.budget.seconds.map(|seconds| 1e3 * seconds),
        },
        "own": measured_json(light, &own.map, own.texels, &own.score, is_timed),
        "front": tuned.front.iter().map(found).collect::<Vec<_>>(),
        "best": tuned.front.last().map(found),
        "shimmer": tuned.shimmer.as_ref().map(|[best, own]| json!({
            "best": best.as_ref().map(shimmer_json),
            "own": own.as_ref().map(shimmer_json),
        })),
        "engines": tuned.engines.iter().map(|engine| engine_json(light, engine, is_timed)).collect::<Vec<_>>(),
    })
}

fn measured_json(
    light: &Light,
    map: &ShadowMapSettings,
    texels: u64,
    score: &Score,
    is_timed: bool,
) -> Map<String, Value> {
    let value = json!({
        "images": ShadowMap::images(light, map),
        "resolution": map.resolution,
        "cascades": map.cascades,
        "cascade_split": map.cascade_split,
        "bias": map.bias.to_string(),
        "filter": map.filter.to_string(),
        "size": shown_size(light, map),
        "texels": texels,
        "wrong": score.wrong,
        "percent": score.percent(),
        "mean_error": score.mean_error(),
        "milliseconds": is_timed.then_some(1e3 * score.seconds),
        "options": flags(light, map),
    });
    match value {
        Value::Object(map) => map,
        _ => Map::new(),
    }
}

fn mends_json(mends: &Mends) -> Value {
    json!({
        "bias": mends.bias,
        "texels_or_filter": mends.texels,
        "neither": mends.neither,
    })
}

fn shimmer_json(shimmer: &Shimmer) -> Value {
    json!({
        "texel": shimmer.texel,
        "pixels": shimmer.pixels,
        "changed_map": shimmer.map,
        "changed_truth": shimmer.truth,
        "changed_map_alone": shimmer.only_map,
    })
}

fn engine_json(light: &Light, engine: &TunedEngine, is_timed: bool) -> Value {
    let default = &engine.default;
    let best = engine.best.as_ref().map(|(settings, found)| {
        let mut value = measured_json(light, &found.map, found.texels, &found.score, is_timed);
        let code = (engine.dialect.paste)(settings, &engine.place);
        value.insert("code".to_owned(), json!(code));
        Value::Object(value)
    });
    json!({
        "engine": engine.dialect.name,
        "default": measured_json(light, &default.map, default.texels, &default.score, is_timed),
        "best": best,
        "units": engine.dialect.units,
    })
}
