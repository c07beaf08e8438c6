//! What was found, for programs. Lengths are metres, radiances nit, directions of unit length; what is infinite is null.

use super::{Job, rays::ray_kind, words::verdict};
use serde_json::{Value, json};
use umbriel_formats::render::{
    Blocker, Explanation, InstanceId, LightAnswer, LightExplanation, MapAnswer, RayTree, Scene,
    Tap, Term, TermSource, TreeRay, Unasked,
};

/// All numbers.
pub(super) fn to_json(job: &Job, found: &Explanation, total: f64) -> Value {
    let lights = found.lights.iter();
    let lights = lights.filter(|light| job.lights.contains(&light.light));
    json!({
        "scene": job.args.truth.scene.display().to_string(),
        "camera": job.camera.name,
        "width": job.settings.resolution[0],
        "height": job.settings.resolution[1],
        "pixel": found.pixel,
        "tolerance": job.args.truth.tolerance,
        "color": {
            "shadow_map": job.hex(found.mapped.radiance()),
            "whitted": job.hex(found.whitted.radiance()),
        },
        "seen": seen_json(job, &found.mapped.rays[0]),
        "lights": lights.map(|light| light_json(job, light)).collect::<Value>(),
        "rays": {
            "shadow_map": tree_json(job, &found.mapped),
            "whitted": tree_json(job, &found.whitted),
        },
        "output": job.args.output.as_ref().map(|path| path.display().to_string()),
        "seconds": total,
    })
}

fn instance_json(scene: &Scene, id: InstanceId, primitive: u32) -> Value {
    let instance = &scene.instances[id.index()];
    json!({
        "instance": id.0,
        "name": instance.name,
        "material": scene.materials[instance.material.index()].name,
        "primitive": primitive,
    })
}

fn blocker_json(scene: &Scene, blocker: &Blocker) -> Value {
    let mut value = instance_json(scene, blocker.instance, blocker.primitive);
    value["point"] = json!(blocker.p.to_array());
    value
}

/// What a ray sees; null for the sky.
fn seen_json(job: &Job, ray: &TreeRay) -> Value {
    let (Some(hit), Some(surface)) = (&ray.hit, &ray.surface) else {
        return Value::Null;
    };
    let bsdf = &surface.bsdf;
    let mut value = instance_json(job.bvh.scene(), InstanceId(hit.instance), hit.primitive);
    value["distance"] = json!(hit.t);
    value["point"] = json!(surface.p.to_array());
    value["normal"] = json!(surface.ng.to_array());
    value["shading_normal"] = json!(surface.ns.to_array());
    value["shadow_point"] = json!(surface.shadow_p.to_array());
    value["front"] = json!(surface.front);
    value["bsdf"] = json!({
        "base_color": bsdf.base_color.to_array(),
        "metallic": bsdf.metallic,
        "roughness": bsdf.roughness,
        "transmission": bsdf.transmission,
        "ior": bsdf.ior,
        "alpha": bsdf.alpha,
        "emission": bsdf.emission.to_array(),
    });
    value
}

fn light_json(job: &Job, light: &LightExplanation) -> Value {
    let name = job.bvh.scene().lights[light.light].name();
    match &light.answer {
        Ok(answer) => {
            let mut value = answer_json(job, light.light, answer);
            value["light"] = json!(name);
            value["asked"] = json!(true);
            value
        }
        Err(why) => json!({
            "light": name,
            "asked": false,
            "why": match why {
                Unasked::Unlit => "unlit",
                Unasked::OutOfReach => "out of reach",
                Unasked::FacesAway => "faces away",
                Unasked::TooLittle => "too little",
            },
        }),
    }
}

fn answer_json(job: &Job, light: usize, answer: &LightAnswer) -> Value {
    let scene = job.bvh.scene();
    json!({
        "verdict": verdict(answer),
        "wrong": answer.wrong.as_ref().map(|wrong| json!({
            "cause": wrong.cause.name(),
            "is_dark": wrong.is_dark(),
            "difference": wrong.map - wrong.truth,
        })),
        "to_light": answer.arriving.to_light.to_array(),
        "unshadowed": answer.unshadowed.to_array(),
        "map_fraction": answer.map,
        "truth_fraction": answer.truth.to_array(),
        "truth_rays": answer.rays,
        "first_on_the_way": answer.blocker.as_ref().map(|found| blocker_json(scene, found)),
        "map": answer.how.as_ref().map(|how| map_json(job, light, how)),
    })
}

fn map_json(job: &Job, light: usize, how: &MapAnswer) -> Value {
    let (seen, bias) = (&how.comparison, &how.bias);
    let taps = how.footprint.taps.iter();
    let taps: Value = taps
        .map(|(tap, weight)| {
            let mut value = tap_json(tap);
            value["weight"] = json!(weight);
            value
        })
        .collect();
    json!({
        "images": job.maps.of(light).faces().len(),
        "image": seen.face,
        "place": seen.at.to_array(),
        "texel_width": seen.texel,
        "depth": seen.depth,
        "comparison": tap_json(&seen.tap),
        "difference": finite(seen.tap.compared - seen.tap.stored),
        "writer": how.writer.as_ref().map(|found| blocker_json(job.bvh.scene(), found)),
        "bias": {
            "nearer": seen.bias,
            "constant": bias.constant,
            "sloped": bias.sloped,
            "rounding": bias.rounding,
            "plane": bias.plane,
            "moved": bias.moved,
            "tangent": bias.tangent,
        },
        "taps": taps,
    })
}

fn tap_json(tap: &Tap) -> Value {
    json!({
        "image": tap.face,
        "texel": tap.texel,
        "stored": finite(tap.stored),
        "compared": tap.compared,
        "lit": tap.lit,
    })
}

fn finite(value: f32) -> Value {
    if value.is_finite() {
        json!(value)
    } else {
        Value::Null
    }
}

fn tree_json(job: &Job, tree: &RayTree) -> Value {
    let ray = |(number, ray): (usize, &TreeRay)| {
        let terms = tree.terms.iter().filter(|term| term.ray as usize == number);
        json!({
            "parent": ray.parent,
            "kind": ray_kind(ray.kind),
            "depth": ray.depth,
            "origin": ray.ray.origin.to_array(),
            "direction": ray.ray.dir.to_array(),
            "weight": ray.weight.to_array(),
            "seen": seen_json(job, ray),
            "seen_weight": ray.seen_weight.to_array(),
            "terms": terms.map(|term| term_json(job, term)).collect::<Value>(),
            "brings": tree.brought_by(number as u32).to_array(),
        })
    };
    json!({
        "radiance": tree.radiance().to_array(),
        "rays": tree.rays.iter().enumerate().map(ray).collect::<Value>(),
    })
}

fn term_json(job: &Job, term: &Term) -> Value {
    let source = match term.source {
        TermSource::Sky => "sky".to_owned(),
        TermSource::Own => "own".to_owned(),
        TermSource::Light(number) => {
            let name = job.bvh.scene().lights[number as usize].name();
            format!("light {name}")
        }
    };
    json!({
        "source": source,
        "fraction": term.fraction.to_array(),
        "radiance": term.radiance.to_array(),
    })
}
