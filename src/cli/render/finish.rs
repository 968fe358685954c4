//! The end of a render: saves the results, shows the final picture, and prints the report.

use std::path::Path;
use std::sync::OnceLock;

use crate::denoise::DenoisedPicture;
use crate::error::{Error, Result};
use crate::image_io::{AtomicFile, Picture};
use crate::job::save::{self, RetryPolicy, SaveTask, SaveTasks};
use crate::job::{ColorDifference, PictureRecord, RunOutcome, Session, StopReason};

use super::super::exit::Exit;
use super::super::interrupt::Interrupt;
use super::super::outputs::Outputs;
use super::super::print;
use super::super::progress::ProgressDisplay;
use super::super::recorded_outputs::resume_command;
use super::super::watch::FinalUpdate;
use super::checkpoint::CheckpointTarget;
use super::report::{Report, Times};
use super::request::RenderRequest;

/// What the end of a render needs.
pub(super) struct RenderFinisher<'a> {
    pub(super) request: &'a RenderRequest,
    pub(super) session: &'a Session,
    pub(super) outputs: &'a Outputs,
    pub(super) keep: Option<&'a CheckpointTarget>,
    pub(super) interrupt: &'a Interrupt,
    pub(super) progress: &'a ProgressDisplay,
    pub(super) times: Times,
    /// Warnings about the spheres.
    pub(super) about_scene: Vec<String>,
}

impl RenderFinisher<'_> {
    /// Saves the results, waits for the viewers, and prints the report. Saving comes first, so that
    /// a slow viewer delays nothing that matters.
    ///
    /// # Errors
    /// If a file cannot be written, or there is no sample to write.
    pub(super) fn close(
        &self,
        reached: &RunOutcome,
        render_s: f64,
        last_look: &FinalUpdate<'_>,
    ) -> Result<Exit> {
        last_look.begin_saving();
        let saved = self.session.install(|| self.save_all(reached, last_look));
        last_look.wait();
        self.report(reached, render_s, saved?)?;
        Ok(match reached.stop_reason {
            StopReason::Stopped => Exit::Stopped,
            StopReason::Failed => Exit::Fault,
            // If the render writes only a part, `merge` reports the missed target.
            _ if !is_met(reached)
                && !self.outputs.is_part_alone()
                && !self.request.has_default_noise =>
            {
                Exit::CheckFailed
            }
            _ => Exit::Done,
        })
    }

    /// Writes the part and the pictures. Returns how far the colours are from the legend.
    ///
    /// # Errors
    /// If there is not one sample, or a file cannot be written. The other files are then still
    /// written where possible, and what would be lost is saved elsewhere.
    fn save_all(
        &self,
        reached: &RunOutcome,
        last_look: &FinalUpdate<'_>,
    ) -> Result<Option<ColorDifference>> {
        let session = self.session;
        if session.film().sample_count() == 0 {
            let help = "no sample was finished, so no picture was written";
            return Err(Error::cancelled().with_help(help));
        }
        let picture = OnceLock::new();
        let scene = session.prepared().scene();
        let shown = || picture.get_or_init(|| self.outputs.with_columns(session.picture(), scene));
        // After a signal somebody waits for the program to exit. But a finished picture has the
        // same bytes whenever the signal came.
        let in_haste = reached.stop_reason == StopReason::Stopped;
        let finished = OnceLock::new();
        let finish = || self.finish_picture(shown(), in_haste);
        let pictures = self.outputs.pictures().iter().map(|file| SaveTask {
            path: file.path.clone(),
            is_file: file.is_file(),
            write: Box::new(|place| {
                let (denoised, notes) = finished.get_or_init(finish);
                match denoised {
                    None => file.write(place, shown(), notes),
                    Some(denoised) => file.write(place, denoised.of(file.has_layers()), notes),
                }
            }),
        });
        let tasks = SaveTasks {
            checkpoint: self.keep.map(|keep| self.checkpoint_task(keep, reached)),
            pictures: pictures.collect(),
            remake: &|samples, pictures| {
                let command = resume_command(&self.request.delivery, samples);
                format!("the samples are saved: {command} writes {pictures}")
            },
        };
        let warn = |text: String| self.progress.suspend(|| print::warning(&text));
        let manner = RetryPolicy { skip_retries: &|| self.interrupt.is_requested(), warn: &warn };
        let saved = save::save_all(&tasks, &manner);
        drop(tasks);
        drop(finished);
        let mut color_difference = None;
        if let Some(picture) = picture.into_inner() {
            if self.outputs.has_legend() && !in_haste {
                let look = &self.request.delivery.look;
                color_difference = session.color_difference(&picture, look);
            }
            last_look.set_picture(picture);
        }
        saved.map(|()| color_difference)
    }

    /// Denoises the picture, if that is asked for, and returns what is written beside it. A picture
    /// that cannot be denoised is written as it is, with a warning.
    fn finish_picture(
        &self,
        picture: &Picture,
        in_haste: bool,
    ) -> (Option<DenoisedPicture>, PictureRecord) {
        let mut metadata = self.session.metadata();
        let denoiser = self.outputs.denoiser();
        let denoised = denoiser.and_then(|denoiser| {
            let denoised = DenoisedPicture::new(denoiser, picture);
            let warn = |error| self.progress.suspend(|| print::warning(error));
            denoised.map_err(warn).ok()
        });
        if let Some((denoiser, _)) = denoiser.zip(denoised.as_ref()) {
            metadata.mark_denoised(&denoiser.name());
        }
        let notes = self.outputs.notes(self.session.film().frame(), &metadata, in_haste);
        (denoised, notes)
    }

    fn checkpoint_task<'a>(
        &'a self,
        keep: &'a CheckpointTarget,
        reached: &'a RunOutcome,
    ) -> SaveTask<'a> {
        let write = move |place: Option<&Path>| match place {
            None => self.session.write_checkpoint(&keep.file, Some(reached)),
            Some(place) => self.session.write_checkpoint(&AtomicFile::new(place)?, Some(reached)),
        };
        SaveTask { path: keep.path.clone(), is_file: true, write: Box::new(write) }
    }

    /// Prints the report.
    fn report(
        &self,
        reached: &RunOutcome,
        render_s: f64,
        color_difference: Option<ColorDifference>,
    ) -> Result<()> {
        let (samples, rays, about_film) = self.session.statistics();
        let complaint =
            reached.noise.filter(|noise| !noise.is_met()).map(|noise| noise.to_string());
        about_film.iter().chain(&complaint).for_each(print::warning);
        let warnings = [self.about_scene.clone(), about_film, complaint.into_iter().collect()];
        let report = Report {
            request: self.request,
            session: self.session,
            reached,
            kept: self.keep.map(|keep| keep.path.as_path()),
            samples,
            rays,
            times: self.times,
            render_s,
            color_difference,
            warnings: warnings.concat(),
        };
        report.print()
    }
}

/// Returns true if the noise target is met, or there is none.
fn is_met(reached: &RunOutcome) -> bool {
    reached.noise.is_none_or(|noise| noise.is_met())
}
