//! Accessors: typed arrays in buffers, dense and sparse.

use super::{
    buffer::{Buffers, MAX_ZEROS, View},
    json::Json,
};
use crate::{ErrorKind, FileError};

/// Type of a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn parse(json: &Json) -> Result<Self, FileError> {
        Ok(match json.size("componentType")? {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            other => {
                let message = format!("is {other}; expected 5120 to 5123, 5125 or 5126");
                return Err(json.error_at("componentType", message));
            }
        })
    }

    fn size(self) -> u64 {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The number in the first bytes of `b`. Source: Khronos, glTF 2.0, section 3.11 (normalized integers).
    fn float(self, b: &[u8], normalized: bool) -> f32 {
        let (value, most) = match self {
            Self::I8 => (f32::from(b[0] as i8), 127.0),
            Self::U8 => (f32::from(b[0]), 255.0),
            Self::I16 => (f32::from(i16::from_le_bytes([b[0], b[1]])), 32_767.0),
            Self::U16 => (f32::from(u16::from_le_bytes([b[0], b[1]])), 65_535.0),
            Self::U32 => return u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as f32,
            Self::F32 => return f32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        };
        if normalized {
            (value / most).max(-1.0)
        } else {
            value
        }
    }

    /// The index in the first bytes of `b`, for the unsigned types.
    fn index(self, b: &[u8]) -> u32 {
        match self {
            Self::I8 | Self::U8 => u32::from(b[0]),
            Self::I16 | Self::U16 => u32::from(u16::from_le_bytes([b[0], b[1]])),
            Self::U32 | Self::F32 => u32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        }
    }

    fn is_unsigned(self) -> bool {
        matches!(self, Self::U8 | Self::U16 | Self::U32)
    }
}

/// A typed array, described.
struct Accessor<'a> {
    json: Json<'a>,
    count: u64,
    width: u64,
    component: Component,
    normalized: bool,
}

/// Reads accessor number `index`, which exists, as numbers; returns them and how many an element has.
pub(super) fn read_floats(
    buffers: &Buffers,
    json: &Json,
    widths: &[usize],
) -> Result<(Vec<f32>, usize), FileError> {
    let accessor = Accessor::new(json)?;
    let width = accessor.width as usize;
    if !widths.contains(&width) {
        return Err(json.error_at(
            "type",
            format!("has {width} components; expected {widths:?}"),
        ));
    }
    if width > 4 && accessor.component != Component::F32 {
        return Err(json.error_at(
            "componentType",
            "is not 5126 (float); expected it for a matrix",
        ));
    }
    let values = accessor.read(buffers, |component, normalized, bytes| {
        component.float(bytes, normalized)
    })?;
    Ok((values, width))
}

/// Reads an accessor as unsigned integers.
pub(super) fn read_indices(
    buffers: &Buffers,
    json: &Json,
    width: usize,
) -> Result<Vec<u32>, FileError> {
    let accessor = Accessor::new(json)?;
    if accessor.width as usize != width {
        return Err(json.error_at(
            "type",
            format!("has {} components; expected {width}", accessor.width),
        ));
    }
    if !accessor.component.is_unsigned() {
        return Err(json.error_at(
            "componentType",
            "is signed or a float; expected 5121, 5123 or 5125",
        ));
    }
    accessor.read(buffers, |component, _, bytes| component.index(bytes))
}

impl<'a> Accessor<'a> {
    fn new(json: &Json<'a>) -> Result<Self, FileError> {
        let width = match json.text("type")? {
            Some("SCALAR") => 1,
            Some("VEC2") => 2,
            Some("VEC3") => 3,
            Some("VEC4" | "MAT2") => 4,
            Some("MAT3") => 9,
            Some("MAT4") => 16,
            _ => {
                return Err(json.error_at(
                    "type",
                    "is unknown; expected SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4",
                ));
            }
        };
        let count = json.size("count")?;
        if count > u64::from(u32::MAX) {
            let message = format!("is {count}; the limit is {} elements", u32::MAX);
            return Err(FileError {
                kind: ErrorKind::Limit,
                ..json.error_at("count", message)
            });
        }
        Ok(Self {
            json: json.clone(),
            count,
            width,
            component: Component::parse(json)?,
            normalized: json.flag("normalized")?,
        })
    }

