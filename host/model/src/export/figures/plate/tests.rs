use super::layout::Layout;
use super::*;
use crate::export::figures::tests::{decoded, look_over};
use crate::field::steady_field::{SteadyTone, steady_tones};
use slipline_plate::DriveTable;
use std::sync::Arc;

fn subject(preset: &str) -> Subject {
    let setup = Setup::new(Arc::new(slipline_plate::preset(preset).unwrap()));
    let table = DriveTable::build(&setup.plate, 400e3, 17).unwrap();
    let predicted = SteadyField::solve(&setup.plate, &steady_tones(&setup, Some(&table)));
    Subject {
        sounding: Some(predicted.clone()),
        setup,
        predicted,
        sheet: None,
        measured: None,
        full_peak_m: table.peak_at_full_scale_m(),
        magnification: 1.0,
        is_largest: false,
        wave_time_s: 0.0,
    }
}

fn png(subject: &Subject) -> Vec<u8> {
    plate_figure(subject).unwrap().file(Format::Png).unwrap()
}

/// The figure's width, height and pixels, and its stated dots per metre.
fn drawn(subject: &Subject) -> (u32, u32, Vec<[u8; 3]>, u32) {
    let (width, height, pixels, dots) = decoded(&png(subject));
    (width, height, pixels, dots.unwrap())
}

/// Points on the paper as pixels.
fn px(points: f64) -> u32 {
    (points / 72.0 * PRINT_DOTS_PER_INCH).round() as u32
}

#[test]
fn the_boundary_goes_through_plate_and_envelope_at_print_size() {
    let mut subject = subject("membrane");
    subject.setup.boundary = BoundaryMode::TurningPoint;
    for place_m in [0.12, 0.21] {
        subject.setup.tones[0].position_m = place_m;
        let layout = Layout::new(&subject);
        let (width, height, pixels, dots) = drawn(&subject);
        assert!((f64::from(width) / f64::from(dots) - 0.170).abs() < 2e-4 && dots == 11811);
        let is_dark = |x: u32, y: u32| pixels[(y * width + x) as usize].iter().all(|&channel| channel < 110);
        let dark = |x: u32, (from, to): (f64, f64)| (px(from)..px(to)).filter(|&y| is_dark(x, y)).count();
        let rows = |(from, to): (f64, f64)| (px(to) - px(from)) as usize;
        let x = px(layout.x(place_m));
        for part in [layout.plate, layout.envelope] {
            assert!(dark(x, part) * 10 > rows(part) * 9, "{place_m}");
            assert!(dark(x + 40, part) * 4 < rows(part), "{place_m}: beside the line");
        }
        assert!(layout.size().1 < f64::from(height) / f64::from(dots) * 72.0 / 0.0254 + 1.0);
    }
}

#[test]
fn the_plate_is_coloured_where_it_moves_and_the_envelope_has_its_line() {
    let driven = subject("al-bending");
    let rest = Subject { sounding: None, ..driven.clone() };
    let count = |subject: &Subject, (from, to): (f64, f64), is_it: fn(&[u8; 3]) -> bool| {
        let (width, _, pixels, _) = drawn(subject);
        let layout = Layout::new(subject);
        (px(from)..px(to))
            .flat_map(|y| (px(layout.left)..px(layout.right)).map(move |x| (y * width + x) as usize))
            .filter(|&i| is_it(&pixels[i]))
            .count()
    };
    let layout = Layout::new(&driven);
    let orange: fn(&[u8; 3]) -> bool = |p| p[0] > p[2].saturating_add(60);
    assert!(count(&driven, layout.plate, orange) > 1000);
    assert_eq!(count(&rest, layout.plate, orange), 0);
    let blue: fn(&[u8; 3]) -> bool = |p| p[0] < 60 && (85..150).contains(&p[1]) && p[2] > 140;
    assert!(count(&driven, layout.envelope, blue) > 1000);
}

#[test]
fn sixteen_tones_and_every_preset_can_be_drawn() {
    for preset in slipline_plate::presets() {
        let subject = subject(preset.name);
        look_over(&plate_figure(&subject).unwrap());
        assert!(png(&subject).len() > 10_000, "{}", preset.name);
    }
    let mut subject = subject("membrane");
    let first = subject.setup.tones[0];
    for slot in 1..16 {
        let position_m = 0.08 + 0.012 * f64::from(slot);
        subject.setup.tones.push(crate::setup::ToneSetup { slot, position_m, level: 0.05, ..first });
    }
    subject.setup.boundary = BoundaryMode::FeltEdge;
    let table = DriveTable::build(&subject.setup.plate, 400e3, 17).unwrap();
    let tones: Vec<SteadyTone> = steady_tones(&subject.setup, Some(&table));
    subject.predicted = SteadyField::solve(&subject.setup.plate, &tones);
    let layout = Layout::new(&subject);
    let caption = layout.caption.join(" ");
    assert!(layout.caption.len() > 4 && caption.contains("16: felt"), "{:?}", layout.caption);
    assert!(caption.contains("where a tone is just felt (illustrative)"), "{caption}");
    look_over(&plate_figure(&subject).unwrap());
    png(&subject);
}
