//! `photosphere bench --suite`: the standard scenes, one size after the other, on one page.

use std::io::Write;
use std::path::Path;

use crate::accel::{Backend, BuildOptions};
use crate::error::Result;
use crate::generate::Arrangement;
use crate::output::WholeFile;
use crate::render::MemoryPlan;
use crate::verify::bench::{Rounds, bench, kinds_of_rays};
use crate::verify::bench_page::{Entry, page};
use crate::verify::standard::StandardScene;

use super::args::BenchArgs;
use super::bench::circumstances;
use super::exit::Exit;
use super::{print, system};

/// The largest scene unless `--largest` says another.
const LARGEST: u64 = 100_000_000;
/// The most spheres that every ray is held against one by one.
const MOST_FOR_BRUTE_FORCE: u64 = 10_000;
/// All the rays, and their copies for each intersector.
const RAYS: u64 = 1 << 30;

/// # Errors
/// When an intersector cannot be built, or the page not be written.
pub(super) fn run(args: &BenchArgs, path: &Path) -> Result<Exit> {
    let file = WholeFile::new(path)?;
    let rounds = Rounds { count: args.rounds.into(), batch: args.batch as usize };
    let mut entries = Vec::new();
    for count in sizes(args.largest.unwrap_or(LARGEST)) {
        let backends = backends_for(args.accels.backends(), count);
        if !fits(args, count, &backends) {
            print::remark(format_args!("{count} spheres would not fit into memory"));
            break;
        }
        for (_, arrangement) in Arrangement::NAMES {
            let entry = measure(args, arrangement, count, &backends, rounds)?;
            print::remark(in_words(&entry));
            entries.push(entry);
        }
    }
    let text = page(&facts(rounds), &entries)?;
    file.write(|to| to.write_all(text.as_bytes()))?;
    print::remark(format_args!("wrote {}", path.display()));
    Ok(Exit::Done)
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

fn fits(args: &BenchArgs, spheres: u64, backends: &[Backend]) -> bool {
    let plan = MemoryPlan::of_spheres(spheres, backends, rayon::current_num_threads());
    let limit = args.memory.limit.or_else(system::available_memory);
    limit.is_none_or(|limit| plan.peak() + RAYS <= limit)
}

fn measure(
    args: &BenchArgs,
    arrangement: Arrangement,
    count: u64,
    backends: &[Backend],
    rounds: Rounds,
) -> Result<Entry> {
    let scene = StandardScene::new(arrangement, count)?;
    let (threads, quality) = (rayon::current_num_threads(), args.build.quality);
    let options = BuildOptions { threads, quality, ..Default::default() };
    let accel = backends[0].build(&scene.spheres, &options)?;
    let kinds = kinds_of_rays(&scene.spheres, &*accel, scene.camera);
    drop(accel);
    let results = bench(&scene.spheres, backends, &kinds, &options, rounds)?;
    let kinds = kinds.iter().map(|kind| kind.name).collect();
    Ok(Entry { arrangement, spheres: count, kinds, results })
}

/// What a scene gave, in a line: the rates of the second bounce, which no cache helps.
fn in_words(entry: &Entry) -> String {
    let name = entry.arrangement.name();
    let mut text = format!("{name}, {}:", print::count(entry.spheres as usize, "sphere"));
    let kind = entry.kinds.iter().position(|&kind| kind == "second bounce").unwrap_or(0);
    for result in &entry.results {
        let rate = result.rates[kind].map_or("-".to_owned(), |r| print::si(r.closest.median));
        text += &format!(" {} {rate}rays/s,", result.backend.name());
    }
    text.trim_end_matches(',').to_owned()
}

fn facts(rounds: Rounds) -> Vec<(&'static str, String)> {
    let memory = system::memory().map_or("unknown".to_owned(), print::bytes);
    vec![
        ("program", format!("photosphere {}", env!("CARGO_PKG_VERSION"))),
        ("measured with", circumstances(rounds)),
        ("memory", memory),
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
}
