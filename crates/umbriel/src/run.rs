//! From the command line to an exit code.

use crate::{
    args::{Cli, Command},
    compare, completions, diff,
    errors::{Exit, Failure},
    explain, info, render, tune,
};
use clap::Parser;
use std::{
    io::{self, Write},
    panic::{self, AssertUnwindSafe},
    process::ExitCode,
    sync::{Mutex, PoisonError},
    time::Instant,
};

/// Runs the program.
pub(crate) fn run() -> ExitCode {
    let start = Instant::now();
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return refuse(&error),
    };
    let json = cli.command.json();
    let result = catch(|| dispatch(cli.command, start));
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            if json && !failure.message.is_empty() {
                // There is nobody left to tell if this fails, too.
                let _ = print_line(&failure.to_json().to_string());
            }
            failure.print();
            ExitCode::from(failure.exit as u8)
        }
    }
}

/// Writes one line of results to standard output; a reader that has gone is no error.
pub(crate) fn print_line(line: &str) -> Result<(), Failure> {
    print_bytes(format!("{line}\n").as_bytes())
}

/// Writes results to standard output; a reader that has gone is no error.
pub(crate) fn print_bytes(bytes: &[u8]) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::new(Exit::Io, format!("standard output: {error}")))
        }
        _ => Ok(()),
    }
}

fn dispatch(command: Command, start: Instant) -> Result<(), Failure> {
    match command {
        Command::Render(args) => render::run(&args, start),
        Command::Info(args) => info::run(&args),
        Command::Compare(args) => compare::run(&args, start),
        Command::Sweep(args) => compare::sweep(&args, start),
        Command::Tune(args) => tune::run(&args, start),
        Command::Explain(args) => explain::run(&args, start),
        Command::Diff(args) => diff::run(&args),
        Command::Schema => print_line(umbriel_formats::scene_schema().trim_end()),
        Command::Completions { shell } => completions::completions(shell),
        Command::Man { folder } => completions::man(folder.as_deref()),
    }
}

/// Help, version, or what is wrong with the command line, in clap's words.
fn refuse(error: &clap::Error) -> ExitCode {
    // A closed terminal or pipe is no reason to fail.
    let _ = error.print();
    if error.use_stderr() && std::env::args_os().any(|arg| arg == "--json") {
        // Which arguments are missing stands in the lines up to the first empty one.
        let text = error.to_string();
        let lines: Vec<&str> = text
            .lines()
            .map(str::trim)
            .take_while(|line| !line.is_empty())
            .collect();
        let line = lines.join(" ");
        let line = line.trim_start_matches("error: ");
        let _ = print_line(&Failure::usage(line).to_json().to_string());
    }
    ExitCode::from(error.exit_code() as u8)
}

/// Turns a panic, in this thread or a worker, into an internal error that says where it was.
fn catch(work: impl FnOnce() -> Result<(), Failure>) -> Result<(), Failure> {
    static PANIC: Mutex<String> = Mutex::new(String::new());
    panic::set_hook(Box::new(|info| {
        let mut first = PANIC.lock().unwrap_or_else(PoisonError::into_inner);
        if first.is_empty() {
            *first = info.to_string().replace('\n', " ");
        }
    }));
    panic::catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|_| {
        let first = PANIC.lock().unwrap_or_else(PoisonError::into_inner);
        let message = format!("internal error, please report it with the scene: {first}");
        Err(Failure::new(Exit::Internal, message))
    })
}
