//! The look of the window, in light and dark, compared with approved images.
//!
//! `SLIPLINE_BLESS=1 cargo test -p slipline-window --test gui` approves the present look.

use crate::background::{open_page, open_plate};
use crate::painter::Painter;
use crate::test_app::TestApp;
use eframe::egui::{Color32, ColorImage, Theme, accesskit::Role};
use egui_kittest::HarnessBuilder;
use egui_kittest::kittest::Queryable as _;
use slipline_model::export::figures::encode;
use slipline_window::app::App;
use slipline_window::settings::ThemeChoice;
use std::path::PathBuf;

/// Largest difference of a channel that still counts as equal: the last bits of a float may be rounded
/// differently.
const DIFFERS: u8 = 24;
/// The largest share of pixels that may differ, per thousand.
const MOST_PER_MILLE: usize = 3;

/// The window at a first start.
fn first_picture(theme: ThemeChoice, size: [u16; 2]) -> ColorImage {
    painted(theme, size, 1.0, TestApp::first_start)
}

/// The window in this theme and of this size in points, after `prepare` has acted on it.
fn picture(theme: ThemeChoice, size: [u16; 2], prepare: impl FnOnce(&mut TestApp)) -> ColorImage {
    painted(theme, size, 1.0, |theme, builder| {
        let mut app = TestApp::driving_setup(crate::test_app::membrane(), theme, builder);
        prepare(&mut app);
        app
    })
}

/// `size` is in points, of which each has `density` pixels.
fn painted(
    theme: ThemeChoice,
    size: [u16; 2],
    density: f32,
    open: impl FnOnce(ThemeChoice, HarnessBuilder<App>) -> TestApp,
) -> ColorImage {
    let painter = Painter::default();
    let egui_theme = if theme == ThemeChoice::Dark { Theme::Dark } else { Theme::Light };
    let builder = HarnessBuilder::default()
        .with_size(size.map(f32::from))
        .with_theme(egui_theme)
        .renderer(painter.clone());
    let mut app = open(theme, builder.with_pixels_per_point(density));
    app.wait(100);
    let pixels = size.map(|points| (f32::from(points) * density) as usize);
    painter.paint(&app.window.ctx, app.window.output(), pixels)
}

fn read(path: &PathBuf) -> ColorImage {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap_or_else(|_| {
        panic!("{} is missing: run with SLIPLINE_BLESS=1 and look at it", path.display())
    }));
    let mut decoder = png::Decoder::new(file);
    // An image without an opacity channel is read as opaque.
    decoder.set_transformations(png::Transformations::ALPHA);
    let mut reader = decoder.read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    let pixels =
        bytes[..info.buffer_size()].chunks_exact(4).map(|p| Color32::from_rgb(p[0], p[1], p[2])).collect();
    ColorImage::new([info.width as usize, info.height as usize], pixels)
}

fn png(seen: &ColorImage) -> Vec<u8> {
    let rgba: Vec<[u8; 4]> = seen.pixels.iter().map(Color32::to_srgba_unmultiplied).collect();
    encode((seen.size[0] as u32, seen.size[1] as u32), &rgba, None).unwrap()
}

fn compare(name: &str, seen: &ColorImage) {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/gui/snapshots");
    let path = folder.join(format!("{name}.png"));
    if std::env::var_os("SLIPLINE_BLESS").is_some() {
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(&path, png(seen)).unwrap();
        return;
    }
    let right = read(&path);
    assert_eq!(right.size, seen.size);
    let is_off = |(a, b): &(&Color32, &Color32)| {
        a.r().abs_diff(b.r()).max(a.g().abs_diff(b.g())).max(a.b().abs_diff(b.b())) > DIFFERS
    };
    let off = right.pixels.iter().zip(&seen.pixels).filter(is_off).count();
    if off * 1000 > seen.pixels.len() * MOST_PER_MILLE {
        let actual = std::env::temp_dir().join(format!("slipline-{name}.png"));
        std::fs::write(&actual, png(seen)).unwrap();
        panic!("{off} of {} pixels differ: look at {}", seen.pixels.len(), actual.display());
    }
}

const USUAL: [u16; 2] = [1280, 800];
/// The smallest window with room for everything at once.
const SMALLEST: [u16; 2] = [960, 620];
/// The smallest screen, where panel and plots take turns.
const SMALL_SCREEN: [u16; 2] = [640, 480];

#[test]
fn the_window_looks_as_it_was_approved_in_light() {
    compare("light", &first_picture(ThemeChoice::Light, USUAL));
}

#[test]
fn the_window_looks_as_it_was_approved_in_dark() {
    compare("dark", &first_picture(ThemeChoice::Dark, USUAL));
}

