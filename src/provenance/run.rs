//! What one run was like.

use crate::accel;
use crate::output::Record;

/// The name of the record with [`Run::intersector`].
pub const INTERSECTOR_CHOICE: &str = "intersector-choice";

/// Figures of one run; nothing of them decides the pixels.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// The command line, quoted for a shell.
    pub command: String,
    /// The scene file's full path.
    pub scene_file: String,
    /// Rays traced.
    pub rays: u64,
    /// Seconds that rendering took, without loading and building.
    pub seconds: f64,
    /// Threads that it took.
    pub threads: usize,
    /// The error that 95 % of the values stay below, or another share where one was asked for, as a
    /// share of the brightness; `None` where it is not known.
    pub error: Option<f64>,
    /// The noise that was asked for, in words.
    pub noise: Option<String>,
    /// Which intersector found the hits, and why it.
    pub intersector: String,
}

impl Run {
    /// As records of a file.
    pub fn records(&self) -> Vec<Record> {
        let mut records = vec![
            Record::new("command", &self.command),
            Record::new("scene-file", &self.scene_file),
            Record::new("rays", self.rays.to_string()),
            Record::new("seconds", format!("{:.3}", self.seconds)),
            Record::new("threads", self.threads.to_string()),
            Record::new(INTERSECTOR_CHOICE, &self.intersector),
        ];
        records.extend(self.error.map(|error| Record::new("error", format!("{error:.3e}"))));
        records.extend(self.noise.as_ref().map(|noise| Record::new("noise", noise)));
        if let Some(Ok(info)) = accel::embree_info() {
            let text = format!(
                "{}, compiled against {}, {}, {}",
                info.runtime_version, info.compiled_version, info.instruction_set, info.tasking
            );
            records.push(Record::new("embree", text));
        }
        records
    }
}
