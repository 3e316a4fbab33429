//! Gauss-Legendre quadrature.

use std::f64::consts::PI;

/// Places and weights of the Gauss-Legendre rule with `count` places on 0..1, in rising order: the integral of f is
/// the sum of weight f(place), exact for polynomials up to the degree 2 `count` - 1.
///
/// The places are the roots of the Legendre polynomial, by Newton's method.
pub(crate) fn gauss(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    (0..count)
        .map(|i| {
            let mut root = (PI * (i as f64 + 0.75) / (n + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..8 {
                let (mut before, mut now) = (0.0, 1.0);
                for k in 0..count {
                    let k = k as f64;
                    (before, now) = (now, ((2.0 * k + 1.0) * root * now - k * before) / (k + 1.0));
                }
                slope = n * (root * now - before) / (root * root - 1.0);
                root -= now / slope;
            }
            (0.5 - 0.5 * root, 1.0 / ((1.0 - root * root) * slope * slope))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gauss_integrates_polynomials() {
        for power in 0..9 {
            let sum: f64 = gauss(5).iter().map(|(place, weight)| weight * place.powi(power)).sum();
            assert!((sum - 1.0 / f64::from(power + 1)).abs() < 1e-13, "power {power}: {sum}");
        }
    }
}
