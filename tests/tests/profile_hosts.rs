//! Random hosts against the actuator's profile, in front of a model of the actuator: amplitude, travel, rise and time.

mod amplitude;
mod statistics;

use crate::profile::{armed, flash_with, plain};
use proptest::prelude::*;
use slipline_link::simulator::{Options, SimulatedDevice, SimulatedInputs};
use slipline_protocol::command::{Apply, ArmLease, Chord, Comb, Drive, ProfileSetting, TravelSetting};
use slipline_protocol::event::{Event, State};
use slipline_protocol::hold::{HoldSetting, HoldTone};
use slipline_protocol::limits::{
    DEAD_MAN_MS, DEAD_MAN_RAMP_MS, DESK_STOP_MS, EMERGENCY_RAMP_MS, HAND_MS, HOLD_PAUSE_BLOCKS, STOP_RAMP_MS,
};
use slipline_protocol::profile::{ActuatorProfile, TravelLimit};
use slipline_protocol::refusal::Field;
use slipline_protocol::units::CentiDecibel;
use slipline_protocol::{Command, Refusal};
use slipline_tests::client::Client;
use slipline_tests::mass_on_a_spring::{FULL, travel};
use slipline_tests::measure::peak;
use slipline_tests::rig::{BLOCK, MID, Rig, Table, chord, comb, drive};

const RESONANCE_HZ: f64 = 30_000.0;
const QUALITY: f64 = 4.0;
/// Samples, long enough for the actuator to follow.
const GLIDE: u32 = 2000;
const UNLIMITED: Command = Command::SetTravelLimit(TravelSetting { limit: None });

/// An actuator with a resonance in the middle of the usual table; `static_travel` as a share of the peak travel.
fn resonator(static_travel: f64) -> TravelLimit {
    TravelLimit {
        resonance_uhz: (RESONANCE_HZ * 1e6) as u64,
        quality_per_mille: (QUALITY * 1e3) as u32,
        static_ppm: (static_travel * 1e6) as u32,
    }
}

/// Its profile.
fn resonant(max_sum_per_mille: u16, static_travel: f64) -> ActuatorProfile {
    ActuatorProfile { max_sum_per_mille, travel: Some(resonator(static_travel)), ..plain() }
}

/// Something that a host or its user does with these random numbers from 0 to 1.
#[derive(Clone, Debug)]
struct Act {
    kind: u8,
    minor: u8,
    place: f64,
    level: f64,
    other: f64,
    pause: f64,
}

fn acts() -> impl Strategy<Value = Vec<Act>> {
    let act = (0u8..25, 0u8..=3, 0.0..1.0, 0.0..1.0, 0.0..1.0, 0.0..1.0).prop_map(
        |(kind, minor, place, level, other, pause)| Act { kind, minor, place, level, other, pause },
    );
    prop::collection::vec(act, 1..20)
}

/// A drive that the device has accepted: its earliest begin, the index until which it may begin later because it waits for the trigger
/// input, the index from which it alone is in force if that is known, and the sum of its levels.
struct Accepted {
    begin: u64,
    waits_until: u64,
    alone: Option<u64>,
    sum: f64,
}

/// A host with its user in front of a device with a profile, and what their acts allow the device to do, judged by its codes alone.
struct Bench {
    rig: Rig,
    profile: ActuatorProfile,
    minor: u8,
    /// `Some`: the host arms on this lease.
    lease_ms: Option<u32>,
    drives: Vec<Accepted>,
    /// Where the lease may have begun again.
    leases: Vec<u64>,
    /// Where the last press of the button began, while it lasts.
    pressed: Option<u64>,
    /// Stretches in which nothing may sound.
    silences: Vec<(u64, u64)>,
}

impl Bench {
    fn new(rig: Rig, profile: ActuatorProfile, minor: u8, lease_ms: Option<u32>) -> Self {
        let (drives, leases, silences) = (vec![], vec![], vec![]);
        let mut bench = Self { rig, profile, minor, lease_ms, drives, leases, pressed: None, silences };
        bench.arm();
        bench.rig.record();
        bench
    }

