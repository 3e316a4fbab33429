//! Dialogs keep their size while they are used, and fit the smallest screen, whatever names they hold.

use crate::calibrate::{answers, go_through, open_calibration, page};
use crate::small_screens::screen;
use crate::test_app::TestApp;
use crate::type_into;
use eframe::egui::{Key, Modifiers, Rect, Shape, accesskit::Role};
use egui_kittest::kittest::Queryable as _;
use std::path::PathBuf;

/// The usual window, the smallest screen, and that with the bars of the system.
const SIZES: [[f32; 2]; 3] = [[1280.0, 800.0], [640.0, 480.0], [640.0, 400.0]];

const LONG: &str = "a plate whose name is as long as a name may be made by whoever has the time";

fn collect(shape: &Shape, rects: &mut Vec<(Rect, u8)>) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| collect(shape, rects)),
        Shape::Rect(shape) => rects.push((shape.rect, shape.fill.a())),
        _ => {}
    }
}

/// The frame of the dialog: the first opaque rectangle over what dims the window. It fades in and settles first.
fn frame(app: &mut TestApp) -> Rect {
    app.wait(900);
    let window = app.window.ctx.content_rect();
    let mut rects: Vec<(Rect, u8)> = Vec::new();
    for clipped in &app.window.output().shapes {
        collect(&clipped.shape, &mut rects);
    }
    let dims = |(rect, alpha): &(Rect, u8)| rect.contains_rect(window) && (1..255).contains(alpha);
    let front = rects.iter().rposition(dims).unwrap_or_else(|| {
        panic!("no dialog: {:?} {:?}", app.window.state().notice(), app.snapshot().record.log.back())
    });
    rects[front + 1..].iter().find(|(_, alpha)| *alpha == 255).expect("its frame").0
}

fn press(app: &mut TestApp, name: &str) {
    app.window.get_by_role_and_label(Role::Button, name).scroll_to_me();
    app.wait(300);
    app.click_button(name, 200);
}

fn sized(size: [f32; 2]) -> TestApp {
    let mut app = TestApp::driving();
    app.resize(size.into(), 100);
    app
}

#[test]
fn the_calibration_keeps_its_size_from_page_to_page_and_fits_the_smallest_screen() {
    for size in SIZES {
        let mut app = sized(size);
        go_through(&mut app, &answers(1.04));
        let first = frame(&mut app);
        assert!(screen(size).contains_rect(first), "{size:?}: {first}");
        for number in (1..5).rev() {
            press(&mut app, "Back");
            assert_eq!(page(&app), Some(number));
            assert_eq!(frame(&mut app), first, "{size:?}: page {number}");
        }
        press(&mut app, "Cancel");
    }
}

#[test]
fn long_names_and_a_fold_out_leave_the_calibration_as_wide_as_it_is() {
    for size in SIZES {
        let mut app = sized(size);
        open_calibration(&mut app);
        let usual = frame(&mut app);
        press(&mut app, "Cancel");
        let text = slipline_plate::preset("membrane").unwrap().to_toml();
        let name = format!("name = \"{LONG}\"");
        crate::background::open_plate(&mut app, text.replace("name = \"membrane\"", &name));
        app.wait(1500);
        open_calibration(&mut app);
        assert_eq!(frame(&mut app), usual, "{size:?}: the plate's name");
        let calipers = app.window.get_by_label("I measured width and length with calipers");
        calipers.click();
        assert_eq!(frame(&mut app), usual, "{size:?}: the calipers");
        // A comma as the sign of decimals, and a value that is refused.
        type_into(&mut app, "Width, driven end", "80,5 mm");
        let width = app.window.get_by_role_and_label(Role::TextInput, "Width, driven end").value();
        assert_eq!(width.as_deref(), Some("80.5 mm"), "{size:?}");
        type_into(
            &mut app,
            "Width, driven end",
            "1e300 mm, and more words than there is room for in its field",
        );
        assert_eq!(frame(&mut app), usual, "{size:?}: a refused value");
        press(&mut app, "Next");
        press(&mut app, "Next");
        let name = PathBuf::from(format!("{}.csv", LONG.replace(' ', "-")));
        *app.files.contents.borrow_mut() = vec![(name, Ok(answers(1.04)[0].to_csv()))];
        press(&mut app, "Open file…");
        assert_eq!(frame(&mut app), usual, "{size:?}: the name of a measurement");
    }
}

#[test]
fn every_other_dialog_fits_the_smallest_screen() {
    for size in SIZES {
        let mut app = sized(size);
        for (menu, entry) in [
            ("File", "Scenes…"),
            ("Help", "Keys"),
            ("Help", "Ports and permissions"),
            ("Help", "About Slipline"),
            ("File", "Copy diagnostics"),
        ] {
            if entry == "Keys" {
                app.window.key_press(Key::F1);
            } else {
                app.click(menu, 200);
                app.window.get_by_label_contains(entry).scroll_to_me();
                app.wait(300);
                app.window.get_by_label_contains(entry).click();
            }
            let first = frame(&mut app);
            assert!(screen(size).contains_rect(first), "{size:?} {entry}: {first}");
            app.wait(500);
            assert_eq!(frame(&mut app), first, "{size:?} {entry}");
            app.click("Close", 300);
        }
        // A path that is longer than its field, and one whose file exists.
        app.files.has_no_dialogs.set(true);
        app.window.key_press_modifiers(Modifiers::COMMAND, Key::S);
        let first = frame(&mut app);
        assert!(screen(size).contains_rect(first), "{size:?}: {first}");
        app.window.get_by_role_and_label(Role::TextInput, "File path").type_text(&LONG.repeat(3));
        assert_eq!(frame(&mut app), first, "{size:?}: a long path");
        press(&mut app, "Save");
        app.keys(Modifiers::COMMAND, Key::S, 300);
        app.window.get_by_role_and_label(Role::TextInput, "File path").type_text(&LONG.repeat(3));
        app.wait(100);
        press(&mut app, "Save");
        assert!(app.has_part("A file of that name exists"));
        assert_eq!(frame(&mut app), first, "{size:?}: an existing file");
    }
}
