//! Before and after a calibration: the two plates by one key, with the lines where they are.

use crate::session::Session;
use slipline_instrument::{CalibrationSide, MeasureIntent};
use std::sync::Arc;

fn side(session: &Session) -> Option<CalibrationSide> {
    session.instrument.shown().calibration_side
}

fn plate_name(session: &Session) -> String {
    session.instrument.desk.setup().plate.name().to_owned()
}

/// Shows the other plate, as a gesture of its own, until its table is made and driven.
fn show_other(session: &mut Session) {
    session.instrument.desk.begin_gestures(1);
    session.instrument.show_before_or_after();
    session.pass(1500);
}

#[test]
fn one_key_shows_the_plate_before_a_calibration_and_after_it_while_the_line_stays() {
    let mut session = Session::felt_at_bench();
    assert_eq!(side(&session), None);
    show_other(&mut session);
    assert!(session.notice().contains("no calibrated plate is in use"), "{}", session.notice());
    session.instrument.perform_measure(MeasureIntent::Secret(true));
    let (line_mm, file) = (session.line_mm(), Arc::clone(&session.instrument.desk.setup().plate));
    session.calibrate_by_measuring();
    let calibrated = Arc::clone(&session.instrument.desk.setup().plate);
    assert_eq!(side(&session), Some(CalibrationSide::After));
    for (wanted, plate) in [(CalibrationSide::Before, &file), (CalibrationSide::After, &calibrated)] {
        show_other(&mut session);
        assert_eq!(side(&session), Some(wanted));
        assert!(Arc::ptr_eq(plate, &session.instrument.desk.setup().plate), "{}", plate_name(&session));
        assert!((session.line_mm() - line_mm).abs() < 0.1, "{wanted:?}: {line_mm} {}", session.line_mm());
        assert!(session.is_driving(), "{wanted:?}: {}", session.notice());
        let shown = session.instrument.shown();
        assert!(shown.measure.live.is_secret_measured, "the hidden plate stays the one that was measured");
        assert!(!shown.measure.shelf.entries().is_empty(), "{wanted:?}: its measurements stay");
    }
    // While it is measured it is not exchanged.
    session.instrument.perform_measure(MeasureIntent::Begin(None));
    session.until("it measures", Session::is_measuring);
    show_other(&mut session);
    assert_eq!(side(&session), Some(CalibrationSide::After));
    assert!(session.is_measuring() && session.notice().contains("is being measured"), "{}", session.notice());
    session.instrument.press_stop();
    session.end_of_measuring();
    // A step of undo, as any other change of the plate.
    session.instrument.undo();
    session.pass(500);
    assert_eq!(side(&session), Some(CalibrationSide::Before));
    // Another plate has neither.
    session.change_plate(slipline_plate::preset("al-bending").unwrap());
    session.pass(500);
    assert_eq!(side(&session), None);
}
