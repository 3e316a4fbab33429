//! The 2-D sheet in the app: the choice between sheet and modal lines, and the sheet's state in slow motion.
//!
//! ```text
//! plate --cost against BUDGET--> sheet or modal lines
//! acknowledged drive + table --> mirror --> DAC codes --> slipline_plate::Sheet --> settle, slow motion --> Frame
//! ```
//! The codes are the same as for the modal line of [`time_domain`]. After a change the sheet runs as fast as it
//! can until it has settled; then it runs in slow motion, so that the eye can follow one wave.

mod source;

pub use source::{FieldSource, SourceChoice, source};

use crate::field::line_at_rest::line_at_rest;
use crate::field::time_domain::{self, TimeDomainJob};
use crate::jobs::Task;
use slipline_link::BLOCK;
use slipline_link::DeviceTable;
use slipline_link::Played;
use slipline_link::mirror::Mirror;
use slipline_plate::EnvelopeScope;
use slipline_plate::{LINE_POINTS, Plate, Sheet, SheetGrid};
use std::collections::VecDeque;
use std::sync::Arc;

/// Codes between table and drive, so that the table is active before the drive begins.
const AHEAD: u64 = 8 * BLOCK as u64;
/// The longest plate time between two frames, in seconds; the rest of a longer pause is skipped.
const STRIDE_MAX_S: f64 = 0.05;

/// The cells of the app's sheet: coarse, and with the largest displacement everywhere.
fn grid(plate: &Plate) -> SheetGrid {
    SheetGrid { envelope: EnvelopeScope::Everywhere, ..SheetGrid::coarse(plate) }
}

/// The sheet at one moment. The default has no plate and is 0 everywhere.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Frame {
    /// The plate of the sheet.
    #[serde(with = "slipline_plate::exchange::maybe_by_number")]
    pub plate: Option<Arc<Plate>>,
    /// Distance of the stations along the plate and of the rows across it, in metres.
    step_m: (f64, f64),
    /// Number of stations in a row.
    stations: usize,
    /// Displacement in metres, row by row; the middle row is the centre line.
    now_m: Vec<f32>,
    /// Largest displacement since the sheet had settled, in metres.
    largest_m: Vec<f32>,
}

impl Frame {
    /// Displacement in metres at a place (x from the driven end, z from the centre line, both in metres), bilinear
    /// between the cells; 0 off the sheet.
    #[must_use]
    pub fn now_m(&self, x_m: f64, z_m: f64) -> f64 {
        self.at(&self.now_m, x_m, z_m)
    }

    /// Largest displacement in metres since the sheet had settled, at a place given as for [`Frame::now_m`].
    #[must_use]
    pub fn largest_m(&self, x_m: f64, z_m: f64) -> f64 {
        self.at(&self.largest_m, x_m, z_m)
    }

    fn at(&self, values: &[f32], x_m: f64, z_m: f64) -> f64 {
        let rows = values.len().checked_div(self.stations).unwrap_or(0);
        let (column, row) = (x_m / self.step_m.0, z_m / self.step_m.1 + 0.5 * rows.saturating_sub(1) as f64);
        if !(column >= 0.0 && row >= 0.0) {
            return 0.0;
        }
        let value = |row: usize, column: usize| {
            if row >= rows || column >= self.stations {
                return 0.0;
            }
            f64::from(values[row * self.stations + column])
        };
        let (i, j) = (row as usize, column as usize);
        let (t, s) = (row - i as f64, column - j as f64);
        let mix = |row: usize| value(row, j) * (1.0 - s) + value(row, j + 1) * s;
        mix(i) * (1.0 - t) + mix(i + 1) * t
    }
}

/// A drive for a sheet, and the time of its slow motion.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct SheetJob {
    /// The drive and its plate.
    pub drive: TimeDomainJob,
    /// Plate time that has passed in slow motion, in seconds. The sheet advances by the difference to the job
    /// before, limited to 0 to 0.05 s.
    pub time_s: f64,
}

