//! Reports intersector speed as text, JSON and bars, and as a page for the standard scenes.

mod page;

use std::fmt;

pub use page::page;

use serde_json::{Map, Value, json};

use crate::accel::{BackendChoice, SelectedBackend};
use crate::draw::text::{count, percent, row, si};
use crate::verify::bench::{
    BackendBench, BenchOptions, Quartiles, Rates, RenderBench, SECOND_BOUNCE, SceneBench,
    SuiteEntry, SweepResult,
};

/// Measurements of one scene.
#[derive(Clone, Copy, Debug)]
pub struct SpeedReport<'a> {
    /// Number of spheres in the scene.
    pub spheres: usize,
    /// Options of the measurement.
    pub rounds: BenchOptions,
    /// Measured figures.
    pub measured: &'a SceneBench,
}

/// Column widths of a table of rates.
const RATES: [i32; 8] = [-14, 10, 8, 8, 12, 8, 8, 12];

impl fmt::Display for SpeedReport<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let BenchOptions { rounds, batch } = self.rounds;
        let SelectedBackend { backend, reason } = self.choice();
        writeln!(
            f,
            "{}, {}, {} a call; `auto` takes {} ({reason})\n",
            count(self.spheres, "sphere"),
            count(rayon::current_num_threads(), "thread"),
            count(batch, "ray"),
            backend.name(),
        )?;
        let columns = [-12, 10, 8, 18, -3, -1];
        f.write_str(&row(columns, ["", "build (s)", "+-", "bytes per sphere", "", ""]))?;
        for BackendBench { backend, build_s, bytes_per_sphere, details, .. } in self.results() {
            let seconds = format!("{:.3}", build_s.median);
            let bytes = format!("{bytes_per_sphere:.1}");
            let cells = [backend.name(), &seconds, &spread(*build_s), &bytes, "", details];
            f.write_str(&row(columns, cells))?;
        }
        let rounds = count(rounds, "round");
        writeln!(
            f,
            "\nrays per second of all threads: median of {rounds}, and the spread of half of them"
        )?;
        for (kind, name) in self.measured.ray_sets.iter().enumerate() {
            f.write_str(&head(name, "other ids"))?;
            for result in self.results() {
                f.write_str(&self.of_kind(result, kind))?;
            }
        }
        self.batches(f)?;
        self.scaling(f)?;
        self.renders(f)
    }
}

impl SpeedReport<'_> {
    fn choice(&self) -> SelectedBackend {
        BackendChoice::Auto.select_for_count(self.spheres)
    }

    fn results(&self) -> &[BackendBench] {
        &self.measured.results
    }

    /// Formats one backend's rates on one ray set, compared with the first backend's.
    fn of_kind(&self, result: &BackendBench, kind: usize) -> String {
        let name = result.backend.name();
        let Some(rates) = result.rates[kind] else {
            return row(RATES, [name, "-", "", "", "", "", "", ""]);
        };
        let first = self.results()[0].rates[kind].unwrap_or(rates);
        let both = [(rates.closest, first.closest), (rates.occluded, first.occluded)];
        rates_row(name, both, &rates.differing_ids.to_string())
    }

    fn batches(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for swept in &self.measured.batch_sweep {
            let rays = count(swept.point.batch, "ray");
            write!(f, "\n{SECOND_BOUNCE} rays, {rays} a call{}", head("", ""))?;
            f.write_str(&self.rows_of(swept, |_| swept.rates[0]))?;
        }
        Ok(())
    }

    fn scaling(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(one) = self.measured.thread_sweep.first() else { return Ok(()) };
        for swept in &self.measured.thread_sweep {
            let threads = count(swept.point.threads, "thread");
            let gain = swept.arithmetic.median / one.arithmetic.median;
            write!(
                f,
                "\n{SECOND_BOUNCE} rays, {threads}; ratios to one thread; that of pure arithmetic is \
                 {gain:.2}{}",
                head("", "")
            )?;
            f.write_str(&self.rows_of(swept, |backend| one.rates[backend]))?;
        }
        Ok(())
    }

    /// Formats the rates at one setting; `with` gives the rates to compare each backend with.
    fn rows_of(&self, swept: &SweepResult, with: impl Fn(usize) -> [Quartiles; 2]) -> String {
        let backends = self.results().iter().zip(&swept.rates).enumerate();
        let rows = backends.map(|(i, (result, [closest, occluded]))| {
            let with = with(i);
            rates_row(result.backend.name(), [(*closest, with[0]), (*occluded, with[1])], "")
        });
        rows.collect()
    }

    fn renders(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(first) = self.measured.renders.first() else { return Ok(()) };
        let columns = [-14, 10, 8, 8, 14, 12, 16];
        let names = ["render", "seconds", "+-", "ratio", "intersector", "rays/s", "other pixels"];
        write!(f, "\n{}", row(columns, names))?;
        for render in &self.measured.renders {
            let Quartiles { median, .. } = render.seconds;
            let cells = [
                render.backend.name(),
                &format!("{median:.3}"),
                &spread(render.seconds),
                &format!("{:.2}", median / first.seconds.median),
                &percent(render.intersector_share.median),
                &si(render.rays as f64 / median),
                &render.differing_pixels.to_string(),
            ];
            f.write_str(&row(columns, cells))?;
        }
        Ok(())
    }

    /// Returns the figures as JSON.
    pub fn json(&self) -> Value {
        let SelectedBackend { backend: auto, reason } = self.choice();
        let SceneBench { results, batch_sweep: batches, thread_sweep: scaling, renders, .. } =
            self.measured;
        json!({
            "spheres": self.spheres,
            "threads": rayon::current_num_threads(),
            "rounds": self.rounds.rounds,
            "batch": self.rounds.batch,
            "auto": { "accel": auto.name(), "reason": reason },
            "backends": results.iter().map(|result| self.backend(result)).collect::<Vec<_>>(),
            "batches": batches.iter().map(|swept| self.swept(swept)).collect::<Vec<_>>(),
            "scaling": scaling.iter().map(|swept| self.swept(swept)).collect::<Vec<_>>(),
            "renders": renders.iter().map(whole).collect::<Vec<_>>(),
        })
    }

    fn backend(&self, result: &BackendBench) -> Value {
        let rates = |kind: usize| {
            result.rates[kind].map(|Rates { closest, occluded, differing_ids: other_ids }| {
                let (closest, occluded) = (rate(closest), rate(occluded));
                json!({ "closest": closest, "occluded": occluded, "other_ids": other_ids })
            })
        };
        let kinds = self.measured.ray_sets.iter().enumerate();
        let rays: Map<String, Value> =
            kinds.map(|(kind, name)| (name.replace(' ', "_"), json!(rates(kind)))).collect();
        json!({
            "accel": result.backend.name(),
            "details": result.details,
            "build_s": result.build_s.median,
            "build_spread": result.build_s.relative_spread(),
            "bytes_per_sphere": result.bytes_per_sphere,
            "rays": rays,
        })
    }

    fn swept(&self, swept: &SweepResult) -> Value {
        let named = self.measured.results.iter().zip(&swept.rates);
        let rates: Map<String, Value> = named
            .map(|(result, [closest, occluded])| {
                let rates = json!({ "closest": rate(*closest), "occluded": rate(*occluded) });
                (result.backend.name().to_owned(), rates)
            })
            .collect();
        json!({
            "threads": swept.point.threads,
            "batch": swept.point.batch,
            "second_bounce": rates,
            "arithmetic_passes_per_s": swept.arithmetic.median,
        })
    }
}

