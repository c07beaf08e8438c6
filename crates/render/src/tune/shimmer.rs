//! The shimmer meter: how much of a shadow changes while the camera moves by less than a texel.

use super::score::TuneBench;
use crate::{
    Camera, Control, LightTruth, SeenPoints, ShadowMapSettings, ShadowMaps, TruthSettings,
    truth::brightness,
};
use umbriel_kernels::glam::Vec3;

/// What changed from picture to picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shimmer {
    /// Width of the map's texel in metres by whose parts the camera moved.
    pub texel: f32,
    /// Pixels that the light would reach before and after a step, of all steps.
    pub pixels: u64,
    /// Pixels of these whose shadow changed by the map's word.
    pub map: u64,
    /// Pixels whose shadow changed in truth: they show another place.
    pub truth: u64,
    /// Pixels whose shadow changed by the map's word, not in truth.
    pub only_map: u64,
}

/// Steps a texel.
const PARTS: u32 = 4;
/// Steps along each direction.
const STEPS: u32 = 4;

/// The answers of a picture, by pixel: what the map says and what rays say; `None` where the light would not reach.
type Answers = Vec<Option<[f32; 2]>>;

/// Moves the first camera in steps of a quarter of a texel to the side and along its view, and counts the pixels whose shadow changes by more than the tolerance from
/// each step to the next.
///
/// What the pixels see moves, too, so shadows change in truth: that is counted apart. A texel is that of the middle one of the points that the light would reach. `None` if
/// there is none, or if it is in no map.
pub fn shimmer(
    bench: &TuneBench,
    map: &ShadowMapSettings,
    truth: &TruthSettings,
    control: &Control,
) -> Option<Shimmer> {
    let view = bench.views.first()?;
    let questions = &view.seen.questions[bench.light];
    let middle = &view.seen.points[questions.get(questions.len() / 2)?.point as usize];
    let settings = bench.settings_with(map);
    let mut maps = ShadowMaps::default();
    maps.render_only(bench.bvh, &view.camera, &settings, false, bench.light);
    let texel = maps
        .of(bench.light)
        .lookup(middle.shadow_p, middle.ng)?
        .texel;
    let mut found = Shimmer {
        texel,
        pixels: 0,
        map: 0,
        truth: 0,
        only_map: 0,
    };
    let axes = view.camera.pose.matrix3;
    for direction in [axes.x_axis, -axes.z_axis].map(Vec3::from) {
        let mut before: Option<Answers> = None;
        for step in 0..=STEPS {
            let by = direction * (texel * step as f32 / PARTS as f32);
            let mut camera = view.camera.clone();
            camera.pose.translation += umbriel_kernels::glam::Vec3A::from(by);
            let now = answers(bench, &mut maps, map, &camera, truth, control);
            if let Some(before) = &before {
                count(before, &now, bench.tolerance, &mut found);
            }
            before = Some(now);
        }
    }
    Some(found)
}

fn answers(
    bench: &TuneBench,
    maps: &mut ShadowMaps,
    map: &ShadowMapSettings,
    camera: &Camera,
    how: &TruthSettings,
    control: &Control,
) -> Answers {
    let settings = bench.settings_with(map);
    maps.render_only(bench.bvh, camera, &settings, false, bench.light);
    let seen = SeenPoints::find(bench.bvh, camera, &settings);
    let truth = LightTruth::trace(bench.bvh, &seen, bench.light, map.light_size, how, control);
    let [width, height] = settings.resolution;
    let mut answers = vec![None; width as usize * height as usize];
    for (question, &fraction) in seen.questions[bench.light].iter().zip(&truth.fractions) {
        let point = &seen.points[question.point as usize];
        let answer = maps.of(bench.light).fraction(point.shadow_p, point.ng);
        answers[point.pixel as usize] = Some([answer, brightness(fraction)]);
    }
    answers
}

fn count(before: &Answers, now: &Answers, tolerance: f32, found: &mut Shimmer) {
    for pair in before.iter().zip(now) {
        let (Some(a), Some(b)) = pair else { continue };
        let [map, truth] = [0, 1].map(|i| (a[i] - b[i]).abs() > tolerance);
        found.pixels += 1;
        found.map += u64::from(map);
        found.truth += u64::from(truth);
        found.only_map += u64::from(map && !truth);
    }
}
