//! Small values of scene files: vectors, colours, references to textures.

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, de};
use std::fmt;
use umbriel_render::kernels::glam;

/// Reads `[a, b, …]`, or one number for all components where `grey` is set.
struct Numbers<const N: usize> {
    grey: bool,
}

impl<'de, const N: usize> de::Visitor<'de> for Numbers<N> {
    type Value = [f32; N];

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.grey {
            true => write!(f, "{N} numbers in brackets or one number"),
            false => write!(f, "{N} numbers in brackets"),
        }
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<Self::Value, E> {
        match self.grey {
            true => Ok([value as f32; N]),
            false => Err(E::invalid_type(de::Unexpected::Float(value), &self)),
        }
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<Self::Value, E> {
        match self.grey {
            true => Ok([value as f32; N]),
            false => Err(E::invalid_type(de::Unexpected::Signed(value), &self)),
        }
    }

    fn visit_seq<A: de::SeqAccess<'de>>(self, mut items: A) -> Result<Self::Value, A::Error> {
        let mut result = [0.0; N];
        let mut found = 0;
        while let Some(value) = items.next_element::<f32>()? {
            if let Some(slot) = result.get_mut(found) {
                *slot = value;
            }
            found += 1;
        }
        if found == N {
            return Ok(result);
        }
        Err(de::Error::custom(format!(
            "expected {N} numbers, found {found}"
        )))
    }
}

/// A vector or point: `[x, y, z]`.
#[derive(Clone, Copy, Debug, JsonSchema)]
pub(super) struct Vec3(pub [f32; 3]);

/// Two numbers: `[x, y]`.
#[derive(Clone, Copy, Debug, JsonSchema)]
pub(super) struct Vec2(pub [f32; 2]);

/// A linear Rec. 709 colour, `[r, g, b]`, or one number for grey.
#[derive(Clone, Copy, Debug, JsonSchema)]
pub(super) struct Color(#[schemars(with = "ColorShape")] pub [f32; 3]);

/// One factor for all axes, or one for each: `[x, y, z]`.
#[derive(Clone, Copy, Debug, JsonSchema)]
pub(super) struct Scale(#[schemars(with = "ColorShape")] pub [f32; 3]);

/// The same for texture coordinates.
#[derive(Clone, Copy, Debug, JsonSchema)]
pub(super) struct Scale2(#[schemars(with = "PairShape")] pub [f32; 2]);

/// Shape in the schema.
#[derive(JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "only its schema is used")]
enum ColorShape {
    Grey(f32),
    Rgb([f32; 3]),
}

/// Shape in the schema.
#[derive(JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "only its schema is used")]
enum PairShape {
    Both(f32),
    Each([f32; 2]),
}

macro_rules! read {
    ($name:ident, $n:literal, $grey:literal) => {
        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                deserializer
                    .deserialize_any(Numbers::<$n> { grey: $grey })
                    .map(Self)
            }
        }
    };
}
read!(Vec3, 3, false);
read!(Vec2, 2, false);
read!(Color, 3, true);
read!(Scale, 3, true);
read!(Scale2, 2, true);

impl From<Vec3> for glam::Vec3 {
    fn from(v: Vec3) -> Self {
        v.0.into()
    }
}

impl From<Color> for glam::Vec3 {
    fn from(c: Color) -> Self {
        c.0.into()
    }
}

/// Width and height in pixels: `[640, 480]`.
#[derive(Clone, Copy, Debug, JsonSchema)]
pub(super) struct Resolution(pub [i64; 2]);

impl<'de> Deserialize<'de> for Resolution {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        // Numbers, not integers, are read for the sake of the message about 1.5 and about arity.
        let sides = Vec::<i64>::deserialize(deserializer)?;
        let found = sides.len();
        sides
            .try_into()
            .map(Self)
            .map_err(|_| de::Error::custom(format!("expected 2 numbers, found {found}")))
    }
}

/// Use of a texture: its name, or a table with its name and how it is laid on.
#[derive(Clone, Debug)]
pub(super) struct TextureUse(pub TextureTable);

/// Use of a texture with its placement.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct TextureTable {
    /// Name of a `[[checker]]` or `[[image]]`.
    pub texture: String,
    /// Factor for the texture coordinates: 2 shows the texture twice as often.
    pub scale: Option<Scale2>,
    /// Added to the texture coordinates.
    pub offset: Option<Vec2>,
    /// Counter-clockwise rotation about the origin of the texture, in degrees.
    pub rotation: Option<f32>,
    /// Which set of texture coordinates of a mesh: 0 (default) or 1.
    pub uv_set: Option<u8>,
}

impl JsonSchema for TextureUse {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "TextureUse".into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let table = generator.subschema_for::<TextureTable>();
        schemars::json_schema!({
            "description": "Name of a [[checker]] or [[image]], or a table with its name and placement.",
            "anyOf": [{ "type": "string" }, table],
        })
    }
}

impl<'de> Deserialize<'de> for TextureUse {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(TextureVisitor).map(Self)
    }
}

struct TextureVisitor;

impl<'de> de::Visitor<'de> for TextureVisitor {
    type Value = TextureTable;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the name of a texture or a table { texture = \"name\", … }")
    }

    fn visit_str<E: de::Error>(self, name: &str) -> Result<TextureTable, E> {
        Ok(TextureTable {
            texture: name.to_owned(),
            scale: None,
            offset: None,
            rotation: None,
            uv_set: None,
        })
    }

    fn visit_map<A: de::MapAccess<'de>>(self, map: A) -> Result<TextureTable, A::Error> {
        TextureTable::deserialize(de::value::MapAccessDeserializer::new(map))
    }
}
