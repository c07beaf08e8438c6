//! What was found, for people and for programs.

use super::{
    CompareArgs,
    measure::{Job, Measured, MeasuredLight},
};
use crate::shadow_maps::{map_words, shown_size};
use serde_json::{Map, Value, json};
use umbriel_formats::render::{Cause, Comparison, Light, Mends, ShadowMap};

/// One table a light, and the pictures.
pub(super) fn table(job: &Job, measured: &Measured) -> String {
    let [width, height] = job.settings.resolution;
    let mut lines = vec![format!(
        "{} {width}x{height}, camera {:?}, differences above {} of a light",
        job.args.truth.scene.display(),
        job.camera.name,
        job.args.truth.tolerance
    )];
    for light in &measured.lights {
        lines.extend(light_lines(job, measured, light));
    }
    if measured.lights.len() > 1 {
        lines.push(format!(
            "all lights: {}",
            picture_words(measured.pictures.as_ref())
        ));
    }
    lines.join("\n")
}

fn light_lines(job: &Job, measured: &Measured, found: &MeasuredLight) -> Vec<String> {
    let errors = &found.errors;
    let light = &job.bvh.scene().lights[errors.light];
    let map = &job.settings.shadow_maps[errors.light];
    let mut lines = vec![
        String::new(),
        format!("light {:?}: {}", light.name(), map_words(light, map)),
        format!(
            "  would reach {} pixels; {}",
            errors.answers.len(),
            truth_words(measured, found, light)
        ),
        format!(
            "  {:<10}{:<22}{:>13}{:>13}",
            "cause", "", "wrongly dark", "wrongly lit"
        ),
    ];
    let share = |count| percent(errors.percent(count));
    for cause in Cause::ALL {
        lines.push(format!(
            "  {:<10}{:<22}{:>13}{:>13}",
            cause.name(),
            cause.meaning(),
            share(errors.count(cause, true)),
            share(errors.count(cause, false))
        ));
    }
    let dark = errors.wrong.iter().filter(|wrong| wrong.is_dark()).count();
    lines.push(format!(
        "  {:<32}{:>13}{:>13}",
        "all",
        share(dark),
        share(errors.wrong.len() - dark)
    ));
    let [bias, texels, neither] = mends(found).map(share);
    lines.push(format!(
        "  {bias} a bias can mend, {texels} more texels or another filter, {neither} neither"
    ));
    lines.push(format!(
        "  mean error {:.5} of the light; {}",
        errors.mean_error,
        picture_words(found.pictures.as_ref())
    ));
    lines
}

fn truth_words(measured: &Measured, found: &MeasuredLight, light: &Light) -> String {
    let rays = found.truth.rays;
    if found.truth.size == 0.0 {
        return format!("truth by {rays} rays");
    }
    let unit = match light {
        Light::Directional(_) => "degrees",
        Light::Point(_) | Light::Spot(_) => "m",
    };
    let size = match light {
        Light::Directional(_) => found.truth.size.to_degrees(),
        Light::Point(_) | Light::Spot(_) => found.truth.size,
    };
    format!(
        "truth by {rays} rays to a light of {:.4} {unit}, in penumbras to {:.3}",
        size,
        measured.how.error()
    )
}

/// Wrong pixels that a bias, that texels and filters, and that neither can mend.
fn mends(found: &MeasuredLight) -> [usize; 3] {
    let mends = Mends::of(&found.errors.wrong);
    [mends.bias, mends.texels, mends.neither].map(|count| count as usize)
}

fn picture_words(pictures: Option<&Comparison>) -> String {
    let rmse = pictures.map_or("none".to_owned(), |c| format!("{:.6}", c.rmse));
    format!("pictures: ssim {}, rmse {rmse}", ssim(pictures))
}

/// Of pictures of at least 11x11 pixels.
pub(super) fn ssim(pictures: Option<&Comparison>) -> String {
    let known = pictures.and_then(|c| c.ssim);
    known.map_or("none".to_owned(), |ssim| format!("{ssim:.5}"))
}

/// Three digits behind the point: a hundred-thousandth of the points is seen.
pub(crate) fn percent(percent: f64) -> String {
    format!("{percent:.3} %")
}

/// How long it took.
pub(super) fn times(args: &CompareArgs, measured: &Measured, total: f64) -> String {
    let s = &measured.seconds;
    let ms = |seconds: f64| format!("{:.1} ms", 1e3 * seconds);
    let saved = args
        .output
        .as_ref()
        .map_or(String::new(), |path| format!("saved {}; ", path.display()));
    format!(
        "{saved}build {}, maps {}, points {}, truth {}, errors {}, pictures {}; {} in all",
        ms(s.build),
        ms(s.maps),
        ms(s.points),
        ms(s.truth),
        ms(s.errors),
        ms(s.pictures),
        ms(total)
    )
}

/// All numbers. Those of pictures that cannot be compared are null.
pub(super) fn to_json(job: &Job, measured: &Measured, total: f64) -> Value {
    let s = &measured.seconds;
    let lights: Vec<Value> = measured
        .lights
        .iter()
        .map(|light| light_json(job, measured, light))
        .collect();
    json!({
        "scene": job.args.truth.scene.display().to_string(),
        "camera": job.camera.name,
        "width": job.settings.resolution[0],
        "height": job.settings.resolution[1],
        "crop": job.settings.crop,
        "tolerance": job.args.truth.tolerance,
        "output": job.args.output.as_ref().map(|path| path.display().to_string()),
        "pictures": pictures_json(measured.pictures.as_ref()),
        "lights": lights,
        "phases": {
            "build": s.build,
            "maps": s.maps,
            "points": s.points,
            "truth": s.truth,
            "errors": s.errors,
            "pictures": s.pictures,
            "total": total,
        },
    })
}

fn light_json(job: &Job, measured: &Measured, found: &MeasuredLight) -> Value {
    let errors = &found.errors;
    let light = &job.bvh.scene().lights[errors.light];
    let map = &job.settings.shadow_maps[errors.light];
    let side = |is_dark: bool| -> Value {
        let counts = Cause::ALL.map(|cause| (cause.name(), errors.count(cause, is_dark)));
        let all = counts.iter().map(|c| c.1).sum();
        let counts = counts.into_iter().chain([("all", all)]);
        let one = |(name, count): (&str, usize)| {
            let share = json!({ "pixels": count, "percent": errors.percent(count) });
            (name.to_owned(), share)
        };
        Value::Object(counts.map(one).collect::<Map<String, Value>>())
    };
    let [bias, texels, neither] = mends(found).map(|count| errors.percent(count));
    json!({
        "light": light.name(),
        "images": ShadowMap::images(light, map),
        "resolution": map.resolution,
        "bias": map.bias.to_string(),
        "filter": map.filter.to_string(),
        "size": shown_size(light, map),
        "pixels": errors.answers.len(),
        "wrongly_dark": side(true),
        "wrongly_lit": side(false),
        "mean_error": errors.mean_error,
        "mend_percent": { "bias": bias, "texels_or_filter": texels, "neither": neither },
        "pictures": pictures_json(found.pictures.as_ref()),
        "truth_rays": found.truth.rays,
        "truth_error": if found.truth.size > 0.0 { measured.how.error() } else { 0.0 },
    })
}

fn pictures_json(pictures: Option<&Comparison>) -> Value {
    pictures.map_or(
        Value::Null,
        |c| json!({ "ssim": c.ssim, "rmse": c.rmse, "differing": c.differing }),
    )
}
