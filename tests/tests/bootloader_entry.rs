//! What the host's link makes of a device that was sent into its ROM bootloader and comes back, or stays away.

use slipline_link::{LinkState, Outcome, Refusal, Request};
use slipline_protocol::event::ResetCause;
use slipline_protocol::{Command, Event};
use slipline_tests::faulty_ports::{Rewrite, as_real, board, identified};
use slipline_tests::link_rig::LinkRig;

/// How long a device that does not come back is looked for, in ms, and a little more.
const LOOKED_FOR_MS: u64 = 3_100;

/// The board whose ROM may miss the crystal.
fn as_f407(event: Event) -> Event {
    identified(event, |identity| identity.board = "STM32F4DISCOVERY".try_into().expect("fits"))
}

/// A ROM that restarts the program `misses` times before DFU appears; without DFU's own device nothing is listed then. Returns how
/// often the bootloader was entered, and how the request ended.
fn enter(rewrite: Rewrite, misses: u32) -> (LinkRig, u32, Option<Outcome>) {
    let rig = LinkRig::new();
    rig.ports().rewrite = rewrite;
    let mut rig = rig.connect();
    let asked = rig.ask(Request::Bootloader);
    let mut entered = 0;
    for _ in 0..30_000 {
        rig.pass_ms(1);
        if rig.ports().device.is_in_bootloader() && !rig.ports().listed.is_empty() {
            entered += 1;
            rig.ports().unplug();
            if entered <= misses {
                rig.pass_ms(200);
                rig.ports().device.restart(ResetCause::Software);
                rig.ports().listed = vec![board("B")];
            }
        }
    }
    let outcome = rig.outcome(asked);
    (rig, entered, outcome)
}

#[test]
fn a_device_that_stays_away_is_in_its_bootloader_and_not_looked_for_any_more() {
    //
    let (mut rig, entered, outcome) = enter(as_real, 0);
    assert_eq!((entered, rig.view().link.state.clone()), (1, LinkState::Disconnected));
    assert!(matches!(outcome, Some(Outcome::Done { .. })), "{outcome:?}");
    assert_eq!(rig.connection.deadline(rig.now), None);
    // It was flashed and is plugged in again: the user connects, as before.
    rig.ports().device.restart(ResetCause::PowerOn);
    rig.ports().listed = vec![board("A")];
    let opened = rig.ports().opened.len();
    rig.pass_ms(5_000);
    assert_eq!(rig.ports().opened.len(), opened);
    let rig = rig.connect();
    assert_eq!(rig.ports().commands.iter().filter(|(_, sent)| *sent == Command::BootloaderToken).count(), 1);
}

#[test]
fn a_board_whose_rom_misses_its_crystal_is_asked_again_at_most_five_times() {
    //
    for misses in [1, 5] {
        let (rig, entered, outcome) = enter(as_f407, misses);
        assert_eq!((entered, rig.view().link.state.clone()), (misses + 1, LinkState::Disconnected));
        assert!(matches!(outcome, Some(Outcome::Done { .. })), "{outcome:?}");
    }
    let (rig, entered, outcome) = enter(as_f407, u32::MAX);
    assert_eq!((entered, outcome), (6, Some(Outcome::Refused(Refusal::NotInBootloader))));
    assert_eq!(rig.view().link.state, LinkState::Connected, "it can be used");
}

#[test]
fn a_device_that_comes_back_with_the_same_build_wants_boot0() {
    //
    let (rig, entered, outcome) = enter(as_real, u32::MAX);
    assert_eq!((entered, outcome), (1, Some(Outcome::Refused(Refusal::NotInBootloader))));
    assert_eq!(rig.view().link.state, LinkState::Connected);
    let (_, refusal) = rig.view().record.last_refusal.clone().expect("what window and command line show");
    assert!(refusal.to_string().contains("hold BOOT0"), "{refusal}");
}

#[test]
fn a_silent_line_ends_the_search_too_and_another_request_of_the_user_comes_first() {
    // the NUCLEO-G474RE's port stays, and its ROM does not answer a hello.
    let mut rig = LinkRig::connected();
    let asked = rig.ask(Request::Bootloader);
    rig.pass_ms(100);
    rig.ports().drop_replies = u32::MAX;
    rig.pass_ms(LOOKED_FOR_MS);
    assert!(matches!(rig.outcome(asked), Some(Outcome::Done { .. })), "{:?}", rig.outcome(asked));
    assert_eq!((rig.connection.is_open(), rig.view().link.state.clone()), (false, LinkState::Disconnected));
    // While it is looked for.
    for with_hello in [false, true] {
        let mut rig = LinkRig::connected();
        let asked = rig.ask(Request::Bootloader);
        rig.pass_ms(100);
        rig.ports().device.restart(ResetCause::Software);
        rig.ports().drop_replies = if with_hello { u32::MAX } else { 0 };
        rig.pass_ms(if with_hello { 300 } else { 10 });
        let left = rig.ask(Request::Disconnect);
        assert!(matches!(rig.outcome(asked), Some(Outcome::Done { .. })));
        rig.pass_ms(1_000);
        assert!(matches!(rig.outcome(left), Some(Outcome::Done { .. })));
        assert_eq!(
            (rig.connection.is_open(), rig.view().link.state.clone()),
            (false, LinkState::Disconnected)
        );
    }
}
