//! Gauss-Legendre quadrature over an interval.

use std::f64::consts::PI;

/// Nodes in (0, 1) and weights of the Gauss-Legendre rule with `n` nodes, exact for polynomials up
/// to degree `2 n - 1` (Davis and Rabinowitz 1984, section 2.7).
pub(super) fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    (0..n).map(|i| node(n, i)).collect()
}

/// Finds a root of the Legendre polynomial by Newton's method, from Tricomi's approximation.
fn node(n: usize, i: usize) -> (f64, f64) {
    let mut x = libm::cos(PI * (i as f64 + 0.75) / (n as f64 + 0.5));
    let mut slope = 1.0;
    for _ in 0..100 {
        let (value, derivative) = legendre(n, x);
        slope = derivative;
        let step = value / derivative;
        x -= step;
        if step.abs() < 1e-16 {
            break;
        }
    }
    ((1.0 + x) / 2.0, 1.0 / ((1.0 - x * x) * slope * slope))
}

/// The Legendre polynomial of degree `n` and its derivative, by the three-term recurrence.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut previous, mut value) = (0.0, 1.0);
    for k in 0..n {
        let k = k as f64;
        let next = ((2.0 * k + 1.0) * x * value - k * previous) / (k + 1.0);
        previous = value;
        value = next;
    }
    (value, n as f64 * (x * value - previous) / (x * x - 1.0))
}

/// Integrates `f` over `[low, high]` with `n` nodes.
pub(super) fn integral(low: f64, high: f64, n: usize, f: impl Fn(f64) -> f64) -> f64 {
    let width = high - low;
    gauss_legendre(n).iter().map(|(x, weight)| weight * width * f(low + width * x)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn polynomials_up_to_the_promised_degree_are_exact() {
        for n in [1, 2, 5, 16] {
            let degree = 2 * n as i32 - 1;
            let found = integral(0.5, 2.0, n, |x| x.powi(degree));
            let exact = (2f64.powi(degree + 1) - 0.5f64.powi(degree + 1)) / f64::from(degree + 1);
            assert_relative_eq!(found, exact, max_relative = 1e-13);
        }
        assert_relative_eq!(integral(0.0, PI, 12, f64::sin), 2.0, max_relative = 1e-13);
    }
}
