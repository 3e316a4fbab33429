//! Steps that need no drive: clocks, supply, mute pin, link.

use super::course::{Course, reading};
use super::limits::step;
use super::report::{Reading, StepResult};
use crate::measure::MeasureError;
use slipline_link::protocol::board::{ClockReport, MuteResistor, MuteTrial, PinLevel};
use slipline_link::{Request, Snapshot};
use std::time::Duration;

/// Looks at the clocks at each end of the time over which they are compared: the quickest answer counts.
const LOOKS: usize = 20;
/// Time over which the clocks are compared, seconds.
const CLOCKS_S: f64 = 10.0;
/// Time between two readings of the USB's frames, whose number wraps after 2.048 s, seconds.
const FRAMES_S: f64 = 0.8;
const FRAMES: u64 = 2048;
/// Longest doubt about the time at which the mute pin went low, us; a trial with more is repeated.
const DOUBT_US: u32 = 100;
/// Trials of one kind, at most.
const TRIALS: usize = 5;

/// The clocks at one moment: the host's at the device's sample, and those that the device reports.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moment {
    time: Duration,
    sample: u64,
    device: ClockReport,
}

impl Course {
    /// The clocks now, by the quickest of some answers.
    pub(super) async fn moment(&self) -> Result<Moment, MeasureError> {
        let mut best: Option<(f64, Duration, u64)> = None;
        for _ in 0..LOOKS {
            self.dialogue.done(Request::Refresh).await?;
            let read = |snapshot: &Snapshot| Some((snapshot.drive.status_time, snapshot.drive.status?.now));
            if let Some((time, sample)) = self.dialogue.seen(read).flatten() {
                let late_s = time.as_secs_f64() - sample as f64 / self.rate_hz;
                if best.is_none_or(|(least_s, ..)| late_s < least_s) {
                    best = Some((late_s, time, sample));
                }
            }
        }
        let (_, time, sample) = best.ok_or(MeasureError::Lost)?;
        let device = match self.dialogue.done(Request::ReadClock).await {
            Ok(_) => self.dialogue.seen(|snapshot| snapshot.device.clock).flatten().unwrap_or_default(),
            Err(MeasureError::TooOld) => ClockReport::default(),
            Err(error) => return Err(error),
        };
        Ok(Moment { time, sample, device })
    }

    /// Compares the clocks since this moment; waits until it is long enough ago.
    pub(super) async fn clocks(&self, since: Moment) -> Result<StepResult, MeasureError> {
        let name = step::CLOCKS;
        let span_s = if self.is_short() { 0.0 } else { CLOCKS_S };
        self.dialogue.past(since.sample + self.samples(span_s)).await?;
        let now = self.moment().await?;
        let elapsed_s = now.time.saturating_sub(since.time).as_secs_f64();
        let by_samples_s = now.sample.saturating_sub(since.sample) as f64 / self.rate_hz;
        let quantity = if self.is_short() { "rate error in a short time" } else { "rate error" };
        let mut readings = vec![reading(name, quantity, ppm(by_samples_s / elapsed_s.max(1e-9)))];
        readings.extend(self.cycles(&since.device, &now.device));
        readings.extend(self.usb().await?);
        let good = format!("The samples keep the host's time over {elapsed_s:.1} s.");
        Ok(StepResult::judged(name, readings, good))
    }

    /// Cycles of the processor between two reports over those of its clock; none where they are not counted.
    fn cycles(&self, since: &ClockReport, now: &ClockReport) -> Option<Reading> {
        let core_hz = self.core_hz()?;
        if since.cycles == 0 || now.cycles == 0 {
            return None;
        }
        let expected = now.at.saturating_sub(since.at) as f64 / self.rate_hz * core_hz;
        let counted = near(expected, now.cycles.wrapping_sub(since.cycles));
        Some(reading(step::CLOCKS, "cycle error", ppm(counted / expected.max(1.0))))
    }

