//! `--method path`: limits, what they report, and pictures that are saved while they grow.
#![cfg(unix)]

mod support;

use std::{
    process::{Command, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};
use support::{Folder, SCENE};

/// What a picture used, from its JSON.
fn used(folder: &Folder, words: &str) -> serde_json::Value {
    let words = format!("render scene.toml -o a.exr -m path --json {words}");
    folder.ok(&words).json()["used"].clone()
}

#[test]
fn the_first_limit_ends_the_picture() {
    let folder = Folder::new();
    let spp = used(&folder, "--spp 5 --time 1000 --noise 0.0001");
    assert_eq!(spp["ended_by"], "spp");
    assert_eq!(
        (&spp["least_spp"], &spp["most_spp"]),
        (&5.into(), &5.into())
    );
    let time = used(&folder, "--time 0.2");
    assert_eq!(time["ended_by"], "time");
    let noise = used(&folder, "--time 1000 --noise 0.2");
    assert_eq!(noise["ended_by"], "noise");
    assert!(noise["noise"].as_f64().unwrap() < 0.22, "{noise}");
    // Without a limit, 64 samples; a scene file may say something else.
    assert_eq!(used(&folder, "")["spp"], 64.0);
    assert_eq!(used(&folder, "-D render.spp=3")["spp"], 3.0);
    let said = folder.ok("render scene.toml -o a.png -m path --spp 2").err;
    assert!(said.contains("path 2 spp, noise 0."), "{said}");
}

#[test]
fn layers_of_samples() {
    let folder = Folder::new();
    folder.ok("render scene.toml -o a.exr -m path --spp 2 --aov all");
    let bytes = folder.read("a.exr");
    for name in ["direct.R", "indirect.B", "sampleCount", "variance", "Z"] {
        let found = bytes.windows(name.len()).any(|w| w == name.as_bytes());
        assert!(found, "{name}");
    }
    folder.ok("render scene.toml -o b.exr --aov all");
    let bytes = folder.read("b.exr");
    assert!(!bytes.windows(8).any(|w| w == b"direct.R"));
}

/// Starts a picture that would take hours, and interrupts it as soon as `ready`; the exit code, and what it said.
fn interrupt_when(folder: &Folder, words: &str, ready: impl Fn() -> bool) -> (Option<i32>, String) {
    let mut command = folder.command(&format!(
        "render scene.toml -o a.png -m path -r 160x120 --spp 65536 {words}"
    ));
    let child = command.stderr(Stdio::piped()).spawn().unwrap();
    let start = Instant::now();
    while !ready() && start.elapsed() < Duration::from_secs(60) {
        sleep(Duration::from_millis(20));
    }
    let id = child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &id])
            .status()
            .unwrap()
            .success()
    );
    let output = child.wait_with_output().unwrap();
    (
        output.status.code(),
        String::from_utf8(output.stderr).unwrap(),
    )
}

#[test]
fn an_interrupt_saves_the_picture_so_far() {
    let folder = Folder::new();
    let start = Instant::now();
    let ready = || start.elapsed() > Duration::from_secs(2);
    let (code, said) = interrupt_when(&folder, "", ready);
    assert_eq!(code, Some(130), "{said}");
    assert!(said.contains("interrupted: saved a.png"), "{said}");
    assert!(folder.read("a.png").starts_with(b"\x89PNG"));
    assert_eq!(folder.names(), ["a.png", "scene.toml"]);
}

#[test]
fn the_picture_is_saved_while_it_grows() {
    let folder = Folder::new();
    folder.write("a.png", "old");
    // Whatever is there at any moment is a whole file.
    let ready = || {
        let bytes = folder.read("a.png");
        let whole = bytes.starts_with(b"\x89PNG") && bytes.ends_with(b"IEND\xaeB`\x82");
        assert!(whole || bytes == b"old");
        whole
    };
    let (code, said) = interrupt_when(&folder, "--save-every 0.1", ready);
    assert_eq!(code, Some(130), "{said}");
    assert!(said.contains("saved a.png so far: "), "{said}");
    assert_eq!(folder.names(), ["a.png", "scene.toml"]);
}

/// A disk that fills up, or here a limit of the size of files: the old picture stays, rendering goes on, and the end says why.
#[test]
fn a_full_disk_loses_nothing() {
    let folder = Folder::new();
    folder.write("scene.toml", &SCENE.replace("[64, 48]", "[320, 240]"));
    folder.write("a.png", "old");
    let program = env!("CARGO_BIN_EXE_umbriel");
    let words = "render scene.toml -o a.png -m path --time 1 --save-every 0.1";
    let script = format!("trap '' XFSZ; ulimit -f 8; exec '{program}' {words}");
    let output = Command::new("sh")
        .args(["-c", &script])
        .current_dir(folder.path(""))
        .output()
        .unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(4), "{said}");
    assert!(said.contains("warning: --save-every: a.png: "), "{said}");
    assert!(said.contains("rendering goes on"), "{said}");
    let last = said.lines().last().unwrap();
    assert!(
        last.starts_with("error: a.png: ") && last.contains("nothing was changed"),
        "{said}"
    );
    assert_eq!(folder.read("a.png"), b"old");
    assert_eq!(folder.names(), ["a.png", "scene.toml"]);
}
