//! What a file is that is not TOML.

/// What a text looks like.
pub(super) struct Likeness {
    /// Completes "it looks like".
    pub(super) name: &'static str,
    pub(super) help: &'static str,
}

const SCENE: &str = "a scene begins with `format = 1` (docs/scene-format.md)";
const PARTICLES: &str = "particles are rendered without a scene: photosphere render FILE -o a.png, with its \
                         format by name if that is not recognised";

/// What a text looks like that cannot be read as TOML; `None` if it may be a scene with mistakes.
pub(super) fn what_it_looks_like(text: &str) -> Option<Likeness> {
    let lines = || text.lines().map(str::trim).filter(|line| !line.is_empty());
    let without_notes = || lines().filter(|line| !line.starts_with('#'));
    let first = without_notes().next()?;
    if lines().take(200).any(|line| line.starts_with("[[spheres]]") || line.starts_with("format ="))
    {
        return None;
    }
    let is_numbers = |line: &str| {
        let mut words =
            line.split([' ', '\t', ',', ';']).filter(|word| !word.is_empty()).peekable();
        words.peek().is_some() && words.all(|word| word.parse::<f64>().is_ok())
    };
    let is_atom = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        words.len() >= 4 && words[1..4].iter().all(|word| word.parse::<f64>().is_ok())
    };
    let like = |name, help| Some(Likeness { name, help });
    if first.parse::<u64>().is_ok() && lines().nth(2).is_some_and(is_atom) {
        return like("an XYZ file", PARTICLES);
    }
    if first.starts_with("ITEM:") {
        return like("a LAMMPS dump", PARTICLES);
    }
    if ["HEADER", "CRYST1", "ATOM ", "HETATM"].iter().any(|word| first.starts_with(word)) {
        return like("a PDB file", PARTICLES);
    }
    if first.starts_with('<') {
        return like("XML", SCENE);
    }
    if first.starts_with('{') || (first.starts_with('[') && !first.ends_with(']')) {
        return like("JSON", SCENE);
    }
    if ["LookAt", "Camera ", "WorldBegin", "Film ", "Sampler "].iter().any(|w| first.starts_with(w))
    {
        return like("a scene of pbrt", SCENE);
    }
    if without_notes().take(5).all(is_numbers) {
        return like("a table of numbers", PARTICLES);
    }
    if without_notes().skip(1).take(5).all(is_numbers) && without_notes().nth(1).is_some() {
        return like("a table of numbers with a heading", PARTICLES);
    }
    (!first.starts_with('[') && !first.contains('='))
        .then_some(Likeness { name: "some other text", help: SCENE })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(text: &str) -> Option<&'static str> {
        what_it_looks_like(text).map(|what| what.name)
    }

    #[test]
    fn other_files_are_named() {
        let cases = [
            ("3\nwater\nO 0 0 0.1\nH 1 0 0\nH 0 1 0\n", "an XYZ file"),
            ("ITEM: TIMESTEP\n0\n", "a LAMMPS dump"),
            ("HEADER    PROTEIN\n", "a PDB file"),
            ("<scene version=\"3.0.0\">\n", "XML"),
            ("{ \"camera\": 1 }", "JSON"),
            ("# pbrt\nLookAt 0 0 5 0 0 0 0 1 0\n", "a scene of pbrt"),
            ("0.1 2 3 1e-3\n1 2 3 4\n", "a table of numbers"),
            ("x,y,z,r\n1,2,3,4\n5,6,7,8\n", "a table of numbers with a heading"),
            ("Dear reader,\nonce upon a time\n", "some other text"),
        ];
        for (text, expected) in cases {
            assert_eq!(name(text), Some(expected), "{text}");
        }
    }

    #[test]
    fn a_scene_with_mistakes_stays_one() {
        for text in
            ["format = 1\n[camera\n", "[camera]\nposition = [0, 0\n", "a = 1\nb\n", "", "#\n"]
        {
            assert_eq!(name(text), None, "{text}");
        }
    }
}
