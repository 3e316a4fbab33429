//! Steps by drives on the bench: load, codes, trigger output to trigger input, also after a stall of the DMA.

use super::course::{Course, SENSOR, SPAN_M, TRIES, reading};
use super::limits::step;
use super::report::StepResult;
use crate::measure::{MeasureError, ended_by, is_late};
use slipline_link::protocol::command::{Apply, DigestWindow};
use slipline_link::protocol::frame::CRC;
use slipline_link::protocol::limits::MAX_TONES;
use slipline_link::{
    DriveRequest, ListenRequest, Outcome, Request, Snapshot, Sounding, ToneRequest, WindowShape,
};

/// Time under load, and of a short test, seconds.
const LOAD_S: f64 = 2.0;
const SHORT_LOAD_S: f64 = 0.1;
/// Windows of codes and their length, and of a short test.
const WINDOWS: (u32, f64) = (20, 0.5);
const SHORT_WINDOWS: (u32, f64) = (2, 0.05);
/// Drives within a window.
const DRIVES: u32 = 3;
/// Latest time of a digest after its window, over the slowest link, seconds.
const BEHIND_S: f64 = 5.0;
/// Time within which a rise of the trigger output begins a drive, seconds: some blocks.
const TRIGGERED_S: f64 = 0.05;
/// Samples by which the trigger output rises before the program's first code is at the DAC's pin.
const EARLY: u64 = 2;

/// The digests of random drives.
pub(super) struct Compared {
    pub(super) result: StepResult,
    /// CRC-32 over the device's digests, in hexadecimal.
    pub(super) crc: String,
}

impl Course {
    /// A drive of this number of random tones.
    fn random_drive(&self, count: usize, glide_s: f64) -> DriveRequest {
        let mut random = self.random.borrow_mut();
        let (start_m, end_m) = SPAN_M;
        let level = 0.9 * self.most / count as f64;
        let tones = (0..count as u8)
            .map(|slot| ToneRequest {
                slot,
                boundary_m: random.within(start_m, end_m),
                level: level * random.within(0.1, 1.0),
                phase_turns: random.within(0.0, 1.0),
            })
            .collect();
        DriveRequest { glide_s, ..DriveRequest::of(tones) }
    }

    async fn play(&self, drive: DriveRequest) -> Result<u64, MeasureError> {
        self.dialogue.done(Request::Play(Sounding::Drive(drive))).await
    }

    /// Drags sixteen tones as fast as the device answers, while its inputs are measured, and looks at what that costs.
    pub(super) async fn load(&self) -> Result<StepResult, MeasureError> {
        let name = step::LOAD;
        self.dialogue.done(Request::ReadBoard).await?;
        let before = self.dialogue.seen(lost);
        let seconds = if self.request.is_short { SHORT_LOAD_S } else { LOAD_S };
        let end = self.dialogue.now() + self.samples(seconds);
        let blocks = (self.samples(seconds) / slipline_link::BLOCK as u64).clamp(1, u16::MAX.into()) as u16;
        let measures = self.inputs.inputs > 0;
        if measures {
            let shape = WindowShape::Hann;
            let listen = ListenRequest { from: None, blocks, shape, slots: u16::MAX, input: SENSOR };
            self.dialogue.begin(Request::Listen(listen));
        }
        let mut drives = 0.0;
        while self.dialogue.now() < end {
            self.play(self.random_drive(MAX_TONES, 0.005)).await?;
            drives += 1.0;
        }
        if measures {
            // The measured values do not count, only that no block was lost.
            self.dialogue.ended(end + self.samples(BEHIND_S)).await?;
        }
        self.dialogue.done(Request::ReadBoard).await?;
        self.dialogue.done(Request::Refresh).await?;
        let after = self.dialogue.seen(lost);
        self.dialogue.stop().await?;
        let [(lost_before, late_before), (lost_after, late_after)] =
            [before.unwrap_or_default(), after.unwrap_or_default()];
        let mut readings = vec![
            reading(name, "lost blocks", f64::from(lost_after.saturating_sub(lost_before))),
            reading(name, "underruns", f64::from(late_after.saturating_sub(late_before))),
            reading(name, "drives in that time", drives),
        ];
        let worst = self.dialogue.seen(Snapshot::worst_block).flatten();
        readings.extend(worst.map(|share| reading(name, "worst block", 100.0 * share)));
        Ok(StepResult::judged(name, readings, "The device keeps up with tones, inputs and a busy link."))
    }

    /// Compares the digests of random drives with the mirror's.
    pub(super) async fn codes(&self) -> Result<Compared, MeasureError> {
        let name = step::CODES;
        let (windows, window_s) = if self.request.is_short { SHORT_WINDOWS } else { WINDOWS };
        let (mut differing, mut all) = (0, CRC.digest());
        for _ in 0..windows {
            let (of_device, of_mirror) = self.window(window_s).await?;
            differing += u32::from(of_device != of_mirror);
            all.update(&of_device.to_le_bytes());
        }
        self.dialogue.stop().await?;
        let readings = vec![
            reading(name, "windows that differ", f64::from(differing)),
            reading(name, "windows", f64::from(windows)),
            reading(name, "compared time", f64::from(windows) * window_s),
        ];
        let result = StepResult::judged(name, readings, "The device sends the mirror's codes.");
        Ok(Compared { result, crc: format!("{:08x}", all.finalize()) })
    }

