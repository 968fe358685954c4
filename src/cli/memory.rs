//! Prints the memory plan, and refuses scenes that do not fit.

use serde_json::{Value, json};

use crate::accel::Backend;
use crate::error::{Error, Result};
use crate::film::Aov;
use crate::job::{MemoryPhase, MemoryPlan};
use crate::scene::SceneFile;
use crate::scene::description::ColorStorage;

use super::{print, system};

/// What a command needs memory for, apart from the scene.
pub(super) struct MemoryNeeds<'a> {
    /// Intersectors that are built one after another and all kept.
    pub(super) backends: &'a [Backend],
    /// The layers of the picture.
    pub(super) kinds: &'a [Aov],
    /// Additional bytes.
    pub(super) besides: u64,
}

/// Refuses a scene that needs more memory than `limit` or, without a limit, than is free.
///
/// # Errors
/// Fails with the memory needed, and with a cheaper option if there is one.
pub(super) fn check(file: &SceneFile, needs: &MemoryNeeds<'_>, limit: Option<u64>) -> Result<()> {
    let MemoryNeeds { backends, kinds, besides } = *needs;
    let (limit, has_limit) = match (limit, system::available_memory()) {
        (Some(limit), _) => (limit, true),
        (None, Some(free)) => (free, false),
        (None, None) => return Ok(()),
    };
    let peak = |backends: &[Backend], colors| {
        let threads = rayon::current_num_threads();
        MemoryPlan::new(file, backends, kinds, threads, colors).peak() + besides
    };
    let needed = peak(backends, None);
    if needed <= limit {
        return Ok(());
    }
    let (needed, shown) = (print::bytes(needed), print::bytes(limit));
    let reason = match has_limit {
        true => format!("more than the limit of {shown}"),
        false => format!("but only {shown} is free"),
    };
    let message = format!("this needs {needed} of memory at its peak, {reason}");
    Err(Error::input(message).with_help(cheaper(file, backends, limit, &peak)))
}

/// Returns the smallest change that makes the scene fit.
fn cheaper(
    file: &SceneFile,
    backends: &[Backend],
    limit: u64,
    peak: &dyn Fn(&[Backend], Option<ColorStorage>) -> u64,
) -> String {
    let packed = Some(ColorStorage::Packed);
    let others: &[Backend] = if backends.len() > 1 { backends } else { Backend::AVAILABLE };
    let mut choices = vec![(pack_colors(file), peak(backends, packed))];
    for colors in [None, packed] {
        // Brute force is too slow to suggest for a large scene.
        for &backend in others.iter().filter(|&&backend| backend != Backend::BruteForce) {
            let pack = if colors.is_some() { pack_colors(file) } else { String::new() };
            let words = format!("--accel {} {pack}", backend.name());
            choices.push((words, peak(&[backend], colors)));
        }
    }
    let fitting = choices.iter().find(|(words, bytes)| !words.is_empty() && *bytes <= limit);
    match fitting {
        Some((words, bytes)) => {
            format!("{} needs {}", words.trim_end(), print::bytes(*bytes))
        }
        None => "no option makes it fit; use smaller tables or a smaller picture".to_owned(),
    }
}

/// Returns the options that pack the colours of all tables; empty if there are none to pack.
fn pack_colors(file: &SceneFile) -> String {
    let tables = file.description.tables.iter().enumerate();
    let unpacked =
        tables.filter(|(_, table)| table.colors == ColorStorage::Exact && table.data.has_colors());
    let options = unpacked.map(|(i, _)| format!("--set sphere_tables.{i}.colors=packed"));
    options.collect::<Vec<_>>().join(" ")
}

fn plans(file: &SceneFile) -> impl Iterator<Item = (&'static str, MemoryPlan)> {
    let plan = move |&backend: &Backend| {
        let threads = rayon::current_num_threads();
        let plan = MemoryPlan::new(file, &[backend], &Aov::DEFAULT, threads, None);
        (backend.name(), plan)
    };
    Backend::AVAILABLE.iter().map(plan)
}

/// Formats the memory plan as a table of names and values.
pub(super) fn table(file: &SceneFile) -> String {
    let mut text = print::field("memory plan", "of a render");
    let mut line =
        |name: &str, value: String| text += &print::field("", format!("{name:<14}{value}"));
    // Apart from the acceleration structures, the plan is equal for all intersectors.
    if let Some((_, plan)) = plans(file).next() {
        let held = [
            ("spheres", plan.spheres),
            ("rows", plan.rows),
            ("colours", plan.colors),
            ("emitters", plan.emitters),
            ("background", plan.background),
            ("film", plan.film),
        ];
        let held = held.into_iter().filter(|(_, bytes)| *bytes > 0);
        held.for_each(|(name, bytes)| line(name, print::bytes(bytes)));
    }
    for (name, plan) in plans(file) {
        let (tree, peak) = (print::bytes(plan.accel), print::bytes(plan.peak()));
        let doing = match plan.peak_phase() {
            MemoryPhase::Sorting => "sorting",
            MemoryPhase::Building => "building the tree",
            MemoryPhase::Rendering => "rendering",
        };
        line(name, format!("tree {tree}, peak {peak} while {doing}"));
    }
    text
}

/// Returns the memory plan as JSON.
pub(super) fn json(file: &SceneFile) -> Value {
    let backend = |(name, plan): (&str, MemoryPlan)| {
        let MemoryPlan {
            spheres,
            rows,
            colors,
            emitters: emitter_bytes,
            background,
            accel: tree,
            accel_build: build,
            film,
            program,
        } = plan;
        json!({
            "accel": name,
            "sphere_bytes": spheres,
            "row_bytes": rows,
            "color_bytes": colors,
            "emitter_bytes": emitter_bytes,
            "background_bytes": background,
            "tree_bytes": tree,
            "build_bytes": build,
            "film_bytes": film,
            "program_bytes": program,
            "peak_bytes": plan.peak(),
        })
    };
    plans(file).map(backend).collect()
}
