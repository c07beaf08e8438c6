//! The picture of the errors: a panel for each light.

use super::{
    measure::{Job, Measured, MeasuredLight},
    words::{percent, ssim},
};
use crate::{
    shadow_maps::map_words,
    sheet::{Bitmap, Panel, compose, with_legend},
};
use umbriel_formats::render::{Cause, Image, Tonemap, develop, error_picture, srgb_to_linear};

/// All panels, with their legends and numbers.
pub(super) fn draw(job: &Job, measured: &Measured) -> Bitmap {
    let linear = |&[r, g, b, a]: &[f32; 4]| {
        let [r, g, b] = [r, g, b].map(|value| srgb_to_linear((255.0 * value).round() as u8));
        [r, g, b, a]
    };
    let ground = Image {
        pixels: measured.shown.pixels.iter().map(linear).collect(),
        ..measured.shown
    };
    let panels: Vec<Panel> = measured
        .lights
        .iter()
        .map(|light| panel(job, measured, light, &ground))
        .collect();
    let columns = match panels.len() {
        1 => 1,
        2..=4 => 2,
        _ => 3,
    };
    compose(&panels, columns)
}

fn panel(job: &Job, measured: &Measured, found: &MeasuredLight, ground: &Image) -> Panel {
    let errors = &found.errors;
    let light = &job.bvh.scene().lights[errors.light];
    let share = |count| percent(errors.percent(count));
    let legend = Cause::ALL.map(|cause| {
        let count = errors.count(cause, true) + errors.count(cause, false);
        let words = format!("{} {}", cause.meaning(), share(count));
        (cause.color(), words)
    });
    let image = error_picture(ground, errors);
    let picture = Bitmap {
        width: image.width,
        height: image.height,
        pixels: develop(&image, 0.0, Tonemap::Linear),
    };
    let dark = errors.wrong.iter().filter(|wrong| wrong.is_dark()).count();
    let truth = match found.truth.size > 0.0 {
        true => format!("; truth by {} rays in penumbras", measured.how.rays),
        false => String::new(),
    };
    let caption = format!(
        "{} wrongly dark, {} wrongly lit of {} pixels that the light would reach; mean error {:.4}; ssim {}; {}{truth}",
        share(dark),
        share(errors.wrong.len() - dark),
        errors.answers.len(),
        errors.mean_error,
        ssim(found.pictures.as_ref()),
        map_words(light, &job.settings.shadow_maps[errors.light]),
    );
    Panel {
        title: format!("light {:?}: wrong pixels by cause", light.name()),
        caption,
        picture: with_legend(picture, &legend),
    }
}
