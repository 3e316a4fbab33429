//! The figures of the paper "A Tactile Display Using Elastic Waves in a Tapered Plate", as printed and corrected.
//!
//! ```text
//! figures() -> Figure { panels: [as printed, corrected] } -> to_csv(), or a picture (the caller draws it)
//! ```
//! The paper does not give the rate of the taper, the wave speed, the loss or the thickness of the plate, so every
//! panel states the values it assumes. `d` is always 4.62 /m, which makes a plate four times narrower over 300 mm.

mod amplitude;
mod boundary;
mod csv;
mod dispersion;
pub(crate) mod figure;
mod potential;
mod printed;
mod rubber;
mod superposition;

pub use figure::{Figure, FigureError, Mark, Panel, RATE_PER_M, Series, Stroke};

/// The figures 2, 3, 4, 5, 7 and 9 of the paper.
///
/// # Errors
/// [`FigureError`] if a preset of a figure is missing or its frequencies do not enter; the presets as shipped give no
/// error.
pub fn figures() -> Result<Vec<Figure>, FigureError> {
    Ok(vec![
        dispersion::figure(),
        potential::figure(),
        amplitude::figure()?,
        boundary::figure()?,
        superposition::figure()?,
        rubber::figure()?,
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_figures_have_both_panels_with_a_convention_each() {
        let all = figures().expect("the presets show them");
        assert_eq!(all.iter().map(|figure| figure.number).collect::<Vec<_>>(), [2, 3, 4, 5, 7, 9].map(Some));
        for figure in &all {
            assert_eq!(figure.panels[0].heading, "as printed");
            assert_eq!(figure.panels[1].heading, "corrected");
            for panel in &figure.panels {
                assert!(!panel.convention.is_empty() && !panel.series.is_empty(), "{:?}", figure.number);
                for series in &panel.series {
                    assert!(series.points.len() > 1, "{}", series.name);
                    assert!(
                        series.points.iter().all(|p| p.0.is_finite() && p.1.is_finite()),
                        "{}",
                        series.name
                    );
                }
                for mark in &panel.marks {
                    assert!(mark.x >= panel.x_range.0 && mark.x <= panel.x_range.1, "{mark:?}");
                }
            }
        }
    }
}
