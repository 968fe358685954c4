//! The `photosphere` program: commands, progress, error messages, exit codes.
//!
//! Only this module prints. Every command returns an `Exit` or an error. Both become the exit code
//! here, and an error is printed here, once.

#[allow(unreachable_pub, reason = "the arguments are read throughout this module")]
mod args;
mod bench;
mod cite;
mod compare;
mod converge;
mod convert;
mod crosscheck;
mod denoise;
mod doctor;
mod error;
mod excerpt;
mod exit;
mod file_columns;
mod generate;
mod import;
mod info;
mod interrupt;
pub mod keywords;
mod manual;
mod memory;
mod merge;
mod outputs;
mod packaging;
mod particle_file;
mod particle_info;
mod pick;
mod picture_file;
mod plan;
mod print;
mod progress;
mod recorded_outputs;
mod render;
mod reproduce;
mod resume;
mod scene_file;
mod system;
#[doc(hidden)]
pub mod testing;
mod trace;
mod usage;
mod verify;
mod watch;

use std::ffi::OsString;
use std::panic::catch_unwind;
use std::process::ExitCode;

use clap::FromArgMatches;

use crate::error::{Error, Result};
use crate::scene::keys;

use args::{Cli, Command};
use exit::Exit;

pub use packaging::Packaging;

/// Runs the command given by the program's arguments and prints its outcome.
///
/// The command runs in its own thread. This function returns when the command ends or a signal ends
/// it. The program then exits, whatever its other threads do.
pub fn main() -> ExitCode {
    main_with(std::env::args_os().collect(), Packaging::Program)
}

/// Runs the command given by these words, the first of which is the name of the program, as
/// [`main`] does: another front end that contains this program calls it instead.
pub fn main_with(words: Vec<OsString>, packaging: Packaging) -> ExitCode {
    system::set_arguments(words);
    interrupt::survive_file_size_limits();
    let left = exit::last_word();
    let work = move || {
        let exit = catch_unwind(|| match read() {
            Ok(cli) => {
                let outcome = system::prepare_threads().and_then(|()| run(&cli.command, packaging));
                exit_of(outcome, cli.command.json())
            }
            Err(answer) => usage::answer(answer),
        });
        exit::leave_with(exit.unwrap_or(Exit::Fault) as u8);
    };
    let command = std::thread::Builder::new().name("command".to_owned()).stack_size(STACK);
    match command.spawn(work) {
        Ok(_) => exit::end(left.recv().unwrap_or(Exit::Fault as u8)),
        Err(e) => exit_of(Err(Error::input(format!("cannot start a thread: {e}"))), false).into(),
    }
}

/// Stack size in bytes: the usual size for a program's main thread.
const STACK: usize = 8 << 20;

/// Returns the exit code for the outcome of a command, and prints its error.
fn exit_of(outcome: Result<Exit>, as_json: bool) -> Exit {
    outcome.unwrap_or_else(|e| {
        error::print(&e, as_json);
        Exit::of(&e)
    })
}

/// Parses the program's arguments.
fn read() -> std::result::Result<Cli, clap::Error> {
    parse(&mut args::help::program(), system::arguments())
}

/// Parses a command line, which begins with the name of the program.
fn parse(
    program: &mut clap::Command,
    words: impl Iterator<Item = OsString>,
) -> std::result::Result<Cli, clap::Error> {
    let mut matches = program.try_get_matches_from_mut(words)?;
    Cli::from_arg_matches_mut(&mut matches).map_err(|e| e.format(program))
}

fn run(command: &Command, packaging: Packaging) -> Result<Exit> {
    match command {
        Command::Render(args) => render::run(args),
        Command::Resume(args) => resume::run(args),
        Command::Merge(args) => merge::run(args),
        Command::Plan(args) => plan::run(args),
        Command::Crosscheck(args) => crosscheck::run(args),
        Command::Bench(args) => bench::run(args),
        Command::Compare(args) => compare::run(args),
        Command::Converge(args) => converge::run(args),
        Command::Convert(args) => convert::run(args),
        Command::Denoise(args) => denoise::run(args),
        Command::Reproduce(args) => reproduce::run(args),
        Command::Trace(args) => trace::run(args),
        Command::Verify(args) => verify::run(args),
        Command::Pick(args) => pick::run(args),
        Command::Generate(args) => generate::run(args),
        Command::Import(args) => import::run(args),
        Command::Info(args) => info::run(args),
        Command::Cite(args) => cite::run(args),
        Command::Doctor => doctor::run(packaging),
        Command::Schema => print::result(&format!("{:#}\n", keys::schema())).map(|()| Exit::Done),
        Command::Completions { shell } => manual::completions(*shell),
        Command::Man { command } => manual::page(command.as_deref()),
    }
}
