//! The error over the texels, drawn as SVG: a panel for each light.

use super::{
    measure::{Job, TunedLight},
    words::{cameras, settings},
};
use crate::{
    compare::percent,
    svg::{document, escaped, text},
};
use std::fmt::Write;

const WIDTH: f64 = 960.0;
const PANEL: f64 = 430.0;
/// Left, top, right and bottom of the area of the curve in its panel.
const AREA: [f64; 4] = [70.0, 60.0, 690.0, 370.0];
/// Colours of Okabe & Ito, told apart with every kind of colour vision.
const COLORS: [&str; 5] = ["#e69f00", "#56b4e9", "#009e73", "#cc79a7", "#d55e00"];

/// The drawing.
pub(super) fn draw(job: &Job, tuned: &[TunedLight]) -> String {
    let height = PANEL * tuned.len() as f64;
    let mut panels = String::new();
    for (number, light) in tuned.iter().enumerate() {
        // Writing to a string does not fail.
        let _ = writeln!(
            panels,
            "<g transform=\"translate(0 {})\">\n{}</g>",
            PANEL * number as f64,
            panel(job, light)
        );
    }
    document([WIDTH, height], &panels)
}

/// A place in the plot: texels, and wrong pixels in percent.
type Place = [f64; 2];

/// What is marked beside the front: a name, a colour, whether it was tuned, a place.
struct Mark {
    name: String,
    color: &'static str,
    is_tuned: bool,
    place: Place,
}

fn marks(tuned: &TunedLight) -> Vec<Mark> {
    let mut marks = vec![Mark {
        name: "as set".to_owned(),
        color: "black",
        is_tuned: false,
        place: [tuned.own.texels as f64, tuned.own.score.percent()],
    }];
    for (engine, color) in tuned.engines.iter().zip(COLORS.into_iter().cycle()) {
        let title = engine.dialect.title;
        let default = &engine.default;
        marks.push(Mark {
            name: format!("{title}, not set"),
            color,
            is_tuned: false,
            place: [default.texels as f64, default.score.percent()],
        });
        if let Some((_, found)) = &engine.best {
            marks.push(Mark {
                name: format!("{title}, tuned"),
                color,
                is_tuned: true,
                place: [found.texels as f64, found.score.percent()],
            });
        }
    }
    marks
}

fn panel(job: &Job, tuned: &TunedLight) -> String {
    let light = &job.bvh.scene().lights[tuned.light];
    let wrong: Vec<Place> = tuned
        .front
        .iter()
        .map(|(found, _)| [found.texels as f64, found.score.percent()])
        .collect();
    let unmendable: Vec<Place> = tuned
        .front
        .iter()
        .map(|(found, mends)| {
            let share = mends.texels as f64 / found.score.asked.max(1) as f64;
            [found.texels as f64, 100.0 * share]
        })
        .collect();
    let marks = marks(tuned);
    let all = wrong.iter().chain(&unmendable);
    let axes = Axes::of(all.copied().chain(marks.iter().map(|mark| mark.place)));
    let mut lines = titles(job, tuned, light.name());
    lines.extend(axes.grid());
    lines.push(axes.curve(&unmendable, "#888888", "5 4"));
    lines.push(axes.curve(&wrong, "#0072b2", "none"));
    for (place, (found, _)) in wrong.iter().zip(&tuned.front) {
        let [x, y] = axes.at(place);
        let title = format!("{}: {}", percent(place[1]), settings(light, &found.map));
        lines.push(format!(
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"#0072b2\"><title>{}</title></circle>",
            escaped(&title)
        ));
    }
    lines.extend(marks.iter().map(|mark| axes.mark(mark)));
    lines.extend(legend(&marks));
    lines.join("\n") + "\n"
}

/// The panel's two lines of words.
fn titles(job: &Job, tuned: &TunedLight, light: &str) -> Vec<String> {
    let title = format!("Light {light:?}: wrong pixels over texels");
    let about = format!(
        "{}, {}, {} settings tried",
        job.args.truth.scene.display(),
        cameras(job.args.cameras),
        tuned.tried
    );
    let bold = "<text font-weight=\"bold\" font-size=\"15\"";
    vec![
        text([AREA[0], 24.0], "start", &title).replace("<text", bold),
        text([AREA[0], 44.0], "start", &about),
    ]
}

/// Both axes are logarithmic: exponents of 2, and logarithms of the percentages, at the area's borders.
struct Axes {
    x: [f64; 2],
    y: [f64; 2],
}

/// Nothing wrong at all is drawn as this many percent.
const LEAST_PERCENT: f64 = 1e-3;

/// Percentages that have a line, from the least up.
fn ticks() -> impl Iterator<Item = f64> {
    let powers = (-3..=2).map(|power| 10_f64.powi(power));
    let all = powers.flat_map(|power| [1.0, 2.0, 5.0].map(|digit| digit * power));
    all.filter(|tick| *tick <= 100.0)
}

