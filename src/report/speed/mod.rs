//! Reports intersector speed as text, JSON and bars, and as a page for the standard scenes.

mod digits;
mod page;
mod sentence;
mod stages;

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
        let SelectedBackend { backend, reason } = self.selection();
        writeln!(
            f,
            "{}, {}, {} a call; `auto` selects {} ({reason})\n",
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
            "\nrays per second over all threads: median of {rounds}, +- half the interquartile range"
        )?;
        for (set, name) in self.measured.ray_sets.iter().enumerate() {
            f.write_str(&header(name, "other ids"))?;
            for result in self.results() {
                f.write_str(&self.backend_rates(result, set))?;
            }
        }
        self.batch_sweep(f)?;
        self.thread_sweep(f)?;
        self.renders(f)?;
        stages::text(&self.measured.stages, f)
    }
}

impl SpeedReport<'_> {
    fn selection(&self) -> SelectedBackend {
        BackendChoice::Auto.select_for_count(self.spheres)
    }

    fn results(&self) -> &[BackendBench] {
        &self.measured.results
    }

    /// Formats one backend's rates on one ray set, compared with the first backend's.
    fn backend_rates(&self, result: &BackendBench, set: usize) -> String {
        let name = result.backend.name();
        let Some(rates) = result.rates[set] else {
            return row(RATES, [name, "-", "", "", "", "", "", ""]);
        };
        let first = self.results()[0].rates[set].unwrap_or(rates);
        let rates_and_baselines =
            [(rates.closest, first.closest), (rates.occluded, first.occluded)];
        rates_row(name, rates_and_baselines, &rates.differing_ids.to_string())
    }

    fn batch_sweep(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for sweep_result in &self.measured.batch_sweep {
            let rays = count(sweep_result.point.batch, "ray");
            write!(f, "\n{SECOND_BOUNCE} rays, {rays} a call{}", header("", ""))?;
            f.write_str(&self.sweep_rows(sweep_result, |_| sweep_result.rates[0]))?;
        }
        Ok(())
    }

    fn thread_sweep(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(single_thread) = self.measured.thread_sweep.first() else { return Ok(()) };
        for sweep_result in &self.measured.thread_sweep {
            let threads = count(sweep_result.point.threads, "thread");
            let arithmetic_ratio = sweep_result.arithmetic.median / single_thread.arithmetic.median;
            write!(
                f,
                "\n{SECOND_BOUNCE} rays, {threads}; ratios to one thread; that of pure arithmetic is \
                 {arithmetic_ratio:.2}{}",
                header("", "")
            )?;
            f.write_str(&self.sweep_rows(sweep_result, |backend| single_thread.rates[backend]))?;
        }
        Ok(())
    }

    /// Formats the rates at one setting; `baseline` gives the rates to compare each backend with.
    fn sweep_rows(
        &self,
        sweep_result: &SweepResult,
        baseline: impl Fn(usize) -> [Quartiles; 2],
    ) -> String {
        let backends = self.results().iter().zip(&sweep_result.rates).enumerate();
        let rows = backends.map(|(i, (result, [closest, occluded]))| {
            let baseline = baseline(i);
            rates_row(
                result.backend.name(),
                [(*closest, baseline[0]), (*occluded, baseline[1])],
                "",
            )
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
                &percent(render.intersector_fraction.median),
                &si(render.rays as f64 / median),
                &render.differing_pixels.to_string(),
            ];
            f.write_str(&row(columns, cells))?;
        }
        Ok(())
    }

    /// Returns the figures as JSON.
    pub fn json(&self) -> Value {
        let SelectedBackend { backend: auto, reason } = self.selection();
        let SceneBench { results, batch_sweep, thread_sweep, renders, .. } = self.measured;
        let sweep = |results: &[SweepResult]| -> Vec<Value> {
            results.iter().map(|result| self.sweep_result(result)).collect()
        };
        json!({
            "spheres": self.spheres,
            "threads": rayon::current_num_threads(),
            "rounds": self.rounds.rounds,
            "batch": self.rounds.batch,
            "auto": { "accel": auto.name(), "reason": reason },
            "backends": results.iter().map(|result| self.backend(result)).collect::<Vec<_>>(),
            "batches": sweep(batch_sweep),
            "scaling": sweep(thread_sweep),
            "renders": renders.iter().map(render_json).collect::<Vec<_>>(),
            "stages": stages::json(&self.measured.stages),
        })
    }

    fn backend(&self, result: &BackendBench) -> Value {
        let rates = |set: usize| {
            result.rates[set].map(|Rates { closest, occluded, differing_ids }| {
                let (closest, occluded) = (rate(closest), rate(occluded));
                json!({ "closest": closest, "occluded": occluded, "differing_ids": differing_ids })
            })
        };
        let ray_sets = self.measured.ray_sets.iter().enumerate();
        let rays: Map<String, Value> =
            ray_sets.map(|(set, name)| (name.replace(' ', "_"), json!(rates(set)))).collect();
        json!({
            "accel": result.backend.name(),
            "details": result.details,
            "build_s": result.build_s.median,
            "build_spread": result.build_s.relative_spread(),
            "bytes_per_sphere": result.bytes_per_sphere,
            "rays": rays,
        })
    }

    fn sweep_result(&self, sweep_result: &SweepResult) -> Value {
        let named = self.measured.results.iter().zip(&sweep_result.rates);
        let rates: Map<String, Value> = named
            .map(|(result, [closest, occluded])| {
                let rates = json!({ "closest": rate(*closest), "occluded": rate(*occluded) });
                (result.backend.name().to_owned(), rates)
            })
            .collect();
        json!({
            "threads": sweep_result.point.threads,
            "batch": sweep_result.point.batch,
            "second_bounce": rates,
            "arithmetic_passes_per_s": sweep_result.arithmetic.median,
        })
    }
}