    fn arm(&mut self) {
        let command = self.lease_ms.map_or(Command::Arm, |lease_ms| Command::ArmFor(ArmLease { lease_ms }));
        if self.rig.send(&command).accepted_at().is_some() {
            self.leases.push(self.rig.device.now());
        }
    }

    fn play(&mut self, command: &Command, glide: u32, waits: bool, sum: f64) {
        let (begin, until) = match self.rig.send(command) {
            // A host of an older minor does not learn of a glide that takes longer.
            Event::Accepted(accepted) if self.minor < 3 => {
                (accepted.at, accepted.at + self.rig.samples(5000))
            }
            Event::Accepted(accepted) => (accepted.at, accepted.at + u64::from(glide)),
            Event::AcceptedUntil(accepted) => (accepted.at, accepted.until),
            _ => return,
        };
        // It takes the place of what has not ended until then.
        for before in &mut self.drives {
            before.alone = before.alone.map(|alone| if alone > begin { alone.max(until) } else { alone });
        }
        let (waits_until, alone) = if waits { (u64::MAX, None) } else { (begin, Some(until)) };
        self.drives.push(Accepted { begin, waits_until, alone, sum });
    }

    fn apply(&self, act: &Act) -> Apply {
        match act.kind {
            0..=3 => Apply::Next,
            4..=6 => Apply::At(self.rig.device.now() + (act.place * 4.0 * self.second()) as u64),
            _ => Apply::AtTrigger,
        }
    }

    fn second(&self) -> f64 {
        f64::from(self.rig.samples(1000) as u32)
    }

    /// Whether a hand on the board allows what a host alone must not do.
    fn has_hand(&self) -> bool {
        let now = self.rig.device.now();
        self.pressed.is_some_and(|since| now < since + self.rig.samples(HAND_MS))
    }

