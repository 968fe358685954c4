//! Identifies the intersector that rendered a picture.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::backend::{Backend, embree_info};

/// A backend with everything that affects its results: equal intersectors give equal hits.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Intersector {
    /// The backend.
    pub backend: Backend,
    /// The Embree library; `None` for our own backends, which change only with the program.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub embree: Option<EmbreeBuild>,
}

/// An Embree library on some processor. Its kernels round differently for each instruction set.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EmbreeBuild {
    /// Version of the library, such as `4.3.3`.
    pub version: String,
    /// The instruction set that Embree selected, such as `AVX2`.
    pub instruction_set: String,
}

impl Intersector {
    /// The intersector of this backend on this machine.
    pub fn for_backend(backend: Backend) -> Self {
        let embree = match embree_info() {
            Some(Ok(info)) if backend.uses_embree() => Some(EmbreeBuild {
                version: info.runtime_version,
                instruction_set: info.instruction_set.to_owned(),
            }),
            _ => None,
        };
        Self { backend, embree }
    }
}

/// Formats as `native` or `embree 4.3.3, AVX2`.
impl fmt::Display for Intersector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.backend.name())?;
        match &self.embree {
            Some(EmbreeBuild { version, instruction_set }) => {
                write!(f, " {version}, {instruction_set}")
            }
            None => Ok(()),
        }
    }
}
