//! Pictures: pixels as arrays, and files.

use std::path::PathBuf;
use std::sync::OnceLock;

use numpy::ndarray::Array3;
use numpy::{IntoPyArray, PyArray1};
use photosphere::Error;
use photosphere::color::{Rgb, ToneCurve, ViewTransform};
use photosphere::denoise::{DenoisedPicture, Denoiser, denoised_alone};
use photosphere::film::Aov;
use photosphere::image_io::{
    ChannelValues, CropWindow, FileFormat, ImageChannel, ImageWriter, Picture as LibraryPicture,
    display_pixels, write_to_stream,
};
use photosphere::job::merge::{MergeOptions, merge as merge_parts};
use photosphere::job::{Metadata, OutputSpec, PictureRecord, frame_crop};
use photosphere::math::Rect;
use photosphere::overlay::OverlaySpec;
use photosphere::studio::font_pixels;
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyList};
use serde::{Deserialize, Serialize};

use crate::{arrays, error, pool};

/// A picture with everything that its files record.
#[pyclass(frozen, module = "photosphere._core")]
pub(crate) struct Picture {
    picture: LibraryPicture,
    /// The denoised picture, which the screen and files without layers show.
    denoised: Option<LibraryPicture>,
    crop: Option<CropWindow>,
    facts: Facts,
    /// Layers of several channels, interleaved when they are first asked for.
    beauty: OnceLock<Vec<[f32; 3]>>,
    direct: OnceLock<Vec<[f32; 3]>>,
    indirect: OnceLock<Vec<[f32; 3]>>,
}

/// What a picture records besides its pixels.
#[derive(Clone, Serialize, Deserialize)]
struct Facts {
    metadata: Metadata,
    layers: Vec<Aov>,
    overlay: Option<OverlaySpec>,
    output: OutputSpec,
}

/// What pickle keeps of a picture, with the arrays beside it.
#[derive(Serialize, Deserialize)]
struct Pickled {
    facts: Facts,
    width: usize,
    height: usize,
    has_alpha: bool,
    hidden: Vec<String>,
    crop: Option<([usize; 2], [usize; 2])>,
    channels: Vec<String>,
    attributes: Vec<(String, String)>,
}

/// How a file for the screen shows a picture; `None` is as the render's options say.
#[derive(FromPyObject)]
pub(crate) struct Look {
    exposure: Option<f32>,
    tone: Option<String>,
    dither: Option<bool>,
    dpi: Option<u32>,
    font_size: Option<f64>,
    overlay: bool,
    run_figures: Option<bool>,
}

impl Picture {
    pub(crate) fn new(
        picture: LibraryPicture,
        metadata: Metadata,
        layers: Vec<Aov>,
        crop: Option<CropWindow>,
        overlay: Option<OverlaySpec>,
        output: OutputSpec,
    ) -> Self {
        let facts = Facts { metadata, layers, overlay, output };
        let denoised = denoised_alone(&picture);
        let (beauty, direct, indirect) = Default::default();
        Self { picture, denoised, crop, facts, beauty, direct, indirect }
    }

    /// What files with layers contain, or what others show.
    fn shown(&self, has_layers: bool) -> &LibraryPicture {
        self.denoised.as_ref().filter(|_| !has_layers).unwrap_or(&self.picture)
    }

    /// What is written beside the pixels.
    fn record(&self, look: &Look) -> PyResult<PictureRecord> {
        let mut output = self.facts.output.clone();
        let tone = match look.tone.as_deref() {
            None => output.look.tone,
            Some(name) => ToneCurve::named(name).ok_or_else(|| {
                let known: Vec<&str> = ToneCurve::NAMES.iter().map(|(name, _)| *name).collect();
                let known = known.join(", ");
                PyValueError::new_err(format!("tone: expected one of {known}, not `{name}`"))
            })?,
        };
        output.look = ViewTransform {
            exposure: look.exposure.unwrap_or(output.look.exposure),
            tone,
            dither: look.dither.unwrap_or(output.look.dither),
        };
        output.dpi = look.dpi.or(output.dpi);
        output.overlay.font_size = look.font_size.or(output.overlay.font_size);
        output.with_run_record = look.run_figures.unwrap_or(output.with_run_record);
        let mut overlay = self.facts.overlay.clone().filter(|_| look.overlay);
        if let Some(overlay) = &mut overlay {
            overlay.font_pixels = font_pixels(&output.overlay, overlay.size[1], output.dpi);
        }
        let Facts { metadata, layers, .. } = &self.facts;
        Ok(PictureRecord::new(metadata, layers, self.crop, overlay.as_ref(), &output))
    }

