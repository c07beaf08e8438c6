//! The work: maps, points, rays, pictures.

use super::CompareArgs;
use crate::{interrupt::STOP, progress::Progress, render::timed, values::Exposure};
use umbriel_formats::render::{
    Camera, Comparison, Control, Image, LightErrors, LightTruth, SceneBvh, SeenPoints, Settings,
    ShadowMaps, Tonemap, TruthSettings, auto_exposure, compare, develop, render_with_maps,
    truth_picture,
};

/// What is compared.
pub(super) struct Job<'a> {
    pub(super) args: &'a CompareArgs,
    pub(super) bvh: &'a SceneBvh<'a>,
    pub(super) camera: &'a Camera,
    pub(super) settings: &'a Settings,
    pub(super) exposure: Exposure,
    pub(super) tonemap: Option<Tonemap>,
}

/// One light's part.
pub(super) struct MeasuredLight {
    pub(super) truth: LightTruth,
    pub(super) errors: LightErrors,
    /// Of the picture with maps and that where this light alone is true; `None` for pictures that cannot be compared.
    pub(super) pictures: Option<Comparison>,
}

/// What was found.
pub(super) struct Measured {
    pub(super) lights: Vec<MeasuredLight>,
    /// Of the picture with maps and that with the truth of all lights asked for.
    pub(super) pictures: Option<Comparison>,
    /// The picture with maps, as shown.
    pub(super) shown: Image,
    pub(super) how: TruthSettings,
    pub(super) seconds: Seconds,
}

/// How long each part took.
pub(super) struct Seconds {
    pub(super) build: f64,
    pub(super) maps: f64,
    pub(super) points: f64,
    pub(super) truth: f64,
    pub(super) errors: f64,
    pub(super) pictures: f64,
}

/// Does the work for the lights `chosen`, on the rayon pool that it is called in.
pub(super) fn measure(job: &Job, chosen: &[usize]) -> Measured {
    let (bvh, camera, settings) = (job.bvh, job.camera, job.settings);
    let ((), build) = timed(|| bvh.build_trees());
    let (maps, map_time) = timed(|| ShadowMaps::render(bvh, camera, settings, true));
    let (seen, points) = timed(|| SeenPoints::find(bvh, camera, settings));
    let rays = TruthSettings::default().rays;
    let how = job.args.truth.truth(settings, rays);
    let (truths, truth) = timed(|| {
        let trace = |&light: &usize| trace(job, &maps, &seen, light, &how);
        chosen.iter().map(trace).collect::<Vec<_>>()
    });
    let (errors, error_time) = timed(|| {
        let find = |truth| {
            LightErrors::find(
                bvh,
                &maps,
                &seen,
                truth,
                how.glass_shadows,
                job.args.truth.tolerance,
            )
        };
        truths.iter().map(find).collect::<Vec<_>>()
    });
    let ((lights, shown, pictures), picture_time) =
        timed(|| compare_pictures(job, &maps, &seen, truths, errors));
    Measured {
        lights,
        pictures,
        shown,
        how,
        seconds: Seconds {
            build,
            maps: map_time,
            points,
            truth,
            errors: error_time,
            pictures: picture_time,
        },
    }
}

fn trace(
    job: &Job,
    maps: &ShadowMaps,
    seen: &SeenPoints,
    light: usize,
    how: &TruthSettings,
) -> LightTruth {
    let progress = Progress::new(job.args.truth.quiet, true);
    let control = Control {
        stop: &STOP,
        progress: &|done, total| progress.update(done, total),
    };
    let size = maps.of(light).settings.light_size;
    let truth = LightTruth::trace(job.bvh, seen, light, size, how, &control);
    progress.finish();
    truth
}

/// Draws the picture with maps, puts the truth in the place of each light's answers and of all, and compares what is shown.
fn compare_pictures(
    job: &Job,
    maps: &ShadowMaps,
    seen: &SeenPoints,
    truths: Vec<LightTruth>,
    errors: Vec<LightErrors>,
) -> (Vec<MeasuredLight>, Image, Option<Comparison>) {
    let control = Control {
        stop: &STOP,
        progress: &|_, _| {},
    };
    let film = render_with_maps(job.bvh, job.camera, job.settings, Some(maps), &control);
    let stops = match job.exposure {
        Exposure::Stops(stops) => stops,
        Exposure::Auto => auto_exposure(&film.image),
    };
    let as_shown = |image: &Image| as_shown(image, stops, job.tonemap.unwrap_or_default());
    let shown = as_shown(&film.image);
    let against = |lights: &[(&LightTruth, &LightErrors)]| {
        let truth = truth_picture(&film.image, seen, lights);
        compare(&shown, &as_shown(&truth), 0.0)
    };
    let pairs: Vec<_> = truths.iter().zip(&errors).collect();
    let own: Vec<_> = pairs.iter().map(|&pair| against(&[pair])).collect();
    let all = match own[..] {
        [only] => only,
        _ => against(&pairs),
    };
    let lights = truths.into_iter().zip(errors).zip(own);
    let lights = lights.map(|((truth, errors), pictures)| MeasuredLight {
        truth,
        errors,
        pictures,
    });
    (lights.collect(), shown, all)
}

/// The values of a PNG of the image, from 0 to 1: those that `umbriel diff` compares.
fn as_shown(image: &Image, stops: f32, tonemap: Tonemap) -> Image {
    let bytes = develop(image, stops, tonemap);
    let value = |pixel: [u8; 4]| pixel.map(|byte| f32::from(byte) / 255.0);
    Image {
        pixels: bytes.into_iter().map(value).collect(),
        ..*image
    }
}
