//! `--show`: the pictures of shadow mapping, one, as layers, or all on one sheet.

use crate::{
    args::RenderArgs,
    errors::Failure,
    plan::{Plan, Target},
    shadow_maps::map_words,
    sheet::{Bitmap, Panel, compose, with_legend},
    values::Exposure,
};
use serde_json::{Value, json};
use umbriel_formats::render::{
    Camera, Cause, Control, Fact, Film, Image, Layer, Light, Method, SceneBvh, ShadowMaps, Show,
    ShowContext, Shown, Tonemap, auto_exposure, develop, render_with_maps, show,
};

/// What `--show` names.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ShowList {
    /// All pictures on one, with their numbers.
    Sheet,
    /// These, in this order.
    Pictures(Box<[Show]>),
}

/// What will be shown, and of which light.
#[derive(Clone, Debug)]
pub(crate) struct ShowPlan {
    list: ShowList,
    light: usize,
}

/// A film with the pictures that explain it.
pub(crate) struct ShownFilm {
    pub(crate) film: Film,
    /// What a PNG holds instead of the film.
    pub(crate) bitmap: Option<Bitmap>,
    /// What an EXR file holds beside the film.
    pub(crate) layers: Vec<Layer>,
    pub(crate) captions: Vec<Caption>,
}

impl From<Film> for ShownFilm {
    fn from(film: Film) -> Self {
        Self {
            film,
            bitmap: None,
            layers: Vec::new(),
            captions: Vec::new(),
        }
    }
}

/// A picture's numbers.
pub(crate) struct Caption {
    show: Show,
    facts: Vec<Fact>,
}

/// Panels next to each other on a sheet.
const COLUMNS: usize = 3;

/// Reads the argument of `--show`.
pub(crate) fn parse_show(text: &str) -> Result<ShowList, String> {
    if text == "sheet" {
        return Ok(ShowList::Sheet);
    }
    if text == "all" {
        return Ok(ShowList::Pictures(Show::ALL.into()));
    }
    let find = |name: &str| {
        let found = Show::ALL
            .into_iter()
            .find(|show| show.name() == name.trim());
        found.ok_or_else(|| {
            let names = Show::ALL.map(Show::name).join(", ");
            format!("no picture {name:?}; expected {names}, sheet, or all")
        })
    };
    let shows: Result<Vec<Show>, String> = text.split(',').map(find).collect();
    Ok(ShowList::Pictures(shows?.into()))
}

/// What the options ask for; refuses what does not fit the file or the scene.
pub(crate) fn choose_show(
    args: &RenderArgs,
    target: Target,
    plan: &Plan,
    lights: &[Light],
) -> Result<Option<ShowPlan>, Failure> {
    let Some(list) = &args.show else {
        return match &args.show_light {
            Some(_) => Err(Failure::usage("--show-light says nothing without --show")),
            None => Ok(None),
        };
    };
    let fits = match (target, list) {
        (Target::Exr, ShowList::Sheet) => Err("an EXR file holds layers; expected names, or all"),
        (Target::Png | Target::Stdout, ShowList::Pictures(shows)) if shows.len() != 1 => {
            Err("a PNG holds one picture; expected one name, or sheet")
        }
        _ if plan.settings.method != Method::ShadowMap => {
            Err("explains --method shadow-map; expected that method, or none")
        }
        _ if !plan.settings.shadows => {
            Err("explains shadows; expected none of --no-shadows and `shadows = false`")
        }
        _ => Ok(()),
    };
    fits.map_err(|why| Failure::usage(format!("--show: {why}")))?;
    Ok(Some(ShowPlan {
        list: list.clone(),
        light: find_light("--show-light", args.show_light.as_deref(), lights)?,
    }))
}

/// By name, or by number from 0 where no light has that name; by default the first directional light, or the first of all.
pub(crate) fn find_light(
    option: &str,
    wanted: Option<&str>,
    lights: &[Light],
) -> Result<usize, Failure> {
    if lights.is_empty() {
        return Err(Failure::usage("the scene has no light to show"));
    }
    let Some(wanted) = wanted else {
        let sun = |light: &Light| matches!(light, Light::Directional(_));
        return Ok(lights.iter().position(sun).unwrap_or(0));
    };
    named_light(option, wanted, lights)
}

/// The light that an option names, or numbers from 0 where no light has that name.
pub(crate) fn named_light(option: &str, wanted: &str, lights: &[Light]) -> Result<usize, Failure> {
    let by_name = lights.iter().position(|light| light.name() == wanted);
    let by_number = || wanted.parse().ok().filter(|&i: &usize| i < lights.len());
    by_name.or_else(by_number).ok_or_else(|| {
        let names = lights.iter().enumerate();
        let names: Vec<String> = names
            .map(|(i, light)| format!("{i} {:?}", light.name()))
            .collect();
        Failure::usage(format!(
            "{option}: no light {wanted:?}; expected one of {}",
            names.join(", ")
        ))
    })
}

impl ShowPlan {
    /// Whether the maps must know what wrote each texel.
    pub(crate) fn needs_ids(&self) -> bool {
        matches!(&self.list, ShowList::Pictures(shows) if shows.contains(&Show::Error))
    }
}

