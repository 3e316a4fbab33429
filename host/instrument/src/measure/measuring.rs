//! The steps of a measurement, without a clock and without a port.
//!
//! ```text
//! stop -> comb, silent (-96 dB) -> window: the noise
//!      -> stop -> comb -> settle -> window -> stop -> next comb ... -> stop
//!                                     \-> answers not clear? a longer window after it -> stop
//! ```
//! A comb whose window lost samples is measured again.

use super::answers::{Measured, Sensor, Window};
use super::dialogue::Dialogue;
use super::error::MeasureError;
use super::loudness::{self, Tone};
use super::plan::{Comb, Plan};
use super::procedure::{Evaluation, Procedure, evaluated};
use super::setback::{Tries, is_late};
use slipline_link::protocol::listen::InputsReport;
use slipline_link::{
    CombRequest, DeviceTable, HarmonicRequest, ListenRequest, Outcome, Request, Sounding, WindowShape,
};
use slipline_plate::calibrate::{MeasuredPoint, Measurement};
use slipline_plate::{Complex64, order};
use std::sync::Arc;

/// Master level of a silent comb: its amplitude is far below a code while its phases run.
pub(super) const SILENT_DB: f64 = -96.0;

/// A measurement.
pub struct Measuring {
    plan: Plan,
    table: Arc<DeviceTable>,
    sensor: Sensor,
    lag_s: f64,
    /// Factor on the level by which the tones stay within the DAC's linear part and the actuator's travel.
    scale: f64,
    quiet: Option<Window>,
    windows: Vec<Window>,
}

impl Measuring {
    /// A measurement with a device that must be armed and hold `table`; `inputs` is the device's report of
    /// its inputs.
    ///
    /// # Errors
    /// [`MeasureError::NoInputs`] if it does not have the sensor's input.
    pub fn new(
        plan: Plan,
        table: Arc<DeviceTable>,
        sensor: Sensor,
        inputs: &InputsReport,
    ) -> Result<Self, MeasureError> {
        let lag_s = sensor.lag_s(inputs, plan.rate_hz)?;
        Ok(Self { plan, table, sensor, lag_s, scale: 1.0, quiet: None, windows: Vec::new() })
    }

    /// Samples that it needs by its plan.
    pub(super) fn planned_samples(&self) -> u64 {
        self.plan.samples()
    }

