//! Comparison of the device's codes with the mirror's.
//!
//! In each stage the device computes a CRC-32 of a future window of its codes, a request changes the drive within the
//! window, and the mirror renders the same window from the changes that the device acknowledged. Equal digests mean equal
//! codes, on any board.

use super::client::{BlockingLink, Client};
use super::error::ClientError;
use serde::Serialize;
use slipline_link::mirror::replay::{DeviceHistory, Replay};
use slipline_link::protocol::command::DigestWindow;
use slipline_link::protocol::frame::CRC;
use slipline_link::protocol::limits::MAX_DIGEST_SAMPLES;
use slipline_link::{DriveRequest, Snapshot, Sounding, ToneRequest};
use slipline_plate::Plate;
use slipline_plate::quantity::Range;
use std::sync::Arc;
use std::time::Duration;

/// Time from the request to the window, in seconds, so that the command arrives before it over the slowest link.
const AHEAD_S: f64 = 0.1;
/// Time after which a stop has ramped down and the table has been taken up.
const REST: Duration = Duration::from_millis(100);
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
    pub equal: bool,
    /// The windows, in their order.
    pub windows: Vec<VerifiedWindow>,
}

/// The codes of one window.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VerifiedWindow {
    /// The kind of change within it.
    pub stage: &'static str,
    /// Its first sample.
    pub at_samples: u64,
    /// Its length.
    pub samples: u32,
    /// CRC-32 of the device's codes in hexadecimal; `None` if the device has none.
    pub device_crc: Option<String>,
    /// CRC-32 of the mirror's codes.
    pub mirror_crc: String,
    /// Whether they are equal.
    pub equal: bool,
}

/// The allowed lengths of a window at this sample rate.
#[must_use]
pub fn verify_windows_s(rate_hz: f64) -> Range {
    Range::new(SHORTEST_S, f64::from(MAX_DIGEST_SAMPLES) / rate_hz, "s")
}

impl<W: BlockingLink> Client<W> {
    /// Arms the device, which holds the table of this plate, plays this number of tones, 1 to 16, and compares the codes of
    /// four windows of this length ([`verify_windows_s`]) with the mirror's; then it stops the drive.
    ///
    /// # Errors
    /// [`ClientError::NotComparable`] and a request's errors.
    pub fn verify(&self, plate: &Plate, tones: u8, window_s: f64) -> Result<Verified, ClientError> {
        let rate = f64::from(self.identity()?.sample_rate_hz);
        self.arm()?;
        self.pause(REST);
        let mut replay = Replay::new(((window_s + KEPT_BEHIND_S) * rate) as usize);
        self.follow(&mut replay)?;
        let mut windows = Vec::new();
        for stage in Stage::ALL {
            let from = self.refresh()? + (AHEAD_S * rate) as u64;
            let window = DigestWindow { from, count: (window_s * rate) as u32 };
            let patience = Duration::from_secs_f64(5.0 + 2.0 * window_s);
            let digest = self.digest(window, patience, || {
                // Until the window has begun.
                self.pause(Duration::from_secs_f64(AHEAD_S + 0.1 * window_s));
                self.act(stage, plate, tones, window_s)
            })?;
            let mirror = self.mirror_digest(&mut replay, window)?;
            windows.push(VerifiedWindow {
                stage: stage.name(),
                at_samples: digest.from,
                samples: digest.count,
                device_crc: digest.crc.map(hexadecimal),
                mirror_crc: hexadecimal(mirror),
                equal: digest.crc == Some(mirror),
            });
        }
        self.stop()?;
        Ok(Verified { equal: windows.iter().all(|window| window.equal), windows })
    }

    fn act(&self, stage: Stage, plate: &Plate, count: u8, window_s: f64) -> Result<(), ClientError> {
        let (start_m, end_m) = plate.span_m();
        let drive = |shift: f64| {
            let tones = (0..count)
                .map(|slot| {
                    let share = 0.05 + 0.8 * f64::from(slot) / f64::from(count) + 0.1 * shift;
                    ToneRequest {
                        slot,
                        boundary_m: start_m + share * (end_m - start_m),
                        level: 0.9 / f64::from(count),
                        phase_turns: f64::from(slot) / f64::from(count),
                    }
                })
                .collect();
            self.play(Sounding::Drive(DriveRequest::of(tones)))
        };
        match stage {
            Stage::Start => drop(drive(0.0)?),
            Stage::Steady => {}
            Stage::Drag => {
                for shift in [1.0, 0.3, 0.7] {
                    drive(shift)?;
                    self.pause(Duration::from_secs_f64(0.1 * window_s));
                }
            }
            Stage::Stop => drop(self.stop()?),
        }
        Ok(())
    }

    /// The CRC-32 of a past window, from the changes that the device has accepted.
    fn mirror_digest(&self, replay: &mut Replay, window: DigestWindow) -> Result<u32, ClientError> {
        // The status after the window contains the thermal fold-back up to its end.
        self.refresh()?;
        let snapshot = self.follow(replay)?;
        let crc = self.during(|| {
            replay.exact_codes(window.from, window.count).map(|codes| {
                let mut crc = CRC.digest();
                codes.for_each(|code| crc.update(&code.to_le_bytes()));
                crc.finalize()
            })
        })?;
        crc.ok_or_else(|| ClientError::NotComparable(snapshot.status.and_then(|status| status.first_fault)))
    }

    fn follow(&self, replay: &mut Replay) -> Result<Arc<Snapshot>, ClientError> {
        let snapshot = self.snapshot();
        let history = DeviceHistory::of(&snapshot).ok_or(ClientError::Gone)?;
        self.during(|| replay.follow(&history))?;
        Ok(snapshot)
    }
}

fn hexadecimal(crc: u32) -> String {
    format!("{crc:08x}")
}
