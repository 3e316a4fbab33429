//! The README's moving picture: the line is dragged to and fro over the first start's plate.
//!
//! `SLIPLINE_BLESS=1 cargo test -p slipline-window --test gui moving_picture -- --ignored` makes it again; it needs no
//! display.

use crate::line_rect;
use crate::painter::Painter;
use crate::test_app::TestApp;
use eframe::egui::{Color32, ColorImage, Pos2, Rect, Theme, pos2, vec2};
use egui_kittest::HarnessBuilder;
use gif::{ColorOutput, DecodeOptions, Encoder, Frame, Repeat};
use slipline_window::settings::ThemeChoice;
use std::borrow::Cow;
use std::f32::consts::TAU;
use std::path::PathBuf;

/// The window, in points.
const WINDOW: [f32; 2] = [1280.0, 800.0];
/// What of it is shown: the stage.
const SHOWN: Rect = Rect { min: pos2(8.0, 64.0), max: pos2(952.0, 568.0) };
/// The picture's width in pixels.
const WIDTH: u16 = 800;
/// From one picture to the next, in hundredths of a second, and in frames of the window.
const DELAY_CS: u16 = 8;
const FRAMES: u16 = 5;
/// Pictures of a whole drag, which ends where and as fast as it begins.
const PICTURES: u16 = 50;
/// How far the line goes to either side, in points.
const REACH: f32 = 170.0;
/// A change of a channel that is not seen: such a pixel is not written again.
const UNSEEN: u8 = 3;
const MOST_BYTES: usize = 1_500_000;

fn path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../assets/drag.gif")
}

/// The pictures `wanted` of the drag; all of them are played.
fn drag(wanted: impl Fn(u16) -> bool) -> Vec<(u16, ColorImage)> {
    let painter = Painter::default();
    let density = f32::from(WIDTH) / SHOWN.width();
    let builder = HarnessBuilder::default()
        .with_size(WINDOW)
        .with_theme(Theme::Dark)
        .renderer(painter.clone())
        .with_pixels_per_point(density);
    let mut app =
        TestApp::driving_setup(slipline_window::app::first_setup().unwrap(), ThemeChoice::Dark, builder);
    app.wait(100);
    let line = line_rect(&app).center();
    let size = WINDOW.map(|points| (points * density).ceil() as usize);
    let mut pictures = Vec::new();
    app.grab(line, 0);
    for number in 0..PICTURES {
        let mut pointer = line;
        for frame in 1..=FRAMES {
            let share = f32::from(number * FRAMES + frame) / f32::from(PICTURES * FRAMES);
            pointer = line - vec2(REACH * (TAU * share).sin(), 0.0);
            app.window.hover_at(pointer);
            app.pass(u64::from(10 * DELAY_CS / FRAMES));
            app.window.step();
        }
        if wanted(number) {
            let whole = painter.paint_within(&app.window.ctx, app.window.output(), size, SHOWN);
            let mut shown = whole.region(&SHOWN, Some(density));
            draw_pointer(&mut shown, ((pointer - SHOWN.min) * density).to_pos2());
            pictures.push((number, shown));
        }
    }
    app.release(line, 50);
    pictures
}

/// An arrow whose tip is at a place of the picture, as a system draws it.
fn draw_pointer(picture: &mut ColorImage, tip: Pos2) {
    const ARROW: [&str; 17] = [
        "#                ",
        "##               ",
        "#.#              ",
        "#..#             ",
        "#...#            ",
        "#....#           ",
        "#.....#          ",
        "#......#         ",
        "#.......#        ",
        "#........#       ",
        "#.....#####      ",
        "#..#..#          ",
        "#.# #..#         ",
        "##  #..#         ",
        "#    #..#        ",
        "     #..#        ",
        "      ##         ",
    ];
    let [width, height] = picture.size;
    for (y, row) in ARROW.iter().enumerate() {
        for (x, dot) in row.bytes().enumerate() {
            let colour = match dot {
                b'#' => Color32::BLACK,
                b'.' => Color32::WHITE,
                _ => continue,
            };
            let (x, y) = (tip.x as usize + x, tip.y as usize + y);
            if x < width && y < height {
                picture[(x, y)] = colour;
            }
        }
    }
}

fn differs(a: Color32, b: Color32, by: u8) -> bool {
    a.r().abs_diff(b.r()).max(a.g().abs_diff(b.g())).max(a.b().abs_diff(b.b())) > by
}

