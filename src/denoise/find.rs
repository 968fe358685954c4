//! Where Open Image Denoise may be.

use std::env;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::error::Error;

/// The variable that names the folder of the library, or of its installation.
const FOLDER: &str = "OIDN_DIR";

/// The library's file, of the version of its interface that is used here.
const FILE: &str = if cfg!(target_os = "macos") {
    "libOpenImageDenoise.2.dylib"
} else if cfg!(windows) {
    "OpenImageDenoise.dll"
} else {
    "libOpenImageDenoise.so.2"
};

/// Where in its installation the library may be.
const INNER: [&str; 4] = ["", "lib", "lib64", "bin"];

/// Prints the folder of the Python package that contains the library, without importing it.
const PYTHON: &str = "import importlib.util as u; print(u.find_spec('pyoidn').origin)";

/// The files to try, the first that can be loaded wins: in the folder that the user names and
/// nowhere else, or the system's, that of a conda environment, and that of the Python package
/// `pyoidn`, in its folder `package` if that is known.
pub(super) fn candidates(package: Option<&Path>) -> impl Iterator<Item = PathBuf> {
    let named = env::var_os(FOLDER).filter(|folder| !folder.is_empty());
    let is_named = named.is_some();
    let of_user = named.into_iter().flat_map(|folder| in_folder(&folder));
    // A bare name is searched for by the system.
    let of_system = (!is_named).then(|| PathBuf::from(FILE));
    let conda = env::var_os("CONDA_PREFIX").filter(|_| !is_named);
    let of_conda = conda.into_iter().flat_map(|folder| in_folder(&folder));
    let of_python = std::iter::once_with(move || match package {
        _ if is_named => None,
        Some(package) => in_package(package),
        None => in_package(&package_of_shell()?),
    });
    of_user.chain(of_system).chain(of_conda).chain(of_python.flatten())
}

fn in_folder(folder: &OsStr) -> Vec<PathBuf> {
    let folder = Path::new(folder);
    let files = INNER.map(|inner| folder.join(inner).join(FILE));
    files.into_iter().filter(|file| file.is_file()).collect()
}

/// The library in the folder of the PyPI package `pyoidn`.
fn in_package(package: &Path) -> Option<PathBuf> {
    let library = package.join("oidn").join("lib").join(FILE);
    library.is_file().then_some(library)
}

/// The folder of the package `pyoidn` of the Python that a shell would start.
fn package_of_shell() -> Option<PathBuf> {
    let mut python = Command::new(if cfg!(windows) { "python" } else { "python3" });
    let output = python.args(["-c", PYTHON]).stdin(Stdio::null()).stderr(Stdio::null()).output();
    let text = String::from_utf8(output.ok()?.stdout).ok()?;
    Path::new(text.trim()).parent().map(Path::to_owned)
}

/// The error where none of the files could be loaded.
pub(super) fn missing(reasons: &[String]) -> Error {
    let message = match env::var_os(FOLDER).filter(|folder| !folder.is_empty()) {
        Some(folder) => format!(
            "Open Image Denoise is not in {FOLDER}, `{}`: {}",
            Path::new(&folder).display(),
            reasons.first().cloned().unwrap_or_else(|| format!("it has no {FILE}"))
        ),
        None => "denoising needs Intel Open Image Denoise 2, which is not installed".to_owned(),
    };
    Error::input(message).with_help(format!(
        "pip install pyoidn, or install it from your system (Debian: libopenimagedenoise2), or \
         unpack a release and name its folder: {FOLDER}=/opt/oidn"
    ))
}
