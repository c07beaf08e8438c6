//! `-D key=value`: changes to the document before it is understood.

use super::diagnose::hint;
use super::source::{Fault, Source};
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Applies all overrides of `source` to its document.
///
/// Every changed value gets the span of its override, so that a later error names the override.
pub(super) fn apply_overrides<'a>(source: &'a Source, root: &mut DeTable<'a>) -> Result<(), Fault> {
    for (i, (key, value)) in source.overrides.iter().enumerate() {
        let span = source.override_span(i);
        let fault = |message: String| Fault::new(span.clone(), message);
        let path: Vec<&str> = key.split('.').map(str::trim).collect();
        if path.iter().any(|step| step.is_empty()) {
            return Err(fault(
                "is no path; expected names with dots between them, as in sphere.0.radius"
                    .to_owned(),
            ));
        }
        let new = Spanned::new(span.clone(), parse_value(value, &span));
        set_in_table(root, &path, new, &span).map_err(fault)?;
    }
    Ok(())
}

/// A value in TOML, or else the text itself.
fn parse_value<'a>(value: &'a str, span: &Range<usize>) -> DeValue<'a> {
    match DeValue::parse(value) {
        Ok(parsed) => stamp(parsed.into_inner(), span),
        Err(_) => DeValue::String(value.into()),
    }
}

/// Gives all parts of a value one span.
fn stamp<'a>(value: DeValue<'a>, span: &Range<usize>) -> DeValue<'a> {
    let item = |v: Spanned<DeValue<'a>>| Spanned::new(span.clone(), stamp(v.into_inner(), span));
    match value {
        DeValue::Array(array) => DeValue::Array(array.into_iter().map(item).collect()),
        DeValue::Table(table) => DeValue::Table(
            table
                .into_iter()
                .map(|(k, v)| (Spanned::new(span.clone(), k.into_inner()), item(v)))
                .collect(),
        ),
        plain => plain,
    }
}

fn set_in_table<'a>(
    table: &mut DeTable<'a>,
    path: &[&'a str],
    new: Spanned<DeValue<'a>>,
    span: &Range<usize>,
) -> Result<(), String> {
    let Some((&step, rest)) = path.split_first() else {
        return Ok(());
    };
    if rest.is_empty() {
        // The key gets the override's span, too: an unknown key is then the override's fault.
        table.remove(step);
        table.insert(Spanned::new(span.clone(), step.into()), new);
        return Ok(());
    }
    if !table.contains_key(step) {
        // Tables that need not be written may be made by an override; arrays of things have no element to set.
        let makeable = [
            "render",
            "environment",
            "transform",
            "adaptive",
            "shadow_map",
        ];
        if !makeable.contains(&step) {
            let names: Vec<&str> = table.keys().map(|k| k.get_ref().as_ref()).collect();
            return Err(format!(
                "no `{step}` in the scene; {}",
                hint(step, names, "the file is empty")
            ));
        }
        let empty = Spanned::new(span.clone(), DeValue::Table(DeTable::new()));
        table.insert(Spanned::new(span.clone(), step.into()), empty);
    }
    let Some(next) = table.get_mut(step) else {
        return Ok(());
    };
    set_in_value(step, next.get_mut(), rest, new, span)
}

fn set_in_value<'a>(
    name: &str,
    value: &mut DeValue<'a>,
    path: &[&'a str],
    new: Spanned<DeValue<'a>>,
    span: &Range<usize>,
) -> Result<(), String> {
    match value {
        DeValue::Table(table) => set_in_table(table, path, new, span),
        DeValue::Array(array) => {
            let step = path[0];
            let index = find_element(array, step).ok_or_else(|| no_element(name, array, step))?;
            match path.len() {
                1 => (**array)[index] = new,
                _ => set_in_value(name, (**array)[index].get_mut(), &path[1..], new, span)?,
            }
            Ok(())
        }
        _ => Err(format!("`{name}` is a single value; nothing is inside it")),
    }
}

/// An element by its position, counted from 0, or by its name.
fn find_element(array: &[Spanned<DeValue<'_>>], step: &str) -> Option<usize> {
    let by_name = array
        .iter()
        .position(|item| element_name(item) == Some(step));
    by_name.or_else(|| step.parse().ok().filter(|&i: &usize| i < array.len()))
}

fn element_name<'a>(item: &'a Spanned<DeValue<'_>>) -> Option<&'a str> {
    item.get_ref().as_table()?.get("name")?.get_ref().as_str()
}

fn no_element(name: &str, array: &[Spanned<DeValue<'_>>], step: &str) -> String {
    let names: Vec<&str> = array.iter().filter_map(element_name).collect();
    let is_position = step.bytes().all(|b| b.is_ascii_digit());
    let list = match array.len() {
        0 => "there is none".to_owned(),
        n if is_position || names.is_empty() => format!("expected 0 to {}", n - 1),
        _ => hint(step, names, ""),
    };
    format!("no `{name}` `{step}`; {list}")
}
