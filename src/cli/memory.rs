//! Prints the memory plan, and refuses scenes that do not fit.

use serde_json::{Value, json};

use crate::accel::Backend;
use crate::error::{Error, Result};
use crate::film::Aov;
use crate::job::{Job, MemoryPhase, MemoryPlan};
use crate::scene::SceneFile;
use crate::scene::data::SphereData;
use crate::scene::description::ColorStorage;

use crate::task::memory_limits;
use crate::task::memory_limits::MemoryLimit;

use super::print;

/// What a command needs memory for, apart from the scene.
pub(super) struct MemoryNeeds<'a> {
    /// Intersectors that are built one after another and all kept.
    pub(super) backends: &'a [Backend],
    /// The layers of the picture.
    pub(super) kinds: &'a [Aov],
    /// Additional bytes.
    pub(super) besides: u64,
}

/// Refuses a scene that needs more memory than `limit` or, without a limit, than this process may
/// still take.
///
/// # Errors
/// Fails with the memory needed, and with a cheaper option if there is one.
pub(super) fn check(file: &SceneFile, needs: &MemoryNeeds<'_>, limit: Option<u64>) -> Result<()> {
    let MemoryNeeds { backends, kinds, besides } = *needs;
    let (limit, free) = match (limit, memory_limits::free()) {
        (Some(limit), _) => (limit, None),
        (None, Some(free)) => (free.bytes, Some(free.limit)),
        (None, None) => return Ok(()),
    };
    let job = job(file, kinds);
    let (exact, packed) = (file.size(), file.size().with_packed_colors());
    let peak = |backends: &[Backend], is_packed| {
        let size = if is_packed { &packed } else { &exact };
        MemoryPlan::with_backends(size, &job, backends).peak() + besides
    };
    let needed = peak(backends, false);
    if needed <= limit {
        return Ok(());
    }
    let (needed, shown) = (print::bytes(needed), print::bytes(limit));
    let reason = match free {
        None => format!("more than the limit of {shown}"),
        Some(MemoryLimit::Machine) => format!("but only {shown} is free"),
        Some(MemoryLimit::ControlGroup(group)) => {
            format!("but the limit of the control group `{}` leaves only {shown}", group.display())
        }
        Some(MemoryLimit::Resource(name, option)) => {
            format!("but the limit of the {name} (ulimit {option}) leaves only {shown}")
        }
    };
    let message = format!("this needs {needed} of memory at its peak, {reason}");
    Err(Error::input(message).with_help(cheaper(file, backends, limit, &peak)))
}

/// Returns the job whose memory is planned.
fn job(file: &SceneFile, layers: &[Aov]) -> Job {
    let threads = rayon::current_num_threads();
    Job { layers: layers.to_vec(), threads, ..Job::from_settings(file.settings) }
}

/// Returns the smallest change that makes the scene fit.
fn cheaper(
    file: &SceneFile,
    backends: &[Backend],
    limit: u64,
    peak: &dyn Fn(&[Backend], bool) -> u64,
) -> String {
    let others: &[Backend] = if backends.len() > 1 { backends } else { Backend::AVAILABLE };
    let mut choices = vec![(pack_colors(file), peak(backends, true))];
    for is_packed in [false, true] {
        // Brute force is too slow to suggest for a large scene.
        for &backend in others.iter().filter(|&&backend| backend != Backend::BruteForce) {
            let pack = if is_packed { pack_colors(file) } else { String::new() };
            let words = format!("--accel {} {pack}", backend.name());
            choices.push((words, peak(&[backend], is_packed)));
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
    // Particles have packed colours unless a scene says otherwise.
    let unpacked = unpacked.filter(|(_, table)| !matches!(table.data, SphereData::Particles(_)));
    let options = unpacked.map(|(i, _)| format!("--set sphere_tables.{i}.colors=packed"));
    options.collect::<Vec<_>>().join(" ")
}

fn plans(file: &SceneFile) -> impl Iterator<Item = (&'static str, MemoryPlan)> + use<> {
    let (size, job) = (file.size(), job(file, &Aov::DEFAULT));
    let plan = move |&backend: &Backend| {
        (backend.name(), MemoryPlan::with_backends(&size, &job, &[backend]))
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
            ("emission", plan.emission),
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
            emission,
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
            "emission_bytes": emission,
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
