//! The stages of renders, as text and JSON.

use std::fmt;

use serde_json::{Map, Value, json};

use crate::accel::Backend;
use crate::draw::text::percent;
use crate::integrator::{Stage, StageProfile};

/// Writes a table of nanoseconds per vertex: a row for each stage, a column for each intersector.
pub(super) fn text(stages: &[(Backend, StageProfile)], f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let Some((_, first)) = stages.first().filter(|(_, first)| first.vertices > 0) else {
        return Ok(());
    };
    let scalar = first.scalar_vertices as f64 / first.vertices as f64;
    writeln!(
        f,
        "\nnanoseconds per vertex of a path, on one thread; {} vertices, {} by the scalar code",
        first.vertices,
        percent(scalar)
    )?;
    let line = |name: &str, cell: &dyn Fn(&(Backend, StageProfile)) -> String| {
        let cells: String = stages.iter().map(|each| format!("{:>13}", cell(each))).collect();
        format!("{name:<20}{cells}\n")
    };
    f.write_str(&line("stage", &|(backend, _)| backend.name().to_owned()))?;
    for &(name, stage) in Stage::NAMES {
        let time = |(_, profile): &(Backend, StageProfile)| {
            format!("{:.1}", per_vertex(profile, profile.nanoseconds(stage)))
        };
        f.write_str(&line(name, &time))?;
    }
    let outside = |(_, profile): &(Backend, StageProfile)| {
        format!("{:.1}", per_vertex(profile, outside_intersector(profile)))
    };
    f.write_str(&line("but the intersector", &outside))
}

/// Returns the figures as JSON.
pub(super) fn json(stages: &[(Backend, StageProfile)]) -> Vec<Value> {
    let one = |(backend, profile): &(Backend, StageProfile)| {
        let time = |&(name, stage): &(&str, Stage)| {
            (name.replace(' ', "_"), json!(per_vertex(profile, profile.nanoseconds(stage))))
        };
        let times: Map<String, Value> = Stage::NAMES.iter().map(time).collect();
        json!({
            "accel": backend.name(),
            "vertices": profile.vertices,
            "scalar_vertices": profile.scalar_vertices,
            "ns_per_vertex": times,
            "ns_per_vertex_outside_intersector":
                per_vertex(profile, outside_intersector(profile)),
        })
    };
    stages.iter().map(one).collect()
}

fn per_vertex(profile: &StageProfile, nanoseconds: u64) -> f64 {
    nanoseconds as f64 / profile.vertices.max(1) as f64
}

fn outside_intersector(profile: &StageProfile) -> u64 {
    let is_outside = |stage: &Stage| !matches!(stage, Stage::ClosestHits | Stage::Occlusion);
    let stages = Stage::NAMES.iter().map(|&(_, stage)| stage).filter(is_outside);
    stages.map(|stage| profile.nanoseconds(stage)).sum()
}