/// Formats the second-bounce rates on a standard scene; those rays are incoherent.
impl fmt::Display for SuiteEntry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { arrangement, spheres, bench: measured } = self;
        let kind = measured.ray_set_index(SECOND_BOUNCE).unwrap_or(0);
        let rates = measured.results.iter().filter_map(|result| {
            let rate = si(result.rates[kind]?.closest.median);
            Some(format!("{} {rate}rays/s", result.backend.name()))
        });
        let rates = rates.collect::<Vec<_>>().join(", ");
        let rates = if rates.is_empty() { "no ray gets as far as a second bounce" } else { &rates };
        write!(f, "{}, {}: {rates}", arrangement.name(), count(*spheres as usize, "sphere"))
    }
}

/// Returns the measurements of standard scenes as JSON.
pub fn entries_json(entries: &[SuiteEntry], rounds: BenchOptions) -> Value {
    let one = |SuiteEntry { arrangement, spheres, bench: measured }: &SuiteEntry| {
        let report = SpeedReport { spheres: *spheres as usize, rounds, measured };
        json!({ "arrangement": arrangement.name(), "measured": report.json() })
    };
    entries.iter().map(one).collect()
}

fn head(name: &str, last: &str) -> String {
    let cells = [name, "closest", "+-", "ratio", "occluded", "+-", "ratio", last];
    format!("\n{}", row(RATES, cells))
}

/// Formats two rates, each with the rate it is compared with.
fn rates_row(name: &str, rates: [(Quartiles, Quartiles); 2], last: &str) -> String {
    let [closest, occluded] = rates.map(|(rate, with)| {
        [si(rate.median), spread(rate), format!("{:.2}", rate.median / with.median)]
    });
    let ([a, b, c], [d, e, f]) = (&closest, &occluded);
    row(RATES, [name, a, b, c, d, e, f, last])
}

fn spread(figure: Quartiles) -> String {
    format!("{:.0} %", 100.0 * figure.relative_spread())
}

fn rate(rate: Quartiles) -> Value {
    json!({ "rays_per_s": rate.median, "spread": rate.relative_spread() })
}

fn whole(render: &RenderBench) -> Value {
    json!({
        "accel": render.backend.name(),
        "seconds": render.seconds.median,
        "spread": render.seconds.relative_spread(),
        "intersector_share": render.intersector_share.median,
        "rays": render.rays,
        "samples": render.samples,
        "other_pixels": render.differing_pixels,
    })
}
