//! The plate in two dimensions: as it is, with another wave speed or loss, under a finger, and as a thick plate.

use slipline_plate::{DriveEnd, Equation, Finger, Model, Plate, PlateSpec, Response, plane, respond};

/// Points of a field along the centre line.
const POINTS: usize = 257;
/// Boundaries over the span for the mean factor between an end with a near field and one without.
const PLACES: usize = 9;

/// The field in two dimensions.
pub(crate) fn field(plate: &Plate, frequency_hz: f64, finger: Option<Finger>) -> Response {
    let setup = plane::Setup { finger, ..plane::Setup::of(plate) };
    plane::respond(plate, frequency_hz, POINTS, &setup).expect("solves")
}

/// The field that the lights assume.
pub(crate) fn stated(plate: &Plate, frequency_hz: f64) -> Response {
    respond(plate, frequency_hz, POINTS, Equation::Corrected).expect("responds")
}

/// Height of the peak, dB; without a peak, that of the Airy function with the amplitude at the turning point, as in a
/// table.
pub(crate) fn level_db(response: &Response) -> f64 {
    let height = response.peak.map_or(response.amplitude_at_turning_point / 0.6628, |peak| peak.amplitude);
    20.0 * height.log10()
}

/// Place beyond the peak where the amplitude has fallen to a tenth of it, metres.
pub(crate) fn edge_m(response: &Response) -> Option<f64> {
    let peak = response.peak?;
    let tenth = 0.1 * peak.amplitude;
    let mut before = (peak.position_m, peak.amplitude);
    for (&x, f) in response.position_m.iter().zip(&response.amplitude) {
        let here = (x, f.norm());
        if x > peak.position_m && here.1 < tenth {
            return Some(before.0 + (here.0 - before.0) * (before.1 - tenth) / (before.1 - here.1));
        }
        if x > peak.position_m {
            before = here;
        }
    }
    None
}

/// |w| on the centre line at `x`, metres.
pub(crate) fn amplitude_at(response: &Response, x: f64) -> f64 {
    let step_m = response.position_m[1];
    response.amplitude[(x / step_m).round() as usize].norm()
}

/// The largest amplitude over the peak's, dB.
pub(crate) fn largest_over_peak_db(response: &Response) -> Option<f64> {
    let largest = response.amplitude.iter().map(|f| f.norm()).fold(0.0, f64::max);
    response.peak.map(|peak| 20.0 * (largest / peak.amplitude).log10())
}

/// Level of the plate over that of an end in bending without its near field, dB, mean over the span: one measurement
/// of the level determines it. 0 for every other end.
pub(crate) fn factor_db(plate: &Plate) -> f64 {
    let one_mode = match plate.spec().drive_end {
        DriveEnd::Displacement | DriveEnd::Force { .. } | DriveEnd::Resistance { .. } => {
            plate.spec().model.bending().is_some()
        }
        DriveEnd::DisplacementAndSlope { .. } | DriveEnd::Source(_) => false,
    };
    if !one_mode {
        return 0.0;
    }
    let (start, end) = plate.span_m();
    let above_db = (0..PLACES).map(|i| {
        let hz = plate.frequency_for_boundary_hz(start + (end - start) * i as f64 / (PLACES - 1) as f64);
        level_db(&field(plate, hz, None)) - level_db(&stated(plate, hz))
    });
    above_db.sum::<f64>() / PLACES as f64
}

/// The plate with its loss times `factor`.
pub(crate) fn with_loss(plate: &Plate, factor: f64) -> Plate {
    let loss_factor = (factor * plate.spec().loss_factor).min(0.5);
    Plate::new(PlateSpec { loss_factor, ..plate.spec().clone() }).expect("valid")
}

/// The plate with shear and rotary inertia; `None` if it has them already or is not in bending.
pub(crate) fn thick(plate: &Plate) -> Option<Plate> {
    let mut spec = plate.spec().clone();
    match &mut spec.model {
        Model::BendingSupported(bending) | Model::BendingClamped(bending) if !bending.thick_plate => {
            bending.thick_plate = true;
        }
        _ => return None,
    }
    Plate::new(spec).ok()
}
