//! `umbriel completions` and `umbriel man`: made from the command line's own definition.

use crate::{args::Cli, errors::Failure, run::print_bytes};
use clap::CommandFactory;
use clap_complete::Shell;
use clap_mangen::Man;
use std::{io, path::Path};
use umbriel_formats::{FileError, write_file};

/// Prints the completion script of a shell.
pub(crate) fn completions(shell: Shell) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "umbriel", &mut script);
    print_bytes(&script)
}

/// Prints the manual page of the program, or writes it and those of the commands into a folder.
pub(crate) fn man(folder: Option<&Path>) -> Result<(), Failure> {
    let mut command = Cli::command();
    // Gives the commands their full names, "umbriel-render".
    command.build();
    let Some(folder) = folder else {
        return print_bytes(&page(command)?);
    };
    if !folder.is_dir() {
        return Err(FileError::io(folder, &io::Error::other("is no folder; make it first")).into());
    }
    for sub in command
        .get_subcommands()
        .filter(|sub| sub.get_name() != "help")
    {
        let path = folder.join(format!("umbriel-{}.1", sub.get_name()));
        write_file(&path, &page(sub.clone())?)?;
    }
    Ok(write_file(&folder.join("umbriel.1"), &page(command)?)?)
}

fn page(command: clap::Command) -> Result<Vec<u8>, Failure> {
    let mut page = Vec::new();
    let made = Man::new(command).render(&mut page);
    made.map_err(|error| Failure::new(crate::errors::Exit::Internal, error.to_string()))?;
    Ok(page)
}
