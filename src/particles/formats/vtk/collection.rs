//! ParaView collections (`.pvd`): each time has a file, which is a frame.

use std::path::{Path, PathBuf};

use roxmltree::Document;

use crate::particles::source::Source;
use crate::particles::trouble::{Outcome, Trouble, plural};

/// The file of a frame, and its time.
pub(in crate::particles) fn part_of_pvd(
    source: &Source,
    frame: u64,
) -> Outcome<(PathBuf, Option<f64>)> {
    let all = files(source)?;
    let has = plural(all.len() as u64, "frame");
    let found = usize::try_from(frame).ok().and_then(|frame| all.get(frame));
    let Some((file, time)) = found else {
        let message = format!("it has {has}, and no frame {frame} (the first is 0)");
        return Err(Trouble::new(message).into());
    };
    let folder = source.path.parent().unwrap_or(Path::new(""));
    Ok((folder.join(file), *time))
}

/// Counts the frames.
pub(in crate::particles) fn count_pvd(source: &Source) -> Outcome<u64> {
    Ok(files(source)?.len() as u64)
}

/// All files with their times. Files must lie beside the collection or below.
fn files(source: &Source) -> Outcome<Vec<(PathBuf, Option<f64>)>> {
    if !source.is_short() {
        let message = "the collection has more than 64 KiB";
        return Err(Trouble::new(message).with_help("read one of its files").into());
    }
    let text = String::from_utf8_lossy(&source.head);
    let document = Document::parse(&text).map_err(|error| {
        Trouble::at(u64::from(error.pos().row), format!("the XML is damaged: {error}"))
    })?;
    let mut all = Vec::new();
    for node in document.descendants().filter(|node| node.has_tag_name("DataSet")) {
        let file = PathBuf::from(node.attribute("file").unwrap_or_default());
        let is_below = file.components().all(|part| {
            matches!(part, std::path::Component::Normal(_) | std::path::Component::CurDir)
        });
        if !is_below || file.as_os_str().is_empty() {
            let line = document.text_pos_at(node.range().start).row;
            let message =
                format!("expected a file beside the collection, found `{}`", file.display());
            return Err(Trouble::at(u64::from(line), message).into());
        }
        let time = node.attribute("timestep").and_then(|time| time.trim().parse().ok());
        all.push((file, time));
    }
    if all.is_empty() {
        return Err(Trouble::new("it has no `DataSet`").into());
    }
    Ok(all)
}
