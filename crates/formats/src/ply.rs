//! PLY meshes, text and binary of both byte orders.

use crate::{
    FileError, Place, Report,
    ply_header::{Element, Form, Header, Property, Scalar, read_header},
    polygon,
    words::{Text, Words},
};
use std::path::Path;
use umbriel_kernels::glam::{Vec2, Vec3, Vec4};
use umbriel_render::{Mesh, srgb_to_linear};

/// Names of the vertex properties that are used, by slot; texture coordinates have several.
const SLOTS: [&[&str]; 12] = [
    &["x"],
    &["y"],
    &["z"],
    &["nx"],
    &["ny"],
    &["nz"],
    &["red", "diffuse_red", "r"],
    &["green", "diffuse_green", "g"],
    &["blue", "diffuse_blue", "b"],
    &["alpha", "diffuse_alpha", "a"],
    &["s", "u", "texture_u", "texture_s"],
    &["t", "v", "texture_v", "texture_t"],
];

/// Reads the mesh of a PLY file: positions, normals, colours, texture coordinates and polygons.
///
/// Colours stored as integers are sRGB; as floats they are linear. Texture coordinates have their origin
/// at the lower left, so that v is turned over.
///
/// Source: Turk, The PLY Polygon File Format, 1994.
pub(crate) fn read_ply(path: &Path, bytes: &[u8], report: &mut Report) -> Result<Mesh, FileError> {
    let header = read_header(path, bytes)?;
    refuse_splats(path, &header)?;
    let mut source = Source::new(path, bytes, &header)?;
    let mut mesh = Mesh::default();
    let mut faces = Faces::default();
    for element in &header.elements {
        source.check_room(element)?;
        match element.name.as_str() {
            "vertex" => read_vertices(&mut source, element, &mut mesh, report)?,
            "face" => faces.read(&mut source, element, report)?,
            _ => {
                report.ignore_n(
                    format!("PLY element {}", element.name),
                    element.count as usize,
                );
                skip_element(&mut source, element)?;
            }
        }
    }
    faces.triangulate(path, &mut mesh)?;
    Ok(mesh)
}

/// A file of a Gaussian splat scene has points with shapes, and no faces.
fn refuse_splats(path: &Path, header: &Header) -> Result<(), FileError> {
    let is_splat = |element: &Element| {
        let has = |name: &str| element.properties.iter().any(|p| p.name == name);
        has("f_dc_0") || (has("scale_0") && has("rot_0")) || has("packed_position")
    };
    if header.elements.iter().any(is_splat) {
        let message =
            "is a Gaussian splat cloud, which has no surface to draw; expected a mesh of polygons";
        return Err(FileError::input(path, Place::File, message));
    }
    Ok(())
}

fn read_vertices(
    source: &mut Source,
    element: &Element,
    mesh: &mut Mesh,
    report: &mut Report,
) -> Result<(), FileError> {
    let slot_of = |p: &Property| {
        SLOTS
            .iter()
            .position(|names| names.contains(&p.name.as_str()) && p.count.is_none())
    };
    let slots: Vec<Option<usize>> = element.properties.iter().map(slot_of).collect();
    let has =
        |range: std::ops::Range<usize>| range.into_iter().all(|slot| slots.contains(&Some(slot)));
    if element.count > 0 && !has(0..3) {
        return Err(source.header_error("the vertices have no x, y and z"));
    }
    for (property, _) in element
        .properties
        .iter()
        .zip(&slots)
        .filter(|(_, slot)| slot.is_none())
    {
        report.ignore(format!("PLY vertex property {}", property.name));
    }
    let red = element
        .properties
        .iter()
        .zip(&slots)
        .find(|(_, slot)| **slot == Some(6));
    let color_type = red.map_or(Scalar::U8, |(property, _)| property.kind);
    let (normals, colors, uvs) = (has(3..6), has(6..9), has(10..12));
    for _ in 0..element.count {
        let mut v = [0.0_f64; 12];
        v[9] = color_type.white();
        for (property, slot) in element.properties.iter().zip(&slots) {
            let n = source.list_length(property)?;
            for _ in 0..n {
                let value = source.next(property.kind)?;
                if let Some(slot) = slot {
                    v[*slot] = value;
                }
            }
        }
        let f = v.map(|x| x as f32);
        mesh.positions.push(Vec3::new(f[0], f[1], f[2]));
        if normals {
            mesh.normals.push(Vec3::new(f[3], f[4], f[5]));
        }
        if colors {
            mesh.colors
                .push(linear_color([v[6], v[7], v[8], v[9]], color_type));
        }
        if uvs {
            mesh.uvs[0].push(Vec2::new(f[10], 1.0 - f[11]));
        }
    }
    Ok(())
}

fn linear_color(rgba: [f64; 4], kind: Scalar) -> Vec4 {
    let [r, g, b, a] = rgba.map(|x| (x / kind.white()) as f32);
    if kind.is_float() {
        return Vec4::new(r, g, b, a);
    }
    let [r, g, b] = [r, g, b].map(|c| srgb_to_linear((c * 255.0).round() as u8));
    Vec4::new(r, g, b, a)
}

fn skip_element(source: &mut Source, element: &Element) -> Result<(), FileError> {
    for _ in 0..element.count {
        for property in &element.properties {
            for _ in 0..source.list_length(property)? {
                source.next(property.kind)?;
            }
        }
    }
    Ok(())
}

/// Polygons as they are in the file; vertices may come after them.
#[derive(Default)]
struct Faces {
    corners: Vec<u32>,
    lengths: Vec<u32>,
}

