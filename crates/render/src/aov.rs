//! Layers beside the picture, and those that tell what the ray through each pixel's centre hits.

use crate::{Camera, CameraFrame, Layer, SceneBvh, Settings, surface::surface_interaction};
use rayon::prelude::*;
use umbriel_kernels::{
    Hit, Ray,
    glam::{Vec2, Vec3},
};

/// What can be written beside the picture. Up to [`Aov::Material`] facts of what the ray through each pixel's centre hits: where it hits
/// nothing, all channels are 0, but depth is infinite. The others come from the samples of a [`PathFilm`](crate::PathFilm).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aov {
    /// Distance from the eye along the view direction, in metres.
    Depth,
    /// Shading normal in world space, turned towards the eye.
    Normal,
    /// Position in world space.
    Position,
    /// Base colour.
    Albedo,
    /// Number of the instance, counted from 1; 0 where nothing is hit.
    Instance,
    /// Number of the triangle or surface part, counted from 1.
    Primitive,
    /// Number of the material, counted from 1.
    Material,
    /// Light that was scattered by one surface at most: lights and sky as the eye sees them, and their light on what it sees. With
    /// [`Aov::Indirect`] it adds up to the picture. The names are those of Arnold, whose `direct` leaves out what is seen without a surface.
    Direct,
    /// Light that was scattered by two surfaces or more.
    Indirect,
    /// Samples in the pixel.
    SampleCount,
    /// Estimated variance of the pixel's luminance, the mean of its samples.
    Variance,
}

impl Aov {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::Depth,
        Self::Normal,
        Self::Position,
        Self::Albedo,
        Self::Instance,
        Self::Primitive,
        Self::Material,
        Self::Direct,
        Self::Indirect,
        Self::SampleCount,
        Self::Variance,
    ];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Depth => "depth",
            Self::Normal => "normal",
            Self::Position => "position",
            Self::Albedo => "albedo",
            Self::Instance => "instance",
            Self::Primitive => "primitive",
            Self::Material => "material",
            Self::Direct => "direct",
            Self::Indirect => "indirect",
            Self::SampleCount => "sample-count",
            Self::Variance => "variance",
        }
    }

    /// Names of its channels in an EXR file, in the usual compositing convention.
    pub fn channels(self) -> &'static [&'static str] {
        match self {
            Self::Depth => &["Z"],
            Self::Normal => &["N.X", "N.Y", "N.Z"],
            Self::Position => &["P.X", "P.Y", "P.Z"],
            Self::Albedo => &["albedo.R", "albedo.G", "albedo.B"],
            Self::Instance => &["instanceId"],
            Self::Primitive => &["primitiveId"],
            Self::Material => &["materialId"],
            Self::Direct => &["direct.R", "direct.G", "direct.B"],
            Self::Indirect => &["indirect.R", "indirect.G", "indirect.B"],
            Self::SampleCount => &["sampleCount"],
            Self::Variance => &["variance"],
        }
    }

    /// Whether it comes from the samples of a [`PathFilm`](crate::PathFilm), not from what is hit.
    pub fn is_of_samples(self) -> bool {
        matches!(
            self,
            Self::Direct | Self::Indirect | Self::SampleCount | Self::Variance
        )
    }
}

/// Rows that are traced at once; what is kept of them is the layers alone.
const BAND: u32 = 64;

/// Renders the layers for the whole picture; outside of the crop they are as where nothing is hit.
///
/// Layers that come from samples are left out: [`PathFilm::layers`](crate::PathFilm::layers) has them.
/// A partly transparent surface counts like an opaque one: the layers tell of the first thing that is met.
pub fn render_aovs(
    bvh: &SceneBvh,
    camera: &Camera,
    settings: &Settings,
    aovs: &[Aov],
) -> Vec<Layer> {
    let [width, height] = settings.resolution;
    let frame = camera.frame(settings.resolution);
    let of_hits: Vec<Aov> = aovs
        .iter()
        .copied()
        .filter(|a| !a.is_of_samples())
        .collect();
    let mut layers: Vec<Layer> = of_hits
        .iter()
        .map(|&aov| Layer {
            names: aov.channels(),
            channels: vec![Vec::with_capacity((width * height) as usize); aov.channels().len()],
        })
        .collect();
    for top in (0..height).step_by(BAND as usize) {
        let rows: Vec<Vec<(Ray, Option<Hit>)>> = (top..height.min(top + BAND))
            .into_par_iter()
            .map(|y| trace_row(bvh, &frame, settings, y))
            .collect();
        for (aov, Layer { channels, .. }) in of_hits.iter().zip(&mut layers) {
            let value = |(ray, hit): &(Ray, Option<Hit>)| {
                value(bvh, frame.forward, *aov, ray, hit.as_ref())
            };
            let values: Vec<[f32; 3]> = rows.par_iter().flatten_iter().map(value).collect();
            for (c, channel) in channels.iter_mut().enumerate() {
                channel.extend(values.iter().map(|v| v[c]));
            }
        }
    }
    layers
}

/// The rays through the centres of row `y`, with what they hit inside the crop.
fn trace_row(
    bvh: &SceneBvh,
    frame: &CameraFrame,
    settings: &Settings,
    y: u32,
) -> Vec<(Ray, Option<Hit>)> {
    let [width, height] = settings.resolution;
    let [x0, y0, x1, y1] = settings.crop.unwrap_or([0, 0, width, height]);
    let rays: Vec<Ray> = (0..width)
        .map(|x| frame.ray(Vec2::new(x as f32 + 0.5, y as f32 + 0.5)))
        .collect();
    let mut hits = vec![None; rays.len()];
    if (y0..y1).contains(&y) {
        let columns = x0 as usize..x1 as usize;
        bvh.intersect(&rays[columns.clone()], &mut hits[columns]);
    }
    rays.into_iter().zip(hits).collect()
}

fn value(bvh: &SceneBvh, forward: Vec3, aov: Aov, ray: &Ray, hit: Option<&Hit>) -> [f32; 3] {
    let Some(hit) = hit else {
        return if aov == Aov::Depth {
            [f32::INFINITY; 3]
        } else {
            [0.0; 3]
        };
    };
    let number = |n: u32| [(n + 1) as f32, 0.0, 0.0];
    let surface = || surface_interaction(bvh, ray, hit);
    match aov {
        Aov::Depth => [hit.t * ray.dir.dot(forward), 0.0, 0.0],
        Aov::Normal => surface().ns.to_array(),
        Aov::Position => surface().p.to_array(),
        Aov::Albedo => surface().bsdf.base_color.to_array(),
        Aov::Instance => number(hit.instance),
        Aov::Primitive => number(hit.primitive),
        Aov::Material => number(bvh.scene().instances[hit.instance as usize].material.0),
        Aov::Direct | Aov::Indirect | Aov::SampleCount | Aov::Variance => [0.0; 3],
    }
}