    fn channel(&self, name: &str) -> Option<&ImageChannel> {
        self.picture.channels.iter().find(|channel| channel.name == name)
    }

    /// The channels of a layer, as in `normal.X`, `normal.Y`, `normal.Z`.
    fn channels_of(&self, layer: &str) -> Vec<&ImageChannel> {
        let is_of = |channel: &&ImageChannel| {
            channel.name.strip_prefix(layer).is_some_and(|rest| rest.starts_with('.'))
        };
        self.picture.channels.iter().filter(is_of).collect()
    }
}

#[pymethods]
impl Picture {
    /// Width in pixels.
    #[getter]
    fn width(&self) -> usize {
        self.picture.width
    }

    /// Height in pixels.
    #[getter]
    fn height(&self) -> usize {
        self.picture.height
    }

    /// Names of the layers.
    fn names(&self) -> Vec<String> {
        let hidden = &self.picture.hidden_layers;
        let mut names = vec!["beauty".to_owned()];
        names.extend(
            ["direct", "indirect"]
                .iter()
                .filter(|name| !hidden.contains(name))
                .map(|n| n.to_string()),
        );
        for channel in &self.picture.channels {
            let name = channel.name.rsplit_once('.').map_or(&*channel.name, |(layer, _)| layer);
            if names.last().is_none_or(|last| last != name) {
                names.push(name.to_owned());
            }
        }
        names.extend(self.picture.alpha.as_ref().map(|_| "alpha".to_owned()));
        names
    }

