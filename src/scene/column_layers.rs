//! Columns of a particle file as layers of a picture: each pixel has the number of the particle
//! that its layer `sphere_id` names. The layer `row` has its row in the file.

use std::path::Path;

use crate::color::NO_ROW;
use crate::error::{Error, Result};
use crate::image_io::{ChannelValues, ImageChannel, Picture};
use crate::particles::{ColumnData, Wanted, read, survey};

use super::data::SphereData;
use super::particle_file::ParticleTable;
use super::particle_table::FileRows;
use super::{Scene, SceneDescription, SceneFile};

/// The layer that tells which sphere a pixel shows.
const SPHERE_ID: &str = "sphere_id";

/// Channels that are no layers.
const BEAUTY_CHANNELS: [&str; 4] = ["R", "G", "B", "A"];

/// The layer of rows, unless a column has that name.
pub const ROW_LAYER: &str = "row";

/// Numbers of columns of the first particle file of a scene, by row of the file.
#[derive(Clone, Debug)]
pub struct ColumnLayers {
    /// Index of the table of the particles.
    table: usize,
    rows: FileRows,
    columns: Vec<(String, LayerValues)>,
}

/// What a layer shows of each particle, by row of the file.
#[derive(Clone, Debug)]
pub enum LayerValues {
    /// A number.
    Numbers(Vec<f32>),
    /// The row itself, or the row that it stands for.
    Rows(Option<Vec<u32>>),
}

impl ColumnLayers {
    /// Reads columns of the particles of a scene file.
    ///
    /// # Errors
    /// If the scene has no particle file, or that file lacks a column of numbers with such a name.
    pub fn of_scene_file(file: &SceneFile, names: &[String]) -> Result<Self> {
        let (table, particles) = first_particles(&file.description, names)?;
        let rows = file.particles().next().map(|loaded| loaded.file_rows());
        Self::read(table, particles, rows.unwrap_or_default(), names)
    }

    /// Takes the values of all particles of a scene, whose arrays a program has in memory.
    ///
    /// # Errors
    /// As for [`Self::of_scene_file`].
    pub fn of_values(file: &SceneFile, columns: Vec<(String, LayerValues)>) -> Result<Self> {
        let names: Vec<String> = columns.iter().map(|(name, _)| name.clone()).collect();
        let (table, _) = first_particles(&file.description, &names)?;
        refuse_colour_channels(&names)?;
        let rows = file.particles().next().map(|loaded| loaded.file_rows()).unwrap_or_default();
        Ok(Self { table, rows, columns })
    }

    /// Reads columns of the particles of a scene whose files are in a folder.
    ///
    /// # Errors
    /// As for [`Self::of_scene_file`].
    pub fn of_description(
        description: &SceneDescription,
        folder: &Path,
        names: &[String],
    ) -> Result<Self> {
        let (table, particles) = first_particles(description, names)?;
        let mut particles = particles.clone();
        particles.for_each_file(&mut |file| *file = folder.join(&*file));
        let rows = particles.file_rows()?;
        Self::read(table, &particles, rows, names)
    }

    fn read(
        table: usize,
        particles: &ParticleTable,
        rows: FileRows,
        names: &[String],
    ) -> Result<Self> {
        refuse_colour_channels(names)?;
        let is_row = names_rows(particles, names)?;
        let to_read = names.iter().filter(|name| !(is_row && *name == ROW_LAYER)).cloned();
        let wanted: Vec<String> = to_read.collect();
        if wanted.is_empty() {
            let layers = names.iter().map(|name| (name.clone(), LayerValues::Rows(None)));
            return Ok(Self { table, rows, columns: layers.collect() });
        }
        let found = read(&particles.path, &particles.request(Wanted::Only(wanted)))?;
        let values = |name: &String| {
            if is_row && name == ROW_LAYER {
                return Ok((name.clone(), LayerValues::Rows(None)));
            }
            let column = found.column(name).filter(|c| !matches!(c.data, ColumnData::Text(_)));
            let column = column.ok_or_else(|| {
                let file = particles.path.display();
                Error::input(format!("the column `{name}` of `{file}` has words"))
                    .with_help("a layer holds numbers; name another column")
            })?;
            let all = (0..column.data.len()).map(|row| column.number(row) as f32);
            Ok((name.clone(), LayerValues::Numbers(all.collect())))
        };
        Ok(Self { table, rows, columns: names.iter().map(values).collect::<Result<_>>()? })
    }

    /// The names of the columns.
    pub fn names(&self) -> Vec<String> {
        self.columns.iter().map(|(name, _)| name.clone()).collect()
    }

    /// Adds the layers to a picture of the scene that has the layer `sphere_id`. Pixels without a
    /// particle are NaN, or [`NO_ROW`] in the layer of rows.
    pub fn add_to(&self, picture: &mut Picture, scene: &Scene) {
        let ids = picture.channels.iter().find(|channel| channel.name == SPHERE_ID);
        let Some(ChannelValues::Uint(ids)) = ids.map(|channel| &channel.values) else { return };
        let row_in_file = |id: &u32| {
            let id = Some(*id).filter(|id| *id != NO_ROW)?;
            let (_, row) = scene.table_and_row(id).filter(|(table, _)| *table == self.table)?;
            self.rows.row_in_file(row)
        };
        let rows: Vec<Option<u32>> = ids.iter().map(row_in_file).collect();
        for (name, values) in &self.columns {
            picture.channels.push(ImageChannel::new(name, values.of_rows(&rows)));
        }
    }
}

impl LayerValues {
    /// The values of the particles that the pixels show.
    fn of_rows(&self, rows: &[Option<u32>]) -> ChannelValues {
        match self {
            Self::Numbers(numbers) => {
                let number = |row: &Option<u32>| row.map_or(f32::NAN, |row| numbers[row as usize]);
                ChannelValues::Float(rows.iter().map(number).collect())
            }
            Self::Rows(None) => {
                ChannelValues::Uint(rows.iter().map(|row| row.unwrap_or(NO_ROW)).collect())
            }
            Self::Rows(Some(origins)) => {
                let origin = |row: &Option<u32>| row.map_or(NO_ROW, |row| origins[row as usize]);
                ChannelValues::Uint(rows.iter().map(origin).collect())
            }
        }
    }
}

/// Returns true if a layer `row` is wanted that is not a column of the file.
fn names_rows(particles: &ParticleTable, names: &[String]) -> Result<bool> {
    if names.iter().all(|name| name != ROW_LAYER) {
        return Ok(false);
    }
    let survey = survey(&particles.path, &particles.request(Wanted::All))?;
    Ok(survey.columns.iter().all(|column| column.name != ROW_LAYER))
}

fn refuse_colour_channels(names: &[String]) -> Result<()> {
    let Some(name) = names.iter().find(|name| BEAUTY_CHANNELS.contains(&&***name)) else {
        return Ok(());
    };
    let message = format!("the layer `{name}` would have the name of a colour channel");
    Err(Error::input(message).with_help("rename the column"))
}

/// The first particle file of a scene, with the index of its table.
fn first_particles<'d>(
    description: &'d SceneDescription,
    names: &[String],
) -> Result<(usize, &'d ParticleTable)> {
    let tables = description.tables.iter().enumerate();
    let mut particles = tables.filter_map(|(index, table)| match &table.data {
        SphereData::Particles(particles) => Some((index, &**particles)),
        _ => None,
    });
    particles.next().ok_or_else(|| {
        let name = names.first().map_or("", String::as_str);
        Error::input(format!("there is no layer `{name}`"))
            .with_help("columns are layers only in pictures of particle files")
    })
}
