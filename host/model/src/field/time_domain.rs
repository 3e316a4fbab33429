//! The simulated plate under the device's codes: its response to the acknowledged drive, in the time domain.
//!
//! ```text
//! acknowledged drive + table --> mirror --> DAC codes --> slipline_plate::TimeDomainLine --> settle --> envelope
//! ```
//! It shares only the plate with the solver that predicts the envelope, so the agreement of the two checks both.

use crate::field::line_at_rest::line_at_rest;
use crate::jobs::Task;
use slipline_link::BLOCK;
use slipline_link::DeviceTable;
use slipline_link::Played;
use slipline_link::mirror::Mirror;
use slipline_plate::Plate;
use std::sync::Arc;

/// Places along the plate.
const POINTS: usize = 128;
/// Recorded periods of the slowest tone, after the plate has settled.
const TURNS: f64 = 6.0;
/// The longest recording, in seconds: the maximum of a slower beat may be missed.
const WATCH_MAX_S: f64 = 0.25;
/// The longest recording of several tones, in seconds: the mean of a slower beat is that of a part of it.
const MEAN_MAX_S: f64 = 1.0;
/// The longest run, in seconds of the device's time.
pub(crate) const RUN_MAX_S: f64 = 12.0;
/// Codes between table and drive, so that the table is active before the drive begins.
const AHEAD: u64 = 8 * BLOCK as u64;
/// Blocks between two checks whether the result is still wanted.
const BLOCKS_AT_ONCE: u64 = 64;

/// Largest displacement at places along the simulated plate.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct SimulatedField {
    /// Journal number of the drive.
    pub number: u64,
    /// Places in metres.
    pub position_m: Vec<f64>,
    /// Largest displacement seen at each place, in metres.
    pub maximum_m: Vec<f64>,
    /// Root mean square of the displacement at each place, in metres.
    pub rms_m: Vec<f64>,
    /// Number of tones.
    pub tones: usize,
}

impl SimulatedField {
    /// Place and displacement of each point, in metres, with the definition of the predicted envelope: for
    /// one tone the largest displacement, for several the mean, which is sqrt 2 times the root mean square.
    /// During the recording several tones do not reach their largest possible sum.
    pub fn points(&self) -> impl Iterator<Item = (f64, f64)> {
        let value = |i: usize| match self.tones {
            0 | 1 => self.maximum_m[i],
            _ => self.rms_m[i] * std::f64::consts::SQRT_2,
        };
        self.position_m.iter().copied().enumerate().map(move |(i, x_m)| (x_m, value(i)))
    }
}

/// A drive to simulate on a plate.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct TimeDomainJob {
    /// Journal number of the drive.
    pub number: u64,
    /// The plate.
    #[serde(with = "slipline_plate::exchange::by_number")]
    pub plate: Arc<Plate>,
    /// The device's table.
    pub table: Arc<DeviceTable>,
    /// The drive, chord or comb that the device has accepted.
    pub played: Played,
    /// The device's bits per code.
    pub dac_bits: u8,
}

/// Duration of the recording of the largest displacement, in seconds.
pub(crate) fn watch_s(job: &TimeDomainJob) -> f64 {
    let tones = job.played.tones(&job.table);
    let slowest_hz = tones.iter().map(|tone| tone.frequency_hz).fold(f64::INFINITY, f64::min);
    if tones.len() > 1 { WATCH_MAX_S } else { (TURNS / slowest_hz).min(WATCH_MAX_S) }
}

/// Duration of the recording of the mean of several tones, in seconds: a number of periods of the slowest
/// beat, within limits.
fn mean_s(job: &TimeDomainJob) -> f64 {
    let mut hertz: Vec<f64> =
        job.played.tones(&job.table).into_iter().map(|tone| tone.frequency_hz).collect();
    hertz.sort_by(f64::total_cmp);
    let beat_hz =
        hertz.windows(2).map(|pair| pair[1] - pair[0]).filter(|hz| *hz > 0.0).fold(f64::INFINITY, f64::min);
    (TURNS / beat_hz).clamp(watch_s(job), MEAN_MAX_S)
}