/// The work of the sheet thread, which keeps the sheet from job to job. `None` if the plate has no sheet at
/// the device's rate, or its codes could not be replayed. If the task is cancelled during settling, the frame
/// shows the state so far, and the next job continues from it.
pub fn work() -> impl FnMut(SheetJob, &Task) -> Option<Frame> + Send {
    let mut run: Option<Run> = None;
    move |job, task| {
        if run.as_ref().is_none_or(|run| !Arc::ptr_eq(&run.plate, &job.drive.plate)) {
            run = Run::new(&job.drive);
        }
        let run = run.as_mut()?;
        if run.number != Some(job.drive.number) {
            run.change(&job.drive)?;
        }
        if run.settling {
            run.settle(&job.drive, task);
            run.time_s = job.time_s;
        }
        let passed_s = (job.time_s - run.time_s).clamp(0.0, STRIDE_MAX_S);
        run.time_s = job.time_s;
        run.due += passed_s * run.rate_hz;
        run.advance(run.due as u64);
        Some(run.frame())
    }
}

/// A sheet driven by the codes of a mirror.
struct Run {
    plate: Arc<Plate>,
    number: Option<u64>,
    table: Arc<DeviceTable>,
    mirror: Mirror,
    sheet: Sheet,
    rate_hz: f64,
    dac_bits: u8,
    settle_s: f64,
    /// Whether it is still settling after the latest change.
    settling: bool,
    /// Plate time shown so far, in seconds.
    time_s: f64,
    /// Index of the code up to which the sheet must run. It is fractional because one frame of slow motion takes
    /// less than a block.
    due: f64,
    /// Codes rendered by the mirror that the sheet has not received.
    ahead: VecDeque<f32>,
    /// Number of codes that the sheet has received.
    taken: u64,
}

impl Run {
    fn new(job: &TimeDomainJob) -> Option<Self> {
        let rate = job.table.header().sample_rate_hz;
        let rate_hz = f64::from(rate);
        let sheet = Sheet::new(&job.plate, rate_hz, grid(&job.plate)).ok()?;
        let settle_s = line_at_rest(&job.plate, rate_hz, LINE_POINTS.0)?.settle_time_s();
        Some(Self {
            plate: Arc::clone(&job.plate),
            number: None,
            table: Arc::clone(&job.table),
            mirror: Mirror::new(rate, 0),
            sheet,
            rate_hz,
            dac_bits: job.dac_bits.clamp(2, 16),
            settle_s,
            settling: true,
            time_s: 0.0,
            due: 0.0,
            ahead: VecDeque::new(),
            taken: 0,
        })
    }

    /// Switches to another drive: the tones glide from their present places.
    fn change(&mut self, job: &TimeDomainJob) -> Option<()> {
        let now = self.mirror.now();
        if self.number.is_none() || self.table.crc() != job.table.crc() {
            self.mirror.acknowledge_table(job.table.knots().into(), now).ok()?;
            self.table = Arc::clone(&job.table);
        }
        if let Played::Chord(_) = job.played {
            // A chord begins in silence.
            self.mirror.silence(now);
        }
        self.mirror.acknowledge_play(job.played.clone(), now + AHEAD).ok()?;
        let tones_hz: Vec<f64> =
            job.played.tones(&job.table).into_iter().map(|tone| tone.frequency_hz).collect();
        self.sheet.retune(&tones_hz);
        self.number = Some(job.number);
        self.settling = true;
        Some(())
    }

    /// Runs until the transient of the change has decayed, then long enough to record the largest
    /// displacement.
    fn settle(&mut self, job: &TimeDomainJob, task: &Task) {
        let glide_s = f64::from(job.played.glide()) / self.rate_hz;
        let settle = AHEAD + ((glide_s + self.settle_s).min(time_domain::RUN_MAX_S) * self.rate_hz) as u64;
        let watch = (time_domain::watch_s(job) * self.rate_hz) as u64;
        let whole = (settle + watch).max(1);
        let first = self.taken;
        for (end, is_watch) in [(settle, false), (whole, true)] {
            if is_watch {
                self.sheet.reset_envelope();
            }
            while self.taken < first + end {
                self.due = (self.taken + 16 * BLOCK as u64).min(first + end) as f64;
                self.advance(self.due as u64);
                if !task.report((self.taken - first) as f64 / whole as f64) {
                    // A newer job is waiting; it continues from here.
                    return;
                }
            }
        }
        self.settling = false;
    }

    fn advance(&mut self, until: u64) {
        let half = f32::from(1u16 << (self.dac_bits - 1));
        let due = until.next_multiple_of(BLOCK as u64);
        let ahead = &mut self.ahead;
        self.mirror.render(due, |_, codes| {
            ahead.extend(codes.iter().map(|&code| (f32::from(code) - half) / half));
        });
        let count = until.saturating_sub(self.taken).min(self.ahead.len() as u64) as usize;
        let codes: Vec<f32> = self.ahead.drain(..count).collect();
        self.sheet.push(&codes);
        self.taken += count as u64;
    }