/// The pictures as a GIF that loops: of each what has changed, the rest transparent.
fn encoded(pictures: &[(u16, ColorImage)]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let [width, height] = pictures[0].1.size;
    let mut encoder = Encoder::new(&mut bytes, width as u16, height as u16, &[]).unwrap();
    encoder.set_repeat(Repeat::Infinite).unwrap();
    let mut seen: Option<ColorImage> = None;
    for (_, picture) in pictures {
        let is_new =
            |at: usize| seen.as_ref().is_none_or(|it| differs(it.pixels[at], picture.pixels[at], UNSEEN));
        let rows: Vec<usize> = (0..height).filter(|y| (0..width).any(|x| is_new(y * width + x))).collect();
        let columns: Vec<usize> = (0..width).filter(|x| (0..height).any(|y| is_new(y * width + x))).collect();
        let (Some((&top, &bottom)), Some((&left, &right))) =
            (rows.first().zip(rows.last()), columns.first().zip(columns.last()))
        else {
            continue;
        };
        let mut rgba = Vec::new();
        let mut now = picture.clone();
        for y in top..=bottom {
            for x in left..=right {
                let at = y * width + x;
                let [r, g, b, _] = picture.pixels[at].to_array();
                if is_new(at) {
                    rgba.extend([r, g, b, 255]);
                } else {
                    rgba.extend([0; 4]);
                    if let Some(seen) = &seen {
                        now.pixels[at] = seen.pixels[at];
                    }
                }
            }
        }
        let size = ((right - left + 1) as u16, (bottom - top + 1) as u16);
        let mut frame = Frame::from_rgba_speed(size.0, size.1, &mut rgba, 1);
        (frame.left, frame.top, frame.delay) = (left as u16, top as u16, DELAY_CS);
        encoder.write_frame(&frame).unwrap();
        seen = Some(now);
    }
    drop(encoder);
    bytes
}

/// The pictures of a GIF, each as it is seen, and the time in which they are seen, in hundredths of a second.
fn decoded(bytes: &[u8]) -> (Vec<ColorImage>, Vec<u16>, Repeat) {
    let mut options = DecodeOptions::new();
    options.set_color_output(ColorOutput::RGBA);
    let mut decoder = options.read_info(bytes).unwrap();
    let size = [usize::from(decoder.width()), usize::from(decoder.height())];
    let mut seen = ColorImage::filled(size, Color32::BLACK);
    let (mut pictures, mut delays) = (Vec::new(), Vec::new());
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        let buffer: &Cow<'_, [u8]> = &frame.buffer;
        for (number, rgba) in buffer.chunks_exact(4).enumerate() {
            if rgba[3] == 255 {
                let row = usize::from(frame.width);
                let at = (usize::from(frame.left) + number % row, usize::from(frame.top) + number / row);
                seen[at] = Color32::from_rgb(rgba[0], rgba[1], rgba[2]);
            }
        }
        pictures.push(seen.clone());
        delays.push(frame.delay);
    }
    (pictures, delays, decoder.repeat())
}

#[test]
fn the_moving_picture_is_light_to_load_and_to_look_at() {
    let bytes = std::fs::read(path()).expect("the README's moving picture");
    assert!(bytes.len() < MOST_BYTES, "{} bytes", bytes.len());
    let (pictures, delays, repeat) = decoded(&bytes);
    assert_eq!(pictures[0].size[0], usize::from(WIDTH));
    assert!(matches!(repeat, Repeat::Infinite));
    assert!(delays.iter().all(|delay| (5..=8).contains(delay)), "12 to 20 pictures a second: {delays:?}");
    let lasts_cs: u16 = delays.iter().sum();
    assert!((300..=600).contains(&lasts_cs), "{lasts_cs}");
}

#[test]
#[ignore = "a drag of 250 frames: .ci/run long_tests"]
fn the_moving_picture_shows_the_window_as_it_is() {
    if std::env::var_os("SLIPLINE_BLESS").is_some() {
        std::fs::write(path(), encoded(&drag(|_| true))).unwrap();
    }
    let (stands, ..) = decoded(&std::fs::read(path()).expect("the README's moving picture"));
    for (number, seen) in drag(|number| [0, 13, 37].contains(&number)) {
        let right = &stands[usize::from(number)];
        assert_eq!(right.size, seen.size);
        // A picture has 256 colours.
        let off = right.pixels.iter().zip(&seen.pixels).filter(|(a, b)| differs(**a, **b, 40)).count();
        assert!(off * 1000 < 5 * seen.pixels.len(), "picture {number}: {off} pixels differ");
    }
}
