//! What one light's map and its rays say of a point.

use super::ray_tree::TreeRay;
use crate::{
    BiasParts, Control, Footprint, InstanceId, LightErrors, LightSample, LightTruth, Question,
    SceneBvh, SeenPoint, SeenPoints, ShadowComparison, ShadowMaps, SurfaceInteraction,
    TruthSettings, WrongPixel, truth::reflected,
};
use std::sync::atomic::AtomicBool;
use umbriel_kernels::{
    Hit, Ray,
    glam::{Vec2, Vec3},
};

/// A light at the point that a pixel sees.
#[derive(Clone, Debug, PartialEq)]
pub struct LightExplanation {
    /// Position in [`Scene::lights`](crate::Scene::lights).
    pub light: usize,
    /// What the map and the rays say, or why neither is asked.
    pub answer: Result<Box<LightAnswer>, Unasked>,
}

/// Why a light is not asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unasked {
    /// The material does not reflect light.
    Unlit,
    /// The point is out of the light's range or cone, or the light is in the point.
    OutOfReach,
    /// The surface faces away from the light.
    FacesAway,
    /// The surface reflects next to nothing of the light to the eye.
    TooLittle,
}

/// What is known of a light at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct LightAnswer {
    /// The point as it is asked for.
    pub point: SeenPoint,
    /// The light that arrives if nothing stands in its way.
    pub arriving: LightSample,
    /// What the pixel shows of that, in nit.
    pub unshadowed: Vec3,
    /// The fraction of the light that arrives, by the map.
    pub map: f32,
    /// By rays, by colour.
    pub truth: Vec3,
    /// How many rays said so.
    pub rays: u64,
    /// How the map comes to its answer; `None` for points that it does not hold.
    pub how: Option<MapAnswer>,
    /// What a ray to the light's centre meets first; `None` for nothing.
    pub blocker: Option<Blocker>,
    /// If map and rays differ by more than the tolerance.
    pub wrong: Option<WrongPixel>,
}

/// How a map comes to its answer.
#[derive(Clone, Debug, PartialEq)]
pub struct MapAnswer {
    /// The comparison with the texel that the point lies in.
    pub comparison: ShadowComparison,
    /// What its bias is made of.
    pub bias: BiasParts,
    /// The comparisons that the answer is made of.
    pub footprint: Footprint,
    /// Who wrote the texel that the point lies in, and where; `None` if nobody did.
    pub writer: Option<Blocker>,
}

/// A place on something that casts a shadow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blocker {
    /// Which instance.
    pub instance: InstanceId,
    /// The triangle, or the part of the surface.
    pub primitive: u32,
    /// World position.
    pub p: Vec3,
}

/// What is known of light number `light` at the surface that the eye ray of pixel number `pixel` meets; `None` where it meets nothing.
pub(super) fn explain_light(
    bvh: &SceneBvh,
    maps: &ShadowMaps,
    eye: &TreeRay,
    (pixel, light): (u32, usize),
    settings: &TruthSettings,
    tolerance: f32,
) -> Option<LightExplanation> {
    let (hit, surface) = (eye.hit.as_ref()?, eye.surface.as_ref()?);
    let answer = ask(bvh, light, pixel, hit, surface);
    let answer = answer.map(|(point, arriving, radiance)| {
        let question = Question { point: 0, radiance };
        let mut questions = vec![Vec::new(); bvh.scene().lights.len()];
        questions[light].push(question);
        let seen = SeenPoints {
            points: vec![point],
            questions,
        };
        let size = maps.of(light).settings.light_size;
        let control = Control {
            stop: &AtomicBool::new(false),
            progress: &|_, _| {},
        };
        let truth = LightTruth::trace(bvh, &seen, light, size, settings, &control);
        let glass = settings.glass_shadows;
        let errors = LightErrors::find(bvh, maps, &seen, &truth, glass, tolerance);
        Box::new(LightAnswer {
            point,
            arriving,
            unshadowed: radiance,
            map: errors.answers[0],
            truth: truth.fractions[0],
            rays: truth.rays,
            how: how(maps, light, &point),
            blocker: blocker(bvh, &point.shadow_ray(arriving.to_light, arriving.t_max)),
            wrong: errors.wrong.first().copied(),
        })
    });
    Some(LightExplanation { light, answer })
}

/// The point that a light is asked about, what arrives there, and what the pixel shows of it.
fn ask(
    bvh: &SceneBvh,
    light: usize,
    pixel: u32,
    hit: &Hit,
    surface: &SurfaceInteraction,
) -> Result<(SeenPoint, LightSample, Vec3), Unasked> {
    if surface.bsdf.unlit {
        return Err(Unasked::Unlit);
    }
    let light = &bvh.scene().lights[light];
    let arriving = light.sample(surface.p).ok_or(Unasked::OutOfReach)?;
    let radiance = reflected(light, surface).ok_or_else(|| {
        if arriving.wi.dot(surface.ng) > 0.0 {
            Unasked::TooLittle
        } else {
            Unasked::FacesAway
        }
    })?;
    Ok((SeenPoint::new(pixel, hit, surface), arriving, radiance))
}

fn how(maps: &ShadowMaps, light: usize, point: &SeenPoint) -> Option<MapAnswer> {
    let map = maps.of(light);
    let comparison = map.lookup(point.shadow_p, point.ng)?;
    let footprint = map.footprint(point.shadow_p, point.ng)?;
    let (tap, face) = (&comparison.tap, comparison.tap.face);
    let [x, y] = tap.texel;
    let written = |(instance, primitive)| {
        let center = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
        Blocker {
            instance,
            primitive,
            p: map.faces()[face].view.point(center, tap.stored),
        }
    };
    let is_within = x >= 0 && y >= 0;
    let writer = is_within.then(|| maps.writer(light, face, x as u32, y as u32));
    Some(MapAnswer {
        bias: map.bias_parts(comparison.face, point.shadow_p, point.ng),
        comparison,
        footprint,
        writer: writer.flatten().map(written),
    })
}

/// What a ray to a light meets first, of what may hold light back.
fn blocker(bvh: &SceneBvh, ray: &Ray) -> Option<Blocker> {
    let mut hits = [None];
    bvh.first_blockers(&[*ray], &mut hits);
    let hit = hits[0]?;
    Some(Blocker {
        instance: InstanceId(hit.instance),
        primitive: hit.primitive,
        p: ray.at(hit.t),
    })
}
