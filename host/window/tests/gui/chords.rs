//! Setups whose tones are a chord, whose peak the device proves.

use crate::fake_files::FakeFiles;
use crate::real_device;
use crate::test_app::{TestApp, open_window};
use eframe::egui::{self, Key, Modifiers, accesskit::Role};
use egui_kittest::kittest::Queryable as _;
use slipline_link::protocol::event::State;
use slipline_link::{Change, Played, Request, Sounding};
use slipline_model::field::steady_field::SteadyTone;
use slipline_model::setup::Setup;
use slipline_model::sounding;
use slipline_model::texture::{Wish, make};
use slipline_plate::feeling::Feeling;
use slipline_plate::texture::Palette;
use slipline_plate::{DriveTable, Progress};
use slipline_window::settings::ThemeChoice;
use std::sync::Arc;

/// A profile that falls along an aluminium plate, as a chord; and the plate's table.
fn falling() -> (Setup, DriveTable) {
    let plate = slipline_plate::preset("al-bending-displacement").unwrap();
    // As many knots as the app's own.
    let table = DriveTable::build(&plate, 400e3, slipline_model::jobs::table::KNOTS).unwrap();
    let wish = Wish::Profile(vec![(0.01, 1.0), (0.17, 0.8), (0.2, 0.2), (0.34, 0.0)]);
    let made = {
        let (palette, mut tell) = (Palette::new(&plate, &table), |_| true);
        let progress = &mut Progress::new(&mut tell);
        make(&palette, &wish, 16, &Feeling::default(), progress)
            .unwrap()
            .finished(&palette, &Feeling::default(), progress)
            .unwrap()
    };
    (made.setup(Arc::new(plate)), table)
}

/// Whether the latest thing that sounds is a chord; `None` if nothing does.
fn sounds_as_chord(app: &TestApp) -> Option<bool> {
    let snapshot = app.snapshot();
    sounding::sounding(&snapshot)?;
    let is_chord = |change: &Change| match change {
        Change::Play(Played::Chord(_)) => Some(true),
        Change::Play(Played::Drive(_)) => Some(false),
        _ => None,
    };
    snapshot.journal.iter().rev().find_map(|entry| is_chord(&entry.change))
}

/// What was asked of the device's tones since the last call.
fn played(app: &TestApp) -> Vec<Request> {
    let is_of_tones = |request: &Request| {
        matches!(
            request,
            Request::Stop | Request::Play(Sounding::Chord(_)) | Request::Play(Sounding::Drive(_))
        )
    };
    app.take_sent().into_iter().filter(is_of_tones).collect()
}

#[test]
fn a_chord_is_played_as_one_as_loud_as_it_is_drawn_until_a_tone_is_moved() {
    let (setup, table) = falling();
    assert!(setup.chord_gain_db.is_some_and(|gain_db| gain_db > 0.5), "{:?}", setup.chord_gain_db);
    let builder =
        egui_kittest::HarnessBuilder::default().with_size([1280.0, 800.0]).with_theme(egui::Theme::Light);
    let mut app = TestApp::driving_setup(setup.clone(), ThemeChoice::Light, builder);
    // Showing a setup changes nothing of it: levels are not rounded to what a slider shows.
    assert!(app.window.state().setup() == &setup);
    assert_eq!(sounds_as_chord(&app), Some(true));
    let sounding = sounding::sounding(&app.snapshot()).unwrap();
    assert_eq!(sounding.tones.len(), setup.tones.len());
    for tone in &setup.tones {
        let drawn = SteadyTone::of(&setup, tone, &table);
        let at = |other: &&SteadyTone| (other.frequency_hz - drawn.frequency_hz).abs() < 3.0;
        let sounds = sounding.tones.iter().find(at).unwrap();
        assert!((sounds.peak_m / drawn.peak_m - 1.0).abs() < 0.01, "{sounds:?} {drawn:?}");
    }
    // A tone that moves is no multiple any more.
    app.take_sent();
    app.window.key_press(Key::ArrowLeft);
    app.wait(400);
    assert_eq!(app.window.state().setup().chord_gain_db, None);
    assert_eq!(sounds_as_chord(&app), Some(false));
    assert!(app.is_driving() && app.window.state().notice().is_none());
    assert!(matches!(played(&app)[..], [Request::Stop, Request::Play(Sounding::Drive(_))]));
    // What was undone sounds as it did.
    app.window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    app.wait(400);
    assert_eq!(sounds_as_chord(&app), Some(true));
    assert!(app.is_driving());
    assert!(matches!(played(&app)[..], [Request::Stop, Request::Play(Sounding::Chord(_))]));
}

#[test]
fn a_texture_for_a_device_that_plays_no_chords_says_how_much_quieter_it_is() {
    for (minor, is_told) in [(0, true), (slipline_link::protocol::version::MINOR, false)] {
        let mut link = real_device(State::Idle);
        let snapshot = Arc::make_mut(&mut link.snapshot);
        Arc::make_mut(snapshot.identity.as_mut().unwrap()).version.minor = minor;
        assert_eq!(snapshot.can_play_chords(), !is_told);
        let builder = egui_kittest::HarnessBuilder::default().with_size([1280.0, 800.0]);
        let files = FakeFiles::default();
        let profile = Ok(b"0.01,1\n0.17,0.8\n0.2,0.2\n0.34,0\n".to_vec());
        let plate = slipline_plate::preset("al-bending-displacement").unwrap().to_toml();
        *files.contents.borrow_mut() = vec![("plate.toml".into(), Ok(plate))];
        *files.profiles.borrow_mut() = vec![("falling.csv".into(), profile)];
        let mut window = open_window(Box::new(link), &files, ThemeChoice::Light, builder);
        window.run_steps(5);
        window.key_press_modifiers(Modifiers::COMMAND, Key::O);
        window.run_steps(5);
        for name in ["Texture", "Profile", "Open profile…"] {
            window.get_by_role_and_label(Role::Button, name).click();
            window.run_steps(20);
        }
        assert!(window.query_by_label("As a chord").is_some(), "minor {minor}");
        assert_eq!(window.query_by_label("not by this device").is_some(), is_told, "minor {minor}");
        window.get_by_label("Play this").click();
        window.run_steps(5);
        let told = window.state().notice().map(|notice| notice.text.clone()).unwrap_or_default();
        assert_eq!(
            told.starts_with("This device plays no chords: the texture is "),
            is_told,
            "{minor}: {told}"
        );
        assert!(window.state().setup().tones.len() > 1);
    }
}
