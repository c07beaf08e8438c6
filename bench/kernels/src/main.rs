//! Umbriel's mesh kernels and their peers on the same rays, in turn, checked hit for hit.

mod args;
mod check;
#[cfg(feature = "rust-peers")]
mod crates;
mod embree;
mod mesh;
mod peers;
mod picture;
mod rays;
mod report;
mod run;
mod timing;

use args::{Args, HELP};
use std::process::ExitCode;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match words.first().map(String::as_str) {
        Some("--help" | "-h") => println!("{HELP}"),
        Some("--list") => peers::PEERS.iter().for_each(|peer| println!("{}", peer.name)),
        _ => {
            if let Err(error) = Args::parse(words.into_iter()).and_then(|args| run::all(&args)) {
                eprintln!("error: {error}");
                return ExitCode::FAILURE;
            }
        }
    }
    ExitCode::SUCCESS
}
