//! A bench whose device is in another worker of a browser: what is done here is kept as changes, which are carried out there.
//!
//! ```text
//! instrument --put, rest, tap--> Bench::elsewhere --BenchChange--> Bench::carry_out --> inputs of the device
//!                                       ^-------- passed_over -----------'
//! ```

use super::Bench;
use crate::rig::{RigCopy, RigState};
use serde::{Deserialize, Serialize};

/// A change that the device's bench must make.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum BenchChange {
    /// As [`Bench::put`].
    Put(RigCopy),
    /// As [`Bench::pass_over_to`].
    PassOverTo(RigCopy, f64),
    /// A person has moved the sensor, or has caused or removed a fault.
    State(RigState),
    /// As [`Bench::rest`].
    Rest(bool),
    /// As [`Bench::tap`].
    Tap,
}

/// The changes that are not carried out yet.
#[derive(Default)]
pub(super) struct Elsewhere {
    changes: Vec<BenchChange>,
    /// The latest rig, and its state as it was sent.
    rig: Option<(RigCopy, RigState)>,
    is_resting: bool,
    is_passing_over: bool,
}

impl Elsewhere {
    pub(super) fn put(&mut self, rig: RigCopy) {
        self.rig = Some((rig.clone(), rig.state()));
        self.is_passing_over = false;
        self.changes.push(BenchChange::Put(rig));
    }

    pub(super) fn pass_over_to(&mut self, rig: RigCopy, sample_rate_hz: f64) {
        self.rig = Some((rig.clone(), rig.state()));
        self.is_passing_over = true;
        self.changes.push(BenchChange::PassOverTo(rig, sample_rate_hz));
    }

    pub(super) fn rest(&mut self, is_resting: bool) {
        if self.is_resting != is_resting {
            self.is_resting = is_resting;
            self.changes.push(BenchChange::Rest(is_resting));
        }
    }

    pub(super) fn tap(&mut self) {
        self.changes.push(BenchChange::Tap);
    }

    pub(super) const fn is_passing_over(&self) -> bool {
        self.is_passing_over
    }

    fn take_changes(&mut self) -> Vec<BenchChange> {
        if let Some((rig, sent)) = &mut self.rig {
            let state = rig.state();
            if state != *sent {
                self.changes.push(BenchChange::State(state.clone()));
                *sent = state;
            }
        }
        std::mem::take(&mut self.changes)
    }
}

impl Bench {
    /// A bench for a device in another worker: its changes must be carried out there.
    #[must_use]
    pub fn elsewhere() -> Self {
        let bench = Self::default();
        bench.rigs().elsewhere = Some(Elsewhere::default());
        bench
    }

    /// The changes since the last call, in order.
    #[must_use]
    pub fn take_changes(&self) -> Vec<BenchChange> {
        self.rigs().elsewhere.as_mut().map(Elsewhere::take_changes).unwrap_or_default()
    }

    /// The other bench has ended its crossfade.
    pub fn passed_over(&self) {
        if let Some(elsewhere) = &mut self.rigs().elsewhere {
            elsewhere.is_passing_over = false;
        }
    }

    /// Does what a bench elsewhere has done. Returns the rig that it has brought along: a later state is that rig's.
    pub fn carry_out(&self, change: BenchChange, rig: &mut Option<RigCopy>) {
        match change {
            BenchChange::Put(other) => {
                self.rigs().put(other.inputs());
                *rig = Some(other);
            }
            BenchChange::PassOverTo(other, sample_rate_hz) => {
                self.rigs().pass_over_to(other.inputs(), sample_rate_hz);
                *rig = Some(other);
            }
            BenchChange::State(state) => {
                if let Some(rig) = rig {
                    rig.set_state(state);
                }
            }
            BenchChange::Rest(is_resting) => self.rest(is_resting),
            BenchChange::Tap => self.tap(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig::{PreparedRig, RigOptions};
    use slipline_plate::preset;

    const RATE_HZ: f64 = 400e3;

    /// What a device's inputs read while `act` does something every tenth block.
    fn heard(bench: &Bench, mut act: impl FnMut(usize)) -> Vec<[[u16; 128]; 2]> {
        let mut inputs = bench.inputs();
        let codes: [u16; 128] = std::array::from_fn(|n| 2048 + 15 * n as u16);
        let read = |block: usize| {
            if block.is_multiple_of(10) {
                act(block / 10);
            }
            let mut sensed = [[0; 128]; 2];
            inputs.sample(&codes, false, &mut sensed);
            sensed
        };
        (0..80).map(read).collect()
    }

    /// All that a person and the instrument do at a bench, one after another.
    fn act(bench: &Bench, rig: &PreparedRig, step: usize) {
        match step {
            1 => bench.put(rig),
            2 => rig.hand().put_sensor(0.16).expect("on the plate"),
            3 => bench.rest(true),
            4 => bench.rest(false),
            5 => bench.tap(),
            6 => bench.pass_over_to(rig, RATE_HZ),
            _ => {}
        }
    }

    #[test]
    fn a_change_at_a_bench_elsewhere_reaches_the_device() {
        let options = RigOptions { place_m: 0.03, ..RigOptions::default() };
        let rig =
            || PreparedRig::new(&preset("membrane").expect("a plate"), &options, RATE_HZ).expect("a rig");
        let (here, direct) = (rig(), Bench::default());
        let expected = heard(&direct, |step| act(&direct, &here, step));
        let (there, device, elsewhere) = (rig(), Bench::default(), Bench::elsewhere());
        let mut known = None;
        let received = heard(&device, |step| {
            act(&elsewhere, &there, step);
            for change in elsewhere.take_changes() {
                let bytes = postcard::to_extend(&change, Vec::new()).expect("plain data");
                // A browser copies it several times, and the worker that reads it receives no STOP meanwhile.
                assert!(bytes.len() < 100_000, "{} bytes", bytes.len());
                device.carry_out(postcard::from_bytes(&bytes).expect("the same data"), &mut known);
            }
        });
        assert!(received == expected, "the inputs differ");
        assert!(elsewhere.is_passing_over() && device.is_passing_over() && direct.is_passing_over());
        elsewhere.passed_over();
        assert!(!elsewhere.is_passing_over());
        let different = expected.iter().filter(|block| **block != expected[0]).count();
        assert!(different > 40, "the rig is heard: {different}");
    }
}
