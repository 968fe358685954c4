//! Generates shell completions and manual pages.

use std::path::Path;

use crate::error::{Error, Result};

use super::args::help::program;
use super::exit::Exit;
use super::print;

/// Prints the completion script for a shell.
pub(super) fn completions(shell: clap_complete::Shell) -> Result<Exit> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut program(), "photosphere", &mut script);
    print::result(&String::from_utf8_lossy(&script))?;
    Ok(Exit::Done)
}

/// Prints the manual page of the program or of one of its commands.
///
/// # Errors
/// If there is no such command.
pub(super) fn page(command: Option<&str>) -> Result<Exit> {
    let mut program = program();
    // Sets the names under which `man` looks for the commands: photosphere-render.
    program.build();
    let subject = match command {
        None => program,
        Some(name) => named(&program, name)?,
    };
    let mut page = Vec::new();
    clap_mangen::Man::new(subject)
        .render(&mut page)
        .map_err(|e| Error::file("write", Path::new("the manual page"), e))?;
    print::result(&String::from_utf8_lossy(&page))?;
    Ok(Exit::Done)
}

fn named(program: &clap::Command, name: &str) -> Result<clap::Command> {
    let found = program.find_subcommand(name).ok_or_else(|| {
        Error::input(format!("there is no command `{name}`"))
            .with_help("photosphere --help lists the commands")
    })?;
    Ok(found.clone())
}
