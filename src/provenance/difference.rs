//! What differs between how two pictures were made, in words.

use super::Made;

impl Made {
    /// What differs of all that decides the pixels, first as it is here and then as it is there. Which
    /// samples of which pixels there are does not count.
    pub fn difference(&self, other: &Self) -> String {
        let mut found = Vec::new();
        let mut differ = |what: &str, ours: &dyn ToString, theirs: &dyn ToString| {
            let (ours, theirs) = (ours.to_string(), theirs.to_string());
            if ours != theirs {
                found.push(format!("{what} {ours}, not {theirs}"));
            }
        };
        differ("the program's version is", &self.version, &other.version);
        differ("the intersector is", &self.intersector, &other.intersector);
        let size = |made: &Self| format!("{} x {}", made.size[0], made.size[1]);
        differ("the picture's size is", &size(self), &size(other));
        differ("the seed is", &self.seed, &other.seed);
        let options = |made: &Self| {
            let mut options: Vec<String> =
                made.source.options.iter().map(|(key, value)| format!("{key}={value}")).collect();
            options.sort();
            if options.is_empty() { "none".to_owned() } else { options.join(" ") }
        };
        differ("the options are", &options(self), &options(other));
        if self.source.hash != other.source.hash {
            found.push("the scene file's text is another".to_owned());
        }
        let hashes =
            |made: &Self| made.source.files.iter().map(|file| file.hash).collect::<Vec<_>>();
        if hashes(self) != hashes(other) {
            found.push("a table or an image of the scene has other values".to_owned());
        }
        if found.is_empty() {
            // All else that is hashed is how many samples a pixel is to have.
            found.push(
                "the number of samples per pixel changes each of them, as it does with \
                 `sampler = \"stratified\"`"
                    .to_owned(),
            );
        }
        found.join("; ")
    }
}
