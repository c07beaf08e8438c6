//! What was found, for people.

use super::{
    Job,
    names::{blocker, instance, kind, material, part, percent, short, vector},
    rays,
};
use crate::shadow_maps::map_words;
use umbriel_formats::render::{
    Cause, Explanation, InstanceId, Light, LightAnswer, LightExplanation, MapAnswer, Tap, TreeRay,
    Unasked,
};

/// The whole report.
pub(super) fn report(job: &Job, found: &Explanation) -> String {
    let [width, height] = job.settings.resolution;
    let [x, y] = found.pixel;
    let (mapped, whitted) = (found.mapped.radiance(), found.whitted.radiance());
    let mut lines = vec![
        format!(
            "{} {width}x{height}, camera {:?}, pixel {x},{y}: {} by shadow maps, {} by Whitted's rays",
            job.args.scene.display(),
            job.camera.name,
            job.hex(mapped),
            job.hex(whitted),
        ),
        String::new(),
    ];
    lines.extend(seen(job, &found.mapped.rays[0]));
    if found.lights.is_empty() {
        lines.push(String::new());
        lines.push(no_lights(job, found).to_owned());
    }
    for light in &found.lights {
        if job.lights.contains(&light.light) {
            lines.push(String::new());
            lines.extend(light_lines(job, light));
        }
    }
    lines.push(String::new());
    lines.extend(rays::lines(job, &found.whitted));
    lines.join("\n")
}

fn no_lights(job: &Job, found: &Explanation) -> &'static str {
    if job.bvh.scene().lights.is_empty() {
        "the scene has no lights: what is seen is the sky's light and what shines by itself"
    } else if found.mapped.rays[0].hit.is_none() {
        "no surface, so no light is asked for"
    } else {
        ""
    }
}

/// What the pixel sees.
fn seen(job: &Job, eye: &TreeRay) -> Vec<String> {
    let (Some(hit), Some(surface)) = (&eye.hit, &eye.surface) else {
        let dir = vector(eye.ray.dir);
        return vec![format!("sees the sky, in the direction {dir}")];
    };
    let scene = job.bvh.scene();
    let id = InstanceId(hit.instance);
    let side = if surface.front {
        "front"
    } else {
        "back or inside"
    };
    let bsdf = &surface.bsdf;
    let mut lines = vec![
        format!(
            "sees the {side} of {}, material {:?}, {} m away",
            part(scene, id, hit.primitive),
            material(scene, id).name,
            short(hit.t)
        ),
        format!("  point     {}", vector(surface.p)),
        format!(
            "  normal    {}; for shading {}",
            vector(surface.ng),
            vector(surface.ns)
        ),
        format!(
            "  material  colour {}, metallic {}, roughness {}, transmission {}, alpha {}",
            vector(bsdf.base_color),
            short(bsdf.metallic),
            short(bsdf.roughness),
            short(material(scene, id).transmission),
            short(bsdf.alpha)
        ),
    ];
    if surface.shadow_p != surface.p {
        let lift = (surface.shadow_p - surface.p).length();
        lines.push(format!(
            "  lifted    {} m for shadows, onto the curve that the normals describe",
            short(lift)
        ));
    }
    lines
}

fn light_lines(job: &Job, light: &LightExplanation) -> Vec<String> {
    let known = &job.bvh.scene().lights[light.light];
    let name = format!("light {:?}, {}", known.name(), light_kind(known));
    let answer = match &light.answer {
        Err(why) => return vec![format!("{name}: not asked for, {}", unasked(*why))],
        Ok(answer) => answer,
    };
    let mut lines = vec![format!("{name}: {}", verdict(answer))];
    lines.push(format!(
        "  light     {}, at {:.1} degrees to the normal; would add {}",
        distance(answer),
        angle(answer),
        job.hex(answer.unshadowed)
    ));
    lines.extend(map_lines(job, light.light, answer));
    lines.push(format!("  rays      {}", ray_words(job, answer)));
    if let Some(why) = why(answer) {
        lines.push(format!("  why       {why}"));
    }
    lines
}

