//! What is known of the Embree that this program runs with.

/// The Embree library, as it describes itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EmbreeInfo {
    /// Version of the headers that this program was compiled against, such as `4.3.3`.
    pub compiled_version: String,
    /// Version of the library that runs.
    pub runtime_version: String,
    /// The instructions that it selected on this processor.
    pub instruction_set: &'static str,
    /// What runs its build threads.
    pub tasking: &'static str,
    /// Whether it was built to overlook the inside of spheres; `None` where the version does not
    /// tell. If so, the backend `embree` refuses to work and `embree-user` is the way out.
    pub culls_sphere_back_faces: Option<bool>,
    /// Features that photosphere needs and that it was built without.
    pub missing: Vec<&'static str>,
}
