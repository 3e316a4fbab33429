//! The brush draws the wanted amplitude over the envelope; the tones follow, and it shades what is out of reach.

use crate::test_app::{TestApp, opened};
use crate::textures::open_textures;
use crate::{boundary_mm, line_rect, real_device};
use eframe::egui::{Color32, Key, Modifiers, Pos2, Rect, Shape, accesskit::Role, pos2, vec2};
use egui_kittest::kittest::Queryable as _;
use slipline_link::protocol::event::State;
use slipline_link::{Request, Sounding};
use slipline_model::setup::{Setup, ToneSetup};

/// The window with the brush in the hand.
pub(crate) fn with_brush(app: &mut TestApp) {
    open_textures(app);
    app.click_button("Brush", 200);
}

fn has(app: &TestApp, name: &str) -> bool {
    app.window.query_all_by_label(name).next().is_some()
}

/// A place of the envelope by its shares of plate and height.
fn at(app: &TestApp, (along, up): (f32, f32)) -> Pos2 {
    let canvas = app.window.get_by_label("Drawing area").rect();
    pos2(canvas.left() + along * canvas.width(), canvas.bottom() - up * (canvas.height() - 6.0))
}

/// Begins a stroke and draws it through these places, five moves from one to the next; it is not ended.
fn draw(app: &mut TestApp, path: &[(f32, f32)]) -> Pos2 {
    let begin = at(app, path[0]);
    app.grab(begin, 50);
    let mut last = begin;
    for &to in &path[1..] {
        let to = at(app, to);
        for step in 1..=5 {
            app.hover(last + (to - last) * (step as f32 / 5.0), 50);
        }
        last = to;
    }
    last
}

/// As [`draw`], to its end.
pub(crate) fn stroke(app: &mut TestApp, path: &[(f32, f32)]) {
    let last = draw(app, path);
    app.release(last, 400);
}

fn setup(app: &TestApp) -> Setup {
    app.window.state().setup().clone()
}

fn loudness(setup: &Setup) -> f64 {
    setup.tones.iter().map(|tone| tone.level).sum()
}

/// The area of the shade over what is out of reach, in square points.
fn shaded(app: &TestApp) -> f32 {
    let ink = Color32::from_rgb(0x96, 0x5a, 0x00).gamma_multiply(0.35);
    let meshes = app.window.output().shapes.iter().filter_map(|clipped| match &clipped.shape {
        Shape::Mesh(mesh) if mesh.vertices.iter().all(|vertex| vertex.color == ink) => Some(mesh),
        _ => None,
    });
    let area = |corners: &[Pos2]| {
        let (a, b) = (corners[1] - corners[0], corners[2] - corners[0]);
        0.5 * (a.x * b.y - a.y * b.x).abs()
    };
    meshes
        .flat_map(|mesh| {
            mesh.indices
                .chunks_exact(3)
                .map(|it| it.iter().map(|&i| mesh.vertices[i as usize].pos).collect::<Vec<_>>())
        })
        .map(|corners| area(&corners))
        .sum()
}

/// An even amplitude that falls: it is within reach.
const FALLS: [(f32, f32); 3] = [(0.06, 0.1), (0.5, 0.1), (0.8, 0.01)];

#[test]
fn the_tones_follow_a_stroke_which_is_one_step_of_undo() {
    let mut app = TestApp::driving();
    with_brush(&mut app);
    let before = setup(&app);
    let mut seen: Vec<Setup> = Vec::new();
    let begin = at(&app, FALLS[0]);
    app.grab(begin, 50);
    for step in 1..=10 {
        let to = at(&app, (0.06 + 0.06 * step as f32, 0.1));
        app.hover(to, 50);
        seen.push(setup(&app));
    }
    seen.dedup();
    assert!(seen.len() > 7, "a fit for each move: {}", seen.len());
    let end = at(&app, (0.66, 0.1));
    app.release(end, 400);
    let drawn = setup(&app);
    assert!(drawn.tones.len() > 1 && app.is_driving());
    assert!(app.window.state().notice().is_none(), "{:?}", app.window.state().notice());
    // A second stroke is another step, and the first one stays.
    stroke(&mut app, &[(0.66, 0.1), (0.85, 0.01)]);
    let more = setup(&app);
    assert_ne!(more, drawn);
    let key = |app: &mut TestApp, key: Key| {
        app.keys(Modifiers::COMMAND, key, 400);
        setup(app)
    };
    assert_eq!(key(&mut app, Key::Z), drawn);
    assert_eq!(key(&mut app, Key::Z), before);
    assert_eq!(key(&mut app, Key::Y), drawn);
    assert_eq!(key(&mut app, Key::Y), more);
}

