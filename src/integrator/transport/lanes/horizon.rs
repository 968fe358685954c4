//! Light samples of an emitter that the horizon cuts, in lanes: those of a batch, put together.

use crate::geometry::Sphere;
use crate::light::sample_at_horizon;
use crate::math::{DVec3, Isa, SimdKernel};

use super::vertex_batch::VertexBatch;

/// Number of lanes that are sampled together.
const GROUP: usize = 8;

/// A vector for every lane of a group.
type Group3 = [[f64; GROUP]; 3];

/// Lanes of a batch at whose points the horizon cuts the emitter.
#[derive(Default)]
struct HorizonGroup {
    /// Lanes in use.
    count: usize,
    lanes: [usize; GROUP],
    point: Group3,
    normal: Group3,
    u: [[f64; GROUP]; 2],
    direction: Group3,
    distance: [f64; GROUP],
    pdf: [f64; GROUP],
}

/// Samples the emitter for every lane of a batch at which the horizon cuts it.
pub(super) fn sample_at_horizons(isa: Isa, sphere: Sphere, batch: &mut VertexBatch) {
    sample_lanes::<true>(isa, sphere, batch);
    sample_lanes::<false>(isa, sphere, batch);
}

fn sample_lanes<const IS_LUNE: bool>(isa: Isa, sphere: Sphere, batch: &mut VertexBatch) {
    let light = &batch.light;
    let is_due = |lane: &usize| {
        let is_cut = light.is_cut.0[*lane] & !light.is_missing.0[*lane];
        is_cut & (light.is_lune.0[*lane] == IS_LUNE)
    };
    let due = (0..batch.count).filter(is_due).fold(0u32, |due, lane| due | 1 << lane);
    let mut lanes = Bits(due);
    while lanes.0 != 0 {
        let mut group = HorizonGroup::default();
        lanes.by_ref().take(GROUP).for_each(|lane| group.push(batch, lane));
        isa.run(SampleAtHorizon::<'_, IS_LUNE> { group: &mut group, sphere });
        group.store(batch);
    }
}

/// The indices of the bits that are set.
struct Bits(u32);

impl Iterator for Bits {
    type Item = usize;

    fn next(&mut self) -> Option<usize> {
        let first = self.0.trailing_zeros();
        self.0 &= self.0.wrapping_sub(1);
        (first < u32::BITS).then_some(first as usize)
    }
}

impl HorizonGroup {
    fn push(&mut self, batch: &VertexBatch, lane: usize) {
        let n = self.count;
        self.lanes[n] = lane;
        set(&mut self.point, n, batch.hit.point.get(lane));
        set(&mut self.normal, n, batch.hit.facing_normal.get(lane));
        let [first, second] = VertexBatch::pair(&batch.numbers.light, lane);
        self.u[0][n] = first;
        self.u[1][n] = second;
        self.count += 1;
    }

    fn store(&self, batch: &mut VertexBatch) {
        for (n, &lane) in self.lanes.iter().enumerate().take(self.count) {
            batch.light.direction.set(lane, get(&self.direction, n));
            batch.light.distance.0[lane] = self.distance[n];
            batch.light.pdf.0[lane] = self.pdf[n];
        }
    }
}

/// Samples the emitter for a group of lanes.
struct SampleAtHorizon<'a, const IS_LUNE: bool> {
    group: &'a mut HorizonGroup,
    sphere: Sphere,
}

impl<const IS_LUNE: bool> SimdKernel for SampleAtHorizon<'_, IS_LUNE> {
    #[inline(always)]
    fn run(self) {
        let Self { group, sphere } = self;
        for n in 0..GROUP {
            let (point, normal) = (get(&group.point, n), get(&group.normal, n));
            let u = [group.u[0][n], group.u[1][n]];
            let sample = sample_at_horizon::<IS_LUNE>(point, normal, &sphere, u);
            set(&mut group.direction, n, sample.direction);
            group.distance[n] = sample.distance;
            group.pdf[n] = sample.pdf;
        }
    }
}

#[inline(always)]
fn get(v: &Group3, n: usize) -> DVec3 {
    DVec3::new(v[0][n], v[1][n], v[2][n])
}

#[inline(always)]
fn set(v: &mut Group3, n: usize, value: DVec3) {
    v[0][n] = value.x;
    v[1][n] = value.y;
    v[2][n] = value.z;
}
