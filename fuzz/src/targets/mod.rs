//! What each fuzz target does with its input. The fuzzers call these functions, and
//! `tests/cli/fuzz_seeds.rs` calls them with the inputs in `fuzz/seeds`, so this module uses only
//! what both have.
//!
//! A target returns true if the input was accepted, such as a scene without mistakes. A refusal is
//! checked in [`refused`]. Anything else is a finding: a panic, a broken promise (an assertion
//! here), too much time or too much memory.

mod arguments;
mod background;
mod checkpoints;
mod metadata;
mod particles;
mod pictures;
mod render;
mod scenes;
mod tables;
mod viewer;

use std::path::Path;

use photosphere::Error;
use photosphere::cli::testing::error_text;
use photosphere::scene::{Override, SceneFile, read_text};

/// A fuzz target.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Target {
    /// The name of its program, and of its folder in `fuzz/seeds`.
    pub(crate) name: &'static str,
    /// Takes one input.
    pub(crate) run: fn(&[u8]) -> bool,
}

/// All targets. A new one also needs a program in `src/bin`, an entry in `Cargo.toml`, and seeds.
pub(crate) const TARGETS: [Target; 29] = [
    Target { name: "scene", run: scenes::scene },
    Target { name: "overrides", run: scenes::overrides },
    Target { name: "render", run: render::render },
    Target { name: "table_rows", run: tables::rows },
    Target { name: "table_npy", run: tables::npy },
    Target { name: "checkpoint", run: checkpoints::raw },
    Target { name: "checkpoint_shaped", run: checkpoints::shaped },
    Target { name: "picture", run: pictures::picture },
    Target { name: "environment", run: background::environment },
    Target { name: "metadata", run: metadata::metadata },
    Target { name: "arguments", run: arguments::arguments },
    Target { name: "viewer", run: viewer::viewer },
    Target { name: "particles_npy", run: particles::npy },
    Target { name: "particles_npz", run: particles::npz },
    Target { name: "particles_csv", run: particles::csv },
    Target { name: "particles_table", run: particles::table },
    Target { name: "particles_xyz", run: particles::xyz },
    Target { name: "particles_lammps_dump", run: particles::lammps_dump },
    Target { name: "particles_lammps_data", run: particles::lammps_data },
    Target { name: "particles_pdb", run: particles::pdb },
    Target { name: "particles_mmcif", run: particles::mmcif },
    Target { name: "particles_gro", run: particles::gro },
    Target { name: "particles_poscar", run: particles::poscar },
    Target { name: "particles_ply", run: particles::ply },
    Target { name: "particles_gsd", run: particles::gsd },
    Target { name: "particles_vtk_xml", run: particles::vtk_xml },
    Target { name: "particles_vtk_legacy", run: particles::vtk_legacy },
    Target { name: "particles_xtc", run: particles::xtc },
    Target { name: "particles_any", run: particles::any },
];

/// Checks that an error says something, points into its text, and does nothing to a terminal.
fn refused(error: &Error) -> bool {
    for location in error.diagnostics().iter().filter_map(|mistake| mistake.location.as_ref()) {
        let (text, span) = (&location.source.text, location.span.clone());
        assert!(text.get(span.clone()).is_some(), "{error}: {span:?} is not in its text");
    }
    let text = error_text(error);
    assert!(is_inert(&text), "{text:?}");
    assert!(text.starts_with("error: "), "{text:?}");
    false
}

/// Returns true if a terminal shows the text and does nothing else.
fn is_inert(text: &str) -> bool {
    !text.contains(|c: char| c.is_control() && !matches!(c, '\n' | '\t'))
}

/// Reads a scene from a text; its files are in `folder`.
fn read_scene(text: &str, folder: &Path, overrides: &[Override]) -> Option<SceneFile> {
    match read_text("scene.toml", text, folder, overrides) {
        Ok(file) => Some(file),
        Err(error) => {
            refused(&error);
            None
        }
    }
}

/// Passes on a value, and checks an error.
fn accepted<T>(result: photosphere::Result<T>) -> Option<T> {
    result.inspect_err(|error| _ = refused(error)).ok()
}

/// Splits the input at the first line break. Without one, the second part is empty.
fn first_line(input: &[u8]) -> (&[u8], &[u8]) {
    match input.iter().position(|byte| *byte == b'\n') {
        Some(end) => (&input[..end], &input[end + 1..]),
        None => (input, &[]),
    }
}

/// Runs the target of this name.
///
/// # Panics
/// If there is none, or on a finding.
pub(crate) fn run(name: &str, input: &[u8]) -> bool {
    let target = TARGETS.iter().find(|target| target.name == name);
    (target.expect("a target of this name").run)(input)
}
