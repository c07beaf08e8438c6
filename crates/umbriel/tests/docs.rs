//! What the documents say is there: files behind links, functions in the files that are named, pictures that commands draw.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};
use tempfile::TempDir;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .canonicalize()
        .expect("the workspace is there")
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn lecture() -> String {
    read(&root().join("docs/lecture.md"))
}

/// All documents that readers are sent to.
fn documents() -> Vec<PathBuf> {
    let top = [
        "README.md",
        "ARCHITECTURE.md",
        "CHANGELOG.md",
        "scenes/README.md",
    ];
    let docs = fs::read_dir(root().join("docs")).expect("the folder can be read");
    let docs = docs.map(|entry| entry.expect("entries can be read").path());
    docs.filter(|path| path.extension().is_some_and(|e| e == "md"))
        .chain(top.map(|name| root().join(name)))
        .collect()
}

/// The text without fenced blocks, in one line.
fn prose(text: &str) -> String {
    let outside = text.split("```").step_by(2);
    let words = outside.flat_map(str::split_whitespace);
    words.collect::<Vec<_>>().join(" ")
}

/// The targets of links and pictures, with the text before each `](`.
fn links(prose: &str) -> impl Iterator<Item = (&str, &str)> {
    prose.match_indices("](").filter_map(|(at, mark)| {
        let target = &prose[at + mark.len()..];
        let end = target.find(')')?;
        Some((&prose[..at], &target[..end]))
    })
}

/// The anchors that headings have.
fn anchors(document: &str) -> BTreeSet<String> {
    let outside = document.split("```").step_by(2);
    let headings = outside
        .flat_map(str::lines)
        .filter(|line| line.starts_with('#'));
    let anchor = |line: &str| {
        let text = line.trim_start_matches('#').trim().to_lowercase();
        let kept = text
            .chars()
            .filter(|c| c.is_alphanumeric() || " -_".contains(*c));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect()
    };
    headings.map(anchor).collect()
}

#[test]
fn links_lead_somewhere() {
    let mut faults = Vec::new();
    let mut found = 0;
    for document in documents() {
        let text = read(&document);
        for (_, target) in links(&prose(&text)) {
            if target.contains("://") {
                continue;
            }
            found += 1;
            let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
            let folder = document.parent().expect("files have folders");
            let path = if file.is_empty() {
                document.clone()
            } else {
                folder.join(file)
            };
            let is_there =
                path.exists() && (anchor.is_empty() || anchors(&read(&path)).contains(anchor));
            if !is_there {
                faults.push(format!("{}: {target}", document.display()));
            }
        }
    }
    assert!(found > 300, "only {found} links found");
    assert!(faults.is_empty(), "{faults:#?}");
}

/// The names in backticks at the end of `text`: of "`a`, `b` and `c`" all three.
fn names_before(text: &str) -> Vec<&str> {
    let mut names = Vec::new();
    let mut rest = text.strip_suffix(" in [").unwrap_or_default();
    while let Some((before, name)) = rest.strip_suffix('`').and_then(|t| t.rsplit_once('`')) {
        names.push(name);
        let more = [", ", " and "]
            .iter()
            .find_map(|word| before.strip_suffix(word));
        rest = more.unwrap_or_default();
    }
    names
}

/// Whether a source defines a name, of which a path's last part counts.
fn defines(source: &str, name: &str) -> bool {
    let name = name.rsplit("::").next().unwrap_or(name);
    ["fn", "struct", "enum", "trait"].iter().any(|kind| {
        let start = format!("{kind} {name}");
        let ends = |rest: &str| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_');
        source.split(&start).skip(1).any(ends)
    })
}

/// "`name` in [`file.rs`](path)" is a promise.
#[test]
fn functions_are_where_documents_say() {
    let mut faults = Vec::new();
    let mut found = 0;
    for document in documents() {
        let prose = prose(&read(&document));
        for (before, target) in links(&prose).filter(|(_, target)| target.ends_with(".rs")) {
            let Some(text) = before.strip_suffix('`').and_then(|t| t.rsplit_once('`')) else {
                continue;
            };
            let source = read(&document.parent().expect("files have folders").join(target));
            for name in names_before(text.0) {
                found += 1;
                if !defines(&source, name) {
                    faults.push(format!("{}: no {name} in {target}", document.display()));
                }
            }
        }
    }
    assert!(found > 100, "only {found} functions found");
    assert!(faults.is_empty(), "{faults:#?}");
}

/// The commands of the lecture, word by word.
fn commands(text: &str) -> Vec<Vec<&str>> {
    let lines = text.lines().filter(|line| line.starts_with("umbriel "));
    lines
        .map(|line| line.split_whitespace().collect())
        .collect()
}

#[test]
fn every_picture_of_the_lecture_has_its_command() {
    let text = lecture();
    let drawn: BTreeSet<&str> = commands(&text)
        .iter()
        .filter_map(|words| words.last().copied())
        .collect();
    let prose = prose(&text);
    let shown: BTreeSet<&str> = links(&prose)
        .filter_map(|(_, target)| target.strip_prefix("pictures/"))
        .collect();
    let missing: Vec<_> = shown.difference(&drawn).collect();
    assert!(shown.len() > 40 && missing.is_empty(), "{missing:?}");
}

/// Sets an option, which may be there already.
fn set(words: &mut Vec<String>, option: &str, value: &str) {
    match words.iter().position(|word| word == option) {
        Some(at) => words[at + 1] = value.to_owned(),
        None => words.extend([option.to_owned(), value.to_owned()]),
    }
}

/// The same command for a tiny picture in a folder; and the file that it writes, if any.
fn made_tiny(words: &[&str], folder: &Path) -> (Vec<String>, Option<PathBuf>) {
    let mut tiny: Vec<String> = words[1..].iter().map(|&word| word.to_owned()).collect();
    let output = ["-o", "--plot"]
        .iter()
        .find(|option| words.contains(option));
    let file = output.map(|option| {
        let file = folder.join(words.last().expect("commands have words"));
        set(&mut tiny, option, &file.to_string_lossy());
        file
    });
    // A pixel that is to be explained must stay in the picture.
    if words[1] != "explain" {
        set(&mut tiny, "-r", "24x18");
    }
    if words[1] == "tune" {
        set(&mut tiny, "--texels", "16k");
        set(&mut tiny, "--cameras", "1");
    } else {
        set(&mut tiny, "--shadow-map-size", "64");
    }
    if words[1] == "render" {
        set(&mut tiny, "-s", "1");
    }
    if words.contains(&"map-size") {
        set(&mut tiny, "--values", "64,128");
    }
    (tiny, file)
}

/// Runs the program from the repository's root.
fn run(words: &[String]) -> Output {
    let mut program = Command::new(env!("CARGO_BIN_EXE_umbriel"));
    let ran = program.current_dir(root()).args(words).output();
    ran.expect("the program starts")
}

/// Every command of the lecture runs from the repository's root and writes its picture.
#[test]
fn commands_of_the_lecture_run() {
    let folder = TempDir::new().expect("a folder can be made");
    let text = lecture();
    let commands = commands(&text);
    assert!(commands.len() > 40, "only {} commands", commands.len());
    for words in commands {
        let (tiny, file) = made_tiny(&words, folder.path());
        let ran = run(&tiny);
        let said = String::from_utf8_lossy(&ran.stderr);
        assert!(ran.status.success(), "{tiny:?}: {said}");
        assert!(file.is_none_or(|file| file.exists()), "{tiny:?}");
    }
}
