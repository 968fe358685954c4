//! Layout of `--help`.
//!
//! The texts after the options are wrapped at 100 columns in the source. On a narrower terminal,
//! wrapping the wrapped lines again would leave short lines in between. The lines of each paragraph
//! are therefore joined, and clap wraps them. Indented lines (examples and tables) stay as they
//! are, and fit into 80 columns.

use clap::{Arg, Command, CommandFactory};

use super::Cli;

/// Returns the command-line definition of the program.
pub fn program() -> Command {
    let names = |command: &Command| -> Vec<String> {
        command.get_subcommands().map(|one| one.get_name().to_owned()).collect()
    };
    let program = with_whole_paragraphs(Cli::command());
    let set_out = |command: Command| with_whole_paragraphs(command).mut_args(with_negative_numbers);
    names(&program).into_iter().fold(program, |program, name| program.mut_subcommand(name, set_out))
}

/// Lets an option take a negative number as its value. Otherwise clap reads it as another option.
fn with_negative_numbers(arg: Arg) -> Arg {
    let takes_value = arg.get_long().is_some()
        && arg.get_action().takes_values()
        && !arg.is_allow_hyphen_values_set();
    if takes_value { arg.allow_negative_numbers(true) } else { arg }
}

fn with_whole_paragraphs(command: Command) -> Command {
    let text = |text: Option<&clap::builder::StyledStr>| text.map(|text| joined(&text.to_string()));
    match (text(command.get_after_help()), text(command.get_after_long_help())) {
        (None, None) => command,
        (Some(short), None) => command.after_help(short),
        (None, Some(long)) => command.after_long_help(long),
        (Some(short), Some(long)) => command.after_help(short).after_long_help(long),
    }
}

/// Joins the lines of each paragraph into one.
fn joined(text: &str) -> String {
    let mut whole = String::new();
    let mut is_open = false;
    for line in text.lines() {
        let is_prose = !line.is_empty() && !line.starts_with(' ');
        match (is_open, is_prose) {
            (true, true) => whole.push(' '),
            _ if whole.is_empty() => {}
            _ => whole.push('\n'),
        }
        whole += line;
        is_open = is_prose;
    }
    whole
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paragraphs_are_joined_and_tables_are_not() {
        let text = "Examples:\n  a b\n  c d\n\nOne\ntwo\nthree.\n\n  x  1\n  y  2\nFour";
        let whole = "Examples:\n  a b\n  c d\n\nOne two three.\n\n  x  1\n  y  2\nFour";
        assert_eq!(joined(text), whole);
    }

    /// Checks that no line is longer, and that no table row or example is broken.
    #[test]
    fn help_fits_a_terminal_of_80_columns() {
        let mut program = program().term_width(80);
        program.build();
        let mut all = vec![program.clone()];
        all.extend(program.get_subcommands().cloned());
        for mut command in all {
            let name = command.get_name().to_owned();
            let shown = command.render_long_help().to_string();
            let is_short = |line: &str| line.chars().count() <= 80;
            assert!(shown.lines().all(is_short), "{name}: {shown}");
            let written = command.get_after_long_help().or(command.get_after_help());
            let written = written.map_or(String::new(), |text| text.to_string());
            for row in written.lines().filter(|line| line.starts_with(' ')) {
                assert!(shown.contains(row), "{name}: {row}");
            }
        }
    }
}
