//! Twenty plates in bending: supported and clamped edges, and every kind of driven end with its near field.

use slipline_plate::{DriveEnd, EndSlope, Impedance, LeadIn, Model, Plate, PlateSpec, Source, Taper, preset};
use std::f64::consts::TAU;

/// The drive of the plate. Resistances, masses and stiffnesses are in units of the wave impedance in the middle of
/// the band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum End {
    /// A prescribed displacement with this condition on the slope.
    Moved(EndSlope),
    /// A force on an end of zero impedance.
    Force(EndSlope),
    /// A force on a damper.
    Damper(EndSlope, f64),
    /// A force on a damper, a mass and a spring.
    Coil(EndSlope),
    /// A force between the plate and a lead-in of this many half-widths, with a damper at its far end.
    LeadIn(f64, f64),
}

pub(crate) const ENDS: [End; 10] = [
    End::Moved(EndSlope::Free),
    End::Moved(EndSlope::Held),
    End::Force(EndSlope::Free),
    End::Force(EndSlope::Held),
    End::Damper(EndSlope::Free, 0.37),
    End::Damper(EndSlope::Held, 0.74),
    End::Coil(EndSlope::Free),
    End::Coil(EndSlope::Held),
    End::LeadIn(3.5, 0.37),
    End::LeadIn(5.0, 0.0),
];

impl End {
    /// Whether the end takes no power from the plate.
    pub(crate) fn is_stiff(self) -> bool {
        matches!(self, Self::Moved(_) | Self::Force(_))
    }

    fn drive(self, plate: &Plate, at_frequency_hz: f64) -> DriveEnd {
        let impedance = plate.wave_impedance_n_s_per_m(at_frequency_hz).expect("enters");
        let omega = TAU * at_frequency_hz;
        let source = |slope, ratio: f64| Source {
            impedance: Impedance::damper(ratio * impedance),
            slope: Some(slope),
            ..Source::soft(&plate.spec().model, at_frequency_hz)
        };
        match self {
            Self::Moved(slope) => DriveEnd::DisplacementAndSlope { slope },
            Self::Force(slope) => DriveEnd::Source(source(slope, 0.0)),
            Self::Damper(slope, ratio) => DriveEnd::Source(source(slope, ratio)),
            Self::Coil(slope) => DriveEnd::Source(Source {
                impedance: Impedance {
                    resistance_n_s_per_m: if slope == EndSlope::Held { 0.6 } else { 0.3 } * impedance,
                    mass_kg: 0.05 * impedance / omega,
                    stiffness_n_per_m: 0.2 * impedance * omega,
                },
                ..source(slope, 0.0)
            }),
            Self::LeadIn(half_widths, ratio) => DriveEnd::Source(Source {
                lead_in: Some(LeadIn {
                    length_m: half_widths * plate.half_width_m(0.0),
                    loss_factor: 0.2,
                    end_resistance_n_s_per_m: ratio * impedance,
                }),
                ..source(EndSlope::Free, 0.0)
            }),
        }
    }
}

pub(crate) fn is_clamped(plate: &Plate) -> bool {
    plate.spec().model.is_clamped()
}

/// Aluminium of 2 mm: each end with both kinds of edges, |W'| from 0.06 to 0.1 at the drive, loss factor 0.01.
pub(crate) fn plates() -> Vec<(End, Plate)> {
    let cases = ENDS.into_iter().flat_map(|end| [(end, false), (end, true)]);
    cases.enumerate().map(|(number, (end, clamped))| (end, plate(number, end, clamped))).collect()
}

fn plate(number: usize, end: End, clamped: bool) -> Plate {
    let half_width_m = [0.02, 0.016, 0.012][number % 3];
    let slope = [0.1, 0.08, 0.06, 0.09][number % 4];
    let rate_per_m = slope / half_width_m;
    let length_m = 1.5 / rate_per_m;
    let taper = match number % 5 {
        4 => Taper::Linear { half_width_m, end_half_width_m: half_width_m - 0.56 * slope * length_m },
        _ => Taper::Exponential { half_width_m, rate_per_m },
    };
    let spec = preset("al-bending-displacement").expect("a preset").spec().clone();
    let mut bending = spec.model.bending().expect("bending").clone();
    bending.poisson_ratio = [0.33, 0.25, 0.4][number % 3];
    let model = if clamped { Model::BendingClamped(bending) } else { Model::BendingSupported(bending) };
    let (span_start_m, span_end_m) = (0.3 * length_m, 0.8 * length_m);
    let spec = PlateSpec { taper, length_m, model, loss_factor: 0.01, span_start_m, span_end_m, ..spec };
    let bare = Plate::new(spec.clone()).expect("valid");
    let drive_end = end.drive(&bare, bare.frequency_for_boundary_hz(0.55 * length_m));
    Plate::new(PlateSpec { drive_end, ..spec }).expect("a valid end")
}
