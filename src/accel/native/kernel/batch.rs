//! A batch of rays and its progress.

use crate::accel::native::aggregate::Aggregate;
use crate::accel::native::query::BestHit;
use crate::math::Ray;

use super::query_mode::QueryMode;
use super::ray_state::RayState;
use super::simd::Simd8;

/// A batch of rays and its progress.
pub(super) struct RayBatch<'a, Q: QueryMode> {
    pub(super) bvh: &'a Aggregate,
    pub(super) rays: &'a [Ray],
    pub(super) outputs: &'a mut [Q::Output],
    /// The next ray to load.
    pub(super) next: usize,
    /// One past the last ray to load.
    pub(super) end: usize,
}

impl<Q: QueryMode> RayBatch<'_, Q> {
    /// Loads the next ray that needs the tree into the slot, and resolves those before it that do
    /// not. Returns false if no ray is left.
    ///
    /// # Safety
    /// `slot` is valid for writing, the CPU supports `L`, and there are as many outputs as rays.
    #[inline(always)]
    pub(super) unsafe fn load_next_ray<L: Simd8>(&mut self, slot: *mut RayState) -> bool {
        while let Some(ray) = self.rays[..self.end].get(self.next) {
            let number = self.next;
            self.next += 1;
            let mut best = BestHit::none(ray);
            // SAFETY: upheld by the caller.
            unsafe {
                if is_valid::<L>(ray) {
                    best = self.bvh.closest_giant(ray, Q::ANY_HIT);
                    let root = self.bvh.tree.root;
                    let is_open = !(Q::ANY_HIT && best.is_hit());
                    if is_open && RayState::init(slot, ray, best, number as u32, root) {
                        return true;
                    }
                }
                *self.outputs.get_unchecked_mut(number) = Q::output(best);
            }
        }
        false
    }
}

/// [`Ray::is_valid`], on all numbers at once.
///
/// # Safety
/// The CPU supports `L`.
#[inline(always)]
pub(super) unsafe fn is_valid<L: Simd8>(ray: &Ray) -> bool {
    /// Bounds of valid numbers, lane by lane.
    #[repr(C, align(32))]
    struct ValidRange([f32; 8]);
    const MOST: f32 = 4.0 * crate::math::MAX_COORDINATE as f32;
    const INFINITE: f32 = f32::INFINITY;
    static LOW: ValidRange = ValidRange([-MOST, -MOST, -MOST, 0.0, -MOST, -MOST, -MOST, 0.0]);
    static HIGH: ValidRange = ValidRange([MOST, MOST, MOST, MOST, MOST, MOST, MOST, INFINITE]);
    // SAFETY: a ray begins with its origin, t_min, direction and t_max: eight aligned numbers.
    unsafe {
        let numbers = L::load(std::ptr::from_ref(ray).cast());
        let is_above = L::le(L::load(LOW.0.as_ptr()), numbers);
        let is_below = L::le(numbers, L::load(HIGH.0.as_ptr()));
        L::mask_bits(L::and(is_above, is_below)) == 0xff
    }
}
