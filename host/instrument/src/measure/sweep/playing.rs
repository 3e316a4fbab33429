//! The steps that play a sweep twice.
//!
//! ```text
//! stop -> table of the sweep -> silent tone -> glide -> silent tone -> glide -> codes that were played -> stop
//!      -> the device's own table
//! ```
//! It needs no inputs. At the end the codes that the device has played are compared with those that the description gives.

use super::codes::{Codes, SILENT_S};
use super::played::PlayedSweep;
use super::table;
use crate::measure::error::MeasureError;
use crate::measure::procedure::{self, Procedure, Step};
use slipline_link::{DeviceTable, Outcome, Request, Snapshot};
use std::sync::Arc;

/// How often it is begun anew.
const TRIES: u32 = 4;
/// How much longer the host may take for a request at last: twice as long at each try.
const LEADS: f64 = 8.0;
/// How often the device is asked how far it is until its codes are known.
const LOOKS: u32 = 400;

/// Where it stands. The first tone begins at sample `from`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    /// Whatever sounds is stopped.
    Silence,
    /// The device gets the table of the sweep.
    Table,
    /// The time of a drive is awaited.
    Until {
        from: u64,
        number: usize,
    },
    /// A drive of the score.
    Play {
        from: u64,
        number: usize,
    },
    /// The end is awaited, and the codes.
    Codes {
        from: u64,
        looks: u32,
    },
    /// The last stop.
    Ending,
    /// The device gets its table back.
    Restore,
    Ended,
}

/// A sweep that is played for a recorder, under way. It ends in its description.
pub struct Playing {
    sweep: PlayedSweep,
    /// The plate's own.
    table: Arc<DeviceTable>,
    /// The sweep's.
    swept: Arc<DeviceTable>,
    stage: Stage,
    is_asked: bool,
    /// Whether the device may hold the sweep's table.
    is_changed: bool,
    lead_s: f64,
    tries: u32,
    now: u64,
    replay: Codes,
    codes: Vec<u16>,
    error: Option<MeasureError>,
}

impl Playing {
    /// A sweep that begins with the next step. The device must be armed and hold `table`.
    ///
    /// # Errors
    /// A table that no device takes.
    pub fn new(sweep: PlayedSweep, table: Arc<DeviceTable>) -> Result<Self, MeasureError> {
        let rate_hz = sweep.chirp.rate_hz;
        let swept = table::with_gains(&sweep.chirp, &sweep.gains, table.peak_at_full_scale_m())?;
        // Beside the sweeps, as a slow host gets them, two seconds of what was before and after them.
        let longest = sweep.clone().with_lead(LEADS * sweep.lead as f64 / rate_hz).end();
        Ok(Self {
            swept: Arc::new(swept.with_travel_limit_of(&table)),
            lead_s: sweep.lead as f64 / rate_hz,
            replay: Codes::new(longest + 2 * rate_hz as u64),
            sweep,
            table,
            stage: Stage::Silence,
            is_asked: false,
            is_changed: false,
            tries: 0,
            now: 0,
            codes: Vec::new(),
            error: None,
        })
    }

    /// When a drive may be sent: when the one before it is over.
    fn sent_from(&self, number: usize) -> u64 {
        let score = self.sweep.score();
        number.checked_sub(1).map_or(0, |before| score[before].at + score[before].glide)
    }

    fn begin_anew(&mut self, error: MeasureError) {
        self.tries += 1;
        if self.tries >= TRIES {
            self.fail(error);
        } else {
            self.stage = Stage::Silence;
        }
    }

    /// Takes the codes of both sweeps, once they are known.
    fn take_codes(&mut self, from: u64, looks: u32) {
        let count = self.sweep.end();
        if self.now <= from + count {
            return;
        }
        if let Some(codes) = self.replay.played(from, count) {
            self.codes = codes;
            self.stage = Stage::Ending;
        } else if looks >= LOOKS {
            self.fail(MeasureError::Unknown);
        } else {
            self.stage = Stage::Codes { from, looks: looks + 1 };
        }
    }

    fn fail(&mut self, error: MeasureError) {
        self.error.get_or_insert(error);
        self.stage = Stage::Ending;
        self.is_asked = false;
    }

    /// Whether it only tidies up.
    const fn is_ending(&self) -> bool {
        matches!(self.stage, Stage::Ending | Stage::Restore | Stage::Ended)
    }
}

