//! House rules that no compiler checks: module headings, layers, names, sources, length.

use std::{
    fs,
    path::{Path, PathBuf},
};

/// A file's path from the workspace's root, and its text.
struct Source {
    path: String,
    text: String,
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .canonicalize()
        .expect("the workspace is there")
}

fn collect(folder: &Path, files: &mut Vec<Source>) {
    for entry in fs::read_dir(folder).expect("folders can be read") {
        let path = entry.expect("entries can be read").path();
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|e| e == "rs") {
            let text = fs::read_to_string(&path).expect("sources are text");
            let path = path
                .strip_prefix(root())
                .expect("below the root")
                .to_string_lossy()
                .replace('\\', "/");
            files.push(Source { path, text });
        }
    }
}

/// All sources of the crates; tests and examples apart.
fn sources() -> Vec<Source> {
    let mut files = Vec::new();
    for name in ["kernels", "render", "formats", "umbriel"] {
        collect(&root().join("crates").join(name).join("src"), &mut files);
    }
    assert!(files.len() > 80, "only {} sources found", files.len());
    files
}

/// Fails with all faults that `fault` finds, each with its file.
fn check(fault: impl Fn(&Source) -> Option<String>) {
    let faults: Vec<String> = sources()
        .iter()
        .filter_map(|s| fault(s).map(|what| format!("{}: {what}", s.path)))
        .collect();
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn every_module_says_what_it_is() {
    check(|s| (!s.text.starts_with("//!")).then(|| "does not begin with `//!`".to_owned()));
}

#[test]
fn no_file_without_a_name_of_its_own() {
    let forbidden = ["utils.rs", "common.rs", "helpers.rs", "types.rs", "misc.rs"];
    check(|s| {
        forbidden
            .iter()
            .find(|name| s.path.ends_with(&format!("/{name}")))
            .map(|name| format!("{name} says nothing"))
    });
}

#[test]
fn no_unsafe() {
    // In two parts, so that this file does not find itself.
    let word = concat!("uns", "afe ");
    check(|s| {
        s.text
            .lines()
            .find(|line| !line.trim_start().starts_with("//") && line.contains(word))
            .map(str::to_owned)
    });
}

#[test]
fn files_are_short() {
    check(|s| {
        let lines = s.text.lines().count();
        (lines > 400).then(|| format!("{lines} lines; find the part that wants a file of its own"))
    });
}

/// Tells whether code, comments apart, has a word.
fn has_word(source: &Source, word: &str) -> bool {
    let part_of_name = |c: char| c.is_alphanumeric() || c == '_';
    let code = source
        .text
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"));
    code.flat_map(|line| line.split(|c| !part_of_name(c)))
        .any(|found| found == word)
}

/// A crate knows the crates below it alone, and the scene model knows no algorithm.
#[test]
fn imports_point_down() {
    let crates = [
        ("kernels", vec!["umbriel_render", "umbriel_formats"]),
        ("render", vec!["umbriel_formats"]),
    ];
    let algorithms = [
        "trace",
        "direct",
        "ray_cast",
        "whitted",
        "adaptive",
        "scene_bvh",
        "SceneBvh",
        "Tracer",
    ];
    let model = [
        "scene",
        "mesh",
        "material",
        "light",
        "camera",
        "texture",
        "environment",
        "image",
        "film",
        "ids",
        "settings",
    ];
    check(|s| {
        let above = crates
            .iter()
            .filter(|(name, _)| s.path.starts_with(&format!("crates/{name}/")))
            .flat_map(|(_, above)| above)
            .find(|word| has_word(s, word));
        let in_model = model
            .iter()
            .any(|name| s.path == format!("crates/render/src/{name}.rs"));
        let algorithm = algorithms.iter().find(|word| in_model && has_word(s, word));
        above.or(algorithm).map(|word| format!("knows {word}"))
    });
}

/// Functions that put a formula from the literature into code.
fn is_slide(line: &str) -> bool {
    let visible = ["pub(crate) ", "pub(super) ", "pub "];
    let code = line.trim_start();
    let code = visible
        .iter()
        .find_map(|v| code.strip_prefix(v))
        .unwrap_or(code);
    let name = code.strip_prefix("fn ").unwrap_or_default();
    let kinds = [
        "intersect_",
        "eval_ggx",
        "eval_diffuse",
        "fresnel_",
        "tonemap_",
        "sample_pixel",
        "terminator_",
        "filter_",
        "draw_triangle",
        "chebyshev",
        "solid_angle",
        "offset_origin",
    ];
    kinds.iter().any(|kind| name.starts_with(kind))
}

/// Every formula names where it comes from, or the functions that it is made of.
#[test]
fn slides_name_their_source() {
    check(|s| {
        if s.path.starts_with("crates/umbriel/") || s.path.starts_with("crates/formats/") {
            return None;
        }
        let mut comment = String::new();
        for line in s.text.lines() {
            if let Some(words) = line.trim_start().strip_prefix("///") {
                comment.push_str(words);
            } else if is_slide(line) && !comment.contains("Source:") && !comment.contains("[`") {
                return Some(format!("{line} has no `Source:`"));
            } else if !line.trim_start().starts_with("#[") {
                comment.clear();
            }
        }
        None
    });
}
