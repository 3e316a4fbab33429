//! The figures of the physics page: one dimension against two, with the limits of each.
//!
//! ```text
//! figures() -> Figure { panels } -> to_csv(), or a picture (the caller draws it)
//! ```
//! Lines are the one-mode equation, dots and dashes the plate in two dimensions.

mod clamped;
mod field;
mod finger;
mod reflection;
mod turning;

use crate::definition::plate::Plate;
use crate::frequency::equation::Equation;
use crate::frequency::finger::Finger;
use crate::frequency::respond::{Response, respond_touched};
use crate::paper::figure::{Figure, FigureError, POINTS, magnitude};
use crate::plane;

/// The figures of the physics page, in its order.
///
/// # Errors
/// [`FigureError`] if a preset of a figure is missing or cannot be solved; the presets as shipped give no error.
pub fn figures() -> Result<Vec<Figure>, FigureError> {
    Ok(vec![
        field::figure()?,
        turning::figure()?,
        clamped::figure()?,
        reflection::figure()?,
        finger::figure()?,
    ])
}

/// Points of a field in two dimensions.
const PLANE_POINTS: usize = 321;

/// |f| of the one-mode equation over x in mm.
fn one_dimension(
    plate: &Plate,
    finger: Option<&Finger>,
    frequency_hz: f64,
) -> Result<Vec<(f64, f64)>, FigureError> {
    Ok(magnitude(&respond_touched(plate, finger, frequency_hz, POINTS, Equation::Corrected)?))
}

/// |w| of the plate in two dimensions on its centre line.
fn two_dimensions(plate: &Plate, finger: Option<Finger>, frequency_hz: f64) -> Result<Response, FigureError> {
    let setup = plane::Setup { finger, ..plane::Setup::of(plate) };
    Ok(plane::respond(plate, frequency_hz, PLANE_POINTS, &setup)?)
}

fn preset(name: &'static str) -> Result<Plate, FigureError> {
    crate::definition::presets::preset(name).ok_or(FigureError::Preset(name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::figure::Stroke;

    fn curve<'a>(figure: &'a Figure, panel: usize, name: &str) -> &'a [(f64, f64)] {
        &figure.panels[panel].curve(name).unwrap_or_else(|| panic!("no curve {name}")).points
    }

    /// Largest distance of the dots or dashes `named` from the line `line`, in the unit of y, at x in `range`.
    fn apart(figure: &Figure, panel: usize, (line, named): (&str, &str), range: (f64, f64)) -> f64 {
        let line = curve(figure, panel, line);
        let at = |x: f64| {
            let right = line.partition_point(|point| point.0 < x).clamp(1, line.len() - 1);
            let (a, b) = (line[right - 1], line[right]);
            a.1 + (b.1 - a.1) * (x - a.0) / (b.0 - a.0)
        };
        let inside = curve(figure, panel, named).iter().filter(|(x, _)| (range.0..=range.1).contains(x));
        inside.map(|&(x, y)| (y - at(x)).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn the_figures_show_what_their_page_says() {
        let [field, turning, clamped, reflection, finger] =
            <[Figure; 5]>::try_from(figures().expect("the presets show them")).expect("five");
        // One and two dimensions nearly coincide.
        for panel in 0..2 {
            let off = apart(&field, panel, ("one dimension", "two dimensions"), (5.0, 320.0));
            let top = curve(&field, panel, "one dimension").iter().map(|point| point.1).fold(0.0, f64::max);
            assert!(off < 0.05 * top, "{panel}: {off} of {top}");
        }
        // The arc removes most of the error of the plain width.
        for panel in 0..2 {
            let worst =
                |name: &str| curve(&turning, panel, name).iter().map(|p| p.1.abs()).fold(0.0, f64::max);
            assert!(worst("along the arc") < worst("straight across") / 3.0, "{panel}");
        }
        assert!(apart(&clamped, 0, ("exact law", "two dimensions"), (0.0, 230.0)) < 1.0);
        assert!(apart(&clamped, 0, ("tangent at the cut-off", "two dimensions"), (0.0, 200.0)) > 40.0);
        for (panel, figure) in [(0, &reflection), (1, &reflection)] {
            for line in figure.panels[panel].series.iter().filter(|series| series.stroke == Stroke::Solid) {
                let off = apart(figure, panel, (&line.name, &format!("{}, 2-D", line.name)), (0.0, 50.0));
                assert!(off < 0.03, "{}: {off}", line.name);
            }
        }
        let peak =
            |panel: usize, name: &str| curve(&finger, panel, name).iter().map(|p| p.1).fold(0.0, f64::max);
        assert!(peak(0, "light touch") < 0.8 * peak(0, "no finger"), "the light membrane loses its peak");
        assert!(peak(1, "light touch") > 0.85 * peak(1, "no finger"), "the heavy one keeps it");
        for panel in 0..2 {
            for name in ["no finger", "light touch", "firm press"] {
                let off = apart(&finger, panel, (name, &format!("{name}, 2-D")), (5.0, 320.0));
                assert!(off < 0.06 * peak(panel, "no finger"), "{panel} {name}: {off}");
            }
        }
    }
}
