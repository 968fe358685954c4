//! The options for picture files: their paths, layers and format. Shared by every command that
//! writes pictures.

use std::ffi::OsStr;
use std::path::PathBuf;
use std::time::Duration;

use clap::builder::{PossibleValue, TypedValueParser};
use clap::{Arg, Args, Command};

use crate::color::{ToneCurve, ViewTransform};
use crate::film::{AOVS, Aov};
use crate::image_io::{FileFormat, PICTURE_FORMATS};
use crate::job::{FilePath, OutputSpec};
use crate::overlay::OverlayChoice;

use super::values::{exposure, named, one_of};

/// The files, and how those for the screen show the picture.
#[derive(Args, Clone, Debug)]
pub struct OutputArgs {
    /// The files to write.
    #[arg(short = 'o', long = "output", value_name = "FILE", required = true, help = files_help())]
    pub files: Vec<PathBuf>,

    /// The layers (AOVs) of .exr files, such as direct,albedo,normal; also columns of a particle
    /// file [default: direct,indirect]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = LayerParser)]
    layers: Option<Vec<LayerName>>,

    #[command(flatten)]
    look: LookArgs,

    /// Omit the command, the time and the machine from the files, so that equal pictures are equal
    /// files
    #[arg(long)]
    pub no_run_figures: bool,
}

/// How files for the screen show a picture.
#[derive(Args, Clone, Debug)]
pub struct LookArgs {
    /// The exposure of .png files in stops; each stop doubles the light
    #[arg(long, value_name = "EV", value_parser = exposure)]
    exposure: Option<f32>,

    /// The tone curve of .png files: srgb (clips at 1), filmic or agx
    #[arg(long, value_name = "NAME", value_parser = one_of(named::<ToneCurve>()))]
    tone: Option<ToneCurve>,

    /// Dither .png files, which hides steps in smooth gradients
    #[arg(long)]
    dither: bool,

    /// The resolution for print that .png files record, in pixels per inch
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub dpi: Option<u32>,
}

impl LookArgs {
    /// Returns the view transform of display-referred files.
    pub fn look(&self) -> ViewTransform {
        let (exposure, tone) = (self.exposure.unwrap_or(0.0), self.tone.unwrap_or_default());
        ViewTransform { exposure, tone, dither: self.dither }
    }

    /// Returns the options; true if they are given.
    pub fn given(&self) -> [(&'static str, bool); 4] {
        [
            ("--exposure", self.exposure.is_some()),
            ("--tone", self.tone.is_some()),
            ("--dither", self.dither),
            ("--dpi", self.dpi.is_some()),
        ]
    }
}

impl OutputArgs {
    /// Returns the requested layers without duplicates, or the default ones.
    pub fn kinds(&self) -> Vec<Aov> {
        let mut kinds = Vec::new();
        let mut add = |kind: Aov| {
            if !kinds.contains(&kind) {
                kinds.push(kind);
            }
        };
        match &self.layers {
            None => Aov::DEFAULT.into_iter().for_each(add),
            Some(layers) => layers.iter().for_each(|layer| match layer {
                LayerName::Aov(kind) => add(*kind),
                // Tells which particle's number a pixel has.
                LayerName::Column(_) => add(Aov::SphereId),
            }),
        }
        kinds
    }

    /// Returns the columns of a particle file that are requested as layers, without duplicates.
    pub fn columns(&self) -> Vec<String> {
        let mut columns: Vec<String> = Vec::new();
        for layer in self.layers.iter().flatten() {
            match layer {
                LayerName::Column(name) if !columns.contains(name) => columns.push(name.clone()),
                _ => {}
            }
        }
        columns
    }

    /// Returns true if layers are requested.
    pub fn has_layers(&self) -> bool {
        self.layers.is_some()
    }

    /// Returns where the picture goes, without viewers.
    pub fn output_spec(&self) -> OutputSpec {
        OutputSpec {
            files: self.files.iter().cloned().map(FilePath).collect(),
            look: self.look(),
            dpi: self.look.dpi,
            overlay: OverlayChoice::default(),
            columns: self.columns(),
            denoise: false,
            with_run_record: !self.no_run_figures,
            save_every: Duration::from_secs(60),
            preview: None,
            preview_every: Duration::from_secs(2),
            tev: None,
        }
    }

    /// Returns the view transform of display-referred files.
    pub fn look(&self) -> ViewTransform {
        self.look.look()
    }

    /// Returns the options as command arguments: first those that concern parts, then those that
    /// concern only picture files.
    pub fn to_arguments(&self) -> [Vec<String>; 2] {
        let mut of_parts = Vec::new();
        if let Some(kinds) = &self.layers {
            let name = |layer: &LayerName| match layer {
                LayerName::Aov(kind) => kind.info().name.to_owned(),
                LayerName::Column(name) => name.clone(),
            };
            let names: Vec<String> = kinds.iter().map(name).collect();
            of_parts.extend(["--layers".to_owned(), names.join(",")]);
        }
        let mut of_pictures = Vec::new();
        if let Some(stops) = self.look.exposure {
            of_pictures.extend(["--exposure".to_owned(), stops.to_string()]);
        }
        if let Some(tone) = self.look.tone {
            of_pictures.extend(["--tone".to_owned(), tone.name().to_owned()]);
        }
        if let Some(dpi) = self.look.dpi {
            of_pictures.extend(["--dpi".to_owned(), dpi.to_string()]);
        }
        let flags = [("--dither", self.look.dither), ("--no-run-figures", self.no_run_figures)];
        let given = flags.into_iter().filter(|(_, given)| *given);
        of_pictures.extend(given.map(|(flag, _)| flag.to_owned()));
        [of_parts, of_pictures]
    }
}

/// The format of a picture on the standard output.
#[derive(Args, Clone, Copy, Debug)]
pub struct StdoutArgs {
    /// The format of -o -, the picture on the standard output [default: png]
    #[arg(long, value_name = "NAME", value_parser = one_of(named::<FileFormat>()))]
    pub format: Option<FileFormat>,
}

fn files_help() -> String {
    format!(
        "The picture; its extension chooses the format: {PICTURE_FORMATS}; or .part, the sums of \
         the film, for merge. `-` is the standard output, and `none` discards the picture. May be \
         repeated"
    )
}

/// A layer of .exr files.
#[derive(Clone, Debug)]
enum LayerName {
    /// What the renderer computes.
    Aov(Aov),
    /// A column of a particle file.
    Column(String),
}

/// Parses the name of a layer. One that is like that of an AOV is a typo; others are columns.
#[derive(Clone)]
struct LayerParser;

impl TypedValueParser for LayerParser {
    type Value = LayerName;

    fn parse_ref(
        &self,
        command: &Command,
        arg: Option<&Arg>,
        value: &OsStr,
    ) -> Result<LayerName, clap::Error> {
        let refused = match kinds().parse_ref(command, arg, value) {
            Ok(kind) => return Ok(LayerName::Aov(kind)),
            Err(refused) => refused,
        };
        let is_typo = |name: &str| AOVS.iter().any(|row| strsim::osa_distance(row.name, name) <= 2);
        match value.to_str().filter(|name| !name.is_empty() && !is_typo(name)) {
            Some(name) => Ok(LayerName::Column(name.to_owned())),
            None => Err(refused),
        }
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        let names = AOVS.iter().map(|row| PossibleValue::new(row.name));
        Some(Box::new(names))
    }
}

fn kinds() -> impl TypedValueParser<Value = Aov> {
    one_of(AOVS.iter().filter_map(|row| Some((row.name.into(), Aov::named(row.name)?))))
}
