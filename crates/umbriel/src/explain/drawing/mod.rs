//! The drawing: for each light a cut through the eye, the point and the light, and the tree of rays from the side.

mod cut;
mod panel;
mod side;

use super::{Job, words::verdict};
use crate::svg::{document, text};
use panel::{GAP, PANEL, WIDTH};
use umbriel_formats::render::Explanation;

/// Lights that are drawn; the others are in the words.
const MOST_LIGHTS: usize = 8;
/// Height of the words above panels.
const WORDS: f64 = 46.0;

/// The drawing as SVG.
pub(super) fn draw(job: &Job, found: &Explanation) -> String {
    let [x, y] = found.pixel;
    let title = format!(
        "{}, camera {:?}, pixel {x},{y}",
        job.args.truth.scene.display(),
        job.camera.name
    );
    let mut content = bold(text([GAP, 24.0], "start", &title)) + "\n";
    let mut top = 36.0;
    let answers = found.lights.iter().filter_map(|light| {
        let answer = light.answer.as_ref().ok()?;
        job.lights
            .contains(&light.light)
            .then_some((light.light, answer))
    });
    for (light, answer) in answers.take(MOST_LIGHTS) {
        let name = job.bvh.scene().lights[light].name();
        let words = format!("Light {name:?}: {}", verdict(answer));
        content += &(text([GAP, top + 24.0], "start", &words) + "\n");
        content += &cut::draw(job, found, light, answer, top + WORDS);
        top += WORDS + PANEL[1] + GAP;
    }
    content += &(rays_words(top + 24.0) + "\n");
    content += &side::draw(job, &found.whitted, top + WORDS);
    top += WORDS + PANEL[1] + GAP;
    document([WIDTH, top], &content)
}

/// What the last panel shows.
fn rays_words(y: f64) -> String {
    let words = "Whitted's rays from the side, each dot in the colour that its ray finds; grey: the scene in the vertical plane of the eye's ray";
    let legend = side::LEGEND
        .map(|(color, words)| format!("<tspan fill=\"{color}\" dx=\"12\">{words}</tspan>"));
    format!(
        "{}\n<text x=\"{GAP}\" y=\"{:.1}\">{}</text>",
        text([GAP, y], "start", words),
        y + 15.0,
        legend.join("")
    )
}

fn bold(words: String) -> String {
    words.replacen("<text", "<text font-weight=\"bold\" font-size=\"15\"", 1)
}
