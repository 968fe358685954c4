//! `photosphere doctor`: reports what this build and machine support, what they would gain, and how
//! to get what is missing.

use std::path::PathBuf;
use std::sync::Arc;

use crate::accel::{
    self, Accel, Backend, BackendChoice, BuildOptions, EmbreeInfo, KernelIsa, SelectedBackend,
};
use crate::denoise::Denoiser;
use crate::error::{Error, Result};
use crate::geometry::{PathRay, Sphere, SphereRows, SphereSet};
use crate::math::{DVec3, Hit};
use crate::task::memory_limits;

use super::exit::Exit;
use super::packaging::Packaging;
use super::{print, system};

/// Printed if the build lacks Embree.
const HOW_TO_GET_EMBREE: [&str; 6] = [
    "it adds --accel embree and embree-user, to compare with `native`, which is faster",
    "to get it, install its headers and libclang, then build again:",
    "  Debian, Ubuntu:  sudo apt-get install libembree-dev libclang-dev",
    "  elsewhere:       the package of Embree 3 or 4, or set EMBREE_DIR to its folder",
    "  then:            touch build.rs && cargo build --release",
    "the .deb packages for Debian 12 and 13 have it",
];

/// Printed in its place inside the Python package.
const EMBREE_AND_PYTHON: [&str; 2] = [
    "the Python package traces rays by `native`, which is faster and needs nothing",
    "to compare the two, use the .deb packages for Debian 12 and 13, or build the program",
];

/// A program that photosphere works with and does without.
struct Companion {
    name: &'static str,
    /// The name of its executable file.
    program: &'static str,
    gain: &'static str,
    how_to_get: &'static str,
}

const COMPANIONS: [Companion; 2] = [
    Companion {
        name: "ffmpeg",
        program: "ffmpeg",
        gain: "makes a video: ffmpeg -pattern_type glob -i 'pictures/*.png' video.mp4",
        how_to_get: "Debian, Ubuntu: sudo apt-get install ffmpeg",
    },
    Companion {
        name: "python",
        program: "python3",
        gain: "for the package `photosphere` (3.11 or later), which has this program in it",
        how_to_get: "Debian, Ubuntu: sudo apt-get install python3-venv",
    },
];

/// Runs the command.
///
/// # Errors
/// If the findings cannot be printed.
pub(super) fn run(packaging: Packaging) -> Result<Exit> {
    let mut report = Report { text: String::new(), healthy: true };
    let (os, arch) = (std::env::consts::OS, std::env::consts::ARCH);
    report.row("photosphere", format!("{} ({os}, {arch})", env!("CARGO_PKG_VERSION")));
    report.machine();
    report.vectors();
    report.embree(packaging);
    for backend in Backend::AVAILABLE {
        report.backend(*backend);
    }
    report.choice();
    report.denoiser();
    let is_python = packaging == Packaging::PythonPackage;
    let companions = COMPANIONS.iter().filter(|one| !(is_python && one.name == "python"));
    companions.for_each(|companion| report.companion(companion));
    print::result(&report.text)?;
    Ok(if report.healthy { Exit::Done } else { Exit::Backend })
}

/// The findings so far.
struct Report {
    text: String,
    healthy: bool,
}

impl Report {
    fn row(&mut self, name: &str, value: impl std::fmt::Display) {
        self.text += &print::field(name, value);
    }

    /// Adds a row with a long name.
    fn wide_row(&mut self, name: &str, value: impl std::fmt::Display) {
        self.text += &format!("{name:<22}{value}\n");
    }

    fn machine(&mut self) {
        let cores = std::thread::available_parallelism()
            .map_or_else(|e| format!("unknown ({e})"), |cores| cores.to_string());
        self.row("threads", cores);
        if let (Some(memory), Some(free)) = (system::total_memory(), memory_limits::free()) {
            let (memory, free) = (print::bytes(memory), print::bytes(free.bytes));
            self.row("memory", format!("{memory}, {free} available"));
        }
    }

    /// Adds the vector instructions in use, and what another compiler would add.
    fn vectors(&mut self) {
        self.row("vectors", KernelIsa::best().name());
        if cfg!(target_arch = "x86_64") && !KernelIsa::Avx512.is_compiled() {
            self.row("", "not in this build: AVX-512, which Rust 1.89 or newer compiles");
        }
    }

