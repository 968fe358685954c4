//! A render at work: what it keeps and writes, at any time and from any thread.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::Instant;

use serde_json::json;

use crate::accel::Accel;
use crate::error::{Error, Result};
use crate::film::Film;
use crate::integrator::Tally;
use crate::output::{Record, WholeFile, write_part};
use crate::provenance::{Counts, Made, Run, Samples};
use crate::render::{self, Session};
use crate::scene::Scene;

use super::super::args::RenderArgs;
use super::super::exit::Exit;
use super::super::goal::{Goal, Reached};
use super::super::interrupt::Interrupt;
use super::super::keeper::Chore;
use super::super::outputs::Outputs;
use super::super::progress::Progress;
use super::super::watch::{LastLook, Told};
use super::super::{print, system};
use super::report::{self, Figures, Report};
use super::save::{self, Errand, Manner};
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
    pub(super) interrupt: &'a Interrupt,
    pub(super) progress: &'a Progress,
    /// What decides the pixels, but for how many samples they have so far.
    pub(super) made: Made,
    /// What came before the render took, and the intersector.
    pub(super) figures: Figures,
    /// What there was to warn of.
    pub(super) about_spheres: Vec<String>,
    pub(super) before: Before,
    pub(super) samples_before: u64,
    pub(super) began: Instant,
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
            work: Box::new(|| self.save_part(&keep.file, None)),
        });
        keep.into_iter().collect()
    }

    /// Saves what it came to, and tells of it. Saved first, and shown then: who looks on may keep nobody
    /// waiting.
    ///
    /// # Errors
    /// When something cannot be written, or there is nothing to write.
    pub(super) fn close(&self, reached: &Reached, last_look: &LastLook<'_>) -> Result<Exit> {
        self.told.end();
        let render_s = self.began.elapsed().as_secs_f64();
        let saved = self.save_all(reached);
        last_look.wait();
        saved?;
        self.report(reached, render_s)?;
        Ok(match (reached.is_complete, reached.is_good_enough()) {
            (false, _) => Exit::Stopped,
            // Of a picture that is shared out, the merge says so.
            (true, false) if self.outputs.has_pictures() => Exit::CheckFailed,
            (true, _) => Exit::Done,
        })
    }

    /// Writes the part and the pictures.
    ///
    /// # Errors
    /// When something cannot be written; the others are, where they can be, and what would be lost is
    /// elsewhere. When there is not one sample.
    fn save_all(&self, reached: &Reached) -> Result<()> {
        if self.film().samples() == 0 {
            let help = "no sample was finished, so no picture was written";
            return Err(Error::cancelled().with_help(help));
        }
        let (film, picture) = (self.film(), OnceLock::new());
        let shown = || {
            picture
                .get_or_init(|| render::picture(self.scene, self.accel, film, self.outputs.kinds()))
        };
        // Whoever stops a render waits for the end of it.
        let words =
            self.outputs.words(film.frame(), &self.made(), &self.run(), self.interrupt.is_asked());
        let part: Vec<Errand<'_>> =
            self.keep.map(|keep| self.errand_of(keep, reached)).into_iter().collect();
        let help = self.keep.map(|keep| {
            let path = keep.path.display();
            format!("the samples are safe: photosphere resume '{path}' writes it again")
        });
        let pictures = self.outputs.pictures().iter().map(|file| Errand {
            path: file.path.clone(),
            is_vital: self.keep.is_none(),
            help: help.clone().unwrap_or_default(),
            write: Box::new(|place| file.write(place, shown(), &words)),
        });
        let pictures: Vec<Errand<'_>> = pictures.collect();
        let warn = |text: String| self.progress.say(|| print::warning(&text));
        let manner = Manner { in_haste: &|| self.interrupt.is_asked(), warn: &warn };
        let saved = save::all(&part, &pictures, &manner);
        drop(pictures);
        if let Some(picture) = picture.into_inner() {
            self.told.picture(picture);
        }
        saved
    }

    fn errand_of<'a>(&'a self, keep: &'a Keep, reached: &'a Reached) -> Errand<'a> {
        let write = move |place: Option<&Path>| match place {
            None => self.save_part(&keep.file, Some(reached)),
            Some(place) => self.save_part(&WholeFile::new(place)?, Some(reached)),
        };
        let (path, help) = (keep.path.clone(), String::new());
        Errand { path, is_vital: true, help, write: Box::new(write) }
    }

    /// `reached` is what it came to, where it does not go on.
    fn save_part(&self, file: &WholeFile, reached: Option<&Reached>) -> Result<()> {
        let mut records = self.made().records();
        records.extend(self.run().records());
        let tally = self.tally();
        records.push(Record::new("media-overflows", tally.media_overflows.to_string()));
        records.push(Record::new("cut-off", tally.cut_off.to_string()));
        let last = self.scene.description().render.samples_per_pixel;
        records.push(Record::new("samples-per-pixel", last.to_string()));
        let transparent = self.scene.description().background.transparent;
        records.push(Record::new("transparent", transparent.to_string()));
        if let Some(reached) = reached.filter(|reached| reached.is_complete) {
            records.push(Record::new(ENDED, "true"));
            records.extend(reached.complaint().map(|missed| Record::new(MISSED, missed)));
        }
        records.push(self.outputs.record_of_layers());
        records.push(Record::new(RESUME, self.how_to_go_on().to_string()));
        write_part(file, self.film(), &self.samples, &records)
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
            intersector: self.figures.accel.in_words(),
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
    fn report(&self, reached: &Reached, render_s: f64) -> Result<()> {
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
            figures: Figures { render_s, ..self.figures.clone() },
            warnings: self
                .about_spheres
                .iter()
                .cloned()
                .chain(about_film)
                .chain(complaint)
                .collect(),
        };
        report.print()
    }
}