    fn frame(&self) -> Frame {
        let (along, across) = (self.sheet.positions_m(), self.sheet.widths_m());
        let step = |places: &[f64]| places.get(1).zip(places.first()).map_or(1.0, |(b, a)| b - a);
        let mut now_m = vec![0.0; along.len() * across.len()];
        self.sheet.field_m(&mut now_m);
        let largest_m = self.sheet.envelope().maximum_m;
        Frame {
            plate: Some(Arc::clone(&self.plate)),
            step_m: (step(along), step(across)),
            stations: along.len(),
            now_m,
            largest_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::simulation::device_table;
    use crate::field::steady_field::{SteadyField, SteadyTone};
    use crate::field::time_domain::tests::one_tone;
    use slipline_link::protocol::units::Position;
    use slipline_plate::DriveTable;

    const RATE: f64 = 400_000.0;

    fn job(number: u64, plate: &Arc<Plate>, table: &Arc<DeviceTable>, position: Position) -> SheetJob {
        let drive = one_tone(0, position, 8000);
        let drive = TimeDomainJob {
            number,
            plate: Arc::clone(plate),
            table: Arc::clone(table),
            played: drive.into(),
            dac_bits: 12,
        };
        SheetJob { drive, time_s: 0.0 }
    }

    #[test]
    fn the_sheet_moves_as_the_solver_predicts_and_follows_a_change() {
        moves_as_predicted("membrane");
    }

    #[test]
    fn the_sheet_of_a_membrane_in_air_moves_as_the_solver_predicts_and_follows_a_change() {
        moves_as_predicted("latex-membrane");
    }

    fn moves_as_predicted(name: &str) {
        let plate = Arc::new(slipline_plate::preset(name).unwrap());
        let table = DriveTable::build(&plate, RATE, 257).unwrap();
        let table = Arc::new(device_table(&table).unwrap());
        let mut work = work();
        for (number, x0) in [(1, 0.2), (2, 0.14)] {
            let position = table.position(x0).unwrap();
            let frame = work(job(number, &plate, &table, position), &Task::default()).unwrap();
            let peak_m = table.peak_at_full_scale_m();
            let frequency_hz = table.frequency_hz(position);
            let steady = SteadyField::solve(&plate, &[SteadyTone { slot: 0, frequency_hz, peak_m }]);
            let worst = (0..=64)
                .map(|i| f64::from(i) / 64.0 * plate.length_m())
                .map(|x| (frame.largest_m(x, 0.0) - steady.bound_at(x)).abs() / peak_m)
                .fold(0.0, f64::max);
            assert!(worst < 0.08, "{name} {x0}: {worst}");
            // Across the plate it is the first width mode: zero at the edge, smaller than the middle between.
            let half_m = plate.half_width_m(x0);
            let across = [0.0, 0.5, 1.0].map(|share| frame.largest_m(x0, share * half_m));
            assert!((across[1] / across[0] - 0.5f64.sqrt()).abs() < 0.08 && across[2] < 0.1 * across[0]);
        }
    }

    #[test]
    fn slow_motion_goes_on_by_the_time_that_passes_and_stands_while_none_does() {
        let plate = Arc::new(slipline_plate::preset("membrane").unwrap());
        let table = DriveTable::build(&plate, RATE, 257).unwrap();
        let table = Arc::new(device_table(&table).unwrap());
        let position = table.position(0.2).unwrap();
        let frequency_hz = table.frequency_hz(position);
        let mut work = work();
        let mut at = |turns: f64| {
            let mut job = job(1, &plate, &table, position);
            job.time_s = turns / frequency_hz;
            let frame = work(job, &Task::default()).unwrap();
            frame.now_m(0.1, 0.0) / table.peak_at_full_scale_m()
        };
        let first = at(0.0);
        assert_eq!(at(0.0), first);
        let (half, whole) = (at(0.5), at(1.0));
        // A step of the sheet is about a seventieth of a turn.
        assert!((half + first).abs() < 0.1 && (whole - first).abs() < 0.1, "{first} {half} {whole}");
        let swing = (0..8).map(|i| at(1.0 + f64::from(i) / 8.0).abs()).fold(0.0, f64::max);
        assert!(swing > 0.2, "{swing}");
    }
}
