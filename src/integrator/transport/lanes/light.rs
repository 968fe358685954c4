//! Light samples in lanes.

use crate::light::{CategoryPmf, LightSample, LightSampleContext};
use crate::math::Isa;

use super::super::super::context::RenderContext;
use super::super::super::trace::PathRecorder;
use super::super::batch::PathBatch;
use super::horizon::sample_at_horizons;
use super::kernels::{SampleCutEmitter, SampleSingleEmitter};
use super::vertex_batch::VertexBatch;
use super::vertex_kind::VertexKind;

impl<R: PathRecorder> PathBatch<'_, R> {
    /// Samples a light for every lane. Lanes of other kinds than Lambertian ones may be left
    /// missing.
    pub(super) fn sample_lights(&self, isa: Isa, kind: VertexKind, batch: &mut VertexBatch) {
        let lights = self.context.prepared.lights();
        let Some(&emitter) = lights.single_emitter().filter(|emitter| emitter.transmittance == 0.0)
        else {
            batch.light.is_missing.0.fill(true);
            return self.sample_missing_lights(kind, batch);
        };
        batch.light.categories.fill(CategoryPmf::EMITTERS);
        let sphere = self.context.scene.spheres().sphere(emitter.id);
        match (kind, lights.single_emitter_cut()) {
            (VertexKind::Diffuse, None) => {
                isa.run(SampleSingleEmitter::<'_, true> { batch, emitter, sphere });
            }
            (VertexKind::Diffuse, Some(cut)) => {
                isa.run(SampleCutEmitter::<'_, true> { batch, emitter, sphere, cut });
            }
            (_, None) => isa.run(SampleSingleEmitter::<'_, false> { batch, emitter, sphere }),
            (_, Some(cut)) => {
                isa.run(SampleCutEmitter::<'_, false> { batch, emitter, sphere, cut });
            }
        }
        for lane in 0..batch.count {
            batch.light.is_missing.0[lane] |= batch.vertices[lane].id == emitter.id;
        }
        if kind == VertexKind::Diffuse {
            sample_at_horizons(isa, sphere, batch);
        }
        self.sample_missing_lights(kind, batch);
    }

    /// Samples a light for each lane that has none yet.
    fn sample_missing_lights(&self, kind: VertexKind, batch: &mut VertexBatch) {
        let missing = batch.light.is_missing.0.iter().fold(false, |any, &is| any | is);
        if kind != VertexKind::Diffuse || !missing {
            return;
        }
        for lane in 0..batch.count {
            if batch.light.is_missing.0[lane] {
                let hit = batch.hit(lane);
                let ctx = LightSampleContext { hit, is_two_sided: false, is_lambertian: true };
                let (category_pmf, sample) = sample_light_in_lane(self.context, &ctx, batch, lane);
                batch.light.categories[lane] = category_pmf;
                batch.light.set(lane, sample);
            }
        }
    }
}

/// Samples a light with the random numbers of a lane.
pub(super) fn sample_light_in_lane(
    context: RenderContext<'_>,
    ctx: &LightSampleContext,
    batch: &VertexBatch,
    lane: usize,
) -> (CategoryPmf, Option<LightSample>) {
    let u = VertexBatch::pair(&batch.numbers.light, lane);
    let u_select = batch.numbers.light_selection.0[lane];
    let (lights, spheres) = (context.prepared.lights(), context.scene.spheres());
    let category_pmf = lights.category_pmf(ctx);
    (category_pmf, lights.sample_by(&category_pmf, spheres, ctx, u_select, u))
}
