//! `shadow_map` tables: what a scene file says of shadow maps, for all lights and for one.

use super::include::Part;
use super::source::{Fault, Source};
use crate::{ErrorKind, FileError};
use schemars::JsonSchema;
use serde::Deserialize;
use std::ops::Range;
use umbriel_render::{Bias, Light, ShadowFilter, ShadowMapSettings};

/// How a light's shadow map is made and read, under `method = "shadow-map"`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub(super) struct ShadowMapTable {
    /// Texels a side, from 1 to 16384; 2048 by default.
    pub resolution: Option<i64>,
    /// What keeps a surface from shadowing itself: none, constant:AMOUNT, slope-scaled:AMOUNT, normal-offset:AMOUNT,
    /// receiver-plane:AMOUNT or adaptive (default); AMOUNT in texels, or in metres as in 0.02m. Or a sum as engines have it, such as
    /// constant:0.02m+normal-whole:2.
    pub bias: Option<String>,
    /// How texels become one shadow: hard (default), pcf:SIDE, bilinear:SIDE, poisson:TAPS:RADIUS, vogel:TAPS:RADIUS,
    /// pcss:TAPS, vsm:RADIUS, evsm:RADIUS or msm:RADIUS; RADIUS in texels.
    pub filter: Option<String>,
    /// Maps of a directional light one behind the other, from 1 (default) to 8.
    pub cascades: Option<i64>,
    /// Where cascades meet, from 0 (even distances) to 1 (logarithmic ones); 0.75 by default.
    pub cascade_split: Option<f32>,
}

/// What somebody says of shadow maps; the rest stays as it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShadowMapOverrides {
    /// Texels a side.
    pub resolution: Option<u32>,
    /// What keeps a surface from shadowing itself.
    pub bias: Option<Bias>,
    /// How texels become one shadow.
    pub filter: Option<ShadowFilter>,
    /// Depth images of a directional light.
    pub cascades: Option<u32>,
    /// Weight of logarithmic distances between them, from 0 to 1.
    pub cascade_split: Option<f32>,
}

impl ShadowMapOverrides {
    /// The settings of `light`, which has the size, with what is said here in place of `base`'s.
    pub fn apply(&self, light: &Light, base: ShadowMapSettings) -> ShadowMapSettings {
        ShadowMapSettings {
            resolution: self.resolution.unwrap_or(base.resolution),
            bias: self.bias.unwrap_or(base.bias),
            filter: self.filter.unwrap_or(base.filter),
            cascades: self.cascades.unwrap_or(base.cascades),
            cascade_split: self.cascade_split.unwrap_or(base.cascade_split),
            light_size: light.size(),
        }
    }

    fn or(self, other: Self) -> Self {
        Self {
            resolution: self.resolution.or(other.resolution),
            bias: self.bias.or(other.bias),
            filter: self.filter.or(other.filter),
            cascades: self.cascades.or(other.cascades),
            cascade_split: self.cascade_split.or(other.cascade_split),
        }
    }
}

/// Refuses a map that is too large, in words that begin with its memory.
///
/// # Errors
/// The words, when `side` is over [`ShadowMapSettings::MAX_RESOLUTION`].
pub fn check_shadow_map_side(side: u64) -> Result<u32, String> {
    let most = ShadowMapSettings::MAX_RESOLUTION;
    match u32::try_from(side) {
        Ok(small) if small <= most => Ok(small),
        _ => {
            let gib = 4.0 * (side as f64).powi(2) / f64::from(1 << 30);
            Err(format!(
                "a shadow map of {side}x{side} takes {gib:.1} GiB of memory; expected at most {most} texels a side"
            ))
        }
    }
}

/// All `shadow_map` tables of a scene.
pub(super) struct ShadowMapTables {
    all: ShadowMapOverrides,
    /// One for each light of a table, in order.
    own: Vec<ShadowMapOverrides>,
}