    /// The processor's clock over the frames of the USB, read so often that their number wraps once at most between two readings;
    /// none without USB.
    async fn usb(&self) -> Result<Option<Reading>, MeasureError> {
        let Some(core_hz) = self.core_hz() else { return Ok(None) };
        let span_s = if self.is_short() { 0.1 } else { CLOCKS_S };
        let usb = |snapshot: &Snapshot| snapshot.device.clock.and_then(|clock| clock.usb);
        let Some(first) = self.dialogue.seen(usb).flatten() else { return Ok(None) };
        let (mut last, mut frames, mut cycles) = (first, 0_u64, 0_u64);
        let end = self.dialogue.now() + self.samples(span_s);
        while self.dialogue.now() < end {
            let next = (self.dialogue.now() + self.samples(FRAMES_S)).min(end);
            self.dialogue.past(next).await?;
            self.dialogue.done(Request::ReadClock).await?;
            let Some(now) = self.dialogue.seen(usb).flatten() else { return Ok(None) };
            frames += (u64::from(now.number) + FRAMES - u64::from(last.number)) % FRAMES;
            cycles += u64::from(now.cycles.wrapping_sub(last.cycles));
            last = now;
        }
        let by_frames_s = frames as f64 * 1e-3;
        let share = cycles as f64 / core_hz / by_frames_s.max(1e-3);
        Ok(Some(reading(step::CLOCKS, "error by USB frames", ppm(share))))
    }

    fn core_hz(&self) -> Option<f64> {
        let core_hz = self.dialogue.seen(|snapshot| snapshot.device.board.map(|board| board.core_hz));
        core_hz.flatten().filter(|&core_hz| core_hz > 0).map(f64::from)
    }

    /// What the device reports of its supply.
    pub(super) fn supply(&self) -> StepResult {
        let name = step::SUPPLY;
        let read = self.dialogue.seen(|snapshot| {
            let reset = snapshot.device.identity.as_ref().map(|identity| identity.reset);
            (snapshot.device.analogue, snapshot.device.maintenance, reset)
        });
        let Some((analogue, maintenance, reset)) = read else {
            return StepResult::skipped(name, "The device reports nothing of its supply.");
        };
        let analogue = analogue.unwrap_or_default();
        if analogue.reference_mv == 0 {
            return StepResult::skipped(name, "The device has not measured its reference voltage.");
        }
        let volts = f64::from(analogue.reference_mv) / 1000.0;
        let unset = maintenance.map(|report| f64::from(u8::from(!report.brown_out_guarded)));
        let mut readings = vec![reading(name, "VREF+", volts)];
        readings.extend(unset.map(|unset| reading(name, "brown-out level unset", unset)));
        let level = analogue.brown_out_level.map(f64::from);
        readings.extend(level.map(|level| reading(name, "brown-out level", level)));
        readings.push(reading(name, "linear share", f64::from(analogue.linear_per_mille) / 10.0));
        if analogue.chip != 0 {
            readings.push(reading(name, "chip", f64::from(analogue.chip)));
            readings.push(reading(name, "silicon revision", f64::from(analogue.revision)));
        }
        let errors = analogue.ram_errors.map(|found| found.count_ones());
        readings.extend(errors.map(|errors| reading(name, "kinds of RAM errors", f64::from(errors))));
        let reset = reset.map_or_else(String::new, |cause| format!(" The last reset: {cause:?}."));
        StepResult::judged(name, readings, format!("The reference is within its range.{reset}"))
    }

    /// The level of the mute pin.
    pub(super) async fn mute_level(&self) -> Result<PinLevel, MeasureError> {
        self.dialogue.done(Request::MutePin(MuteTrial::Read)).await?;
        let level = self.dialogue.seen(|snapshot| snapshot.device.mute_pin.map(|pin| pin.level));
        Ok(level.flatten().unwrap_or_default())
    }

    /// The mute pin by the levels that were read while it should be low.
    pub(super) fn mute(&self, levels: &[PinLevel]) -> StepResult {
        let name = step::MUTE;
        let board = self.dialogue.seen(|snapshot| snapshot.device.board).flatten().unwrap_or_default();
        let resistor = match board.mute_resistor {
            MuteResistor::NotLooked => None,
            MuteResistor::Present => Some(0.0),
            MuteResistor::Missing => Some(1.0),
        };
        let mut readings: Vec<Reading> =
            resistor.into_iter().map(|missing| reading(name, "resistor missing", missing)).collect();
        if levels.iter().any(|&level| level != PinLevel::NoPin) {
            let high = levels.iter().filter(|&&level| level == PinLevel::High).count();
            readings.push(reading(name, "pin high while muted", high as f64));
        }
        if readings.is_empty() {
            return StepResult::skipped(name, "The device has no mute pin, or does not look at it.");
        }
        StepResult::judged(name, readings, "The pin is low while the device is disarmed and on the bench.")
    }

