//! Small screens: STOP, the boundary line and the controls stay usable, whatever page is open.

use crate::fixed_link::FixedLink;
use crate::test_app::{TestApp, click, opened};
use crate::{boundary_mm, line_rect, real_device, type_into};
use eframe::egui::{Key, Modifiers, Rect, Vec2, accesskit::Role, pos2, vec2};
use egui_kittest::HarnessBuilder;
use egui_kittest::kittest::Queryable as _;
use slipline_link::protocol::event::State;
use slipline_link::{LinkError, LinkState, Port, Request, Snapshot};
use slipline_window::settings::ThemeChoice;

/// Sizes in points: the smallest supported, a small panel display, and 1600 x 1000 pixels at 2 pixels per point.
pub(crate) const SIZES: [[f32; 2]; 3] = [[640.0, 480.0], [800.0, 480.0], [800.0, 500.0]];

pub(crate) fn screen(size: [f32; 2]) -> Rect {
    Rect::from_min_size(pos2(0.0, 0.0), Vec2::from(size))
}

fn stop_is_on_the_screen(app: &TestApp, size: [f32; 2], what: &str) {
    let stop = app.window.get_by_label("STOP").rect();
    assert!(screen(size).contains_rect(stop), "{size:?} {what}: {stop}");
    assert!(stop.width() >= 80.0 && stop.height() >= 30.0, "{size:?} {what}: {stop}");
}

/// A window of this size that drives.
pub(crate) fn small(size: [f32; 2]) -> TestApp {
    let builder = HarnessBuilder::default().with_size(size).with_theme(eframe::egui::Theme::Light);
    TestApp::driving_with(ThemeChoice::Light, builder)
}

#[test]
fn on_a_small_screen_the_panels_give_their_room_to_the_stage_and_stop_stays() {
    let mut app = TestApp::driving();
    app.resize(vec2(640.0, 480.0), 100);
    // There is no room for both, so the plots have closed by themselves.
    assert!(app.has("Tones") && !app.has("Drive waveform"));
    let before = line_rect(&app);
    assert!(before.height() > 200.0, "{before}");
    app.keys(Modifiers::COMMAND, Key::Num0, 100);
    assert!(line_rect(&app).left() > before.left() + 150.0, "{before} {}", line_rect(&app));
    assert!(!app.has("Tones") && !app.has("Drive waveform"));
    let stop = app.window.get_by_label("STOP").rect();
    assert!(stop.right() <= 640.0 && stop.bottom() <= 480.0, "{stop}");
    // The line moves and the plate is driven as before.
    app.key(Key::ArrowRight, 100);
    assert!(app.is_driving());
    // A message opens nothing, and the key of a page opens the panel.
    app.open("bad.toml", Ok("nonsense".to_owned()));
    assert!(app.has("Dismiss") && !app.has("Tones"));
    app.click("Dismiss", 100);
    assert!(!app.has("Tones"));
    app.keys(Modifiers::COMMAND, Key::Num2, 100);
    assert!(app.has("Add tone"));
    app.click("View", 200);
    app.click("Plots, meters and log", 100);
    assert!(app.has("Drive waveform") && !app.has("Tones"));
    // The buttons at the bottom open one in place of the other, and a larger window shows both.
    app.click("Panel", 100);
    assert!(!app.has("Drive waveform") && app.has("Tones"));
    app.resize(vec2(1280.0, 800.0), 100);
    assert!(app.has("Drive waveform") && app.has("Tones"));
    assert!(!app.has("Panel"));
}

#[test]
fn the_hint_lies_over_nothing_and_the_names_are_read_on_a_small_screen() {
    for size in SIZES.into_iter().chain([[640.0, 400.0], [960.0, 620.0], [1280.0, 800.0]]) {
        let app = small(size);
        let hint = app.window.get_by_label("Drag the line").rect();
        assert!(screen(size).contains_rect(hint), "{size:?}: {hint}");
        let line = line_rect(&app);
        // The line's column begins with the row of its flag; plate, envelope and strip are under that row.
        assert!(hint.bottom() <= line.top() + 27.0, "{size:?}: {hint} {line}");
        for name in ["Wave", "View of the plate", "Validity: 3 notes"] {
            let Some(other) = app.window.query_by_label_contains(name).map(|node| node.rect()) else {
                continue;
            };
            assert!(!hint.intersects(other.shrink(1.0)), "{size:?} {name}: {hint} {other}");
        }
        assert!(line.height() >= 150.0, "{size:?}: {line}");
    }
}