/// Draws the film and the pictures.
pub(crate) fn draw(
    show_plan: &ShowPlan,
    plan: &Plan,
    bvh: &SceneBvh,
    camera: &Camera,
    maps: &ShadowMaps,
    control: &Control,
) -> ShownFilm {
    let film = render_with_maps(bvh, camera, &plan.settings, Some(maps), control);
    let context = ShowContext {
        bvh,
        camera,
        settings: &plan.settings,
        maps,
        light: show_plan.light,
        exposure: match plan.exposure {
            Exposure::Stops(stops) => stops,
            Exposure::Auto => auto_exposure(&film.image),
        },
        tonemap: plan.tonemap,
    };
    let shows = match &show_plan.list {
        ShowList::Sheet => &Show::SHEET[..],
        ShowList::Pictures(shows) => &shows[..],
    };
    let shown = shows
        .iter()
        .map(|&kind| (kind, show(kind, &context, control)));
    let shown: Vec<(Show, Shown)> = shown.collect();
    let bitmap = match &show_plan.list {
        ShowList::Sheet => Some(sheet(&shown, &context)),
        ShowList::Pictures(_) => match &shown[..] {
            [(Show::Error, only)] => {
                let picture = bitmap(Show::Error, &only.image, &context);
                Some(error_panel(picture, &only.facts, &context))
            }
            [(kind, only)] => Some(bitmap(*kind, &only.image, &context)),
            _ => None,
        },
    };
    ShownFilm {
        film,
        bitmap,
        layers: shown
            .iter()
            .map(|(kind, shown)| layer(*kind, &shown.image))
            .collect(),
        captions: shown
            .into_iter()
            .map(|(show, shown)| Caption {
                show,
                facts: shown.facts,
            })
            .collect(),
    }
}

/// The picture of a light's errors with its legend and its numbers.
fn error_panel(picture: Bitmap, facts: &[Fact], context: &ShowContext) -> Bitmap {
    let name = context.bvh.scene().lights[context.light].name();
    let legend: Vec<(u32, String)> = Cause::ALL
        .map(|cause| (cause.color(), cause.meaning().to_owned()))
        .into();
    let panel = Panel {
        title: format!("error: light {name:?}"),
        caption: words(facts),
        picture: with_legend(picture, &legend),
    };
    compose(&[panel], 1)
}

/// The pixels as a screen shows them.
fn bitmap(show: Show, image: &Image, context: &ShowContext) -> Bitmap {
    let (exposure, tonemap) = match show.is_radiance() {
        true => (context.exposure, context.tonemap),
        false => (0.0, Tonemap::Linear),
    };
    Bitmap {
        width: image.width,
        height: image.height,
        pixels: develop(image, exposure, tonemap),
    }
}

fn layer(show: Show, image: &Image) -> Layer {
    let channel = |c: usize| image.pixels.iter().map(|pixel| pixel[c]).collect();
    Layer {
        names: show.channels(),
        channels: (0..3).map(channel).collect(),
    }
}

fn sheet(shown: &[(Show, Shown)], context: &ShowContext) -> Bitmap {
    let light = &context.bvh.scene().lights[context.light];
    let map = map_words(light, &context.maps.of(context.light).settings);
    let panel = |(show, shown): &(Show, Shown)| {
        let about = match show {
            Show::Lit => String::new(),
            _ => format!("; light {:?}: {map}", light.name()),
        };
        Panel {
            title: format!("{}: {}", show.name(), meaning(*show)),
            caption: words(&shown.facts) + &about,
            picture: bitmap(*show, &shown.image, context),
        }
    };
    let panels: Vec<Panel> = shown.iter().map(panel).collect();
    compose(&panels, COLUMNS)
}

fn meaning(show: Show) -> &'static str {
    match show {
        Show::Lit => "without shadows",
        Show::Shadowed => "lit where the map says so",
        Show::LightView => "the scene from the light",
        Show::LightDepth => "the depth image",
        Show::Compare => "green where it matches the map",
        Show::MapTexels => "each texel a colour",
        Show::Error => "where the map is wrong, and why",
    }
}

/// `nearest 2.31 m, furthest 40.2 m`.
fn words(facts: &[Fact]) -> String {
    let fact = |fact: &Fact| {
        let space = if fact.unit.is_empty() || fact.unit == "°" {
            ""
        } else {
            " "
        };
        format!("{} {}{space}{}", fact.name, number(fact.value), fact.unit)
    };
    facts.iter().map(fact).collect::<Vec<_>>().join(", ")
}

/// Three digits or more; whole numbers without a point.
fn number(value: f64) -> String {
    match value.abs() {
        size if size >= 100.0 || value.fract() == 0.0 => format!("{value:.0}"),
        size if size >= 10.0 => format!("{value:.1}"),
        size if size >= 1.0 => format!("{value:.2}"),
        _ => format!("{value:.3}"),
    }
}

impl Caption {
    /// For people.
    pub(crate) fn line(&self) -> String {
        format!("{}: {}", self.show.name(), words(&self.facts))
    }

    /// For programs.
    pub(crate) fn to_json(&self) -> Value {
        let facts = self.facts.iter();
        let facts: Vec<Value> = facts
            .map(|fact| json!({ "name": fact.name, "value": fact.value, "unit": fact.unit }))
            .collect();
        json!({ "picture": self.show.name(), "facts": facts })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_read_in_their_order() {
        assert_eq!(parse_show("sheet"), Ok(ShowList::Sheet));
        let pair = ShowList::Pictures([Show::Compare, Show::Lit].into());
        assert_eq!(parse_show("compare, lit"), Ok(pair));
        let error = parse_show("compar").unwrap_err();
        assert!(
            error.starts_with("no picture \"compar\"; expected lit, light-view"),
            "{error}"
        );
    }

    #[test]
    fn numbers_have_three_digits() {
        assert_eq!(
            ["0", "0.123", "1.23", "12.3", "1235", "2048"],
            [0.0, 0.1234, 1.234, 12.34, 1234.9, 2048.0].map(number)
        );
    }
}
