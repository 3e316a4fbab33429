//! The steps that play a sweep twice.
//!
//! ```text
//! stop -> table of the sweep -> silent tone -> glide -> silent tone -> glide -> codes that were played -> stop
//!      -> the device's own table
//! ```
//! It needs no inputs. At the end the played codes are compared with those that the description determines.

use super::played::PlayedSweep;
use super::table;
use crate::measure::codes::SILENT_S;
use crate::measure::dialogue::Dialogue;
use crate::measure::error::MeasureError;
use crate::measure::procedure::{Evaluation, Procedure};
use crate::measure::setback::{Tries, ended_by, is_late, quieter};
use slipline_link::{DeviceTable, Outcome};
use std::sync::Arc;

/// Largest extension of the time for the host's requests; the time doubles at each attempt.
const LEADS: f64 = 8.0;

/// Procedure that plays a sweep for a recorder; its result is the description.
pub struct Playing {
    sweep: PlayedSweep,
    /// The plate's table.
    table: Arc<DeviceTable>,
    /// The sweep's table.
    swept: Arc<DeviceTable>,
    lead_s: f64,
    tries: Tries,
}

impl Playing {
    /// A procedure with a device that must be armed and hold `table`.
    ///
    /// # Errors
    /// The table of the sweep is not valid for a device.
    pub fn new(sweep: PlayedSweep, table: Arc<DeviceTable>) -> Result<Self, MeasureError> {
        let swept = table::with_gains(&sweep.chirp, &sweep.gains, table.peak_at_full_scale_m())?;
        let swept = Arc::new(swept.with_travel_limit_of(&table));
        let lead_s = sweep.lead as f64 / sweep.chirp.rate_hz;
        Ok(Self { sweep, table, swept, lead_s, tries: Tries::default() })
    }

    /// Plays the whole sequence and returns the codes of both sweeps; `None` if it must be repeated.
    async fn play(&mut self, dialogue: &Dialogue) -> Result<Option<Vec<u16>>, MeasureError> {
        dialogue.mark(0, 1, None);
        dialogue.stop().await?;
        let at = dialogue.lend(&self.swept, &self.table).await?;
        let from = self.sweep.chirp.after(at.max(dialogue.now()), SILENT_S);
        dialogue.mark(0, self.sweep.end(), Some((from, self.sweep.end())));
        let mut sent_from = None;
        for step in self.sweep.score() {
            // A drive may be sent when the previous one is over.
            if let Some(over) = sent_from.replace(from + step.at + step.glide) {
                dialogue.past(over).await?;
            }
            let outcome = dialogue.ask(step.request(self.sweep.chirp.rate_hz, from)).await;
            if matches!(outcome, Outcome::Done { .. }) {
                continue;
            }
            if is_late(&outcome) {
                self.lead_s *= 2.0;
                self.sweep = self.sweep.clone().with_lead(self.lead_s);
            } else {
                self.sweep.level *= quieter(&outcome).ok_or_else(|| ended_by(&outcome))?;
            }
            self.tries.again(ended_by(&outcome))?;
            return Ok(None);
        }
        dialogue.codes(from, self.sweep.end()).await.map(Some)
    }
}

impl Procedure for Playing {
    type Found = PlayedSweep;

    async fn carry_out(mut self, dialogue: Dialogue) -> Result<Evaluation<PlayedSweep>, MeasureError> {
        self.sweep.level *= dialogue.linear_scale(self.sweep.level);
        let rate_hz = self.sweep.chirp.rate_hz;
        // The sweeps with the longest lead, and two seconds of codes around them.
        let longest = self.sweep.clone().with_lead(LEADS * self.lead_s).end();
        dialogue.replay(longest + 2 * rate_hz as u64);
        loop {
            if let Some(codes) = self.play(&dialogue).await? {
                dialogue.stop().await?;
                let sweep = self.sweep;
                let as_played = move || {
                    if codes == sweep.rendered()? { Ok(sweep) } else { Err(MeasureError::TurnedDown) }
                };
                return Ok(Box::new(as_played));
            }
        }
    }
}
