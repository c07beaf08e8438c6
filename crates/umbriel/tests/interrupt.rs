//! Ctrl-C saves the picture so far; `--watch` renders again.
#![cfg(unix)]

mod support;

use std::{
    process::{Child, Command, ExitStatus, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};
use support::{Folder, SCENE};

/// A program that does not outlive its test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Its output goes nowhere unless asked for: a pipe held open would hang whoever waits for the tests.
fn start(command: &mut Command) -> Running {
    Running(command.stderr(Stdio::null()).spawn().unwrap())
}

fn interrupt(running: &Running) {
    let id = running.0.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &id])
            .status()
            .unwrap()
            .success()
    );
}

/// Waits at most a minute; a busy machine may be slow.
fn wait(running: &mut Running) -> ExitStatus {
    wait_until("the program ends", || running.0.try_wait().unwrap())
}

fn wait_until<T>(what: &str, mut done: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(60) {
        if let Some(result) = done() {
            return result;
        }
        sleep(Duration::from_millis(20));
    }
    panic!("waited a minute until {what}");
}

#[test]
fn the_picture_so_far_is_saved() {
    let folder = Folder::new();
    folder.write("a.png", "old");
    let mut command = folder.command("render scene.toml -o a.png -r 2000x2000 --spp 1000 -t 1");
    let mut child = start(&mut command);
    sleep(Duration::from_millis(1500));
    interrupt(&child);
    let stopped = Instant::now();
    assert_eq!(wait(&mut child).code(), Some(130));
    assert!(
        stopped.elapsed() < Duration::from_secs(10),
        "{:?}",
        stopped.elapsed()
    );
    assert!(folder.read("a.png").starts_with(b"\x89PNG"));
    let object = folder.ok("diff a.png a.png --json").json();
    assert_eq!(object["pixels"], 4_000_000);
    assert_eq!(folder.names(), ["a.png", "scene.toml"]);
}

#[test]
fn watch_renders_again_and_survives_errors() {
    let folder = Folder::new();
    let mut child = start(&mut folder.command("render scene.toml -o a.png --watch -q"));
    wait_until("the first picture is there", || {
        folder.path("a.png").exists().then_some(())
    });
    let first = folder.read("a.png");
    // The picture is renamed into place just before the program begins to wait.
    sleep(Duration::from_millis(300));
    folder.write("scene.toml", "wrong");
    sleep(Duration::from_millis(500));
    folder.write("scene.toml", &SCENE.replace("radius = 1", "radius = 0.5"));
    wait_until("the picture changes", || {
        (folder.read("a.png") != first).then_some(())
    });
    interrupt(&child);
    assert_eq!(wait(&mut child).code(), Some(130));
}

/// A reader that goes away is no error.
#[test]
fn a_closed_pipe_is_quiet() {
    let folder = Folder::new();
    let mut child = start(folder.command("completions bash").stdout(Stdio::piped()));
    drop(child.0.stdout.take());
    assert_eq!(wait(&mut child).code(), Some(0));
}
