//! OBJ and PLY files: positions and faces, nothing else.

use super::Shape;
use std::fs;
use umbriel_kernels::glam::Vec3;

/// Reads a file by its ending.
pub fn read(path: &str) -> Result<Shape, String> {
    let bytes = fs::read(path).map_err(|error| error.to_string())?;
    match path.rsplit('.').next() {
        Some("obj") => obj(&String::from_utf8_lossy(&bytes)),
        Some("ply") => ply(&bytes),
        _ => Err("expected a file that ends with .obj or .ply".into()),
    }
}

impl Shape {
    /// A polygon as a fan of triangles.
    fn polygon(&mut self, corners: &[u32]) -> Result<(), String> {
        if let Some(bad) = corners.iter().find(|&&i| i as usize >= self.positions.len()) {
            return Err(format!("no vertex {bad}"));
        }
        for pair in corners.windows(2).skip(1) {
            self.indices.push([corners[0], pair[0], pair[1]]);
        }
        Ok(())
    }
}

fn obj(text: &str) -> Result<Shape, String> {
    let mut shape = Shape::default();
    for (number, line) in text.lines().enumerate() {
        let mut words = line.split_ascii_whitespace();
        let bad = |what: &str| format!("line {}: {what}", number + 1);
        match words.next() {
            Some("v") => {
                let mut next =
                    || words.next().and_then(|w| w.parse().ok()).ok_or_else(|| bad("expected three numbers"));
                shape.positions.push(Vec3::new(next()?, next()?, next()?));
            }
            Some("f") => {
                let count = shape.positions.len() as i64;
                let corner = |word: &str| word.split('/').next()?.parse::<i64>().ok();
                // Numbers count from 1; negative ones from the end.
                let index = |i: i64| u32::try_from(if i < 0 { count + i } else { i - 1 }).ok();
                let corners: Option<Vec<u32>> = words.map(|w| corner(w).and_then(index)).collect();
                shape.polygon(&corners.ok_or_else(|| bad("bad face"))?).map_err(|e| bad(&e))?;
            }
            _ => {}
        }
    }
    Ok(shape)
}

/// A property of a PLY element.
struct Property {
    name: String,
    kind: Kind,
    /// Type of the length, for lists.
    list: Option<Kind>,
}

#[derive(Clone, Copy)]
enum Kind {
    Signed(usize),
    Unsigned(usize),
    Float(usize),
}

impl Kind {
    fn parse(word: &str) -> Result<Self, String> {
        Ok(match word {
            "char" | "int8" => Self::Signed(1),
            "short" | "int16" => Self::Signed(2),
            "int" | "int32" => Self::Signed(4),
            "uchar" | "uint8" => Self::Unsigned(1),
            "ushort" | "uint16" => Self::Unsigned(2),
            "uint" | "uint32" => Self::Unsigned(4),
            "float" | "float32" => Self::Float(4),
            "double" | "float64" => Self::Float(8),
            _ => return Err(format!("no type `{word}`")),
        })
    }
}

struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

/// Numbers of the body, one after the other.
enum Body<'a> {
    Words(std::str::SplitAsciiWhitespace<'a>),
    Bytes { rest: &'a [u8], big: bool },
}

impl Body<'_> {
    fn next(&mut self, kind: Kind) -> Result<f64, String> {
        match self {
            Self::Words(words) => words.next().and_then(|w| w.parse().ok()).ok_or("expected a number".into()),
            Self::Bytes { rest, big } => {
                let (Kind::Signed(size) | Kind::Unsigned(size) | Kind::Float(size)) = kind;
                let (bytes, after) = rest.split_at_checked(size).ok_or("the file ends too early")?;
                *rest = after;
                let mut word = [0; 8];
                word[..size].copy_from_slice(bytes);
                if *big {
                    word[..size].reverse();
                }
                let word = u64::from_le_bytes(word);
                Ok(match kind {
                    Kind::Unsigned(_) => word as f64,
                    Kind::Signed(size) => ((word << (64 - 8 * size)) as i64 >> (64 - 8 * size)) as f64,
                    Kind::Float(4) => f32::from_bits(word as u32).into(),
                    Kind::Float(_) => f64::from_bits(word),
                })
            }
        }
    }
}

fn ply(bytes: &[u8]) -> Result<Shape, String> {
    const END: &[u8] = b"end_header";
    let end = bytes.windows(END.len()).position(|w| w == END).ok_or("no end of the header")?;
    let line_end = bytes[end..].iter().position(|&b| b == b'\n').ok_or("no body")?;
    let (header, body) = (String::from_utf8_lossy(&bytes[..end]), &bytes[end + line_end + 1..]);
    let text;
    let mut body = if header.contains("format ascii") {
        text = String::from_utf8_lossy(body);
        Body::Words(text.split_ascii_whitespace())
    } else {
        Body::Bytes { rest: body, big: header.contains("big_endian") }
    };
    let mut shape = Shape::default();
    for element in elements(&header)? {
        for _ in 0..element.count {
            item(&element, &mut body, &mut shape)?;
        }
    }
    Ok(shape)
}

fn elements(header: &str) -> Result<Vec<Element>, String> {
    let mut elements: Vec<Element> = Vec::new();
    for line in header.lines() {
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let property = match words[..] {
            ["element", name, count] => {
                let count = count.parse().map_err(|_| format!("bad header line `{line}`"))?;
                elements.push(Element { name: name.into(), count, properties: Vec::new() });
                continue;
            }
            ["property", "list", length, kind, name] => {
                Property { name: name.into(), kind: Kind::parse(kind)?, list: Some(Kind::parse(length)?) }
            }
            ["property", kind, name] => Property { name: name.into(), kind: Kind::parse(kind)?, list: None },
            _ => continue,
        };
        elements.last_mut().ok_or("a property without an element")?.properties.push(property);
    }
    Ok(elements)
}

/// One vertex, one face, or something else that is read over.
fn item(element: &Element, body: &mut Body<'_>, shape: &mut Shape) -> Result<(), String> {
    let mut position = Vec3::ZERO;
    for property in &element.properties {
        let Some(length) = property.list else {
            let value = body.next(property.kind)? as f32;
            match property.name.as_str() {
                "x" => position.x = value,
                "y" => position.y = value,
                "z" => position.z = value,
                _ => {}
            }
            continue;
        };
        let length = body.next(length)? as usize;
        let corners: Result<Vec<u32>, String> = (0..length).map(|_| Ok(body.next(property.kind)? as u32)).collect();
        if element.name == "face" && property.name.starts_with("vertex_ind") {
            shape.polygon(&corners?)?;
        }
    }
    if element.name == "vertex" {
        shape.positions.push(position);
    }
    Ok(())
}