    /// Carries out what an act says, whatever the device answers, and lets time pass. Returns whether the device is still there.
    fn perform(&mut self, act: &Act, longest_pause_ms: f64) -> Result<bool, TestCaseError> {
        let &Act { kind, minor, place, level, other, pause } = act;
        let glide = GLIDE.max(self.rig.samples(5) as u32);
        let now = self.rig.device.now();
        match kind {
            0 | 4 | 7 => {
                let tones = [(0, place, level * 0.7), (1, other, level * other)];
                let drive = Drive { apply: self.apply(act), ..drive(&tones, glide) };
                self.play(&Command::Drive(drive), glide, kind == 7, level * 0.7 + level * other);
            }
            // Quiet, so that a hold has room to rise.
            1 | 5 => {
                let drive = Drive { apply: self.apply(act), ..drive(&[(0, place, level * 0.1)], glide) };
                self.play(&Command::Drive(drive), glide, false, level * 0.1);
            }
            2 | 8 => {
                // Multiples of 390.6 Hz at 400 kS/s: 20 to 60 kHz.
                let harmonic = 52 + (place * 100.0) as u16;
                let tones = [(harmonic, level, 0.0), (52 + (other * 100.0) as u16, other, 0.5)];
                let chord = Chord { apply: self.apply(act), ..chord(10, &tones) };
                self.play(&Command::Chord(chord), 2000, kind == 8, level + other);
            }
            3 | 6 => {
                let tones = [(100 + (place * 200.0) as u16, level, 0.0), (200, other * 0.3, 0.25)];
                let comb = Comb { apply: self.apply(act), ..comb(16, &tones) };
                self.play(&Command::Comb(comb), 2000, false, level + other * 0.3);
            }
            9 => {
                self.rig.send(if level < 0.5 { &Command::Stop } else { &Command::EmergencyStop });
                self.rig.live_ms(2 * STOP_RAMP_MS);
                self.is_silent_after(now, STOP_RAMP_MS);
                self.rig.send(&Command::ClearFaults);
                self.arm();
            }
            10 => {
                self.minor = if self.lease_ms.is_some() { 3 } else { minor };
                self.rig.hello_of_minor(self.minor);
                self.rig.live_ms(2 * STOP_RAMP_MS);
                self.is_silent_after(now, STOP_RAMP_MS);
                self.rig.send(&Command::ClearFaults);
                self.arm();
            }
            // A table whose frequencies go through the resonance elsewhere, while another sounds.
            11 => self.swap(20_000.0 + 40_000.0 * place, 20_000.0 + 40_000.0 * other, (level.max(0.1), 1.0)),
            12 => {
                self.rig.send(&UNLIMITED);
            }
            13 => {
                self.rig.send(&Command::Disarm);
                self.rig.live_ms(2 * STOP_RAMP_MS);
                self.is_silent_after(now, STOP_RAMP_MS);
                self.arm();
            }
            14 => self.rig.device.raise_trigger(),
            15 => self.arm(),
            // The host is gone for a while.
            16 => {
                self.rig.silent_ms(1200);
                self.is_silent_after(now, DEAD_MAN_MS + DEAD_MAN_RAMP_MS);
                self.rig.send(&Command::ClearFaults);
                self.arm();
            }
            17 | 18 => {
                self.hold(level, other);
                if kind == 18 {
                    self.swap(60_000.0, 20_000.0, (1.0, 1.0));
                }
            }
            19 => self.press(other < 0.7, (level * longest_pause_ms) as u32),
            // To silence or nearly so, slowly, by another place.
            21 => {
                let level = if level < 0.7 { 0.0 } else { level * 0.1 };
                let glide = glide * (1 + (other * 8.0) as u32);
                self.play(&Command::Drive(drive(&[(0, place, level)], glide)), glide, false, level);
            }
            22 => {
                self.rig.send(&Command::Hold(HoldSetting::default()));
            }
            23 => self.open_stop_input((level * longest_pause_ms) as u32),
            20 => {
                let profile = (other < 0.5).then(|| self.profile.clone());
                let may_write = self.has_hand();
                let answer =
                    self.rig.send(&Command::WriteProfile(ProfileSetting { profile: profile.clone() }));
                let is_written = matches!(answer, Event::Accepted(_) | Event::Unchanged(_));
                prop_assert!(may_write || !is_written, "without a hand: {answer:?}");
                if is_written && profile.is_none() {
                    return Ok(false);
                }
            }
            _ => {
                let Event::BootloaderToken(token) = self.rig.send(&Command::BootloaderToken) else {
                    return Ok(true);
                };
                let may_enter = self.has_hand();
                let answer = self.rig.send(&Command::BootloaderEnter(token));
                let enters = matches!(answer, Event::Accepted(_));
                prop_assert!(may_enter || !enters, "without a hand: {answer:?}");
                if enters {
                    return Ok(false);
                }
            }
        }
        self.rig.live_ms(1 + (pause * longest_pause_ms) as u32);
        Ok(true)
    }

    /// Nothing may sound from so long after an index until now, and nothing begins any more that was accepted before.
    fn is_silent_after(&mut self, index: u64, ms: u32) {
        let begin = index + self.rig.samples(ms) + 4 * BLOCK;
        self.silences.push((begin, self.rig.device.now()));
        self.drives.retain(|drive| drive.begin < begin);
        for drive in &mut self.drives {
            drive.waits_until = drive.waits_until.min(begin);
        }
    }

    /// A table with one gain in its first half and another in its second.
    fn swap(&mut self, first_hz: f64, last_hz: f64, gains: (f64, f64)) {
        let table = Table::line(33, first_hz, last_hz, |u| if u < 0.5 { gains.0 } else { gains.1 });
        let table = table.at_rate(self.rig.samples(1000) as u32);
        self.rig.send(&Command::TableBegin(table.header));
        for chunk in table.chunks() {
            self.rig.send(&Command::TableChunk(chunk));
        }
        if let Some(at) = self.rig.send(&Command::TableCommit).accepted_at() {
            // It may make a glide under way longer.
            for drive in &mut self.drives {
                drive.alone = drive.alone.filter(|alone| *alone <= at);
            }
        }
        self.rig.live_ms(60);
    }

