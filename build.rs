//! Tells the program which commit it is built from and what the compiler knows, and builds the seam
//! to Embree: finds it, compiles `ffi/shim.c`, binds `ffi/shim.h`, and links.
//!
//! `EMBREE_DIR` (with `include` and `lib` or `lib64`) is tried first and alone, then the system;
//! Embree 4 before 3. A system without Embree or libclang gets a build without the intersectors of
//! Embree, and a warning that says so; what is there and does not work is an error. Without the
//! feature `embree` there is nothing to do.

#![allow(clippy::print_stdout, reason = "that is how a build script speaks to cargo")]

use std::path::Path;
use std::process::Command;

/// What the program is built from. It is looked at again only when some of it changes, which builds
/// everything anew anyway; so the commit that is told is one with this very source.
const SOURCES: [&str; 5] = ["build.rs", "src", "ffi", "Cargo.toml", "Cargo.lock"];

fn main() {
    println!("cargo::rustc-check-cfg=cfg(has_avx512)");
    if rust_version().is_some_and(|minor| minor >= 89) {
        println!("cargo::rustc-cfg=has_avx512");
    }
    for source in SOURCES.into_iter().filter(|source| Path::new(source).exists()) {
        println!("cargo::rerun-if-changed={source}");
    }
    let commit = commit().unwrap_or_else(|| "unknown".to_owned());
    println!("cargo::rustc-env=PHOTOSPHERE_COMMIT={commit}");
    println!("cargo::rustc-check-cfg=cfg(has_embree)");
    #[cfg(feature = "embree")]
    match embree::build() {
        Ok(()) => println!("cargo::rustc-cfg=has_embree"),
        Err(failure) => failure.report(),
    }
}

/// The minor version of the compiler: Rust 1.89 is the first that knows AVX-512.
fn rust_version() -> Option<u32> {
    let rustc = std::env::var_os("RUSTC")?;
    let told = Command::new(rustc).arg("--version").output().ok()?;
    let told = String::from_utf8(told.stdout).ok()?;
    told.strip_prefix("rustc 1.")?.split('.').next()?.parse().ok()
}

/// The commit, where this folder is the top of a repository and not unpacked somewhere in one.
fn commit() -> Option<String> {
    let git = |arguments: &[&str]| {
        let output =
            Command::new("git").arg("--no-optional-locks").args(arguments).output().ok()?;
        let text = String::from_utf8(output.stdout).ok()?;
        output.status.success().then(|| text.trim().to_owned())
    };
    let below_the_top = git(&["rev-parse", "--show-prefix"])?;
    let commit = git(&["rev-parse", "--short=12", "HEAD"]).filter(|_| below_the_top.is_empty())?;
    let changes = git(&[&["status", "--porcelain", "--"], &SOURCES[..]].concat())?;
    Some(if changes.is_empty() { commit } else { format!("{commit} with changes") })
}

#[cfg(feature = "embree")]
mod embree {
    use std::env;
    use std::panic;
    use std::path::{Path, PathBuf};

    /// Follows every message.
    const ADVICE: &str = "\
        Debian, Ubuntu: apt-get install build-essential libembree-dev libclang-dev\n\
        Elsewhere: a C compiler, libclang, and Embree 3.13 or 4; EMBREE_DIR may name its folder.";

    /// Why there is no Embree in this build.
    pub(super) enum Failure {
        /// What the system lacks.
        Missing(String),
        /// What is there, or was asked for, and does not work.
        Broken(String),
    }

    impl Failure {
        pub(super) fn report(&self) {
            let (kind, message, end) = match self {
                Self::Missing(message) => (
                    "warning",
                    format!(
                        "Built without the intersectors of Embree: {message}\n\
                        `native` renders the same pictures, faster. To have Embree's, too:"
                    ),
                    "Then touch build.rs and build again.",
                ),
                Self::Broken(message) => (
                    "error",
                    message.clone(),
                    "Or build with --no-default-features --features cli, without Embree.",
                ),
            };
            for line in message.lines().chain(ADVICE.lines()).chain([end]) {
                println!("cargo::{kind}={line}");
            }
        }
    }

    type Result<T, E = String> = std::result::Result<T, E>;

    /// Where Embree is, and which.
    struct Embree {
        major: u32,
        /// The folder with `include` and the one with the library; the system's own where `None`.
        folders: Option<(PathBuf, PathBuf)>,
    }

    pub(super) fn build() -> Result<(), Failure> {
        println!("cargo::rerun-if-env-changed=EMBREE_DIR");
        let folder = env::var_os("EMBREE_DIR");
        let (found, failure): (_, fn(String) -> Failure) = match &folder {
            Some(folder) => (Embree::in_folder(Path::new(folder)), Failure::Broken),
            None => (Embree::of_the_system(), Failure::Missing),
        };
        let embree = found.and_then(|embree| find_libclang().map(|()| embree)).map_err(failure)?;
        bind().and_then(|()| embree.compile()).map_err(Failure::Broken)?;
        embree.link();
        Ok(())
    }

