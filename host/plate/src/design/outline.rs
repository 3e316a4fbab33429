//! The parts that are cut: the sheet and the frame whose window is the taper.
//!
//! The frame reaches around the plate: its window begins before the driven end, so that the actuator finds room and
//! the wide end stays free, follows the taper and is closed at the narrow end. Where the edges are clamped or the
//! sheet is stretched, the sheet reaches under the rim and shares the frame's bolt holes; where the edges may turn,
//! the sheet is cut to the taper itself and rests in the window's edge.

use super::drawing::{Drawing, Shape};
use crate::plate::Plate;

/// Largest departure of the cut polyline from the taper, mm.
const SAG_MM: f64 = 0.005;
/// Most points of one edge of the taper.
const EDGE_POINTS_MAX: usize = 2000;
/// Free length of the window before the driven end, mm.
const DRIVE_GAP_MM: f64 = 15.0;
/// Diameter of the bolt holes, mm (M4 with clearance).
const BOLT_MM: f64 = 4.3;
/// Longest distance between bolt holes along an edge, mm.
const BOLT_PITCH_MM: f64 = 60.0;

/// The upper edge of the taper from x = 0 to the plate's end, mm.
fn edge(plate: &Plate) -> Vec<[f64; 2]> {
    let length_mm = plate.length_m() * 1e3;
    // A chord of length s leaves an arc of curvature W'' by s^2 W''/8; the edge bends most at its wide end.
    let rate = plate.narrowing_per_m(0.0).abs() * 1e-3;
    let bend = (plate.half_width_m(0.0) * 1e3 * rate * rate).max(1e-12);
    let chord = (8.0 * SAG_MM / bend).sqrt();
    let count = ((length_mm / chord).ceil() as usize + 1).clamp(2, EDGE_POINTS_MAX);
    (0..count)
        .map(|i| {
            let x = length_mm * i as f64 / (count - 1) as f64;
            [x, plate.half_width_m(x * 1e-3) * 1e3]
        })
        .collect()
}

/// The taper's outline from (x_from, +W0) around the narrow end and back, mm.
fn taper_outline(plate: &Plate, start_mm: f64) -> Vec<[f64; 2]> {
    let upper = edge(plate);
    let lower = upper.iter().rev().map(|&[x, z]| [x, -z]);
    let mut points = Vec::with_capacity(2 * upper.len() + 2);
    let wide = upper[0][1];
    if start_mm < 0.0 {
        points.push([start_mm, wide]);
    }
    points.extend(upper.iter().copied());
    points.extend(lower);
    if start_mm < 0.0 {
        points.push([start_mm, -wide]);
    }
    points
}

/// Bolt holes along both long sides and the narrow end of a rim, mm.
fn bolts(wide_mm: f64, length_mm: f64, rim_mm: f64) -> impl Iterator<Item = Shape> {
    let line = wide_mm + 0.5 * rim_mm;
    // The first pair stands at the driven end's corner of the sheet, half a rim behind its edge.
    let (first, last) = (0.5 * rim_mm, length_mm + 0.5 * rim_mm);
    let along = ((last - first) / BOLT_PITCH_MM).ceil().max(1.0) as usize;
    let across = (2.0 * line / BOLT_PITCH_MM).ceil().max(1.0) as usize;
    let sides = (0..=along).flat_map(move |i| {
        let x = first + (last - first) * i as f64 / along as f64;
        [[x, line], [x, -line]]
    });
    let end = (1..across).map(move |i| [last, line - 2.0 * line * i as f64 / across as f64]);
    sides.chain(end).map(|centre| Shape::Hole { centre, diameter: BOLT_MM })
}

/// The sheet.
pub(super) fn plate(plate: &Plate, rim_m: f64, edges_free_to_turn: bool) -> Drawing {
    let (length, rim) = (plate.length_m() * 1e3, rim_m * 1e3);
    let wide = plate.half_width_m(0.0) * 1e3;
    let narrow = plate.half_width_m(plate.length_m()) * 1e3;
    let mut shapes = Vec::new();
    let (title, half, end) = if edges_free_to_turn {
        shapes.push(Shape::Outline { points: taper_outline(plate, 0.0) });
        ("plate, cut to the taper", wide, length)
    } else {
        let (half, end) = (wide + rim, length + rim);
        shapes.push(Shape::Outline { points: vec![[0.0, half], [end, half], [end, -half], [0.0, -half]] });
        shapes.extend(bolts(wide, length, rim));
        ("plate, to be held between two frames", half, end)
    };
    shapes.push(horizontal(0.0, end, -half - 12.0));
    shapes.push(vertical(-8.0, half));
    if edges_free_to_turn {
        shapes.push(vertical(length + 12.0, narrow));
    }
    Drawing { title: format!("{}: {title}", plate.name()), shapes }
}

/// The frame.
pub(super) fn frame(plate: &Plate, rim_m: f64) -> Drawing {
    let (length, rim) = (plate.length_m() * 1e3, rim_m * 1e3);
    let wide = plate.half_width_m(0.0) * 1e3;
    let narrow = plate.half_width_m(plate.length_m()) * 1e3;
    let (left, right, half) = (-DRIVE_GAP_MM - rim, length + rim, wide + rim);
    let mut shapes = vec![
        Shape::Outline { points: vec![[left, half], [right, half], [right, -half], [left, -half]] },
        Shape::Outline { points: taper_outline(plate, -DRIVE_GAP_MM) },
    ];
    shapes.extend(bolts(wide, length, rim));
    shapes.push(horizontal(left, right, -half - 24.0));
    shapes.push(horizontal(0.0, length, -half - 12.0));
    shapes.push(vertical(left - 8.0, half));
    shapes.push(vertical(left - 20.0, wide));
    shapes.push(vertical(right + 12.0, narrow));
    Drawing { title: format!("{}: frame", plate.name()), shapes }
}

fn horizontal(from: f64, to: f64, z: f64) -> Shape {
    Shape::Dimension { from: [from, z], to: [to, z], text: millimetres(to - from) }
}

/// A dimension across the centre line.
fn vertical(x: f64, half: f64) -> Shape {
    Shape::Dimension { from: [x, -half], to: [x, half], text: millimetres(2.0 * half) }
}

fn millimetres(length: f64) -> String {
    format!("{length:.2} mm")
}
