//! The sender of drives at sample indices.
//!
//! The device has room for one change ahead, at most 60 s ahead. A later one is kept back until there is room and time:
//! ```text
//! change 1 --sent--> accepted --begins at its index--> change 2 --sent--> ..
//! ```
//! It takes a round trip (some milliseconds) and the latest wake-up of this program from the beginning of one change until the
//! next one is accepted, so changes closer than that are late. A late drive is refused by the device; a late end becomes a stop at
//! once.

use super::client::{BlockingLink, Client};
use super::error::ClientError;
use crate::measure::is_late;
use slipline_link::protocol::command::Apply;
use slipline_link::protocol::limits::MAX_APPLY_AHEAD_MS;
use slipline_link::{Change, DriveRequest, Outcome, Sounding};

/// A change farther ahead than this is sent later; the device refuses it beyond [`MAX_APPLY_AHEAD_MS`].
const AHEAD_S: f64 = MAX_APPLY_AHEAD_MS as f64 / 1000.0 - 10.0;

/// A drive, chord or comb, and the sample index at which it begins.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedDrive {
    /// The index; the device rounds it up to a block.
    pub at: u64,
    /// What sounds from there on.
    pub sounding: Sounding,
}

impl TimedDrive {
    /// The end of what sounds: a drive without tones, so that it fades from this index on for `glide_s`, 5 ms to 10 s.
    #[must_use]
    pub fn end(at: u64, glide_s: f64) -> Self {
        let silence = DriveRequest { glide_s, ..DriveRequest::of(Vec::new()) };
        Self { at, sounding: Sounding::Drive(silence) }
    }
}

impl<W: BlockingLink> Client<W> {
    /// Plays a drive from its index on; returns, when the device has accepted it, the index at which it begins: the first of a
    /// block of 128. It is sent once no other change is ahead, and at most 60 s before. `None` if `goes_on` has ended the wait
    /// for that.
    ///
    /// # Errors
    /// [`ClientError::Refused`] if the index has passed, [`ClientError::Superseded`], those of [`Client::check_drives`] during
    /// the wait, and a request's error.
    pub fn play_at(
        &self,
        drive: TimedDrive,
        mut goes_on: impl FnMut() -> bool,
    ) -> Result<Option<u64>, ClientError> {
        if !self.await_change_ahead(&mut goes_on)? {
            return Ok(None);
        }
        let TimedDrive { at, sounding } = drive;
        let ahead = (AHEAD_S * f64::from(self.identity()?.sample_rate_hz)) as u64;
        let from = at.saturating_sub(ahead);
        if from > self.now_at_least() && !self.wait_until(from, goes_on)? {
            return Ok(None);
        }
        self.play(sounding.beginning(Apply::At(at))).map(Some)
    }

    /// Plays each of these drives from its index on, in this order; returns the indices at which they begin when the last one is
    /// accepted. `None` for those that `goes_on` or a newer drive has kept from being sent. After an error the device is stopped.
    ///
    /// # Errors
    /// Those of [`Client::play_at`].
    pub fn play_each(
        &self,
        drives: Vec<TimedDrive>,
        mut goes_on: impl FnMut() -> bool,
    ) -> Result<Vec<Option<u64>>, ClientError> {
        let mut began = Vec::new();
        let mut is_over = false;
        for drive in drives {
            let at = if is_over {
                None
            } else {
                match self.play_at(drive, &mut goes_on) {
                    Err(ClientError::Superseded) => None,
                    Err(error) => {
                        // The error is the reason; a device that is gone stops by itself.
                        let _ = self.stop();
                        return Err(error);
                    }
                    Ok(at) => at,
                }
            };
            is_over |= at.is_none();
            began.push(at);
        }
        Ok(began)
    }

    /// Ends what sounds at this sample index: it fades from there on for `glide_s`, 5 ms to 10 s. Returns, when the device has
    /// accepted it, the index at which the fade begins. If the index has passed, it stops at once. `None` if `goes_on` has ended
    /// the wait for an earlier change, or a newer drive or a stop took its place.
    ///
    /// # Errors
    /// Those of [`Client::play_at`], but for an index that has passed.
    pub fn stop_at(
        &self,
        at: u64,
        glide_s: f64,
        goes_on: impl FnMut() -> bool,
    ) -> Result<Option<u64>, ClientError> {
        match self.play_at(TimedDrive::end(at, glide_s), goes_on) {
            Err(ClientError::Refused(refusal)) if is_late(&Outcome::Refused(refusal.clone())) => {
                self.stop().map(Some)
            }
            Err(ClientError::Superseded) => Ok(None),
            found => found,
        }
    }

