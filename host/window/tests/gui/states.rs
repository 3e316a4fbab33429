//! Every state of link and device offers a next step, and Drive names its obstacle.

use crate::fixed_link::{FixedLink, driving};
use crate::test_app::{TestApp, opened};
use eframe::egui::{Key, Modifiers, Rect, accesskit::Role, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use slipline_link::protocol::event::{Fault, Faults, State};
use slipline_link::protocol::version::Compatibility;
use slipline_link::{
    LinkError, LinkState, LinkView, Outcome, Port, Request, Snapshot, Sounding, Ticket, UploadProgress,
};
use slipline_window::app::App;
use std::sync::Arc;

/// A device in this state.
pub(crate) fn in_state(driving: &Snapshot, state: State, is_simulated: bool) -> Snapshot {
    let mut snapshot = driving.clone();
    let mut identity = (**snapshot.device.identity.as_ref().unwrap()).clone();
    identity.simulated = is_simulated;
    snapshot.device.identity = Some(Arc::new(identity));
    if !is_simulated {
        snapshot.link.port = Some(Port::Serial("/dev/ttyACM0".to_owned()));
    }
    let status = snapshot.drive.status.as_mut().unwrap();
    status.state = state;
    if state == State::Fault {
        status.faults = Faults::NONE.with(Fault::Overheat);
    }
    snapshot.revision += 1;
    snapshot
}

/// A link in this state, with nothing known of a device.
fn no_device(link: LinkState) -> Snapshot {
    let link = LinkView { state: link, port: Some(Port::Simulated), ..LinkView::default() };
    Snapshot { link, revision: 1, ..Snapshot::default() }
}

pub(crate) fn show(snapshot: Snapshot, size: [f32; 2]) -> (Harness<'static, App>, FixedLink) {
    let link = FixedLink::of(snapshot);
    let window = opened(link.clone(), size);
    link.sent.borrow_mut().clear();
    (window, link)
}

/// The required effect of a press.
type Effect = fn(&Harness<'static, App>, &[Request]) -> bool;

const fn disconnects(_: &Harness<'static, App>, sent: &[Request]) -> bool {
    matches!(sent, [Request::Disconnect])
}
const fn connects(_: &Harness<'static, App>, sent: &[Request]) -> bool {
    matches!(sent, [Request::Connect(_)])
}
fn drives(_: &Harness<'static, App>, sent: &[Request]) -> bool {
    sent.iter().any(|request| matches!(request, Request::Play(Sounding::Drive(_))))
}
const fn arms(_: &Harness<'static, App>, sent: &[Request]) -> bool {
    matches!(sent, [Request::Arm | Request::ArmFor(_)])
}
const fn clears(_: &Harness<'static, App>, sent: &[Request]) -> bool {
    matches!(sent, [Request::ClearFaults])
}
const fn disarms(_: &Harness<'static, App>, sent: &[Request]) -> bool {
    matches!(sent, [Request::Stop, Request::Disarm])
}
const fn stops(_: &Harness<'static, App>, sent: &[Request]) -> bool {
    matches!(sent, [Request::Stop])
}
fn asks_to_arm(window: &Harness<'static, App>, sent: &[Request]) -> bool {
    sent.is_empty() && window.query_by_label("Arm the device?").is_some()
}
fn asks_to_restart(window: &Harness<'static, App>, sent: &[Request]) -> bool {
    sent.is_empty() && window.query_by_label("Restart into the bootloader?").is_some()
}
fn shows_the_device(window: &Harness<'static, App>, sent: &[Request]) -> bool {
    sent.is_empty() && window.query_by_label("Reconnect by itself").is_some()
}
fn closes(window: &Harness<'static, App>, _: &[Request]) -> bool {
    use eframe::egui::ViewportCommand;
    let mut views = window.output().viewport_output.values();
    views.any(|view| view.commands.contains(&ViewportCommand::Close))
}

/// A state of link and device, what it offers, the effect of that, and the effect of Ctrl+Enter: a request, or a
/// message with these words.
struct Case {
    name: &'static str,
    snapshot: Snapshot,
    offers: Vec<(&'static str, Effect)>,
    drive: Result<Effect, &'static str>,
}

#[test]
fn a_drive_that_waits_for_the_trigger_input_is_shown_as_waiting() {
    let driving = driving();
    let (window, _) = show(in_state(&driving, State::Waiting, false), [1280.0, 800.0]);
    assert!(window.query_by_label("State: waiting").is_some());
}

fn cases() -> Vec<Case> {
    let driving = driving();
    let real = |state| in_state(&driving, state, false);
    let simulated = |state| in_state(&driving, state, true);
    let case = |name, snapshot, offers: &[(&'static str, Effect)], drive| Case {
        name,
        snapshot,
        offers: offers.to_vec(),
        drive,
    };
    let mut drive_time = simulated(State::Fault);
    drive_time.drive.status.as_mut().unwrap().faults = Faults::NONE.with(Fault::DriveTime);
    let mut without_table = real(State::Armed);
    without_table.table.report.active = None;
    without_table.table.confirmed = None;
    let missing = Port::Serial("/dev/ttyACM0".to_owned());
    let mut no_status = real(State::Idle);
    no_status.drive.status = None;
    let mut missing_port = no_device(LinkState::Reconnecting(LinkError::NoSuchPort(missing.clone())));
    missing_port.link.port = Some(missing);
    let mut flash = real(State::Idle);
    flash.device.compatibility = Some(Compatibility::FlashDevice);
    let mut update = simulated(State::Idle);
    update.device.compatibility = Some(Compatibility::UpdateHost);
    vec![
        case(
            "disconnected",
            no_device(LinkState::Disconnected),
            &[("Connect", connects)],
            Err("press Connect first"),
        ),
        case(
            "connecting",
            no_device(LinkState::Connecting),
            &[("Cancel", disconnects)],
            Err("has not answered yet"),
        ),
        case(
            "lost",
            no_device(LinkState::Lost(LinkError::Gone)),
            &[("Reconnect", connects)],
            Err("press Reconnect first"),
        ),
        case(
            "crashed",
            no_device(LinkState::Lost(LinkError::Crashed)),
            &[("Close Slipline", closes)],
            Err("start it again"),
        ),
        case(
            "sought",
            no_device(LinkState::Reconnecting(LinkError::Silent)),
            &[("Stop looking", disconnects)],
            Err("press Drive once it is back"),
        ),
        case("missing", missing_port, &[("Cancel", disconnects)], Err("choose another port")),
        case("no status", no_status, &[("Disconnect", disconnects)], Err("not reported its state yet")),
        case("older firmware", flash, &[("What to do", shows_the_device)], Err("flash the firmware")),
        case(
            "newer firmware",
            update,
            &[("What to do", shows_the_device)],
            Err("install the newer Slipline"),
        ),
        case(
            "real, idle",
            real(State::Idle),
            &[("Arm…", asks_to_arm)],
            Err("arm it first, then press Drive"),
        ),
        case("simulated, idle", simulated(State::Idle), &[("Drive", arms), ("Arm", arms)], Ok(arms)),
        case("real, armed", real(State::Armed), &[("Drive", drives), ("Disarm", disarms)], Ok(drives)),
        case("simulated, armed", simulated(State::Armed), &[("Drive", drives)], Ok(drives)),
        case("real, driving", real(State::Driving), &[("Disarm", disarms), ("STOP", disarms)], Ok(drives)),
        case("real, waiting", real(State::Waiting), &[("Drive", drives), ("Disarm", disarms)], Ok(drives)),
        case("simulated, waiting", simulated(State::Waiting), &[("Drive", drives)], Ok(drives)),
        case("simulated, driving", simulated(State::Driving), &[("STOP", stops)], Ok(drives)),
        case("real, stopping", real(State::Stopping), &[("Disarm", disarms)], Ok(drives)),
        case("simulated, stopping", simulated(State::Stopping), &[("Drive", drives)], Ok(drives)),
        case("real, fault", real(State::Fault), &[("Clear fault", clears)], Err("Press Clear fault first")),
        case(
            "simulated, fault",
            simulated(State::Fault),
            &[("Clear fault", clears)],
            Err("Press Clear fault first"),
        ),
        case("simulated, drive time", drive_time, &[("Drive", clears)], Ok(clears)),
        case(
            "real, safe mode",
            real(State::SafeMode),
            &[("Bootloader…", asks_to_restart)],
            Err("Disconnect its power"),
        ),
        case(
            "simulated, safe mode",
            simulated(State::SafeMode),
            &[("Reconnect", connects)],
            Err("Disconnect its power"),
        ),
        case(
            "real, no table",
            without_table,
            &[("table differs: upload", |_, sent| matches!(sent, [Request::Upload(_)]))],
            Err("press \"table differs: upload\" first"),
        ),
    ]
}

#[test]
fn where_a_port_may_not_be_opened_the_rules_that_permit_it_are_offered() {
    for error in [None, Some(LinkError::NoPermission(Port::Serial("/dev/ttyACM0".to_owned())))] {
        let mut snapshot = no_device(LinkState::Disconnected);
        snapshot.link.error = error.clone();
        let (mut window, _) = show(snapshot, [1280.0, 800.0]);
        window.get_by_role_and_label(Role::Button, "Device").click();
        window.run_steps(3);
        assert_eq!(window.query_by_label("Permit this port…").is_some(), error.is_some());
        if error.is_some() {
            let cure = "\"slipline udev\" prints";
            assert!(window.query_all_by_label_contains(cure).next().is_some());
            window.get_by_label("Permit this port…").click();
            window.run_steps(4);
            assert!(window.query_by_label(slipline_link::udev::RULES).is_some());
        }
    }
}

#[test]
fn every_state_offers_a_way_on_that_has_an_effect() {
    for case in cases() {
        assert!(!case.offers.is_empty(), "{}", case.name);
        for (offer, has_effect) in &case.offers {
            let (mut window, link) = show(case.snapshot.clone(), [1280.0, 800.0]);
            window.get_by_label(offer).click();
            window.step();
            let is_done = has_effect(&window, &link.sent.borrow());
            window.run_steps(4);
            let is_done = is_done || has_effect(&window, &link.sent.borrow());
            assert!(is_done, "{}: {offer}: {:?}", case.name, link.sent);
        }
    }
}

#[test]
fn drive_by_the_keys_acts_or_says_what_helps() {
    for case in cases() {
        let (mut window, link) = show(case.snapshot.clone(), [1280.0, 800.0]);
        window.key_press_modifiers(Modifiers::COMMAND, Key::Enter);
        window.run_steps(4);
        match case.drive {
            Ok(has_effect) => {
                assert!(has_effect(&window, &link.sent.borrow()), "{}: {:?}", case.name, link.sent);
            }
            Err(words) => {
                let told = window.state().notice().map(|notice| notice.text.clone()).unwrap_or_default();
                assert!(told.contains(words), "{}: {told:?}", case.name);
                assert!(link.sent.borrow().is_empty(), "{}: {:?}", case.name, link.sent);
            }
        }
    }
}

#[test]
fn in_the_narrowest_window_every_states_offers_are_on_the_screen() {
    let driving = driving();
    let mut uploading = in_state(&driving, State::Armed, false);
    uploading.table.upload = Some(UploadProgress { sent: 100, total: 256 });
    let mut differs = in_state(&driving, State::Armed, false);
    differs.table.report.active.as_mut().unwrap().crc ^= 1;
    let armed = |name, snapshot, last| Case {
        name,
        snapshot,
        offers: vec![("Drive", drives as Effect), ("Disarm", disarms), (last, stops)],
        drive: Ok(drives),
    };
    let more = [armed("uploading", uploading, "Cancel"), armed("differs", differs, "table differs: upload")];
    for case in cases().into_iter().chain(more) {
        let size = vec2(640.0, 480.0);
        let (mut window, _) = show(case.snapshot, size.into());
        window.run_steps(3);
        let names = ["File", "Edit", "View", "Help", "STOP"].into_iter();
        let offers = case.offers.iter().map(|(name, _)| *name).filter(|name| *name != "STOP");
        let mut seen: Vec<(&str, Rect)> = Vec::new();
        for name in names.chain(offers) {
            let mut nodes = window.query_all_by_label(name).map(|node| node.rect());
            let rect = nodes.find(|rect| rect.bottom() < 54.0);
            seen.push((name, rect.unwrap_or_else(|| panic!("{}: {name} is missing", case.name))));
        }
        let states = window.query_all_by_label_contains("State: ").map(|node| node.rect());
        seen.extend(states.filter(|rect| rect.bottom() < 54.0).map(|rect| ("State", rect)));
        for (i, (name, rect)) in seen.iter().enumerate() {
            assert!(rect.left() >= 0.0 && rect.right() <= size.x, "{}: {name} {rect}", case.name);
            for (other, at) in seen.iter().skip(i + 1) {
                let is_over = rect.shrink(1.0).intersects(at.shrink(1.0));
                assert!(!is_over, "{}: {name} {rect}, {other} {at}", case.name);
            }
        }
    }
}

#[test]
fn a_simulated_device_that_was_disarmed_is_armed_and_driven_by_one_press() {
    let mut app = TestApp::driving();
    app.click("STOP", 300);
    app.disarm();
    app.wait(600);
    assert!(app.has("State: idle"));
    app.click("Device", 200);
    assert!(app.shows("Disarmed: press Drive to move the plate."), "one press is enough");
    app.click("Drive", 600);
    assert!(app.is_driving(), "{:?}", app.snapshot().record.log);
}

#[test]
fn a_press_of_drive_before_arming_does_not_drive_after_arming() {
    let driving = driving();
    let (mut window, link) = show(in_state(&driving, State::Idle, false), [1280.0, 800.0]);
    window.key_press_modifiers(Modifiers::COMMAND, Key::Enter);
    window.run_steps(3);
    window.get_by_label("Cancel").click();
    window.run_steps(3);
    // The device is armed by the user later.
    let mut armed = in_state(&driving, State::Armed, false);
    armed.revision += 1;
    link.become_known(armed);
    window.run_steps(5);
    assert!(window.query_by_label("State: armed").is_some());
    assert!(window.state().notice().is_none(), "the notice no longer holds");
    assert!(!drives(&window, &link.sent.borrow()), "{:?}", link.sent);
}

#[test]
fn a_fault_that_persists_after_clearing_is_reported() {
    let driving = driving();
    let (mut window, link) = show(in_state(&driving, State::Fault, false), [1280.0, 800.0]);
    window.get_by_label("Clear fault").click();
    window.run_steps(3);
    let ticket = Ticket(link.sent.borrow().len() as u64);
    let mut after = in_state(&driving, State::Fault, false);
    let status = after.drive.status.as_mut().unwrap();
    after.record.outcomes = Arc::new([(ticket, Outcome::Done { at: status.now })].into());
    status.now += 1;
    after.revision += 1;
    link.become_known(after);
    window.run_steps(3);
    let told = window.state().notice().unwrap().text.clone();
    assert!(told.starts_with("Not cleared: ") && told.ends_with("Its cause persists."), "{told}");
}

#[test]
fn a_served_device_is_reached_by_its_port_which_is_in_the_lists_then() {
    let mut app = TestApp::driving();
    app.click_button("Device", 200);
    crate::type_into(&mut app, "Another port", "unix:");
    app.wait(100);
    assert!(app.window.query_all_by_label_contains("is not a port").next().is_some());
    app.take_sent();
    crate::type_into(&mut app, "Another port", "unix:/run/slipline.sock");
    app.wait(300);
    let sent = app.take_sent();
    let port = slipline_link::Port::Unix("/run/slipline.sock".into());
    assert!(sent.iter().any(|request| matches!(request, Request::Connect(to) if *to == port)), "{sent:?}");
    assert!(
        !sent.iter().any(|request| matches!(request, Request::Arm | Request::ArmFor(_))),
        "it arms nothing"
    );
    let named = |app: &TestApp| app.window.query_all_by_label_contains("unix:/run/slipline.sock").count();
    let on_the_page = named(&app);
    assert!(on_the_page >= 2, "in the list and in the menu: {on_the_page}");
    assert_eq!(app.window.state().settings().port.as_deref(), Some("unix:/run/slipline.sock"));
}

#[test]
fn a_file_that_was_named_on_the_command_line_is_opened() {
    let mut app = TestApp::driving();
    let text = app.setup_text().replace("master_db = 0.0", "master_db = -7.0");
    *app.files.contents.borrow_mut() = vec![("given.toml".into(), Ok(text))];
    app.window.state_mut().open("given.toml".into());
    app.wait(300);
    assert_eq!(app.window.state().setup().master_db, -7.0);
}
