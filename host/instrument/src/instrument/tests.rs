//! An instrument on a simulated device in virtual time: the cost of a frame, and the precedence of sources.

use super::*;
use slipline_link::simulator::loopback::Loopback;
use slipline_link::{Request, Snapshot, Sounding, Ticket};
use slipline_model::setup::edit::{Edit, EditError};
use slipline_model::setup::undo::{EditSource, Gesture};
use std::cell::{Cell, RefCell};
use std::rc::Rc;
use std::sync::Arc;
use std::thread::LocalKey;

thread_local! {
    /// Number of chords computed.
    pub(super) static CHORDS: Cell<u32> = const { Cell::new(0) };
    /// Number of fields solved.
    pub(super) static FIELDS: Cell<u32> = const { Cell::new(0) };
    /// Number of ranges of a line that were found.
    pub(super) static LIMITS: Cell<u32> = const { Cell::new(0) };
}

pub(super) fn count(counter: &'static LocalKey<Cell<u32>>) {
    counter.set(counter.get() + 1);
}

/// A link whose snapshot stays as it is; it records the requests.
#[derive(Clone)]
pub(super) struct StillLink {
    pub(super) sent: Rc<RefCell<Vec<Request>>>,
    snapshot: Arc<Snapshot>,
}

impl StillLink {
    pub(super) fn with(snapshot: Snapshot) -> Self {
        Self { sent: Rc::default(), snapshot: Arc::new(snapshot) }
    }
}

impl Link for StillLink {
    fn send(&self, request: Request) -> Ticket {
        self.sent.borrow_mut().push(request);
        Ticket(self.sent.borrow().len() as u64)
    }

    fn snapshot(&self) -> Arc<Snapshot> {
        Arc::clone(&self.snapshot)
    }
}

pub(super) struct Wire {
    loopback: RefCell<Loopback>,
    sent: RefCell<Vec<Request>>,
}

struct Wired(Rc<Wire>);

impl Link for Wired {
    fn send(&self, request: Request) -> Ticket {
        self.0.sent.borrow_mut().push(request.clone());
        self.0.loopback.borrow_mut().hand_over(request)
    }

    fn snapshot(&self) -> Arc<Snapshot> {
        let loopback = self.0.loopback.borrow();
        // The loopback does not count revisions.
        Arc::new(Snapshot { revision: loopback.samples(), ..loopback.view().clone() })
    }
}

impl Wire {
    /// Runs the device for 10 ms, then turns the instrument.
    pub(super) fn turn(&self, instrument: &mut Instrument) {
        self.loopback.borrow_mut().pass(4_000, |_| ());
        instrument.take_reports();
        instrument.turn();
    }

    /// Drives, stops and arming requests since the last call.
    fn sent(&self) -> Vec<Request> {
        let mut sent = self.sent.take();
        sent.retain(|request| {
            matches!(request, Request::Play(_) | Request::Stop | Request::Arm | Request::Disarm)
        });
        sent
    }
}

/// An instrument that drives a membrane.
pub(super) fn driven() -> (Instrument, Rc<Wire>) {
    driven_with(Jobs::inline())
}

/// As [`driven`], with these jobs.
pub(super) fn driven_with(jobs: Jobs) -> (Instrument, Rc<Wire>) {
    let loopback = RefCell::new(Loopback::connect(400_000).unwrap());
    let wire = Rc::new(Wire { loopback, sent: RefCell::default() });
    let setup = Setup::new(Arc::new(slipline_plate::preset("membrane").unwrap()));
    let link = Box::new(Wired(Rc::clone(&wire)));
    let mut instrument = Instrument::new(link, jobs, Bench::default(), setup);
    for _ in 0..1000 {
        wire.turn(&mut instrument);
        if instrument.screen.is_sounding() {
            break;
        }
        if !instrument.shown().drive_wanted {
            instrument.start();
        }
    }
    assert!(instrument.screen.is_sounding());
    wire.sent();
    (instrument, wire)
}

#[test]
fn moves_of_one_frame_are_recorded_predicted_once_and_looked_at_once_for_a_chord() {
    let (mut instrument, _wire) = driven();
    instrument.record(true);
    let (start_m, end_m) = instrument.shown().limits_m;
    CHORDS.set(0);
    FIELDS.set(0);
    let at = |share: f64| start_m + share * (end_m - start_m);
    instrument.drag_line(0, &[at(0.3), at(2.0), at(0.5)]);
    instrument.turn();
    for _ in 0..2 {
        let _ = instrument.shown();
    }
    assert_eq!((CHORDS.get(), FIELDS.get()), (1, 1));
    let moves = instrument.desk.recorder().recording().moves().iter();
    let places_m: Vec<f64> = moves.map(|step| step.place_m).collect();
    let is_at = |(place_m, share): (&f64, f64)| (place_m - at(share)).abs() < 1e-5;
    assert!(places_m.len() == 3 && places_m.iter().zip([0.3, 1.0, 0.5]).all(is_at), "{places_m:?}");
}

