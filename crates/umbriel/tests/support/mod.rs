//! Runs the program in a folder of its own.
#![allow(dead_code, reason = "each test file uses a part of it")]

use serde_json::Value;
use std::{
    fs,
    path::PathBuf,
    process::{Command, Output},
};
use tempfile::TempDir;

/// A mirror ball over a checkered floor.
pub(crate) const SCENE: &str = r#"
[render]
resolution = [64, 48]

[environment]
zenith = [0.2, 0.4, 0.9]
nadir = [0.8, 0.8, 0.8]

[[camera]]
name = "front"
eye = [0, 1, 5]
look_at = [0, 0.5, 0]
fov = 40

[[camera]]
name = "top"
eye = [0, 6, 0.1]
look_at = [0, 0, 0]
fov = 40

[[checker]]
name = "squares"
even = [1, 1, 0]
odd = [1, 0, 0]

[[material]]
name = "floor"
base_color_texture = "squares"

[[material]]
name = "mirror"
metallic = 1
roughness = 0

[[sphere]]
center = [0, 1, 0]
radius = 1
material = "mirror"

[[plane]]
point = [0, 0, 0]
normal = [0, 1, 0]
material = "floor"

[[point_light]]
position = [3, 5, 4]
intensity = [60, 60, 60]
"#;

/// A folder with `scene.toml` in it.
pub(crate) struct Folder(TempDir);

/// What a run gave.
#[derive(Debug)]
pub(crate) struct Ran {
    pub(crate) code: Option<i32>,
    pub(crate) out: Vec<u8>,
    pub(crate) err: String,
}

impl Folder {
    pub(crate) fn new() -> Self {
        let folder = Self(TempDir::new().unwrap());
        folder.write("scene.toml", SCENE);
        folder
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }

    /// Sorted names of everything in the folder.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> = entries
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    /// The program in this folder, with words as its arguments.
    pub(crate) fn command(&self, words: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_umbriel"));
        command
            .current_dir(self.0.path())
            .args(words.split_whitespace());
        command
    }

    pub(crate) fn run(&self, words: &str) -> Ran {
        Ran::from(self.command(words).output().unwrap())
    }

    /// Runs what must succeed.
    pub(crate) fn ok(&self, words: &str) -> Ran {
        let ran = self.run(words);
        assert_eq!(ran.code, Some(0), "{words}: {}", ran.err);
        ran
    }

    /// Runs what must fail with a code and one line that holds all of `parts`.
    pub(crate) fn fails(&self, words: &str, code: i32, parts: &[&str]) {
        let ran = self.run(words);
        assert_eq!(ran.code, Some(code), "{words}: {}", ran.err);
        let line = ran
            .err
            .lines()
            .find(|line| line.starts_with("error: "))
            .expect("an error line");
        for part in parts {
            assert!(line.contains(part), "{words}: no {part:?} in {line}");
        }
        assert!(ran.out.is_empty(), "{words}: nothing on standard output");
    }
}

impl Ran {
    pub(crate) fn json(&self) -> Value {
        serde_json::from_slice(&self.out).unwrap()
    }

    pub(crate) fn text(&self) -> String {
        String::from_utf8(self.out.clone()).unwrap()
    }
}

impl From<Output> for Ran {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code(),
            out: output.stdout,
            err: String::from_utf8(output.stderr).unwrap(),
        }
    }
}
