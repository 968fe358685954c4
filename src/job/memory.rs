//! How much memory a scene will take, told before any of it is taken: from the scene's description,
//! the lengths of its tables, and what the intersectors say of themselves.
//!
//! Memory is held in steps that follow one another: the tables are read, the spheres sorted, the tree
//! built, the picture rendered. The peak is the largest of them.

use crate::accel::Backend;
use crate::film::{Film, Kind, Scale};
use crate::scene::SceneFile;
use crate::scene::description::{ColorStorage, Description};

use super::film_format::format_with;

/// Bytes of one sphere: `[x, y, z, radius]` in f32.
const SPHERE: u64 = 16;
/// Bytes of the row of one sphere.
const ROW: u64 = 4;
/// Bytes of one sphere that is written out in the scene, in the description and beside it.
const WRITTEN_OUT: u64 = 256;
/// Bytes of one lamp, in the list and the hierarchy of lamps.
const LAMP: u64 = 288;
/// Bytes of one pixel of the background's image: the image, and what directions are drawn by.
const BACKGROUND_PIXEL: u64 = 48;
/// Bytes of one pixel of the finished picture and of the file that it becomes.
const PICTURE_PIXEL: u64 = 32;
/// The program itself, without Embree's library and with it.
const PROGRAM: [u64; 2] = [10 << 20, 12 << 20];
/// What one thread takes for its paths.
const THREAD: u64 = 1 << 20;

/// The memory plan of one render. All figures are bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MemoryPlan {
    /// The spheres themselves.
    pub spheres: u64,
    /// The row of each sphere.
    pub rows: u64,
    /// The spheres' own colours.
    pub colors: u64,
    /// The lamps and the hierarchy over them.
    pub lamps: u64,
    /// The background's image.
    pub background: u64,
    /// The trees of all intersectors.
    pub tree: u64,
    /// The most that is held for trees while they are built.
    pub build: u64,
    /// Film and picture.
    pub film: u64,
    /// The program and its threads.
    pub program: u64,
}

/// What happens when the most memory is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// The spheres are put in order.
    Sorting,
    /// Trees are built.
    Building,
    /// The picture is rendered.
    Rendering,
}

impl MemoryPlan {
    /// The plan for a scene of which nothing large was read yet, with these intersectors built one
    /// after the other and kept, a picture with these layers, and `threads` threads. `colors`
    /// overrides how the tables' colours are kept.
    pub fn new(
        file: &SceneFile,
        backends: &[Backend],
        kinds: &[Kind],
        threads: usize,
        colors: Option<ColorStorage>,
    ) -> Self {
        let description = &file.description;
        // How bright the lamps are does not change the film's size.
        let transparent = description.background.transparent;
        let scale = Scale::of_brightest(1.0);
        let format = format_with(&file.settings, transparent, scale, kinds);
        let written_out = description.spheres.len() as u64;
        let bare = Self::of_spheres(file.sphere_count(), backends, threads);
        Self {
            spheres: bare.spheres + written_out * WRITTEN_OUT,
            colors: bytes_of_colors(file, colors),
            lamps: count_lamps(file) * LAMP,
            background: file.environment_pixels() * BACKGROUND_PIXEL,
            film: Film::bytes(&format) as u64 + format.frame.pixels() as u64 * PICTURE_PIXEL,
            ..bare
        }
    }

    /// The plan for so many spheres without anything else, and these intersectors.
    pub fn of_spheres(count: u64, backends: &[Backend], threads: usize) -> Self {
        let mut trees = Trees::default();
        backends.iter().for_each(|backend| trees.build(*backend, count));
        let with_embree = backends.iter().any(|backend| backend.uses_embree());
        Self {
            spheres: count * SPHERE,
            rows: count * ROW,
            colors: 0,
            lamps: 0,
            background: 0,
            tree: trees.finished,
            build: trees.peak,
            film: 0,
            program: PROGRAM[usize::from(with_embree)] + threads as u64 * THREAD,
        }
    }

    /// The most that is held at any time.
    pub fn peak(&self) -> u64 {
        self.step(self.critical())
    }

    /// When the most is held.
    pub fn critical(&self) -> Step {
        let steps = [Step::Sorting, Step::Building, Step::Rendering];
        steps.into_iter().max_by_key(|&step| self.step(step)).unwrap_or(Step::Rendering)
    }

    /// What is held in a step at most.
    pub fn step(&self, step: Step) -> u64 {
        let scene = self.spheres + self.rows + self.colors + self.background + self.program;
        match step {
            // The spheres in their old and in their new order.
            Step::Sorting => scene + self.spheres,
            Step::Building => scene + self.lamps + self.build,
            Step::Rendering => scene + self.lamps + self.tree + self.film,
        }
    }
}

/// Trees that are built one after the other.
#[derive(Default)]
struct Trees {
    finished: u64,
    peak: u64,
}

impl Trees {
    fn build(&mut self, backend: Backend, spheres: u64) {
        let planned = backend.planned_bytes(spheres);
        self.peak = self.peak.max(self.finished + planned.peak);
        self.finished += planned.finished;
    }
}

fn bytes_of_colors(file: &SceneFile, storage: Option<ColorStorage>) -> u64 {
    let tables = file.description.tables.iter().zip(file.table_rows());
    let colored = tables.filter(|(table, _)| table.data.has_colors());
    let bytes =
        colored.map(|(table, rows)| rows * storage.unwrap_or(table.colors).bytes_each() as u64);
    bytes.sum()
}

fn count_lamps(file: &SceneFile) -> u64 {
    let Description { materials, spheres, tables, .. } = &file.description;
    let shines = |material: usize| materials[material].emission.max_element() > 0.0;
    let written_out = spheres.iter().filter(|sphere| shines(sphere.material)).count() as u64;
    let of_tables = tables.iter().zip(file.table_rows());
    let of_tables = of_tables.filter(|(table, _)| shines(table.material)).map(|(_, rows)| rows);
    written_out + of_tables.sum::<u64>()
}