    /// Holds slot 0 at an amplitude that its sensor does not reach.
    fn hold(&mut self, level: f64, other: f64) {
        let blocks = 4;
        let setting = HoldSetting {
            input: 0,
            time_constant: 0,
            blocks,
            max_rise: CentiDecibel((f64::from(self.profile.max_rise.0) * other.min(0.8) / 0.8) as i16),
            slew: CentiDecibel(602),
            tones: [HoldTone { slot: 0, amplitude: ((0.02 + level) * FULL * 64.0) as u32 }]
                .into_iter()
                .collect(),
        };
        self.rig.send(&Command::Hold(setting));
        self.rig.live_blocks(5 * u64::from(blocks + HOLD_PAUSE_BLOCKS));
    }

    /// The user presses the button for so long, or goes on holding it.
    fn press(&mut self, releases: bool, ms: u32) {
        let was_armed = matches!(self.rig.status().state, State::Armed | State::Driving | State::Waiting);
        let since = *self.pressed.get_or_insert(self.rig.device.now());
        self.rig.device.press_button(true);
        self.rig.live_blocks(3);
        self.rig.live_ms(ms);
        let begin = since + self.rig.samples(EMERGENCY_RAMP_MS) + 4 * BLOCK;
        let mut end = self.rig.device.now();
        if releases {
            self.rig.device.press_button(false);
            self.pressed = None;
            end += self.rig.samples(DESK_STOP_MS);
        }
        if was_armed {
            self.is_silent_after(since, EMERGENCY_RAMP_MS);
            self.silences.push((begin, end));
        }
        self.rig.send(&Command::ClearFaults);
        self.arm();
    }

    /// The user opens the stop input for so long.
    fn open_stop_input(&mut self, ms: u32) {
        let now = self.rig.device.now();
        self.rig.device.open_stop_input(true);
        self.rig.live_blocks(4);
        self.arm();
        self.rig.live_ms(ms);
        if self.profile.has_stop_input {
            self.is_silent_after(now, 0);
        }
        self.rig.device.open_stop_input(false);
        self.rig.send(&Command::ClearFaults);
        self.arm();
    }

    /// What every code is judged by.
    fn judge(&self) -> Result<(), TestCaseError> {
        let samples = |ms: u32| self.rig.samples(ms);
        // A ramp, a tick, and the blocks on their way.
        let slack = samples(DEAD_MAN_RAMP_MS) + 12 * BLOCK;
        let rise = 10_f64.powf(f64::from(self.profile.max_rise.0) / 2000.0);
        let most = FULL * f64::from(self.profile.max_sum_per_mille) / 1000.0 + 1.0;
        for (block, codes) in self.rig.recording.codes.chunks(BLOCK as usize).enumerate() {
            let at = self.rig.recording.first + block as u64 * BLOCK;
            let peak = codes.iter().map(|code| f64::from(code.abs_diff(MID))).fold(0.0, f64::max);
            prop_assert!(peak <= most, "{peak} of {most} at {at}");
            if peak == 0.0 {
                continue;
            }
            let begun = self.drives.iter().filter(|drive| drive.begin <= at);
            // One that waits may have begun a moment ago.
            let latest = begun.clone().map(|drive| drive.waits_until.min(at));
            let since = latest.max();
            let longest = samples(self.profile.max_drive_ms) + slack;
            prop_assert!(since.is_some_and(|since| at < since + longest), "at {at}, driven at {since:?}");
            // The last that is alone, and those that were accepted after it: while tones glide both sound.
            let accepted: Vec<&Accepted> = begun.collect();
            // A stop may end a fade later than it would have ended itself.
            let ramp = samples(DEAD_MAN_RAMP_MS) + BLOCK;
            let alone = |drive: &&Accepted| drive.alone.is_some_and(|alone| alone + ramp <= at);
            let first = accepted.iter().rposition(alone).unwrap_or(0);
            let loudest: f64 = accepted[first..].iter().map(|drive| drive.sum).sum();
            prop_assert!(peak <= FULL * loudest * rise * 1.003 + 1.0, "{peak} at {at} by {loudest}");
            if let Some(lease_ms) = self.lease_ms {
                let again = self.leases.iter().copied().filter(|&begin| begin <= at).chain(since);
                let ends = again.max().unwrap_or(0) + samples(lease_ms) + slack;
                prop_assert!(at < ends, "at {at}, leased to {ends}");
            }
            let silence = self.silences.iter().find(|(begin, end)| (*begin..*end).contains(&at));
            prop_assert!(silence.is_none(), "{peak} at {at}, in {silence:?}");
        }
        Ok(())
    }
}