#[test]
fn what_is_drawn_half_as_high_is_half_as_loud() {
    let loud = |share: f32| {
        let mut app = TestApp::driving();
        with_brush(&mut app);
        stroke(&mut app, &FALLS.map(|(along, up)| (along, share * up)));
        loudness(&setup(&app))
    };
    let (whole, half) = (loud(1.0), loud(0.5));
    assert!(whole > 0.05 && (half / whole - 0.5).abs() < 0.02, "{half} {whole}");
}

#[test]
fn only_what_the_shape_misses_is_shaded_and_not_what_is_too_high_as_a_whole() {
    let shade = |path: &[(f32, f32)]| {
        let mut app = TestApp::driving();
        with_brush(&mut app);
        assert_eq!(shaded(&app), 0.0, "nothing is drawn yet");
        stroke(&mut app, path);
        let length =
            (path[path.len() - 1].0 - path[0].0) * app.window.get_by_label("Drawing area").rect().width();
        // The mean height of the shade.
        shaded(&app) / length
    };
    let falls = shade(&FALLS);
    let rises = shade(&[(0.06, 0.02), (0.8, 0.12)]);
    let too_high = shade(&FALLS.map(|(along, up)| (along, 6.0 * up)));
    assert!(falls < 0.5 && rises > 1.0 && too_high < 2.0, "{falls} {rises} {too_high}");
}

#[test]
fn a_stroke_passes_lines_and_moves_none() {
    let mut app = TestApp::driving();
    with_brush(&mut app);
    let line = line_rect(&app).center().x;
    let canvas = app.window.get_by_label("Drawing area").rect();
    let along = (line - canvas.left()) / canvas.width();
    // It begins on the line.
    stroke(&mut app, &[(along, 0.08), (along - 0.3, 0.08)]);
    assert!(setup(&app).tones.len() > 1);
    // On the plate a press moves the line as usual.
    let plate = app.window.get_by_label("Plate from above").rect();
    let before = setup(&app);
    app.grab(pos2(plate.left() + 0.4 * plate.width(), plate.top() + 8.0), 1000);
    let moved = |(one, other): (&ToneSetup, &ToneSetup)| one.position_m != other.position_m;
    let after = setup(&app);
    assert_eq!(before.tones.iter().zip(&after.tones).filter(|pair| moved(*pair)).count(), 1);
    assert_eq!(shaded(&app), 0.0, "the tones are no longer those of the drawing");
}

