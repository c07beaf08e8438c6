//! The tree of rays, from the side.

use super::{
    super::{Job, rays::ray_kind, words::met},
    panel::{BLUE, GAP, GREEN, ORANGE, PANEL, Panel, RED, WIDTH},
};
use umbriel_formats::render::{
    RayKind, RayTree, Section, TermSource, TreeRay,
    kernels::glam::{Vec2, Vec3},
};

/// What the colours mean, for a line above the panel.
pub(super) const LEGEND: [(&str, &str); 5] = [
    ("black", "the eye's ray"),
    (BLUE, "mirrored"),
    (GREEN, "refracted"),
    (ORANGE, "to a light that arrives"),
    (RED, "to a light that does not"),
];
/// Rays that are drawn.
const MOST: usize = 200;
/// Rays that have a number.
const NUMBERED: usize = 24;

/// The panel.
pub(super) fn draw(job: &Job, tree: &RayTree, top: f64) -> String {
    let size = [WIDTH - 2.0 * GAP, PANEL[1]];
    let eye = &tree.rays[0];
    let Some(section) = upright(job, eye) else {
        return String::new();
    };
    let mut ends: Vec<Vec2> = tree
        .rays
        .iter()
        .filter_map(|ray| Some(section.at(ray.ray.at(ray.hit?.t))))
        .collect();
    ends.push(section.at(eye.ray.origin));
    let reach = ends
        .iter()
        .map(|end| end.distance(ends[0]))
        .fold(0.0, f32::max);
    // Rays that meet nothing end somewhere.
    let open = if reach > 0.0 { 0.3 * reach } else { 1.0 };
    ends.extend(tree.rays.iter().map(|ray| section.at(end_of(ray, open))));
    let mut panel = Panel::around(&ends, [GAP, top], size);
    panel.surfaces(job, &section, 1.2);
    for (number, ray) in tree.rays.iter().enumerate().take(MOST) {
        let (from, to) = (section.at(ray.ray.origin), section.at(end_of(ray, open)));
        let width = (0.6 + 2.4 * ray.weight.max_element().min(1.0)).clamp(0.6, 3.0);
        panel.line(
            from,
            to,
            color(ray.kind),
            &format!("stroke-width=\"{width:.1}\""),
        );
        shadow_rays(job, tree, number as u32, &section, open, &mut panel);
    }
    for (number, ray) in tree.rays.iter().enumerate().take(MOST) {
        let (to, brings) = (
            section.at(end_of(ray, open)),
            tree.brought_by(number as u32),
        );
        let title = format!("{number} {}: {}", ray_kind(ray.kind), met(job, ray));
        panel.dot(
            to,
            5.0,
            &job.hex(brings / ray.weight.max(Vec3::splat(1e-6))),
            &title,
        );
        if number < NUMBERED {
            panel.label(to, [7.0, -5.0], &number.to_string());
        }
    }
    panel.dot(section.at(eye.ray.origin), 4.0, BLUE, "the eye");
    panel.label(section.at(eye.ray.origin), [8.0, -8.0], "eye");
    panel.finish()
}

/// The vertical plane through the eye's ray; for one that goes straight up or down, that of the camera.
fn upright(job: &Job, eye: &TreeRay) -> Option<Section> {
    let (origin, dir) = (eye.ray.origin, eye.ray.dir);
    let flat = Vec3::new(dir.x, 0.0, dir.z);
    if flat.length() > 1e-3 {
        return Section::new(origin, flat, Vec3::Y);
    }
    let up = Vec3::from(job.camera.pose.matrix3.y_axis);
    Section::new(origin, up, dir)
}

fn end_of(ray: &TreeRay, open: f32) -> Vec3 {
    ray.ray.at(ray.hit.map_or(open, |hit| hit.t))
}

fn color(kind: RayKind) -> &'static str {
    match kind {
        RayKind::Eye => "black",
        RayKind::Mirrored => BLUE,
        RayKind::Refracted => GREEN,
        RayKind::Passed => "#cc79a7",
    }
}

/// A short piece of the way to each light from where a ray ends.
fn shadow_rays(
    job: &Job,
    tree: &RayTree,
    number: u32,
    section: &Section,
    open: f32,
    panel: &mut Panel,
) {
    let Some(surface) = &tree.rays[number as usize].surface else {
        return;
    };
    for term in tree.terms.iter().filter(|term| term.ray == number) {
        let TermSource::Light(light) = term.source else {
            continue;
        };
        let Some(arriving) = job.bvh.scene().lights[light as usize].sample(surface.p) else {
            continue;
        };
        let length = if arriving.t_max > 1.0 {
            open
        } else {
            arriving.to_light.length().min(open)
        };
        let (color, style) = if term.fraction.max_element() > 0.0 {
            (ORANGE, "stroke-width=\"1\"")
        } else {
            (RED, "stroke-width=\"1\" stroke-dasharray=\"3 3\"")
        };
        let end = surface.p + arriving.wi * length;
        panel.line(section.at(surface.p), section.at(end), color, style);
    }
}