    impl Embree {
        fn in_folder(folder: &Path) -> Result<Self> {
            let include = folder.join("include");
            let header = |major| include.join(format!("embree{major}/rtcore_config.h"));
            let major =
                [4, 3].into_iter().find(|&major| header(major).is_file()).ok_or_else(|| {
                    format!("EMBREE_DIR: there is no Embree 4 or 3 in {}", include.display())
                })?;
            println!("cargo::rerun-if-changed={}", header(major).display());
            let lib = ["lib", "lib64"].map(|name| folder.join(name));
            let lib = lib.into_iter().find(|lib| has_library(lib, major)).ok_or_else(|| {
                format!("EMBREE_DIR: there is no embree{major} library in {}/lib", folder.display())
            })?;
            Ok(Self { major, folders: Some((include, lib)) })
        }

        /// Lets the C compiler look, which knows the system's folders.
        fn of_the_system() -> Result<Self> {
            let probe = quiet_compiler().file("ffi/probe.c").try_expand();
            let probe = probe.map_err(|error| format!("The C compiler does not work: {error}"))?;
            let probe = String::from_utf8_lossy(&probe);
            let major = [4, 3].into_iter().find(|m| probe.contains(&format!("found_embree = {m}")));
            let major = major.ok_or("Embree's headers are not installed.")?;
            // Preprocessor lines such as `# 1 "/usr/include/embree4/rtcore_config.h"`: the file
            // changes, or goes, when another Embree is installed.
            let names = probe.lines().filter(|line| line.starts_with('#'));
            let config = names.filter_map(|line| line.split('"').nth(1));
            if let Some(file) = config.into_iter().find(|name| name.ends_with("rtcore_config.h")) {
                println!("cargo::rerun-if-changed={file}");
            }
            Ok(Self { major, folders: None })
        }

        fn compile(&self) -> Result<()> {
            let mut compiler = cc::Build::new();
            if let Some((include, _)) = &self.folders {
                compiler.include(include);
            }
            compiler
                .file("ffi/shim.c")
                .define("EMBREE_MAJOR", self.major.to_string().as_str())
                .std("c11")
                .opt_level(3)
                .extra_warnings(true)
                // The same bits as the same formula in Rust.
                .flag_if_supported("-ffp-contract=off")
                .flag_if_supported("-fno-math-errno")
                .try_compile("photosphere_shim")
                .map_err(|error| format!("ffi/shim.c does not compile: {error}"))
        }

        /// After the shim's own line, because the shim needs Embree and not the reverse.
        fn link(&self) {
            if let Some((_, lib)) = &self.folders {
                println!("cargo::rustc-link-search=native={}", lib.display());
                if env::var_os("CARGO_CFG_UNIX").is_some() {
                    println!("cargo::rustc-link-arg=-Wl,-rpath,{}", lib.display());
                }
            }
            println!("cargo::rustc-link-lib=embree{}", self.major);
            if env::var_os("CARGO_CFG_UNIX").is_some() {
                println!("cargo::rustc-link-lib=m");
            }
        }
    }

    /// A compiler for questions: it prints nothing.
    fn quiet_compiler() -> cc::Build {
        let mut compiler = cc::Build::new();
        compiler.cargo_metadata(false).cargo_warnings(false);
        compiler
    }

    fn has_library(folder: &Path, major: u32) -> bool {
        let Ok(files) = folder.read_dir() else { return false };
        let names = files.flatten().filter_map(|file| file.file_name().into_string().ok());
        names
            .map(|name| name.trim_start_matches("lib").to_owned())
            .any(|name| name.starts_with(&format!("embree{major}.")))
    }

    fn find_libclang() -> Result<()> {
        // bindgen panics where there is no libclang; nobody should have to read that.
        let hook = panic::take_hook();
        panic::set_hook(Box::new(|_| {}));
        let clang = panic::catch_unwind(bindgen::clang_version);
        panic::set_hook(hook);
        clang.map(drop).map_err(|_| "libclang is not installed.".to_owned())
    }

    fn bind() -> Result<()> {
        let rust = bindgen::RustTarget::stable(85, 0).map_err(|error| error.to_string())?;
        let bindings = bindgen::builder()
            .header("ffi/shim.h")
            .parse_callbacks(Box::new(bindgen::CargoCallbacks::new()))
            .allowlist_item("(ps|Ps|PS)_?.*")
            .rust_target(rust)
            .rust_edition(bindgen::RustEdition::Edition2024)
            .formatter(bindgen::Formatter::None)
            .generate()
            .map_err(|error| format!("libclang cannot read ffi/shim.h: {error}"))?;
        let out = env::var_os("OUT_DIR").ok_or("OUT_DIR is not set: run this through cargo.")?;
        let file = Path::new(&out).join("shim.rs");
        bindings
            .write_to_file(&file)
            .map_err(|error| format!("cannot write {}: {error}", file.display()))
    }
}