/// A way to put the brush away, and its name.
type Way = (&'static str, fn(&mut TestApp));

#[test]
fn escape_its_button_its_switch_and_another_page_put_the_brush_away() {
    let mut app = TestApp::driving();
    let ways: [Way; 4] = [
        ("Esc", |app| app.window.key_press(Key::Escape)),
        ("its button", |app| app.window.get_by_label("Done").click()),
        ("its switch", |app| app.window.get_by_role_and_label(Role::Button, "Brush").click()),
        ("another page", |app| app.window.get_by_role_and_label(Role::Button, "Tones").click()),
    ];
    for (way, put_away) in ways {
        with_brush(&mut app);
        assert!(has(&app, "Drawing area"), "{way}");
        put_away(&mut app);
        app.wait(300);
        assert_eq!(setup(&app).tones.len(), 1, "{way}: that draws nothing");
        assert!(!has(&app, "Drawing area") && !has(&app, "Done"), "{way}");
        if way == "Esc" {
            assert!(has(&app, "Esc ended the drawing and stopped the drive. Press Drive to resume."));
            assert!(!app.is_driving());
            app.click_button("Drive", 200);
        }
        // A press on the envelope brings the line again.
        let envelope = app.window.get_by_label("Envelope").rect();
        let before = boundary_mm(&app);
        let place = pos2(
            envelope.left() + if before > 150.0 { 0.4 } else { 0.6 } * envelope.width(),
            envelope.top() + 40.0,
        );
        app.grab(place, 1000);
        app.release(place, 100);
        assert_ne!(boundary_mm(&app), before, "{way}");
        // While the brush is in use, opening this page would put it away.
        app.click_button("Boundary", 200);
    }
}

#[test]
fn a_drawing_is_sent_a_few_times_a_second_and_to_its_end() {
    let mut app = TestApp::driving();
    with_brush(&mut app);
    app.take_sent();
    // 31 frames of 1/60 s.
    let last = draw(
        &mut app,
        &[(0.06, 0.1), (0.2, 0.1), (0.3, 0.1), (0.4, 0.1), (0.5, 0.1), (0.6, 0.08), (0.7, 0.05)],
    );
    let drives = |sent: &[Request]| sent.iter().filter(|it| matches!(it, Request::Play(_))).count();
    let during = drives(&app.take_sent());
    assert!((2..=3).contains(&during), "{during}");
    app.release(last, 1500);
    let sent = app.take_sent();
    let Some(Request::Play(Sounding::Drive(drive))) =
        sent.iter().rev().find(|it| matches!(it, Request::Play(_)))
    else {
        panic!("{sent:?}")
    };
    let places: Vec<f64> = drive.tones.iter().map(|tone| tone.boundary_m).collect();
    let wanted: Vec<f64> = setup(&app).tones.iter().map(|tone| tone.position_m).collect();
    assert_eq!(places, wanted, "the last of them is that of the setup");
    assert!(app.is_driving());
}

#[test]
fn a_drawing_arms_and_starts_nothing() {
    for state in [State::Idle, State::Fault] {
        let link = real_device(state);
        let mut window = opened(link.clone(), [1280.0, 800.0]);
        window.get_by_role_and_label(Role::Button, "Texture").click();
        window.run_steps(5);
        window.get_by_role_and_label(Role::Button, "Brush").click();
        window.run_steps(5);
        link.sent.borrow_mut().clear();
        let canvas: Rect = window.get_by_label("Drawing area").rect();
        let begin = canvas.left_bottom() + vec2(60.0, -20.0);
        window.drag_at(begin);
        window.run_steps(2);
        window.hover_at(begin + vec2(200.0, 0.0));
        window.run_steps(2);
        window.drop_at(begin + vec2(200.0, 0.0));
        window.run_steps(60);
        assert!(window.state().setup().tones.len() > 1, "{state:?}");
        assert!(link.sent.borrow().is_empty(), "{state:?}: {:?}", link.sent.borrow());
    }
}

#[test]
fn a_stopped_drive_stays_stopped_while_a_profile_is_drawn() {
    let mut app = TestApp::driving();
    with_brush(&mut app);
    app.key(Key::Space, 300);
    app.take_sent();
    stroke(&mut app, &FALLS);
    assert!(setup(&app).tones.len() > 1 && !app.is_driving());
    assert!(app.take_sent().iter().all(|it| !matches!(it, Request::Play(_) | Request::Arm)));
}

#[test]
fn a_drawing_fits_the_smallest_screen_and_its_controls_can_be_touched() {
    for size in [[640.0, 480.0], [800.0, 480.0], [1280.0, 800.0]] {
        let mut app = TestApp::driving();
        app.resize(size.into(), 200);
        with_brush(&mut app);
        let screen = Rect::from_min_size(Pos2::ZERO, size.into());
        for name in ["Brush", "Done"] {
            let rect = app.window.get_by_role_and_label(Role::Button, name).rect();
            assert!(
                screen.contains_rect(rect) && rect.width() >= 24.0 && rect.height() >= 24.0,
                "{size:?}: {name} {rect}"
            );
        }
        stroke(&mut app, &FALLS);
        assert!(setup(&app).tones.len() > 1, "{size:?}");
    }
}