    /// A layer, as a read-only array. Those of one channel share the memory of the picture; those
    /// of several are interleaved once.
    fn layer<'py>(slf: &Bound<'py, Self>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let this = slf.get();
        let owner = slf.clone().into_any();
        let picture = &this.picture;
        let (height, width) = (picture.height, picture.width);
        let colors = |cache: &'_ OnceLock<Vec<[f32; 3]>>, color: &dyn Fn(usize) -> Rgb| {
            let all = || (0..picture.len()).map(|pixel| color(pixel).to_array()).collect();
            arrays::shared(owner.clone(), cache.get_or_init(all).as_flattened(), (height, width, 3))
        };
        match name {
            "beauty" => return colors(&this.beauty, &|pixel| picture.beauty(pixel)),
            "direct" => return colors(&this.direct, &|pixel| picture.direct[pixel]),
            "indirect" => return colors(&this.indirect, &|pixel| picture.indirect[pixel]),
            "alpha" => {
                if let Some(alpha) = &picture.alpha {
                    return arrays::shared(owner, alpha, (height, width));
                }
            }
            _ => {}
        }
        if let Some(channel) = this.channel(name) {
            return match &channel.values {
                ChannelValues::Float(values) => arrays::shared(owner, values, (height, width)),
                ChannelValues::Uint(values) => arrays::shared(owner, values, (height, width)),
            };
        }
        let channels = this.channels_of(name);
        if channels.is_empty() {
            return Err(PyKeyError::new_err(name.to_owned()));
        }
        let depth = channels.len();
        let mut all = Array3::<f32>::zeros((height, width, depth));
        for (index, channel) in channels.iter().enumerate() {
            if let ChannelValues::Float(values) = &channel.values {
                for (pixel, value) in values.iter().enumerate() {
                    all[[pixel / width, pixel % width, index]] = *value;
                }
            }
        }
        Ok(all.into_pyarray(slf.py()).into_any())
    }

    /// The bytes of a file.
    fn encode<'py>(
        &self,
        py: Python<'py>,
        format: &str,
        look: Look,
        fast: bool,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let format = FileFormat::named(format)
            .ok_or_else(|| PyValueError::new_err(format!("there is no format `{format}`")))?;
        let record = self.record(&look)?.fast(fast);
        let bytes = pool::run(py, || {
            let mut bytes = Vec::new();
            let options = record.options_for(format)?;
            let shown = self.shown(format.has_layers());
            write_to_stream(format, shown, &options, &mut bytes)
                .map_err(|e| Error::input(format!("cannot encode the picture: {e}")))?;
            Ok(bytes)
        })?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Writes a file, whose ending chooses the format.
    fn save(&self, py: Python<'_>, path: PathBuf, look: Look) -> PyResult<()> {
        let record = self.record(&look)?;
        pool::run(py, || {
            let file = ImageWriter::new(&path)?;
            let shown = self.shown(file.has_layers());
            file.write_with(shown, &record.options_for(file.format())?)
        })
    }

    /// The pixels of a PNG file: 8-bit sRGB, with alpha if the picture has it.
    fn display<'py>(&self, py: Python<'py>, look: Look) -> PyResult<Bound<'py, PyAny>> {
        let record = self.record(&look)?;
        let bytes = pool::run(py, || {
            Ok(display_pixels(self.shown(false), &record.options_for(FileFormat::Png)?))
        })?;
        let channels = if self.picture.alpha.is_some() { 4 } else { 3 };
        let (height, width) = (self.picture.height, self.picture.width);
        let array = Array3::from_shape_vec((height, width, channels), bytes)
            .map_err(|e| PyValueError::new_err(e.to_string()))?;
        Ok(array.into_pyarray(py).into_any())
    }

    /// The picture with the layer `denoised`. `package` is the folder of `pyoidn`.
    fn denoise(&self, py: Python<'_>, package: Option<PathBuf>) -> PyResult<Self> {
        pool::run(py, || {
            let denoiser = Denoiser::load_with(package.as_deref())?;
            let picture = DenoisedPicture::new(&denoiser, &self.picture)?.into_layered();
            let Facts { mut metadata, layers, overlay, output } = self.facts.clone();
            metadata.mark_denoised(&denoiser.name());
            Ok(Self::new(picture, metadata, layers, self.crop, overlay, output))
        })
    }

    /// How the picture was made, as JSON.
    fn metadata(&self) -> PyResult<String> {
        json_text(&self.facts.metadata)
    }

    /// What is drawn over the picture, as JSON.
    fn overlay(&self) -> PyResult<String> {
        json_text(&self.facts.overlay)
    }

    /// What pickle keeps: a text and arrays.
    fn pickled<'py>(&self, py: Python<'py>) -> PyResult<(String, Bound<'py, PyList>)> {
        let picture = &self.picture;
        let text = json_text(&Pickled {
            facts: self.facts.clone(),
            width: picture.width,
            height: picture.height,
            has_alpha: picture.alpha.is_some(),
            hidden: picture.hidden_layers.iter().map(ToString::to_string).collect(),
            crop: self.crop.map(|crop| (crop.full_size, crop.offset)),
            channels: picture.channels.iter().map(|channel| channel.name.clone()).collect(),
            attributes: picture.attributes.clone(),
        })?;
        let list = PyList::empty(py);
        for colors in [&picture.direct, &picture.indirect] {
            let flat = colors.iter().flat_map(|color| color.to_array());
            list.append(PyArray1::from_iter(py, flat))?;
        }
        if let Some(alpha) = &picture.alpha {
            list.append(PyArray1::from_slice(py, alpha))?;
        }
        for channel in &picture.channels {
            match &channel.values {
                ChannelValues::Float(values) => list.append(PyArray1::from_slice(py, values))?,
                ChannelValues::Uint(values) => list.append(PyArray1::from_slice(py, values))?,
            }
        }
        Ok((text, list))
    }

    /// From what pickle kept.
    #[staticmethod]
    fn restore(text: &str, arrays: Vec<Bound<'_, PyAny>>) -> PyResult<Self> {
        let kept: Pickled =
            serde_json::from_str(text).map_err(|e| PyValueError::new_err(e.to_string()))?;
        let wrong = || PyValueError::new_err("these are not the arrays of a picture");
        let mut arrays = arrays.iter();
        let mut colors = || -> PyResult<Vec<Rgb>> {
            let flat: Vec<f32> = crate::arrays::values(arrays.next().ok_or_else(wrong)?)?;
            let fits = flat.len() == 3 * kept.width * kept.height;
            fits.then(|| flat.chunks_exact(3).map(Rgb::from_slice).collect()).ok_or_else(wrong)
        };
        let (direct, indirect) = (colors()?, colors()?);
        let alpha = match kept.has_alpha {
            true => Some(crate::arrays::values(arrays.next().ok_or_else(wrong)?)?),
            false => None,
        };
        let mut channels = Vec::new();
        for name in &kept.channels {
            let array = arrays.next().ok_or_else(wrong)?;
            let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
            let values = match kind.as_str() {
                "u" => ChannelValues::Uint(crate::arrays::values(array)?),
                _ => ChannelValues::Float(crate::arrays::values(array)?),
            };
            channels.push(ImageChannel::new(name, values));
        }
        let hidden = ["direct", "indirect"].into_iter();
        let picture = LibraryPicture {
            width: kept.width,
            height: kept.height,
            direct,
            indirect,
            alpha,
            hidden_layers: hidden.filter(|name| kept.hidden.iter().any(|h| h == name)).collect(),
            channels,
            attributes: kept.attributes,
        };
        let crop = kept.crop.map(|(full_size, offset)| CropWindow { full_size, offset });
        let Facts { metadata, layers, overlay, output } = kept.facts;
        Ok(Self::new(picture, metadata, layers, crop, overlay, output))
    }
}

