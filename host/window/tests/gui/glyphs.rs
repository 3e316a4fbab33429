//! Names in scripts that the window's fonts lack.

use crate::background::open_plate;
use crate::test_app::TestApp;
use eframe::egui::epaint::text::{FallbackRequest, FontInsert};
use eframe::egui::{FontData, FontDefinitions, FontFamily, MissingGlyphPolicy};
use std::sync::Arc;

/// A window that shows boxes for what no font has, as the program's does; others of these tests would fail.
fn driving() -> TestApp {
    let app = TestApp::driving();
    app.window.ctx.set_missing_glyph_policy(MissingGlyphPolicy::Tofu);
    app
}

fn open_named(app: &mut TestApp, name: &str) {
    let text = slipline_plate::preset("membrane").unwrap().to_toml();
    open_plate(app, text.replace("name = \"membrane\"", &format!("name = \"{name}\"")));
}

fn is_reported(app: &TestApp, code: &str) -> bool {
    // Not the log's line, which begins with its time.
    let text = format!("No font of this system has the characters {code}");
    app.window.state().notice().is_some_and(|notice| notice.text.starts_with(&text))
}

#[test]
fn a_name_that_no_font_can_show_is_reported_once_and_the_rest_works() {
    let mut app = driving();
    open_named(&mut app, "Größe \u{00b5} Ж");
    assert!(!is_reported(&app, ""), "the window's own fonts have these");
    open_named(&mut app, "\u{819c}\u{677f} 12");
    assert!(is_reported(&app, "U+677F, U+819C"));
    app.wait(500);
    assert_eq!(app.window.state().setup().plate.name(), "\u{819c}\u{677f} 12");
    app.click("Dismiss", 100);
    open_named(&mut app, "\u{819c}");
    assert!(!is_reported(&app, ""), "they were reported");
}

/// A system with one more font: Hack, which the window uses for figures only. It stands for a CJK font, which no test can
/// count on: U+E0A0 is in Hack and in no font of the window's words.
#[test]
fn a_name_that_a_font_of_the_system_can_show_is_shown() {
    const ONLY_HACK: &str = "\u{e0a0}";
    let mut app = driving();
    open_named(&mut app, &format!("before {ONLY_HACK}"));
    assert!(is_reported(&app, "U+E0A0"));
    let mut app = driving();
    let hack: FontData = (*FontDefinitions::default().font_data["Hack"]).clone();
    let system = move |request: &FallbackRequest<'_>| {
        let is_wanted = *request.family == FontFamily::Proportional;
        is_wanted.then(|| FontInsert {
            name: "of the system".to_owned(),
            data: hack.clone(),
            families: Vec::new(),
        })
    };
    app.window.ctx.add_font_provider(Arc::new(system));
    app.wait(100);
    open_named(&mut app, &format!("after {ONLY_HACK}"));
    assert!(!is_reported(&app, ""));
}