#[test]
fn the_flag_of_the_line_is_whole_at_every_size_and_place() {
    for size in SIZES.into_iter().chain([[640.0, 400.0], [960.0, 620.0], [1280.0, 800.0]]) {
        let mut app = small(size);
        if !app.has("Tones") {
            app.keys(Modifiers::COMMAND, Key::Num1, 100);
        }
        for place in ["80 mm", "176.5 mm", "280 mm"] {
            type_into(&mut app, "Boundary position", place);
            app.wait(500);
            let flag = app.window.get_by_label_contains("Flag: turning point ").rect();
            let panel = app.window.get_by_role_and_label(Role::Button, "Boundary").rect();
            assert!(flag.left() >= 0.0 && flag.right() < panel.left(), "{size:?} {place}: {flag} {panel}");
        }
    }
}

#[test]
fn stop_is_on_a_small_screen_with_any_panel_or_page_open() {
    for size in SIZES {
        let mut app = small(size);
        for panel in ["Boundary", "Tones", "Texture", "Plate", "Device", "Play"] {
            app.click_button(panel, 100);
            stop_is_on_the_screen(&app, size, panel);
        }
        for page in ["Shortcuts", "Ports and permissions", "About Slipline", "Copy diagnostics"] {
            let menu = if page == "Copy diagnostics" { "File" } else { "Help" };
            app.click(menu, 200);
            app.window.get_by_label_contains(page).scroll_to_me();
            app.wait(300);
            app.click_part(page, 200);
            stop_is_on_the_screen(&app, size, page);
            // The page shows its own button, too, and STOP does not cover it.
            let close = app.window.get_by_label("Close").rect();
            let stop = app.window.get_by_label("STOP").rect();
            assert!(screen(size).contains_rect(close), "{size:?} {page}: {close}");
            assert!(!stop.expand(2.0).intersects(close), "{size:?} {page}: {close}");
            app.click("Close", 200);
            assert!(!app.has("Close"), "{size:?} {page}");
        }
        app.take_sent();
        app.key(Key::F1, 200);
        app.click("STOP", 300);
        assert!(app.take_sent().iter().any(|request| matches!(request, Request::Stop)), "{size:?}");
        assert!(!app.is_driving(), "{size:?}");
    }
}

#[test]
fn confirmations_and_typed_paths_fit_a_small_screen() {
    for size in SIZES {
        let link = real_device(State::Idle);
        let mut window = opened(link, size);
        click(&mut window, "Arm…");
        let stop = window.get_by_label("STOP").rect();
        for name in ["Cancel", "Arm", "STOP"] {
            let rect = window.get_by_label(name).rect();
            assert!(screen(size).contains_rect(rect), "{size:?}: {name} {rect}");
            assert!(name == "STOP" || !rect.intersects(stop), "{size:?}: {name} {rect}");
        }
        let mut app = small(size);
        app.files.has_no_dialogs.set(true);
        app.keys(Modifiers::COMMAND, Key::S, 200);
        for name in ["Cancel", "Save", "STOP"] {
            let rect = app.window.get_by_label(name).rect();
            assert!(screen(size).contains_rect(rect), "{size:?}: {name} {rect}");
        }
    }
}

