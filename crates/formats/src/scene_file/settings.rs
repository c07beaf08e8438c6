//! `[render]`: what a scene file says of how to draw it.

use super::document::{GlassShadowsName, MethodName, RenderTable, TonemapName};
use super::include::Part;
use super::source::{Fault, Source};
use crate::{ErrorKind, FileError};
use umbriel_render::{GlassShadows, Method, Sampling, ShadowMapSettings, Tonemap};

/// What `[render]` of a scene file may say; the command line goes first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneSettings {
    /// The algorithm.
    pub method: Option<Method>,
    /// Width and height in pixels.
    pub resolution: Option<[u32; 2]>,
    /// Where the eye rays go.
    pub sampling: Option<Sampling>,
    /// Recursion limit.
    pub depth: Option<u32>,
    /// Least weight of a ray.
    pub min_weight: Option<f32>,
    /// Whether lights cast shadows.
    pub shadows: Option<bool>,
    /// What a shadow ray does at glass.
    pub glass_shadows: Option<GlassShadows>,
    /// How the shadow maps are made and read: one entry for each light of the scene, in its order.
    pub shadow_maps: Vec<ShadowMapSettings>,
    /// Seed of the sample positions.
    pub seed: Option<u64>,
    /// Exposure in stops.
    pub exposure: Option<f32>,
    /// Tone mapping.
    pub tonemap: Option<Tonemap>,
}

/// Most mirrored or refracted rays one after the other: between two mirrors they would never end.
const MAX_DEPTH: u32 = 64;
/// Longest side of a picture, in pixels.
pub const MAX_SIDE: u32 = 65_535;
/// Most pixels of a picture: a film of 4 GiB.
pub const MAX_PIXELS: u32 = 1 << 28;

/// Merges the `[render]` tables; what an including file says goes before what it includes.
pub(super) fn read_settings(parts: &[Part]) -> Result<SceneSettings, FileError> {
    let mut merged = SceneSettings::default();
    for part in parts {
        let one = read_table(&part.document.render, &part.source)
            .map_err(|fault| part.source.error(fault))?;
        merged = SceneSettings {
            method: merged.method.or(one.method),
            resolution: merged.resolution.or(one.resolution),
            sampling: merged.sampling.or(one.sampling),
            depth: merged.depth.or(one.depth),
            min_weight: merged.min_weight.or(one.min_weight),
            shadows: merged.shadows.or(one.shadows),
            glass_shadows: merged.glass_shadows.or(one.glass_shadows),
            shadow_maps: Vec::new(),
            seed: merged.seed.or(one.seed),
            exposure: merged.exposure.or(one.exposure),
            tonemap: merged.tonemap.or(one.tonemap),
        };
    }
    Ok(merged)
}

fn read_table(table: &RenderTable, source: &Source) -> Result<SceneSettings, Fault> {
    let at = |field: &str| source.span_of("render", None, &[field]);
    if let Some(stops) = table.exposure
        && !(-100.0..=100.0).contains(&stops)
    {
        return Err(Fault::new(
            at("exposure"),
            format!("`exposure` is {stops}; must be from -100 to 100 stops"),
        ));
    }
    if let Some(depth) = table.depth
        && depth > MAX_DEPTH
    {
        let message = format!("`depth` is {depth}; must be from 0 to {MAX_DEPTH}");
        return Err(Fault::new(at("depth"), message));
    }
    if let Some(weight) = table.min_weight
        && !(0.0..=1.0).contains(&weight)
    {
        let message = format!("`min_weight` is {weight}; must be from 0 to 1");
        return Err(Fault::new(at("min_weight"), message));
    }
    Ok(SceneSettings {
        method: table.method.map(|name| match name {
            MethodName::RayCast => Method::RayCast,
            MethodName::Whitted => Method::Whitted,
            MethodName::Path => Method::Path,
            MethodName::Distributed => Method::Distributed,
            MethodName::ShadowMap => Method::ShadowMap,
        }),
        resolution: resolution(table, at("resolution"))?,
        sampling: sampling(table, &at)?,
        depth: table.depth,
        min_weight: table.min_weight,
        shadows: table.shadows,
        glass_shadows: table.glass_shadows.map(|name| match name {
            GlassShadowsName::Filtered => GlassShadows::Filtered,
            GlassShadowsName::Opaque => GlassShadows::Opaque,
        }),
        shadow_maps: Vec::new(),
        seed: table.seed,
        exposure: table.exposure,
        tonemap: table.tonemap.map(|name| match name {
            TonemapName::Neutral => Tonemap::Neutral,
            TonemapName::Linear => Tonemap::Linear,
            TonemapName::Aces => Tonemap::Aces,
            TonemapName::Agx => Tonemap::Agx,
        }),
    })
}

fn resolution(
    table: &RenderTable,
    span: std::ops::Range<usize>,
) -> Result<Option<[u32; 2]>, Fault> {
    let Some([width, height]) = table.resolution.map(|r| r.0) else {
        return Ok(None);
    };
    if width < 1 || height < 1 {
        let message = format!("`resolution` is [{width}, {height}]; both sides must be at least 1");
        return Err(Fault::new(span, message));
    }
    let longest = i64::from(MAX_SIDE);
    if width > longest || height > longest || width * height > i64::from(MAX_PIXELS) {
        let gib = width as f64 * height as f64 * 16.0 / f64::from(1 << 30);
        return Err(Fault {
            kind: ErrorKind::Limit,
            span,
            message: format!(
                "`resolution` of {width}x{height} takes {gib:.1} GiB of memory; \
                 expected at most {MAX_SIDE} pixels a side and 4 GiB"
            ),
        });
    }
    Ok(Some([width as u32, height as u32]))
}

fn sampling(
    table: &RenderTable,
    at: &impl Fn(&str) -> std::ops::Range<usize>,
) -> Result<Option<Sampling>, Fault> {
    match (table.spp, &table.adaptive) {
        (Some(_), Some(_)) => {
            let message = "`spp` and `adaptive` exclude each other; expected one of them";
            Err(Fault::new(at("adaptive"), message))
        }
        (Some(spp), None) if !(1..=65_536).contains(&spp) => Err(Fault::new(
            at("spp"),
            format!("`spp` is {spp}; must be from 1 to 65536"),
        )),
        (Some(spp), None) => Ok(Some(Sampling::Fixed { spp })),
        (None, Some(table)) => {
            let (threshold, levels) = (table.threshold, table.levels);
            if !(0.0..=1.0).contains(&threshold) {
                let message = format!("`threshold` is {threshold}; must be from 0 to 1");
                return Err(Fault::new(at("adaptive"), message));
            }
            if !(1..=6).contains(&levels) {
                let message = format!("`levels` is {levels}; must be from 1 to 6");
                return Err(Fault::new(at("adaptive"), message));
            }
            Ok(Some(Sampling::Adaptive { threshold, levels }))
        }
        (None, None) => Ok(None),
    }
}
