//! From the parser's words to ours: what is wrong, and what was expected.

use super::source::{Fault, Source, Step};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The nearest of `names` to `name`, when it is near enough to be a typing error.
pub(super) fn nearest<'a>(name: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let distance = |candidate: &str| strsim::damerau_levenshtein(name, candidate);
    let (best, score) = names
        .into_iter()
        .map(|n| (n, distance(n)))
        .min_by_key(|&(_, d)| d)?;
    (score <= 1 + name.chars().count().min(best.chars().count()) / 4).then_some(best)
}

/// `did you mean X?`, or the list of what there is.
pub(super) fn hint<'a>(
    name: &str,
    names: impl IntoIterator<Item = &'a str> + Clone,
    none: &str,
) -> String {
    // A name as long as a file would make the search and the line as long.
    if name.len() <= 100
        && let Some(best) = nearest(name, names.clone())
    {
        return format!("did you mean `{best}`?");
    }
    let list: Vec<_> = names.into_iter().map(|n| format!("`{n}`")).collect();
    match list.len() {
        0 => none.to_owned(),
        1 => format!("expected {}", list[0]),
        _ => format!("expected one of {}", list.join(", ")),
    }
}

/// The fault behind an error of the TOML parser.
pub(super) fn syntax_fault(error: &toml::de::Error, source: &Source) -> Fault {
    let span = error.span().unwrap_or(0..0);
    let message = error.message().lines().collect::<Vec<_>>().join("; ");
    if message.contains("array elements") || message.starts_with("unclosed array, ") {
        return unclosed_fault(&source.text, span.start).unwrap_or(Fault::new(span, message));
    }
    let message = match message.as_str() {
        "duplicate key" => format!(
            "second `{}` in the same table",
            source.text.get(span.clone()).unwrap_or_default()
        ),
        "recursion limit" | "cannot recurse further; max recursion depth met" => {
            "is nested too deeply; expected at most 80 levels".to_owned()
        }
        "invalid float, expected nothing" => "not a number; expected one like 1.5".to_owned(),
        _ => message.replacen(", expected ", "; expected ", 1),
    };
    Fault::new(span, message)
}

/// Points at the last bracket that is open at `end` when it stands in an earlier line: its end was
/// forgotten there.
fn unclosed_fault(text: &str, end: usize) -> Option<Fault> {
    let mut depth = 0;
    let before = text.get(..end)?;
    let open = before.char_indices().rev().find(|&(_, c)| {
        depth += match c {
            ']' => 1,
            '[' => -1,
            _ => 0,
        };
        depth < 0
    });
    let (open, _) = open?;
    let lines = before[open..].matches('\n').count();
    (lines > 0 || end >= text.trim_end().len())
        .then(|| Fault::new(open..open + 1, "`[` is not closed; expected `]`"))
}

/// Refuses arrays where tables belong: deserialisation would take their elements for the fields in order.
pub(super) fn check_tables(root: &DeTable<'_>) -> Result<(), Fault> {
    for (key, value) in root.iter() {
        let name = key.get_ref().as_ref();
        match value.get_ref() {
            DeValue::Array(_) if matches!(name, "render" | "environment") => {
                let message = format!("`{name}` is an array; expected one table, [{name}]");
                return Err(Fault::new(key.span(), message));
            }
            DeValue::Array(items) if name != "include" => {
                items.iter().try_for_each(|item| check_item(name, item))?
            }
            DeValue::Table(table) => check_fields(table)?,
            _ => {}
        }
    }
    Ok(())
}

fn check_item(name: &str, item: &Spanned<DeValue<'_>>) -> Result<(), Fault> {
    match item.get_ref() {
        DeValue::Table(table) => check_fields(table),
        _ => {
            let message = format!("`{name}` holds something else than tables; expected [[{name}]]");
            Err(Fault::new(item.span(), message))
        }
    }
}

fn check_fields(table: &DeTable<'_>) -> Result<(), Fault> {
    for (key, value) in table.iter() {
        let name = key.get_ref().as_ref();
        if matches!(name, "transform" | "adaptive" | "shadow_map") && !value.get_ref().is_table() {
            let message = format!(
                "`{name}` is of type {}; expected a table, {{ … }}",
                value.get_ref().type_str()
            );
            return Err(Fault::new(value.span(), message));
        }
    }
    Ok(())
}

