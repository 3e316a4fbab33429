//! The renderer's interrupt between any two steps of a command.

use super::*;

/// More locks than any command takes.
const LOCKS: u32 = 16;
/// Blocks from the command to where the drive is to begin.
const AHEAD: u64 = 200;

/// Lets something happen before the lock `locks` from now, while a command is done.
fn interrupted(
    bench: &mut Bench,
    locks: u32,
    happens: impl FnOnce(&RefCell<Renderer>, &Mailbox<Interrupted>) + 'static,
    command: &Command,
) -> Result<Event, Refusal> {
    let (renderer, mailbox) = (bench.renderer.clone(), bench.mailbox.clone());
    INTERRUPT.set(Some((locks, Box::new(move || happens(&renderer, &mailbox)))));
    let answer = bench.execute(command);
    INTERRUPT.take();
    answer
}

/// A drive that begins some time later.
fn later(bench: &Bench) -> Command {
    full_scale(Apply::At(bench.mailbox.now() + AHEAD * BLOCK as u64))
}

/// Clears what stands and arms, before the drive was to begin: whether it does.
fn sounds_when_armed_again(bench: &mut Bench) -> bool {
    bench.render(AHEAD / 2);
    bench.accepted(&Command::ClearFaults);
    bench.accepted(&Command::Arm);
    bench.render(AHEAD)
}

#[test]
fn a_drive_that_the_dead_man_overtakes_never_begins() {
    //
    for locks in 0..LOCKS {
        let mut bench = Bench::armed();
        // Up to the last block in which the device is armed.
        for _ in 0..bench.controller.timing().dead_man / BLOCK as u64 {
            render(&bench.renderer, &bench.mailbox);
        }
        assert!(bench.mailbox.view().armed);
        let blocks = |renderer: &RefCell<Renderer>, mailbox: &Mailbox<Interrupted>| {
            for _ in 0..3 {
                render(renderer, mailbox);
            }
        };
        let drive = later(&bench);
        let answer = interrupted(&mut bench, locks, blocks, &drive);
        if bench.mailbox.view().armed {
            // The interrupt came after the command, or not at all.
            for _ in 0..3 {
                render(&bench.renderer, &bench.mailbox);
            }
        }
        assert!(!bench.mailbox.view().armed);
        assert!(!sounds_when_armed_again(&mut bench), "before lock {locks}: {answer:?}");
    }
}

#[test]
fn a_drive_that_an_underrun_overtakes_never_begins() {
    for locks in 0..LOCKS {
        let mut bench = Bench::armed();
        bench.accepted(&full_scale(Apply::Next));
        assert!(bench.render(20));
        let dry = |renderer: &RefCell<Renderer>, mailbox: &Mailbox<Interrupted>| {
            renderer.borrow_mut().underrun(mailbox);
        };
        let drive = later(&bench);
        let answer = interrupted(&mut bench, locks, dry, &drive);
        if bench.mailbox.view().armed {
            bench.renderer.borrow_mut().underrun(&bench.mailbox);
        }
        assert!(bench.faults().contains(Fault::Underrun));
        assert!(!sounds_when_armed_again(&mut bench), "before lock {locks}: {answer:?}");
    }
}

#[test]
fn a_stop_in_the_midst_of_the_block_that_begins_a_drive_stops_it() {
    // Today's boards cannot do that: the stop comes from the half that is interrupted.
    for locks in 0..LOCKS {
        let mut bench = Bench::armed();
        bench.render(8);
        bench.accepted(&full_scale(Apply::Next));
        let mailbox = bench.mailbox.clone();
        INTERRUPT.set(Some((
            locks,
            Box::new(move || {
                mailbox.fault(Fault::EmergencyStop, Stop::Emergency);
            }),
        )));
        bench.render(1);
        if INTERRUPT.take().is_some() {
            continue;
        }
        bench.render(100);
        assert!(
            bench.mailbox.view().is_silent() && bench.renderer.borrow().is_muted(),
            "before lock {locks}"
        );
    }
}

#[test]
fn a_digest_is_of_its_whole_window_or_refused() {
    let silence: std::vec::Vec<u8> =
        core::iter::repeat_n(MID_SCALE.to_le_bytes(), 2 * BLOCK).flatten().collect();
    let crc = slipline_protocol::frame::CRC.checksum(&silence);
    for locks in 0..LOCKS {
        let mut bench = Bench::armed();
        let window = DigestWindow { from: bench.mailbox.now(), count: 2 * BLOCK as u32 };
        let block = |renderer: &RefCell<Renderer>, mailbox: &Mailbox<Interrupted>| {
            render(renderer, mailbox);
        };
        let answer = interrupted(&mut bench, locks, block, &Command::DigestStart(window));
        bench.render(4);
        match answer {
            Ok(_) => {
                assert_eq!(bench.mailbox.digest(), DigestState::Done(window, crc), "before lock {locks}");
            }
            Err(refusal) => assert!(matches!(refusal, Refusal::OutOfRange { field: Field::ApplyAt, .. })),
        }
    }
}