/// Formats the second-bounce rates on a standard scene; those rays are incoherent.
impl fmt::Display for SuiteEntry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { arrangement, spheres, bench: measured } = self;
        let set = measured.ray_set_index(SECOND_BOUNCE).unwrap_or(0);
        let rates = measured.results.iter().filter_map(|result| {
            let rate = si(result.rates[set]?.closest.median);
            Some(format!("{} {rate}rays/s", result.backend.name()))
        });
        let rates = rates.collect::<Vec<_>>().join(", ");
        let rates = if rates.is_empty() { "no ray reaches a second bounce" } else { &rates };
        write!(f, "{}, {}: {rates}", arrangement.name(), count(*spheres as usize, "sphere"))
    }
}

/// Returns the measurements of standard scenes as JSON.
pub fn entries_json(entries: &[SuiteEntry], rounds: BenchOptions) -> Value {
    let entry = |SuiteEntry { arrangement, spheres, bench: measured }: &SuiteEntry| {
        let report = SpeedReport { spheres: *spheres as usize, rounds, measured };
        json!({ "arrangement": arrangement.name(), "measured": report.json() })
    };
    entries.iter().map(entry).collect()
}

fn header(name: &str, last: &str) -> String {
    let cells = [name, "closest", "+-", "ratio", "occluded", "+-", "ratio", last];
    format!("\n{}", row(RATES, cells))
}

/// Formats two rates, each with the rate it is compared with.
fn rates_row(name: &str, rates: [(Quartiles, Quartiles); 2], last: &str) -> String {
    let [closest, occluded] = rates.map(|(rate, baseline)| {
        [si(rate.median), spread(rate), format!("{:.2}", rate.median / baseline.median)]
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

fn render_json(render: &RenderBench) -> Value {
    json!({
        "accel": render.backend.name(),
        "seconds": render.seconds.median,
        "spread": render.seconds.relative_spread(),
        "intersector_fraction": render.intersector_fraction.median,
        "rays": render.rays,
        "samples": render.samples,
        "differing_pixels": render.differing_pixels,
    })
}