#[test]
fn the_line_can_be_dragged_on_a_small_screen() {
    for size in SIZES {
        let mut app = small(size);
        let line = line_rect(&app);
        assert!(line.width() >= 24.0 && line.height() >= 150.0, "{size:?}: {line}");
        let before = boundary_mm(&app);
        app.grab(line.center(), 0);
        app.hover(line.center() + vec2(20.0, 0.0), 0);
        app.release(line.center() + vec2(20.0, 0.0), 100);
        assert!(boundary_mm(&app) > before + 10.0, "{size:?}: {}", boundary_mm(&app));
        assert!(app.is_driving(), "{size:?}");
        // The side panel does not cover the plate, and its first field is visible.
        let field = app.window.get_by_role_and_label(Role::TextInput, "Boundary position").rect();
        assert!(screen(size).contains_rect(field) && field.left() > line.right(), "{size:?}: {field}");
    }
}

#[test]
fn stop_is_on_the_screen_at_every_zoom_and_pixel_density() {
    for (pixels, density) in [([1280.0, 800.0], 1.0), ([1600.0, 1000.0], 2.0), ([800.0, 480.0], 1.0)] {
        let size = Vec2::from(pixels) / density;
        let mut app = small(size.into());
        app.window.set_pixels_per_point(density);
        for key in [Key::Plus, Key::Minus] {
            for _ in 0..12 {
                app.window.key_press_modifiers(Modifiers::COMMAND, key);
                for _ in 0..3 {
                    app.wait(50);
                    app.window.set_size(size / app.window.ctx.zoom_factor());
                }
                let seen = app.window.ctx.content_rect();
                let stop = app.window.get_by_label("STOP").rect();
                assert!(seen.contains_rect(stop), "{pixels:?} at {density}: {seen} {stop}");
            }
        }
    }
}

#[test]
fn the_buttons_of_the_pages_stay_while_a_page_is_scrolled_and_each_page_keeps_its_place() {
    let mut app = small(SIZES[0]);
    let pages = ["Boundary", "Tones", "Texture", "Plate", "Device", "This plate", "Validity", "Designer"];
    app.click_button("Plate", 100);
    let place = |app: &TestApp, name: &str| app.window.get_by_role_and_label(Role::Button, name).rect();
    let before = pages.map(|name| place(&app, name));
    let field = |app: &TestApp| app.window.get_by_role_and_label(Role::TextInput, "Length").rect().top();
    let top = field(&app);
    app.turn_wheel(pos2(480.0, 300.0), -150.0);
    assert!(field(&app) < top - 100.0, "{top} {}", field(&app));
    assert_eq!(pages.map(|name| place(&app, name)), before);
    let scrolled = field(&app);
    app.click_button("Device", 100);
    app.click_button("Plate", 100);
    assert_eq!(field(&app), scrolled);
}

/// Scroll bars at their widest, as they are drawn under the pointer.
fn bars(app: &TestApp) -> Vec<Rect> {
    let wide = app.window.ctx.global_style().spacing.scroll.bar_width;
    let is_bar = |rect: &Rect| (rect.width() - wide).abs() < 0.6 && rect.height() > 20.0;
    let shapes = app.window.output().shapes.iter();
    let rects = shapes.filter_map(|clipped| match &clipped.shape {
        eframe::egui::Shape::Rect(shape) => Some(shape.rect.intersect(clipped.clip_rect)),
        _ => None,
    });
    rects.filter(is_bar).collect()
}

