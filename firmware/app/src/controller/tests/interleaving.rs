//! The renderer's interrupt between any two steps of a command.

use super::*;

/// More locks than any command takes.
const LOCKS: u32 = 16;
/// Blocks from the command to where the drive is to begin.
const AHEAD: u64 = 200;

/// Lets something happen before the lock `locks` from now, while a command is done.
fn interrupted(
    rig: &mut Rig,
    locks: u32,
    happens: impl FnOnce(&RefCell<Renderer>, &Mailbox<Interrupted>) + 'static,
    command: &Command,
) -> Result<Event, Refusal> {
    let (renderer, mailbox) = (rig.renderer.clone(), rig.mailbox.clone());
    INTERRUPT.set(Some((locks, Box::new(move || happens(&renderer, &mailbox)))));
    let answer = rig.execute(command);
    INTERRUPT.take();
    answer
}

/// A drive that begins some time later.
fn later(rig: &Rig) -> Command {
    full_scale(Apply::At(rig.mailbox.now() + AHEAD * BLOCK as u64))
}

/// Clears what stands and arms, before the drive was to begin: whether it does.
fn sounds_when_armed_again(rig: &mut Rig) -> bool {
    rig.render(AHEAD / 2);
    rig.accepted(&Command::ClearFaults);
    rig.accepted(&Command::Arm);
    rig.render(AHEAD)
}

#[test]
fn a_drive_whose_planning_the_dead_man_interrupts_never_begins() {
    //
    for locks in 0..LOCKS {
        let mut rig = Rig::armed();
        // Up to the last block in which the device is armed.
        for _ in 0..rig.controller.timing().dead_man / BLOCK as u64 {
            render(&rig.renderer, &rig.mailbox);
        }
        assert!(rig.mailbox.view().armed);
        let blocks = |renderer: &RefCell<Renderer>, mailbox: &Mailbox<Interrupted>| {
            for _ in 0..3 {
                render(renderer, mailbox);
            }
        };
        let drive = later(&rig);
        let answer = interrupted(&mut rig, locks, blocks, &drive);
        if rig.mailbox.view().armed {
            // The interrupt came after the command, or not at all.
            for _ in 0..3 {
                render(&rig.renderer, &rig.mailbox);
            }
        }
        assert!(!rig.mailbox.view().armed);
        assert!(!sounds_when_armed_again(&mut rig), "before lock {locks}: {answer:?}");
    }
}

#[test]
fn a_drive_whose_planning_an_underrun_interrupts_never_begins() {
    for locks in 0..LOCKS {
        let mut rig = Rig::armed();
        rig.accepted(&full_scale(Apply::Next));
        assert!(rig.render(20));
        let dry = |renderer: &RefCell<Renderer>, mailbox: &Mailbox<Interrupted>| {
            renderer.borrow_mut().underrun(mailbox);
        };
        let drive = later(&rig);
        let answer = interrupted(&mut rig, locks, dry, &drive);
        if rig.mailbox.view().armed {
            rig.renderer.borrow_mut().underrun(&rig.mailbox);
        }
        assert!(rig.faults().contains(Fault::Underrun));
        assert!(!sounds_when_armed_again(&mut rig), "before lock {locks}: {answer:?}");
    }
}

#[test]
fn a_stop_in_the_midst_of_the_block_that_begins_a_drive_stops_it() {
    // Today's boards cannot do that: the stop comes from the half that is interrupted.
    for locks in 0..LOCKS {
        let mut rig = Rig::armed();
        rig.render(8);
        rig.accepted(&full_scale(Apply::Next));
        let mailbox = rig.mailbox.clone();
        INTERRUPT.set(Some((
            locks,
            Box::new(move || {
                mailbox.fault(Fault::EmergencyStop, Stop::Emergency);
            }),
        )));
        rig.render(1);
        if INTERRUPT.take().is_some() {
            continue;
        }
        rig.render(100);
        assert!(rig.mailbox.view().is_silent() && rig.renderer.borrow().is_muted(), "before lock {locks}");
    }
}

#[test]
fn a_digest_is_of_its_whole_window_or_refused() {
    let silence: std::vec::Vec<u8> =
        core::iter::repeat_n(MID_SCALE.to_le_bytes(), 2 * BLOCK).flatten().collect();
    let crc = slipline_protocol::frame::CRC.checksum(&silence);
    for locks in 0..LOCKS {
        let mut rig = Rig::armed();
        let window = DigestWindow { from: rig.mailbox.now(), count: 2 * BLOCK as u32 };
        let block = |renderer: &RefCell<Renderer>, mailbox: &Mailbox<Interrupted>| {
            render(renderer, mailbox);
        };
        let answer = interrupted(&mut rig, locks, block, &Command::DigestStart(window));
        rig.render(4);
        match answer {
            Ok(_) => {
                assert_eq!(rig.mailbox.digest(), DigestState::Done(window, crc), "before lock {locks}");
            }
            Err(refusal) => assert!(matches!(refusal, Refusal::OutOfRange { field: Field::ApplyAt, .. })),
        }
    }
}