#[test]
fn the_smallest_window_looks_as_it_was_approved_with_a_long_name() {
    let long_name = |app: &mut TestApp| {
        let text = slipline_plate::preset("membrane").unwrap().to_toml();
        let name = "name = \"a plate whose name is as long as a name may be made by whoever has the time\"";
        open_plate(app, text.replace("name = \"membrane\"", name));
        app.click("Dismiss", 1500);
    };
    compare("smallest", &picture(ThemeChoice::Light, SMALLEST, long_name));
}

#[test]
fn the_scenes_look_as_they_were_approved() {
    let open = |app: &mut TestApp| {
        app.click("File", 200);
        app.click_part("Scenes…", 200);
    };
    compare("scenes", &picture(ThemeChoice::Dark, USUAL, open));
}

#[test]
fn the_lights_look_as_they_were_approved() {
    compare("validity", &picture(ThemeChoice::Dark, USUAL, |app| open_page(app, "Validity")));
}

/// Amber and red on the stage, large and small, and what one of them says.
#[test]
fn the_lights_on_the_stage_look_as_they_were_approved() {
    let pointed_at = |app: &mut TestApp| {
        crate::light_marks::open(app, "al-sh", 0.16);
        let symbol = crate::light_marks::symbol(app, "Edge slope").rect();
        app.hover(symbol.center(), 2500);
    };
    compare("lights-light", &picture(ThemeChoice::Light, USUAL, pointed_at));
    let few = |app: &mut TestApp| crate::light_marks::open(app, "al-sh", 0.16);
    compare("lights-small", &picture(ThemeChoice::Dark, [640, 480], few));
    let dense = |theme, builder| {
        let mut app = TestApp::driving_setup(crate::test_app::membrane(), theme, builder);
        crate::light_marks::open(&mut app, "al-bending-displacement", 0.15);
        app
    };
    compare("lights-dense", &painted(ThemeChoice::Dark, [640, 400], 2.0, dense));
}

/// A drawn profile, a solid area and an unreachable target, large and small.
#[test]
fn the_texture_page_looks_as_it_was_approved() {
    use crate::textures::{choose, open_profile, open_textures};
    let rising = |app: &mut TestApp| {
        open_textures(app);
        open_profile(app, "bump.csv", Ok(b"0,0.3\n0.1,0.3\n0.16,1\n0.22,0.2\n0.32,0\n".to_vec()));
        app.click("Dismiss", 1450);
        // Away from the bar of the page, which grows under the pointer.
        app.hover(eframe::egui::pos2(600.0, 30.0), 50);
    };
    compare("texture-light", &picture(ThemeChoice::Light, USUAL, rising));
    let solid = |app: &mut TestApp| {
        open_textures(app);
        choose(app, "Solid");
        crate::type_into(app, "Felt to", "270 mm");
        app.wait(1500);
    };
    compare("texture-dark", &picture(ThemeChoice::Dark, USUAL, solid));
    compare("texture-small-light", &picture(ThemeChoice::Light, [640, 480], open_textures));
    compare("texture-small-dark", &picture(ThemeChoice::Dark, [640, 480], solid));
}

/// A profile that is partly out of reach, drawn over the envelope, large and small.
#[test]
fn a_drawing_looks_as_it_was_approved() {
    use crate::brush::{stroke, with_brush};
    let drawn = |app: &mut TestApp| {
        with_brush(app);
        stroke(app, &[(0.06, 0.1), (0.3, 0.1), (0.55, 0.3), (0.8, 0.02)]);
        app.wait(600);
        app.hover(eframe::egui::pos2(600.0, 30.0), 50);
    };
    compare("brush-light", &picture(ThemeChoice::Light, USUAL, drawn));
    compare("brush-small", &picture(ThemeChoice::Dark, SMALL_SCREEN, drawn));
}

/// A recorded drag of two tones, at a time that was chosen.
#[test]
fn a_time_line_looks_as_it_was_approved() {
    let chosen = |app: &mut TestApp| {
        crate::add_tone(app);
        app.wait(500);
        app.window.get_by_role_and_label(Role::Button, "Play").click();
        let step = |i: i32| (0.1 * f64::from(i), 0.18 + 0.06 * (0.15 * f64::from(i)).sin());
        let moves: String = (0..=60)
            .map(step)
            .flat_map(|(s, m)| [(s, 1, m), (s, 2, 0.3 - m)])
            .map(|(s, tone, m)| format!("{s},{tone},{m}\n"))
            .collect();
        app.open("drag.csv", Ok(format!("time_s,tone,place_m\n{moves}")));
        app.click("Dismiss", 300);
        let line = app.window.get_by_role_and_label(Role::Slider, "Time of the recording").rect();
        let at = line.left_center() + eframe::egui::vec2(0.35 * line.width(), 0.0);
        app.grab(at, 50);
        app.release(at, 600);
        app.hover(eframe::egui::pos2(600.0, 30.0), 50);
    };
    compare("time-line", &picture(ThemeChoice::Light, SMALLEST, chosen));
}

