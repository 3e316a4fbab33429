//! A plate driven through the whole signal chain, measured and compared with the prediction of the frequency
//! domain.
//!
//! ```text
//! boundary -> table of the table's plate -> Loopback -> DAC codes -> line or sheet of the actual plate -> demodulation
//!                                                        |                                          |
//!                                       frequency played +--> respond(actual plate) --- compared ---+
//! ```
//! After the plate has settled, the field at each place is multiplied by the phasor of each tone and averaged
//! under a Hann window. The result is the complex amplitude of that tone, even if other tones sound.

mod beat;
mod demodulator;
mod feeling;
mod waves;

pub use beat::SlowBeat;
pub use waves::{Solver, sheet_grid};

use beat::{MAX_WINDOW_S, is_blurred, slow_beat, window_s};
use demodulator::Demodulator;
use slipline_link::protocol::refusal::Refusal;
use slipline_link::simulator::loopback::{Loopback, LoopbackError};
use slipline_link::{BLOCK, Change, DriveError, DriveRequest, OutOfRange, Played, Request, Sounding};
use slipline_link::{DeviceTable, DeviceTableError, span_m};
use slipline_plate::{
    Complex64, DriveTable, Equation, Finger, LineError, Peak, Plate, Progress, RespondError, Response,
    SheetError, Stopped, TableError, TableTravel, ToneDrive, plane, predict_envelope, respond_touched,
};
use std::sync::Arc;
use waves::Waves;

/// Samples per second of the simulated device, in Hz.
pub const SAMPLE_RATE_HZ: u32 = 400_000;
/// Number of knots of a table: the largest that a device accepts.
pub const KNOTS: usize = slipline_link::protocol::limits::MAX_KNOTS;
/// Number of places along the plate at which the field of a line is measured; a sheet is measured at its stations.
pub const PLACES: usize = 513;
/// The longest simulation, in seconds.
pub const MAX_SECONDS: f64 = 600.0;
/// Number of progress reports in a run.
const PARTS: u64 = 200;

/// A simulation to run.
#[derive(Clone, Debug)]
pub struct Simulation<'a> {
    /// The plate for which the table is made.
    pub plate: &'a Plate,
    /// The plate on which the waves run.
    pub actual: &'a Plate,
    /// (boundary in metres from the driven end, level 0..=1) of each tone, 1 to 16.
    pub tones: &'a [(f64, f64)],
    /// What plays these tones; `None` for a drive of them at phase 0 and full master level.
    pub sounding: Option<Sounding>,
    /// Whether the table's gains are used; without them every tone is driven at the same DAC amplitude.
    pub has_gains: bool,
    /// Duration of the drive, in seconds; `None` means until the plate has settled and the window is full.
    pub seconds: Option<f64>,
    /// The solver of the actual plate in the time domain.
    pub solver: Solver,
    /// A finger that rests on the actual plate.
    pub finger: Option<Finger>,
}

