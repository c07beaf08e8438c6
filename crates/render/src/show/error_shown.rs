//! Where the map is wrong, seen from the eye.

use super::{Fact, ShowContext, Shown};
use crate::{
    Cause, Control, Image, LightErrors, LightTruth, SeenPoints, TruthSettings, error_picture,
};

/// The errors of one light's map on `ground`, the picture as shown.
pub(super) fn error(context: &ShowContext, ground: &Image, control: &Control) -> Shown {
    let ShowContext {
        bvh, maps, light, ..
    } = *context;
    let glass_shadows = context.settings.glass();
    let settings = TruthSettings {
        glass_shadows,
        ..TruthSettings::default()
    };
    let seen = SeenPoints::find(bvh, context.camera, context.settings);
    let size = maps.of(light).settings.light_size;
    let truth = LightTruth::trace(bvh, &seen, light, size, &settings, control);
    let tolerance = LightErrors::TOLERANCE;
    let errors = LightErrors::find(bvh, maps, &seen, &truth, glass_shadows, tolerance);
    Shown {
        image: error_picture(ground, &errors),
        facts: facts(&errors),
    }
}

/// Percentages of the points that the light would reach.
fn facts(errors: &LightErrors) -> Vec<Fact> {
    let asked = errors.answers.len();
    let both = |cause| errors.count(cause, true) + errors.count(cause, false);
    let dark = errors.wrong.iter().filter(|wrong| wrong.is_dark()).count();
    let mut facts = vec![
        Fact::percent("wrongly dark", dark, asked),
        Fact::percent("wrongly lit", errors.wrong.len() - dark, asked),
    ];
    facts.extend(Cause::ALL.map(|cause| Fact::percent(cause.name(), both(cause), asked)));
    facts
}
