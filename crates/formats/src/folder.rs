//! THE rule for every name of a file inside a file: it stays in the folder of the file that names it.

use std::{
    fmt::Write as _,
    path::{Component, Path, PathBuf},
};

/// How a name is written in the file that holds it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NameSyntax {
    /// Percent-encoded, as in glTF; decoded once.
    Uri,
    /// As it is.
    Plain,
}

/// Why a name was refused or has no file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum NameError {
    /// The rule forbids it; the file was not touched.
    Forbidden(String),
    /// There is no such file.
    Missing(String),
}

impl NameError {
    /// The sentence to show, to be read after the place.
    pub(crate) fn message(&self) -> &str {
        let (Self::Forbidden(message) | Self::Missing(message)) = self;
        message
    }
}

/// The regular file that `name`, found in `base_file`, stands for.
///
/// Relative names only, without `..`; symbolic links must not leave the folder of `base_file`.
/// Environment variables, `~` and the like are never expanded.
pub(crate) fn resolve(
    base_file: &Path,
    name: &str,
    syntax: NameSyntax,
) -> Result<PathBuf, NameError> {
    let forbid = |why: &str| NameError::Forbidden(format!("\"{}\" {why}", shorten(name)));
    let decoded = match syntax {
        NameSyntax::Uri => decode_percent(name).ok_or_else(|| forbid("is not a valid URI"))?,
        NameSyntax::Plain => name.to_owned(),
    };
    check_name(&decoded).map_err(forbid)?;

    let folder = match base_file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let path = folder.join(&decoded);
    let missing =
        |error: std::io::Error| NameError::Missing(format!("\"{}\": {error}", shorten(name)));
    let canonical = path.canonicalize().map_err(missing)?;
    let root = folder.canonicalize().map_err(missing)?;
    if !canonical.starts_with(&root) {
        return Err(forbid(
            "leaves the folder through a link; files outside the folder are not read",
        ));
    }
    if !canonical.is_file() {
        return Err(forbid("is not a regular file"));
    }
    Ok(path)
}

/// The part of the rule that needs no file system.
fn check_name(name: &str) -> Result<(), &'static str> {
    if name.is_empty() {
        return Err("names no file");
    }
    let lower = name.to_ascii_lowercase();
    if lower.starts_with("http:") || lower.starts_with("https:") {
        return Err("is remote; remote URIs are not read");
    }
    if name.contains('\0') {
        return Err("contains a NUL byte");
    }
    if name.contains('\\') {
        return Err("contains a backslash; expected / between folders");
    }
    // A scheme or a drive letter: letters and a colon before the first slash.
    let first = name.split('/').next().unwrap_or_default();
    if first.contains(':') {
        return Err("has a scheme or drive; expected a relative name");
    }
    let mut components = Path::new(name).components();
    if name.starts_with('/')
        || !components.clone().all(|c| {
            matches!(
                c,
                Component::Normal(_) | Component::CurDir | Component::ParentDir
            )
        })
    {
        return Err("is absolute; expected a relative name");
    }
    if components.any(|c| c == Component::ParentDir) {
        return Err("leaves the folder of the file; `..` is not followed");
    }
    Ok(())
}

/// Decodes `%41` to `A`, once; `None` for a wrong escape or a result that is not UTF-8.
fn decode_percent(uri: &str) -> Option<String> {
    let mut out = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&byte, tail)) = rest.split_first() {
        if byte == b'%' {
            let hex = std::str::from_utf8(tail.get(..2)?).ok()?;
            if !hex.bytes().all(|b| b.is_ascii_hexdigit()) {
                return None;
            }
            out.push(u8::from_str_radix(hex, 16).ok()?);
            rest = &tail[2..];
        } else {
            out.push(byte);
            rest = tail;
        }
    }
    String::from_utf8(out).ok()
}

/// At most 80 characters of a name, control characters escaped, for messages.
pub(crate) fn shorten(name: &str) -> String {
    let mut out = String::new();
    for c in name.chars().take(80) {
        if c.is_control() {
            let _ = write!(out, "{}", c.escape_default());
        } else {
            out.push(c);
        }
    }
    if name.chars().nth(80).is_some() {
        out.push('…');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn names_stay_in_the_folder() {
        let root = tempfile::tempdir().unwrap();
        let inside = root.path().join("inside");
        fs::create_dir_all(inside.join("textures")).unwrap();
        fs::write(root.path().join("secret"), "x").unwrap();
        fs::write(inside.join("textures/A..B.png"), "x").unwrap();
        let base = inside.join("scene.gltf");
        for name in [
            "../secret",
            "textures/../../secret",
            "%2e%2e/secret",
            "%2E%2e%2fsecret",
            "/etc/passwd",
            "file:///etc/passwd",
            "http://example.org/a.png",
            "HTTPS://example.org/a.png",
            "C:\\x",
            "C:/x",
            "a%00b",
            "a\\b",
            "",
            "a%zz",
            "textures",
        ] {
            let found = resolve(&base, name, NameSyntax::Uri);
            assert!(
                matches!(found, Err(NameError::Forbidden(_))),
                "{name}: {found:?}"
            );
        }
        for name in ["`id`", "$(id)", "~/x", "%252e%252e/secret"] {
            let found = resolve(&base, name, NameSyntax::Uri);
            assert!(
                matches!(found, Err(NameError::Missing(_))),
                "{name}: {found:?}"
            );
        }
        assert!(resolve(&base, "textures/A%2E.B.png", NameSyntax::Uri).is_ok());
        assert!(resolve(&base, "./textures/A..B.png", NameSyntax::Plain).is_ok());
    }

    #[cfg(unix)]
    #[test]
    fn links_do_not_leave_the_folder() {
        let root = tempfile::tempdir().unwrap();
        let inside = root.path().join("inside");
        fs::create_dir(&inside).unwrap();
        fs::write(root.path().join("secret"), "x").unwrap();
        std::os::unix::fs::symlink("../secret", inside.join("link")).unwrap();
        let found = resolve(&inside.join("scene.gltf"), "link", NameSyntax::Plain);
        assert!(matches!(found, Err(NameError::Forbidden(_))), "{found:?}");
    }
}
