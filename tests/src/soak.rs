//! A soak test: a simulated day of random use, R-57.
//!
//! ```text
//! seed -> actions (drives, stops, tables, pauses, sessions) -> Rig -> every code compared with the mirror's
//!                                                              +--> every status: no fault, counters that add up
//! codes -> Wire -> inputs -> Listen, Capture: compared with what the wire makes of the codes that were sent
//! ```
//! Time is virtual, so a day takes as long as its blocks take to compute. The same seed makes the same day.

mod listening;

use std::sync::Arc;

use slipline_app::{Stop, Timing};
use slipline_link::mirror::Mirror;
use slipline_link::simulator::{Options, SimulatedDevice};
use slipline_protocol::command::Command;
use slipline_protocol::event::{Accepted, AcceptedUntil, Event, Fault, Faults, State, Status};
use slipline_protocol::limits::{DEAD_MAN_MS, MAX_DRIVE_MS, STOP_RAMP_MS};
use slipline_protocol::refusal::Refusal;
use slipline_protocol::units::SampleIndex;

use self::listening::{Listening, Sounding};
use crate::client::Client;
use crate::rig::{BLOCK, Rig, Table, drive};
use crate::wire::Wire;

/// The longest time between two keep-alives: below the dead-man's time by a tenth, which covers the blocks that are
/// rendered ahead.
const LATEST_BEAT_MS: u32 = DEAD_MAN_MS * 9 / 10;
/// Blocks by which the device stretches a glide at most: all of a table's way, and a swap's blend, at the largest change of
/// a step that a block may have (2^-10 turns).
const STRETCHED: u64 = 1024;
/// The longest pause of the user while something sounds.
const LONGEST_PAUSE_MS: u32 = MAX_DRIVE_MS / 4;

/// The counts of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Samples that passed.
    pub samples: u64,
    /// Frames the host has sent.
    pub frames: u32,
    /// Drives that the device accepted.
    pub drives: u32,
    /// Tables that were swapped in.
    pub tables: u32,
    /// Stops, the emergency stops among them.
    pub stops: u32,
    /// Sessions that began.
    pub sessions: u32,
    /// Measurements and captures that were read and were right.
    pub measured: u32,
    /// Measured tones whose phase was right.
    pub phases: u32,
    /// The highest temperature seen, per mille of its limit.
    pub hottest_per_mille: u16,
}

/// A device, its mirror, and a user that acts at random.
pub struct Soak {
    rig: Rig,
    mirror: Mirror,
    listening: Listening,
    tables: [Table; 3],
    /// The number of the table in force.
    table: usize,
    random: Xorshift,
    beat_due: SampleIndex,
    tally: Tally,
}

impl Client for Soak {
    fn send(&mut self, command: &Command) -> Event {
        self.tally.frames += 1;
        self.rig.send(command)
    }
}

impl Soak {
    /// A device at this rate in Hz, connected, with a table, armed.
    /// Its inputs receive what it plays.
    #[must_use]
    pub fn new(sample_rate_hz: u32, seed: u64) -> Self {
        let tables = [
            Table::usual(),
            Table::line(33, 25_000.0, 90_000.0, |u| 0.3 + 0.6 * (1.0 - u)),
            Table::line(1025, 500.0, 4_000.0, |u| 0.2 + 0.7 * u * u),
        ];
        let options = Options { sample_rate_hz, ..Options::default() };
        let mut soak = Self {
            rig: Rig::of(SimulatedDevice::with_inputs(options, Box::new(Wire::new()))),
            mirror: Mirror::new(sample_rate_hz, 0),
            listening: Listening::default(),
            tables: tables.map(|table| table.at_rate(sample_rate_hz)),
            table: 0,
            random: Xorshift(seed | 1),
            beat_due: 0,
            tally: Tally::default(),
        };
        soak.begin_session();
        soak.change_table(0);
        soak.pass_ms(20);
        soak.arm();
        soak
    }

