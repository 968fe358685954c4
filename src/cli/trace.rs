//! `photosphere trace`: explains one path step by step, and draws it.

use crate::accel::BuildOptions;
use crate::error::{Error, Result};
use crate::image_io::AtomicFile;
use crate::integrator::{self, RenderContext, SampleAddress};
use crate::report::path;
use crate::scene::PreparedScene;
use crate::task::CancelToken;

use super::args::TraceArgs;
use super::exit::Exit;
use super::particle_file::read_scene;
use super::system::on_threads;
use super::{interrupt, print};

/// Runs the command.
///
/// # Errors
/// If the scene cannot be loaded, has no such pixel or sample, or its integrator traces no paths.
pub(super) fn run(args: &TraceArgs) -> Result<Exit> {
    let svg = |path| AtomicFile::with_extension(path, "svg");
    let file = args.svg.as_deref().map(svg).transpose()?;
    interrupt::listen();
    on_threads(args.scene.threads(), || trace(args, file))
}

fn trace(args: &TraceArgs, file: Option<AtomicFile>) -> Result<Exit> {
    let (scene, settings) =
        read_scene(&args.scene.path, &args.overrides(), Some(&args.studio))?.build()?;
    let prepared = PreparedScene::new(&scene, settings)?;
    let address = address(args, &prepared)?;
    let (threads, quality) = (rayon::current_num_threads(), args.accel.build.quality);
    let build = BuildOptions { threads, quality, ..Default::default() };
    let accel = args.accel.choice.select(scene.spheres()).backend.build(scene.spheres(), &build)?;
    let cancel = CancelToken::default();
    let context = RenderContext::new(&prepared, &*accel, &cancel);
    let trace = integrator::create(&prepared).trace_path(context, address).ok_or_else(|| {
        let name = prepared.render_settings().integrator.kind().name();
        Error::input(format!("the integrator `{name}` traces no paths"))
            .with_help("add --integrator path")
    })?;
    if let Some(file) = file {
        let svg = path::svg(&prepared, &trace);
        file.write(|to| std::io::Write::write_all(to, svg.as_bytes()))?;
    }
    if args.json {
        print::json(&path::json(&prepared, &trace))?;
    } else {
        print::result(&path::text(&prepared, &trace))?;
    }
    if let Some(path) = &args.svg {
        print::note(format_args!("wrote {}", path.display()));
    }
    Ok(Exit::Done)
}

/// Returns the address of the sample, if it is within the picture.
fn address(args: &TraceArgs, prepared: &PreparedScene) -> Result<SampleAddress> {
    let (x, y) = args.pixel;
    let image = prepared.image_settings();
    if x >= image.width || y >= image.height {
        let (width, height) = (image.width, image.height);
        return Err(Error::input(format!(
            "there is no pixel {x},{y}: the picture has {width} x {height}"
        ))
        .with_help(format!("pixels run from 0,0 to {},{}", width - 1, height - 1)));
    }
    let count = prepared.render_settings().samples_per_pixel;
    if args.sample >= count {
        return Err(Error::input(format!(
            "there is no sample {}: each pixel has {count}",
            args.sample
        ))
        .with_help(format!("samples run from 0 to {}", count - 1)));
    }
    Ok(SampleAddress { x, y, sample: args.sample })
}
