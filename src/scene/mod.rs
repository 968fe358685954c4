//! Scenes and render settings: plain values ([`SceneDescription`], [`Settings`]) from a program or
//! a scene file, and the immutable [`Scene`] built from them.

mod arrays;
mod biases;
mod builder;
mod camera;
mod camera_fit;
mod casters;
mod colors;
mod column_layers;
mod column_limits;
mod columns;
mod complaint;
pub mod data;
pub mod description;
mod direction_value;
mod environment;
mod file_layout;
mod import;
mod key_values;
pub mod keys;
mod light_preset;
mod light_trap;
mod loaded_particles;
mod no_effect;
mod npy;
mod particle_file;
mod particle_radii;
mod particle_table;
pub(crate) mod paths;
mod prepared_scene;
#[allow(clippy::module_inception, reason = "the room is called after what it makes")]
mod scene;
pub mod settings;
mod size;
mod source;
mod sphere_material;
mod storage;
mod straight_boundaries;
mod surface;
mod synonyms;
mod table_chunk;
mod table_layout;
mod table_path;
mod table_reader;
mod toml;
mod validate;
mod validation_errors;
mod value_types;

pub use builder::{MaterialHandle, SceneBuilder};
pub use column_layers::{ColumnLayers, LayerValues, ROW_LAYER};
pub use data::{SphereArrays, SphereData};
pub use description::SceneDescription;
pub use loaded_particles::LoadedParticles;
pub use particle_file::ParticleTable;
pub use particle_table::FileRows;
pub use prepared_scene::{CameraEnclosure, PreparedScene};
pub use scene::Scene;
pub use settings::Settings;
pub use size::SceneSize;
pub use source::{ContentHash, FileHash, SceneSource};
pub use sphere_material::SphereMaterial;
pub(crate) use sphere_material::Surface;

pub use self::toml::{
    Override, SceneFile, TableInput, read_file, read_stream, read_text, read_text_reusing,
    read_text_with,
};