    /// How long the pin takes to go low: when no block comes any more, and when the program breaks the timer. It takes the pin high.
    pub(super) async fn mute_time(&self) -> Result<StepResult, MeasureError> {
        let name = step::MUTE_TIME;
        let mut readings = Vec::new();
        for (trial, late, silent) in [
            (MuteTrial::Lapse, "time to low", "timer leaves it high"),
            (MuteTrial::Break, "time to low by a break", "break leaves it high"),
        ] {
            let mut fall = None;
            for _ in 0..TRIALS {
                self.idle().await?;
                let ready = self.dialogue.arm(true).await?;
                self.dialogue.past(ready).await?;
                self.dialogue.done(Request::MutePin(trial)).await?;
                fall = self
                    .dialogue
                    .seen(|snapshot| snapshot.device.mute_pin.and_then(|pin| pin.fall))
                    .flatten();
                if fall.is_none_or(|fall| fall.within_us <= DOUBT_US) {
                    break;
                }
            }
            let level =
                self.dialogue.seen(|snapshot| snapshot.device.mute_pin.map(|pin| pin.level)).flatten();
            if level != Some(PinLevel::High) {
                self.dialogue.disarm().await?;
                return Ok(StepResult::skipped(
                    name,
                    "The pin stays low where the device is armed: see the step mute.",
                ));
            }
            readings.push(reading(name, silent, f64::from(u8::from(fall.is_none()))));
            let in_ms = fall.map(|fall| f64::from(fall.low_after_us) / 1000.0);
            readings.extend(in_ms.map(|ms| reading(name, late, ms)));
        }
        self.dialogue.disarm().await?;
        Ok(StepResult::judged(
            name,
            readings,
            "The pin goes low by itself when no block comes, and at once by a break.",
        ))
    }

    /// How the link has done so far.
    pub(super) fn link_record(&self) -> LinkRecord {
        self.dialogue.seen(LinkRecord::of).unwrap_or_default()
    }

    /// How the link has done since the test began.
    pub(super) fn link(&self, before: &LinkRecord) -> Vec<Reading> {
        let name = step::LINK;
        let now = self.link_record();
        // The slowest answer of the connection counts if it is one of the test.
        let longest = if now.worst > before.worst { now.worst } else { self.dialogue.slowest() };
        vec![
            reading(name, "longest answer", longest.as_secs_f64()),
            reading(name, "damaged frames", f64::from(now.damaged.saturating_sub(before.damaged))),
            reading(name, "repeated commands", f64::from(now.repeats.saturating_sub(before.repeats))),
        ]
    }
}

/// What the link has recorded since the connection began.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LinkRecord {
    /// The slowest answer.
    worst: Duration,
    /// Frames that arrived damaged at either end.
    damaged: u32,
    /// Commands sent again.
    repeats: u32,
}

impl LinkRecord {
    fn of(snapshot: &Snapshot) -> Self {
        let of_device = snapshot.drive.status.map_or(0, |status| status.counters.crc_errors);
        Self {
            worst: snapshot.link.round_trip.worst,
            damaged: of_device.saturating_add(snapshot.link.decoder.damaged),
            repeats: snapshot.link.counters.retries,
        }
    }
}

/// How far a share is from 1, in parts per million.
fn ppm(share: f64) -> f64 {
    1e6 * (share - 1.0)
}

/// The count nearest to `expected` whose lowest 32 bits are these.
fn near(expected: f64, low: u32) -> f64 {
    const WRAP: f64 = 4_294_967_296.0;
    f64::from(low) + WRAP * ((expected - f64::from(low)) / WRAP).round()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrapped_count_is_the_one_nearest_to_what_is_expected() {
        let (core_hz, seconds) = (168e6_f64, 60.0);
        let counted = (core_hz * seconds + 500.0) as u64;
        assert_eq!(near(core_hz * seconds, counted as u32), counted as f64);
        assert_eq!(near(10.0, u32::MAX), -1.0);
    }
}
