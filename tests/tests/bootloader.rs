//! The way into the ROM bootloader: only when disarmed, and only in two steps.

use slipline_protocol::event::Event;
use slipline_protocol::limits::BOOTLOADER_TOKEN_MS;
use slipline_protocol::version::Version;
use slipline_protocol::{Command, Refusal};
use slipline_tests::answer;
use slipline_tests::client::Client;
use slipline_tests::commands::every_command;
use slipline_tests::rig::{Rig, drive};

fn token(rig: &mut Rig) -> u32 {
    answer!(rig, Command::BootloaderToken, BootloaderToken)
}

#[test]
fn the_right_token_shown_in_time_leads_into_the_bootloader_after_the_reply() {
    //
    let mut rig = Rig::greeted();
    let token = token(&mut rig);
    rig.live_ms(100);
    rig.accepted(&Command::BootloaderEnter(token));
    assert!(!rig.device.is_in_bootloader(), "the reply goes out first");
    rig.live_ms(100);
    assert!(rig.device.is_in_bootloader());
}

#[test]
fn a_wrong_old_or_used_token_does_not_enter_the_bootloader() {
    //
    let mut rig = Rig::greeted();
    assert_eq!(rig.refused(&Command::BootloaderEnter(0)), Refusal::BadToken);
    let first = token(&mut rig);
    assert_eq!(rig.refused(&Command::BootloaderEnter(first ^ 1)), Refusal::BadToken);
    assert_eq!(rig.refused(&Command::BootloaderEnter(first)), Refusal::BadToken, "one try each");
    let second = token(&mut rig);
    assert_ne!(first, second);
    rig.live_ms(BOOTLOADER_TOKEN_MS + 10);
    assert_eq!(rig.refused(&Command::BootloaderEnter(second)), Refusal::BadToken);
    let third = token(&mut rig);
    rig.hello();
    assert_eq!(rig.refused(&Command::BootloaderEnter(third)), Refusal::BadToken, "another session");
    rig.live_ms(200);
    assert!(!rig.device.is_in_bootloader());
}

#[test]
fn an_armed_device_gives_no_token_and_takes_none() {
    //
    let mut rig = Rig::greeted();
    let early = token(&mut rig);
    rig.upload(&slipline_tests::rig::Table::usual());
    rig.arm();
    assert_eq!(rig.refused(&Command::BootloaderToken), Refusal::Armed);
    assert_eq!(rig.refused(&Command::BootloaderEnter(early)), Refusal::Armed);
    rig.play(&[(0, 0.5, 0.5)], 2000, 10);
    assert_eq!(rig.refused(&Command::BootloaderToken), Refusal::Armed);
    rig.accepted(&Command::Disarm);
    assert_eq!(rig.refused(&Command::BootloaderToken), Refusal::Armed, "while it still ramps");
    rig.live_ms(40);
    token(&mut rig);
    assert!(!rig.device.is_in_bootloader());
}

#[test]
fn no_other_command_leads_into_the_bootloader() {
    // the matrix.
    let mut rig = Rig::greeted();
    for command in every_command() {
        if matches!(command, Command::Hello(_)) {
            continue;
        }
        rig.send(&command);
        rig.live_ms(100);
        assert!(!rig.device.is_in_bootloader(), "{command:?}");
    }
}

#[test]
fn a_host_of_another_version_may_identify_stop_and_flash_and_nothing_else() {
    //
    for other in [Version { major: 2, ..Version::OURS }, Version { schema: [9; 4], ..Version::OURS }] {
        let mut rig = Rig::default();
        rig.hello_as(other);
        for command in every_command() {
            let command_is_newer = command.since() > 0;
            let event = rig.send(&match command {
                Command::Hello(_) => continue,
                command => command,
            });
            let allowed = !matches!(event, Event::Refused(Refusal::VersionMismatch));
            let harmless = matches!(event, Event::Status(_) | Event::BootloaderToken(_))
                || matches!(event, Event::Refused(Refusal::BadToken))
                // What a later minor has brought: to such a host the device is one of the first minor.
                || (command_is_newer && matches!(event, Event::Refused(Refusal::UnknownMessage { .. })))
                || matches!(event, Event::Accepted(_));
            assert!(!allowed || harmless, "{event:?}");
        }
        let refused = [
            Command::Arm,
            Command::Drive(drive(&[], 2000)),
            Command::TableCommit,
            Command::Store,
            Command::Forget,
            Command::ClearFaults,
        ];
        for command in refused {
            assert_eq!(rig.refused(&command), Refusal::VersionMismatch);
        }
        rig.accepted(&Command::Stop);
        let token = token(&mut rig);
        rig.accepted(&Command::BootloaderEnter(token));
        rig.live_ms(100);
        assert!(rig.device.is_in_bootloader());
    }
}
