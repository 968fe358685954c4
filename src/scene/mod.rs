//! What is to be seen: values ([`Description`], [`Settings`]) that a program fills in or a scene file
//! holds, and the immutable [`Scene`] that is built of them.

mod arrays;
mod biases;
mod builder;
mod colors;
mod complaint;
pub mod data;
pub mod description;
mod environment;
mod import;
mod key_values;
pub mod keys;
mod kinds;
pub(crate) mod paths;
mod problem;
mod rows;
#[allow(clippy::module_inception, reason = "the room is called after what it makes")]
mod scene;
pub mod settings;
mod shot;
mod source;
mod storage;
mod suggest;
mod surface;
mod toml;
mod validate;

pub use builder::{Builder, Material};
pub use data::{SphereArrays, SphereData};
pub use description::Description;
pub use scene::Scene;
pub use settings::Settings;
pub use shot::Shot;
pub use source::{FileHash, Identity, Source};
pub use surface::Surface;

pub use self::toml::{Override, SceneFile, read_file, read_text};
