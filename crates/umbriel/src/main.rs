//! The program: `umbriel render`, `compare`, `tune`, `info`, `diff` and helpers around them.

mod args;
mod camera;
mod compare;
mod completions;
mod diff;
mod errors;
mod explain;
mod growing;
mod info;
mod interrupt;
mod output;
mod plan;
mod progress;
mod render;
mod run;
mod say;
mod shadow_maps;
mod sheet;
mod show;
mod summary;
mod svg;
mod truth_args;
mod tune;
mod values;
mod watch;

fn main() -> std::process::ExitCode {
    run::run()
}
