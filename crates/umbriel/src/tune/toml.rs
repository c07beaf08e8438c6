//! The settings as a file that a scene can include.

use super::{
    measure::{Job, TunedLight},
    words::settings,
};
use crate::compare::percent;
use umbriel_formats::render::{Light, ShadowMapSettings};

/// A table `[render.shadow_map]` for the first light tuned, which others have, too, unless they have a table of their own; for each further one a line to paste
/// into its table.
pub(super) fn settings_file(job: &Job, tuned: &[TunedLight]) -> String {
    let scene = job.args.truth.scene.file_name().unwrap_or_default();
    let mut lines = vec![
        format!("# Shadow maps of {}, by `umbriel tune`.", scene.display()),
        "# What a scene says itself goes before what it includes: take its own `shadow_map` away to use this.".to_owned(),
    ];
    for (number, tuned) in tuned.iter().enumerate() {
        let Some((best, _)) = tuned.front.last() else {
            continue;
        };
        let light = &job.bvh.scene().lights[tuned.light];
        lines.push(String::new());
        lines.push(format!(
            "# Light {:?}: {} of the pixels wrong with {} texels.",
            light.name(),
            percent(best.score.percent()),
            best.texels
        ));
        let fields = fields(light, &best.map);
        if number == 0 {
            lines.push("[render.shadow_map]".to_owned());
            lines.extend(fields.iter().map(|(key, value)| format!("{key} = {value}")));
        } else {
            let fields: Vec<String> = fields
                .iter()
                .map(|(key, value)| format!("{key} = {value}"))
                .collect();
            lines.push("# To paste into the table of this light:".to_owned());
            lines.push(format!("# shadow_map = {{ {} }}", fields.join(", ")));
        }
        lines.push(format!("# {}", settings(light, &best.map)));
    }
    lines.push(String::new());
    lines.join("\n")
}

/// Keys and values as in the file.
fn fields(light: &Light, map: &ShadowMapSettings) -> Vec<(&'static str, String)> {
    let mut fields = vec![
        ("resolution", map.resolution.to_string()),
        ("bias", format!("\"{}\"", map.bias)),
        ("filter", format!("\"{}\"", map.filter)),
    ];
    if let Light::Directional(_) = light {
        fields.push(("cascades", map.cascades.to_string()));
        fields.push(("cascade_split", format!("{:?}", map.cascade_split)));
    }
    fields
}
