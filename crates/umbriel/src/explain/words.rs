//! What was found, for people.

use super::{
    Job, comparison,
    names::{blocker, instance, kind, material, part, percent, short, vector},
    rays,
};
use umbriel_formats::render::{
    Explanation, InstanceId, Light, LightAnswer, LightExplanation, TreeRay, Unasked,
};

/// The whole report.
pub(super) fn report(job: &Job, found: &Explanation) -> String {
    let [width, height] = job.settings.resolution;
    let [x, y] = found.pixel;
    let (mapped, whitted) = (found.mapped.radiance(), found.whitted.radiance());
    let mut lines = vec![
        format!(
            "{} {width}x{height}, camera {:?}, pixel {x},{y}: {} by shadow maps, {} by Whitted's rays",
            job.args.truth.scene.display(),
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
    lines.extend(comparison::lines(job, light.light, answer));
    lines.push(format!("  rays      {}", ray_words(job, answer)));
    if let Some(why) = comparison::why(answer) {
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
