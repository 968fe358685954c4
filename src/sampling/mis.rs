//! Weights for multiple importance sampling.

/// The power heuristic with exponent 2 for a sample with density `pdf` under its own strategy and
/// `other_pdf` under the other strategy (Veach 1997, section 9.2.4).
///
/// Written with the ratio of the densities: their squares overflow for a distant emitter.
#[inline(always)]
pub fn power_heuristic(pdf: f64, other_pdf: f64) -> f64 {
    let ratio = other_pdf / pdf;
    1.0 / (1.0 + ratio * ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weights_of_both_strategies_add_up_to_one() {
        for (a, b) in [(1.0, 1.0), (0.3, 5.0), (1e300, 1e-300), (1e-200, 2e-200)] {
            let sum = power_heuristic(a, b) + power_heuristic(b, a);
            assert!((sum - 1.0).abs() < 1e-15, "{a} {b}: {sum}");
        }
        assert_eq!(power_heuristic(2.0, 0.0), 1.0);
    }
}