impl Procedure for Playing {
    type Found = PlayedSweep;

    fn step(&mut self) -> Step {
        match self.stage {
            Stage::Until { from, number } if !self.is_asked && self.now > from + self.sent_from(number) => {
                self.stage = Stage::Play { from, number };
            }
            Stage::Codes { from, looks } if !self.is_asked => self.take_codes(from, looks),
            Stage::Silence
            | Stage::Table
            | Stage::Until { .. }
            | Stage::Play { .. }
            | Stage::Codes { .. }
            | Stage::Ending
            | Stage::Restore
            | Stage::Ended => {}
        }
        if self.stage == Stage::Ended {
            return Step::Ended;
        }
        if std::mem::replace(&mut self.is_asked, true) {
            return Step::Wait;
        }
        Step::Ask(match self.stage {
            Stage::Silence | Stage::Ending | Stage::Ended => Request::Stop,
            Stage::Table => {
                self.is_changed = true;
                Request::Upload(self.swept.clone())
            }
            Stage::Play { from, number } => {
                self.sweep.score()[number].request(self.sweep.chirp.rate_hz, from)
            }
            Stage::Until { .. } | Stage::Codes { .. } => Request::Refresh,
            Stage::Restore => Request::Upload(self.table.clone()),
        })
    }

    fn take(&mut self, outcome: &Outcome) {
        self.is_asked = false;
        match (self.stage, outcome) {
            (Stage::Ending, _) if self.is_changed => self.stage = Stage::Restore,
            (Stage::Ending | Stage::Restore | Stage::Ended, other) => {
                if !matches!(other, Outcome::Done { .. }) {
                    self.error.get_or_insert(procedure::ended_by(other));
                }
                self.stage = Stage::Ended;
            }
            (Stage::Silence, Outcome::Done { .. }) => self.stage = Stage::Table,
            (Stage::Table, Outcome::Done { at }) => {
                self.stage =
                    Stage::Play { from: self.sweep.chirp.after((*at).max(self.now), SILENT_S), number: 0 };
            }
            (Stage::Play { from, number }, Outcome::Done { .. }) => {
                let next = number + 1;
                self.stage = if next < self.sweep.score().len() {
                    Stage::Until { from, number: next }
                } else {
                    Stage::Codes { from, looks: 0 }
                };
            }
            // The next step looks at the time.
            (Stage::Until { .. } | Stage::Codes { .. }, Outcome::Done { .. }) => {}
            (Stage::Play { .. }, late) if procedure::is_late(late) => {
                self.lead_s *= 2.0;
                self.sweep = self.sweep.clone().with_lead(self.lead_s);
                self.begin_anew(procedure::ended_by(late));
            }
            (Stage::Play { .. }, other) => match procedure::quieter(other) {
                Some(share) => {
                    self.sweep.level *= share;
                    self.begin_anew(procedure::ended_by(other));
                }
                None => self.fail(procedure::ended_by(other)),
            },
            (_, other) => self.fail(procedure::ended_by(other)),
        }
    }

    fn watch(&mut self, snapshot: &Snapshot) {
        self.replay.follow(snapshot);
        self.now = snapshot.status.map_or(self.now, |status| status.now);
        let trouble = procedure::trouble(&mut self.error, snapshot);
        if let Some(trouble) = trouble.filter(|_| !self.is_ending()) {
            self.fail(trouble);
        }
    }

    fn cancel(&mut self) {
        if !self.is_ending() {
            self.fail(MeasureError::Cancelled);
        }
    }

    fn progress(&self, now: u64) -> f64 {
        match self.stage {
            Stage::Silence | Stage::Table => 0.0,
            Stage::Until { from, .. } | Stage::Play { from, .. } | Stage::Codes { from, .. } => {
                (now.saturating_sub(from) as f64 / self.sweep.end() as f64).min(1.0)
            }
            Stage::Ending | Stage::Restore | Stage::Ended => 1.0,
        }
    }

    fn finish(self) -> Result<PlayedSweep, MeasureError> {
        if let Some(error) = self.error {
            return Err(error);
        }
        if self.codes.is_empty() {
            return Err(MeasureError::Cancelled);
        }
        if self.codes == self.sweep.rendered()? { Ok(self.sweep) } else { Err(MeasureError::TurnedDown) }
    }
}
