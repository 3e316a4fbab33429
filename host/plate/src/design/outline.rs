//! Outlines of the two parts to cut: the sheet, and the frame whose window has the shape of the taper.
//!
//! The frame surrounds the plate. Its window begins before the driven end, so that the actuator has room and the wide
//! end stays free; it follows the taper and is closed at the narrow end. The frame holds the sheet at the edge of the
//! window, so the sheet is larger than the window. With clamped edges or under tension it extends over the whole rim
//! and has the frame's bolt holes. With supported edges only a narrow lip of it lies between the two frames.

use super::drawing::{Drawing, Shape, wrapped};
use super::mounting::Mounting;
use crate::definition::drive::DriveEnd;
use crate::definition::frame::DRIVE_GAP_M;
use crate::definition::plate::Plate;
use crate::definition::source::{LeadIn, Source};
use crate::quantity::number_format::rounded;
use crate::quantity::show_si;

/// Overhang of a plate with supported edges beyond the window, mm: several times a cutter's kerf, so that the plate
/// cannot fall through, and short enough to rotate freely. At 40 kHz in 2 mm of aluminium (K = 0.28 /mm) the moment
/// of the lip's inertia about the edge is (K lip)^3/3 of the plate's bending moment, under 1 %.
pub(super) const LIP_MM: f64 = 1.0;
/// Largest distance of the cut polyline from the taper, mm.
const SAG_MM: f64 = 0.005;
/// Largest number of points of one edge of the taper.
const EDGE_POINTS_MAX: usize = 2000;
/// Free length of the window before the driven end, mm.
const DRIVE_GAP_MM: f64 = 1e3 * DRIVE_GAP_M;
/// Diameter of the bolt holes, mm (M4 with clearance).
const BOLT_MM: f64 = 4.3;
/// Longest distance between bolt holes along an edge, mm.
const BOLT_PITCH_MM: f64 = 60.0;

/// The lead-in behind the drive, a strip with the width of the driven end.
fn lead_in(plate: &Plate) -> Option<LeadIn> {
    match plate.spec().drive_end {
        DriveEnd::Source(Source { lead_in, .. }) => lead_in,
        _ => None,
    }
}

/// Length of the lead-in, mm; 0 if there is none.
fn lead_in_mm(plate: &Plate) -> f64 {
    lead_in(plate).map_or(0.0, |lead_in| lead_in.length_m * 1e3)
}

/// The upper edge of the taper from x = 0 to the plate's end, mm.
fn edge(plate: &Plate) -> Vec<[f64; 2]> {
    let length_mm = plate.length_m() * 1e3;
    // A chord of length s deviates by s^2 W''/8 from a curve with second derivative W''. Here W'' = d^2 W, which is
    // largest at the wide end.
    let rate = plate.narrowing_per_m(0.0).abs() * 1e-3;
    let bend = (plate.cut_half_width_m(0.0) * 1e3 * rate * rate).max(1e-12);
    let chord = (8.0 * SAG_MM / bend).sqrt();
    let count = ((length_mm / chord).ceil() as usize + 1).clamp(2, EDGE_POINTS_MAX);
    (0..count)
        .map(|i| {
            let x = length_mm * i as f64 / (count - 1) as f64;
            [x, plate.cut_half_width_m(x * 1e-3) * 1e3]
        })
        .collect()
}

/// Outline of the window, mm: from before the sheet's wide end along the taper, around the narrow end and back.
fn window(plate: &Plate) -> Vec<[f64; 2]> {
    let wide = plate.cut_half_width_m(0.0) * 1e3;
    let start = -lead_in_mm(plate) - DRIVE_GAP_MM;
    closed(std::iter::once([start, wide]).chain(edge(plate)).collect())
}

/// Outline of the taper and of the lead-in before it, with a lip on all sides except the wide end, mm.
fn lipped(plate: &Plate) -> Vec<[f64; 2]> {
    let mut upper = edge(plate);
    if lead_in(plate).is_some() {
        upper.insert(0, [-lead_in_mm(plate), plate.cut_half_width_m(0.0) * 1e3]);
    }
    upper.extend(upper.last().map(|&[x, z]| [x + LIP_MM, z]));
    closed(upper.into_iter().map(|[x, z]| [x, z + LIP_MM]).collect())
}

/// Joins an upper edge and its mirror image to one outline.
fn closed(upper: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let lower: Vec<[f64; 2]> = upper.iter().rev().map(|&[x, z]| [x, -z]).collect();
    [upper, lower].concat()
}

/// Bolt holes in the rim along both long sides and the narrow end, mm; the sheet's wide end is at `start_mm`.
fn bolts(start_mm: f64, wide_mm: f64, length_mm: f64, rim_mm: f64) -> impl Iterator<Item = Shape> {
    let line = wide_mm + 0.5 * rim_mm;
    // The first two holes lie half a rim's width inside the sheet's edge at its wide end.
    let (first, last) = (start_mm + 0.5 * rim_mm, length_mm + 0.5 * rim_mm);
    let along = ((last - first) / BOLT_PITCH_MM).ceil().max(1.0) as usize;
    let across = (2.0 * line / BOLT_PITCH_MM).ceil().max(1.0) as usize;
    let sides = (0..=along).flat_map(move |i| {
        let x = first + (last - first) * i as f64 / along as f64;
        [[x, line], [x, -line]]
    });
    let end = (1..across).map(move |i| [last, line - 2.0 * line * i as f64 / across as f64]);
    sides.chain(end).map(|centre| Shape::Hole { centre, diameter: BOLT_MM })
}

