//! The pictures of shadow mapping: what the light sees, what the map holds, what the comparison says.

mod error_shown;
mod light_pictures;
mod map_pictures;
mod seen;

use crate::{
    Camera, Control, Image, Method, SceneBvh, Settings, ShadowMaps, Tonemap, develop,
    render::render_with_maps, srgb::srgb_to_linear,
};
use error_shown::error;
use light_pictures::{light_depth, light_view};
use map_pictures::{compare, map_texels};
use seen::see;

/// A picture that explains shadow mapping.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Show {
    /// The picture without shadows.
    Lit,
    /// The picture with them.
    Shadowed,
    /// The scene as the light sees it; the faces of a map of several are side by side.
    LightView,
    /// The depth images: near is bright, far is dark, where nothing is there is blue.
    LightDepth,
    /// Green where a point's distance from the light matches the map, the picture without shadows elsewhere.
    Compare,
    /// Each texel of the map in a colour of its own, on the surfaces, or each square of as many texels as take to be seen; grey where no map is.
    MapTexels,
    /// Where the map differs from exact rays, in the colours of the [causes](crate::Cause); asks as many rays as the truth takes.
    Error,
}

/// A picture and its numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// Linear values. Those of [`Show::Lit`], [`Show::Shadowed`] and [`Show::LightView`] are radiance, the others are to be shown as
    /// they are: exposure 0, [`Tonemap::Linear`].
    pub image: Image,
    /// What a caption tells.
    pub facts: Vec<Fact>,
}

/// A number of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fact {
    /// What it is, in words.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// Its unit; empty for plain numbers.
    pub unit: &'static str,
}

/// What the pictures are made of, and for which light.
#[derive(Clone, Copy, Debug)]
pub struct ShowContext<'a> {
    /// The scene.
    pub bvh: &'a SceneBvh<'a>,
    /// The eye.
    pub camera: &'a Camera,
    /// Resolution, sampling and glass; the method is always [`Method::ShadowMap`].
    pub settings: &'a Settings,
    /// The maps of all lights; with ids for [`Show::Error`].
    pub maps: &'a ShadowMaps,
    /// Position in [`Scene::lights`](crate::Scene::lights) of the light that [`Show::LightView`] and those after it are about; it must exist.
    pub light: usize,
    /// Exposure in stops and tone curve of [`Show::Compare`]'s ground.
    pub exposure: f32,
    /// See `exposure`.
    pub tonemap: Tonemap,
}

impl Show {
    /// All of them, in the order of the lecture.
    pub const ALL: [Self; 7] = [
        Self::Lit,
        Self::LightView,
        Self::LightDepth,
        Self::Compare,
        Self::MapTexels,
        Self::Shadowed,
        Self::Error,
    ];

    /// Those that one sheet shows: what the method does, step by step.
    pub const SHEET: [Self; 6] = [
        Self::Lit,
        Self::LightView,
        Self::LightDepth,
        Self::Compare,
        Self::MapTexels,
        Self::Shadowed,
    ];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lit => "lit",
            Self::Shadowed => "shadowed",
            Self::LightView => "light-view",
            Self::LightDepth => "light-depth",
            Self::Compare => "compare",
            Self::MapTexels => "map-texels",
            Self::Error => "error",
        }
    }

    /// Names of its channels in an EXR file.
    pub fn channels(self) -> &'static [&'static str] {
        match self {
            Self::Lit => &["lit.R", "lit.G", "lit.B"],
            Self::Shadowed => &["shadowed.R", "shadowed.G", "shadowed.B"],
            Self::LightView => &["light-view.R", "light-view.G", "light-view.B"],
            Self::LightDepth => &["light-depth.R", "light-depth.G", "light-depth.B"],
            Self::Compare => &["compare.R", "compare.G", "compare.B"],
            Self::MapTexels => &["map-texels.R", "map-texels.G", "map-texels.B"],
            Self::Error => &["error.R", "error.G", "error.B"],
        }
    }

    /// Whether its values are radiance, which wants an exposure and a tone curve.
    pub fn is_radiance(self) -> bool {
        matches!(self, Self::Lit | Self::Shadowed | Self::LightView)
    }
}

/// Makes one of the pictures, as large as the settings say.
///
/// Pictures of a light fit its depth images into that size; what is left over has alpha 0.
pub fn show(show: Show, context: &ShowContext, control: &Control) -> Shown {
    match show {
        Show::Lit => lit(context, control),
        Show::Shadowed => shadowed(context, control),
        Show::LightView => light_view(context, control),
        Show::LightDepth => light_depth(context),
        Show::Compare => compare(context, &as_shown(&lit(context, control).image, context)),
        Show::MapTexels => map_texels(context),
        Show::Error => {
            let ground = as_shown(&shadowed(context, control).image, context);
            error(context, &ground, control)
        }
    }
}

fn lit(context: &ShowContext, control: &Control) -> Shown {
    let settings = by_maps(context, false);
    let film = render_with_maps(context.bvh, context.camera, &settings, None, control);
    let points = see(context);
    let hits = points.iter().flatten().count();
    Shown {
        image: film.image,
        facts: vec![
            Fact::plain("lights", context.bvh.scene().lights.len() as f64),
            Fact::percent("pixels that see a surface", hits, points.len()),
        ],
    }
}

fn shadowed(context: &ShowContext, control: &Control) -> Shown {
    let (settings, maps) = (by_maps(context, true), Some(context.maps));
    let film = render_with_maps(context.bvh, context.camera, &settings, maps, control);
    let map = context.maps.of(context.light);
    let towards: Vec<f32> = see(context)
        .iter()
        .flatten()
        .filter(|point| point.cos > 0.0)
        .map(|point| map.fraction(point.p, point.ng))
        .collect();
    let count = |is_such: fn(f32) -> bool| towards.iter().filter(|&&f| is_such(f)).count();
    Shown {
        image: film.image,
        facts: vec![
            Fact::plain("texels a side", f64::from(map.settings.resolution)),
            Fact::percent(
                "in shadow, of what faces the light",
                count(|f| f == 0.0),
                towards.len(),
            ),
            Fact::percent("in penumbra", count(|f| f > 0.0 && f < 1.0), towards.len()),
        ],
    }
}

fn by_maps(context: &ShowContext, shadows: bool) -> Settings {
    Settings {
        method: Method::ShadowMap,
        shadows,
        ..context.settings.clone()
    }
}

/// Radiance as a screen shows it, in linear values.
fn as_shown(image: &Image, context: &ShowContext) -> Image {
    let bytes = develop(image, context.exposure, context.tonemap);
    let linear = |[r, g, b, a]: [u8; 4]| {
        let [r, g, b] = [r, g, b].map(srgb_to_linear);
        [r, g, b, f32::from(a) / 255.0]
    };
    Image {
        pixels: bytes.into_iter().map(linear).collect(),
        ..*image
    }
}

impl Fact {
    fn new(name: &'static str, value: f64, unit: &'static str) -> Self {
        Self { name, value, unit }
    }

    fn plain(name: &'static str, value: f64) -> Self {
        Self::new(name, value, "")
    }

    /// A share of a whole, 0 of nothing.
    fn percent(name: &'static str, part: usize, whole: usize) -> Self {
        Self::new(name, 100.0 * part as f64 / whole.max(1) as f64, "%")
    }
}
