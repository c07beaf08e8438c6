//! The cut through the eye, the point and a light, as a whole and near the point.

use super::{
    super::{
        Job,
        names::{blocker, percent, short},
    },
    panel::{BLUE, GAP, GREEN, ORANGE, PANEL, Panel, RED},
};
use umbriel_formats::render::{
    DepthMap, Explanation, LightAnswer, MapAnswer, Section, kernels::glam::Vec2,
    kernels::glam::Vec3,
};

/// What is cut.
struct Cut<'a> {
    job: &'a Job<'a>,
    answer: &'a LightAnswer,
    section: Section,
    /// In the plane; the point is at (0, 0).
    eye: Vec2,
    /// Where the way to the light ends in the drawing.
    light: Vec2,
    /// Whether the light itself is there.
    is_near: bool,
}

/// Lights further away than so many times the eye are drawn as an arrow.
const FAR: f32 = 3.0;
/// Borders of more texels would be grey.
const MOST_COLUMNS: f32 = 60.0;

/// Both panels of a light.
pub(super) fn draw(
    job: &Job,
    found: &Explanation,
    light: usize,
    answer: &LightAnswer,
    top: f64,
) -> String {
    let point = answer.point.p;
    let eye = found.mapped.rays[0].ray.origin;
    let Some(section) = plane(point, eye, answer) else {
        return String::new();
    };
    let reach = FAR * (eye - point).length();
    let to_light = answer.arriving.to_light;
    let is_near = answer.arriving.t_max <= 1.0 && to_light.length() <= reach;
    let light_at = if is_near {
        point + to_light
    } else {
        point + answer.arriving.wi * reach / FAR
    };
    let cut = Cut {
        job,
        answer,
        eye: section.at(eye),
        light: section.at(light_at),
        section,
        is_near,
    };
    let right = 2.0 * GAP + PANEL[0];
    cut.whole([GAP, top]) + &cut.near(light, [right, top])
}

/// The plane through the point, the eye and the light, upright if it can be, with the light to the right.
fn plane(point: Vec3, eye: Vec3, answer: &LightAnswer) -> Option<Section> {
    let wi = answer.arriving.wi;
    // An eye in line with the light leaves the choice to the surface.
    let beside = [eye - point, answer.point.ng, Vec3::Y, Vec3::X];
    let n = beside.into_iter().find_map(|v| {
        let n = wi.cross(v.normalize_or_zero());
        (n.length() > 1e-2).then(|| n.normalize())
    })?;
    let up = Vec3::Y - n * n.y;
    let y = if up.length() > 0.2 {
        up.normalize()
    } else {
        wi
    };
    let x = y.cross(n);
    let x = if x.dot(wi) < 0.0 { -x } else { x };
    Section::new(point, x, y)
}

