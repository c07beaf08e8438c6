//! What was found, for people.

use super::{
    TuneArgs,
    engines::Dialect,
    measure::{Job, Measured, Refusal, TunedEngine, TunedLight},
};
use crate::compare::percent;
use umbriel_formats::render::{Found, Light, Mends, Score, ShadowMap, ShadowMapSettings, Shimmer};

/// A part for each light.
pub(super) fn report(job: &Job, tuned: &[TunedLight]) -> String {
    let [width, height] = job.settings.resolution;
    let mut lines = vec![format!(
        "{} {width}x{height}, {} around {:?}, differences above {} of a light",
        job.args.truth.scene.display(),
        cameras(job.args.cameras),
        job.camera.name,
        job.args.truth.tolerance
    )];
    for light in tuned {
        lines.push(String::new());
        lines.extend(light_lines(job, light));
    }
    lines.join("\n")
}

/// `1 camera`, `4 cameras`.
pub(super) fn cameras(count: u32) -> String {
    match count {
        1 => "1 camera".to_owned(),
        _ => format!("{count} cameras"),
    }
}

fn light_lines(job: &Job, tuned: &TunedLight) -> Vec<String> {
    let light = &job.bvh.scene().lights[tuned.light];
    let is_timed = tuned.budget.seconds.is_some();
    let mut lines = vec![
        format!(
            "light {:?}: would reach {} pixels; {} settings tried for at most {} texels{}",
            light.name(),
            tuned.own.score.asked,
            tuned.tried,
            tuned.budget.texels,
            match tuned.budget.seconds {
                Some(seconds) => format!(" and {} ms", 1e3 * seconds),
                None => String::new(),
            }
        ),
        format!(
            "  {:>10}{}{:>11}{:>15}{:>12}  settings",
            "texels",
            if is_timed { "        ms" } else { "" },
            "wrong",
            "no bias mends",
            "mean error",
        ),
    ];
    for (found, mends) in &tuned.front {
        lines.push(front_line(light, found, mends, is_timed));
    }
    lines.push(own_line(light, &tuned.own, is_timed));
    if let Some((best, mends)) = tuned.front.last() {
        lines.push(format!(
            "  best: {} wrong, of which {} no bias can mend: more texels or another filter do{}",
            percent(best.score.percent()),
            share(mends.texels, &best.score),
            match mends.neither {
                0 => String::new(),
                n => format!("; {} nothing does (glass, outside)", share(n, &best.score)),
            }
        ));
        lines.push(format!("  {}", flags(light, &best.map)));
    }
    if let Some([best, own]) = &tuned.shimmer {
        lines.push(format!("  shimmer: {}", shimmer_words(best.as_ref())));
        lines.push(format!("    as set: {}", shimmer_words(own.as_ref())));
    }
    for engine in &tuned.engines {
        lines.extend(engine_lines(light, engine));
    }
    lines
}

fn front_line(light: &Light, found: &Found, mends: &Mends, is_timed: bool) -> String {
    format!(
        "  {:>10}{}{:>11}{:>15}{:>12.5}  {}",
        found.texels,
        time(&found.score, is_timed),
        percent(found.score.percent()),
        share(mends.texels, &found.score),
        found.score.mean_error(),
        settings(light, &found.map)
    )
}

fn own_line(light: &Light, own: &Measured, is_timed: bool) -> String {
    format!(
        "  {:>10}{}{:>11}{:>15}{:>12.5}  as set: {}",
        own.texels,
        time(&own.score, is_timed),
        percent(own.score.percent()),
        "",
        own.score.mean_error(),
        settings(light, &own.map)
    )
}

fn time(score: &Score, is_timed: bool) -> String {
    if is_timed {
        format!("{:>10.2}", 1e3 * score.seconds)
    } else {
        String::new()
    }
}

