//! The tour: its order, its pages, and what counts as done.

use crate::session::Session;
use slipline_instrument::{CalibrateIntent, MeasureIntent, Output, Page, TourScene, TourStep};
use slipline_model::field::touch::Touch;
use slipline_model::setup::edit::Edit;

fn tour(session: &Session) -> Option<TourScene> {
    session.instrument.shown().tour
}

/// The page that the latest step has opened.
fn opened(session: &mut Session) -> Option<Page> {
    let outputs = session.instrument.out.take_outputs();
    outputs.into_iter().find_map(|output| if let Output::Open(page) = output { Some(page) } else { None })
}

/// A step, the page that it opens, and what the user does there.
type Does = (TourStep, Page, fn(&mut Session));

#[test]
fn each_step_opens_the_page_of_its_control_and_is_done_when_the_user_has_done_it() {
    let (mut session, _bench) = Session::at_bench();
    session.instrument.press_stop();
    session.pass(1500);
    assert!(!session.is_driving() && tour(&session).is_none());
    session.instrument.begin_tour();
    let does: [Does; 6] = [
        (TourStep::Line, Page::Boundary, |session| session.move_to(session.line_mm() - 20.0)),
        (TourStep::Finger, Page::Boundary, |session| {
            let place_m = session.instrument.screen.finger_place_m();
            session.instrument.screen.move_finger(place_m - 0.02);
        }),
        (TourStep::Texture, Page::Texture, |session| session.edit(&Edit::Add { position_m: 0.12 })),
        (TourStep::Measure, Page::Measurements, |session| {
            session.instrument.perform_measure(MeasureIntent::Begin(None));
        }),
        (TourStep::Calibrate, Page::Measurements, |session| {
            session.instrument.perform_calibrate(CalibrateIntent::Open);
        }),
        (TourStep::OwnPlate, Page::Plate, |session| {
            session.change_plate(slipline_plate::preset("al-bending").unwrap());
        }),
    ];
    for (step, page, acts) in does {
        assert_eq!(opened(&mut session), Some(page), "{step:?}");
        session.pass(300);
        assert_eq!(tour(&session), Some(TourScene { step, is_done: false }));
        acts(&mut session);
        session.pass(300);
        assert_eq!(tour(&session), Some(TourScene { step, is_done: true }), "{}", session.notice());
        session.instrument.next_step();
    }
    assert_eq!(tour(&session), None, "it ends after the last step");
}

#[test]
fn the_tour_drives_the_simulated_plate_and_lays_a_finger_that_takes_nothing() {
    let mut session = Session::driving();
    let setup = session.instrument.desk.setup().clone();
    session.instrument.press_stop();
    session.pass(1500);
    session.instrument.begin_tour();
    session.until("it drives", Session::is_driving);
    assert_eq!(session.instrument.shown().touch, Touch::None);
    session.instrument.next_step();
    assert_eq!(session.instrument.shown().touch, Touch::Ideal);
    // Back and forth as one likes; nothing before the first step, and its end is no change of the setup.
    session.instrument.step_back();
    session.instrument.step_back();
    session.pass(100);
    assert_eq!(tour(&session), Some(TourScene { step: TourStep::Line, is_done: false }));
    session.instrument.end_tour();
    session.pass(100);
    assert_eq!((tour(&session), session.instrument.desk.setup()), (None, &setup));
}

#[test]
fn a_minute_is_enough_to_read_and_do_the_tour() {
    // Slow readers take 150 words a minute; half of the minute is for the hands.
    let words: usize = TourStep::ALL.iter().map(|step| step.sentence().split_whitespace().count()).sum();
    assert!(words <= 100, "{words}");
}
