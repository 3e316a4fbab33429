//! Files of other programs on the page of measurements and in the calibration: the form asks for what they do not state.

use crate::measure::{Dropped, measured, membrane, open_measure};
use crate::test_app::TestApp;
use crate::type_into;
use eframe::egui::{accesskit::Role, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use hound::{SampleFormat, WavSpec, WavWriter};
use slipline_instrument::calibration::CalibrationWizard;
use slipline_instrument::measure::{PlayedSweep, Wanted};
use slipline_model::field::simulation::table_for;
use slipline_plate::calibrate::Measurement;
use std::f64::consts::{PI, TAU};
use std::io::Cursor;
use std::path::PathBuf;
use std::sync::Arc;

pub(crate) fn drop_file(app: &mut TestApp, name: &str, bytes: &[u8]) {
    let path = PathBuf::from(name);
    *app.files.profiles.borrow_mut() = vec![(path.clone(), Ok(bytes.to_vec()))];
    app.window.input_mut().dropped_files = vec![Arc::new(Dropped(path))];
    app.wait(300);
}

fn press(app: &mut TestApp, name: &str) {
    app.window.get_by_role_and_label(Role::Button, name).click_accesskit();
    app.wait(300);
}

fn choose_kind(app: &mut TestApp, now: &str, kind: &str) {
    app.window.get_by_role_and_label(Role::ComboBox, &format!("Sensor: {now}")).click_accesskit();
    app.wait(200);
    app.click_button(kind, 200);
}

/// What an acceleration sensor measures at the first place of the calibration.
fn near(share: f64) -> Measurement {
    measured(&membrane(share), 0.032, 12.0)
}

/// The text of REW for these answers.
fn rew(measurement: &Measurement) -> String {
    let frd = measurement.to_frd();
    let rows = frd.lines().filter(|line| !line.starts_with('*'));
    let head =
        "* Measurement data measured by REW V5.20\n* Source: microphone\n* Freq(Hz) SPL(dB) Phase(degrees)\n";
    head.to_owned() + &rows.map(|row| format!("{row}\n")).collect::<String>()
}

#[test]
fn what_another_program_measured_is_asked_for_its_place_and_its_sensor() {
    let measured = near(1.04);
    let files =
        [("room.frd", measured.to_frd()), ("rew.txt", rew(&measured)), ("table.csv", measured.to_frd())];
    for (name, text) in files {
        let mut app = TestApp::driving();
        open_measure(&mut app);
        drop_file(&mut app, name, text.as_bytes());
        assert!(app.shows("By another program: 60 frequencies from"), "{name}");
        assert!(app.shows("as frequency") && app.shows("Column 2: level in dB"), "{name}");
        assert!(!app.is_enabled("Take it") && !app.shows("Measured differs"), "{name}");
        type_into(&mut app, "Sensor stood at", "32 mm");
        choose_kind(&mut app, "choose…", "acceleration");
        press(&mut app, "Take it");
        assert!(!app.shows("By another program") && app.shows("Measured differs"), "{name}");
        assert!(app.has(name) && app.shows("32.0 mm ±"), "{name}");
    }
}

#[test]
fn the_form_of_a_foreign_file_is_whole_in_a_usual_low_window() {
    let mut app = TestApp::driving();
    app.resize(vec2(1280.0, 720.0), 200);
    open_measure(&mut app);
    let panel = app.window.get_by_role_and_label(Role::Button, "Play").rect();
    drop_file(&mut app, "foreign.csv", near(1.0).to_frd().replace(' ', ",").as_bytes());
    assert!(app.shows("By another program"));
    let roles = [Role::Button, Role::ComboBox, Role::TextInput, Role::CheckBox, Role::Label];
    let mut seen = 0;
    for node in roles.into_iter().flat_map(|role| app.window.query_all_by_role(role)) {
        let (rect, name) = (node.rect(), node.accesskit_node().label());
        // The panel's content ends where its tabs end.
        if rect.left() > 970.0 && rect.top() > panel.bottom() && rect.bottom() < 500.0 {
            assert!(
                rect.right() <= panel.right() + 1.0,
                "{name:?}: {rect}, the panel ends at {}",
                panel.right()
            );
            seen += 1;
        }
    }
    assert!(seen > 8, "{seen}");
}

#[test]
fn columns_that_are_not_clear_are_chosen_before_the_file_is_taken() {
    let frd = near(1.0).to_frd();
    let rows = frd
        .lines()
        .filter(|line| !line.starts_with('*'))
        .map(|row| row.replacen(' ', ";0;", 1).replace(' ', ";"));
    let head = "Frequency (Hz);Level A (dB);Level B (dB);Phase (deg)".to_owned();
    let text: Vec<String> = std::iter::once(head).chain(rows).collect();
    let mut app = TestApp::driving();
    open_measure(&mut app);
    drop_file(&mut app, "two.csv", text.join("\n").as_bytes());
    assert!(app.shows("Its columns are not clear") && app.shows("2 columns may be the level"));
    type_into(&mut app, "Sensor stood at", "32 mm");
    choose_kind(&mut app, "choose…", "acceleration");
    assert!(!app.is_enabled("Take it"));
    for (column, meaning) in [(1, "frequency in Hz"), (3, "level in dB"), (4, "phase in deg")] {
        app.window
            .get_by_role_and_label(Role::ComboBox, &format!("Column {column}: left out"))
            .click_accesskit();
        app.wait(200);
        app.window.get_by_role_and_label(Role::Button, meaning).click_accesskit();
        app.wait(200);
    }
    assert!(app.shows("By another program: 60 frequencies") && app.shows("*Level A (dB)* left out"));
    press(&mut app, "Take it");
    assert!(!app.shows("By another program") && app.shows("The plate's model fits"));
}

#[test]
fn a_universal_file_states_its_sensor_and_an_impossible_one_is_refused_in_place() {
    let mut app = TestApp::driving();
    // Dropped on any page: its name says what it is.
    drop_file(&mut app, "hammer.UFF", near(1.0).to_uff58().as_bytes());
    assert!(app.shows("Sensor: acceleration") && app.is_enabled("Take it"));
    type_into(&mut app, "Sensor stood at", "900 mm");
    assert!(app.shows("320 mm"));
    type_into(&mut app, "Sensor stood at", "32 mm");
    type_into(&mut app, "Over the noise, dB", "150");
    assert!(app.shows("140"));
    type_into(&mut app, "Over the noise, dB", "46");
    press(&mut app, "Take it");
    assert!(app.shows("The plate's model fits"));
    // A file at other frequencies has none of use for this plate; its form stays open, to be corrected or left.
    let high: String = (0..40).map(|i| format!("{} -20\n", 40_000 + 100 * i)).collect();
    drop_file(&mut app, "high.frd", high.as_bytes());
    choose_kind(&mut app, "choose…", "velocity");
    press(&mut app, "Take it");
    assert!(app.shows("By another program: 40 frequencies"));
    assert!(app.shows("0 of its frequencies are between") && app.shows("at least 8 are needed"));
    press(&mut app, "Leave it");
    assert!(!app.shows("By another program") && !app.has("high.frd"));
}

#[test]
fn a_file_that_is_no_measurement_is_refused_by_its_line() {
    let mut app = TestApp::driving();
    open_measure(&mut app);
    for (name, bytes, reason) in [
        ("words.txt", &b"nothing to see\n"[..], "No line has a frequency and a level"),
        ("half.frd", b"100 -20 3\n101 x\n", "Line 2"),
        ("voice.wav", b"RIFF....WAVE", "The WAV file cannot be read"),
        ("voice.mp3", b"ID3\x03\0\0\0\0\0\0", "compressed with loss: record as WAV"),
        (
            "table.xlsx",
            b"PK\x03\x04........................[Content_Types].xml",
            "It is a spreadsheet: save it as CSV",
        ),
        ("near.zip", b"PK\x03\x04........................near.txt", "It is an archive: unpack it"),
    ] {
        drop_file(&mut app, name, bytes);
        let notice = app.window.state().notice().cloned().unwrap();
        assert!(notice.is_error && notice.text.contains(name) && notice.text.contains(reason), "{notice:?}");
        assert!(!app.shows("By another program"));
    }
}

#[test]
fn the_calibration_takes_such_files_at_the_places_of_its_pages() {
    let mut app = TestApp::driving();
    crate::calibrate::open_calibration(&mut app);
    press(&mut app, "Next");
    press(&mut app, "Next");
    let [first_m, second_m, _] = CalibrationWizard::of(&app.window.state().setup().plate).places_m();
    for place_m in [first_m, second_m] {
        let measurement = measured(&membrane(1.02), place_m, 12.0);
        *app.files.contents.borrow_mut() = vec![(PathBuf::from("answer.frd"), Ok(measurement.to_frd()))];
        press(&mut app, "Open file…");
        let place = app.window.get_by_role_and_label(Role::TextInput, "Sensor stood at").value().unwrap();
        assert_eq!(place, format!("{:.1} mm", 1e3 * place_m), "where the page has it put");
        assert!(!app.is_enabled("Next"));
        choose_kind(&mut app, "choose…", "acceleration");
        press(&mut app, "Take it");
        press(&mut app, "Next");
    }
    assert_eq!(crate::calibrate::page(&app), Some(5));
    assert!(app.shows("Boundary off by"));
}

/// A sweep over the membrane's band, and what a recorder at the end of a wire records, in the second of two channels.
fn swept() -> (PlayedSweep, Vec<u8>) {
    const RATE_HZ: f64 = 8e3;
    let plate = membrane(1.0);
    let (_, table) = table_for(&plate, 40_000).unwrap();
    let sweep = PlayedSweep::new(&plate, &table, &Wanted::of(&plate), 40e3, 1.0).unwrap();
    let chirp = sweep.chirp();
    let (seconds, octaves) = (chirp.samples as f64 / chirp.rate_hz, (chirp.ends_hz.1 / chirp.ends_hz.0).ln());
    let tone = |t: f64| {
        let share = t / seconds;
        let turns = chirp.ends_hz.0 * seconds / octaves * ((share * octaves).exp() - 1.0);
        if (0.0..1.0).contains(&share) { (TAU * turns).sin() * (PI * share).sin().powf(0.2) } else { 0.0 }
    };
    let spec =
        WavSpec { channels: 2, sample_rate: 8000, bits_per_sample: 16, sample_format: SampleFormat::Int };
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = WavWriter::new(&mut bytes, spec).unwrap();
    for n in 0..((sweep.seconds() + 1.0) * RATE_HZ) as usize {
        let t = n as f64 / RATE_HZ - 0.7;
        let value = 0.4 * tone(t) + 0.2 * tone(t - sweep.apart_s());
        writer.write_sample(0_i16).unwrap();
        writer.write_sample((value * 32_768.0) as i16).unwrap();
    }
    writer.finalize().unwrap();
    (sweep, bytes.into_inner())
}

#[test]
fn a_recording_is_asked_for_its_sweep_its_channel_and_its_sensor() {
    let (sweep, wav) = swept();
    let mut app = TestApp::driving();
    open_measure(&mut app);
    drop_file(&mut app, "phone.wav", &wav);
    assert!(app.shows("A recording of the sweep:") && app.shows("kHz, 2 channels"));
    assert!(app.shows("no description yet") && !app.is_enabled("Take it"));
    choose_kind(&mut app, "choose…", "acceleration");
    assert!(!app.is_enabled("Take it"));
    *app.files.contents.borrow_mut() = vec![(PathBuf::from("sweep.toml"), Ok(sweep.to_toml()))];
    press(&mut app, "Open its sweep…");
    assert!(!app.shows("no description yet") && app.is_enabled("Take it"));
    // The first channel is silent: the refusal is in the form.
    press(&mut app, "Take it");
    assert!(app.shows("the recording is shorter than the sweep, or silent"));
    type_into(&mut app, "Channel", "3");
    assert!(app.shows("channel = 3: must be 1 to 2"));
    type_into(&mut app, "Channel", "2");
    press(&mut app, "Take it");
    assert!(!app.shows("A recording of the sweep:") && app.has("phone.wav"));
    // By default the next recording is of the same sweep.
    drop_file(&mut app, "again.wav", &wav);
    assert!(!app.shows("no description yet"));
    press(&mut app, "Leave it");
    assert!(!app.shows("A recording of the sweep:"));
}
