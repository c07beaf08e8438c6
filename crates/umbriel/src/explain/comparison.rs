//! How a map comes to its answer, for people.

use super::{
    Job,
    names::{blocker, percent, short, vector},
};
use crate::shadow_maps::map_words;
use umbriel_formats::render::{Cause, LightAnswer, MapAnswer, Tap};

/// How the map comes to its answer.
pub(super) fn lines(job: &Job, number: usize, answer: &LightAnswer) -> Vec<String> {
    let scene = job.bvh.scene();
    let settings = &job.settings.shadow_maps[number];
    let made = map_words(&scene.lights[number], settings);
    let Some(how) = &answer.how else {
        let why = if answer.map == 0.0 {
            "an infinite plane stands in the way"
        } else {
            "nothing that it shows could stand in the way"
        };
        return vec![format!(
            "  map       {made}; it does not reach the point: {why}"
        )];
    };
    let (seen, tap) = (&how.comparison, &how.comparison.tap);
    let images = job.maps.of(number).faces().len();
    let image = match images {
        1 => String::new(),
        _ => format!("image {} of {images}, ", seen.face),
    };
    let [x, y] = tap.texel;
    let stored = match &how.writer {
        Some(writer) => format!(
            "{} m, written by {} at {}",
            short(tap.stored),
            blocker(scene, writer),
            vector(writer.p)
        ),
        None => "nothing".to_owned(),
    };
    let mut lines = vec![
        format!("  map       {made}"),
        format!(
            "  texel     {image}{x},{y}, the point at {:.2},{:.2}, {} m wide there",
            seen.at.x,
            seen.at.y,
            short(seen.texel)
        ),
        format!("  stored    {stored}"),
        format!(
            "  compared  {} m: depth {} m, {}",
            short(tap.compared),
            short(seen.depth),
            bias_words(how)
        ),
        format!("  so        {}", comparison_words(how)),
    ];
    lines.extend(filter_lines(how));
    lines
}

/// The bias by its parts.
fn bias_words(how: &MapAnswer) -> String {
    let (bias, texel) = (&how.bias, how.comparison.texel);
    let parts = [
        (-bias.constant, "constant"),
        (-bias.sloped, "sloped"),
        (-bias.rounding, "rounding"),
        (bias.plane, "along the plane to the texel's centre"),
    ];
    let mut words: Vec<String> = parts
        .into_iter()
        .filter(|(metres, _)| *metres != 0.0)
        .map(|(metres, name)| {
            let sign = if metres < 0.0 { "-" } else { "+" };
            format!("{sign} {} m {name}", short(metres.abs()))
        })
        .collect();
    if bias.moved != 0.0 {
        words.insert(0, format!("moved {} m off the surface", short(bias.moved)));
    }
    if words.is_empty() {
        words.push("no bias".to_owned());
    }
    let degrees = bias.tangent.atan().to_degrees();
    format!(
        "{}; bias {} texels, slope {} ({degrees:.1} degrees)",
        words.join(", "),
        short(how.comparison.bias / texel),
        short(bias.tangent)
    )
}

/// How far the point lies before or behind what is stored.
fn comparison_words(how: &MapAnswer) -> String {
    let (tap, texel) = (&how.comparison.tap, how.comparison.texel);
    if !tap.stored.is_finite() {
        return "nothing stands there: lit".to_owned();
    }
    let behind = tap.compared - tap.stored;
    let size = format!(
        "{} m ({} texels)",
        short(behind.abs()),
        short(behind.abs() / texel)
    );
    if tap.lit {
        format!("what is compared lies {size} before what is stored: lit")
    } else {
        format!("what is compared lies {size} behind what is stored: dark")
    }
}

