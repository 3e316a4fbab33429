//! The level of the brown-out reset, written by the device itself into its chip's option bytes.

use slipline_link::simulator::Options;
use slipline_protocol::board::{Analogue, BrownOut, BrownOutOrder};
use slipline_protocol::event::{Event, ResetCause, State};
use slipline_protocol::limits::HAND_MS;
use slipline_protocol::refusal::{Busy, Field};
use slipline_protocol::{Command, Refusal};
use slipline_tests::answer;
use slipline_tests::client::Client;
use slipline_tests::rig::{Rig, Table};

const READ: Command = Command::BrownOut(BrownOutOrder { is_written: false });
const WRITE: Command = Command::BrownOut(BrownOutOrder { is_written: true });

/// A board as it is delivered, with this reference voltage and this byte of read protection.
fn delivered(reference_mv: u16, read_protection: u8) -> Rig {
    let analogue = Analogue { reference_mv, ..Options::default().analogue };
    let options = Options { brown_out_guarded: false, analogue, read_protection, ..Options::default() };
    let mut rig = Rig::greeted_with(options);
    rig.live_ms(10);
    rig
}

fn press(rig: &mut Rig) {
    rig.device.press_button(true);
    rig.live_ms(10);
}

/// The reset and the crash's message that a new session's hello has.
fn hello(rig: &mut Rig) -> (ResetCause, String) {
    match rig.hello().event {
        Event::Hello(identity) => (identity.reset, identity.crash.to_string()),
        other => panic!("{other:?}"),
    }
}

fn maintenance(rig: &mut Rig) -> bool {
    answer!(rig, Command::Maintenance, Maintenance).brown_out_guarded
}

#[test]
fn the_level_is_written_with_a_hand_on_the_board_and_in_force_after_a_restart() {
    //
    let mut rig = delivered(3300, 0xaa);
    let found = answer!(rig, READ, BrownOut);
    assert_eq!((found.level, found.needed, found.restarts), (0, 2, false));
    assert_eq!(rig.refused(&WRITE), Refusal::HoldButton);
    press(&mut rig);
    let written = answer!(rig, WRITE, BrownOut);
    assert_eq!((written.level, written.read_protection, written.restarts), (2, 0xaa, true));
    assert_eq!(written.options ^ found.options, 0b10 << 2, "nothing else changes");
    rig.device.press_button(false);
    rig.live_ms(20);
    assert_eq!(rig.status().state, State::Idle, "the answer goes out first");
    rig.device.advance(400, |_| {});
    assert_eq!(hello(&mut rig), (ResetCause::Software, String::new()));
    assert!(maintenance(&mut rig));
    let compared = answer!(rig, WRITE, BrownOut);
    assert_eq!(compared, BrownOut { restarts: false, ..written }, "it is high enough, and not written again");
}

#[test]
fn the_level_is_not_written_where_anything_could_go_wrong() {
    //
    let mut rig = delivered(3300, 0xaa);
    rig.upload(&Table::usual());
    rig.arm();
    assert_eq!(rig.refused(&WRITE), Refusal::DisarmFirst);
    rig.play(&[(0, 0.5, 0.5)], 2000, 20);
    assert_eq!(rig.refused(&WRITE), Refusal::Busy(Busy::DriveActive));
    for (reference_mv, read_protection, refusal) in [
        (2899, 0xaa, Refusal::out_of_range(Field::ReferenceVoltage, 2900, 65535, 2899)),
        (0, 0xaa, Refusal::out_of_range(Field::ReferenceVoltage, 2900, 65535, 0)),
        (3300, 0xcc, Refusal::out_of_range(Field::ReadProtection, 0xaa, 0xaa, 0xcc)),
        (3300, 0x55, Refusal::out_of_range(Field::ReadProtection, 0xaa, 0xaa, 0x55)),
    ] {
        let mut rig = delivered(reference_mv, read_protection);
        press(&mut rig);
        assert_eq!(rig.refused(&WRITE), refusal);
        assert!(!maintenance(&mut rig));
    }
    let mut rig = delivered(3300, 0xaa);
    press(&mut rig);
    rig.live_ms(HAND_MS);
    assert_eq!(rig.refused(&WRITE), Refusal::HoldButton, "a button that is stuck is no hand");
    assert!(matches!(rig.send(&READ), Event::BrownOut(BrownOut { level: 0, .. })));
}

#[test]
fn the_device_restarts_with_its_level_in_whatever_session_comes_meanwhile() {
    let mut rig = delivered(3300, 0xaa);
    press(&mut rig);
    assert!(answer!(rig, WRITE, BrownOut).restarts);
    rig.hello();
    rig.device.advance(400, |_| {});
    assert!(rig.device.now() < 400 * 128, "its index began again");
    assert_eq!(hello(&mut rig).0, ResetCause::Software);
}
