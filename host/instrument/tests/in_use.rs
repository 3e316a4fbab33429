//! An instrument in use, without a window: a scripted session with the simulated device in virtual time, from
//! the first connection to a calibrated plate and a pulled cable; and what each room does, a file each.

#[path = "in_use/before_after.rs"]
mod before_after;
#[path = "in_use/chords.rs"]
mod chords;
#[cfg(feature = "native")]
#[path = "in_use/client.rs"]
mod client;
#[path = "in_use/desk.rs"]
mod desk;
#[path = "in_use/drive_check.rs"]
mod drive_check;
#[path = "in_use/drive_time.rs"]
mod drive_time;
#[path = "in_use/felt_lines.rs"]
mod felt_lines;
#[path = "in_use/fixed_link.rs"]
#[allow(dead_code, reason = "two programs of tests use it, each a part")]
mod fixed_link;
#[path = "in_use/holding.rs"]
mod holding;
#[path = "in_use/lights.rs"]
mod lights;
#[path = "in_use/measuring.rs"]
mod measuring;
#[cfg(feature = "figures")]
#[path = "in_use/one_truth.rs"]
mod one_truth;
#[path = "in_use/planted_faults.rs"]
mod planted_faults;
#[path = "in_use/pluggable_port.rs"]
#[allow(dead_code, reason = "two programs of tests use it, each a part")]
mod pluggable_port;
#[path = "in_use/replaying.rs"]
mod replaying;
#[path = "in_use/script.rs"]
#[allow(dead_code, reason = "two programs of tests use it, each a part")]
mod script;
#[path = "in_use/selftest.rs"]
mod selftest;
#[path = "in_use/sensors.rs"]
#[allow(dead_code, reason = "two programs of tests use it, each a part")]
mod sensors;
#[path = "in_use/session.rs"]
#[allow(dead_code, reason = "two programs of tests use it, each a part")]
mod session;
#[path = "in_use/sounding.rs"]
mod sounding;
#[path = "in_use/starting.rs"]
mod starting;
#[path = "in_use/texturing.rs"]
mod texturing;
#[path = "in_use/touring.rs"]
mod touring;
#[path = "in_use/verifying.rs"]
mod verifying;

use session::Session;
use slipline_instrument::MeasureIntent;
use slipline_instrument::rig::secret;
use slipline_link::protocol::event::State;
use slipline_plate::Plate;
use slipline_plate::calibrate::departure;
use std::sync::Arc;

#[test]
fn a_session_from_the_first_connection_to_a_pulled_cable() {
    let mut session = Session::new();
    // Connect, table, drive: the simulated device is armed and driven automatically.
    session.pass(2000);
    assert_eq!(session.state(), Some(State::Driving));
    let begun = session.sent();
    assert_eq!(begun, ["AutoReconnect", "Connect", "Upload", "Drive"], "{begun:?}");

    // A drag of many moves is one gesture; undo reverts all of it.
    let first_m = session.line_m();
    session.instrument.desk.begin_gestures(1);
    session.attention.is_dragging = true;
    for mm in 150..180 {
        session.instrument.drag_line(0, &[f64::from(mm) * 1e-3]);
        session.pass(50);
    }
    session.attention.is_dragging = false;
    assert!((session.line_m() - 0.179).abs() < 1e-6);
    session.instrument.undo();
    assert_eq!(session.line_m(), first_m);
    session.instrument.redo();
    assert_eq!(session.sent(), ["Drive"]);

    // A texture, computed while its page is open, played and undone.
    session.attention.is_texture_open = true;
    session.pass(500);
    session.instrument.play_texture();
    session.pass(500);
    assert!(session.instrument.desk.setup().tones.len() > 1, "{}", session.notice());
    let sent = session.sent();
    assert!(sent.iter().any(|kind| kind == "Chord" || kind == "Drive"), "{sent:?}");
    session.instrument.save_texture();
    session.turn();
    assert_eq!(session.saved, ["texture.toml"]);
    session.instrument.undo();
    session.attention.is_texture_open = false;
    session.pass(500);

    // An unknown plate is measured, calibrated and used.
    session.instrument.perform_measure(MeasureIntent::Secret(true));
    session.measure(None);
    assert!(session.notice().starts_with("Measured 30.0 mm, run 1"), "{}", session.notice());
    let is_other_plate =
        |session: &Session| session.instrument.shown().measure.comparison().unwrap().is_other_plate();
    assert!(is_other_plate(&session));
    session.calibrate_by_measuring();
    assert!(!is_other_plate(&session), "the plate's model fits");
    let nominal = slipline_plate::preset("membrane").unwrap();
    let truth = secret(&Arc::new(nominal.clone()), 1).unwrap();
    let off_mm = |plate: &Plate| 1e3 * departure(plate, &truth, 400e3).unwrap().boundary_m;
    let used = Arc::clone(&session.instrument.desk.setup().plate);
    let (before_mm, after_mm) = (off_mm(&nominal), off_mm(&used));
    assert!(after_mm < 1.0 && after_mm < 0.3 * before_mm, "{before_mm} {after_mm} mm");
    assert!(session.sent().contains(&"Comb".to_owned()));
    assert!(session.is_driving(), "it goes on with the calibrated plate: {}", session.notice());

    session.instrument.start();
    session.pass(1000);
    // The cable is pulled and plugged in again: nothing sounds automatically; Drive continues.
    session.worker.borrow().plug(false);
    session.pass(1000);
    assert!(!session.instrument.drive.snapshot().is_connected());
    session.worker.borrow().plug(true);
    session.pass(3000);
    assert!(session.instrument.drive.snapshot().is_connected(), "{}", session.notice());
    session.instrument.start();
    session.pass(1500);
    assert_eq!(session.state(), Some(State::Driving));
}

#[test]
#[ignore = "the window's tests run it, too: .ci/run statistics"]
fn the_script_of_a_window_runs_without_one() {
    let mut session = Session::new();
    let sent = script::play(&mut session);
    // For the page's test, which compares what a browser computes with what this computer does: .ci/run page.
    println!("{}", sent.join("\n"));
    let combs = sent.iter().filter(|request| request.starts_with("Play(Comb")).count();
    assert!(combs > 3, "a measurement plays combs: {sent:#?}");
    assert_eq!(session.state(), Some(State::Driving));
}
