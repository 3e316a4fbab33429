//! Two setups to compare, and a recorded drag: what is moved and sent, and what ends a replay.

use crate::session::{Session, drives};
use slipline_link::{Request, Sounding};
use slipline_model::setup::compare::Side;

/// Records a drag of the line in 12 steps; returns where it was at each, in millimetres.
fn record_drag(session: &mut Session) -> Vec<f64> {
    session.instrument.record(true);
    session.pass(100);
    session.instrument.desk.begin_gestures(1);
    session.attention.is_dragging = true;
    let start_m = session.line_m();
    let mut places = Vec::new();
    for step in 1..=12 {
        session.instrument.drag_line(0, &[start_m + 2e-3 * f64::from(step)]);
        session.pass(100);
        places.push(session.line_mm());
    }
    session.attention.is_dragging = false;
    session.instrument.record(false);
    session.pass(100);
    places
}

/// The places of the line in this many turns, in millimetres.
fn watch(session: &mut Session, turns: usize) -> Vec<f64> {
    (0..turns)
        .map(|_| {
            session.pass(50);
            session.line_mm()
        })
        .collect()
}

fn is_playing(session: &Session) -> bool {
    session.instrument.desk.recorder().played_s().is_some()
}

fn near(mm: f64, wanted_mm: f64) -> bool {
    (mm - wanted_mm).abs() < 1e-6
}

#[test]
fn two_setups_are_switched_the_device_follows_and_undo_takes_it_back() {
    let mut session = Session::driving();
    // The side on the screen, its line and that of the other side.
    let is = |session: &Session, side: Side, mm: f64, other_mm: f64| {
        let compare = session.instrument.shown().compare.clone();
        let other = compare.other().map(|other| other.tones[0].position_m * 1e3);
        compare.side() == side && near(session.line_mm(), mm) && other.is_some_and(|it| near(it, other_mm))
    };
    assert!(session.instrument.shown().compare.other().is_none(), "B begins as a copy");
    session.instrument.switch_setups();
    session.move_to(181.0);
    assert!(is(&session, Side::B, 181.0, 180.0));
    session.take_requests();
    session.instrument.desk.begin_gestures(1);
    session.instrument.switch_setups();
    session.pass(100);
    assert!(is(&session, Side::A, 180.0, 181.0));
    let sent = drives(&session.take_requests());
    assert!(sent.len() == 1 && near(sent[0], 180.0), "the device follows: {sent:?}");
    session.instrument.desk.begin_gestures(1);
    session.instrument.switch_setups();
    assert!(is(&session, Side::B, 181.0, 180.0));
    session.instrument.undo();
    assert!(is(&session, Side::A, 180.0, 181.0), "B waits again");
    session.instrument.redo();
    assert!(is(&session, Side::B, 181.0, 180.0));
}

#[test]
fn a_recorded_drag_is_played_through_the_way_of_a_drag() {
    let mut session = Session::driving();
    let recorded = record_drag(&mut session);
    assert_eq!(session.instrument.desk.recorder().recording().moves().len(), recorded.len());
    session.take_requests();
    session.instrument.desk.play(true);
    let mut seen = watch(&mut session, 40);
    seen.dedup();
    let last = *recorded.last().unwrap();
    assert!(seen.contains(&last) && seen.len() >= recorded.len() - 2, "{seen:?} {recorded:?}");
    let sent = session.take_requests();
    assert!(drives(&sent).len() >= recorded.len() - 2, "{sent:?}");
    assert!(sent.iter().all(|request| matches!(request, Request::Play(Sounding::Drive(_)))), "{sent:?}");
    assert!(!is_playing(&session), "it has ended");
    // Undo takes the whole replay back.
    session.instrument.undo();
    assert!((session.line_mm() - last).abs() < 1e-9, "it began and ended there");
}

