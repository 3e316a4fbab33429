//! The model error of the signals beyond their noise, as one number.

/// Largest model error in the search: a fit with more is refused anyway.
const MISFIT_MAX: f64 = 0.3;
/// Halvings of that range: to 1e-5.
const HALVINGS: usize = 15;

/// The relative model error with which `chi2` equals the number of degrees of freedom; 0 where the noise explains
/// everything.
pub(crate) fn misfit(chi2: impl Fn(f64) -> f64, freedom: f64) -> f64 {
    if chi2(0.0) <= freedom {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, MISFIT_MAX);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if chi2(middle) > freedom {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_residual_of_two_hundredths_beside_little_noise_is_a_misfit_of_two_hundredths() {
        let chi2 = |model_error: f64| 50.0 * 0.02_f64.powi(2) / (0.001_f64.powi(2) + model_error.powi(2));
        assert!((misfit(chi2, 50.0) - 0.02).abs() < 5e-5, "{}", misfit(chi2, 50.0));
        assert_eq!(misfit(|model_error: f64| 40.0 / (1.0 + model_error), 50.0), 0.0);
    }
}