    /// The digests of device and mirror over a window with random drives in it.
    async fn window(&self, window_s: f64) -> Result<(u32, u32), MeasureError> {
        let mut tries = 1;
        loop {
            let (window, outcome) = self.driven_window(window_s, self.ahead_s(tries)).await?;
            if is_late(&outcome) && tries < TRIES {
                tries += 1;
                continue;
            }
            let Outcome::Digest(digest) = outcome else { return Err(ended_by(&outcome)) };
            let mut mirror = CRC.digest();
            for code in self.dialogue.codes(window.from, window.count.into()).await? {
                mirror.update(&code.to_le_bytes());
            }
            return Ok((digest.crc.ok_or(MeasureError::NoDigest)?, mirror.finalize()));
        }
    }

    /// Orders the digest of a window, and plays random drives in it.
    async fn driven_window(
        &self,
        window_s: f64,
        ahead_s: f64,
    ) -> Result<(DigestWindow, Outcome), MeasureError> {
        self.dialogue.done(Request::Refresh).await?;
        let window = DigestWindow {
            from: self.dialogue.now() + self.samples(ahead_s),
            count: self.samples(window_s) as u32,
        };
        self.dialogue.begin(Request::Digest(window));
        for part in 0..DRIVES {
            let share = (f64::from(part) + 0.2) / f64::from(DRIVES);
            self.dialogue.past(window.from + self.samples(share * window_s)).await?;
            let glide_s = self.random.borrow_mut().within(0.005, 0.5 * window_s.min(0.2));
            let count = 1 + self.random.borrow_mut().bits() as usize % MAX_TONES;
            self.play(self.random_drive(count, glide_s)).await?;
        }
        let end = window.from + u64::from(window.count);
        let outcome = self.dialogue.ended(end + self.samples(BEHIND_S)).await?;
        Ok((window, outcome.ok_or(MeasureError::NoDigest)?))
    }

    /// Begins a drive by the device's own trigger output, which rises on the bench where a drive begins to wait.
    pub(super) async fn trigger(&self) -> Result<StepResult, MeasureError> {
        let name = step::TRIGGER;
        Ok(match self.triggered().await? {
            None => StepResult::failed(
                name,
                "The trigger output's rise began no drive: look at the wire from the trigger output to the trigger input.",
            ),
            Some(samples) => {
                let readings = vec![reading(name, "trigger delay", samples)];
                StepResult::judged(name, readings, "A rise of the trigger input begins a drive in time.")
            }
        })
    }

    /// Stops the DAC's DMA, and begins a drive by the trigger output after it: does the output rise as before?
    pub(super) async fn stall(&self) -> Result<StepResult, MeasureError> {
        let name = step::STALL;
        self.idle().await?;
        // In silence, where an underrun is no fault.
        let ready = self.dialogue.arm(false).await?;
        self.dialogue.past(ready).await?;
        let before = self.dialogue.seen(lost);
        self.dialogue.done(Request::Stall).await?;
        self.dialogue.past(self.dialogue.now() + self.samples(TRIGGERED_S)).await?;
        let late = |seen: Option<(u32, u32)>| seen.map_or(0, |(_, late)| late);
        let is_noticed = late(self.dialogue.seen(lost)) > late(before);
        let mut readings = vec![reading(name, "stall unnoticed", f64::from(u8::from(!is_noticed)))];
        let triggered = self.triggered().await?;
        self.dialogue.disarm().await?;
        match triggered {
            None => Ok(StepResult::failed(
                name,
                "After a stall of the DMA the trigger output's rise began no drive.",
            )),
            Some(samples) => {
                readings.push(reading(name, "trigger delay after a stall", samples));
                let good = "A stall of the DMA is noticed, and the trigger output rises as before after it.";
                Ok(StepResult::judged(name, readings, good))
            }
        }
    }

    /// Begins a drive by the device's own trigger output; the samples from the first that may begin it to the one that does, or
    /// `None` if nothing has begun.
    async fn triggered(&self) -> Result<Option<f64>, MeasureError> {
        self.dialogue.stop().await?;
        let began = |snapshot: &Snapshot| snapshot.drive.trigger.and_then(|report| report.began);
        let before = self.dialogue.seen(began).flatten();
        let drive = DriveRequest { apply: Apply::AtTrigger, ..self.random_drive(1, 0.02) };
        let waits = self.play(drive).await?;
        let end = waits + self.samples(TRIGGERED_S);
        self.dialogue.past(end).await?;
        // Its report follows a status in which nothing waits.
        for _ in 0..10 {
            self.dialogue.done(Request::Refresh).await?;
        }
        let since = self.dialogue.seen(began).flatten();
        self.dialogue.stop().await?;
        let at = since.filter(|at| Some(*at) != before && *at >= waits);
        Ok(at.map(|at| (at - waits + EARLY) as f64))
    }
}

/// Blocks of the inputs that were lost, and blocks that came too late for the DAC.
fn lost(snapshot: &Snapshot) -> (u32, u32) {
    let lost = snapshot.device.inputs.map_or(0, |inputs| inputs.lost_blocks);
    (lost, snapshot.drive.status.map_or(0, |status| status.counters.underruns))
}
