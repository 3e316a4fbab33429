//! An instrument on a simulated device in virtual time: the cost of a frame, and the precedence of sources.

use super::*;
use slipline_link::Sounding;
use slipline_link::simulator::loopback::Loopback;
use slipline_model::field::sheet::{self, SheetJob};
use slipline_model::jobs::JobQueue;
use slipline_model::setup::edit::Edit;
use slipline_model::setup::undo::{EditSource, Gesture};
use std::cell::{Cell, RefCell};
use std::rc::Rc;
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

struct Wire {
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
    fn turn(&self, instrument: &mut Instrument) {
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
fn driven() -> (Instrument, Rc<Wire>) {
    driven_with(Jobs::inline())
}

/// As [`driven`], with these jobs.
fn driven_with(jobs: Jobs) -> (Instrument, Rc<Wire>) {
    let loopback = RefCell::new(Loopback::connect(400_000).unwrap());
    let wire = Rc::new(Wire { loopback, sent: RefCell::default() });
    let setup = Setup::new(Arc::new(slipline_plate::preset("membrane").unwrap()));
    let link = Box::new(Wired(Rc::clone(&wire)));
    let mut instrument = Instrument::new(link, jobs, Bench::default(), setup);
    for _ in 0..1000 {
        wire.turn(&mut instrument);
        if instrument.is_sounding() {
            break;
        }
        if !instrument.shown().drive_wanted {
            instrument.start();
        }
    }
    assert!(instrument.is_sounding());
    wire.sent();
    (instrument, wire)
}

#[test]
fn moves_of_one_frame_are_recorded_predicted_once_and_looked_at_once_for_a_chord() {
    let (mut instrument, _wire) = driven();
    instrument.record(true);
    let (start_m, end_m) = instrument.limits_m();
    CHORDS.set(0);
    FIELDS.set(0);
    let at = |share: f64| start_m + share * (end_m - start_m);
    instrument.drag_line(0, &[at(0.3), at(2.0), at(0.5)]);
    instrument.turn();
    for _ in 0..2 {
        let _ = instrument.shown();
    }
    assert_eq!((CHORDS.get(), FIELDS.get()), (1, 1));
    let moves = instrument.recorder().recording().moves().iter();
    let places_m: Vec<f64> = moves.map(|step| step.place_m).collect();
    let is_at = |(place_m, share): (&f64, f64)| (place_m - at(share)).abs() < 1e-5;
    assert!(places_m.len() == 3 && places_m.iter().zip([0.3, 1.0, 0.5]).all(is_at), "{places_m:?}");
}

#[test]
fn the_range_of_a_line_is_found_once_until_something_changes_that_it_follows_from() {
    let (mut instrument, wire) = driven();
    let range_m = instrument.limits_m();
    LIMITS.set(0);
    for number in 0..20 {
        let share = 0.3 + 0.02 * f64::from(number);
        instrument.drag_line(0, &[range_m.0 + share * (range_m.1 - range_m.0)]);
        wire.turn(&mut instrument);
        assert_eq!(instrument.shown().limits_m, range_m);
    }
    assert_eq!(LIMITS.get(), 0, "a drag changes nothing that it follows from");
    let found = |instrument: &Instrument| {
        let tone = &instrument.setup.tones[0];
        slipline_model::field::line::limits_m(&instrument.setup, tone, instrument.drive_table())
    };
    for edit in [Edit::Level { slot: 0, level: 0.3 }, Edit::Master(-6.0)] {
        instrument.edit(&edit);
        assert_eq!(instrument.limits_m(), found(&instrument), "{edit:?}");
        assert_ne!(instrument.limits_m(), range_m, "{edit:?}");
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
    assert!(instrument.shown_sheet().is_some());
    let (start_m, end_m) = instrument.limits_m();
    drives.take();
    instrument.attend(Attention { is_dragging: true, ..Attention::default() });
    let mut sounded = Vec::new();
    for step in 0..20 {
        instrument.drag_line(0, &[start_m + (0.3 + 0.02 * f64::from(step)) * (end_m - start_m)]);
        for _ in 0..3 {
            wire.turn(&mut instrument);
            instrument.move_on(0.01);
        }
        sounded.extend(instrument.playback.sounding.as_ref().map(|sounding| sounding.number));
        assert!(step == 0 || instrument.shown_sheet().is_none(), "{step}");
    }
    sounded.dedup();
    assert!(sounded.len() > 10, "{sounded:?}");
    assert!(drives.borrow().iter().all(|number| !sounded[1..].contains(number)), "{drives:?}");
    instrument.attend(Attention::default());
    wire.turn(&mut instrument);
    wire.turn(&mut instrument);
    assert_eq!(drives.borrow().last(), sounded.last());
    assert!(instrument.shown_sheet().is_some());
}

#[test]
fn the_newest_change_counts_a_stop_ends_every_source_and_the_user_alone_drives_again() {
    let (mut instrument, wire) = driven();
    let (start_m, end_m) = instrument.setup().plate.span_m();
    let move_to = |share: f64| Edit::Move { slot: 0, position_m: start_m + share * (end_m - start_m) };
    let program = Gesture { source: EditSource::Program("score"), number: 1 };
    let share = |request: &Request| {
        let Request::Play(Sounding::Drive(drive)) = request else { panic!("{request:?}") };
        ((drive.tones[0].boundary_m - start_m) / (end_m - start_m) * 100.0).round()
    };
    instrument.edit_by(program, &move_to(0.2));
    instrument.edit(&move_to(0.6));
    instrument.edit_by(program, &move_to(0.4));
    assert_eq!(wire.sent().iter().map(share).collect::<Vec<f64>>(), [20.0, 60.0, 40.0]);
    wire.turn(&mut instrument);
    assert!(wire.sent().is_empty());

    instrument.record(true);
    instrument.drag_line(0, &[start_m, end_m]);
    instrument.record(false);
    instrument.play(true);
    wire.sent();
    instrument.stop();
    assert!(instrument.recorder().played_s().is_none());
    for number in 0..50 {
        instrument.edit_by(Gesture { number, ..program }, &move_to(0.01 * number as f64));
        wire.turn(&mut instrument);
    }
    assert!(matches!(wire.sent()[..], [Request::Stop]));
    instrument.disarm();
    wire.turn(&mut instrument);
    instrument.edit_by(program, &move_to(0.7));
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
fn a_fit_that_comes_after_another_change_belongs_to_no_drawing_any_more() {
    let (mut instrument, wire) = driven();
    let stroke = [(0.05, 2e-6), (0.2, 1e-6)];
    let settle = |instrument: &mut Instrument| {
        for _ in 0..5 {
            wire.turn(instrument);
        }
    };
    // A fit is asked for in a turn and taken in the next one.
    instrument.begin_gestures(1);
    instrument.draw_texture(&stroke);
    wire.turn(&mut instrument);
    assert!(instrument.shown().texture.is_drawn);
    instrument.edit(&Edit::Level { slot: 0, level: 0.3 });
    settle(&mut instrument);
    assert_eq!(instrument.setup().tones.len(), 1, "{:?}", instrument.setup().tones);
    assert!(!instrument.shown().texture.is_drawn);
    // One that comes after the stroke has ended does belong to it, and undo takes back the whole of it.
    let before = instrument.setup().clone();
    instrument.begin_gestures(1);
    instrument.draw_texture(&stroke);
    settle(&mut instrument);
    instrument.draw_texture(&[(0.2, 1e-6), (0.25, 1e-6)]);
    instrument.begin_gestures(1);
    settle(&mut instrument);
    assert!(instrument.setup().tones.len() > 1 && instrument.shown().texture.is_drawn);
    instrument.undo();
    assert_eq!(instrument.setup(), &before);
    settle(&mut instrument);
    assert_eq!(instrument.setup(), &before, "nothing comes later");
}
