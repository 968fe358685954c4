//! How `--help` is set out.
//!
//! The texts after the options are written in lines of 100 columns, as everything here. A terminal
//! may be narrower, and breaking broken lines again would leave a word on every second one. So the
//! lines of a paragraph are joined before clap breaks them where the terminal ends. Indented lines,
//! which are examples and tables, stay as they are; they fit into 80 columns.

use clap::{Arg, Command, CommandFactory};

use super::Cli;

/// The definition of the program.
pub fn program() -> Command {
    let names = |command: &Command| -> Vec<String> {
        command.get_subcommands().map(|one| one.get_name().to_owned()).collect()
    };
    let program = with_whole_paragraphs(Cli::command());
    let set_out = |command: Command| with_whole_paragraphs(command).mut_args(with_negative_numbers);
    names(&program).into_iter().fold(program, |program, name| program.mut_subcommand(name, set_out))
}

/// A negative number is the value of the option before it, which may refuse it, and no option
/// itself.
fn with_negative_numbers(arg: Arg) -> Arg {
    let takes_value = arg.get_long().is_some() && arg.get_action().takes_values();
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

/// The text with each paragraph in one line.
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

    /// No line is longer, and no row of a table and no example is broken.
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