    fn embree(&mut self, packaging: Packaging) {
        match accel::embree_info() {
            None if packaging == Packaging::PythonPackage => {
                self.row("embree", "not in this package");
                EMBREE_AND_PYTHON.into_iter().for_each(|line| self.row("", line));
            }
            None => {
                self.row("embree", "not in this build");
                HOW_TO_GET_EMBREE.into_iter().for_each(|line| self.row("", line));
            }
            Some(Err(error)) => self.broken("embree", &error),
            Some(Ok(info)) => self.working_embree(&info),
        }
    }

    fn working_embree(&mut self, info: &EmbreeInfo) {
        let EmbreeInfo { compiled_version, runtime_version, instruction_set, .. } = info;
        self.row("embree", format!("compiled against {compiled_version}"));
        self.row("", format!("running {runtime_version}"));
        self.row("", format!("instruction set {instruction_set}, tasks by {}", info.tasking));
        if !info.missing.is_empty() {
            self.healthy = false;
            let missing = info.missing.join(", ");
            self.row("", format!("BROKEN: this Embree was built without {missing}"));
        }
        if info.culls_sphere_back_faces == Some(true) {
            self.healthy = false;
            self.row("", "BROKEN: this Embree misses spheres from inside (back-face culling)");
            self.row("", "use --accel embree-user or native, or another build of Embree");
        }
    }

    fn backend(&mut self, backend: Backend) {
        let name = format!("--accel {}", backend.name());
        match try_out(backend) {
            Ok(()) => self.wide_row(&name, "works"),
            Err(error) => self.broken(&name, &error),
        }
    }

    /// Adds the intersector that `--accel auto` chooses for each number of spheres.
    fn choice(&mut self) {
        let few = BackendChoice::BRUTE_FORCE_MAX_SPHERES;
        let up_to = format!("up to {few} spheres");
        for (name, spheres, words) in [("--accel auto", few, &*up_to), ("", few + 1, "more")] {
            let SelectedBackend { backend, reason } = BackendChoice::Auto.select_for_count(spheres);
            self.wide_row(name, format!("{words}: {} ({reason})", backend.name()));
        }
    }

    /// Adds the library that denoises pictures.
    fn denoiser(&mut self) {
        match Denoiser::load() {
            Ok(denoiser) => self.row("oidn", denoiser.name()),
            Err(error) => {
                self.row("oidn", format!("not found: {error}"));
                self.row("", error.help().unwrap_or_default());
            }
        }
        self.row("", "denoises pictures: photosphere denoise, or render --denoise");
    }

    fn companion(&mut self, companion: &Companion) {
        match find_program(companion.program) {
            Some(path) => self.row(companion.name, path.display()),
            None => self.row(companion.name, format!("not found; {}", companion.how_to_get)),
        }
        self.row("", companion.gain);
    }

    fn broken(&mut self, name: &str, error: &Error) {
        self.healthy = false;
        self.wide_row(name, format!("BROKEN: {error}"));
        if let Some(help) = error.help() {
            self.wide_row("", help);
        }
    }
}

/// Returns the first file of this name in the folders of PATH.
fn find_program(name: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path).map(|folder| folder.join(name)).find(|file| file.is_file())
}

/// Builds the intersector over two spheres, and checks the front hit of one from outside and its
/// back hit from inside.
fn try_out(backend: Backend) -> Result<()> {
    let ball = |x| Sphere { center: DVec3::new(x, 0.0, 0.0), radius: 1.0 };
    let rows = SphereRows { exact: vec![ball(-3.0), ball(3.0)], table: Vec::new() };
    let spheres = Arc::new(SphereSet::new(rows)?);
    let accel = backend.build(&spheres, &BuildOptions::default())?;
    for (start, expected) in [(0.0, 2.0), (3.0, 1.0)] {
        let origin = DVec3::new(start, 0.0, 0.0) - spheres.origin();
        let ray = PathRay::new(origin, DVec3::X);
        let found = distance(accel.as_ref(), &spheres, &ray);
        if found != Some(expected) {
            return Err(Error::backend(format!(
                "a wall at distance {expected} was found at {found:?}"
            )));
        }
    }
    Ok(())
}

fn distance(accel: &dyn Accel, spheres: &SphereSet, ray: &PathRay) -> Option<f64> {
    let mut hits = [Hit::MISS];
    accel.closest(&[spheres.to_query(ray)], &mut hits);
    spheres.resolve_hit(ray, hits[0]).map(|hit| hit.t)
}
