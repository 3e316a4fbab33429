//! The exports.

use crate::test_app::TestApp;
use eframe::egui::OutputCommand;
use egui_kittest::kittest::Queryable as _;

/// Chooses an entry of the File menu.
pub(crate) fn file_menu(app: &mut TestApp, entry: &str) {
    app.click("File", 200);
    app.click_part(entry, 200);
}

/// The width and height of a PNG file in pixels, its pixels, and its dots per metre.
fn decoded(bytes: &[u8]) -> (u32, u32, Vec<[u8; 3]>, Option<u32>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut data = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut data).unwrap();
    let dots = reader.info().pixel_dims.map(|dims| dims.xppu);
    let pixels = data[..info.buffer_size()].chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
    (info.width, info.height, pixels, dots)
}

#[test]
fn the_figure_is_of_the_plate_at_print_size_and_not_of_the_window() {
    let mut app = TestApp::driving();
    file_menu(&mut app, "Export figure (PNG)…");
    let (name, bytes) = app.files.saved.borrow().last().cloned().unwrap();
    assert_eq!(name, "figure.png");
    let (width, height, pixels, dots) = decoded(&bytes);
    let mm = |pixels: u32| f64::from(pixels) / f64::from(dots.unwrap()) * 1e3;
    assert!((mm(width) - 170.0).abs() < 0.2 && (70.0..170.0).contains(&mm(height)), "{width} x {height}");
    // The figure has no STOP button, but it has the rings of the simulated plate.
    let count = |is_it: fn(&[u8; 3]) -> bool| pixels.iter().filter(|pixel| is_it(pixel)).count();
    assert_eq!(count(|p| p[0] > 170 && p[1] < 60 && p[2] < 70), 0);
    assert!(count(|p| p[0] > 190 && (70..130).contains(&p[1]) && p[2] < 60) > 500);
    // The SVG file contains the same words as text.
    file_menu(&mut app, "Export figure (SVG)…");
    let (name, bytes) = app.files.saved.borrow().last().cloned().unwrap();
    assert_eq!(name, "figure.svg");
    let svg = String::from_utf8(bytes).unwrap();
    for words in [">membrane</text>", ">simulated plate</text>", ">x from the driven end (mm)</text>"] {
        assert!(svg.contains(words), "{words}");
    }
}

#[test]
fn exports_hold_what_is_seen() {
    let mut app = TestApp::driving();
    for (entry, name) in [
        ("Export envelope (CSV)…", "envelope.csv"),
        ("Export waveform (CSV)…", "waveform.csv"),
        ("Export drive (WAV)…", "drive.wav"),
    ] {
        file_menu(&mut app, entry);
        let (saved, bytes) = app.files.saved.borrow().last().cloned().unwrap();
        assert_eq!(saved, name);
        assert!(bytes.len() > 1000, "{name}: {}", bytes.len());
    }
    let saved = app.files.saved.borrow();
    let envelope = String::from_utf8(saved[0].1.clone()).unwrap();
    assert!(envelope.contains("\n# plate: membrane\n") && envelope.contains("\nposition_m,"));
    assert!(!envelope.contains("NaN"));
    let wav = hound::WavReader::new(&saved[2].1[..]).unwrap();
    assert_eq!(wav.spec().sample_rate, 400_000);
    assert!(wav.into_samples::<i16>().map(|sample| sample.unwrap().abs()).max().unwrap() > 8000);
}

/// Whether diagnostics reach the clipboard within the next frames.
fn are_copied(app: &mut TestApp) -> bool {
    let is_it = |command: &OutputCommand| matches!(command, OutputCommand::CopyText(text) if text.contains("== status"));
    (0..4).any(|_| {
        app.window.step();
        app.window.output().platform_output.commands.iter().any(is_it)
    })
}

#[test]
fn the_diagnostics_are_copied_at_once_and_then_read_and_saved() {
    let mut app = TestApp::driving();
    app.click("File", 200);
    app.window.get_by_label_contains("Copy diagnostics").click();
    assert!(are_copied(&mut app), "one click is enough");
    app.wait(200);
    let text = app.window.get_by_label_contains("== status").value().unwrap();
    // The frames are decoded bodies, for developers; everything above them is for everyone.
    let (report, frames) = text.split_once("== latest frames").unwrap();
    assert!(
        report.contains("Sample rate:                   400000 Hz") && !report.contains("Some("),
        "{text}"
    );
    assert!(frames.contains(" to device ") && frames.contains(" to host "), "{text}");
    assert!(app.has_part("read it before you send it"));
    app.window.get_by_label("Copy again").click_accesskit();
    assert!(are_copied(&mut app));
    app.click("Save diagnostics…", 100);
    let (name, bytes) = app.files.saved.borrow().last().cloned().unwrap();
    assert_eq!(name, "slipline-diagnostics.txt");
    assert!(String::from_utf8(bytes).unwrap().contains("== log"));
}
