//! a program that hangs while it drives. The link's own thread goes on and keeps the device alive, so it watches
//! the program: without a sign of life for a second it stops and disarms.

use slipline_link::DeviceTable;
use slipline_link::native::{SystemOpener, Worker};
use slipline_link::{
    Change, DriveRequest, Outcome, Port, Request, SIGN_PATIENCE, SIGN_PERIOD, Severity, Sounding, Ticket,
};
use slipline_protocol::Command;
use slipline_protocol::event::State;
use slipline_tests::faulty_ports::as_real;
use slipline_tests::link_rig::{LinkRig, drive};
use slipline_tests::turned_clock::{TurnedClock, until};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

/// Driving one tone, under watch.
fn driving() -> LinkRig {
    let mut rig = LinkRig::armed().watched();
    rig.ask_and_pass(drive(0.05), 300);
    assert_eq!(rig.state(), State::Driving);
    rig
}

/// Number of these commands that the device was sent after the first `since`.
fn sent(rig: &LinkRig, since: usize, which: fn(&Command) -> bool) -> usize {
    rig.ports().commands[since..].iter().filter(|(_, command)| which(command)).count()
}

fn stalls(rig: &LinkRig) -> u32 {
    rig.view().link.driver_stalls
}

#[test]
fn a_program_that_answers_drives_on_and_is_asked_four_times_a_second() {
    let mut rig = driving();
    let before = rig.signs_wanted;
    rig.pass_ms(60_000);
    assert_eq!((rig.state(), stalls(&rig)), (State::Driving, 0));
    let asked = rig.signs_wanted - before;
    assert!((239..=241).contains(&asked), "{asked}");
}

#[test]
fn a_program_that_hangs_is_stopped_and_disarmed_within_a_second_and_reported() {
    // Every 50 ms of the period, so that the latest sign is of every age.
    for phase_ms in (0..250).step_by(50) {
        let mut rig = driving();
        rig.pass_ms(phase_ms);
        rig.is_driver_alive = false;
        let (hung, words) = (rig.now, rig.ports().commands.len());
        while sent(&rig, words, |command| *command == Command::Stop) == 0 {
            rig.pass_ms(1);
            assert!(rig.now <= hung + SIGN_PATIENCE, "{phase_ms} ms: nothing was stopped");
        }
        let after = rig.now - hung;
        assert!(after >= SIGN_PATIENCE - Duration::from_millis(251), "{phase_ms} ms: after {after:?}");
        // A ramp of 30 ms, and the status after it.
        rig.pass_ms(300);
        assert_eq!((rig.state(), stalls(&rig)), (State::Idle, 1), "{phase_ms} ms");
        assert_eq!(sent(&rig, words, |command| *command == Command::Disarm), 1);
        let last: Vec<&Change> =
            rig.view().record.journal.iter().rev().take(2).map(|entry| &entry.change).collect();
        assert_eq!(last, [&Change::Disarmed, &Change::Stop]);
        let notice =
            rig.view().record.log.iter().find(|line| line.text.contains("gave no sign of life for 1 s"));
        assert_eq!(notice.map(|line| line.severity), Some(Severity::Error));
        // It stays hung: nothing is left to be stopped, and nothing is reported again.
        rig.pass_ms(20_000);
        assert_eq!((rig.state(), stalls(&rig)), (State::Idle, 1));
        assert_eq!(sent(&rig, words, |command| *command == Command::Stop), 1);
    }
}

#[test]
fn a_program_that_comes_back_can_arm_and_drive_again() {
    let mut rig = driving();
    rig.is_driver_alive = false;
    rig.pass_ms(3000);
    rig.is_driver_alive = true;
    rig.ask(Request::Arm);
    rig.ask_and_pass(drive(0.06), 5000);
    assert_eq!((rig.state(), stalls(&rig)), (State::Driving, 1));
    rig.is_driver_alive = false;
    rig.pass_ms(1200);
    assert_eq!((rig.state(), stalls(&rig)), (State::Idle, 2));
}

#[test]
fn a_device_that_is_not_armed_needs_no_sign() {
    let mut rig = LinkRig::connected().watched();
    rig.ask_and_pass(Request::Disarm, 300);
    let asked = rig.signs_wanted;
    rig.is_driver_alive = false;
    rig.pass_ms(30_000);
    assert_eq!((rig.signs_wanted, stalls(&rig)), (asked, 0));
    // The second counts from the arming.
    rig.ask_and_pass(Request::Arm, 900);
    assert_eq!((rig.state(), stalls(&rig)), (State::Armed, 0));
    rig.pass_ms(300);
    assert_eq!((rig.state(), stalls(&rig)), (State::Idle, 1));
}

