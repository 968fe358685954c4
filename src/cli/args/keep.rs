//! The options of long renders: checkpoints, ranges of samples, going on, and adding up.

use std::ops::Range;
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;

use crate::math::Rect;

use super::{MemoryArg, OutputArgs, threads};

/// How a render is kept from being lost.
#[derive(Args, Debug)]
pub(in crate::cli) struct KeepArgs {
    /// Keep the samples so far in this file, and go on from it where it is already there. Written
    /// at the end, too: `photosphere resume FILE --extend-to N` adds samples
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) checkpoint: Option<PathBuf>,

    /// How often the checkpoint is written, as in 90s, 5m or 1h; for -o FILE.part as well
    #[arg(long, value_name = "TIME", default_value = "60s", value_parser = duration, allow_hyphen_values = true)]
    pub(in crate::cli) checkpoint_every: Duration,
}

/// Go on with a render from its checkpoint or part
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere render fig2.toml -o fig2.exr --spp 4096 --checkpoint fig2.part
  photosphere resume fig2.part
  photosphere resume fig2.part --extend-to 16384 -o better.exr

All that decides the picture, its files and who looks on is as in the interrupted command, but for what
is given here. A scene that has changed since is refused.")]
pub(in crate::cli) struct ResumeArgs {
    /// The checkpoint, or the part
    #[arg(value_name = "FILE")]
    pub(in crate::cli) file: PathBuf,

    /// The picture, in place of the one that the interrupted command named; may be repeated
    #[arg(short = 'o', long = "output", value_name = "FILE")]
    pub(in crate::cli) outputs: Vec<PathBuf>,

    /// Render this many samples of every pixel, also where all that were asked for are there; in place
    /// of --noise and --time
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    #[arg(allow_negative_numbers = true)]
    pub(in crate::cli) extend_to: Option<u32>,

    /// The scene file, where it is somewhere else now
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) scene: Option<PathBuf>,

    /// How often the checkpoint is written [default: as before]
    #[arg(long, value_name = "TIME", value_parser = duration, allow_hyphen_values = true)]
    pub(in crate::cli) checkpoint_every: Option<Duration>,

    /// Threads to use [default: as before]
    #[arg(long, value_name = "T", value_parser = threads(), allow_negative_numbers = true)]
    pub(in crate::cli) threads: Option<usize>,

    #[command(flatten)]
    pub(in crate::cli) memory: MemoryArg,

    /// Say nothing but warnings and errors
    #[arg(short, long)]
    pub(in crate::cli) quiet: bool,

    /// Print one JSON object with the figures of the render on the standard output
    #[arg(long)]
    pub(in crate::cli) json: bool,
}

/// Add up parts of a picture
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  photosphere render fig2.toml --samples 0..32 -o a.part
  photosphere render fig2.toml --samples 32..64 -o b.part
  photosphere merge a.part b.part -o fig2.exr
  photosphere merge a.part b.part -o both.part
  photosphere merge left.part right.part -o face.exr --crop 200,100,300,200

`photosphere plan` prints such commands for any number of shards. Parts are ranges of samples
(--samples), windows (--crop) or both, in any order. What comes out has the very bits of one render
without a break. Where parts did not meet their noise target, the picture is written, too, and the exit
code is 1.")]
pub(in crate::cli) struct MergeArgs {
    /// The parts; checkpoints are parts, too
    #[arg(value_name = "PART", required = true)]
    pub(in crate::cli) parts: Vec<PathBuf>,

    #[command(flatten)]
    pub(in crate::cli) output: OutputArgs,

    /// The window that parts of several windows make together, where that is not the whole picture
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = window)]
    pub(in crate::cli) crop: Option<Rect>,

    /// Make a picture of what there is, also where pixels or samples are missing
    #[arg(long)]
    pub(in crate::cli) allow_gaps: bool,

    /// Say nothing but warnings and errors
    #[arg(short, long)]
    pub(in crate::cli) quiet: bool,
}

/// `90s`, `5m`, `1.5h`, or seconds.
pub(in crate::cli) fn duration(text: &str) -> Result<Duration, String> {
    let units = [("ms", 1e-3), ("s", 1.0), ("m", 60.0), ("h", 3600.0)];
    let with_unit = |(unit, seconds): (&str, f64)| {
        Some(text.strip_suffix(unit)?.trim_end().parse::<f64>().ok()? * seconds)
    };
    let seconds = units.into_iter().find_map(with_unit).or_else(|| text.parse().ok());
    match seconds {
        Some(seconds) if (0.001..1e9).contains(&seconds) => Ok(Duration::from_secs_f64(seconds)),
        _ => Err("it must be a time, as in 30s, 5m or 1h".to_owned()),
    }
}

/// `X0,Y0,X1,Y1`.
fn window(text: &str) -> Result<Rect, String> {
    let corners = || {
        let corners: Option<Vec<u32>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
        let [x, y, right, bottom] = corners?.try_into().ok()?;
        let (width, height) = (right.checked_sub(x)?, bottom.checked_sub(y)?);
        (width > 0 && height > 0).then_some(Rect { x, y, width, height })
    };
    corners().ok_or_else(|| {
        "it must be the first column and row and the ones behind the last, as in 0,0,320,240"
            .to_owned()
    })
}

/// `A..B`.
pub(in crate::cli) fn samples(text: &str) -> Result<Range<u32>, String> {
    let range = || {
        let (first, end) = text.split_once("..")?;
        Some(first.trim().parse().ok()?..end.trim().parse().ok()?)
    };
    let range: Option<Range<u32>> = range();
    range.filter(|range| !range.is_empty()).ok_or_else(|| {
        "it must be the first sample and the one behind the last, as in 0..64".to_owned()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_units() {
        for (text, seconds) in
            [("30s", 30.0), ("1.5h", 5400.0), ("250ms", 0.25), ("2m", 120.0), ("7", 7.0)]
        {
            assert_eq!(duration(text), Ok(Duration::from_secs_f64(seconds)), "{text}");
        }
        for text in ["", "s", "-3s", "0", "nan", "1e99h", "3 days"] {
            assert!(duration(text).is_err(), "{text}");
        }
    }

    #[test]
    fn windows_have_two_corners() {
        assert_eq!(window("3,4,10,6"), Ok(Rect { x: 3, y: 4, width: 7, height: 2 }));
        for text in ["", "1,2,3", "0,0,0,5", "5,0,4,9", "-1,0,4,9", "0,0,4,9,9", "a,b,c,d"] {
            assert!(window(text).is_err(), "{text}");
        }
    }

    #[test]
    fn ranges_have_two_ends() {
        assert_eq!(samples("16..48"), Ok(16..48));
        for text in ["", "16", "48..16", "16..16", "-1..3", "a..b", "0..=3", "0..99999999999"] {
            assert!(samples(text).is_err(), "{text}");
        }
    }
}
