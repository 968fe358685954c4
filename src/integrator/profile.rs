//! Where the time of the stages goes, for `bench`.

use std::time::Instant;

use crate::names::named_enum;

/// A stage of the path tracer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Camera rays.
    CameraRays,
    /// Closest hits, by the intersector.
    ClosestHits,
    /// Sorting hits by surface, and shading misses.
    Sorting,
    /// Hit points and normals.
    HitPoints,
    /// Random numbers.
    RandomNumbers,
    /// Light samples.
    LightSamples,
    /// Directions of diffuse surfaces and mirrors.
    Directions,
    /// The other surfaces, and handing on rays and paths.
    Finishing,
    /// Occlusion, by the intersector.
    Occlusion,
    /// Adding the light that arrives.
    AddingLight,
}

named_enum! {
    Stage {
        CameraRays = "camera rays",
        ClosestHits = "closest hits",
        Sorting = "sorting by surface",
        HitPoints = "hit points",
        RandomNumbers = "random numbers",
        LightSamples = "light samples",
        Directions = "directions",
        Finishing = "finishing",
        Occlusion = "occlusion",
        AddingLight = "adding light",
    }
}

/// The time of all stages, and the vertices that they shaded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StageProfile {
    nanoseconds: [u64; Stage::NAMES.len()],
    /// Vertices on surfaces.
    pub vertices: u64,
    /// Those of them that the scalar code shaded.
    pub scalar_vertices: u64,
}

impl StageProfile {
    /// Returns the nanoseconds of a stage.
    pub fn nanoseconds(&self, stage: Stage) -> u64 {
        self.nanoseconds[stage as usize]
    }
}

/// Measures stages, if it is asked to: the time since the last stage ended.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StageClock {
    running: Option<(Instant, StageProfile)>,
}

impl StageClock {
    /// A clock that runs.
    pub(super) fn started() -> Self {
        Self { running: Some((Instant::now(), StageProfile::default())) }
    }

    /// What was measured.
    pub(super) fn profile(&self) -> Option<StageProfile> {
        self.running.map(|(_, profile)| profile)
    }

    /// Begins a batch: what happened since the last stage does not count.
    pub(super) fn begin(&mut self) {
        if let Some((last, _)) = &mut self.running {
            *last = Instant::now();
        }
    }

    /// Ends a stage.
    #[inline(always)]
    pub(super) fn end(&mut self, stage: Stage) {
        if let Some((last, profile)) = &mut self.running {
            let now = Instant::now();
            let elapsed = now.duration_since(*last).as_nanos() as u64;
            profile.nanoseconds[stage as usize] += elapsed;
            *last = now;
        }
    }

    /// Counts vertices, of which the scalar code shades some.
    #[inline(always)]
    pub(super) fn count(&mut self, vertices: usize, scalar_vertices: usize) {
        if let Some((_, profile)) = &mut self.running {
            profile.vertices += vertices as u64;
            profile.scalar_vertices += scalar_vertices as u64;
        }
    }
}
