//! How the window looks, in light and dark, against pictures that were looked at.
//!
//! `SLIPLINE_BLESS=1 cargo test -p slipline --test gui` takes the present look as right.

use crate::bench::Bench;
use crate::painter::Painter;
use eframe::egui::{Color32, ColorImage, Theme};
use egui_kittest::HarnessBuilder;
use slipline::export;
use slipline::settings::ThemeChoice;
use std::path::PathBuf;

const SIZE: [usize; 2] = [1280, 800];
/// A pixel this far off in one channel differs: less is a rounding of the last bits of a float.
const DIFFERS: u8 = 24;
/// So many pixels may differ, of a thousand.
const MOST_PER_MILLE: usize = 3;

fn picture(theme: ThemeChoice) -> ColorImage {
    let painter = Painter::default();
    let egui_theme = if theme == ThemeChoice::Dark { Theme::Dark } else { Theme::Light };
    let builder = HarnessBuilder::default().with_theme(egui_theme).renderer(painter.clone());
    let bench = Bench::driving_with(theme, builder);
    painter.paint(&bench.window.ctx, bench.window.output(), SIZE)
}

fn read(path: &PathBuf) -> ColorImage {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap_or_else(|_| {
        panic!("{} is missing: run with SLIPLINE_BLESS=1 and look at it", path.display())
    }));
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    let pixels =
        bytes[..info.buffer_size()].chunks_exact(4).map(|p| Color32::from_rgb(p[0], p[1], p[2])).collect();
    ColorImage::new([info.width as usize, info.height as usize], pixels)
}

fn compare(name: &str, seen: &ColorImage) {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/gui/snapshots");
    let path = folder.join(format!("{name}.png"));
    if std::env::var_os("SLIPLINE_BLESS").is_some() {
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(&path, export::png(seen).unwrap()).unwrap();
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
        std::fs::write(&actual, export::png(seen).unwrap()).unwrap();
        panic!("{off} of {} pixels differ: look at {}", seen.pixels.len(), actual.display());
    }
}

#[test]
fn the_window_looks_as_it_was_approved_in_light() {
    compare("light", &picture(ThemeChoice::Light));
}

#[test]
fn the_window_looks_as_it_was_approved_in_dark() {
    compare("dark", &picture(ThemeChoice::Dark));
}