/// The fault behind an error of deserialisation.
pub(super) fn content_fault(error: &toml::de::Error, source: &Source) -> Fault {
    let span = error.span().unwrap_or(0..0);
    let path = source.entry_at(&span).map_or(&[][..], |entry| &entry.path);
    Fault::new(span, reword(error.message().trim_end(), path))
}

fn reword(message: &str, path: &[Step]) -> String {
    let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let first = quoted.first().copied().unwrap_or_default();
    if message.starts_with("unknown field") {
        let list = hint(
            first,
            quoted.iter().skip(1).copied(),
            "no key is expected here",
        );
        return format!(
            "unknown key `{first}`{}; {list}",
            place(path.get(..path.len().saturating_sub(1)))
        );
    }
    if message.starts_with("missing field") {
        return format!("missing key `{first}`{}", place(Some(path)));
    }
    if message.starts_with("unknown variant") {
        let list = hint(first, quoted.iter().skip(1).copied(), "");
        return format!("unknown value \"{first}\"{}; {list}", of_key(path));
    }
    let kinds = ["invalid type: ", "invalid value: "];
    let found = kinds.iter().find_map(|kind| message.strip_prefix(kind));
    if let Some((found, expected)) = found.and_then(split_expected) {
        return reword_expected(found, expected, message, path);
    }
    format!("{}{message}", subject(path).replace("` ", "`: "))
}

fn reword_expected(found: &str, expected: &str, message: &str, path: &[Step]) -> String {
    let found = found_words(found);
    if key(path) == Some("include") && message.starts_with("invalid type") {
        return format!("`include` holds {found}; expected an array of names, [\"other.toml\"]");
    }
    let expected = expected_words(expected);
    format!("{}is {found}; expected {expected}", subject(path))
}

fn split_expected(message: &str) -> Option<(&str, &str)> {
    message.split_once(", expected ")
}

/// ` in [[sphere]]`, or nothing for the whole file.
fn place(path: Option<&[Step]>) -> String {
    match path {
        Some([Step::Key(table)]) => format!(" in [{table}]"),
        Some([Step::Key(table), Step::Index(_)]) => format!(" in [[{table}]]"),
        Some([.., Step::Key(key)]) => format!(" in `{key}`"),
        _ => String::new(),
    }
}

/// The key that a path ends in.
fn key(path: &[Step]) -> Option<&str> {
    path.iter().rev().find_map(|step| match step {
        Step::Key(key) => Some(key.as_str()),
        Step::Index(_) => None,
    })
}

fn subject(path: &[Step]) -> String {
    key(path).map_or(String::new(), |key| format!("`{key}` "))
}

fn of_key(path: &[Step]) -> String {
    key(path).map_or(String::new(), |key| format!(" of `{key}`"))
}

/// What was found, in words of TOML.
fn found_words(found: &str) -> String {
    let value = found.split('`').nth(1).unwrap_or_default();
    match found.split_whitespace().next().unwrap_or_default() {
        "integer" | "floating" => value.to_owned(),
        "boolean" => value.to_owned(),
        "string" => found.replacen("string", "the text", 1),
        "sequence" => "an array".to_owned(),
        "map" => "a table".to_owned(),
        _ => found.to_owned(),
    }
}

/// What was expected, in words of TOML.
fn expected_words(expected: &str) -> String {
    match expected {
        "f32" | "f64" => "a number".to_owned(),
        "u8" | "u32" | "u64" => "a whole number, 0 or greater, without a point".to_owned(),
        "i64" => "a whole number".to_owned(),
        "a boolean" => "true or false".to_owned(),
        "a string" => "a text in quotes".to_owned(),
        "a sequence" => "an array; tables of this kind have two brackets, [[ ]]".to_owned(),
        _ if expected.starts_with("struct") => "a table".to_owned(),
        _ if expected.starts_with("enum") => "a text in quotes".to_owned(),
        _ => expected.to_owned(),
    }
}
