//! `photosphere bench --suite`: the standard scenes, one size after the other, on one page.

use std::io::Write;
use std::path::Path;

use serde_json::{Value, json};

use crate::accel::{Backend, EmbreeInfo, embree_info};
use crate::error::Result;
use crate::generate::Arrangement;
use crate::image_io::WholeFile;
use crate::job::{COMMIT, MemoryPlan};
use crate::task::Cancel;
use crate::verify::bench::page::{Entry, page};
use crate::verify::bench::{MOST_FOR_BRUTE_FORCE, Rounds, SECOND_BOUNCE, StandardScene};

use super::super::args::BenchArgs;
use super::super::exit::Exit;
use super::super::interrupt::Interrupt;
use super::super::{print, system};
use super::report::Report;
use super::{build, circumstances, measure, rounds};

/// The largest scene unless `--largest` says another.
const LARGEST: u64 = 100_000_000;
/// All the rays, and their copies for each intersector.
const RAYS: u64 = 1 << 30;

/// # Errors
/// When an intersector cannot be built, or the page not be written.
pub(super) fn run(args: &BenchArgs, path: &Path, interrupt: &Interrupt) -> Result<Exit> {
    let file = WholeFile::ending_in(path, "html")?;
    let cancel = interrupt.cancel();
    let entries = entries(args, interrupt)?;
    let text = page(&facts(rounds(args)), &entries)?;
    file.write(|to| to.write_all(text.as_bytes()))?;
    print::remark(format_args!("wrote {}", path.display()));
    if args.json {
        print::json(&entries.iter().map(|entry| in_json(entry, rounds(args))).collect())?;
    }
    Ok(if cancel.is_cancelled() { Exit::Stopped } else { Exit::Done })
}

/// All that fits, or, after Ctrl-C, all that is finished.
fn entries(args: &BenchArgs, interrupt: &Interrupt) -> Result<Vec<Entry>> {
    let cancel = interrupt.cancel();
    let mut entries = Vec::new();
    for count in sizes(args.largest.unwrap_or(LARGEST)) {
        let wanted = backends_for(args.accels.backends(), count);
        let backends = those_that_fit(wanted.clone(), |backends| fits(args, count, backends));
        for left_out in wanted.iter().filter(|backend| !backends.contains(backend)) {
            let name = left_out.name();
            print::remark(format_args!("{count} spheres with {name} do not fit into memory"));
        }
        if backends.is_empty() {
            break;
        }
        for &(_, arrangement) in Arrangement::NAMES {
            match entry(args, arrangement, count, &backends, &cancel) {
                Err(_) if cancel.is_cancelled() => return Ok(entries),
                entry => entries.push(entry?),
            }
            entries.last().map(in_words).into_iter().for_each(print::remark);
            interrupt.save_from_now_on();
        }
    }
    Ok(entries)
}

/// 3, then powers of ten from 100 on.
fn sizes(largest: u64) -> impl Iterator<Item = u64> {
    let powers = (2..10).map(|exponent| 10u64.pow(exponent));
    [3].into_iter().chain(powers).take_while(move |&count| count <= largest)
}

/// Those that are not hopeless.
fn backends_for(backends: &[Backend], spheres: u64) -> Vec<Backend> {
    let can =
        |backend: &Backend| *backend != Backend::BruteForce || spheres <= MOST_FOR_BRUTE_FORCE;
    backends.iter().copied().filter(can).collect()
}

/// Leaves out one after the other, the largest first, until the others fit.
fn those_that_fit(mut backends: Vec<Backend>, fit: impl Fn(&[Backend]) -> bool) -> Vec<Backend> {
    let size = |backend: &Backend| MemoryPlan::of_spheres(1 << 20, &[*backend], 1).tree;
    while !backends.is_empty() && !fit(&backends) {
        let largest = (0..backends.len()).max_by_key(|&i| size(&backends[i]));
        largest.map(|i| backends.remove(i));
    }
    backends
}

fn fits(args: &BenchArgs, spheres: u64, backends: &[Backend]) -> bool {
    let plan = MemoryPlan::of_spheres(spheres, backends, rayon::current_num_threads());
    let limit = args.memory.limit.or_else(system::available_memory);
    limit.is_none_or(|limit| plan.peak() + RAYS <= limit)
}

fn entry(
    args: &BenchArgs,
    arrangement: Arrangement,
    count: u64,
    backends: &[Backend],
    cancel: &Cancel,
) -> Result<Entry> {
    let scene = StandardScene::new(arrangement, count)?;
    let field = build(args, &scene.spheres, backends, cancel)?;
    let measured = measure(args, &field, scene.camera, cancel)?;
    Ok(Entry { arrangement, spheres: count, measured })
}

/// What a scene gave, in a line: the rates of the second bounce, which no cache helps.
fn in_words(entry: &Entry) -> String {
    let name = entry.arrangement.name();
    let mut text = format!("{name}, {}:", print::count(entry.spheres as usize, "sphere"));
    let kind = entry.measured.kind(SECOND_BOUNCE).unwrap_or(0);
    for result in &entry.measured.results {
        if let Some(rates) = result.rates[kind] {
            let rate = print::si(rates.closest.median);
            text += &format!(" {} {rate}rays/s,", result.backend.name());
        }
    }
    match text.strip_suffix(',') {
        Some(text) => text.to_owned(),
        None => text + " no ray gets as far as a second bounce",
    }
}

fn in_json(entry: &Entry, rounds: Rounds) -> Value {
    let spheres = entry.spheres as usize;
    let report = Report { spheres, rounds, measured: &entry.measured };
    json!({ "arrangement": entry.arrangement.name(), "measured": report.in_json() })
}

fn facts(rounds: Rounds) -> Vec<(&'static str, String)> {
    let embree = match embree_info() {
        Some(Ok(EmbreeInfo { runtime_version, instruction_set, .. })) => {
            format!("{runtime_version}, {instruction_set}")
        }
        _ => "none".to_owned(),
    };
    vec![
        ("program", format!("photosphere {}, {COMMIT}", env!("CARGO_PKG_VERSION"))),
        ("embree", embree),
        ("measured with", circumstances(rounds)),
        ("memory", system::memory().map_or("unknown".to_owned(), print::bytes)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_grow_tenfold_up_to_the_largest() {
        assert_eq!(sizes(1).count(), 0);
        assert_eq!(sizes(3).collect::<Vec<_>>(), [3]);
        assert_eq!(sizes(20_000).collect::<Vec<_>>(), [3, 100, 1000, 10_000]);
        assert_eq!(sizes(LARGEST).last(), Some(LARGEST));
    }

    #[test]
    fn brute_force_is_left_out_where_it_is_hopeless() {
        let all = [Backend::Native, Backend::BruteForce];
        assert_eq!(backends_for(&all, 100), all);
        assert_eq!(backends_for(&all, 1_000_000), [Backend::Native]);
    }

    #[test]
    fn the_largest_are_left_out_first() {
        let all = vec![Backend::BruteForce, Backend::Native];
        assert_eq!(those_that_fit(all.clone(), |_| true), all);
        assert_eq!(those_that_fit(all.clone(), |b| b.len() < 2), [Backend::BruteForce]);
        assert_eq!(those_that_fit(all, |b| b.is_empty()), []);
    }
}
