//! The setup and its sources, without a device.

use super::*;
use crate::instrument::outbox::Outbox;

const PROGRAM: Gesture = Gesture { source: EditSource::Program("score"), number: 1 };

fn desk() -> Desk {
    Desk::new(Setup::new(Arc::new(slipline_plate::preset("membrane").unwrap())))
}

fn edited(desk: &mut Desk, gesture: Gesture, edit: &Edit) -> Option<SetupChange> {
    desk.edit(gesture, edit, &[], None).unwrap()
}

fn by_user(desk: &mut Desk, edit: &Edit) -> Option<SetupChange> {
    edited(desk, desk.gesture(), edit)
}

#[test]
fn an_edit_returns_what_its_source_must_know() {
    let mut desk = desk();
    let add = |position_m| Edit::Add { position_m };
    let change = edited(&mut desk, PROGRAM, &add(0.15)).unwrap();
    assert_eq!(change, SetupChange { remark: change.remark.clone(), ..SetupChange::default() });
    assert!(change.remark.unwrap().starts_with("Master lowered to "));
    assert_eq!(desk.selected(), 1, "an added tone is selected");
    let remark = edited(&mut desk, PROGRAM, &add(9.0)).unwrap().remark.unwrap();
    assert!(remark.contains("Tone 3 is at "), "{remark}");
    let refused = desk.edit(PROGRAM, &Edit::Level { slot: 9, level: 1.0 }, &[], None);
    assert_eq!(refused, Err(EditError::NoTone(9)));
    let level = Edit::Level { slot: 0, level: 0.5 };
    assert_eq!(edited(&mut desk, PROGRAM, &level), Some(SetupChange::default()));
    assert_eq!(edited(&mut desk, PROGRAM, &level), None, "nothing changes");
}

#[test]
fn undo_takes_back_the_latest_gesture_and_a_switch_keeps_the_setup_it_leaves() {
    let mut desk = desk();
    let first = desk.setup().clone();
    by_user(&mut desk, &Edit::Master(-3.0));
    let second = desk.setup().clone();
    assert_eq!(desk.undo(), Some(SetupChange::default()));
    assert_eq!(desk.setup(), &first);
    assert_eq!(desk.undo(), None, "nothing is left to undo");
    desk.redo();
    desk.begin_gestures(1);
    let switch = desk.switch();
    assert_eq!(by_user(&mut desk, &switch), None, "B begins as a copy of A");
    by_user(&mut desk, &Edit::Master(-6.0));
    desk.begin_gestures(1);
    let switch = desk.switch();
    by_user(&mut desk, &switch);
    assert_eq!(desk.setup(), &second);
    desk.undo();
    assert_eq!((desk.setup().master_db, desk.compare().other()), (-6.0, Some(&second)));
}

#[test]
fn a_replay_returns_each_move_once_and_ends_with_the_drive() {
    let (mut desk, mut out) = (desk(), Outbox::default());
    desk.record(true, &mut out);
    for (place_m, now_s) in [(0.10, 5.0), (0.12, 5.05), (0.14, 5.10)] {
        desk.note_move(0, place_m, now_s, &mut out);
    }
    desk.record(false, &mut out);
    desk.play(true);
    let mut due = |desk: &mut Desk, now_s, is_driven| {
        let moves = desk.due_moves(now_s, is_driven, &mut out);
        moves.into_iter().flatten().map(|step| step.place_m).collect::<Vec<f64>>()
    };
    assert_eq!(due(&mut desk, 9.0, true), [0.10]);
    assert_eq!(due(&mut desk, 9.06, true), [0.12]);
    assert!(due(&mut desk, 9.2, false).is_empty() && desk.recorder().played_s().is_none());
}