impl Cut<'_> {
    /// From the eye to the light.
    fn whole(&self, corner: [f64; 2]) -> String {
        let places = [Vec2::ZERO, self.eye, self.light];
        let mut panel = Panel::around(&places, corner, PANEL);
        panel.surfaces(self.job, &self.section, 1.6);
        panel.line(self.eye, Vec2::ZERO, BLUE, "stroke-width=\"1.5\"");
        self.way_to_light(&mut panel);
        panel.dot(self.eye, 5.0, BLUE, "the eye");
        panel.label(self.eye, [8.0, -8.0], "eye");
        if self.is_near {
            panel.dot(self.light, 6.0, ORANGE, "the light");
            panel.label(self.light, [10.0, 4.0], "light");
        } else {
            panel.label(self.light, [8.0, 4.0], "to the light");
        }
        panel.dot(Vec2::ZERO, 4.0, "white", "the point");
        panel.label(Vec2::ZERO, [8.0, 16.0], "point");
        let truth = self.answer.truth.max_element();
        panel.notes(&[("black", format!("by rays {} arrives", percent(truth)))]);
        panel.finish()
    }

    /// Up to what stands in the way, and beyond.
    fn way_to_light(&self, panel: &mut Panel) {
        let Some(found) = &self.answer.blocker else {
            panel.line(Vec2::ZERO, self.light, GREEN, "stroke-width=\"1.5\"");
            return;
        };
        let at = self.section.at(found.p);
        panel.line(Vec2::ZERO, at, RED, "stroke-width=\"1.5\"");
        panel.line(
            at,
            self.light,
            ORANGE,
            "stroke-width=\"1.5\" stroke-dasharray=\"5 4\"",
        );
        let name = blocker(self.job.bvh.scene(), found);
        panel.dot(at, 4.0, RED, &name);
        panel.label(at, [8.0, -6.0], &name);
    }

    /// Around the point: the map's texels, what they hold, and what is compared with it.
    fn near(&self, light: usize, corner: [f64; 2]) -> String {
        let Some(how) = &self.answer.how else {
            let mut panel = Panel::around(&[Vec2::ZERO, Vec2::ONE], corner, PANEL);
            panel.notes(&[("black", "the map does not reach the point".to_owned())]);
            return panel.finish();
        };
        let texel = how.comparison.texel;
        let above = how.comparison.depth - how.comparison.tap.stored;
        let seen = [6.0 * texel, 1.5 * how.comparison.bias, how.bias.moved * 1.5];
        let reach = seen.into_iter().fold(0.0, f32::max);
        // What stands far above is not worth the scale.
        let reach = if above.abs() < 24.0 * texel {
            reach.max(1.3 * above.abs())
        } else {
            reach
        };
        let half = Vec2::splat(reach);
        let mut panel = Panel::around(&[-half, half], corner, PANEL);
        let map = &self.job.maps.of(light).faces()[how.comparison.face];
        let [low, high] = panel.window();
        let across = (high - low).length() / texel;
        self.texels(
            &mut panel,
            map,
            across.clamp(8.0, 200.0),
            (high - low).length(),
        );
        panel.surfaces(self.job, &self.section, 2.5);
        self.compared(&mut panel, map, how);
        panel.finish()
    }

    /// Each texel's column, what it holds, and what it takes for shadow.
    fn texels(&self, panel: &mut Panel, map: &DepthMap, reach: f32, far: f32) {
        let (view, p) = (&map.view, self.answer.point.shadow_p);
        let depth = (p - view.origin).dot(view.forward) - view.shift.z;
        let has_columns = reach < MOST_COLUMNS;
        for texel in self.section.texels(map, p, reach) {
            let place = |end: Vec2, z: f32| self.section.at(view.point(end, z));
            let [a, b] = texel.ends;
            let (first, last) = (depth - far, depth + far);
            let first = if view.perspective {
                first.max(0.0)
            } else {
                first
            };
            if has_columns {
                panel.line(
                    place(a, first),
                    place(a, last),
                    "#d8d8d8",
                    "stroke-width=\"0.7\"",
                );
            }
            if texel.stored < last {
                let shadow = [
                    place(a, texel.stored),
                    place(b, texel.stored),
                    place(b, last),
                    place(a, last),
                ];
                panel.area(&shadow, "#7f7fbf", "fill-opacity=\"0.18\"");
                panel.line(
                    place(a, texel.stored),
                    place(b, texel.stored),
                    ORANGE,
                    "stroke-width=\"2.5\"",
                );
            }
        }
    }

    /// The point, where it is compared, and the verdict.
    fn compared(&self, panel: &mut Panel, map: &DepthMap, how: &MapAnswer) {
        let (seen, tap) = (&how.comparison, &how.comparison.tap);
        let normal = self.answer.point.ng;
        let along = Vec2::new(normal.dot(self.section.x), normal.dot(self.section.y));
        let point = Vec2::ZERO;
        panel.line(
            point,
            point + along * 3.0 * seen.texel,
            "black",
            "stroke-width=\"1\"",
        );
        panel.label(point + along * 3.0 * seen.texel, [4.0, 0.0], "normal");
        let color = if tap.lit { GREEN } else { RED };
        if tap.face == seen.face {
            let compared = self.section.at(map.view.point(seen.at, tap.compared));
            panel.line(point, compared, color, "stroke-width=\"2\"");
            panel.dot(compared, 5.0, color, "what is compared");
        }
        panel.dot(point, 4.0, "white", "the point");
        let verdict = if tap.lit { "lit" } else { "dark" };
        panel.notes(&[
            (
                ORANGE,
                format!(
                    "what the map holds: {} m in the point's texel",
                    short(tap.stored)
                ),
            ),
            ("#6060a0", "what it takes for shadow".to_owned()),
            (
                color,
                format!("what is compared, {} m: {verdict}", short(tap.compared)),
            ),
            (
                "black",
                format!(
                    "one texel is {} m wide; map: {} of the light",
                    short(seen.texel),
                    percent(self.answer.map)
                ),
            ),
        ]);
    }
}
