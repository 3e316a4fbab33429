//! The figures of the paper "A Tactile Display Using Elastic Waves in a Tapered Plate", as printed and corrected.
//!
//! ```text
//! figures() -> Figure { panels: [as printed, corrected] } -> to_csv(), or a picture (drawn by whoever has a canvas)
//! ```
//! The paper gives neither the taper's rate, nor the wave speed, nor the loss, nor the plate's thickness: every panel
//! states the convention it supposes. `d` is 4.62 /m throughout, the rate that narrows a plate fourfold in 300 mm.

mod amplitude;
mod boundary;
mod csv;
mod dispersion;
mod figure;
mod potential;
mod printed;
mod rubber;
mod superposition;

pub use figure::{Figure, FigureError, Mark, Panel, RATE_PER_M, Series, Stroke};

/// Fig. 2, 3, 4, 5, 7 and 9.
///
/// # Errors
/// [`FigureError`] only if the presets were changed into something that cannot show the figures.
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
        assert_eq!(all.iter().map(|figure| figure.number).collect::<Vec<_>>(), [2, 3, 4, 5, 7, 9]);
        for figure in &all {
            assert_eq!(figure.panels[0].heading, "as printed");
            assert_eq!(figure.panels[1].heading, "corrected");
            for panel in &figure.panels {
                assert!(!panel.convention.is_empty() && !panel.series.is_empty(), "{}", figure.number);
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
