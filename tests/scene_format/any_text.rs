//! No text makes the reader panic.

use std::path::Path;

use photosphere::error::Diagnostic;
use photosphere::scene::{Override, SceneFile, read_text};
use proptest::prelude::*;

use crate::scenes::{EXAMPLE, load};

#[test]
fn no_truncated_scene_makes_the_reader_panic() {
    let mut good = 0;
    for end in (0..=EXAMPLE.len()).filter(|&end| EXAMPLE.is_char_boundary(end)) {
        good += usize::from(load(&EXAMPLE[..end], &["image.width=8"]).is_ok());
    }
    assert!((1..EXAMPLE.len() / 2).contains(&good), "{good} pieces are scenes");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn no_edited_scene_makes_the_reader_panic(
        edits in prop::collection::vec(
            (any::<prop::sample::Index>(), 0usize..12, "[ -~\n]{0,6}"), 1..4),
        key in "[a-z0-9.\"']{0,12}",
        value in "[ -~\n]{0,8}",
    ) {
        let mut text = EXAMPLE.to_owned();
        for (at, cut, insert) in edits {
            let start = at.index(text.len() + 1);
            let end = (start + cut).min(text.len());
            text.replace_range(start..end, &insert);
        }
        let option = Override::new(&key, &value).with_option(["--set", &format!("{key}={value}")]);
        let file = read_text("edited.toml", &text, Path::new("tests/data"), &[option]);
        if let Err(error) = file.and_then(SceneFile::build) {
            let shows_text = |mistake: &Diagnostic| {
                let place = mistake.location.as_ref();
                place.is_none_or(|place| place.source.text.get(place.span.clone()).is_some())
            };
            prop_assert!(error.diagnostics().iter().all(shows_text), "{error}");
            prop_assert!(!error.to_string().is_empty());
        }
    }
}
