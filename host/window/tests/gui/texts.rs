//! Every text is whole and lies over no other, in every supported size and on every page.

use crate::small_screens::{screen, small};
use crate::test_app::TestApp;
use eframe::egui::{Rect, Shape};
use egui_kittest::kittest::Queryable as _;

/// The supported sizes in points, and pixels per point.
const SIZES: [([f32; 2], f32); 5] = [
    ([1280.0, 720.0], 1.0),
    ([800.0, 480.0], 1.0),
    ([640.0, 480.0], 1.0),
    ([390.0, 844.0], 1.0),
    // 1280 x 800 pixels without the bars of the system.
    ([640.0, 360.0], 2.0),
];

const PAGES: [&str; 6] = ["Boundary", "Tones", "Texture", "Plate", "Device", "Play"];

/// A text and where it is: all of it, and the part that its view shows.
struct Painted {
    words: String,
    whole: Rect,
    seen: Rect,
}

fn collect(shape: &Shape, clip: Rect, found: &mut Vec<Painted>) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| collect(shape, clip, found)),
        Shape::Text(text) => {
            let whole = text.galley.rect.translate(text.pos.to_vec2());
            let seen = whole.intersect(clip);
            // A line that is scrolled almost out of sight is not read.
            if !text.galley.text().trim().is_empty() && seen.height() > 4.0 && seen.width() > 1.0 {
                found.push(Painted { words: text.galley.text().to_owned(), whole, seen });
            }
        }
        _ => {}
    }
}

/// What is wrong with the texts of this picture.
fn wrong(app: &TestApp, size: [f32; 2]) -> Vec<String> {
    let mut texts = Vec::new();
    for clipped in &app.window.output().shapes {
        collect(&clipped.shape, clipped.clip_rect, &mut texts);
    }
    let mut wrong = Vec::new();
    for (i, text) in texts.iter().enumerate() {
        let Painted { words, whole, seen } = text;
        if !screen(size).expand(0.5).contains_rect(*seen) {
            wrong.push(format!("\"{words}\" is beyond the screen: {seen}"));
        }
        // Upwards and downwards a page scrolls.
        if whole.width() - seen.width() > 2.0 {
            wrong.push(format!("\"{words}\" is cut at its side: {seen} of {whole}"));
        }
        for other in &texts[i + 1..] {
            // Letters do not fill the height of their line.
            let (one, two) = (seen.shrink2([0.5, 2.5].into()), other.seen.shrink2([0.5, 2.5].into()));
            if one.is_positive() && two.is_positive() && one.intersects(two) {
                wrong.push(format!("\"{words}\" {seen} lies over \"{}\" {}", other.words, other.seen));
            }
        }
    }
    wrong
}

fn every_page_is_whole((size, density): ([f32; 2], f32)) {
    let mut app = small(size);
    app.window.set_pixels_per_point(density);
    app.wait(100);
    let mut found = Vec::new();
    let look = |app: &TestApp, page: &str, found: &mut Vec<String>| {
        found.extend(wrong(app, size).into_iter().map(|what| format!("{size:?} {page}: {what}")));
        for name in ["STOP", "State: "] {
            let rect = app.window.query_by_label_contains(name).map(|node| node.rect());
            if !rect.is_some_and(|rect| screen(size).contains_rect(rect)) {
                found.push(format!("{size:?} {page}: {name} is not on the screen: {rect:?}"));
            }
        }
    };
    for page in PAGES {
        app.click_button(page, 300);
        look(&app, page, &mut found);
    }
    app.click_button("Boundary", 100);
    if app.has("Plots") {
        app.click("Plots", 300);
        look(&app, "Plots", &mut found);
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn every_text_is_whole_and_lies_over_no_other_at_1280_by_720() {
    every_page_is_whole(SIZES[0]);
}

#[test]
fn every_text_is_whole_and_lies_over_no_other_at_800_by_480() {
    every_page_is_whole(SIZES[1]);
}

#[test]
fn every_text_is_whole_and_lies_over_no_other_at_640_by_480() {
    every_page_is_whole(SIZES[2]);
}

#[test]
fn every_text_is_whole_and_lies_over_no_other_on_an_upright_telephone() {
    every_page_is_whole(SIZES[3]);
}

#[test]
fn every_text_is_whole_and_lies_over_no_other_at_two_pixels_a_point() {
    every_page_is_whole(SIZES[4]);
}

#[test]
fn the_page_boundary_is_whole_at_1280_by_720() {
    let app = small(SIZES[0].0);
    // Whether its device has inputs or not: the last row of it, over the status line.
    for name in ["Boundary position", "Level", "Glide", "Feeling, illustrative", "Hold the level"] {
        for node in app.window.query_all_by_label(name) {
            let rect = node.rect();
            assert!(rect.height() > 10.0 && rect.bottom() <= SIZES[0].0[1] - 28.0, "{name}: {rect}");
        }
    }
    assert!(app.has("Feeling, illustrative"));
}