    /// Lets the user act for further seconds.
    ///
    /// # Panics
    /// If a code is not the mirror's, a fault stands that the user has not caused, a counter is off, or a command is
    /// answered with anything but what can be expected.
    pub fn run(&mut self, seconds: u32) -> Tally {
        let rate = u64::from(self.rig.device.sample_rate_hz());
        let end = self.rig.device.now() + u64::from(seconds) * rate;
        while self.rig.device.now() < end {
            let left_ms = ((end - self.rig.device.now()) * 1000 / rate) as u32;
            self.act();
            // Mostly as short as in a drag, sometimes seconds, rarely minutes.
            let pause_ms = match self.random.below(16) {
                0 => self.random.below(LONGEST_PAUSE_MS),
                1..4 => self.random.below(10_000),
                _ => self.random.below(400),
            };
            let pause_ms = pause_ms.min(left_ms).max(20);
            self.measure(pause_ms);
            self.pass_ms(pause_ms);
        }
        self.tally.samples = self.rig.device.now();
        self.tally
    }

    fn act(&mut self) {
        match self.random.below(32) {
            0 => {
                // A long pause: disarmed and silent, then a new session.
                self.stop(&Command::Disarm);
                self.pass_ms(200);
                for _ in 0..self.random.below(8) {
                    self.pass_ms(LONGEST_PAUSE_MS);
                }
                self.begin_session();
                self.pass_ms(20);
                self.arm();
            }
            1 => {
                self.stop(&Command::EmergencyStop);
                self.rig.silent_ms(2 * STOP_RAMP_MS);
                assert_eq!(self.status().faults, Faults::NONE.with(Fault::EmergencyStop));
                self.accepted(&Command::ClearFaults);
                self.pass_ms(20);
                self.arm();
            }
            2..4 => self.stop(&Command::Stop),
            4 => {
                let number = self.random.below(3) as usize;
                self.change_table(number);
            }
            5..8 => {
                // From silence a tone begins at its frequency: what is measured has nothing else in it.
                self.stop(&Command::Stop);
                self.pass_ms(2 * STOP_RAMP_MS);
                self.drive_alone(0);
            }
            8..16 => self.drive_alone(STRETCHED),
            _ => self.drive_some(),
        }
    }

    fn begin_session(&mut self) {
        self.tally.frames += 1;
        self.tally.sessions += 1;
        self.listening.dropped();
        self.rig.hello();
    }

    fn arm(&mut self) {
        self.accepted(&Command::Arm);
        self.beat();
        self.pass_ms(40);
    }

    fn stop(&mut self, command: &Command) {
        let kind = if *command == Command::EmergencyStop { Stop::Emergency } else { Stop::Normal };
        let at = self.accepted(command);
        self.listening.acted();
        self.mirror.acknowledge_stop(kind, at).expect("the mirror is not ahead");
        self.tally.stops += 1;
    }

    /// Uploads a table, unless the place for it sounds.
    fn change_table(&mut self, number: usize) {
        let table = self.tables[number].clone();
        match self.send(&Command::TableBegin(table.header)) {
            Event::Accepted(_) => {}
            Event::Refused(Refusal::Busy(_)) => return,
            other => panic!("a table should be taken or put off, not {other:?}"),
        }
        for chunk in table.chunks() {
            self.accepted(&Command::TableChunk(chunk));
        }
        let at = match self.send(&Command::TableCommit) {
            Event::Accepted(accepted) => accepted.at,
            // A stop is still ramping.
            Event::Refused(Refusal::Busy(_)) => return,
            other => panic!("a commit should be taken or put off, not {other:?}"),
        };
        self.listening.acted();
        self.mirror.acknowledge_table(Arc::from(table.knots), at).expect("the mirror is not ahead");
        self.table = number;
        self.tally.tables += 1;
    }

    /// Up to 16 tones anywhere, at any level.
    fn drive_some(&mut self) {
        let count = 1 + self.random.below(16);
        let level = |share: f64| 0.9 * share / f64::from(count);
        let tones: Vec<(u8, f64, f64)> =
            (0..count).map(|slot| (slot as u8, self.random.share(), level(self.random.share()))).collect();
        self.drive(&tones);
    }

    /// One tone where the table's gain is full, at full level: the coil gets warm. Its glide may be longer than asked for by
    /// `stretched` blocks.
    fn drive_alone(&mut self, stretched: u64) {
        let knots = &self.tables[self.table].knots;
        let (position, knot) =
            if self.random.below(2) == 0 { (0.0, knots.first()) } else { (1.0, knots.last()) };
        let step = knot.expect("a table has knots").step;
        if let Some(end) = self.drive(&[(0, position, 1.0)]) {
            self.listening.sounds(Sounding { from: end + stretched * BLOCK, step });
        }
    }