/// Runs the drive on the plate until it has settled, then records the envelope. `None` if the plate cannot be
/// simulated at the device's rate, the drive could not be replayed, or the task was cancelled.
#[must_use]
pub fn run(job: &TimeDomainJob, task: &Task) -> Option<SimulatedField> {
    let rate = job.table.header().sample_rate_hz;
    let mut line = line_at_rest(&job.plate, f64::from(rate), POINTS)?;
    let mut mirror = Mirror::new(rate, 0);
    mirror.acknowledge_table(job.table.knots().into(), 0).ok()?;
    mirror.acknowledge_play(job.played.clone(), AHEAD).ok()?;
    let samples = |seconds: f64| (seconds * f64::from(rate)) as u64;
    let glide_s = f64::from(job.played.glide()) / f64::from(rate);
    let settled = AHEAD + samples((glide_s + line.settle_time_s()).min(RUN_MAX_S));
    let bits = u32::from(job.dac_bits);
    let end = settled + samples(mean_s(job)).max(2 * BLOCK as u64);
    for (until, is_watch) in [(settled, false), (end, true)] {
        if is_watch {
            line.reset_envelope();
        }
        while mirror.now() + (BLOCK as u64) <= until {
            let part = (mirror.now() + BLOCKS_AT_ONCE * BLOCK as u64).min(until);
            mirror.render(part, |_, codes| line.push_codes(codes, bits));
            if !task.report(mirror.now() as f64 / end as f64) {
                return None;
            }
        }
    }
    let in_metres = |values: Vec<f32>| values.into_iter().map(f64::from).collect();
    let envelope = line.envelope();
    let (maximum_m, rms_m) = (in_metres(envelope.maximum_m()), in_metres(envelope.rms_m()));
    mirror.is_true().then(|| SimulatedField {
        number: job.number,
        position_m: line.positions_m().to_vec(),
        maximum_m,
        rms_m,
        tones: job.played.count(),
    })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::field::simulation::device_table;
    use crate::field::steady_field::{SteadyField, SteadyTone, interpolate};
    use slipline_link::protocol::command::{Apply, Drive, Tone};
    use slipline_link::protocol::units::{CentiDecibel, Level, Phase, Position};
    use slipline_plate::DriveTable;

    /// One tone at full level.
    pub(crate) fn one_tone(slot: u8, position: Position, glide: u32) -> Drive {
        let tone = Tone { slot, position, level: Level::FULL, phase: Phase(0) };
        Drive { tones: [tone].into_iter().collect(), master: CentiDecibel(0), glide, apply: Apply::Next }
    }

    #[test]
    fn sixteen_tones_are_measured_where_their_mean_is_predicted() {
        let plate = Arc::new(slipline_plate::preset("membrane").unwrap());
        let (start, end) = plate.span_m();
        let table = DriveTable::build(&plate, 400_000.0, 257).unwrap();
        let table = Arc::new(device_table(&table).unwrap());
        let level = Level(Level::FULL.0 / 16);
        let peak_m = table.peak_at_full_scale_m() * f64::from(level.0) / f64::from(Level::FULL.0);
        let positions = (0..16).map(|i| table.position(start + (end - start) * f64::from(i) / 15.0).unwrap());
        let tones =
            (0..).zip(positions).map(|(slot, position)| Tone { slot, position, level, phase: Phase(0) });
        let tones: Vec<Tone> = tones.collect();
        let steady: Vec<SteadyTone> = tones
            .iter()
            .map(|tone| SteadyTone {
                slot: tone.slot,
                frequency_hz: table.frequency_hz(tone.position),
                peak_m,
            })
            .collect();
        let steady = SteadyField::solve(&plate, &steady);
        let drive = Drive {
            tones: tones.into_iter().collect(),
            master: CentiDecibel(0),
            glide: 8000,
            apply: Apply::Next,
        };
        let job =
            TimeDomainJob { number: 1, plate: Arc::clone(&plate), table, played: drive.into(), dac_bits: 12 };
        let measured = run(&job, &Task::default()).unwrap();
        let predicted = |x_m: f64| interpolate(&steady.rms_m, x_m / plate.length_m()) * 2.0_f64.sqrt();
        let highest_m = measured.points().map(|(_, metres)| metres).fold(0.0, f64::max);
        let worst =
            measured.points().map(|(x_m, metres)| (metres - predicted(x_m)).abs()).fold(0.0, f64::max);
        assert!(worst < 0.03 * highest_m, "{}", worst / highest_m);
    }

    #[test]
    fn the_simulated_plate_stands_where_the_solver_predicts_it() {
        // The last is near 40 kHz, where the plate's own peak differs most from the table's.
        for (name, share) in [("membrane", 0.7), ("al-bending", 0.7), ("al-bending", 0.98)] {
            let plate = Arc::new(slipline_plate::preset(name).unwrap());
            let (start, end) = plate.span_m();
            let table = DriveTable::build(&plate, 400_000.0, 257).unwrap();
            let table = Arc::new(device_table(&table).unwrap());
            let x0 = start + share * (end - start);
            let position = table.position(x0).unwrap();
            let drive = one_tone(0, position, 8000);
            let job = TimeDomainJob {
                number: 1,
                plate: Arc::clone(&plate),
                table: Arc::clone(&table),
                played: drive.into(),
                dac_bits: 12,
            };
            let measured = run(&job, &Task::default()).unwrap();
            let frequency_hz = table.frequency_hz(position);
            let peak_m = table.peak_m(position.fine());
            let steady = SteadyField::solve(&plate, &[SteadyTone { slot: 0, frequency_hz, peak_m }]);
            let worst = measured
                .points()
                .map(|(x, metres)| (metres - steady.bound_at(x)).abs() / peak_m)
                .fold(0.0, f64::max);
            assert!(worst < 0.01, "{name}: {worst}");
        }
    }
}
