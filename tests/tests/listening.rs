//! What the device hears: the simulated device's inputs.

use std::sync::{Arc, Mutex};

use slipline_link::simulator::{Options, SimulatedDevice, SimulatedInputs};
use slipline_protocol::Command;
use slipline_protocol::event::ResetCause;
use slipline_tests::client::Client;
use slipline_tests::rig::{BLOCK, Rig, Table, drive};

/// Notes every block that it samples: its codes, and whether the amplifier was muted.
#[derive(Clone, Default)]
struct Notes(Arc<Mutex<Vec<([u16; BLOCK as usize], bool)>>>);

impl SimulatedInputs for Notes {
    fn inputs(&self) -> usize {
        1
    }

    fn delay_ns(&self) -> i32 {
        0
    }

    fn sample(&mut self, codes: &[u16; BLOCK as usize], muted: bool, _: &mut [[u16; BLOCK as usize]; 2]) {
        self.0.lock().unwrap().push((*codes, muted));
    }
}

#[test]
fn the_inputs_sample_what_is_at_the_pin_whenever_a_block_is_played() {
    for block_waits in [false, true] {
        let notes = Notes::default();
        let options = Options { block_waits, ..Options::default() };
        let mut rig = Rig::of(SimulatedDevice::with_inputs(options, Box::new(notes.clone())));
        rig.hello();
        rig.upload(&Table::usual());
        rig.arm();
        rig.accepted(&Command::Drive(drive(&[(0, 0.3, 0.7)], 2000)));
        rig.live_ms(30);
        rig.device.inject_underrun();
        rig.live_ms(30);
        let noted = std::mem::take(&mut *notes.0.lock().unwrap());
        let (codes, muted): (Vec<_>, Vec<_>) = noted.into_iter().unzip();
        assert!(codes.as_flattened() == rig.recording.codes, "block waits: {block_waits}");
        assert_eq!(muted, rig.recording.muted, "block waits: {block_waits}");
        assert!(muted.contains(&false) && muted.ends_with(&[true]), "the underrun has muted it");

        // The plate stays where it is when the device is reset.
        rig.device.restart(ResetCause::Watchdog);
        rig.device.advance(5, |_| ());
        assert_eq!(notes.0.lock().unwrap().len(), 5);
    }
}
