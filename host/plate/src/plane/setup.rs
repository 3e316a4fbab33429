//! Setup of the plate: its driven end, a lead-in behind it, a finger on it.

use super::error::PlaneError;
use crate::definition::drive::DriveEnd;
use crate::definition::impedance::Impedance;
use crate::definition::limits;
use crate::definition::plate::Plate;
use crate::definition::source::{EndSlope, LeadIn, Source};
use crate::frequency::Finger;
use crate::quantity::{OutOfRange, Range};

/// The force at a driven end for a unit drive; the same at every frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Force {
    /// In newtons.
    Constant(f64),
    /// A multiple of omega Z at one frequency; Z is the wave impedance at x = 0. Twice omega Z launches a wave of
    /// amplitude 1 into a matched plate at that frequency; omega Z alone does so at an end of zero impedance.
    OfWave {
        /// The multiple (1e-9 to 1e9).
        multiple: f64,
        /// The frequency, Hz (above the cut-off at x = 0).
        at_frequency_hz: f64,
    },
}

/// The driven end at x = 0. It acts on the first width mode: force and velocity are those of the deflection's
/// projection on the mode at its cut-off (half a cosine; with clamped edges the clamped beam's), 1 on the centre line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// The deflection is prescribed: the width mode, 1 on the centre line.
    Displacement(EndSlope),
    /// A force on an end with an impedance.
    Source {
        /// The impedance of the end.
        impedance: Impedance,
        /// The force.
        force: Force,
        /// Condition on the slope; not used for a membrane, whose end has no such condition.
        slope: EndSlope,
    },
    /// A damper whose other side moves with amplitude 2; the slope is free. For a membrane with `ratio` 1 the
    /// launched wave has amplitude 1.
    ///
    /// It acts on the first width mode, as every end does. The damper of a [`crate::Sheet`] acts on every point of
    /// the end. The difference is 0.01 dB on the membrane preset, and 0.31 dB on al-sh, whose edges meet the end at
    /// 43 degrees and whose third width mode propagates there.
    Damper {
        /// R over the wave impedance Z at `at_frequency_hz` (0.01 to 100).
        ratio: f64,
        /// Frequency at which the ratio holds, Hz (above the cut-off at x = 0).
        at_frequency_hz: f64,
    },
}

/// Inputs of the two-dimensional solver, besides the plate.
///
/// ```
/// use slipline_plate::{LeadIn, plane, preset};
///
/// let plate = preset("al-bending").unwrap();
/// let end = plane::End::Damper { ratio: 1.0, at_frequency_hz: 28e3 };
/// let damper = plane::Setup { end, lead_in: None, ..plane::Setup::of(&plate) };
/// let lead_in = LeadIn { length_m: 0.06, loss_factor: 0.2, end_resistance_n_s_per_m: 0.0 };
/// let soft = plane::End::Source {
///     impedance: slipline_plate::Impedance::default(),
///     force: plane::Force::OfWave { multiple: 2.0, at_frequency_hz: 28e3 },
///     slope: slipline_plate::EndSlope::Free,
/// };
/// let setup = plane::Setup { end: soft, lead_in: Some(lead_in), ..damper };
/// let reflected = |setup| plane::reflection(&plate, 28e3, setup).unwrap().norm();
/// assert!(reflected(&setup) < 0.3 && reflected(&damper) > 0.5);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setup {
    /// The driven end.
    pub end: End,
    /// The strip behind it, for bending only. Its loss law is E (1 - j eta), and its damper acts on the width mode.
    pub lead_in: Option<LeadIn>,
    /// A finger on the centre line, with the same impedance per area everywhere in its contact.
    pub finger: Option<Finger>,
    /// Compliance c of clamped edges, metres (0 to 0.1): they turn against a rotational stiffness of D/c per length. 0 for edges
    /// that do not turn, and on plates without clamped edges in bending.
    pub edge_compliance_m: f64,
}

impl Setup {
    /// The drive end of the plate's specification, without a finger.
    ///
    /// `Displacement` leaves the slope free, and `Force` and `Resistance` become a free end with a force or a damper:
    /// on a plate in bending their near field makes them differ from the one-mode equation, which has no near field.
    #[must_use]
    pub fn of(plate: &Plate) -> Self {
        let mut lead_in = None;
        let end = match plate.spec().drive_end {
            DriveEnd::Displacement => End::Displacement(EndSlope::Free),
            DriveEnd::DisplacementAndSlope { slope } => End::Displacement(slope),
            DriveEnd::Force { at_frequency_hz } => End::Source {
                impedance: Impedance::default(),
                force: Force::OfWave { multiple: 1.0, at_frequency_hz },
                slope: EndSlope::Free,
            },
            DriveEnd::Resistance { ratio, at_frequency_hz } => End::Damper { ratio, at_frequency_hz },
            DriveEnd::Source(source) => {
                lead_in = source.lead_in;
                let Source { impedance, at_frequency_hz, .. } = source;
                End::Source {
                    impedance,
                    force: Force::OfWave { multiple: 2.0, at_frequency_hz },
                    slope: source.slope.unwrap_or(EndSlope::Free),
                }
            }
        };
        Self { end, lead_in, finger: None, edge_compliance_m: 0.0 }
    }

    /// Length of the lead-in, metres; 0 without one.
    pub(super) fn lead_in_m(&self) -> f64 {
        self.lead_in.map_or(0.0, |lead_in| lead_in.length_m)
    }

    pub(super) fn validate(&self, plate: &Plate) -> Result<(), PlaneError> {
        let entering = Range::new(plate.cut_off_hz() * 1.0001, limits::FREQUENCY.high, "Hz");
        // The name of the input in newtons, if there is one.
        let mut absolute = None;
        match self.end {
            End::Displacement(_) => {}
            End::Source { impedance, force, .. } => {
                for (field, value, range) in impedance.fields() {
                    OutOfRange::check(field, value, range)?;
                }
                if !impedance.is_nothing() {
                    absolute = Some("a source");
                }
                match force {
                    Force::Constant(force) => {
                        OutOfRange::check("force", force, Range::new(-1e12, 1e12, "N"))?;
                        absolute = Some("a source");
                    }
                    Force::OfWave { multiple, at_frequency_hz } => {
                        OutOfRange::check("multiple", multiple, Range::new(1e-9, 1e9, ""))?;
                        OutOfRange::check("at_frequency_hz", at_frequency_hz, entering)?;
                    }
                }
            }
            End::Damper { ratio, at_frequency_hz } => {
                OutOfRange::check("ratio", ratio, limits::DRIVE_RATIO)?;
                OutOfRange::check("at_frequency_hz", at_frequency_hz, entering)?;
            }
        }
        if let Some(lead_in) = self.lead_in {
            if plate.spec().model.bending().is_none() {
                return Err(PlaneError::LeadInWithoutBending);
            }
            lead_in.validate()?;
        }
        let is_clamped = plate.spec().model.is_clamped();
        let turning = Range::new(0.0, if is_clamped { 0.1 } else { 0.0 }, "m");
        OutOfRange::check("edge_compliance_m", self.edge_compliance_m, turning)?;
        if let Some(finger) = self.finger {
            finger.check(plate)?;
        }
        // A force in newtons needs a sheet of known mass per area.
        absolute.map_or(Ok(()), |needed_by| plate.spec().model.surface_density(needed_by).map(drop))?;
        Ok(())
    }
}
