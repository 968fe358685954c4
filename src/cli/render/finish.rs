//! The end of a render: what it came to is saved, shown, and told.

use std::path::Path;
use std::sync::OnceLock;

use crate::error::{Error, Result};
use crate::image_io::WholeFile;
use crate::job::save::{self, Errand, Manner};
use crate::job::{End, Reached, Session};

use super::super::exit::Exit;
use super::super::interrupt::Interrupt;
use super::super::outputs::Outputs;
use super::super::print;
use super::super::progress::Progress;
use super::super::watch::LastLook;
use super::report::{Report, Times};
use super::{Keep, Request};

/// What the end of a render needs.
pub(super) struct Finish<'a> {
    pub(super) request: &'a Request,
    pub(super) session: &'a Session,
    pub(super) outputs: &'a Outputs,
    pub(super) keep: Option<&'a Keep>,
    pub(super) interrupt: &'a Interrupt,
    pub(super) progress: &'a Progress,
    pub(super) times: Times,
    /// What there was to warn of.
    pub(super) about_spheres: Vec<String>,
}

impl Finish<'_> {
    /// Saves what it came to, and tells of it. Saved first, and shown then: who looks on may keep nobody
    /// waiting.
    ///
    /// # Errors
    /// When something cannot be written, or there is nothing to write.
    pub(super) fn close(
        &self,
        reached: &Reached,
        render_s: f64,
        last_look: &LastLook<'_>,
    ) -> Result<Exit> {
        last_look.saving();
        let saved = self.session.on_free_threads(|| self.save_all(reached, last_look));
        last_look.wait();
        saved?;
        self.report(reached, render_s)?;
        Ok(match reached.end {
            End::Stopped => Exit::Stopped,
            End::Failed => Exit::Fault,
            // Of a picture that is shared out, the merge says so.
            _ if !is_met(reached) && self.outputs.has_pictures() => Exit::CheckFailed,
            _ => Exit::Done,
        })
    }

    /// Writes the part and the pictures.
    ///
    /// # Errors
    /// When something cannot be written; the others are, where they can be, and what would be lost is
    /// elsewhere. When there is not one sample.
    fn save_all(&self, reached: &Reached, last_look: &LastLook<'_>) -> Result<()> {
        let session = self.session;
        if session.film().samples() == 0 {
            let help = "no sample was finished, so no picture was written";
            return Err(Error::cancelled().with_help(help));
        }
        let picture = OnceLock::new();
        let shown = || picture.get_or_init(|| session.picture());
        // Whoever stops a render waits for the end of it.
        let in_haste = self.interrupt.is_asked();
        let notes = self.outputs.notes(session.film().frame(), &session.metadata(), in_haste);
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
            write: Box::new(|place| file.write(place, shown(), &notes)),
        });
        let pictures: Vec<Errand<'_>> = pictures.collect();
        let warn = |text: String| self.progress.say(|| print::warning(&text));
        let manner = Manner { in_haste: &|| self.interrupt.is_asked(), warn: &warn };
        let saved = save::all(&part, &pictures, &manner);
        drop(pictures);
        if let Some(picture) = picture.into_inner() {
            last_look.show(picture);
        }
        saved
    }

    fn errand_of<'a>(&'a self, keep: &'a Keep, reached: &'a Reached) -> Errand<'a> {
        let write = move |place: Option<&Path>| match place {
            None => self.session.write_checkpoint(&keep.file, Some(reached)),
            Some(place) => self.session.write_checkpoint(&WholeFile::new(place)?, Some(reached)),
        };
        let (path, help) = (keep.path.clone(), String::new());
        Errand { path, is_vital: true, help, write: Box::new(write) }
    }

    /// Tells what came of it.
    fn report(&self, reached: &Reached, render_s: f64) -> Result<()> {
        let (samples, rays, about_film) = self.session.statistics();
        let complaint =
            reached.noise.filter(|noise| !noise.is_met()).map(|noise| noise.to_string());
        about_film.iter().chain(&complaint).for_each(print::warning);
        let warnings = [self.about_spheres.clone(), about_film, complaint.into_iter().collect()];
        let report = Report {
            request: self.request,
            session: self.session,
            reached,
            kept: self.keep.map(|keep| keep.path.as_path()),
            samples,
            rays,
            times: self.times,
            render_s,
            warnings: warnings.concat(),
        };
        report.print()
    }
}

/// Whether the picture is as exact as was asked for.
fn is_met(reached: &Reached) -> bool {
    reached.noise.is_none_or(|noise| noise.is_met())
}
