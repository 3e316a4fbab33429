//! An unknown value is shown as a dash, never as a number.

use crate::fixed_link::FixedLink;
use crate::plots::words;
use crate::test_app::{TestApp, click, opened};
use egui_kittest::kittest::Queryable as _;
use slipline_link::{Port, Request, Snapshot};

#[test]
fn without_a_device_meters_and_heights_are_dashes_and_connect_is_one_press_away() {
    let link = FixedLink::of(Snapshot::default());
    let mut window = opened(link.clone(), [1280.0, 800.0]);
    for meter in ["Level", "Headroom", "Thermal load"] {
        assert!(window.query_by_label(&format!("{meter}: –")).is_some(), "{meter}");
    }
    let painted = words(window.output());
    let has = |word: &str| painted.iter().any(|(painted, _)| painted == word);
    assert!(!has("silent") && !has("all") && !has("0 %"), "{painted:?}");
    assert!(!has("nm") && !has("µm") && !has("mm"), "the envelope has no scale yet: {painted:?}");
    // The colours, the envelope's scale, the peak's height, three meters, four counters.
    assert_eq!(painted.iter().filter(|(word, _)| word == "–").count(), 10, "{painted:?}");
    assert!(has("180.0 mm"), "where the boundary is needs no table: {painted:?}");
    link.sent.borrow_mut().clear();
    click(&mut window, "Connect");
    assert!(matches!(link.sent.borrow()[..], [Request::Connect(Port::Simulated)]), "{:?}", link.sent);
}

#[test]
fn another_plates_heights_are_dashes_until_its_table_is_made() {
    let mut app = TestApp::driving();
    let dashes = |app: &TestApp| words(app.window.output()).iter().filter(|(word, _)| word == "–").count();
    assert_eq!(dashes(&app), 0);
    app.plug(false);
    app.wait(1500);
    // The device is gone, so its rate is unknown and the new plate's table cannot be made.
    crate::background::open_plate(&mut app, slipline_plate::preset("al-bending").unwrap().to_toml());
    assert!(dashes(&app) >= 3);
    let painted = words(app.window.output());
    assert!(!painted.iter().any(|(word, _)| word == "1.00 µm" || word == "+1.00 µm"), "{painted:?}");
    app.plug(true);
    app.wait(3000);
    assert_eq!(dashes(&app), 0);
}
