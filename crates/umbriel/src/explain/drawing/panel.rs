//! A panel of the drawing: a part of a plane, to scale.

use super::super::{Job, names::instance};
use crate::svg::{escaped, text};
use std::{collections::BTreeMap, fmt::Write};
use umbriel_formats::render::{InstanceId, Section, kernels::glam::Vec2};

/// Between panels and around them, in pixels.
pub(super) const GAP: f64 = 16.0;
/// Of the drawing.
pub(super) const WIDTH: f64 = 1060.0;
/// Width and height of one of two panels side by side.
pub(super) const PANEL: [f64; 2] = [(WIDTH - 3.0 * GAP) / 2.0, 400.0];
/// Lines across and down in which surfaces are sought.
const LINES: u32 = 150;
/// Of Okabe & Ito, told apart with every kind of colour vision.
pub(super) const BLUE: &str = "#0072b2";
pub(super) const ORANGE: &str = "#e69f00";
pub(super) const GREEN: &str = "#009e73";
pub(super) const RED: &str = "#d55e00";

/// Where a part of a plane is drawn.
pub(super) struct Panel {
    /// Of the plane that is shown, around its middle.
    middle: Vec2,
    /// Pixels a metre.
    scale: f64,
    /// Left and top in the drawing.
    corner: [f64; 2],
    size: [f64; 2],
    content: String,
}

impl Panel {
    /// Shows at least the places given, with room around them.
    pub(super) fn around(places: &[Vec2], corner: [f64; 2], size: [f64; 2]) -> Self {
        let bound = |pick: fn(Vec2, Vec2) -> Vec2| places.iter().copied().reduce(pick);
        let low = bound(Vec2::min).unwrap_or_default();
        let high = bound(Vec2::max).unwrap_or_default();
        let room = (1.25 * (high - low)).max(Vec2::splat(1e-6));
        let scale = (size[0] / f64::from(room.x)).min(size[1] / f64::from(room.y));
        Self {
            middle: 0.5 * (low + high),
            scale,
            corner,
            size,
            content: String::new(),
        }
    }

    /// The part of the plane that is seen.
    pub(super) fn window(&self) -> [Vec2; 2] {
        let half = self.size.map(|side| (0.5 * side / self.scale) as f32);
        let half = Vec2::from_array(half);
        [self.middle - half, self.middle + half]
    }

    /// A place in the drawing; y grows downwards there.
    pub(super) fn at(&self, place: Vec2) -> [f64; 2] {
        let from = place - self.middle;
        // Far outside is as good as just outside, and has fewer digits.
        let along = |metres: f32, side: f64| {
            (f64::from(metres) * self.scale).clamp(-8.0 * side, 8.0 * side)
        };
        [
            self.corner[0] + 0.5 * self.size[0] + along(from.x, self.size[0]),
            self.corner[1] + 0.5 * self.size[1] - along(from.y, self.size[1]),
        ]
    }

    pub(super) fn add(&mut self, element: &str) {
        self.content.push_str(element);
        self.content.push('\n');
    }

    /// A line; `style` is further attributes.
    pub(super) fn line(&mut self, from: Vec2, to: Vec2, color: &str, style: &str) {
        let ([x1, y1], [x2, y2]) = (self.at(from), self.at(to));
        self.add(&format!(
            "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"{color}\" {style}/>"
        ));
    }

    /// A dot that says what it is when it is pointed at.
    pub(super) fn dot(&mut self, place: Vec2, radius: f64, fill: &str, title: &str) {
        let [x, y] = self.at(place);
        self.add(&format!(
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"{fill}\" stroke=\"black\"><title>{}</title></circle>",
            escaped(title)
        ));
    }

    /// A filled area.
    pub(super) fn area(&mut self, corners: &[Vec2], fill: &str, style: &str) {
        let corners: Vec<String> = corners
            .iter()
            .map(|&corner| self.at(corner))
            .map(|[x, y]| format!("{x:.1},{y:.1}"))
            .collect();
        self.add(&format!(
            "<polygon points=\"{}\" fill=\"{fill}\" {style}/>",
            corners.join(" ")
        ));
    }

    /// Words beside a place, on white.
    pub(super) fn label(&mut self, place: Vec2, offset: [f64; 2], words: &str) {
        let [x, y] = self.at(place);
        // Near the right border there is room to the left alone.
        let room = self.corner[0] + self.size[0] - x - offset[0];
        let (x, anchor) = if 7.0 * words.chars().count() as f64 > room {
            (x - offset[0], "end")
        } else {
            (x + offset[0], "start")
        };
        self.words([x, y + offset[1]], anchor, "black", words);
    }

    /// Words in a corner, line by line from the top.
    pub(super) fn notes(&mut self, lines: &[(&str, String)]) {
        for (number, (color, words)) in lines.iter().enumerate() {
            let down = 18.0 + 16.0 * number as f64;
            let place = [self.corner[0] + 10.0, self.corner[1] + down];
            self.words(place, "start", color, words);
        }
    }

    /// Words over a white rim, so that lines behind do not touch them.
    fn words(&mut self, place: [f64; 2], anchor: &str, color: &str, words: &str) {
        let plain = text(place, anchor, words);
        for style in [
            "<text stroke=\"white\" stroke-width=\"4\" stroke-linejoin=\"round\"".to_owned(),
            format!("<text fill=\"{color}\""),
        ] {
            self.add(&plain.replacen("<text", &style, 1));
        }
    }

    /// The surfaces that a plane cuts, a path for each instance.
    pub(super) fn surfaces(&mut self, job: &Job, section: &Section, width: f64) {
        let [low, high] = self.window();
        let mut paths: BTreeMap<u32, String> = BTreeMap::new();
        for dash in section.outline(job.bvh, low, high, LINES) {
            let ([x, y], [x2, y2]) = (self.at(dash.at - dash.half), self.at(dash.at + dash.half));
            let path = paths.entry(dash.instance).or_default();
            // Writing to a string does not fail.
            let _ = write!(path, "M{x:.1} {y:.1}l{:.1} {:.1}", x2 - x, y2 - y);
        }
        for (id, path) in paths {
            let name = instance(job.bvh.scene(), InstanceId(id));
            self.add(&format!(
                "<path d=\"{path}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\" stroke-linecap=\"round\"><title>{}</title></path>",
                grey(id),
                escaped(&name)
            ));
        }
    }

    /// The panel, cut off at its borders.
    pub(super) fn finish(self) -> String {
        let ([left, top], [width, height]) = (self.corner, self.size);
        format!(
            "<svg x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" viewBox=\"{left:.1} {top:.1} {width:.1} {height:.1}\">\n\
             <rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"#fbfbfb\" stroke=\"#bbbbbb\"/>\n{}</svg>\n",
            self.content
        )
    }
}

/// Neighbours differ.
fn grey(id: u32) -> &'static str {
    ["#444444", "#888888", "#666666", "#aaaaaa"][id as usize % 4]
}
