//! The blocking client sends the same requests as an instrument: table, drive, measurement, level hold and
//! stop.

use crate::pluggable_port::{SteppedLink, SteppedWorker};
use crate::session::{Session, setup};
use slipline_instrument::Link as _;
use slipline_instrument::hold::{Holding, Standing};
use slipline_instrument::measure::Sensor;
use slipline_instrument::native::{BlockingLink, Client, Measurer};
use slipline_instrument::requests::MeasureRequest;
use slipline_instrument::rig::{PreparedRig, RigOptions};
use slipline_link::{Outcome, Port, Request, Sounding, Ticket};
use slipline_model::field::simulation::table_for;
use slipline_model::setup::edit;
use slipline_plate::calibrate::SensorKind;
use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;

/// Time between two checks for an outcome.
const LOOK: Duration = Duration::from_millis(1);

impl BlockingLink for SteppedLink {
    fn wait(&self, ticket: Ticket, patience: Duration) -> Option<Outcome> {
        for _ in 0..patience.as_millis() {
            self.pause(LOOK);
            let outcome = self.snapshot().outcome(ticket).cloned();
            if outcome.is_some() {
                return outcome;
            }
        }
        None
    }

    fn pause(&self, time: Duration) {
        self.0.borrow_mut().advance(time);
    }

    fn sign_of_life(&self) {}
}

/// The requests by which a device drives or measures. Left out are the sample indices at which they begin,
/// which depend on the time of sending, and the amplitude of a hold, whose sensor stands at another rig.
/// Arming is left out, too: a window arms a real device only, a program before each drive.
fn acts(sent: &[Request]) -> Vec<String> {
    let is_act = |request: &&Request| {
        !matches!(
            request,
            Request::Note(..)
                | Request::AutoReconnect(_)
                | Request::Arm
                | Request::ArmFor(_)
                | Request::Disarm
                | Request::Refresh
        ) && !is_look(request)
    };
    let mut acts: Vec<String> = sent.iter().filter(is_act).map(in_words).collect();
    acts.dedup();
    acts
}

/// A short capture of an input, which shows its level.
fn is_look(request: &Request) -> bool {
    matches!(request, Request::Listen(listen) if listen.from.is_none())
}

fn in_words(request: &Request) -> String {
    let words = match request {
        Request::Upload(table) => format!("Upload({:08x})", table.crc()),
        request => format!("{request:?}"),
    };
    ["At(", "from: Some(", "amplitude_codes: "]
        .iter()
        .fold(words, |words, before| without_number(&words, before))
}

/// The text without the number after each `before`.
fn without_number(words: &str, before: &str) -> String {
    let part = |part: &str| part.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.').to_owned();
    let mut parts = words.split(before);
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, rest| text + before + &part(rest))
}

#[test]
fn a_client_sends_what_an_instrument_sends() {
    let mut session = Session::new();
    session.pass(2000);
    session.instrument.press_stop();
    session.pass(500);
    session.measure(None);
    session.hold_level();
    session.instrument.press_stop();
    session.pass(500);
    let wanted = acts(&session.worker.borrow().sent);

    let setup = &setup();
    let options = RigOptions { place_m: 0.03, ..RigOptions::default() };
    let rig = PreparedRig::new(&setup.plate, &options, 400e3).unwrap();
    let worker = Rc::new(RefCell::new(SteppedWorker::new(true, Some(rig.inputs()))));
    let client = Client::over(SteppedLink(Rc::clone(&worker)));
    client.connect(&Port::Simulated).unwrap();
    let identity = client.identity().unwrap();
    let table = table_for(&setup.plate, identity.sample_rate_hz).unwrap().1;
    client.use_table(table.clone()).unwrap();
    client.arm().unwrap();
    client.play(Sounding::Drive(edit::drive(setup))).unwrap();
    client.pause(Duration::from_secs(1));
    client.stop().unwrap();
    client.disarm().unwrap();
    let measurer = Measurer::new(&client, &setup.plate, &table, &MeasureRequest::default()).unwrap();
    let sensor = Sensor { place_m: 0.03, kind: SensorKind::Displacement, input: 0, body: None };
    measurer.measure(sensor, |_| ()).unwrap();
    client.arm().unwrap();
    let at = client.play(Sounding::Drive(edit::drive(setup))).unwrap();
    let mut holding = Holding::default();
    let mut turns_left = 100;
    let mut goes_on = || {
        turns_left -= 1;
        turns_left > 0
    };
    assert!(client.hold(&mut holding, &setup.plate, 12.0, Some(at), &mut goes_on).unwrap());
    client.pause(Duration::from_millis(50));
    let snapshot = client.snapshot();
    let standing = holding.standing(&snapshot);
    assert!(matches!(standing, Standing::Holding(_)), "{standing:?} {:?}", snapshot.drive.status);
    client.stop().unwrap();
    holding.switch_off();
    client.pause(Duration::from_millis(50));
    client.turn_hold(&mut holding, &setup.plate);
    let sent = acts(&worker.borrow().sent);
    for (number, (sent, wanted)) in sent.iter().zip(&wanted).enumerate() {
        assert_eq!(sent, wanted, "act {number}");
    }
    assert_eq!(sent.len(), wanted.len(), "{sent:#?} {wanted:#?}");
}
