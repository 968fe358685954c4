//! A render at work: what it keeps and writes, at any time and from any thread.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::Instant;

use serde_json::json;

use crate::accel::Accel;
use crate::error::{Error, Result};
use crate::film::{Film, hands};
use crate::integrator::Tally;
use crate::output::{Record, write_part};
use crate::provenance::{Counts, Made, Run, Samples};
use crate::render::{self, Session};
use crate::scene::Scene;

use super::super::args::RenderArgs;
use super::super::exit::Exit;
use super::super::goal::{Goal, Reached};
use super::super::keeper::Chore;
use super::super::outputs::Outputs;
use super::super::watch::Told;
use super::super::{on_threads, print, system};
use super::report::{self, Figures, Report};
use super::start::{Before, Keep};

/// The name of the record that says how to go on.
pub(in crate::cli) const RESUME: &str = "resume";

/// The name of the record of a part that is finished, however many samples its pixels have.
pub(in crate::cli) const ENDED: &str = "ended";

/// The name of the record of a part that ended without having met its noise target: how far it got.
pub(in crate::cli) const MISSED: &str = "missed";

/// A render at work.
pub(super) struct Job<'a> {
    pub(super) args: &'a RenderArgs,
    pub(super) scene: &'a Scene,
    pub(super) accel: &'a dyn Accel,
    pub(super) session: &'a Session<'a>,
    /// The samples that every pixel is to have.
    pub(super) samples: Range<u32>,
    pub(super) outputs: &'a Outputs,
    pub(super) keep: Option<&'a Keep>,
    pub(super) goal: &'a Goal,
    pub(super) told: &'a Told,
    /// Set when it has come to its end, be that at a noise target or at a time.
    pub(super) has_ended: AtomicBool,
    /// Set when it has ended without having met its noise target.
    pub(super) missed: OnceLock<String>,
    /// What decides the pixels, but for how many samples they have so far.
    pub(super) made: Made,
    /// The intersector, and why it.
    pub(super) intersector: String,
    pub(super) before: Before,
    pub(super) samples_before: u64,
    pub(super) began: Instant,
    /// Held while all is saved, so that it is saved once.
    pub(super) saving: Mutex<()>,
}

