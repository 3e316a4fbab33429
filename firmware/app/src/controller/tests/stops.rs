//! A stop that comes while a command is under way that takes long.

use slipline_protocol::limits::CHUNK_KNOTS;

use super::*;

/// Knots between two looks for a stop, at most: with more of them a board is late.
const KNOTS_AT_ONCE: usize = 4;

/// Executes a command during which a stop comes at the check after `look`; returns the answer and the number of checks.
fn stopped_at(rig: &mut Rig, look: u32, command: &Command) -> (Result<Event, Refusal>, u32) {
    let mailbox = Rc::clone(&rig.mailbox);
    let looks = Cell::new(0);
    let answer =
        rig.controller.execute(command, &mut stop_after(look, &looks, Stop::Normal, &mailbox), &mailbox);
    (answer, looks.get())
}

#[test]
fn a_stop_that_comes_while_a_drive_is_planned_keeps_it_from_starting() {
    let drive = full_scale(Apply::Next);
    for look in 0.. {
        let mut rig = Rig::armed();
        let (answer, looks) = stopped_at(&mut rig, look, &drive);
        if answer.is_ok() {
            assert_eq!(looks, look, "started after a stop");
            assert!(looks >= 6, "{looks} looks in planning sixteen tones");
            break;
        }
        assert_eq!(answer, Err(Refusal::Busy(Busy::DriveActive)), "at look {look}");
        assert!(!rig.render(100), "at look {look}");
        // The device is armed as before, and obeys the next drive.
        rig.accepted(&drive);
        assert!(rig.render(100));
    }
}

#[test]
fn a_stop_that_comes_while_a_change_of_tables_is_planned_leaves_the_old_table_in_force() {
    for look in 0.. {
        let mut rig = Rig::armed();
        rig.accepted(&full_scale(Apply::Next));
        rig.render(100);
        let in_force = rig.controller.active;
        rig.stage();
        let (answer, looks) = stopped_at(&mut rig, look, &Command::TableCommit);
        if answer.is_ok() {
            assert_eq!(looks, look, "changed after a stop");
            assert!(looks >= 6, "{looks} looks in planning sixteen tones");
            assert_ne!(rig.controller.active, in_force);
            break;
        }
        assert_eq!(answer, Err(Refusal::Busy(Busy::DriveActive)), "at look {look}");
        assert_eq!(rig.controller.active, in_force, "at look {look}");
        // What was uploaded is still there, and comes into force after the stop.
        rig.render(100);
        rig.accepted(&Command::TableCommit);
        assert_ne!(rig.controller.active, in_force);
    }
}

/// The knots of a table that takes two chunks.
const KNOTS: usize = CHUNK_KNOTS + 3;

fn knot(index: u16) -> Knot {
    Knot { step: (u32::from(index) + 1) << 20, gain: Gain::FULL }
}

fn header() -> TableHeader {
    let crc = table::digest(0, 300_000, RATE, KNOTS as u16, knot);
    TableHeader { knots: KNOTS as u16, span_start_um: 0, span_end_um: 300_000, sample_rate_hz: RATE, crc }
}

fn chunk(first: usize, until: usize) -> Command {
    let knots = (first..until).map(|index| knot(index as u16)).collect();
    Command::TableChunk(TableChunk { first: first as u16, knots })
}

#[test]
fn a_stop_is_looked_for_every_few_knots_of_a_chunk_which_is_taken_whole() {
    for look in 0.. {
        let mut rig = Rig::armed();
        rig.accepted(&full_scale(Apply::Next));
        assert!(rig.render(100));
        rig.accepted(&Command::TableBegin(header()));
        let (answer, looks) = stopped_at(&mut rig, look, &chunk(0, CHUNK_KNOTS));
        assert!(matches!(answer, Ok(Event::Accepted(_))), "at look {look}: {answer:?}");
        if looks == look {
            assert!(looks as usize >= CHUNK_KNOTS.div_ceil(KNOTS_AT_ONCE), "{looks} looks");
            break;
        }
        rig.render(100);
        assert!(!rig.render(10), "at look {look}");
        rig.accepted(&chunk(CHUNK_KNOTS, KNOTS));
        rig.accepted(&Command::TableCommit);
        assert_eq!(rig.reported_crc(), Some(header().crc), "at look {look}");
    }
}

#[test]
fn a_stop_is_looked_for_every_few_knots_of_a_digest() {
    let mut rig = Rig::armed();
    for command in [
        Command::TableBegin(header()),
        chunk(0, CHUNK_KNOTS),
        chunk(CHUNK_KNOTS, KNOTS),
        Command::TableCommit,
    ] {
        rig.accepted(&command);
    }
    let (answer, looks) = stopped_at(&mut rig, 0, &Command::TableDigest);
    let Ok(Event::Table(TableReport { active: Some(active), .. })) = answer else { panic!("{answer:?}") };
    assert_eq!(active.crc, header().crc);
    assert!(looks as usize >= KNOTS.div_ceil(KNOTS_AT_ONCE), "{looks} looks");
}
