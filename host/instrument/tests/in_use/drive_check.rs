//! "Is it on?" before a measurement: the result for a drive that is on, for one that is off, and for a device that
//! cannot see it.

use crate::sensors::{Half, NoCurrent};
use crate::session::Session;
use slipline_instrument::{MeasureDraft, MeasureIntent};

/// Begins a measurement that checks first that the drive is on.
fn begin(session: &mut Session) {
    let draft = MeasureDraft { is_checked: true, ..MeasureDraft::default() };
    session.instrument.perform_measure(MeasureIntent::Draft(draft));
    session.instrument.perform_measure(MeasureIntent::Begin(None));
    session.pass(500);
}

/// The number of measurements.
fn count(session: &Session) -> usize {
    session.instrument.shown().measure.shelf.entries().len()
}

#[test]
fn a_drive_is_measured_once_quiet_tones_have_shown_that_it_is_on() {
    let mut session = Session::at_bench().0;
    assert!(session.instrument.shown().measure.live.is_drive_known, "the rig states its circuit itself");
    begin(&mut session);
    let is_checking = |session: &Session| session.instrument.shown().measure.live.is_checking;
    assert!(session.is_measuring() && is_checking(&session));
    session.end_of_measuring();
    assert!(
        session.is_logged("The drive is connected"),
        "{:?}",
        session.instrument.drive.snapshot().record.log
    );
    assert!(count(&session) == 1 && !is_checking(&session));
}

#[test]
fn a_drive_without_current_is_reported_in_its_sentence_and_not_measured() {
    let mut session = Session::sensed(NoCurrent(Half(5)));
    begin(&mut session);
    session.end_of_measuring();
    let failed = session.instrument.shown().measure.live.failed.unwrap().to_owned();
    assert!(failed.starts_with("Not measured. No current flows: a wire of the drive is open"), "{failed}");
    assert!(count(&session) == 0 && !session.is_driving() && !session.is_logged("The drive is connected"));
}

#[test]
fn a_device_without_a_second_input_cannot_check_and_says_so() {
    let mut session = Session::sensed(Half(6));
    begin(&mut session);
    assert!(session.notice().contains("no input for the drive's current"), "{}", session.notice());
    assert!(!session.is_measuring() && session.is_driving(), "nothing was stopped");
}