impl Job<'_> {
    fn film(&self) -> &Film {
        self.session.film()
    }

    /// What is to be done beside it.
    pub(super) fn chores(&self) -> Vec<Chore<'_>> {
        let keep = self.keep.map(|keep| Chore {
            what: format!("write `{}`", keep.path.display()),
            every: keep.every,
            work: Box::new(|| self.save_part(keep)),
        });
        keep.into_iter().collect()
    }

    /// Saves what there is and ends the program.
    pub(super) fn give_up(&self) {
        self.has_ended.fetch_or(self.goal.is_time_up(), Ordering::Relaxed);
        // The threads that render are stuck, so others must help.
        let saved = on_threads(self.args.scene.threads(), || self.save_all());
        if saved.is_ok() && !self.args.quiet {
            let kept = self.keep.map(|keep| keep.path.as_path());
            print::remark(report::ending(self.args, self.film(), self.goal.is_time_up(), kept));
        }
        // Never let go: the threads that render may get here yet.
        let _saving = self.saving.lock().unwrap_or_else(PoisonError::into_inner);
        let exit = match saved {
            Ok(()) if self.goal.is_time_up() => Exit::Done,
            Ok(()) => Exit::Stopped,
            Err(error) => {
                super::super::error::print(&error);
                Exit::of(&error)
            }
        };
        std::process::exit(i32::from(exit as u8));
    }

    /// Writes the part and the pictures.
    ///
    /// # Errors
    /// When something cannot be written; the others are, where they can be. When there is not one
    /// sample.
    pub(super) fn save_all(&self) -> Result<()> {
        let _saving = self.saving.lock().unwrap_or_else(PoisonError::into_inner);
        if self.film().samples() == 0 {
            let help = "no sample was finished, so no picture was written";
            return Err(Error::cancelled().with_help(help));
        }
        let (kept, shown) = hands::join(
            || self.keep.map_or(Ok(()), |keep| self.save_part(keep)),
            || self.save_pictures(),
        );
        match (kept, shown) {
            (Ok(()), Err(error)) if self.keep.is_some() => {
                let path = self.keep.map(|keep| keep.path.display().to_string());
                let path = path.unwrap_or_default();
                Err(error.with_help(format!(
                    "the samples are safe: photosphere resume '{path}' writes it again"
                )))
            }
            (kept, shown) => shown.and(kept),
        }
    }

    fn save_pictures(&self) -> Result<()> {
        if !self.outputs.has_pictures() {
            return Ok(());
        }
        let film = self.film();
        let picture = render::picture(self.scene, self.accel, film, self.outputs.kinds());
        // Whoever stops a render waits for the end of it.
        let quickly = self.session.cancel().is_cancelled() && !self.goal.is_time_up();
        let written =
            self.outputs.write(&picture, film.frame(), &self.made(), &self.run(), quickly);
        self.told.picture(picture);
        written
    }

    fn save_part(&self, keep: &Keep) -> Result<()> {
        let mut records = self.made().records();
        records.extend(self.run().records());
        let tally = self.tally();
        records.push(Record::new("media-overflows", tally.media_overflows.to_string()));
        records.push(Record::new("cut-off", tally.cut_off.to_string()));
        let last = self.scene.description().render.samples_per_pixel;
        records.push(Record::new("samples-per-pixel", last.to_string()));
        let transparent = self.scene.description().background.transparent;
        records.push(Record::new("transparent", transparent.to_string()));
        if self.has_ended.load(Ordering::Relaxed) {
            records.push(Record::new(ENDED, "true"));
        }
        records.extend(self.missed.get().map(|missed| Record::new(MISSED, missed)));
        records.push(self.outputs.record_of_layers());
        records.push(Record::new(RESUME, self.how_to_go_on().to_string()));
        write_part(&keep.file, self.film(), &self.samples, &records)
    }

    /// What `resume` needs to know of the command.
    fn how_to_go_on(&self) -> serde_json::Value {
        let resumed = self.args.resumed.as_ref();
        let arguments = match resumed {
            Some(resumed) => resumed.arguments.clone(),
            None => std::env::args_os()
                .skip(1)
                .map(|word| word.to_string_lossy().into_owned())
                .collect(),
        };
        let absolute = |file: &PathBuf| std::path::absolute(file).unwrap_or_else(|_| file.clone());
        let files: Vec<PathBuf> = self.args.output.files.iter().map(absolute).collect();
        json!({
            "arguments": arguments,
            "scene": absolute(&self.args.scene.path),
            "files": files,
            "preview": self.args.watch.preview.as_ref().map(absolute),
            "extended_to": resumed.and_then(|resumed| resumed.extended_to),
        })
    }

    fn made(&self) -> Made {
        let (fewest, most) = self.film().fewest_and_most();
        let samples = Samples { first: self.samples.start, fewest, most };
        // Parts that cut tiles may have been gone on with: then nothing short tells how many each has.
        let counts = Counts::of(self.film()).unwrap_or_default();
        Made { samples, counts, ..self.made.clone() }
    }

    fn run(&self) -> Run {
        Run {
            command: system::command_line(),
            scene_file: system::full_path(&self.args.scene.path),
            rays: self.tally().rays,
            seconds: self.before.seconds + self.began.elapsed().as_secs_f64(),
            threads: rayon::current_num_threads(),
            error: self.goal.error(self.film()),
            noise: self.goal.noise_in_words(),
            intersector: self.intersector.clone(),
        }
    }

    /// What happened in this run and those before.
    fn tally(&self) -> Tally {
        let Before { rays, media_overflows, cut_off, .. } = self.before;
        self.session.tally() + Tally { rays, media_overflows, cut_off }
    }

    /// Tells what came of it.
    ///
    /// # Errors
    /// When the standard output is closed.
    pub(super) fn report(
        &self,
        reached: &Reached,
        figures: &Figures,
        about_spheres: Vec<String>,
    ) -> Result<()> {
        let about_film = render::warnings(self.scene, &self.tally(), self.film());
        let complaint = reached.complaint();
        about_film.iter().chain(&complaint).for_each(print::warning);
        let report = Report {
            args: self.args,
            scene: self.scene,
            picture: self.film().picture(),
            reached,
            samples: self.session.samples_done() - self.samples_before,
            samples_in_all: self.session.samples_done(),
            rays: self.session.tally().rays,
            ending: report::ending(
                self.args,
                self.film(),
                reached.is_complete,
                self.keep.map(|keep| keep.path.as_path()),
            ),
            figures,
            warnings: about_spheres.into_iter().chain(about_film).chain(complaint).collect(),
        };
        report.print()
    }
}