impl Faces {
    fn read(
        &mut self,
        source: &mut Source,
        element: &Element,
        report: &mut Report,
    ) -> Result<(), FileError> {
        let is_corners = |p: &Property| {
            p.count.is_some() && matches!(p.name.as_str(), "vertex_indices" | "vertex_index")
        };
        for property in element.properties.iter().filter(|p| !is_corners(p)) {
            report.ignore(format!("PLY face property {}", property.name));
        }
        for face in 0..element.count {
            for property in &element.properties {
                let n = source.list_length(property)?;
                if is_corners(property) {
                    self.lengths.push(n);
                }
                for _ in 0..n {
                    let value = source.next(property.kind)?;
                    if is_corners(property) {
                        if !(0.0..=f64::from(u32::MAX)).contains(&value) || value.fract() != 0.0 {
                            return Err(source.error(&format!("vertex {value} of face {face} does not exist; expected a whole number, at least 0")));
                        }
                        self.corners.push(value as u32);
                    }
                }
            }
        }
        Ok(())
    }

    fn triangulate(&self, path: &Path, mesh: &mut Mesh) -> Result<(), FileError> {
        let mut rest = &self.corners[..];
        for (face, &n) in self.lengths.iter().enumerate() {
            let (polygon, tail) = rest.split_at(n as usize);
            rest = tail;
            let vertices = mesh.positions.len();
            if let Some(bad) = polygon.iter().find(|&&i| i as usize >= vertices) {
                let message = format!(
                    "face {face} uses vertex {bad}; expected less than {vertices}, their number"
                );
                return Err(FileError::input(path, Place::File, message));
            }
            let points: Vec<Vec3> = polygon
                .iter()
                .map(|&i| mesh.positions[i as usize])
                .collect();
            let triangles = polygon::triangulate(&points);
            mesh.indices.extend(
                triangles
                    .into_iter()
                    .map(|t| t.map(|corner| polygon[corner])),
            );
        }
        Ok(())
    }
}

/// The numbers after the header.
enum Source<'a> {
    Text(Text<'a>, Words<'a>),
    Binary {
        path: &'a Path,
        bytes: &'a [u8],
        at: usize,
        big: bool,
    },
}

impl<'a> Source<'a> {
    fn new(path: &'a Path, bytes: &'a [u8], header: &Header) -> Result<Self, FileError> {
        Ok(match header.form {
            Form::Text => {
                let text = Text { path, bytes };
                Self::Text(text, text.words(header.end, bytes.len()))
            }
            Form::BinaryLittle | Form::BinaryBig => Self::Binary {
                path,
                bytes,
                at: header.end,
                big: header.form == Form::BinaryBig,
            },
        })
    }

    /// Refuses an element that cannot fit into the rest of the file, before memory is taken for it.
    fn check_room(&self, element: &Element) -> Result<(), FileError> {
        if element.properties.is_empty() && element.count > 0 {
            return Err(self.error(&format!(
                "the elements `{}` have no properties",
                element.name
            )));
        }
        let least = |p: &Property| match self {
            // A digit and a space; an empty list still has its length.
            Self::Text(..) => 2,
            Self::Binary { .. } => p.count.unwrap_or(p.kind).size() as u64,
        };
        let each: u64 = element.properties.iter().map(least).sum();
        let left = match self {
            // The last number needs no space after it.
            Self::Text(text, words) => (text.bytes.len() - words.position()) as u64 + 1,
            Self::Binary { bytes, at, .. } => (bytes.len() - at) as u64,
        };
        let need = u128::from(each) * u128::from(element.count);
        if need > u128::from(left) || element.count > u64::from(u32::MAX) {
            let message = format!(
                "{} elements `{}` need at least {need} bytes; the file has {left} left",
                element.count, element.name
            );
            return Err(self.error(&message));
        }
        Ok(())
    }

    fn header_error(&self, message: &str) -> FileError {
        let (Self::Text(Text { path, .. }, _) | Self::Binary { path, .. }) = self;
        FileError::input(*path, Place::File, message)
    }

    fn error(&self, message: &str) -> FileError {
        match self {
            Self::Text(text, words) => text.error(words.position(), message),
            Self::Binary { path, at, .. } => {
                FileError::input(*path, Place::Byte(*at as u64), message)
            }
        }
    }

    /// 1 for a property that is no list.
    fn list_length(&mut self, property: &Property) -> Result<u32, FileError> {
        let Some(kind) = property.count else {
            return Ok(1);
        };
        let value = self.next(kind)?;
        if value < 0.0 || value.fract() != 0.0 || value > f64::from(u32::MAX) {
            return Err(self.error(&format!(
                "a list has the length {value}; expected a whole number, at least 0"
            )));
        }
        Ok(value as u32)
    }

    fn next(&mut self, kind: Scalar) -> Result<f64, FileError> {
        match self {
            Self::Text(text, words) => {
                let word = words.next();
                let value: Option<f64> = word.and_then(|w| w.parse());
                value.ok_or_else(|| text.unexpected(word, "a number"))
            }
            Self::Binary {
                path,
                bytes,
                at,
                big,
            } => {
                let size = kind.size();
                let Some(number) = bytes.get(*at..*at + size) else {
                    let message = "the file ends inside an element; expected more bytes";
                    return Err(FileError::input(
                        *path,
                        Place::Byte(bytes.len() as u64),
                        message,
                    ));
                };
                *at += size;
                Ok(kind.value(number, *big))
            }
        }
    }
}