    /// Waits until a change has begun that a request has set for an index ahead, if there is one. Returns whether
    /// there is none any more: `false` if `goes_on` has ended the wait.
    ///
    /// # Errors
    /// Those of [`Client::check_drives`].
    pub(super) fn await_change_ahead(&self, mut goes_on: impl FnMut() -> bool) -> Result<bool, ClientError> {
        while let Some(at) = self.change_ahead() {
            let mut is_asked_to_end = false;
            let has_begun = self.wait_until(at, || {
                is_asked_to_end = !goes_on();
                // A stop drops it.
                !is_asked_to_end && self.change_ahead() == Some(at)
            })?;
            if is_asked_to_end {
                return Ok(false);
            }
            if has_begun {
                break;
            }
        }
        Ok(true)
    }

    /// The index at which the latest change is to begin, if it was sent for an index and has not begun by the latest status.
    fn change_ahead(&self) -> Option<u64> {
        let snapshot = self.snapshot();
        let latest = snapshot.record.journal.iter().rev().find_map(|entry| match &entry.change {
            Change::Play(played) => Some(matches!(played.apply(), Apply::At(_)).then_some(entry.at)),
            Change::Session | Change::Disarmed | Change::Stop | Change::EmergencyStop => Some(None),
            Change::Armed | Change::Table(_) | Change::Hold | Change::Limit(_) => None,
        });
        latest.flatten().filter(|&at| at > self.now_at_least())
    }

    /// The sample index of the latest status.
    fn now_at_least(&self) -> u64 {
        self.snapshot().drive.status.map_or(0, |status| status.now)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_link::protocol::event::State;
    use slipline_link::{BLOCK, DeviceTable, Port};
    use std::sync::Arc;

    fn armed() -> Client {
        let client = Client::new(None).unwrap();
        client.observe(&Port::Simulated).unwrap();
        let knots = (0..=100).map(|i| (30e3 - 100.0 * f64::from(i), 1.0));
        let table = DeviceTable::from_knots((0.0, 0.1), 400e3, knots, 1e-6).unwrap();
        client.use_table(Arc::new(table)).unwrap();
        client.arm().unwrap();
        client
    }

    fn tone(place_m: f64) -> Sounding {
        Sounding::Drive(DriveRequest::at(&[(place_m, 0.5)]))
    }

    #[test]
    fn drives_begin_at_the_first_block_at_or_after_their_indices() {
        let client = armed();
        let begin = client.refresh().unwrap() + 200_000;
        let drives = vec![
            TimedDrive { at: begin, sounding: tone(0.05) },
            TimedDrive { at: begin + 200_001, sounding: tone(0.06) },
            TimedDrive::end(begin + 400_000, 0.01),
        ];
        let blocks = drives.iter().map(|drive| Some(drive.at.next_multiple_of(BLOCK as u64)));
        let blocks = blocks.collect::<Vec<_>>();
        assert_eq!(client.play_each(drives, || true).unwrap(), blocks);
        client.wait_until(begin + 420_000, || true).unwrap();
        assert_eq!(client.snapshot().drive.status.unwrap().state, State::Armed);
    }

    #[test]
    fn a_change_ahead_is_awaited_unless_a_stop_drops_it() {
        let client = armed();
        let first = client.play(tone(0.05)).unwrap();
        let end = client.stop_at(first + 200_000, 0.02, || true).unwrap().unwrap();
        let second = client.play(tone(0.05)).unwrap();
        assert!(second > end, "{second} {end}");
        // Farther ahead than the device accepts: the call waits until its caller gives up.
        let far = TimedDrive { at: second + 400_000 * 3600, sounding: tone(0.06) };
        let mut looks = 0;
        let sent = client.play_at(far, || {
            looks += 1;
            looks < 3
        });
        assert_eq!(sent.unwrap(), None);
        let ahead = TimedDrive { at: second + 400_000 * 40, sounding: tone(0.06) };
        assert!(client.play_at(ahead, || true).unwrap().is_some());
        client.stop().unwrap();
        client.play(tone(0.05)).unwrap();
    }

    #[test]
    fn an_end_whose_index_has_passed_is_a_stop_now_and_a_drive_is_refused() {
        let client = armed();
        let began = client.play(tone(0.05)).unwrap();
        client.wait_until(began + 40_000, || true).unwrap();
        assert!(client.stop_at(began + 1, 0.02, || true).unwrap().unwrap() >= began + 40_000);
        let late = client.play_each(vec![TimedDrive { at: began, sounding: tone(0.06) }], || true);
        assert!(matches!(late, Err(ClientError::Refused(_))), "{late:?}");
    }
}