/// Raises an error unless Open Image Denoise can be loaded. `package` is the folder of `pyoidn`.
#[pyfunction]
pub(crate) fn check_denoiser(py: Python<'_>, package: Option<PathBuf>) -> PyResult<()> {
    let loaded = py.detach(|| Denoiser::load_with(package.as_deref()));
    loaded.map(drop).map_err(|e| error::raise(py, &e))
}

/// Merges the files of parts. Returns the picture, and what the user should know.
#[pyfunction]
pub(crate) fn merge(
    py: Python<'_>,
    paths: Vec<PathBuf>,
    layers: Option<Vec<String>>,
    crop: Option<[u32; 4]>,
    allow_gaps: bool,
) -> PyResult<(Picture, Vec<String>)> {
    let unknown = |name: &String| {
        let error = Error::input(format!("there is no layer `{name}`"));
        Aov::named(name).ok_or_else(|| error::raise(py, &error))
    };
    let layers = layers.map(|names| names.iter().map(unknown).collect()).transpose()?;
    let crop = crop.map(|[x0, y0, x1, y1]| Rect {
        x: x0,
        y: y0,
        width: x1.saturating_sub(x0),
        height: y1.saturating_sub(y0),
    });
    let options =
        MergeOptions { layers, crop, allow_gaps, writes_picture: true, ..Default::default() };
    pool::run(py, || {
        let merged = merge_parts(&paths, &options)?;
        let picture = merged.picture()?;
        let missed = merged.missed_targets.iter().flat_map(|(_, missed)| missed);
        let warnings = missed.map(ToString::to_string).collect();
        let crop = frame_crop(merged.film.frame());
        let output = OutputSpec::default();
        let picture = Picture::new(picture, merged.metadata, merged.layers, crop, None, output);
        Ok((picture, warnings))
    })
}

fn json_text(value: &impl Serialize) -> PyResult<String> {
    serde_json::to_string(value).map_err(|e| PyValueError::new_err(e.to_string()))
}
