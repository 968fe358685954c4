//! The command line.

use photosphere::cli::testing::evaluate_arguments;

use super::is_inert;

/// The scene that the command line names, whatever it is called.
const SCENE: &str = include_str!("../../seeds/scene/base.toml");

/// Each line of the input is an argument. Nothing is run.
pub(super) fn arguments(input: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(input) else { return false };
    let words: Vec<String> = text.lines().map(str::to_owned).collect();
    // No system passes on a zero byte.
    if text.contains('\0') {
        return false;
    }
    match evaluate_arguments(&words, SCENE) {
        Ok(_) => true,
        Err(message) => {
            assert!(is_inert(&message) && !message.trim().is_empty(), "{message:?}");
            false
        }
    }
}