    /// All components of all elements, converted; memory is taken after the sizes were checked.
    fn read<T: Copy + Default>(
        &self,
        buffers: &Buffers,
        convert: impl Fn(Component, bool, &[u8]) -> T,
    ) -> Result<Vec<T>, FileError> {
        let width = self.width as usize;
        let size = self.component.size() as usize;
        let element = |bytes: &[u8], out: &mut [T]| {
            for (value, bytes) in out.iter_mut().zip(bytes.chunks_exact(size)) {
                *value = convert(self.component, self.normalized, bytes);
            }
        };
        let Some(view) = self.json.index("bufferView", buffers.view_count())? else {
            let mut values = self.zeros(buffers)?;
            self.read_sparse(buffers, &mut values, element)?;
            return Ok(values);
        };
        let view = buffers.view(view)?;
        let offset = self.json.integer("byteOffset")?.unwrap_or(0);
        let each = self.width * self.component.size();
        let stride = view.stride.unwrap_or(each);
        if stride < each {
            return Err(self.json.error(format!(
                "has elements of {each} bytes; `byteStride` is only {stride}"
            )));
        }
        let bytes = self.window(view, offset, stride, each, self.count)?;
        let mut values = vec![T::default(); self.count as usize * width];
        // The last element may end before its stride does.
        for (out, bytes) in values
            .chunks_exact_mut(width)
            .zip(bytes.chunks(stride as usize))
        {
            element(bytes, out);
        }
        self.read_sparse(buffers, &mut values, element)?;
        Ok(values)
    }

    /// The bytes of `count` elements of `each` bytes, `stride` apart: exactly up to the end of the last one.
    fn window<'b>(
        &self,
        view: View<'b>,
        offset: u64,
        stride: u64,
        each: u64,
        count: u64,
    ) -> Result<&'b [u8], FileError> {
        if count == 0 {
            return Ok(&[]);
        }
        let need = stride
            .checked_mul(count - 1)
            .and_then(|n| n.checked_add(each))
            .and_then(|n| n.checked_add(offset));
        let has = view.bytes.len() as u64;
        match need.filter(|need| *need <= has) {
            Some(need) => Ok(&view.bytes[offset as usize..need as usize]),
            None => {
                let need = need.map_or("more than 2^64".to_owned(), |need| need.to_string());
                Err(self.json.error(format!(
                    "needs {need} bytes; its buffer view has only {has}"
                )))
            }
        }
    }

    /// The values of an accessor without bytes in the file.
    fn zeros<T: Copy + Default>(&self, buffers: &Buffers) -> Result<Vec<T>, FileError> {
        let n = self.count * self.width;
        if !buffers.take_zeros(n) {
            let message = format!(
                "is {} without a buffer view; the limit is {MAX_ZEROS} numbers in a file",
                self.count
            );
            return Err(FileError {
                kind: ErrorKind::Limit,
                ..self.json.error_at("count", message)
            });
        }
        Ok(vec![T::default(); n as usize])
    }

    /// Puts the sparse values, which are tightly packed, in the places of their rising indices.
    fn read_sparse<T>(
        &self,
        buffers: &Buffers,
        values: &mut [T],
        element: impl Fn(&[u8], &mut [T]),
    ) -> Result<(), FileError> {
        let Some(sparse) = self.json.object("sparse")? else {
            return Ok(());
        };
        let count = sparse.size("count")?;
        if count > self.count {
            return Err(sparse.error_at(
                "count",
                format!("is {count}; the accessor has only {}", self.count),
            ));
        }
        let part = |key: &str, each: u64| -> Result<_, FileError> {
            let json = sparse
                .object(key)?
                .ok_or_else(|| sparse.error(format!("has no `{key}`")))?;
            let view = json.index("bufferView", buffers.view_count())?;
            let view = buffers.view(view.ok_or_else(|| json.error("has no `bufferView`"))?)?;
            let offset = json.integer("byteOffset")?.unwrap_or(0);
            self.window(view, offset, each, each, count)
                .map_err(|error| json.error(error.message))
        };
        let indices = sparse
            .object("indices")?
            .ok_or_else(|| sparse.error("has no `indices`"))?;
        let kind = Component::parse(&indices)?;
        if !kind.is_unsigned() {
            return Err(indices.error_at(
                "componentType",
                "is signed or a float; expected 5121, 5123 or 5125",
            ));
        }
        let each = self.width * self.component.size();
        let places = part("indices", kind.size())?.chunks_exact(kind.size() as usize);
        let mut last = None;
        for (place, bytes) in places.zip(part("values", each)?.chunks_exact(each as usize)) {
            let index = kind.index(place);
            if last.is_some_and(|last| index <= last) || u64::from(index) >= self.count {
                let message = format!(
                    "has index {index}; expected rising indices below {}",
                    self.count
                );
                return Err(indices.error(message));
            }
            last = Some(index);
            let start = index as usize * self.width as usize;
            element(bytes, &mut values[start..start + self.width as usize]);
        }
        Ok(())
    }
}
