//! `--watch`: renders again when the scene or a file it names changes.

use crate::{
    args::RenderArgs,
    errors::{Exit, Failure},
    render::render_once,
    run::print_line,
    say::say,
};
use notify::{Event, EventKind, RecursiveMode, Watcher};
use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    sync::mpsc::{Receiver, channel},
    time::{Duration, Instant},
};

/// Editors write a file in several steps: wait until nothing has changed for this long.
const QUIET: Duration = Duration::from_millis(100);
/// How deep included files are searched for the files they name.
const DEPTH: usize = 8;
/// Larger files are not searched for names.
const MAX_SEARCHED: u64 = 4 << 20;

/// Renders on every change until interrupted. An error is said and waits for the next change.
pub(crate) fn run(args: &RenderArgs) -> Result<(), Failure> {
    let fail = |error: notify::Error| Failure::new(Exit::Io, format!("--watch: {error}"));
    let (sender, receiver) = channel();
    let mut watcher = notify::recommended_watcher(sender).map_err(fail)?;
    let mut folders = BTreeSet::new();
    loop {
        let mut files = BTreeSet::new();
        add_named_files(&args.scene, DEPTH, &mut files);
        // Folders, not files: editors replace a file, and its watch with it.
        for folder in files.iter().filter_map(|file| file.parent()) {
            if folders.insert(folder.to_owned()) {
                watcher
                    .watch(folder, RecursiveMode::NonRecursive)
                    .map_err(fail)?;
            }
        }
        match render_once(args, Instant::now()) {
            Err(failure) if matches!(failure.exit, Exit::Usage | Exit::Interrupted) => {
                return Err(failure);
            }
            // The scene's folder does not exist: nothing would ever change.
            Err(failure) if folders.is_empty() => return Err(failure),
            Err(failure) => report(args, &failure),
            Ok(()) => {}
        }
        if !args.quiet {
            say(&format!(
                "watching {} for changes; Ctrl-C ends",
                args.scene.display()
            ));
        }
        wait_for_change(&receiver, &files, args)?;
    }
}

fn report(args: &RenderArgs, failure: &Failure) {
    if args.json {
        // Nobody is left to tell if this fails, too.
        let _ = print_line(&failure.to_json().to_string());
    }
    failure.print();
}

/// Returns when one of the files has changed and nothing has for a moment.
fn wait_for_change(
    receiver: &Receiver<notify::Result<Event>>,
    files: &BTreeSet<PathBuf>,
    args: &RenderArgs,
) -> Result<(), Failure> {
    let output = identity(&args.output);
    let is_ours = |event: &notify::Result<Event>| match event {
        Ok(event) => {
            !matches!(event.kind, EventKind::Access(_))
                && event
                    .paths
                    .iter()
                    .any(|path| Some(path) != output.as_ref() && concerns(path, files))
        }
        // The watcher has lost count: better once too often.
        Err(_) => true,
    };
    loop {
        let event = receiver
            .recv()
            .map_err(|_| Failure::new(Exit::Internal, "--watch: the watcher has ended"))?;
        if is_ours(&event) {
            break;
        }
    }
    // Only what concerns the picture counts: somebody may be reading in the same folder all the time.
    let mut last = Instant::now();
    while let Some(left) = QUIET.checked_sub(last.elapsed()) {
        match receiver.recv_timeout(left) {
            Ok(event) if is_ours(&event) => last = Instant::now(),
            Ok(_) => {}
            Err(_) => break,
        }
    }
    Ok(())
}

/// Named files, and those that are named without quotes: materials and buffers beside a model.
fn concerns(path: &Path, files: &BTreeSet<PathBuf>) -> bool {
    let extension = path
        .extension()
        .unwrap_or_default()
        .to_string_lossy()
        .to_ascii_lowercase();
    files.contains(path) || matches!(extension.as_str(), "mtl" | "bin")
}

/// Adds `path` and every existing file that it names in quotes, as TOML and JSON do.
fn add_named_files(path: &Path, depth: usize, files: &mut BTreeSet<PathBuf>) {
    let Some(identity) = identity(path) else {
        return;
    };
    let folder = identity.parent().unwrap_or(Path::new("/")).to_owned();
    if !files.insert(identity.clone()) || depth == 0 {
        return;
    }
    let small =
        fs::metadata(&identity).is_ok_and(|meta| meta.is_file() && meta.len() <= MAX_SEARCHED);
    let Some(text) = small.then(|| fs::read_to_string(&identity).ok()).flatten() else {
        return;
    };
    for name in text
        .split(['"', '\'', '\n'])
        .filter(|name| (1..=1024).contains(&name.len()))
    {
        let named = folder.join(name);
        if named.is_file() {
            add_named_files(&named, depth - 1, files);
        }
    }
}

/// The path with its folder resolved, as the watcher reports it; `None` if the folder does not exist.
fn identity(path: &Path) -> Option<PathBuf> {
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    Some(folder.canonicalize().ok()?.join(path.file_name()?))
}