impl Axes {
    fn of(places: impl Iterator<Item = Place>) -> Self {
        let mut x = [f64::INFINITY, 0.0_f64];
        let mut y = [f64::INFINITY, 0.0_f64];
        for [texels, percent] in places {
            let texels = texels.max(1.0).log2();
            let percent = percent.max(LEAST_PERCENT);
            x = [x[0].min(texels), x[1].max(texels)];
            y = [y[0].min(percent), y[1].max(percent)];
        }
        let below = ticks().filter(|tick| *tick < y[0]).last();
        let above = ticks().find(|tick| *tick > y[1]);
        Self {
            x: [(x[0] - 0.5).floor(), (x[1] + 0.5).ceil()],
            y: [below.unwrap_or(0.5 * LEAST_PERCENT), above.unwrap_or(120.0)].map(f64::log10),
        }
    }

    fn at(&self, &[texels, percent]: &Place) -> [f64; 2] {
        let part = |value: f64, [from, to]: [f64; 2]| (value - from) / (to - from);
        let x = part(texels.max(1.0).log2(), self.x);
        let y = part(percent.max(LEAST_PERCENT).log10(), self.y);
        [
            AREA[0] + x * (AREA[2] - AREA[0]),
            AREA[3] - y * (AREA[3] - AREA[1]),
        ]
    }

    /// Lines at powers of four of the texels and of ten of the percentages, with their numbers.
    fn grid(&self) -> Vec<String> {
        let mut lines = Vec::new();
        let line = |[x1, y1]: [f64; 2], [x2, y2]: [f64; 2]| {
            format!(
                "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"#dddddd\"/>"
            )
        };
        for power in self.x[0] as i32..=self.x[1] as i32 {
            if power % 2 == 0 {
                let [x, _] = self.at(&[2_f64.powi(power), 1.0]);
                lines.push(line([x, AREA[1]], [x, AREA[3]]));
                let label = match power {
                    20.. => format!("{}M", 1_u64 << (power - 20)),
                    10.. => format!("{}k", 1 << (power - 10)),
                    _ => format!("{}", 1 << power.max(0)),
                };
                lines.push(text([x, AREA[3] + 18.0], "middle", &label));
            }
        }
        let [least, most] = self.y.map(|y| 10_f64.powf(y));
        for tick in ticks().filter(|tick| (least..=1.0001 * most).contains(tick)) {
            let [_, y] = self.at(&[1.0, tick]);
            lines.push(line([AREA[0], y], [AREA[2], y]));
            let digits = format!("{tick:.3}");
            let label = digits.trim_end_matches('0').trim_end_matches('.');
            lines.push(text([AREA[0] - 8.0, y + 4.0], "end", &format!("{label} %")));
        }
        let middle = 0.5 * (AREA[0] + AREA[2]);
        lines.push(text(
            [middle, AREA[3] + 36.0],
            "middle",
            "texels of all images of the light",
        ));
        lines
    }

    fn curve(&self, places: &[Place], color: &str, dashes: &str) -> String {
        let points: Vec<String> = places
            .iter()
            .map(|place| self.at(place))
            .map(|[x, y]| format!("{x:.1},{y:.1}"))
            .collect();
        format!(
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\" stroke-dasharray=\"{dashes}\"/>",
            points.join(" ")
        )
    }

    fn mark(&self, mark: &Mark) -> String {
        let title = format!("{}: {}", mark.name, percent(mark.place[1]));
        sign(self.at(&mark.place), mark.color, mark.is_tuned, &title)
    }
}

/// A diamond, filled for what was tuned.
fn sign([x, y]: [f64; 2], color: &str, is_tuned: bool, title: &str) -> String {
    let fill = if is_tuned { color } else { "white" };
    format!(
        "<path d=\"M{:.1} {y:.1}l6 -6l6 6l-6 6z\" fill=\"{fill}\" stroke=\"{color}\" stroke-width=\"2\"><title>{}</title></path>",
        x - 6.0,
        escaped(title)
    )
}

/// What the signs mean, to the right of the area.
fn legend(marks: &[Mark]) -> Vec<String> {
    let left = AREA[2] + 20.0;
    let mut lines = Vec::new();
    let curves = [
        ("#0072b2", "none", "best for the texels"),
        ("#888888", "5 4", "of which no bias mends"),
    ];
    let mut y = AREA[1] + 14.0;
    for (color, dashes, words) in curves {
        lines.push(format!(
            "<line x1=\"{left}\" y1=\"{y}\" x2=\"{}\" y2=\"{y}\" stroke=\"{color}\" stroke-width=\"2\" stroke-dasharray=\"{dashes}\"/>",
            left + 22.0
        ));
        lines.push(text([left + 30.0, y + 4.0], "start", words));
        y += 17.0;
    }
    for mark in marks {
        lines.push(sign(
            [left + 11.0, y],
            mark.color,
            mark.is_tuned,
            &mark.name,
        ));
        let words = format!("{}: {}", mark.name, percent(mark.place[1]));
        lines.push(text([left + 30.0, y + 4.0], "start", &words));
        y += 17.0;
    }
    lines
}
