//! Lines that hold felt edges: what moves them, and what moves the turning points under them instead.

use crate::session::{Session, membrane};
use slipline_model::field::line::{Holds, Line};
use slipline_model::setup::Setup;
use slipline_model::setup::edit::Edit;
use slipline_plate::Plate;
use slipline_plate::feeling::Feeling;

/// A plate whose line holds a felt edge, driven at this level.
fn felt(plate: Plate, level: f64) -> Session {
    let mut setup = Setup::new(plate.into());
    setup.tones[0].level = level;
    Session::driving_setup(setup)
}

fn stays(session: &Session, before_mm: f64) -> bool {
    (session.line_mm() - before_mm).abs() < 0.01
}

#[test]
fn neither_a_level_nor_another_tone_moves_the_line() {
    let mut session = felt(slipline_plate::preset("al-bending").unwrap(), 0.8);
    let before_mm = session.line_mm();
    let turning_point_m = session.instrument.desk.setup().tones[0].position_m;
    session.edit(&Edit::Master(-6.0));
    assert!(stays(&session, before_mm), "{before_mm} {}", session.line_mm());
    assert!(session.instrument.desk.setup().tones[0].position_m > turning_point_m + 0.005);
    // Its master is lowered for it.
    session.edit(&Edit::Master(0.0));
    let (start_m, end_m) = session.instrument.desk.setup().plate.span_m();
    session.edit(&Edit::Add { position_m: 0.5 * (start_m + end_m) });
    assert!(session.instrument.desk.setup().master_db < -1.0);
    assert!(stays(&session, before_mm), "{before_mm} {}", session.line_mm());
}

#[test]
fn the_line_holds_what_it_held_when_a_finger_feels_less() {
    let mut session = felt(membrane(1.0), 0.03);
    let before_mm = session.line_mm();
    session.edit(&Edit::Feeling(Feeling { threshold: 2.0, ..Feeling::default() }));
    assert_eq!(session.instrument.desk.setup().feeling.threshold, 2.0);
    assert!(stays(&session, before_mm));
    // The turning point has moved, so that the line could stay.
    let setup = session.instrument.desk.setup();
    let line = Line::of(setup, &setup.tones[0], None);
    assert!(line.holds == Holds::TurningPoint && line.place_m > 0.18 + 0.001, "{line:?}");
}