impl ShadowMapTables {
    /// What an including file says goes before what it includes.
    pub(super) fn read(parts: &[Part]) -> Result<Self, FileError> {
        let mut all = ShadowMapOverrides::default();
        let mut own = Vec::new();
        for part in parts {
            let (document, source) = (&part.document, &part.source);
            let read = |table: &Option<ShadowMapTable>, name, index| match table {
                Some(table) => read_table(table, source, name, index).map_err(|f| source.error(f)),
                None => Ok(ShadowMapOverrides::default()),
            };
            all = all.or(read(&document.render.shadow_map, "render", None)?);
            for (i, light) in document.point_light.iter().enumerate() {
                own.push(read(&light.shadow_map, "point_light", Some(i))?);
            }
            for (i, light) in document.spot_light.iter().enumerate() {
                own.push(read(&light.shadow_map, "spot_light", Some(i))?);
            }
            for (i, light) in document.directional_light.iter().enumerate() {
                own.push(read(&light.shadow_map, "directional_light", Some(i))?);
            }
        }
        Ok(Self { all, own })
    }

    /// The settings of each of the scene's lights: those of tables come first, in order; lights of models and the
    /// daylight follow.
    pub(super) fn settings(&self, lights: &[Light]) -> Vec<ShadowMapSettings> {
        let own = self.own.iter().map(|own| own.or(self.all));
        let said = own.chain(std::iter::repeat(self.all));
        let settings = |(light, said): (&Light, ShadowMapOverrides)| {
            said.apply(light, ShadowMapSettings::default())
        };
        lights.iter().zip(said).map(settings).collect()
    }
}

fn read_table(
    table: &ShadowMapTable,
    source: &Source,
    owner: &str,
    index: Option<usize>,
) -> Result<ShadowMapOverrides, Fault> {
    let at = |field: &str| source.span_within(owner, index, "shadow_map", field);
    if matches!(owner, "point_light" | "spot_light") {
        let given = [
            ("cascades", table.cascades.is_some()),
            ("cascade_split", table.cascade_split.is_some()),
        ];
        if let Some((field, _)) = given.iter().find(|(_, is_given)| *is_given) {
            let message = format!("`{field}` belongs to directional lights; expected none here");
            return Err(Fault::new(at(field), message));
        }
    }
    Ok(ShadowMapOverrides {
        resolution: side(table.resolution, at("resolution"))?,
        bias: text(&table.bias, "bias", at("bias"))?,
        filter: text(&table.filter, "filter", at("filter"))?,
        cascades: cascades(table.cascades, at("cascades"))?,
        cascade_split: split(table.cascade_split, at("cascade_split"))?,
    })
}

fn side(side: Option<i64>, span: Range<usize>) -> Result<Option<u32>, Fault> {
    let most = ShadowMapSettings::MAX_RESOLUTION;
    match side {
        None => Ok(None),
        Some(side) if side < 1 => {
            let message = format!("`resolution` is {side}; must be from 1 to {most}");
            Err(Fault::new(span, message))
        }
        Some(side) => check_shadow_map_side(side.unsigned_abs())
            .map(Some)
            .map_err(|message| Fault {
                kind: ErrorKind::Limit,
                span,
                message,
            }),
    }
}

fn cascades(cascades: Option<i64>, span: Range<usize>) -> Result<Option<u32>, Fault> {
    let most = ShadowMapSettings::MAX_CASCADES;
    match cascades.map(u32::try_from) {
        None => Ok(None),
        Some(Ok(n)) if (1..=most).contains(&n) => Ok(Some(n)),
        _ => {
            let found = cascades.unwrap_or_default();
            let message = format!("`cascades` is {found}; must be from 1 to {most}");
            Err(Fault::new(span, message))
        }
    }
}

fn split(split: Option<f32>, span: Range<usize>) -> Result<Option<f32>, Fault> {
    match split {
        Some(split) if !(0.0..=1.0).contains(&split) => {
            let message = format!("`cascade_split` is {split}; must be from 0 to 1");
            Err(Fault::new(span, message))
        }
        _ => Ok(split),
    }
}

fn text<T: std::str::FromStr<Err = umbriel_render::ShadowTextError>>(
    text: &Option<String>,
    field: &str,
    span: Range<usize>,
) -> Result<Option<T>, Fault> {
    let parsed = text.as_deref().map(str::parse).transpose();
    parsed.map_err(|error| Fault::new(span, format!("`{field}`: {error}")))
}