    /// Returns where the requested glide ends; `None` while a stop is still ramping.
    fn drive(&mut self, tones: &[(u8, f64, f64)]) -> Option<SampleIndex> {
        let glide = 20 + self.random.below(480);
        let drive = drive(tones, self.rig.samples(glide) as u32);
        match self.send(&Command::Drive(drive.clone())) {
            Event::Accepted(Accepted { at }) | Event::AcceptedUntil(AcceptedUntil { at, .. }) => {
                self.mirror.acknowledge_play(drive.clone(), at).expect("the mirror is not ahead");
                self.listening.acted();
                self.tally.drives += 1;
                Some(at + u64::from(drive.glide))
            }
            Event::Refused(Refusal::Busy(_)) => None,
            other => panic!("a drive should be taken or put off, not {other:?}"),
        }
    }

    fn beat(&mut self) {
        self.tally.frames += 1;
        self.rig.keep_alive();
        let next_ms = 50 + self.random.below(LATEST_BEAT_MS - 50);
        self.beat_due = self.rig.device.now() + self.rig.samples(next_ms);
    }

    /// Lets time pass with keep-alives, and compares everything that was sent meanwhile.
    fn pass_ms(&mut self, milliseconds: u32) {
        let end = self.rig.device.now() + self.rig.samples(milliseconds);
        let period = Timing::at(self.rig.device.sample_rate_hz()).limit_period;
        while self.rig.device.now() < end {
            let now = self.rig.device.now();
            // Not past the next keep-alive, and not past a step of the thermal limit before a status has reported it.
            let until = end.min(self.beat_due.max(now + BLOCK)).min(now + (period / 2).max(BLOCK));
            self.rig.silent_blocks((until - now).div_ceil(BLOCK));
            if self.rig.device.now() >= self.beat_due {
                self.beat();
            }
            let status = self.status();
            self.compare(&status);
            self.read_what_was_measured();
        }
    }

    fn compare(&mut self, status: &Status) {
        self.mirror
            .acknowledge_limit(
                status.foldback_per_mille,
                Timing::at(self.rig.device.sample_rate_hz()).limit_since(status.now),
            )
            .expect("the mirror is not ahead");
        let recording = &self.rig.recording;
        self.mirror.render(self.rig.device.now(), |first, codes| {
            let at = first.checked_sub(recording.first).map_or(usize::MAX, |at| at as usize);
            let sent = recording.codes.get(at..at + codes.len());
            assert_eq!(sent, Some(&codes[..]), "at sample {first}");
        });
        assert!(self.mirror.is_true());
        self.listening.pass(recording.first, &recording.codes);
        self.rig.record();
        assert_eq!((status.faults, status.first_fault), (Faults::NONE, None), "at {}", status.now);
        assert!(matches!(status.state, State::Idle | State::Armed | State::Driving | State::Stopping));
        let counters = status.counters;
        assert_eq!(counters.frames, self.tally.frames, "every frame was received once");
        let losses = [counters.crc_errors, counters.overlong, counters.duplicates, counters.dropped];
        assert_eq!((losses, counters.underruns, counters.clips), ([0; 4], 0, 0));
        assert!(!self.rig.device.is_watchdog_starved() && self.rig.replies.is_empty());
        self.tally.hottest_per_mille = self.tally.hottest_per_mille.max(status.heat_per_mille);
    }
}

/// Decides what the user does: xorshift64.
struct Xorshift(u64);

impl Xorshift {
    fn bits(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn below(&mut self, limit: u32) -> u32 {
        (((self.bits() >> 32) * u64::from(limit)) >> 32) as u32
    }

    fn share(&mut self) -> f64 {
        f64::from(self.below(u32::MAX)) / f64::from(u32::MAX)
    }
}

/// This process's resident memory in bytes; `None` where the system does not report it.
#[must_use]
pub fn resident_bytes() -> Option<u64> {
    let statm = std::fs::read_to_string("/proc/self/statm").ok()?;
    // Pages of 4 KiB: the resident set is the second number.
    Some(statm.split_whitespace().nth(1)?.parse::<u64>().ok()? * 4096)
}
