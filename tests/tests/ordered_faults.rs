//! Faults on purpose: ordered in two steps, only where the mute pin is high and nothing sounds, reported, and not counted.

use slipline_link::simulator::Options;
use slipline_protocol::board::{FaultEnd, FaultOrder, FaultTrial, OrderedFault};
use slipline_protocol::command::ArmLease;
use slipline_protocol::event::{Event, Fault, Faults, ResetCause, State};
use slipline_protocol::limits::BOOTLOADER_TOKEN_MS;
use slipline_protocol::refusal::Busy;
use slipline_protocol::{Command, Refusal};
use slipline_tests::answer;
use slipline_tests::client::Client as _;
use slipline_tests::commands::every_command;
use slipline_tests::rig::{Rig, Table};

const ALL: [OrderedFault; 3] =
    [OrderedFault::Hang, OrderedFault::MaskedInterrupts, OrderedFault::StackOverflow];

fn trial(rig: &mut Rig) -> FaultTrial {
    answer!(rig, Command::FaultToken, FaultTrial)
}

fn order(rig: &mut Rig, fault: OrderedFault) -> Command {
    Command::FaultOrder(FaultOrder { fault, token: trial(rig).token })
}

/// Lets the device fail and start again, and says hello.
fn restarted(rig: &mut Rig) -> ResetCause {
    rig.silent_ms(700);
    match rig.hello().event {
        Event::Hello(identity) => identity.reset,
        other => panic!("{other:?}"),
    }
}

fn unmuted() -> Rig {
    let mut rig = Rig::armed();
    rig.live_ms(10);
    rig
}

#[test]
fn an_ordered_fault_is_reported_with_the_time_to_mute_and_three_are_no_safe_mode() {
    //
    let mut rig = unmuted();
    for fault in ALL {
        let order = order(&mut rig, fault);
        rig.accepted(&order);
        rig.live_ms(10);
        assert_eq!(rig.status().state, State::Armed, "the answer goes out first");
        let cause = restarted(&mut rig);
        let wanted =
            if fault == OrderedFault::StackOverflow { ResetCause::HardFault } else { ResetCause::Watchdog };
        assert_eq!(cause, wanted, "{fault:?}");
        let FaultEnd { fault: of, muted_after_us, by_reset } = trial(&mut rig).last.unwrap();
        assert_eq!((of, by_reset), (fault, fault == OrderedFault::Hang));
        match fault {
            OrderedFault::Hang => assert!((200_000..410_000).contains(&muted_after_us), "{muted_after_us}"),
            OrderedFault::MaskedInterrupts => assert_eq!(muted_after_us, 4000),
            OrderedFault::StackOverflow => assert_eq!(muted_after_us, 0),
        }
        let latched = if fault == OrderedFault::StackOverflow { Fault::Crash } else { Fault::Watchdog };
        let status = rig.status();
        assert_eq!((status.state, status.faults), (State::Fault, Faults::NONE.with(latched)));
        assert!(rig.device.is_muted());
        rig.accepted(&Command::ClearFaults);
        rig.upload(&Table::usual());
        rig.arm();
        rig.live_ms(10);
    }
    // It is that of the last run alone.
    rig.device.restart(ResetCause::Pin);
    rig.hello();
    assert_eq!(trial(&mut rig).last, None);
}

#[test]
fn an_ordered_fault_needs_a_token_and_a_silent_device_whose_amplifier_is_on() {
    //
    let bench = Command::Bench(ArmLease { lease_ms: 60_000 });
    let hang = |token| Command::FaultOrder(FaultOrder { fault: OrderedFault::Hang, token });
    let mut rig = Rig::greeted();
    let token = trial(&mut rig).token;
    assert_eq!(rig.refused(&hang(token)), Refusal::NotArmed);
    rig.upload(&Table::usual());
    rig.accepted(&bench);
    rig.live_ms(10);
    assert_eq!(rig.refused(&hang(token)), Refusal::NotArmed, "on the bench the pin is low");
    let mut rig = unmuted();
    assert_eq!(rig.refused(&hang(0)), Refusal::BadToken);
    let token = trial(&mut rig).token;
    assert_eq!(rig.refused(&hang(token ^ 1)), Refusal::BadToken);
    assert_eq!(rig.refused(&hang(token)), Refusal::BadToken, "one try each");
    let token = trial(&mut rig).token;
    rig.live_ms(BOOTLOADER_TOKEN_MS + 10);
    assert_eq!(rig.refused(&hang(token)), Refusal::BadToken);
    rig.play(&[(0, 0.5, 0.5)], 2000, 10);
    let token = trial(&mut rig).token;
    assert_eq!(rig.refused(&hang(token)), Refusal::Busy(Busy::DriveActive));
    let mut rig = Rig::new(Options { mute_resistor_missing: true, ..Options::default() });
    rig.make_ready();
    rig.live_ms(10);
    let order = order(&mut rig, OrderedFault::Hang);
    assert_eq!(rig.refused(&order), Refusal::NotSupported, "the pin stays low");
    rig.live_ms(700);
    assert_eq!(rig.status().state, State::Armed);
}

#[test]
fn leaving_the_state_that_an_order_needs_drops_it() {
    //
    for command in every_command() {
        let is_end = matches!(
            command,
            Command::Hello(_)
                | Command::Disarm
                | Command::EmergencyStop
                | Command::Drive(_)
                | Command::Chord(_)
        );
        if !is_end {
            continue;
        }
        let mut rig = unmuted();
        let order = order(&mut rig, OrderedFault::Hang);
        rig.accepted(&order);
        if matches!(command, Command::Hello(_)) {
            rig.hello();
        } else {
            rig.send(&command);
        }
        rig.live_ms(700);
        assert!(matches!(rig.send(&Command::Status), Event::Status(_)), "{command:?}");
    }
}