fn engine_lines(light: &Light, engine: &TunedEngine) -> Vec<String> {
    let Dialect { title, units, .. } = engine.dialect;
    let default = &engine.default;
    let mut lines = vec![
        String::new(),
        format!(
            "  {title}, not set: {} wrong of {} texels",
            percent(default.score.percent()),
            default.texels
        ),
    ];
    match &engine.best {
        Some((settings, found)) => {
            lines.push(format!(
                "  {title}, tuned:   {} wrong of {} texels",
                percent(found.score.percent()),
                found.texels
            ));
            let code = (engine.dialect.paste)(settings, &engine.place);
            lines.extend(code.into_iter().map(|line| format!("    {line}")));
            lines.push(format!("  here: {}", flags(light, &found.map)));
        }
        None => lines.push(format!(
            "  {title}: nothing that it has keeps to the budget"
        )),
    }
    lines.push(format!("  units: {units}"));
    lines
}

fn shimmer_words(shimmer: Option<&Shimmer>) -> String {
    let Some(found) = shimmer else {
        return "not measured: the middle of what the light would reach is in no map".to_owned();
    };
    let share = |count| percent(100.0 * count as f64 / found.pixels.max(1) as f64);
    format!(
        "{} of the pixels change a quarter of a texel of {:.4} m, {} in truth, {} by the map alone",
        share(found.map),
        found.texel,
        share(found.truth),
        share(found.only_map)
    )
}

/// `4 of 1024x1024, split 0.6, bias adaptive:1, filter hard`.
pub(super) fn settings(light: &Light, map: &ShadowMapSettings) -> String {
    let side = map.resolution;
    let images = match ShadowMap::images(light, map) {
        1 => String::new(),
        n => format!("{n} of "),
    };
    let split = match light {
        Light::Directional(_) if map.cascades > 1 => format!(", split {}", map.cascade_split),
        _ => String::new(),
    };
    format!(
        "{images}{side}x{side}{split}, bias {}, filter {}",
        map.bias, map.filter
    )
}

/// The settings as options of the other commands.
pub(super) fn flags(light: &Light, map: &ShadowMapSettings) -> String {
    let mut flags = format!(
        "--shadow-map-size {} --shadow-bias {} --shadow-filter {}",
        map.resolution, map.bias, map.filter
    );
    if let Light::Directional(_) = light {
        flags += &format!(" --cascades {}", map.cascades);
        if map.cascades > 1 {
            flags += &format!(" --cascade-split {}", map.cascade_split);
        }
    }
    flags
}

/// Why a light was not tuned.
pub(super) fn refusal(args: &TuneArgs, name: &str, refusal: &Refusal) -> String {
    match refusal {
        Refusal::Unseen => format!("light {name:?} would reach nothing that the cameras see"),
        Refusal::NoShadow => {
            format!(
                "light {name:?} casts no shadow on what the cameras see, so there is nothing to tune"
            )
        }
        Refusal::Budget(least, _) if args.texels.is_some_and(|texels| texels < *least) => format!(
            "--texels: {} are too few for light {name:?}; the least that would do is {least}",
            args.texels.unwrap_or_default()
        ),
        Refusal::Budget(least, fastest) => match args.milliseconds {
            Some(ms) if fastest.is_finite() => format!(
                "--milliseconds: nothing that was tried for light {name:?} took {ms} ms or less; the least was {:.3} ms, and times are never twice the same",
                1e3 * fastest
            ),
            _ => format!(
                "nothing keeps to the budget for light {name:?}; the least number of texels is {least}"
            ),
        },
    }
}

/// A count of pixels as a percentage of those that the light would reach.
pub(super) fn share(count: u64, score: &Score) -> String {
    percent(100.0 * count as f64 / score.asked.max(1) as f64)
}

/// How long it took.
pub(super) fn times(args: &TuneArgs, tuned: &[TunedLight], seconds: f64, total: f64) -> String {
    let written = [&args.output, &args.plot].into_iter().flatten();
    let saved: String = written
        .map(|path| format!("saved {}; ", path.display()))
        .collect();
    let tried: u64 = tuned.iter().map(|light| light.tried).sum();
    format!(
        "{saved}{tried} settings from {} in {seconds:.2} s; {total:.2} s in all",
        cameras(args.cameras)
    )
}
