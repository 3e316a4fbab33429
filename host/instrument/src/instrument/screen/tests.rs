//! The screen of an instrument on a simulated device in virtual time, and the pace of a drawing.

use super::*;
use crate::instrument::Instrument;
use crate::instrument::tests::{LIMITS, driven, driven_with};
use slipline_model::field::sheet::{self, SheetJob};
use slipline_model::jobs::JobQueue;
use slipline_model::setup::edit::Edit;
use slipline_model::setup::undo::{EditSource, Gesture};
use std::cell::RefCell;
use std::rc::Rc;

fn limits_m(instrument: &Instrument) -> (f64, f64) {
    instrument.shown().limits_m
}

#[test]
fn the_range_of_a_line_is_computed_once_until_its_inputs_change() {
    let (mut instrument, wire) = driven();
    let range_m = limits_m(&instrument);
    LIMITS.set(0);
    for number in 0..20 {
        let share = 0.3 + 0.02 * f64::from(number);
        instrument.drag_line(0, &[range_m.0 + share * (range_m.1 - range_m.0)]);
        wire.turn(&mut instrument);
        assert_eq!(limits_m(&instrument), range_m);
    }
    assert_eq!(LIMITS.get(), 0, "a drag changes nothing that it follows from");
    let found = |instrument: &Instrument| {
        let setup = instrument.desk.setup();
        slipline_model::field::line::limits_m(setup, &setup.tones[0], instrument.drive.drive_table())
    };
    for edit in [Edit::Level { slot: 0, level: 0.3 }, Edit::Master(-6.0)] {
        instrument.edit(&edit);
        assert_eq!(limits_m(&instrument), found(&instrument), "{edit:?}");
        assert_ne!(limits_m(&instrument), range_m, "{edit:?}");
    }
    assert_eq!(LIMITS.get(), 2);
}

#[test]
fn a_drag_gives_the_sheet_its_last_drive_alone_and_draws_the_modal_lines_meanwhile() {
    let drives: Rc<RefCell<Vec<u64>>> = Rc::default();
    let (given, mut work) = (Rc::clone(&drives), sheet::work());
    let sheets = JobQueue::inline(move |job: SheetJob, task: &_| {
        given.borrow_mut().push(job.drive.number);
        work(job, task)
    });
    let (mut instrument, wire) = driven_with(Jobs { sheets, ..Jobs::inline() });
    wire.turn(&mut instrument);
    assert!(instrument.screen.sheet().is_some());
    let (start_m, end_m) = limits_m(&instrument);
    drives.take();
    instrument.attend(Attention { is_dragging: true, ..Attention::default() });
    let mut sounded = Vec::new();
    for step in 0..20 {
        instrument.drag_line(0, &[start_m + (0.3 + 0.02 * f64::from(step)) * (end_m - start_m)]);
        for _ in 0..3 {
            wire.turn(&mut instrument);
            instrument.move_on(0.01);
        }
        sounded.extend(instrument.screen.playback.sounding.as_ref().map(|sounding| sounding.number));
        assert!(step == 0 || instrument.screen.sheet().is_none(), "{step}");
    }
    sounded.dedup();
    assert!(sounded.len() > 10, "{sounded:?}");
    assert!(drives.borrow().iter().all(|number| !sounded[1..].contains(number)), "{drives:?}");
    instrument.attend(Attention::default());
    wire.turn(&mut instrument);
    wire.turn(&mut instrument);
    assert_eq!(drives.borrow().last(), sounded.last());
    assert!(instrument.screen.sheet().is_some());
}

#[test]
fn the_tones_of_a_drawing_are_sent_three_times_a_second_and_another_change_ends_it() {
    let (mut brush, mut out) = (Brush::default(), Outbox::default());
    brush.begin_stroke(Gesture { source: EditSource::User, number: 1 });
    let mut due = |brush: &mut Brush, now_s, is_driven| {
        brush.follow_change(true);
        brush.is_due(now_s, is_driven, &mut out)
    };
    let times_s = [5.0, 5.1, 5.2, 5.31, 5.4];
    assert_eq!(times_s.map(|now_s| due(&mut brush, now_s, true)), [true, false, false, true, false]);
    assert!(!due(&mut brush, 7.0, false), "the plate is not driven");
    brush.follow_change(false);
    assert!(!brush.is_drawn() && !brush.is_due(9.0, true, &mut out));
}