#[test]
fn a_window_that_takes_seconds_to_open_is_waited_for_by_the_simulated_device_only() {
    for (is_real, state) in [(false, State::Armed), (true, State::Idle)] {
        let mut rig = LinkRig::new().watched();
        rig.is_driver_alive = false;
        rig.ports().rewrite = if is_real { as_real } else { |event| event };
        rig.ask_and_pass(Request::Connect(Port::Serial("A".to_owned())), 300);
        rig.ask_and_pass(Request::Arm, 4000);
        assert_eq!((rig.state(), stalls(&rig)), (state, u32::from(is_real)));
        // From the first sign on it is watched like any other.
        rig.is_driver_alive = true;
        rig.ask_and_pass(Request::Arm, 1000);
        assert_eq!(rig.state(), State::Armed);
        rig.is_driver_alive = false;
        rig.pass_ms(1400);
        assert_eq!((rig.state(), stalls(&rig)), (State::Idle, 1 + u32::from(is_real)));
    }
}

/// Hangs just after a sign of life: the drive ends [`SIGN_PATIENCE`] later.
fn hang_after_a_sign(rig: &mut LinkRig) {
    let asked = rig.signs_wanted;
    while rig.signs_wanted == asked {
        rig.pass_ms(1);
    }
    rig.is_driver_alive = false;
}

#[test]
fn an_upload_under_way_goes_on_and_the_device_is_disarmed_between_its_chunks() {
    let mut rig = driving();
    let knots = (0..1000).map(|i| (100.0 + f64::from(i), 0.5));
    let table = DeviceTable::from_knots((0.0, 0.1), 400e3, knots, 1e-6).unwrap();
    hang_after_a_sign(&mut rig);
    rig.pass_ms(SIGN_PATIENCE.as_millis() as u64 - 10);
    let upload = rig.ask(Request::Upload(Arc::new(table)));
    rig.pass_ms(5);
    let words = rig.ports().commands.len();
    // More than can be sent before the hang is noticed, and not harmful: they may wait.
    let waiting = [(); 20].map(|()| rig.only_ask(Request::ReadBack));
    rig.pass_ms(1000);
    let sent: Vec<Command> = rig.ports().commands[words..].iter().map(|(_, word)| word.clone()).collect();
    let place = |which: fn(&Command) -> bool| sent.iter().position(which).expect("it was sent");
    let disarmed = place(|word| *word == Command::Disarm);
    assert!(place(|word| matches!(word, Command::TableChunk(_))) < disarmed);
    assert!(disarmed < place(|word| *word == Command::TableCommit), "it waits for the upload");
    let read_later = sent[disarmed..].iter().filter(|word| **word == Command::TableDigest).count();
    assert!(read_later > 5, "{read_later}: it waits for what was asked for before");
    assert_eq!((rig.state(), stalls(&rig)), (State::Idle, 1));
    for ticket in waiting.into_iter().chain([upload]) {
        assert!(matches!(rig.outcome(ticket), Some(Outcome::Done { .. })));
    }
}

#[test]
fn the_link_asks_to_be_called_when_a_question_or_the_stop_is_due() {
    let mut rig = driving();
    hang_after_a_sign(&mut rig);
    let mut asked = rig.signs_wanted;
    while stalls(&rig) == 0 {
        let due = rig.connection.deadline(rig.now).expect("it is connected");
        rig.pass_ms(1);
        if rig.signs_wanted > asked || stalls(&rig) > 0 {
            assert!(due <= rig.now, "{due:?} {:?}", rig.now);
            asked = rig.signs_wanted;
        }
    }
}

#[test]
fn an_order_that_a_hung_program_has_not_delivered_is_dropped() {
    let mut rig = driving();
    rig.ask_and_pass(Request::Stop, 250);
    rig.is_driver_alive = false;
    rig.pass_ms(900);
    let words = rig.ports().commands.len();
    // The drive is lost on its way; its repeat would be due after the stop.
    rig.ports().drop_commands = 1;
    let tickets = [drive(0.05), Request::Arm].map(|request| rig.ask(request));
    rig.pass_ms(2000);
    assert_eq!(sent(&rig, words, |command| matches!(command, Command::Drive(_))), 1);
    assert_eq!(sent(&rig, words, |command| *command == Command::Arm), 0);
    assert_eq!(
        tickets.map(|ticket| rig.outcome(ticket)),
        [Some(Outcome::Superseded), Some(Outcome::Superseded)]
    );
    assert_eq!((rig.state(), stalls(&rig)), (State::Idle, 1));
}

#[test]
fn a_stop_that_is_lost_is_sent_again() {
    let mut rig = driving();
    rig.ports().drop_stops = 2;
    rig.is_driver_alive = false;
    rig.pass_ms(1700);
    assert_eq!((rig.state(), stalls(&rig)), (State::Idle, 1));
}

const fn ms(ms: u64) -> Duration {
    Duration::from_millis(ms)
}

