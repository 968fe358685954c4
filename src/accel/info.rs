//! Version and features of the Embree library.

/// The Embree library, as Embree itself reports it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EmbreeInfo {
    /// Version of the headers that this program was compiled with, such as `4.3.3`.
    pub compiled_version: String,
    /// Version of the loaded library.
    pub runtime_version: String,
    /// The instruction set that Embree selected on this processor.
    pub instruction_set: &'static str,
    /// The tasking system that runs the build threads.
    pub tasking: &'static str,
    /// True if this Embree culls hits from inside spheres; `None` if the version does not report
    /// it. If true, the backend `embree` refuses to run; `embree-user` works.
    pub culls_sphere_back_faces: Option<bool>,
    /// Features that photosphere requires and this Embree lacks.
    pub missing: Vec<&'static str>,
}
