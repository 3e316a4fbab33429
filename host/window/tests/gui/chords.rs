//! The texture page for a device that plays chords, and for one that does not.

use crate::fake_files::FakeFiles;
use crate::real_device;
use crate::test_app::open_window;
use eframe::egui::{Key, Modifiers, accesskit::Role};
use egui_kittest::kittest::Queryable as _;
use slipline_link::protocol::event::State;
use slipline_link::protocol::version::MINOR;
use slipline_window::settings::ThemeChoice;
use std::sync::Arc;

#[test]
fn the_texture_page_says_whether_the_device_plays_a_chord() {
    for (minor, is_told) in [(0, true), (MINOR, false)] {
        let mut link = real_device(State::Idle);
        let snapshot = Arc::make_mut(&mut link.snapshot);
        Arc::make_mut(snapshot.device.identity.as_mut().unwrap()).version.minor = minor;
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
    }
}