/// Each tap of a filter: a picture of its texels, and the numbers where they are few.
fn filter_lines(how: &MapAnswer) -> Vec<String> {
    /// Taps that are told one by one.
    const FEW: usize = 9;
    let taps = &how.footprint.taps;
    if taps.len() < 2 {
        return Vec::new();
    }
    let dark = taps.iter().filter(|(tap, _)| !tap.lit).count();
    let mut lines = vec![format!(
        "  filter    {} of {} texels dark (#) for the point's {}",
        dark,
        taps.len(),
        percent(how.comparison.fraction)
    )];
    let mut faces: Vec<usize> = taps.iter().map(|(tap, _)| tap.face).collect();
    faces.sort_unstable();
    faces.dedup();
    for face in faces {
        let own: Vec<&Tap> = taps
            .iter()
            .map(|(tap, _)| tap)
            .filter(|tap| tap.face == face)
            .collect();
        lines.extend(grid(&own));
    }
    if taps.len() <= FEW {
        for (tap, weight) in taps {
            lines.push(format!(
                "            {},{}: stored {}, compared {} m, {}, weight {}",
                tap.texel[0],
                tap.texel[1],
                short(tap.stored),
                short(tap.compared),
                if tap.lit { "lit" } else { "dark" },
                short(*weight)
            ));
        }
    }
    lines
}

/// The taps on one image as they lie there.
fn grid(taps: &[&Tap]) -> Vec<String> {
    /// Wider filters are not drawn.
    const MOST: i32 = 64;
    let range = |axis: usize| {
        let places = taps.iter().map(|tap| tap.texel[axis]);
        let first = places.clone().min().unwrap_or(0);
        (first, places.max().unwrap_or(first))
    };
    let ((left, right), (top, bottom)) = (range(0), range(1));
    if right - left >= MOST || bottom - top >= MOST {
        return Vec::new();
    }
    let sign = |x: i32, y: i32| match taps.iter().find(|tap| tap.texel == [x, y]) {
        Some(tap) if tap.lit => " .",
        Some(_) => " #",
        None => "  ",
    };
    let row = |y| {
        let signs: String = (left..=right).map(|x| sign(x, y)).collect();
        format!("           {}", signs.trim_end())
    };
    (top..=bottom).map(row).collect()
}

/// What makes the map wrong, and what would mend it.
pub(super) fn why(answer: &LightAnswer) -> Option<String> {
    let wrong = answer.wrong.as_ref()?;
    let words = match (wrong.cause, &answer.how) {
        (Cause::Acne, Some(how)) => acne(how),
        (Cause::Leak, Some(how)) => leak(how),
        (Cause::Edge, _) => "the truth changes between the point and the centres of the texels that it is compared with: twice as many texels a side halve such errors, a filter spreads them".to_owned(),
        (Cause::Penumbra, _) if answer.truth.x > 0.0 && answer.truth.x < 1.0 => "the point sees a part of the light, and no comparison with its centre knows: a filter as wide as the penumbra (pcss) does".to_owned(),
        (Cause::Penumbra, _) => "the filter reaches over an edge that it is too wide for: a narrower one mends it".to_owned(),
        (Cause::Glass, _) => "light passes what stands in the way in part, and a map knows one depth and no colour".to_owned(),
        _ => "the point, or what stands in its way, is not in the map".to_owned(),
    };
    Some(words)
}

fn acne(how: &MapAnswer) -> String {
    let (tap, texel) = (&how.comparison.tap, how.comparison.texel);
    if tap.lit {
        return "texels around the point's hold its own surface, nearer to the light than it is compared: more bias, one that follows the plane, or a narrower filter mends it".to_owned();
    }
    let missing = tap.compared - tap.stored;
    format!(
        "the texel holds the point's own surface, seen at the texel's centre: {} m ({} texels) more bias would light it",
        short(missing),
        short(missing / texel)
    )
}

fn leak(how: &MapAnswer) -> String {
    let (seen, tap) = (&how.comparison, &how.comparison.tap);
    let above = seen.depth - tap.stored;
    if !tap.lit || above <= 0.0 || !above.is_finite() {
        return "what stands in the way is in the map, and the filter lets light past it: another filter or a narrower one mends it".to_owned();
    }
    format!(
        "what stands in the way is in the map, {} m ({} texels) above the point, and the bias of {} m takes the point past it: less bias would keep the shadow",
        short(above),
        short(above / seen.texel),
        short(seen.bias)
    )
}
