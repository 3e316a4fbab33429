//! The page that helps with ports.

use crate::test_app::TestApp;
use eframe::egui::OutputCommand;
use egui_kittest::kittest::Queryable as _;

/// What `slipline udev` prints and the Debian package installs.
const SHIPPED: &str = slipline_link::udev::RULES;

#[test]
fn the_rules_on_the_page_are_the_file_that_is_shipped() {
    assert!(SHIPPED.contains("ATTRS{idProduct}==\"df11\""), "a device is also flashed");
    let mut app = TestApp::driving();
    app.click("Help", 200);
    app.click_part("Ports and permissions", 200);
    assert!(app.has(SHIPPED));
    let others = ["Windows", "macOS"].map(|system| app.has(system));
    assert_eq!(others, [false; 2], "nothing for another system");
    app.window.get_by_label("Copy the rules").scroll_to_me();
    app.wait(300);
    app.window.get_by_label("Copy the rules").click();
    let mut copied = Vec::new();
    for _ in 0..4 {
        app.window.step();
        copied.extend(app.window.output().platform_output.commands.iter().filter_map(|command| {
            if let OutputCommand::CopyText(text) = command { Some(text.clone()) } else { None }
        }));
    }
    assert_eq!(copied, [SHIPPED]);
}