/// Two measurements, of which the chosen one differs from the plate's model, large and small.
#[test]
fn the_page_of_measurements_looks_as_it_was_approved() {
    use crate::measure::{measured, membrane, open};
    let two = |app: &mut TestApp| {
        open(app, "before.csv", &measured(&membrane(1.0), 0.032, 12.0));
        open(app, "after the holidays.csv", &measured(&membrane(1.04), 0.032, 4.0));
        app.click("Dismiss", 200);
        app.hover(eframe::egui::pos2(300.0, 240.0), 100);
    };
    compare("measure-light", &picture(ThemeChoice::Light, USUAL, two));
    compare("measure-dark", &picture(ThemeChoice::Dark, USUAL, two));
    compare("measure-small", &picture(ThemeChoice::Dark, SMALL_SCREEN, two));
}

#[test]
fn the_calibration_looks_as_it_was_approved() {
    use crate::calibrate::{answers, go_through, open_calibration};
    let result = |app: &mut TestApp| go_through(app, &answers(1.04));
    compare("calibrate-light", &picture(ThemeChoice::Light, USUAL, result));
    let place = |app: &mut TestApp| {
        open_calibration(app);
        app.click("Next", 200);
    };
    compare("calibrate-dark", &picture(ThemeChoice::Dark, USUAL, place));
    compare("calibrate-small", &picture(ThemeChoice::Light, SMALL_SCREEN, result));
}

/// A firm finger that is dragged on an ultrasonic plate in a small window: amplitude, friction and speed.
#[test]
fn the_trace_of_a_finger_looks_as_it_was_approved() {
    let dragged = |app: &mut TestApp| {
        open_plate(app, slipline_plate::preset("al-bending").unwrap().to_toml());
        app.wait(1500);
        crate::finger::choose(app, "Firm");
        crate::finger::drag_by(app, &[-3.0; 20]);
    };
    compare("finger", &picture(ThemeChoice::Dark, SMALLEST, dragged));
}

#[test]
fn the_designer_looks_as_it_was_approved() {
    compare("designer", &picture(ThemeChoice::Light, USUAL, |app| open_page(app, "Designer")));
}

/// The page of a plate in air, in a window that is high enough for all its numbers.
#[test]
fn the_air_of_a_plate_looks_as_it_was_approved() {
    let page = |app: &mut TestApp| {
        open_plate(app, slipline_plate::preset("latex-membrane").unwrap().to_toml());
        app.wait(500);
        app.window.get_by_label("Dismiss").click();
        open_page(app, "This plate");
    };
    compare("air", &picture(ThemeChoice::Light, [960, 1400], page));
}

#[test]
fn what_is_felt_is_faint_while_nothing_is_driven() {
    for theme in [ThemeChoice::Light, ThemeChoice::Dark] {
        let stop = |app: &mut TestApp| {
            app.key(eframe::egui::Key::Space, 300);
        };
        // A place on the strip with a strong feeling, and one beside the plate.
        let contrast = |seen: &ColorImage| -> u32 {
            let at = |x: usize| seen.pixels[511 * seen.size[0] + x];
            let (felt, page) = (at(440), at(940));
            [felt.r().abs_diff(page.r()), felt.g().abs_diff(page.g()), felt.b().abs_diff(page.b())]
                .into_iter()
                .map(u32::from)
                .sum()
        };
        let driven = contrast(&picture(theme, USUAL, |_| ()));
        let stopped = contrast(&picture(theme, USUAL, stop));
        assert!(2 * stopped < driven && 10 * stopped > driven, "{theme:?}: {driven}, {stopped}");
    }
}

#[test]
fn a_small_screen_looks_as_it_was_approved() {
    compare("small-light", &first_picture(ThemeChoice::Light, SMALL_SCREEN));
    compare("small-dark", &first_picture(ThemeChoice::Dark, SMALL_SCREEN));
    let open_plots = |app: &mut TestApp| {
        app.click("Plots", 300);
    };
    compare("small-plots", &picture(ThemeChoice::Light, SMALL_SCREEN, open_plots));
}

/// 1280 x 800 pixels, two to a point.
#[test]
fn a_dense_screen_looks_as_it_was_approved() {
    compare("dense", &painted(ThemeChoice::Dark, [640, 400], 2.0, TestApp::first_start));
}

#[test]
fn the_relief_looks_as_it_was_approved() {
    let show = |app: &mut TestApp| {
        app.click("Relief", 200);
    };
    compare("relief", &picture(ThemeChoice::Dark, SMALLEST, show));
}