/// Plays a random host on a device whose actuator has a resonance.
fn keeps_within_its_travel(
    max_sum_per_mille: u16,
    static_travel: f64,
    minor: u8,
    acts: &[Act],
) -> Result<(), TestCaseError> {
    let profile = resonant(max_sum_per_mille, static_travel);
    let mut bench = Bench::new(armed(profile.clone(), minor), profile, minor, None);
    for act in acts {
        if !bench.perform(act, 25.0)? {
            break;
        }
    }
    bench.judge()?;
    // What a change adds as free motion, and the noise of the codes.
    let most = travel(&bench.rig.recording.codes, &resonator(static_travel));
    prop_assert!(most <= 1.03, "{most} of the peak travel");
    Ok(())
}

/// Plays a random host on a device at 8 kS/s, so that seconds are few blocks, with a sensor that shows a share of the codes.
fn keeps_its_times_and_rises(
    profile: ActuatorProfile,
    lease_ms: Option<u32>,
    minor: u8,
    heard: f64,
    acts: &[Act],
) -> Result<(), TestCaseError> {
    let options = Options { sample_rate_hz: 8000, flash: flash_with(profile.clone()), ..Options::default() };
    let mut rig = Rig::of(SimulatedDevice::with_inputs(options, Box::new(Slipped(heard))));
    let minor = if lease_ms.is_some() { 3 } else { minor };
    rig.hello_of_minor(minor);
    let gain = |u: f64| if u < 0.3 { 0.2 } else { 1.0 };
    rig.upload(&Table::line(65, 60_000.0, 20_000.0, gain).at_rate(8000));
    rig.live_ms(200);
    let mut bench = Bench::new(rig, profile, minor, lease_ms);
    for act in acts {
        if !bench.perform(act, 1500.0)? {
            break;
        }
    }
    bench.judge()
}

fn profiles() -> impl Strategy<Value = ActuatorProfile> {
    (100u16..=1000, 1000u32..4000, 0i16..=1200, any::<bool>()).prop_map(
        |(max_sum_per_mille, max_drive_ms, max_rise, has_stop_input)| {
            let max_rise = CentiDecibel(max_rise);
            ActuatorProfile { max_sum_per_mille, max_drive_ms, max_rise, has_stop_input, ..plain() }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(30))]

    #[test]
    fn whatever_a_host_does_the_actuator_keeps_within_its_amplitude_and_travel(
        max_sum_per_mille in 100u16..=1000,
        static_travel in 0.1..3.0,
        minor in 0u8..=3,
        acts in acts(),
    ) {
        //
        keeps_within_its_travel(max_sum_per_mille, static_travel, minor, &acts)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(270))]

    #[test]
    fn whatever_hosts_and_users_do_amplitude_rise_time_lease_and_hand_hold(
        profile in profiles(),
        lease_ms in prop::option::of(1000u32..4000),
        minor in 0u8..=3,
        heard in 0.1..0.9,
        acts in acts(),
    ) {
        //
        keeps_its_times_and_rises(profile, lease_ms, minor, heard, &acts)?;
    }
}

/// A sensor that receives this share of the codes.
struct Slipped(f64);

impl SimulatedInputs for Slipped {
    fn sample(&mut self, codes: &[u16; BLOCK as usize], _: bool, sensed: &mut [[u16; BLOCK as usize]; 2]) {
        for (code, sensor) in codes.iter().zip(&mut sensed[0]) {
            let swing = f64::from(*code) - f64::from(MID);
            *sensor = (f64::from(MID) + self.0 * swing).round().clamp(0.0, 4095.0) as u16;
        }
    }
}