#[test]
fn a_replay_ends_with_the_drive_and_starts_none() {
    let mut session = Session::driving();
    record_drag(&mut session);
    session.instrument.desk.loop_replay(true);
    session.instrument.desk.play(true);
    // Longer than the recording.
    let first = watch(&mut session, 120);
    assert!(is_playing(&session));
    assert!(first[60..].iter().any(|mm| (mm - first[70]).abs() > 1.0), "it goes on moving");
    session.instrument.press_stop();
    session.pass(200);
    assert!(!session.is_driving() && !is_playing(&session));
    session.take_requests();
    let still = session.line_mm();
    assert!(watch(&mut session, 20).iter().all(|mm| *mm == still));
    // A replay while nothing is driven moves the picture alone.
    session.instrument.desk.play(true);
    assert!(watch(&mut session, 30).iter().any(|mm| *mm != still));
    assert!(session.take_requests().is_empty() && !session.is_driving());
    // A drive that ends by itself, such as after a stall of the window, ends the replay.
    session.instrument.start();
    session.pass(300);
    assert!(session.is_driving());
    session.hang(2000);
    session.pass(300);
    assert!(!session.is_driving() && !is_playing(&session));
    session.pass(300);
    assert!(!session.is_driving());
}

#[test]
fn a_bad_recording_is_refused_and_a_place_off_the_span_is_as_near_as_the_line_can_be() {
    let mut session = Session::driving();
    record_drag(&mut session);
    let text = session.instrument.desk.recorder().recording().to_csv();
    assert!(text.starts_with("time_s,tone,place_m\n0.0000,1,0.18"), "{text}");
    assert!(session.instrument.opened_table("bad.csv", &text.replacen("0.0000,1", "0.0000,77", 1)));
    let told = session.notice();
    assert!(told.contains("bad.csv was not opened") && told.contains("tone = 77: must be 1 to 16"), "{told}");
    assert_eq!(session.instrument.desk.recorder().recording().to_csv(), text);
    assert!(session.instrument.opened_table("two.csv", "time_s,tone,place_m\n0,1,0.1\n0.5,1,9.9\n"));
    assert_eq!(session.instrument.desk.recorder().recording().moves().len(), 2);
    session.instrument.desk.play(true);
    session.pass(3000);
    assert!(near(session.line_mm(), 280.0));
}

#[test]
fn a_time_of_the_recording_is_chosen_as_one_step_and_the_replay_begins_there() {
    let mut session = Session::driving();
    let recorded = record_drag(&mut session);
    let last = session.line_mm();
    let moves = session.instrument.desk.recorder().recording().moves().to_vec();
    let length_s = moves.last().unwrap().time_s;
    let head_s = |session: &Session| session.instrument.desk.recorder().head_s().unwrap();
    let choose = |session: &mut Session, share: f64| {
        session.instrument.seek(share * length_s);
        session.pass(50);
    };
    session.take_requests();
    session.instrument.desk.begin_gestures(1);
    choose(&mut session, 0.5);
    let due = moves.iter().rfind(|step| step.time_s <= 0.5 * length_s + 1e-6).unwrap().place_m * 1e3;
    assert!(near(session.line_mm(), due) && recorded.contains(&session.line_mm()), "{due}");
    assert!((head_s(&session) / length_s - 0.5).abs() < 1e-6, "{}", head_s(&session));
    choose(&mut session, 0.0);
    assert!(near(session.line_mm(), recorded[0]), "{} {recorded:?}", session.line_mm());
    assert!(drives(&session.take_requests()).len() >= 2, "the plate follows, as it is driven");
    // The whole drag along it is one step.
    session.instrument.undo();
    assert!((session.line_mm() - last).abs() < 1e-9);
    // A replay begins where it stands, and a choice while it plays goes on from there.
    session.instrument.desk.begin_gestures(1);
    choose(&mut session, 0.9);
    session.instrument.desk.play(true);
    session.turn();
    assert!(head_s(&session) >= 0.89 * length_s, "{}", head_s(&session));
    session.instrument.desk.begin_gestures(1);
    choose(&mut session, 0.2);
    assert!(is_playing(&session) && head_s(&session) < 0.6 * length_s, "{}", head_s(&session));
    // It starts no drive.
    session.instrument.press_stop();
    session.pass(300);
    session.take_requests();
    choose(&mut session, 0.5);
    assert!(session.take_requests().is_empty() && !session.is_driving());
}
