//! "Did you mean": suggests the known word nearest to a mistyped one.

/// Longer words are not compared.
const MAX_WORD_BYTES: usize = 100;

/// "did you mean `x`?" if a known word is near.
pub fn did_you_mean<'k>(word: &str, known: impl IntoIterator<Item = &'k str>) -> Option<String> {
    if word.len() > MAX_WORD_BYTES {
        return None;
    }
    let max_edits = (word.chars().count() / 3).max(1);
    known
        .into_iter()
        .map(|candidate| (strsim::damerau_levenshtein(word, candidate), candidate))
        .min()
        .filter(|&(slips, _)| slips <= max_edits)
        .map(|(_, candidate)| format!("did you mean `{candidate}`?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_near_words_are_suggested() {
        let known = ["albedo", "emission", "type"];
        assert_eq!(did_you_mean("albeod", known).as_deref(), Some("did you mean `albedo`?"));
        assert_eq!(did_you_mean("typ", known).as_deref(), Some("did you mean `type`?"));
        assert_eq!(did_you_mean("reflectance", known), None);
    }
}