    /// A measurement at the frequencies of its plan, without measured values yet.
    pub(super) fn planned(&self) -> Measurement {
        let combs = self.plan.combs.iter().flat_map(|comb| comb.frequencies_hz(self.plan.rate_hz));
        let mut points: Vec<MeasuredPoint> = combs
            .map(|frequency_hz| MeasuredPoint {
                frequency_hz,
                response: Complex64::ONE,
                noise: 1.0,
                headroom_db: None,
            })
            .collect();
        order::sort_by(&mut points, |a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
        Measurement::at(self.sensor.place_m, self.sensor.kind, points).by(self.sensor.body)
    }

    /// What the windows so far say.
    fn measured(&self, quiet: &Window) -> Measured {
        Measured::of(&self.sensor, self.plan.rate_hz, self.lag_s, quiet, &self.windows)
    }

    /// Measures one comb; with the first comb it measures the noise before, at the silent level.
    async fn window(&mut self, dialogue: &Dialogue, comb: &Comb) -> Result<Window, MeasureError> {
        let combs = self.plan.combs.iter().take(self.windows.len());
        let done: u64 = combs.map(|comb| self.plan.samples_of(comb)).sum();
        let done = done + self.quiet.as_ref().map_or(0, |_| self.plan.quiet_samples());
        // A silent comb need not settle.
        let settle = self.quiet.as_ref().map_or(0, |_| comb.settle_samples);
        let until_window = self.plan.rise_samples(comb) + settle;
        let mut tries = Tries::default();
        loop {
            dialogue.mark(done, self.plan.samples(), None);
            dialogue.stop().await?;
            let Self { plan, table, scale, .. } = self;
            let tones = |scale| loudness::tones(comb, &*table, plan.rate_hz, plan.level * scale);
            let is_silent = self.quiet.is_none();
            let (tones, at) = sounding(dialogue, comb, is_silent, &mut tries, scale, tones).await?;
            let running = (at, until_window + comb.window_samples());
            dialogue.mark(done, self.plan.samples(), Some(running));
            let input = self.sensor.input;
            let mut heard = listened(dialogue, comb, input, Some(at + until_window), 1).await;
            let Some(mut window) = windowed(comb, 1, &tones, &heard)? else {
                tries.lost(&heard)?;
                continue;
            };
            let wanted = self.quiet.as_ref().map_or(1, |quiet| window.wanted(quiet));
            let further = wanted.min(self.plan.windows_of(comb)) - 1;
            if further > 0 {
                // Its time is not in the plan: the progress waits.
                heard = listened(dialogue, comb, input, None, further).await;
                let Some(second) = windowed(comb, further, &tones, &heard)? else {
                    tries.lost(&heard)?;
                    continue;
                };
                window.extend(&second);
            }
            return Ok(window);
        }
    }
}

/// Plays a comb, at the silent level or as loud as the actuator's travel allows; `scale` falls until the device takes it. Returns its
/// tones and the sample at which they begin.
pub(super) async fn sounding(
    dialogue: &Dialogue,
    comb: &Comb,
    is_silent: bool,
    tries: &mut Tries,
    scale: &mut f64,
    tones: impl Fn(f64) -> Vec<Tone>,
) -> Result<(Vec<Tone>, u64), MeasureError> {
    loop {
        let tones = tones(*scale);
        let harmonics = comb.harmonics.iter().zip(&tones).map(|(&harmonic, tone)| HarmonicRequest {
            harmonic,
            level: tone.level,
            phase_turns: tone.phase_turns,
        });
        let comb = CombRequest {
            master_db: if is_silent { SILENT_DB } else { 0.0 },
            glide_s: comb.rise_s,
            ..CombRequest::of(comb.period_blocks, harmonics.collect())
        };
        let begun = dialogue.ask(Request::Play(Sounding::Comb(comb))).await;
        if let Outcome::Done { at } = begun {
            return Ok((tones, at));
        }
        *scale *= tries.quieter(&begun)?;
    }
}

/// Listens to this number of windows as one at an input, from a sample on. Where that has passed, or with `None`, from now on: all
/// tones that had settled at a missed sample have settled now.
pub(super) async fn listened(
    dialogue: &Dialogue,
    comb: &Comb,
    input: u8,
    from: Option<u64>,
    windows: u16,
) -> Outcome {
    let listen = |from| {
        Request::Listen(ListenRequest {
            from,
            blocks: windows * comb.period_blocks,
            shape: WindowShape::Rectangular,
            // One bit per tone, 16 at most.
            slots: u16::MAX >> (16 - comb.harmonics.len().clamp(1, 16)),
            input,
        })
    };
    let heard = dialogue.ask(listen(from)).await;
    if is_late(&heard) { dialogue.ask(listen(None)).await } else { heard }
}

/// This number of windows as one, from an outcome; `None` if it has none.
pub(super) fn windowed(
    comb: &Comb,
    windows: u16,
    tones: &[Tone],
    outcome: &Outcome,
) -> Result<Option<Window>, MeasureError> {
    let Outcome::Listened(listened) = outcome else { return Ok(None) };
    let answers = listened.answers.iter().take(tones.len()).flatten();
    let answers: Vec<Complex64> = answers.map(|&(re, im)| Complex64::new(re, im)).collect();
    if answers.len() < tones.len() {
        return Err(MeasureError::Stopped);
    }
    let (samples, span) = (u64::from(windows) * comb.window_samples(), (listened.lowest, listened.highest));
    Ok(Some(Window { tones: tones.to_vec(), answers, samples, span }))
}

impl Procedure for Measuring {
    type Found = Measured;

    async fn carry_out(mut self, dialogue: Dialogue) -> Result<Evaluation<Measured>, MeasureError> {
        self.scale = dialogue.linear_scale(self.plan.level);
        while let Some(comb) = self.plan.combs.get(self.windows.len()).cloned() {
            let window = self.window(&dialogue, &comb).await?;
            match &self.quiet {
                None => self.quiet = Some(window),
                Some(quiet) => {
                    self.windows.push(window);
                    dialogue.heard(self.measured(quiet).measurement);
                }
            }
        }
        dialogue.stop().await?;
        let measured = self.measured(self.quiet.as_ref().ok_or(MeasureError::Cancelled)?);
        measured.measurement.check()?;
        Ok(evaluated(measured))
    }
}

#[cfg(test)]
mod tests;