#[test]
fn the_newest_change_counts_a_stop_ends_every_source_and_the_user_alone_drives_again() {
    let (mut instrument, wire) = driven();
    let (start_m, end_m) = instrument.desk.setup().plate.span_m();
    let move_to = |share: f64| Edit::Move { slot: 0, position_m: start_m + share * (end_m - start_m) };
    let program = Gesture { source: EditSource::Program("score"), number: 1 };
    let share = |request: &Request| {
        let Request::Play(Sounding::Drive(drive)) = request else { panic!("{request:?}") };
        ((drive.tones[0].boundary_m - start_m) / (end_m - start_m) * 100.0).round()
    };
    instrument.edit_by(program, &move_to(0.2)).unwrap();
    instrument.edit(&move_to(0.6));
    instrument.edit_by(program, &move_to(0.4)).unwrap();
    assert_eq!(wire.sent().iter().map(share).collect::<Vec<f64>>(), [20.0, 60.0, 40.0]);
    wire.turn(&mut instrument);
    assert!(wire.sent().is_empty());

    instrument.record(true);
    instrument.drag_line(0, &[start_m, end_m]);
    instrument.record(false);
    instrument.desk.play(true);
    wire.sent();
    instrument.stop();
    assert!(instrument.desk.recorder().played_s().is_none());
    for number in 0..50 {
        instrument.edit_by(Gesture { number, ..program }, &move_to(0.01 * number as f64)).unwrap();
        wire.turn(&mut instrument);
    }
    assert!(matches!(wire.sent()[..], [Request::Stop]));
    instrument.disarm();
    wire.turn(&mut instrument);
    instrument.edit_by(program, &move_to(0.7)).unwrap();
    wire.turn(&mut instrument);
    assert!(matches!(wire.sent()[..], [Request::Stop, Request::Disarm]));
    instrument.start();
    for _ in 0..50 {
        wire.turn(&mut instrument);
    }
    let sent = wire.sent();
    assert!(matches!(sent[..], [Request::Arm, Request::Play(_)]), "{sent:?}");
    assert_eq!(share(&sent[1]), 70.0);
}

#[test]
fn an_edits_remark_goes_to_its_source_alone() {
    let (mut instrument, _wire) = driven();
    let program = Gesture { source: EditSource::Program("score"), number: 1 };
    let full = Edit::Level { slot: 0, level: 1.0 };
    let refused = Edit::Level { slot: 9, level: 1.0 };
    let add = Edit::Add { position_m: 0.15 };
    assert_eq!(instrument.edit_by(program, &full), Ok(None));
    assert_eq!(instrument.edit_by(program, &refused), Err(EditError::NoTone(9)));
    let remark = instrument.edit_by(program, &add).unwrap().unwrap();
    assert!(remark.starts_with("Master lowered to "), "{remark}");
    assert_eq!(instrument.out.notices().count(), 0, "the user did nothing");
    instrument.undo();
    let mut shown = |edit| {
        instrument.edit(edit);
        instrument.out.notices().last().map(|notice| notice.text.clone())
    };
    assert_eq!(shown(&add), Some(remark));
    assert_eq!(shown(&refused).as_deref(), Some("There is no tone 10"));
}

#[test]
fn a_fit_that_comes_after_another_change_belongs_to_no_drawing_any_more() {
    let (mut instrument, wire) = driven();
    let stroke = [(0.05, 2e-6), (0.2, 1e-6)];
    let settle = |instrument: &mut Instrument| {
        for _ in 0..5 {
            wire.turn(instrument);
        }
    };
    // A fit is asked for in a turn and taken in the next one.
    instrument.desk.begin_gestures(1);
    instrument.draw_texture(&stroke);
    wire.turn(&mut instrument);
    assert!(instrument.shown().texture.is_drawn);
    instrument.edit(&Edit::Level { slot: 0, level: 0.3 });
    settle(&mut instrument);
    assert_eq!(instrument.desk.setup().tones.len(), 1, "{:?}", instrument.desk.setup().tones);
    assert!(!instrument.shown().texture.is_drawn);
    // One that comes after the stroke has ended does belong to it, and undo takes back the whole of it.
    let before = instrument.desk.setup().clone();
    instrument.desk.begin_gestures(1);
    instrument.draw_texture(&stroke);
    settle(&mut instrument);
    instrument.draw_texture(&[(0.2, 1e-6), (0.25, 1e-6)]);
    instrument.desk.begin_gestures(1);
    settle(&mut instrument);
    assert!(instrument.desk.setup().tones.len() > 1 && instrument.shown().texture.is_drawn);
    instrument.undo();
    assert_eq!(instrument.desk.setup(), &before);
    settle(&mut instrument);
    assert_eq!(instrument.desk.setup(), &before, "nothing comes later");
}

#[test]
fn a_second_stroke_goes_on_from_the_height_that_the_first_one_has_reached() {
    let (mut instrument, wire) = driven();
    let settle = |instrument: &mut Instrument| {
        for _ in 0..5 {
            wire.turn(instrument);
        }
    };
    let height_m = |instrument: &Instrument| instrument.shown().texture.draft.drawn_m(0.1).unwrap();
    // Half a metre is beyond every plate.
    instrument.desk.begin_gestures(1);
    instrument.draw_texture(&[(0.05, 0.5), (0.2, 0.5)]);
    settle(&mut instrument);
    let reached = instrument.shown().texture.reached;
    let seen_m = reached * height_m(&instrument);
    assert!(reached > 0.0 && seen_m < 1e-2, "{reached}");
    instrument.desk.begin_gestures(1);
    instrument.draw_texture(&[(0.22, 0.5 * seen_m), (0.25, 0.5 * seen_m)]);
    assert!((height_m(&instrument) / seen_m - 1.0).abs() < 1e-6, "{seen_m}");
    settle(&mut instrument);
    assert!(instrument.shown().texture.reached > 0.5, "{}", instrument.shown().texture.reached);
}