/// Drawing of the sheet.
pub(super) fn plate(plate: &Plate, rim_m: f64, mounting: Mounting) -> Drawing {
    let (length, rim) = (plate.length_m() * 1e3, rim_m * 1e3);
    let wide = plate.cut_half_width_m(0.0) * 1e3;
    let narrow = plate.cut_half_width_m(plate.length_m()) * 1e3;
    let mut shapes = Vec::new();
    let margin = if mounting == Mounting::Lip { LIP_MM } else { rim };
    let (half, end, start) = (wide + margin, length + margin, -lead_in_mm(plate));
    if mounting == Mounting::Lip {
        shapes.push(Shape::Outline { points: lipped(plate) });
        shapes.push(vertical(end + 12.0, narrow + margin));
    } else {
        shapes
            .push(Shape::Outline { points: vec![[start, half], [end, half], [end, -half], [start, -half]] });
        shapes.extend(bolts(start, wide, length, rim));
    }
    shapes.push(horizontal(start, end, -half - 12.0));
    shapes.push(vertical(start - 8.0, half));
    shapes.extend(lead_in_marks(plate, half));
    shapes.extend(notes(plate, mounting, start, -half - 24.0));
    Drawing { title: format!("{}: plate, to lie between two frames", plate.name()), shapes }
}

/// Drawing of the frame.
pub(super) fn frame(plate: &Plate, rim_m: f64, mounting: Mounting) -> Drawing {
    let (length, rim) = (plate.length_m() * 1e3, rim_m * 1e3);
    let wide = plate.cut_half_width_m(0.0) * 1e3;
    let narrow = plate.cut_half_width_m(plate.length_m()) * 1e3;
    let start = -lead_in_mm(plate);
    let (left, right, half) = (start - DRIVE_GAP_MM - rim, length + rim, wide + rim);
    let mut shapes = vec![
        Shape::Outline { points: vec![[left, half], [right, half], [right, -half], [left, -half]] },
        Shape::Outline { points: window(plate) },
    ];
    shapes.extend(bolts(start, wide, length, rim));
    shapes.push(horizontal(left, right, -half - 24.0));
    shapes.push(horizontal(0.0, length, -half - 12.0));
    shapes.push(vertical(left - 8.0, half));
    shapes.push(vertical(left - 20.0, wide));
    shapes.push(vertical(right + 12.0, narrow));
    shapes.extend(lead_in_marks(plate, half));
    shapes.extend(notes(plate, mounting, left, -half - 36.0));
    Drawing { title: format!("{}: frame, to be cut twice", plate.name()), shapes }
}

/// The line on which the drive acts, and the length of the lead-in before it.
fn lead_in_marks(plate: &Plate, half: f64) -> Vec<Shape> {
    if lead_in(plate).is_none() {
        return Vec::new();
    }
    let drive = Shape::Dimension { from: [0.0, -half], to: [0.0, half], text: "drive".to_owned() };
    vec![drive, horizontal(-lead_in_mm(plate), 0.0, half + 12.0)]
}

/// Assembly instructions, as lines of text from (`x`, `z`) down.
fn notes(plate: &Plate, mounting: Mounting, x: f64, z: f64) -> impl Iterator<Item = Shape> {
    const LINE_MM: f64 = 6.0;
    let lead_in = lead_in(plate).map_or_else(String::new, |lead_in| {
        format!(
            " Drive the plate on the marked line. Cover the {} mm before it with a damping layer until that strip has \
             a loss factor of {}, and put a damper of {} on its end, spread over the width.",
            rounded(lead_in.length_m * 1e3, 4),
            lead_in.loss_factor,
            show_si(lead_in.end_resistance_n_s_per_m, "N s/m")
        )
    });
    let sentences = format!(
        "{}{lead_in} The lines are finished edges: let the cutter allow for its kerf.",
        mounting.sentence()
    );
    let lines = wrapped(&sentences).into_iter().enumerate();
    lines.map(move |(row, text)| Shape::Note { at: [x, z - LINE_MM * row as f64], text })
}

/// A dimension along x.
fn horizontal(from: f64, to: f64, z: f64) -> Shape {
    Shape::Dimension { from: [from, z], to: [to, z], text: millimetres(to - from) }
}

/// A dimension along z, symmetric about the centre line.
fn vertical(x: f64, half: f64) -> Shape {
    Shape::Dimension { from: [x, -half], to: [x, half], text: millimetres(2.0 * half) }
}

fn millimetres(length: f64) -> String {
    format!("{length:.2} mm")
}
