//! Files that are dropped on the window: each is opened as what it is.

use crate::test_app::TestApp;
use eframe::egui::{DroppedFile, HoveredFile, accesskit::Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use slipline_model::export::figures::encode;
use std::path::{Path, PathBuf};
use std::sync::Arc;

#[derive(Debug)]
struct Dropped(PathBuf);

impl DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        Err("the app reads files by their path".to_owned())
    }
}

#[test]
fn a_file_that_is_held_over_the_window_is_asked_for_in_words() {
    let mut app = TestApp::driving();
    let is_said = |app: &TestApp| {
        crate::plots::words(app.window.output()).iter().any(|(words, _)| words.starts_with("Drop to open "))
    };
    assert!(!is_said(&app));
    app.window.input_mut().hovered_files = vec![HoveredFile::default()];
    app.wait(50);
    assert!(is_said(&app));
    app.window.input_mut().hovered_files.clear();
    app.wait(50);
    assert!(!is_said(&app));
}

#[test]
fn of_several_files_of_one_setup_one_is_opened_and_the_others_are_named() {
    let mut app = TestApp::driving();
    let plate = |name: &str| {
        let text = slipline_plate::preset(name).unwrap().to_toml();
        (PathBuf::from(format!("{name}.toml")), Ok(text))
    };
    *app.files.contents.borrow_mut() = vec![plate("membrane-heavy"), plate("al-bending")];
    let paths = ["membrane-heavy.toml", "al-bending.toml"].map(PathBuf::from);
    app.window.input_mut().dropped_files = paths.map(|path| Arc::new(Dropped(path)) as _).to_vec();
    app.wait(300);
    assert_eq!(app.window.state().setup().plate.name(), "membrane-heavy");
    let log = app.snapshot().record.log;
    assert!(log.iter().any(|line| line.text.contains("Not opened: al-bending.toml")), "{log:?}");
}

/// Drops a file with these bytes, which exists under its name.
fn drop_file(app: &mut TestApp, name: &str, bytes: &[u8]) {
    let path = PathBuf::from(name);
    *app.files.profiles.borrow_mut() = vec![(path.clone(), Ok(bytes.to_vec()))];
    let text = String::from_utf8(bytes.to_vec()).map_err(|error| error.to_string());
    *app.files.contents.borrow_mut() = vec![(path.clone(), text)];
    app.window.input_mut().dropped_files = vec![Arc::new(Dropped(path))];
    app.wait(300);
}

/// Place in mm and amplitude of each breakpoint on the texture page.
fn breakpoints(app: &TestApp) -> Vec<(f64, String)> {
    let handle = |number: usize| {
        let name = format!("Breakpoint {number}");
        let handle = app.window.query_by_role_and_label(Role::Slider, &name)?;
        let access = handle.accesskit_node();
        Some((access.numeric_value()?, access.description()?))
    };
    (1..).map_while(handle).collect()
}

#[test]
fn a_dropped_csv_or_png_is_drawn_as_a_profile_on_the_page_of_textures() {
    let mut app = TestApp::driving();
    drop_file(&mut app, "falling.CSV", b"place_m,rms\n0.01,1\n0.28,0.25\n");
    assert!(app.has("Texture over the plate"), "the page is open");
    let drawn = breakpoints(&app);
    assert_eq!(drawn.iter().map(|(mm, _)| *mm).collect::<Vec<_>>(), [10.0, 280.0]);
    assert!(drawn[1].1.starts_with("280.0 mm, 0.25"), "{drawn:?}");
    // Three grey pixels over the plate of 320 mm.
    let grey = [255, 128, 0].map(|level| [level, level, level, 255]);
    drop_file(&mut app, "row.png", &encode((3, 1), &grey, None).unwrap());
    let drawn = breakpoints(&app);
    assert_eq!(drawn.iter().map(|(mm, _)| *mm).collect::<Vec<_>>(), [0.0, 160.0, 320.0]);
    assert!(drawn[1].1.starts_with("160.0 mm, 0.50"), "{drawn:?}");
    assert!(app.is_driving() && app.window.state().notice().is_some_and(|notice| !notice.is_error));
}

#[test]
fn a_dropped_plate_or_recording_is_recognised_and_nonsense_is_refused_by_name() {
    let mut app = TestApp::driving();
    drop_file(&mut app, "drag.csv", b"time_s,tone,place_m\n0,1,0.18\n0.5,1,0.2\n");
    app.click_button("Play", 100);
    assert!(app.has("2 moves, 0.5 s"));
    assert!(!app.has("Texture over the plate"));
    let plate = slipline_plate::preset("membrane-heavy").unwrap().to_toml();
    drop_file(&mut app, "heavy.toml", plate.as_bytes());
    assert_eq!(app.window.state().setup().plate.name(), "membrane-heavy");
    drop_file(&mut app, "cat.png", b"not a picture");
    let notice = app.window.state().notice().cloned().unwrap();
    assert!(notice.is_error && notice.text.contains("cat.png"), "{notice:?}");
}