/// A worker on its own thread, which drives a simulated device, both by a clock that the test turns.
struct Driven {
    worker: Worker,
    clock: TurnedClock,
}

impl Driven {
    fn new() -> Self {
        let clock = TurnedClock::default();
        let ports = SystemOpener::in_time_of(clock.clock());
        let worker = Worker::spawn_in_time_of(clock.clock(), ports, || ()).unwrap();
        let knots = (0..100).map(|i| (100.0 + f64::from(i), 0.5));
        let table = DeviceTable::from_knots((0.0, 0.1), 400e3, knots, 1e-6).unwrap();
        let drive = Request::Play(Sounding::Drive(DriveRequest::at(&[(0.05, 0.5)])));
        let driven = Self { worker, clock };
        for request in
            [Request::Connect(Port::Simulated), Request::Upload(Arc::new(table)), Request::Arm, drive]
        {
            let ticket = driven.worker.send(request);
            let end = driven.clock.now() + Duration::from_secs(10);
            while driven.worker.snapshot().outcome(ticket).is_none() {
                assert!(driven.clock.now() < end, "it is never done");
                driven.worker.handle().sign_of_life();
                driven.turn(ms(5), || ());
            }
            let outcome = driven.worker.snapshot().outcome(ticket).cloned();
            assert!(matches!(outcome, Some(Outcome::Done { .. })), "{outcome:?}");
        }
        driven
    }

    fn turn(&self, time: Duration, step_done: impl FnMut()) {
        self.clock.turn(&self.worker.handle(), time, step_done);
    }

    /// The device's state, and how often a hang was noticed.
    fn seen(&self) -> (Option<State>, u32) {
        let snapshot = self.worker.snapshot();
        (snapshot.drive.status.map(|status| status.state), snapshot.link.driver_stalls)
    }

    /// Nobody gives a sign of life any more: a second after the last one the drive is ended, and not before.
    fn ends_without_a_sign(&self) {
        let left = self.worker.handle().latest_sign() + SIGN_PATIENCE - self.clock.now();
        self.turn(left - ms(1), || ());
        assert_eq!(self.seen(), (Some(State::Driving), 0));
        self.turn(ms(1), || ());
        assert_eq!(self.seen().1, 1);
        self.turn(ms(300), || ());
        assert_eq!(self.seen(), (Some(State::Idle), 1));
    }
}

#[test]
fn a_thread_that_waits_or_pauses_by_the_worker_is_alive_and_one_that_hangs_is_not() {
    let driven = Driven::new();
    let handle = driven.worker.handle();
    thread::scope(|scope| {
        let waits = scope.spawn(|| {
            driven.worker.pause(ms(1250));
            // A request that nobody has made has no outcome.
            assert_eq!(driven.worker.wait(Ticket(u64::MAX), ms(1250)), None);
        });
        while !waits.is_finished() {
            driven.turn(ms(50), || ());
            // However slow that thread is, it gives the next sign before the clock is turned on.
            let is_alive = || driven.clock.now() - handle.latest_sign() < SIGN_PERIOD;
            until("alive", || is_alive() || waits.is_finished());
        }
    });
    assert_eq!(driven.seen(), (Some(State::Driving), 0));
    // From here on this thread only looks.
    driven.ends_without_a_sign();
}

#[test]
fn a_loop_that_is_woken_to_answer_drives_on_until_it_hangs() {
    let driven = Driven::new();
    let (question, questions) = std::sync::mpsc::channel();
    let [asked, answered] = [(); 2].map(|()| Arc::new(AtomicUsize::default()));
    let count = |counter: &Arc<AtomicUsize>| counter.load(Ordering::SeqCst);
    driven.worker.handle().ask_for_signs({
        let asked = Arc::clone(&asked);
        move || {
            asked.fetch_add(1, Ordering::SeqCst);
            let _ = question.send(());
        }
    });
    let hangs = Arc::new(AtomicBool::default());
    let event_loop = thread::spawn({
        let (handle, is_hung) = (driven.worker.handle(), Arc::clone(&hangs));
        let answered = Arc::clone(&answered);
        move || {
            while questions.recv().is_ok() {
                if !is_hung.load(Ordering::SeqCst) {
                    handle.sign_of_life();
                }
                answered.fetch_add(1, Ordering::SeqCst);
            }
        }
    });
    driven.turn(ms(2500), || until("answered", || count(&asked) == count(&answered)));
    assert_eq!(driven.seen(), (Some(State::Driving), 0));
    assert!((9..=11).contains(&count(&asked)), "{}", count(&asked));
    hangs.store(true, Ordering::SeqCst);
    driven.ends_without_a_sign();
    driven.worker.handle().ask_for_signs(|| ());
    event_loop.join().unwrap();
}
