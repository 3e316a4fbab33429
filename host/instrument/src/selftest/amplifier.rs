//! The amplifier on its plate: silent while the device mutes it, and at an input while it does not. An inverted mute is silent
//! in every drive and on in every fault.

use super::course::{Course, reading};
use super::limits::{SHOWN_DB, step};
use super::noise::line_powers;
use super::report::StepResult;
use super::verdict::Verdict;
use crate::measure::MeasureError;
use slipline_link::protocol::board::PinLevel;

/// Codes in which the tones are looked for, in blocks of 128: one period of the comb, 20.5 ms at 400 kS/s, as sums of two.
const BLOCKS: u16 = 64;
const LOG2_CODES: u8 = 1;
/// The tones, in multiples of the comb's 48.8 Hz: an actuator and its sensor pass some of 146 Hz to 40 kHz.
const HARMONICS: [u16; 7] = [3, 8, 20, 51, 128, 320, 820];
/// The sum of their levels: -40 dB.
const LEVEL: f64 = 0.01;
/// Lines on each side of a tone whose middle power is the noise. No other tone is so near.
const NEIGHBOURS: usize = 2;
/// The least noise of a code, that of its rounding: 1/12 of its square.
const ROUNDING: f64 = 1.0 / 12.0;
/// Time that an amplifier takes to settle after its mute pin has risen, seconds.
const SETTLED_S: f64 = 0.2;
/// Time after which the mute pin of a disarmed device must be low, seconds: it switches the amplifier off within some milliseconds.
const MUTED_S: f64 = 0.02;

/// The power of one tone at an input and that of the noise beside it, in any unit.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Received {
    tone: f64,
    noise: f64,
}

impl Course {
    /// The steps with an amplifier: those that drive no more than it bears.
    pub(super) async fn with_amplifier(&self) -> Result<Vec<StepResult>, MeasureError> {
        if self.inputs.inputs == 0 {
            return Err(MeasureError::NoInputs);
        }
        let (since, link_before) = (self.moment().await?, self.link_record());
        self.board_or_none().await?;
        let supply = self.supply();
        let mut levels: Vec<PinLevel> = vec![self.mute_level_or_none().await?];
        let amplifier = self.step(step::AMPLIFIER, self.amplifier(&mut levels)).await?;
        if amplifier.verdict == Verdict::Skipped {
            // The user requested this step alone.
            return Err(MeasureError::TooOld);
        }
        self.dialogue.disarm().await?;
        self.idle().await?;
        self.dialogue.past(self.dialogue.now() + self.samples(MUTED_S)).await?;
        levels.push(self.mute_level_or_none().await?);
        let mute = self.mute(&levels);
        let link = StepResult::judged(step::LINK, self.link(&link_before), "The device answers in time.");
        let clocks = self.step(step::CLOCKS, self.clocks(since)).await?;
        let done = [clocks, supply, mute, link, amplifier];
        let skipped = "The amplifier is connected: this step belongs to the test without it.";
        let of = |name: &&str| done.iter().find(|result| result.name == **name).cloned();
        Ok(step::ALL
            .iter()
            .map(|name| of(name).unwrap_or_else(|| StepResult::skipped(name, skipped)))
            .collect())
    }

    /// Plays quiet tones with the amplifier muted and then on.
    async fn amplifier(&self, levels: &mut Vec<PinLevel>) -> Result<StepResult, MeasureError> {
        let name = step::AMPLIFIER;
        self.begin().await?;
        let muted = self.received().await?;
        levels.push(self.mute_level().await?);
        self.dialogue.disarm().await?;
        self.idle().await?;
        let ready = self.dialogue.arm(true).await?;
        self.dialogue.past(ready + self.samples(SETTLED_S)).await?;
        let on = self.received().await?;
        self.dialogue.disarm().await?;
        let Some((over_noise_db, rise_db)) = compared(&muted, &on) else {
            return Ok(StepResult::failed(name, "The device captured nothing."));
        };
        let mut readings = vec![reading(name, "tone over noise", over_noise_db)];
        if over_noise_db >= SHOWN_DB {
            readings.push(reading(name, "rise by unmuting", rise_db));
        }
        let good = "The amplifier is silent while the device mutes it, and on while it drives.";
        Ok(StepResult::judged(name, readings, good))
    }