fn light_kind(light: &Light) -> &'static str {
    match light {
        Light::Directional(_) => "directional",
        Light::Point(_) => "point",
        Light::Spot(_) => "spot",
    }
}

fn unasked(why: Unasked) -> &'static str {
    match why {
        Unasked::Unlit => "the material is unlit",
        Unasked::OutOfReach => "the point is out of its range or cone",
        Unasked::FacesAway => "the surface faces away from it",
        Unasked::TooLittle => "the surface reflects next to nothing of it to the eye",
    }
}

fn distance(answer: &LightAnswer) -> String {
    if answer.arriving.t_max > 1.0 {
        "endlessly far away".to_owned()
    } else {
        format!("{} m away", short(answer.arriving.to_light.length()))
    }
}

/// Between the light and the surface's normal, in degrees.
fn angle(answer: &LightAnswer) -> f32 {
    let cos = answer.arriving.wi.dot(answer.point.ng);
    cos.clamp(-1.0, 1.0).acos().to_degrees()
}

/// Right or wrong, and the cause.
pub(super) fn verdict(answer: &LightAnswer) -> String {
    let Some(wrong) = &answer.wrong else {
        let state = match answer.map {
            0.0 => "dark",
            1.0 => "lit",
            _ => "partly lit",
        };
        let off = (answer.truth - answer.map).abs().max_element();
        let how = if off == 0.0 {
            "rightly"
        } else {
            "within the tolerance"
        };
        return format!("{state}, {how}: {}", both(answer));
    };
    let state = if wrong.is_dark() {
        "wrongly dark"
    } else {
        "wrongly lit"
    };
    let (name, meaning) = (wrong.cause.name(), wrong.cause.meaning());
    let cause = if meaning.starts_with(name) {
        meaning.to_owned()
    } else {
        format!("{name} ({meaning})")
    };
    let off = percent((wrong.map - wrong.truth).abs());
    format!("{state} by {off} of the light, {cause}: {}", both(answer))
}

fn both(answer: &LightAnswer) -> String {
    let truth = answer.truth;
    let colored = truth.x != truth.y || truth.y != truth.z;
    let truth = if colored {
        format!(
            "{} of red, green, blue",
            truth.to_array().map(percent).join(", ")
        )
    } else {
        percent(truth.x)
    };
    format!("the map lets {} through, rays {truth}", percent(answer.map))
}

/// How the map comes to its answer.
fn map_lines(job: &Job, number: usize, answer: &LightAnswer) -> Vec<String> {
    let scene = job.bvh.scene();
    let settings = &job.settings.shadow_maps[number];
    let made = map_words(&scene.lights[number], settings);
    let Some(how) = &answer.how else {
        return vec![format!("  map       {made}; it does not hold the point")];
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

/// What stands in the way of rays.
fn ray_words(job: &Job, answer: &LightAnswer) -> String {
    let count = match answer.rays {
        1 => "1 ray".to_owned(),
        n => format!("{n} rays over the light"),
    };
    let first = match &answer.blocker {
        None => "to its centre nothing stands in the way".to_owned(),
        Some(found) => format!(
            "to its centre the first thing is {}, {} m from the point",
            blocker(job.bvh.scene(), found),
            short((found.p - answer.point.p).length())
        ),
    };
    format!("{count}; {first}")
}

/// What makes the map wrong, and what would mend it.
fn why(answer: &LightAnswer) -> Option<String> {
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

/// What a ray meets.
pub(super) fn met(job: &Job, ray: &TreeRay) -> String {
    match &ray.hit {
        None => "the sky".to_owned(),
        Some(hit) => {
            let id = InstanceId(hit.instance);
            let scene = job.bvh.scene();
            format!(
                "{} ({}), {} m",
                instance(scene, id),
                kind(scene, id),
                short(hit.t)
            )
        }
    }
}