/// Why a simulation cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum SimulationError {
    /// No table can be made for the plate.
    #[error("no table can be made for this plate: {0}")]
    Table(#[from] TableError),
    /// The table cannot be converted to the device's units.
    #[error("{0}")]
    DeviceTable(#[from] DeviceTableError),
    /// The played frequency does not fit the plate.
    #[error("{0}")]
    Respond(#[from] RespondError),
    /// The plate cannot be simulated in the time domain.
    #[error("{0}")]
    Line(#[from] LineError),
    /// The plate has no sheet.
    #[error("{0}")]
    Sheet(#[from] SheetError),
    /// The simulation was cancelled.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// The sum of the tones exceeds the DAC's range.
    #[error("{0}")]
    Sum(Refusal),
    /// The link or the device refused.
    #[error("{0}")]
    Loopback(#[from] LoopbackError),
}

/// One tone: requested, predicted and measured.
#[derive(Clone, Debug)]
pub struct ToneResult {
    /// The requested boundary, in metres.
    pub boundary_m: f64,
    /// Its level.
    pub level: f64,
    /// The frequency that the device plays, in Hz.
    pub frequency_hz: f64,
    /// The prediction of the frequency domain for the actual plate at that frequency, at the same places.
    pub predicted: Response,
    /// The predicted peak displacement, in metres.
    pub predicted_peak_m: Option<f64>,
    /// Whether another tone is so near that the measured time does not resolve the two. Then no measured
    /// results are given for this tone alone.
    pub is_blurred: bool,
    /// The tone's measured complex amplitude at each place, in metres.
    pub field_m: Vec<Complex64>,
    /// The measured peak; its amplitude is in metres.
    pub measured: Option<Peak>,
    /// The place where the measured amplitude has fallen to the predicted ratio of turning point to peak,
    /// in metres.
    pub measured_turning_point_m: Option<f64>,
    /// Differences between the measured field and the predicted one.
    pub differs: plane::Comparison,
}

/// The result of a simulation.
#[derive(Clone, Debug)]
pub struct Simulated {
    /// The tones, in the requested order.
    pub tones: Vec<ToneResult>,
    /// Places along the plate, in metres.
    pub position_m: Vec<f64>,
    /// Largest displacement at each place while measured, in metres.
    pub maximum_m: Vec<f32>,
    /// The two tones with the slowest beat, if the measured time is too short for it. Then the RMS
    /// displacement is that of the measured part of the beat, not of a whole one.
    pub slow_beat: Option<SlowBeat>,
    /// RMS displacement at each place while measured, in metres.
    pub rms_m: Vec<f32>,
    /// RMS displacement predicted by the frequency domain, in metres.
    pub predicted_rms_m: Vec<f64>,
    /// Codes that had to be clamped to the DAC's range.
    pub clipped_samples: u32,
    /// The duration of the drive, in seconds.
    pub seconds: f64,
    /// The measured part of it, in seconds.
    pub window_s: f64,
    /// The table's peak displacement at level 1, in metres.
    pub peak_at_full_scale_m: f64,
}

/// The table for a plate, in physical and in device units.
///
/// # Errors
/// [`SimulationError`] if no table is possible for the plate or the rate.
pub fn table_for(
    plate: &Plate,
    sample_rate_hz: u32,
) -> Result<(DriveTable, Arc<DeviceTable>), SimulationError> {
    table_for_watched(plate, sample_rate_hz, &mut Progress::unwatched())
}

/// [`table_for`] with progress reports and cancellation.
///
/// # Errors
/// As [`table_for`], and if it was cancelled.
pub fn table_for_watched(
    plate: &Plate,
    sample_rate_hz: u32,
    progress: &mut Progress<'_>,
) -> Result<(DriveTable, Arc<DeviceTable>), SimulationError> {
    let table = DriveTable::build_watched(plate, f64::from(sample_rate_hz), KNOTS, progress)?;
    let device_table = Arc::new(device_table(&table)?);
    Ok((table, device_table))
}

/// Converts a plate's table to the device's units.
///
/// # Errors
/// [`DeviceTableError`]: the value that does not fit the device's units.
pub fn device_table(table: &DriveTable) -> Result<DeviceTable, DeviceTableError> {
    let span_m = table.span_m();
    let knots = table.knots().iter().map(|knot| (knot.frequency_hz, knot.gain));
    let device_table =
        DeviceTable::from_knots(span_m, table.sample_rate_hz(), knots, table.peak_at_full_scale_m())?
            .with_heights(table.nominal_heights().to_vec())?;
    match table.travel() {
        None => Ok(device_table),
        Some(TableTravel { resonance_hz, quality, static_share, .. }) => {
            device_table.with_travel_limit(resonance_hz, quality, static_share)
        }
    }
}

/// The same table with every gain at full scale.
fn without_gains(table: &DriveTable) -> Result<DeviceTable, DeviceTableError> {
    let span_m = table.span_m();
    let knots = table.knots().iter().map(|knot| (knot.frequency_hz, 1.0));
    DeviceTable::from_knots(span_m, table.sample_rate_hz(), knots, table.peak_at_full_scale_m())
}

impl Simulation<'_> {
    /// Runs with a finished table. Progress is reported, and the caller can stop it.
    ///
    /// # Errors
    /// [`SimulationError`]: the unsuitable value and the reason; [`SimulationError::Stopped`].
    pub fn run(&self, table: &DriveTable, progress: &mut Progress<'_>) -> Result<Simulated, SimulationError> {
        let device_table =
            Arc::new(if self.has_gains { self::device_table(table)? } else { without_gains(table)? });
        if !matches!(self.sounding, Some(Sounding::Chord(_))) {
            device_table.check_sum(self.tones).map_err(SimulationError::Sum)?;
        }
        let mut chain = Loopback::connect(SAMPLE_RATE_HZ)?;
        chain.perform(Request::Upload(device_table.clone()), |_| ())?;

        let rate_hz = f64::from(SAMPLE_RATE_HZ);
        let asked = self.asked(&device_table)?;
        let played = self.sounding.clone();
        let played = played.unwrap_or_else(|| Sounding::Drive(DriveRequest::at(self.tones)));
        // With a travel limit the link extends the glide.
        let glide_s = table.travel().map_or(0.0, |travel| 2.0 / travel.resonance_hz).max(glide_s(&played));
        let mut begun = Vec::new();
        chain.perform(Request::Play(played), |codes| begun.extend_from_slice(codes))?;
        let sounding = if self.sounding.is_some() { sounding(&asked, &chain, &device_table) } else { asked };
        let frequencies: Vec<f64> = sounding.iter().map(|tone| tone.frequency_hz).collect();
        let mut waves = Waves::new(self.actual, self.finger.as_ref(), self.solver, rate_hz, &frequencies)?;
        begun.chunks(BLOCK).for_each(|codes| waves.push(codes));

        let settle_s = glide_s + waves.settle_s;
        let (settle_s, window_s) = match self.seconds {
            None => (settle_s, window_s(&frequencies)),
            Some(seconds) => {
                let settle_s = settle_s.min(0.6 * seconds);
                (settle_s, (seconds - settle_s).min(MAX_WINDOW_S))
            }
        };
        let settled = settle_s / (settle_s + window_s);
        let settling = &mut progress.part(0.0, settled);
        pass(&mut chain, in_samples(settle_s), settling, |codes| waves.push(codes))?;
        waves.reset_envelope();
        let mut demodulator = Demodulator::new(&waves, rate_hz, &frequencies, window_s);
        let measuring = &mut progress.part(settled, 1.0);
        pass(&mut chain, in_samples(window_s), measuring, |codes| demodulator.push(&mut waves, codes))?;

        // The status contains the counter and is read again after a request.
        chain.perform(Request::Refresh, |_| ())?;
        let clipped_samples = chain.view().drive.status.map_or(0, |status| status.counters.clips);
        let position_m = waves.positions_m().to_vec();
        let predicted =
            predict_envelope(self.actual, self.finger.as_ref(), &sounding, rate_hz, position_m.len())?;
        let fields = demodulator.fields();
        let blurred =
            |hz: f64| frequencies.iter().filter(|&&other| is_blurred(hz, other, window_s)).count() > 1;
        let tones = self
            .tones
            .iter()
            .zip(&sounding)
            .zip(fields)
            .zip(&predicted.tones)
            .map(|(((&(boundary_m, level), tone), field_m), predicted_field)| {
                let is_blurred = blurred(tone.frequency_hz);
                self.tone_result((boundary_m, level), tone.frequency_hz, is_blurred, field_m, predicted_field)
            })
            .collect::<Result<_, _>>()?;
        let (maximum_m, rms_m) = waves.envelope_m();
        Ok(Simulated {
            tones,
            position_m,
            slow_beat: slow_beat(&frequencies, window_s),
            maximum_m,
            rms_m,
            predicted_rms_m: predicted.rms_m,
            clipped_samples,
            seconds: settle_s + window_s,
            window_s,
            peak_at_full_scale_m: device_table.peak_at_full_scale_m(),
        })
    }

    /// The frequency and level that the device plays for each tone in a drive of them.
    fn asked(&self, table: &DeviceTable) -> Result<Vec<ToneDrive>, LoopbackError> {
        let (start_m, end_m) = span_m(&table.header());
        (0..)
            .zip(self.tones)
            .map(|(slot, &(boundary_m, level))| {
                let (got, min, max) = (boundary_m * 1e3, start_m * 1e3, end_m * 1e3);
                let value = OutOfRange { field: "boundary (mm)".into(), got, min, max };
                let outside = DriveError::Tone { slot, value };
                let position = table.position(boundary_m).ok_or(LoopbackError::Refused(outside.into()))?;
                let gain = f64::from(table.setting(position.fine()).gain.0) / f64::from(1u32 << 31);
                Ok(ToneDrive {
                    frequency_hz: table.frequency_hz(position),
                    amplitude: gain * level,
                    phase_rad: 0.0,
                })
            })
            .collect()
    }

    fn tone_result(
        &self,
        (boundary_m, level): (f64, f64),
        frequency_hz: f64,
        is_blurred: bool,
        field_m: Vec<Complex64>,
        predicted_field: &[Complex64],
    ) -> Result<ToneResult, RespondError> {
        let predicted = respond_touched(
            self.actual,
            self.finger.as_ref(),
            frequency_hz,
            field_m.len(),
            Equation::Corrected,
        )?;
        let measured = Peak::of(&field_m, self.actual, frequency_hz).filter(|_| !is_blurred);
        let predicted_peak = Peak::of(predicted_field, self.actual, frequency_hz);
        let in_metres = |amplitude: &[Complex64], peak: Option<Peak>| Response {
            amplitude: amplitude.to_vec(),
            peak,
            ..predicted.clone()
        };
        let differs = plane::Comparison::of(
            &in_metres(predicted_field, predicted_peak),
            &in_metres(&field_m, measured),
        );
        let measured_turning_point_m = measured.zip(predicted.peak).and_then(|(measured, peak)| {
            let share = predicted.amplitude_at_turning_point / peak.amplitude;
            let step_m = self.actual.length_m() / (field_m.len() - 1) as f64;
            falls_to(&field_m, step_m, measured.position_m, share * measured.amplitude)
        });
        Ok(ToneResult {
            boundary_m,
            level,
            frequency_hz,
            predicted,
            predicted_peak_m: predicted_peak.map(|peak| peak.amplitude),
            is_blurred,
            field_m,
            measured,
            measured_turning_point_m,
            differs,
        })
    }
}

fn glide_s(sounding: &Sounding) -> f64 {
    match sounding {
        Sounding::Drive(drive) => drive.glide_s,
        Sounding::Chord(chord) => chord.glide_s,
        Sounding::Comb(comb) => comb.glide_s,
    }
}

/// The frequency and level of each tone as the device has accepted it. The tones of a chord are in the order of their
/// frequencies: each is the one whose frequency is nearest.
fn sounding(asked: &[ToneDrive], chain: &Loopback, table: &DeviceTable) -> Vec<ToneDrive> {
    let played =
        chain.view().record.journal.iter().rev().find_map(|entry| {
            if let Change::Play(played) = &entry.change { Some(played.clone()) } else { None }
        });
    let tones = played.as_ref().map_or_else(Vec::new, |played| played.tones(table));
    let is_drive = matches!(played, Some(Played::Drive(_)));
    let of_tone = |(number, tone): (usize, &ToneDrive)| {
        let off_hz = |hz: f64| (hz - tone.frequency_hz).abs();
        let nearest =
            || tones.iter().min_by(|a, b| off_hz(a.frequency_hz).total_cmp(&off_hz(b.frequency_hz)));
        let found = if is_drive { tones.get(number) } else { nearest() };
        found.map_or(*tone, |found| ToneDrive {
            frequency_hz: found.frequency_hz,
            amplitude: found.amplitude,
            phase_rad: 0.0,
        })
    };
    asked.iter().enumerate().map(of_tone).collect()
}

/// Advances by a number of samples, rounded up to blocks, and reports the progress.
fn pass(
    chain: &mut Loopback,
    samples: u64,
    progress: &mut Progress<'_>,
    mut sink: impl FnMut(&[u16]),
) -> Result<(), Stopped> {
    let blocks = samples.div_ceil(BLOCK as u64);
    let at_once = blocks.div_ceil(PARTS).max(1);
    let mut passed = 0;
    while passed < blocks {
        let count = at_once.min(blocks - passed);
        chain.pass(count * BLOCK as u64, &mut sink);
        passed += count;
        progress.at(passed as f64 / blocks as f64)?;
    }
    Ok(())
}

fn in_samples(seconds: f64) -> u64 {
    (seconds * f64::from(SAMPLE_RATE_HZ)).ceil() as u64
}

/// The first place after `from_m` where |field| has fallen to `to`.
fn falls_to(field: &[Complex64], step_m: f64, from_m: f64, to: f64) -> Option<f64> {
    let first = (from_m / step_m).ceil() as usize;
    let magnitude = |i: usize| field.get(i).map(|value| value.norm());
    let at = (first + 1..field.len()).find(|&i| magnitude(i).is_some_and(|value| value <= to))?;
    let (before, after) = (magnitude(at - 1)?, magnitude(at)?);
    let share = if before > after { ((before - to) / (before - after)).clamp(0.0, 1.0) } else { 1.0 };
    Some(((at - 1) as f64 + share) * step_m)
}

#[cfg(test)]
mod tests;
