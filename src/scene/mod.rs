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
mod value_types;
pub(crate) mod paths;
mod validation_errors;
mod table_reader;
#[allow(clippy::module_inception, reason = "the room is called after what it makes")]
mod scene;
pub mod settings;
mod prepared_scene;
mod source;
mod storage;
mod suggest;
mod sphere_material;
mod toml;
mod validate;

pub use builder::{SceneBuilder, MaterialHandle};
pub use data::{SphereArrays, SphereData};
pub use description::SceneDescription;
pub use scene::Scene;
pub use settings::Settings;
pub use prepared_scene::PreparedScene;
pub use source::{FileHash, ContentHash, SceneSource};
pub use sphere_material::SphereMaterial;

pub use self::toml::{Override, SceneFile, read_file, read_text};
