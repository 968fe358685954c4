//! What a user may have meant who names a scene file that does not exist.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use crate::names::did_you_mean;

/// At most so many files are listed.
const MAX_LISTED: usize = 6;
/// At most so many entries of folders are looked at.
const MAX_ENTRIES: usize = 5000;
/// So many levels of folders are looked into.
const MAX_DEPTH: usize = 3;

/// Suggests a file with nearly this name, or with this name in a folder below, or lists the scenes
/// beside it. `None` if there are none.
pub(super) fn suggestion(missing: &Path) -> Option<String> {
    let folder = missing.parent().filter(|folder| *folder != Path::new(""));
    if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
        return Some(format!("there is no folder `{}`", folder.display()));
    }
    let name = missing.file_name()?.to_string_lossy().into_owned();
    let start = folder.unwrap_or(Path::new("."));
    let files = scenes_below(start);
    let shown = |file: &Path| file.strip_prefix("./").unwrap_or(file).display().to_string();
    let is_beside = |file: &&PathBuf| file.parent() == Some(start);
    let beside: Vec<String> = files.iter().filter(is_beside).map(|file| shown(file)).collect();
    let near = shown(&start.join(&name));
    let below = files.iter().find(|file| file.file_name() == Some(OsStr::new(&name)));
    below
        .map(|file| format!("did you mean `{}`?", shown(file)))
        .or_else(|| did_you_mean(&near, beside.iter().map(String::as_str)))
        .or_else(|| list(&beside))
}

fn list(names: &[String]) -> Option<String> {
    let shown: Vec<_> = names.iter().take(MAX_LISTED).map(|name| format!("`{name}`")).collect();
    let more = match names.len() > MAX_LISTED {
        true => format!(" and {} more", names.len() - MAX_LISTED),
        false => String::new(),
    };
    (!shown.is_empty()).then(|| format!("the scenes there are {}{more}", shown.join(", ")))
}

/// The scene files in a folder and those below, by name, those nearer to the folder first.
fn scenes_below(start: &Path) -> Vec<PathBuf> {
    let (mut found, mut folders, mut entries) = (Vec::new(), vec![start.to_path_buf()], 0);
    for _ in 0..MAX_DEPTH {
        let mut below = Vec::new();
        for folder in folders {
            let Ok(listing) = folder.read_dir() else { continue };
            for entry in listing.flatten() {
                entries += 1;
                if entries > MAX_ENTRIES {
                    return found;
                }
                let (path, kind) = (entry.path(), entry.file_type());
                let is_hidden = entry.file_name().to_string_lossy().starts_with('.');
                match kind {
                    Ok(kind) if kind.is_dir() && !is_hidden => below.push(path),
                    Ok(_) if path.extension() == Some(OsStr::new("toml")) => found.push(path),
                    _ => {}
                }
            }
        }
        below.sort();
        folders = below;
    }
    found.sort_by_key(|path| (path.components().count(), path.clone()));
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_names_and_neighbours_are_suggested() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let help = |name: &str| suggestion(&at(name));
        assert_eq!(help("a.toml"), None);
        std::fs::create_dir_all(at("sub/deep")).unwrap();
        for name in ["box.toml", "sky.toml", "notes.txt", "sub/deep/fig2.toml"] {
            std::fs::write(at(name), "").unwrap();
        }
        let text = |name: &str| at(name).display().to_string();
        let meant = |name: &str| Some(format!("did you mean `{}`?", text(name)));
        assert_eq!(help("bxo.toml"), meant("box.toml"));
        assert_eq!(help("fig2.toml"), meant("sub/deep/fig2.toml"));
        let all = format!("the scenes there are `{}`, `{}`", text("box.toml"), text("sky.toml"));
        assert_eq!(help("something-else-that-is-long.toml").as_deref(), Some(&*all));
        assert_eq!(help("no/a.toml"), Some(format!("there is no folder `{}`", text("no"))));
    }
}