#[test]
fn no_scroll_bar_lies_over_letters() {
    let mut app = small(SIZES[0]);
    let clear = |app: &mut TestApp, at: eframe::egui::Pos2, what: &str| {
        app.hover(at, 600);
        let bars = bars(app);
        assert!(!bars.is_empty(), "{what}: it scrolls");
        // A page in front is painted after what it lies over.
        let painted = crate::plots::words(app.window.output()).into_iter();
        for (words, rect) in painted.skip_while(|(words, _)| what == "Shortcuts" && words != what) {
            for bar in &bars {
                assert!(
                    words.is_empty() || !bar.intersects(rect.shrink(0.5)),
                    "{what}: {words} {rect} {bar}"
                );
            }
        }
    };
    for page in ["Boundary", "Plate", "Device"] {
        app.click_button(page, 100);
        clear(&mut app, pos2(613.0, 300.0), page);
    }
    app.click("Plots", 100);
    if app.has("Output") && app.window.query_all_by_role(Role::ProgressIndicator).next().is_none() {
        app.click("Output", 100);
    }
    // Only in a lower window the meters have no room.
    app.resize(vec2(640.0, 400.0), 100);
    let level = app.window.get_all_by_role(Role::ProgressIndicator).next().unwrap().rect();
    clear(&mut app, level.right_center() + vec2(8.0, 0.0), "meters");
    app.resize(SIZES[0].into(), 100);
    for name in ["Level", "Headroom"] {
        let words = crate::plots::words(app.window.output());
        let (_, row) = words.iter().find(|(words, _)| words == name).unwrap();
        let beside = |at: &Rect| (at.center().y - row.center().y).abs() < 3.0 && at.left() > row.right();
        let (value, _) = words.iter().find(|(_, at)| beside(at)).unwrap();
        assert!(value.ends_with(" dB"), "{name}: {value}");
    }
    app.key(Key::F1, 300);
    let close = app.window.get_by_label("Close").rect();
    clear(&mut app, pos2(640.0 - close.left() - 4.0, 200.0), "Shortcuts");
}

#[test]
fn a_long_name_of_a_port_moves_nothing_out_of_the_smallest_window() {
    let name = format!("/run/user/1000/{}/device.sock", "a-folder-with-a-long-name/".repeat(3));
    let port = Port::Unix(name.into());
    let mut driven = (*real_device(State::Driving).snapshot).clone();
    driven.link.port = Some(port.clone());
    let mut missing = Snapshot { revision: 1, ..Snapshot::default() };
    missing.link.state = LinkState::Reconnecting(LinkError::NoSuchPort(port.clone()));
    missing.link.port = Some(port.clone());
    for snapshot in [driven, missing] {
        let link = FixedLink::of(snapshot);
        let mut window = opened(link, SIZES[0]);
        window.get_by_role_and_label(Role::Button, "Device").click();
        window.run_steps(5);
        let named: Vec<Rect> =
            window.get_all_by_label_contains(&port.to_string()).map(|node| node.rect()).collect();
        assert!(named.len() >= 2, "in the menu and in the list: {named:?}");
        let [bar, page] = ["STOP", "Another port"].map(|name| window.get_by_label(name).rect());
        for rect in named.into_iter().chain([bar, page]) {
            assert!(screen(SIZES[0]).contains_rect(rect), "{rect}");
        }
        let words = crate::plots::words(window.output());
        // What is typed scrolls in its field.
        let is_typed = |rect: &Rect| page.contains(rect.left_center());
        let is_cut = |(words, rect): &(String, Rect)| {
            !words.is_empty() && rect.right() > SIZES[0][0] && !is_typed(rect)
        };
        let beyond: Vec<_> = words.into_iter().filter(is_cut).collect();
        assert!(beyond.is_empty(), "{beyond:?}");
    }
}

#[test]
fn on_an_upright_telephone_nothing_is_cut_in_the_top_bar_and_a_picture_is_laid_out_once() {
    for size in [[390.0, 844.0], [360.0, 740.0], [844.0, 390.0], [1280.0, 800.0]] {
        let mut app = small(size);
        app.wait(500);
        for name in ["Device: ", "State: ", "round trip", "STOP"] {
            let shown = app.window.query_by_label_contains(name).map(|node| node.rect());
            assert!(
                shown.is_none_or(|shown| app.window.ctx.content_rect().contains_rect(shown)),
                "{size:?} {name}: {shown:?}"
            );
            assert!(shown.is_some() || name == "round trip", "{size:?} {name}");
        }
        let counts =
            |app: &TestApp| (app.window.ctx.cumulative_pass_nr(), app.window.ctx.cumulative_frame_nr());
        let before = counts(&app);
        app.wait(200);
        let after = counts(&app);
        assert!(after.1 > before.1);
        assert_eq!(after.0 - before.0, after.1 - before.1, "{size:?}: passes and pictures");
    }
}
