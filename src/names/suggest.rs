//! "Did you mean": suggests the known word nearest to a mistyped one.

/// Longer words are not compared.
const MAX_WORD_BYTES: usize = 100;

/// Shorter words are the beginning of too many.
const MIN_PREFIX: usize = 3;

/// "did you mean `x`?" if a known word is near, or begins so.
pub fn did_you_mean<'k>(word: &str, known: impl IntoIterator<Item = &'k str>) -> Option<String> {
    if word.len() > MAX_WORD_BYTES {
        return None;
    }
    let max_edits = (word.chars().count() / 3).max(1);
    let known: Vec<&str> = known.into_iter().collect();
    let near = known
        .iter()
        .map(|candidate| (strsim::damerau_levenshtein(word, candidate), *candidate))
        .min()
        .filter(|&(slips, _)| slips <= max_edits)
        .map(|(_, candidate)| vec![candidate]);
    let begun = || known.iter().copied().filter(|candidate| candidate.starts_with(word)).collect();
    let meant = near.or_else(|| (word.len() >= MIN_PREFIX).then(begun))?;
    let names: Vec<String> = meant.iter().map(|candidate| format!("`{candidate}`")).collect();
    (1..=3).contains(&names.len()).then(|| format!("did you mean {}?", names.join(" or ")))
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
        assert_eq!(did_you_mean("emi", known).as_deref(), Some("did you mean `emission`?"));
        assert_eq!(did_you_mean("em", known), None);
        let shapes = ["uniform-angle", "uniform-solid-angle", "cosine"];
        let both = "did you mean `uniform-angle` or `uniform-solid-angle`?";
        assert_eq!(did_you_mean("uniform", shapes).as_deref(), Some(both));
    }
}
