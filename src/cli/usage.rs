//! What clap answers instead of a command: the help, the version, or what is wrong with the
//! command line.

use std::ffi::OsString;

use clap::Args;
use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use serde_json::json;

use crate::draw::printable::printable;

use super::args::OverlayArgs;
use super::exit::Exit;
use super::{error, print, system};

/// Prints the answer; clap chooses the stream and the colours. A wrong command line is also printed
/// as JSON if it asks for that.
pub(super) fn answer(mut answer: clap::Error) -> Exit {
    let words: Vec<OsString> = system::arguments().skip(1).collect();
    let texts: Vec<String> = words.iter().map(|word| word.to_string_lossy().into()).collect();
    advise(&mut answer, &texts);
    let plain = || answer.render().to_string();
    if texts.iter().all(|word| *printable(word) == **word) {
        // On a closed stream nothing can be reported.
        let _ = answer.print();
    } else {
        // Without colours, the control characters of an argument can be told from those of clap.
        print::note(plain().trim_end());
    }
    if !answer.use_stderr() {
        return Exit::Done;
    }
    if texts.iter().take_while(|word| *word != "--").any(|word| word == "--json") {
        let text = plain();
        let (message, help) = text.split_once("\n\n").unwrap_or((&text, ""));
        error::print_json(&json!({ "error": {
            "exit_code": Exit::Usage as u8,
            "category": "usage",
            "message": message.trim_start_matches("error: ").trim(),
            "help": help.trim(),
            "diagnostics": [],
        }}));
    }
    Exit::Usage
}

/// Says where an option belongs that draws over a picture, for the command that writes a scene;
/// returns true if that is what was wrong.
fn advise_of_overlay(answer: &mut clap::Error, words: &[String]) -> bool {
    let is_import = words.iter().any(|word| word == "import");
    let Some(ContextValue::String(given)) = answer.get(ContextKind::InvalidArg) else {
        return false;
    };
    let overlay = OverlayArgs::augment_args(clap::Command::new("overlay"));
    let is_it = |arg: &clap::Arg| arg.get_long() == given.strip_prefix("--");
    if !is_import || !overlay.get_arguments().any(is_it) {
        return false;
    }
    let advice = StyledStr::from(format!(
        "what is drawn over a picture is no part of its scene: give '{given}' to photosphere render"
    ));
    answer.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![advice]));
    // It names another option.
    answer.remove(ContextKind::SuggestedArg);
    true
}

/// Replaces clap's advice for an argument that starts with a dash. It suggests `-- -a.png`, which
/// an option cannot take; a path that starts with its folder can be given anywhere.
pub(super) fn advise(answer: &mut clap::Error, words: &[String]) {
    let is_unknown = answer.kind() == ErrorKind::UnknownArgument;
    if is_unknown && advise_of_overlay(answer, words) {
        return;
    }
    if !is_unknown || answer.get(ContextKind::Suggested).is_none() {
        return;
    }
    let Some(ContextValue::String(argument)) = answer.get(ContextKind::InvalidArg) else { return };
    let is_it = |word: &&String| word.starts_with(argument.as_str());
    let word = words.iter().find(is_it).unwrap_or(argument);
    let advice =
        StyledStr::from(format!("to pass '{word}' as the name of a file, write './{word}'"));
    answer.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![advice]));
}
