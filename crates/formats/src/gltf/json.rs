//! JSON values that know their place, so that every error has a JSON pointer.

use crate::{FileError, Place};
use serde_json::{Map, Value};
use std::path::Path;
use umbriel_kernels::glam::Vec3;

/// A JSON object and where it is.
#[derive(Clone, Debug)]
pub(super) struct Json<'a> {
    pub(super) file: &'a Path,
    pub(super) pointer: String,
    object: &'a Map<String, Value>,
}

impl<'a> Json<'a> {
    /// The object `value`, found at `pointer`.
    pub(super) fn new(
        file: &'a Path,
        value: &'a Value,
        pointer: String,
    ) -> Result<Self, FileError> {
        match value {
            Value::Object(object) => Ok(Self {
                file,
                pointer,
                object,
            }),
            other => {
                let message = format!("is {}; expected an object", show(other));
                Err(FileError::input(file, Place::Pointer(pointer), message))
            }
        }
    }

    /// An error about this object.
    pub(super) fn error(&self, message: impl Into<String>) -> FileError {
        let pointer = if self.pointer.is_empty() {
            "/"
        } else {
            &self.pointer
        };
        FileError::input(self.file, Place::Pointer(pointer.to_owned()), message)
    }

    /// An error about one of its members.
    pub(super) fn error_at(&self, key: &str, message: impl Into<String>) -> FileError {
        FileError::input(
            self.file,
            Place::Pointer(format!("{}/{key}", self.pointer)),
            message,
        )
    }

    fn wrong(&self, key: &str, value: &Value, expected: &str) -> FileError {
        self.error_at(key, format!("is {}; expected {expected}", show(value)))
    }

    pub(super) fn has(&self, key: &str) -> bool {
        self.object.contains_key(key)
    }

    /// The names of the members.
    pub(super) fn keys(&self) -> impl Iterator<Item = &'a str> + use<'a> {
        self.object.keys().map(String::as_str)
    }

    fn get(&self, key: &str) -> Option<&'a Value> {
        self.object.get(key)
    }

    pub(super) fn object(&self, key: &str) -> Result<Option<Json<'a>>, FileError> {
        self.get(key)
            .map(|value| Json::new(self.file, value, format!("{}/{key}", self.pointer)))
            .transpose()
    }

    /// An extension of this object.
    pub(super) fn extension(&self, name: &str) -> Result<Option<Json<'a>>, FileError> {
        self.object("extensions")?
            .map_or(Ok(None), |extensions| extensions.object(name))
    }

    /// An array; empty when absent.
    pub(super) fn array(&self, key: &str) -> Result<&'a [Value], FileError> {
        match self.get(key) {
            None => Ok(&[]),
            Some(Value::Array(values)) => Ok(values),
            Some(other) => Err(self.wrong(key, other, "an array")),
        }
    }

    /// An array of objects; empty when absent.
    pub(super) fn objects(&self, key: &str) -> Result<Vec<Json<'a>>, FileError> {
        let place = |i: usize| format!("{}/{key}/{i}", self.pointer);
        let values = self.array(key)?.iter().enumerate();
        values
            .map(|(i, value)| Json::new(self.file, value, place(i)))
            .collect()
    }

    /// An array of indices below `len`.
    pub(super) fn indices(&self, key: &str, len: usize) -> Result<Vec<usize>, FileError> {
        let values = self.array(key)?.iter().enumerate();
        values
            .map(|(i, value)| self.check_index(&format!("{key}/{i}"), value, len))
            .collect()
    }

    /// An index below `len`.
    pub(super) fn index(&self, key: &str, len: usize) -> Result<Option<usize>, FileError> {
        self.get(key)
            .map(|value| self.check_index(key, value, len))
            .transpose()
    }

    fn check_index(&self, key: &str, value: &Value, len: usize) -> Result<usize, FileError> {
        let index = value
            .as_u64()
            .and_then(|i| usize::try_from(i).ok())
            .filter(|i| *i < len);
        index.ok_or_else(|| {
            self.wrong(
                key,
                value,
                &format!("an index below {len}, the number of entries"),
            )
        })
    }

    pub(super) fn integer(&self, key: &str) -> Result<Option<u64>, FileError> {
        let number = |value: &Value| {
            value
                .as_u64()
                .ok_or_else(|| self.wrong(key, value, "a whole number, at least 0"))
        };
        self.get(key).map(number).transpose()
    }

    /// A required size or count.
    pub(super) fn size(&self, key: &str) -> Result<u64, FileError> {
        self.integer(key)?
            .ok_or_else(|| self.error(format!("has no `{key}`")))
    }

    /// A number that an f32 can hold.
    pub(super) fn number(&self, key: &str) -> Result<Option<f32>, FileError> {
        self.get(key)
            .map(|value| to_f32(value).ok_or_else(|| self.wrong(key, value, "a number")))
            .transpose()
    }

    pub(super) fn numbers<const N: usize>(&self, key: &str) -> Result<Option<[f32; N]>, FileError> {
        let Some(value) = self.get(key) else {
            return Ok(None);
        };
        let list = value.as_array().filter(|list| list.len() == N);
        let numbers: Option<Vec<f32>> = list.and_then(|list| list.iter().map(to_f32).collect());
        let fixed = numbers.and_then(|numbers| <[f32; N]>::try_from(numbers).ok());
        fixed
            .map(Some)
            .ok_or_else(|| self.wrong(key, value, &format!("an array of {N} numbers")))
    }

    pub(super) fn color(&self, key: &str, default: Vec3) -> Result<Vec3, FileError> {
        Ok(self.numbers::<3>(key)?.map_or(default, Vec3::from))
    }

    pub(super) fn text(&self, key: &str) -> Result<Option<&'a str>, FileError> {
        let text = |value: &'a Value| {
            value
                .as_str()
                .ok_or_else(|| self.wrong(key, value, "a string"))
        };
        self.get(key).map(text).transpose()
    }

    pub(super) fn flag(&self, key: &str) -> Result<bool, FileError> {
        let flag = |value: &Value| {
            value
                .as_bool()
                .ok_or_else(|| self.wrong(key, value, "true or false"))
        };
        self.get(key).map_or(Ok(false), flag)
    }

    /// The name in messages; `kind` and the position where there is none.
    pub(super) fn name(&self, kind: &str) -> String {
        let number = self.pointer.rsplit('/').next().unwrap_or_default();
        match self.get("name").and_then(Value::as_str) {
            Some(name) if !name.is_empty() => name.to_owned(),
            _ => format!("{kind} {number}"),
        }
    }
}

fn to_f32(value: &Value) -> Option<f32> {
    value.as_f64().map(|x| x as f32).filter(|x| x.is_finite())
}

/// At most 40 characters of a value.
fn show(value: &Value) -> String {
    match value {
        Value::Object(_) => "an object".to_owned(),
        Value::Array(list) => format!("an array of {}", list.len()),
        other => crate::folder::shorten(&other.to_string()),
    }
}
