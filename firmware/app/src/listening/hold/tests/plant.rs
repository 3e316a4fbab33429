//! A plate of one pole, in time, with a hold around it.

extern crate std;

use super::super::*;
use super::{MIN_GLIDE, SET_CODES, SPAN, setting, tone};
use core::f64::consts::PI;

/// Steps of the simulation in a period.
pub(super) const STEPS: usize = 40;
const PERIOD: u32 = 40_000;
pub(super) const SLOT: usize = 3;

/// The true plate, and the time constant that the hold assumes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Truth {
    /// The time constant in the hold's setting, in periods.
    pub(super) assumed_tau: f64,
    /// The true time constant, in parts of the assumed one.
    pub(super) tau: f64,
    /// Its amplitude at the table's level, in parts of the set one.
    pub(super) gain: f64,
    /// Exponent of the plate's amplitude as a power of the drive's; 1 for a linear plate.
    pub(super) power: f64,
    /// Periods between the end of a window and the glide: a quarter, with the window, the glide and the hold of half a
    /// period, a quarter and half a period, makes a delay of 1.5.
    pub(super) lead: f64,
}

pub(super) const NOMINAL: Truth = Truth { assumed_tau: 1.0, tau: 1.0, gain: 1.0, power: 1.0, lead: 0.25 };

pub(super) struct Rig {
    truth: Truth,
    pub(super) hold: Hold,
    /// The sum of the tones that are not held, Q1.31.
    others: u64,
    /// The plate's amplitude over the set one, now, and since the last [`Rig::forget`] in dB.
    part: f64,
    pub(super) trace: std::vec::Vec<f64>,
    /// The glide under way: levels in parts of the table's, and the step it begins at.
    from: f64,
    to: f64,
    begin: usize,
    next: Option<(usize, f64)>,
    now: usize,
    sum: f64,
    /// Since then, the largest sum of all tones that was published, in parts of full scale, and the largest change in octaves.
    pub(super) loudest: f64,
    pub(super) steepest: f64,
}

fn level_of(hold: &Hold) -> f64 {
    (f64::from(hold.correction(SLOT).expect("held").0) / 65_536.0).exp2()
}

impl Rig {
    /// A plate that has followed the drive for long.
    pub(super) fn new(truth: Truth, slew: Octaves, room_db: f64) -> Self {
        let samples = (truth.assumed_tau * f64::from(PERIOD)) as u32;
        let setting = LoopSetting { period: PERIOD, slew, ..setting(samples) };
        let tone = tone(SLOT as u8);
        let hold = Hold::new(&setting, &[tone], MIN_GLIDE).expect("it can be held");
        // The other tones leave room for a rise of `room_db` of this one.
        let raised = f64::from(tone.level.0) * 10_f64.powf(room_db / 20.0);
        let others = (f64::from(Gain::FULL.0) - raised) as u64;
        Self {
            truth,
            hold,
            others,
            part: truth.gain,
            trace: std::vec::Vec::new(),
            from: 1.0,
            to: 1.0,
            begin: 0,
            next: None,
            now: 0,
            sum: 0.0,
            loudest: 0.0,
            steepest: 0.0,
        }
    }

    fn level(&self) -> f64 {
        let past = (self.now - self.begin) as f64 / (STEPS / 2) as f64;
        self.from + (self.to - self.from) * (0.5 - 0.5 * (PI * past.min(1.0)).cos())
    }

    /// Runs for some periods, `finger` what it leaves of the amplitude.
    pub(super) fn run(&mut self, periods: f64, finger: f64) {
        let tau = self.truth.assumed_tau * self.truth.tau * STEPS as f64;
        let share = 1.0 - (-1.0 / tau.max(1e-9)).exp();
        for _ in 0..(periods * STEPS as f64) as usize {
            if let Some((begin, to)) = self.next.take_if(|(begin, _)| *begin == self.now) {
                (self.from, self.to, self.begin) = (self.level(), to, begin);
            }
            let goal = self.truth.gain * finger * self.level().powf(self.truth.power);
            self.part += share * (goal - self.part);
            self.trace.push(20.0 * self.part.log10());
            self.sum += self.part;
            self.now += 1;
            if self.now.is_multiple_of(STEPS) {
                self.end_window();
            }
        }
    }

    fn end_window(&mut self) {
        let mut amplitudes = [None; TONES];
        amplitudes[SLOT] = Some((self.sum / STEPS as f64 * SET_CODES * 256.0) as u32);
        self.sum = 0.0;
        let table = f64::from(tone(0).level.0);
        let held = (table * level_of(&self.hold)).ceil() as u64;
        let before = level_of(&self.hold);
        let room = Room::in_headroom(held, self.others);
        let step = self.hold.take(Some(&Answers { span: SPAN, amplitudes }), room);
        if let HoldAction::Publish(levels) = step {
            self.hold.accepted();
            let level = levels[SLOT].expect("held").0;
            let sum = (self.others + u64::from(level)) as f64 / f64::from(Gain::FULL.0);
            self.loudest = self.loudest.max(sum);
            self.steepest = self.steepest.max((level_of(&self.hold) / before).log2().abs());
            let begin = self.now + (self.truth.lead * STEPS as f64) as usize;
            self.next = Some((begin, f64::from(level) / table));
        }
    }

    /// Periods since [`Rig::forget`] after which the amplitude was never further than 1 dB from `level_db`.
    pub(super) fn settled_after(&self, level_db: f64) -> f64 {
        let last = self.trace.iter().rposition(|db| (db - level_db).abs() > 1.0);
        last.map_or(0.0, |last| (last + 1) as f64 / STEPS as f64)
    }

    pub(super) fn highest(&self) -> f64 {
        self.trace.iter().copied().fold(f64::MIN, f64::max)
    }

    pub(super) fn lowest(&self) -> f64 {
        self.trace.iter().copied().fold(f64::MAX, f64::min)
    }

    pub(super) fn last(&self) -> f64 {
        self.trace.last().copied().expect("it has run")
    }

    pub(super) fn forget(&mut self) {
        self.trace.clear();
        (self.loudest, self.steepest) = (0.0, 0.0);
    }
}
