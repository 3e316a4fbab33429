//! Comparison of the device's codes with the mirror's.
//!
//! In each stage the device computes a CRC-32 of a future window of its codes, a request changes the drive within the
//! window, and the mirror renders the same window from the changes that the device acknowledged. Equal digests mean equal
//! codes, on any board.

use super::dialogue::Dialogue;
use super::error::MeasureError;
use super::procedure::{Evaluation, Procedure, evaluated};
use super::setback::ended_by;
use serde::Serialize;
use slipline_link::protocol::command::DigestWindow;
use slipline_link::protocol::frame::CRC;
use slipline_link::protocol::limits::MAX_DIGEST_SAMPLES;
use slipline_link::{DriveRequest, Outcome, Request, Sounding, ToneRequest};
use slipline_plate::Plate;
use slipline_plate::quantity::Range;

/// Time from the request to the window, in seconds, so that the command arrives before it over the slowest link.
const AHEAD_S: f64 = 0.1;
/// Time after which a stop has ramped down and the table has been taken up, in seconds.
const REST_S: f64 = 0.1;
/// Latest time of a window's digest after the window's end, over the slowest link, in seconds.
const KEPT_BEHIND_S: f64 = 5.0;
/// The shortest window, in seconds.
const SHORTEST_S: f64 = 0.01;

/// The change within a window.
#[derive(Clone, Copy, Debug)]
enum Stage {
    /// The tones start from silence.
    Start,
    /// They continue.
    Steady,
    /// They glide to other places, three times.
    Drag,
    /// They ramp to silence.
    Stop,
}

impl Stage {
    const ALL: [Self; 4] = [Self::Start, Self::Steady, Self::Drag, Self::Stop];

    const fn name(self) -> &'static str {
        match self {
            Self::Start => "start from silence",
            Self::Steady => "steady tones",
            Self::Drag => "drag",
            Self::Stop => "stop",
        }
    }
}

/// The comparison of the device's codes with the mirror's.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verified {
    /// Whether the codes of all windows are equal.
    // JSON, true or false: Whether the codes of device and mirror are equal
    pub equal: bool,
    /// The windows, in their order.
    pub windows: Vec<VerifiedWindow>,
}

/// The codes of one window.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VerifiedWindow {
    /// The kind of change within it.
    // JSON, text: Kind of change within the window
    pub stage: &'static str,
    /// Its first sample.
    // JSON: Index of the first sample
    pub at_samples: u64,
    /// Its length.
    // JSON, count: Number of samples
    pub samples: u32,
    /// CRC-32 of the device's codes in hexadecimal; `None` if the device has none.
    // JSON, text: CRC-32 of the codes by the device; null if it gave none
    pub device_crc: Option<String>,
    /// CRC-32 of the mirror's codes.
    // JSON, text: CRC-32 of the codes by the mirror
    pub mirror_crc: String,
    /// Whether they are equal.
    pub equal: bool,
}

/// The allowed lengths of a window at this sample rate.
#[must_use]
pub fn verify_windows_s(rate_hz: f64) -> Range {
    Range::new(SHORTEST_S, f64::from(MAX_DIGEST_SAMPLES) / rate_hz, "s")
}

/// The procedure that compares the codes.
pub struct Verifying {
    /// Boundaries of the tones, in metres, from and to.
    span_m: (f64, f64),
    tones: u8,
    window_s: f64,
    rate_hz: f64,
}

impl Verifying {
    /// A comparison with this number of tones, 1 to 16, in windows of this length ([`verify_windows_s`]), on a device that must
    /// be armed and hold the table of this plate.
    #[must_use]
    pub fn new(plate: &Plate, tones: u8, window_s: f64, rate_hz: f64) -> Self {
        Self { span_m: plate.span_m(), tones, window_s, rate_hz }
    }

    const fn samples(&self, time_s: f64) -> u64 {
        (time_s * self.rate_hz) as u64
    }

    /// Plays the tones, shifted by this share of their distance.
    async fn play(&self, shift: f64, dialogue: &Dialogue) -> Result<(), MeasureError> {
        let (start_m, end_m) = self.span_m;
        let count = f64::from(self.tones);
        let tones = (0..self.tones)
            .map(|slot| {
                let turns = f64::from(slot) / count;
                let boundary_m = start_m + (0.05 + 0.8 * turns + 0.1 * shift) * (end_m - start_m);
                ToneRequest { slot, boundary_m, level: 0.9 / count, phase_turns: turns }
            })
            .collect();
        dialogue.done(Request::Play(Sounding::Drive(DriveRequest::of(tones)))).await.map(drop)
    }

    /// Changes the drive within a window.
    async fn act(&self, stage: Stage, dialogue: &Dialogue) -> Result<(), MeasureError> {
        match stage {
            Stage::Start => self.play(0.0, dialogue).await,
            Stage::Steady => Ok(()),
            Stage::Drag => {
                for shift in [1.0, 0.3, 0.7] {
                    self.play(shift, dialogue).await?;
                    dialogue.past(dialogue.now() + self.samples(0.1 * self.window_s)).await?;
                }
                Ok(())
            }
            Stage::Stop => dialogue.stop().await,
        }
    }

    /// Compares the codes of one window.
    async fn window(&self, stage: Stage, dialogue: &Dialogue) -> Result<VerifiedWindow, MeasureError> {
        dialogue.done(Request::Refresh).await?;
        let window = DigestWindow {
            from: dialogue.now() + self.samples(AHEAD_S),
            count: self.samples(self.window_s) as u32,
        };
        dialogue.begin(Request::Digest(window));
        // Until the window has begun.
        dialogue.past(window.from + self.samples(0.1 * self.window_s)).await?;
        self.act(stage, dialogue).await?;
        let end = window.from + u64::from(window.count);
        let digest = match dialogue.ended(end + self.samples(KEPT_BEHIND_S)).await? {
            Some(Outcome::Digest(digest)) => digest,
            Some(outcome) => return Err(ended_by(&outcome)),
            None => return Err(MeasureError::NoDigest),
        };
        let mut crc = CRC.digest();
        for code in dialogue.codes(window.from, window.count.into()).await? {
            crc.update(&code.to_le_bytes());
        }
        let mirror = crc.finalize();
        Ok(VerifiedWindow {
            stage: stage.name(),
            at_samples: digest.from,
            samples: digest.count,
            device_crc: digest.crc.map(hexadecimal),
            mirror_crc: hexadecimal(mirror),
            equal: digest.crc == Some(mirror),
        })
    }
}

impl Procedure for Verifying {
    type Found = Verified;

    async fn carry_out(self, dialogue: Dialogue) -> Result<Evaluation<Verified>, MeasureError> {
        dialogue.replay(self.samples(self.window_s + KEPT_BEHIND_S));
        dialogue.stop().await?;
        dialogue.past(dialogue.now() + self.samples(REST_S)).await?;
        let mut windows = Vec::new();
        for stage in Stage::ALL {
            dialogue.mark(windows.len() as u64, Stage::ALL.len() as u64, None);
            windows.push(self.window(stage, &dialogue).await?);
        }
        dialogue.stop().await?;
        Ok(evaluated(Verified { equal: windows.iter().all(|window| window.equal), windows }))
    }
}

fn hexadecimal(crc: u32) -> String {
    format!("{crc:08x}")
}
