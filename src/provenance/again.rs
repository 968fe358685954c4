//! The same scene again, from what a picture says of it.

use std::path::Path;

use crate::error::{Error, Result};
use crate::scene::{Identity, Scene, read_text};

use super::Made;

impl Made {
    /// The scene, with its files looked for in `folder`, where the scene file was. Where its text did
    /// not fit into the picture, `scene_file` is read.
    ///
    /// # Errors
    /// When a file is missing or is not what it was.
    pub fn scene(&self, folder: &Path, scene_file: Option<&Path>) -> Result<Scene> {
        let text = match &self.source.text {
            Some(text) => text.clone(),
            None => self.read_scene(scene_file)?,
        };
        let loaded = read_text("the picture's scene", &text, folder, &self.overrides())?;
        let changed: Vec<String> = (self.source.files.iter())
            .filter(|said| {
                let is_it =
                    |found: &&crate::scene::Ingredient| found.file == folder.join(&said.file);
                let found = loaded.ingredients.files.iter().find(is_it);
                found.is_some_and(|found| found.hash != said.hash)
            })
            .map(|said| format!("`{}`", folder.join(&said.file).display()))
            .collect();
        if !changed.is_empty() {
            let verb = if changed.len() == 1 { "is" } else { "are" };
            let message = format!("{} {verb} not what the picture was made of", changed.join(", "));
            return Err(Error::input(message)
                .with_help("--folder names another folder, where the files are as they were"));
        }
        Scene::new(loaded)
    }

    fn read_scene(&self, scene_file: Option<&Path>) -> Result<String> {
        let Some(file) = scene_file else {
            return Err(Error::input("the scene was too long for the picture, and is in no file"));
        };
        let text = std::fs::read_to_string(file).map_err(|e| Error::file("read", file, e))?;
        if Identity::of_bytes(text.as_bytes()) == self.source.hash {
            return Ok(text);
        }
        let message = format!("`{}` is not what the picture was made of", file.display());
        Err(Error::input(message))
    }

    /// What differs in how two pictures were made, in words; nothing where they must be equal.
    pub fn differences(&self, other: &Self) -> Vec<String> {
        let pairs = [
            ("version", &self.version, &other.version),
            ("commit", &self.commit, &other.commit),
            ("intersector", &self.intersector, &other.intersector),
        ];
        let differ = pairs.into_iter().filter(|(_, a, b)| a != b);
        differ.map(|(what, a, b)| format!("{what}: {a} then, {b} now")).collect()
    }
}
