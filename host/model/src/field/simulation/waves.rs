//! The solver of the waves: the modal line or the 2-D sheet. Both take DAC codes.

use super::{PLACES, SimulationError};
use slipline_plate::{Complex64, Finger, LINE_POINTS, Plate, Sheet, SheetGrid, TimeDomainLine};
use std::iter::repeat_n;

/// Bits of the device's DAC.
const DAC_BITS: u32 = 12;
/// Cells of a sheet on the half-width at the end of the span: the peak of the membrane preset is then within
/// 0.1 mm and 0.05 dB of the two-dimensional solver of the frequency domain. More cells bring the wide al-sh
/// no nearer to it than 0.1 to 1.1 dB along its span, because the two solve different driven ends: the
/// sheet's damper resists at every place of the driven edge, the solver's resists the first width mode alone,
/// see [`slipline_plate::plane::End::Damper`].
const CELLS: f64 = 10.0;
/// Smallest number of fields per period of the highest tone, so that a real field's mirror image at -f is far
/// from every tone.
const FIELDS_PER_PERIOD: f64 = 8.0;

/// The solver of the plate in the time domain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Solver {
    /// The first width mode along the plate.
    #[default]
    Line,
    /// The wave equation on the whole sheet, for membranes and shear waves, on 1 to 64 threads.
    Sheet {
        /// Threads; the result is the same for every number.
        threads: usize,
    },
}

/// The grid of a plate's sheet whose loss factor equals the plate's at `loss_at_hz`.
#[must_use]
pub fn sheet_grid(plate: &Plate, loss_at_hz: f64, threads: usize) -> SheetGrid {
    let cell = plate.half_width_m(plate.span_m().1) / CELLS;
    let count = |length_m: f64, low: f64, high: f64| (length_m / cell).ceil().clamp(low, high) as usize;
    let (along, across) =
        (count(plate.length_m(), 64.0, 16384.0), count(plate.half_width_m(0.0), 8.0, 4096.0));
    SheetGrid { loss_at_hz: Some(loss_at_hz), threads, ..SheetGrid::new(along, across) }
}

/// A plate in the time domain.
pub(super) struct Waves {
    medium: Medium,
    /// Samples for which a code is held: the steps of a fine sheet. Its fields are taken at every step: a
    /// held code has images of a tone at every multiple of the code rate, which at that rate would alias to
    /// the tone.
    pub(super) held: usize,
    /// Samples between two fields: whole steps.
    pub(super) stride: usize,
    /// Time after which the transient of a change has decayed to a thousandth, seconds.
    pub(super) settle_s: f64,
}

enum Medium {
    Line(Box<TimeDomainLine>),
    /// A sheet, measured on its centre line.
    Sheet {
        sheet: Box<Sheet>,
        codes: Vec<f32>,
        field_m: Vec<f32>,
    },
}

impl Waves {
    /// The plate at rest, for tones of these frequencies.
    pub(super) fn new(
        plate: &Plate,
        finger: Option<&Finger>,
        solver: Solver,
        rate_hz: f64,
        frequencies: &[f64],
    ) -> Result<Self, SimulationError> {
        let Solver::Sheet { threads } = solver else {
            let line = TimeDomainLine::touched(plate, finger, rate_hz, PLACES)?;
            let (stride, settle_s) = ((rate_hz / line.step_rate_hz()).round().max(1.0), line.settle_time_s());
            let medium = Medium::Line(Box::new(line));
            return Ok(Self { medium, held: 1, stride: stride as usize, settle_s });
        };
        let (low_hz, high_hz) =
            frequencies.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), &hz| (low.min(hz), high.max(hz)));
        let grid = sheet_grid(plate, (low_hz * high_hz).sqrt(), threads).at_tones(plate, frequencies)?;
        let held = (grid.cost(plate, rate_hz)?.step_rate_hz / rate_hz).round().max(1.0);
        let sheet = Sheet::touched(plate, finger, rate_hz * held, grid)?;
        let samples_per_step = (rate_hz * held / sheet.step_rate_hz()).round().max(1.0);
        let steps = if held > 1.0 {
            1.0
        } else {
            (rate_hz / (FIELDS_PER_PERIOD * high_hz * samples_per_step)).floor().max(1.0)
        };
        let settle_s = TimeDomainLine::new(plate, rate_hz, LINE_POINTS.0)?.settle_time_s();
        let field_m = vec![0.0; sheet.positions_m().len()];
        let (held, stride) = (held as usize, (steps * samples_per_step) as usize);
        let medium = Medium::Sheet { sheet: Box::new(sheet), codes: Vec::new(), field_m };
        Ok(Self { medium, held, stride, settle_s })
    }

    pub(super) fn positions_m(&self) -> &[f64] {
        match &self.medium {
            Medium::Line(line) => line.positions_m(),
            Medium::Sheet { sheet, .. } => sheet.positions_m(),
        }
    }

    /// Drives the plate with the codes of one block.
    pub(super) fn push(&mut self, codes: &[u16]) {
        self.push_samples(&self.samples(codes));
    }

    /// The codes, each repeated as often as it is held.
    pub(super) fn samples(&self, codes: &[u16]) -> Vec<u16> {
        codes.iter().flat_map(|&code| repeat_n(code, self.held)).collect()
    }

    pub(super) fn push_samples(&mut self, codes: &[u16]) {
        match &mut self.medium {
            Medium::Line(line) => line.push_codes(codes, DAC_BITS),
            Medium::Sheet { sheet, codes: driven, .. } => {
                let half = f32::from(1_u16 << (DAC_BITS - 1));
                driven.clear();
                driven.extend(codes.iter().map(|&code| (f32::from(code) - half) / half));
                sheet.push(driven);
            }
        }
    }

    /// Writes a field whose demodulation at a tone gives the tone's complex amplitude at each place, metres: the
    /// analytic field, or twice the real one.
    pub(super) fn field_m(&mut self, out: &mut [Complex64]) {
        match &mut self.medium {
            Medium::Line(line) => line.analytic_m(out),
            Medium::Sheet { sheet, field_m, .. } => {
                sheet.centre_line_m(field_m);
                for (out, &value) in out.iter_mut().zip(&*field_m) {
                    *out = Complex64::from(2.0 * f64::from(value));
                }
            }
        }
    }

    pub(super) fn reset_envelope(&mut self) {
        match &mut self.medium {
            Medium::Line(line) => line.reset_envelope(),
            Medium::Sheet { sheet, .. } => sheet.reset_envelope(),
        }
    }

    /// Largest and RMS displacement at each place since the reset, metres.
    pub(super) fn envelope_m(&self) -> (Vec<f32>, Vec<f32>) {
        match &self.medium {
            Medium::Line(line) => (line.envelope().maximum_m(), line.envelope().rms_m()),
            Medium::Sheet { sheet, .. } => {
                let envelope = sheet.envelope();
                (envelope.maximum_m, envelope.rms_m)
            }
        }
    }
}