    /// What each input receives of each tone.
    async fn received(&self) -> Result<Vec<Received>, MeasureError> {
        let level = LEVEL.min(self.most) / HARMONICS.len() as f64;
        let risen = self.comb(BLOCKS, HARMONICS.map(|harmonic| (harmonic, level))).await?;
        let values = (BLOCKS * slipline_link::BLOCK as u16) >> LOG2_CODES;
        let mut received = Vec::new();
        for input in 0..self.inputs.inputs {
            let captured = self.capture_of(input, risen, LOG2_CODES, values, false).await?;
            received.extend(received_in(captured.codes().collect()));
        }
        self.dialogue.stop().await?;
        Ok(received)
    }
}

/// Each tone in these codes, one period of the comb.
fn received_in(codes: Vec<f64>) -> impl Iterator<Item = Received> {
    let floor = ROUNDING * codes.len() as f64;
    let power = line_powers(&codes);
    HARMONICS.into_iter().map(move |harmonic| {
        let at = usize::from(harmonic);
        let line = |at: usize| power.get(at).copied().unwrap_or_default();
        let beside = (1..=NEIGHBOURS).flat_map(|away| [line(at - away), line(at + away)]);
        let mut beside: Vec<f64> = beside.collect();
        beside.sort_by(f64::total_cmp);
        let noise = beside[NEIGHBOURS - 1..=NEIGHBOURS].iter().sum::<f64>() / 2.0;
        Received { tone: line(at), noise: noise.max(floor) }
    })
}

/// Of the tone that stands out most, muted or on: its power over the noise, and its power while the amplifier is on over that while it
/// is muted, both in dB; `None` without any.
fn compared(muted: &[Received], on: &[Received]) -> Option<(f64, f64)> {
    let db = |share: f64| 10.0 * share.max(1e-30).log10();
    let pairs = muted.iter().zip(on);
    let of_pair = |(muted, on): (&Received, &Received)| {
        let noise = muted.noise.max(on.noise);
        let over_noise = muted.tone.max(on.tone) / noise;
        (db(over_noise), db(on.tone.max(noise) / muted.tone.max(noise)))
    };
    pairs.map(of_pair).max_by(|one, other| one.0.total_cmp(&other.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_plate::truth::Random;
    use std::f64::consts::TAU;

    /// One period of the comb at an input that gets a share of each tone, with noise of a code.
    fn codes(shares: [f64; 7]) -> Vec<f64> {
        let mut random = Random::new(3);
        (0..4096)
            .map(|n| {
                let turns = f64::from(n) / 4096.0;
                let tones = HARMONICS.iter().zip(shares);
                let tones = tones.map(|(harmonic, share)| share * (TAU * f64::from(*harmonic) * turns).sin());
                (2048.0 + tones.sum::<f64>() + random.normal()).round()
            })
            .collect()
    }

    fn db(muted: [f64; 7], on: [f64; 7]) -> (f64, f64) {
        let received = |shares| received_in(codes(shares)).collect::<Vec<_>>();
        compared(&received(muted), &received(on)).unwrap()
    }

    #[test]
    fn the_loudest_tone_shows_whether_unmuting_lets_it_pass() {
        let (none, one) = ([0.0; 7], [0.0, 0.0, 0.0, 0.0, 5.0, 0.1, 0.0]);
        let (over_noise, rise) = db(none, one);
        // 5 codes over noise of 1: 5^2 / 4 * 4096^2 over 4096.
        assert!((over_noise - 44.0).abs() < 8.0 && (rise - over_noise).abs() < 8.0, "{over_noise} {rise}");
        let (over_noise, rise) = db(one, none);
        assert!(over_noise > 36.0 && rise < -30.0, "an inverted mute: {over_noise} {rise}");
        let (over_noise, rise) = db(one, one);
        assert!(over_noise > 36.0 && rise.abs() < 2.0, "a mute without effect: {over_noise} {rise}");
        let (over_noise, _) = db(none, none);
        assert!(over_noise < SHOWN_DB, "noise alone: {over_noise}");
    }
}
