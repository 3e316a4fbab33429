//! The layout of the figure, in points from the left and the top, and the caption under it.

use super::super::axes::Axes;
use super::super::legend::row_height;
use super::super::page::Place;
use super::super::plot::TEXT;
use super::super::{PRINT_WIDTH, font};
use super::Subject;
use crate::field::line::{Line, lines};
use crate::field::steady_field::SteadyField;
use crate::field::tone_places::TonePlaces;
use crate::setup::{BoundaryMode, Setup};
use slipline_plate::Plate;
use slipline_plate::quantity::ticks;
use slipline_plate::quantity::{show_frequency, show_length, show_place};

/// Width left of the axis for its numbers and name, and right of it for half a number.
const MARGIN: (f64, f64) = (50.0, 16.0);
/// Smallest and largest height of the plate.
const PLATE: (f64, f64) = (48.0, 170.0);
/// Number of line segments of one edge of the plate.
const EDGE: i32 = 400;
/// Height of the envelope.
const ENVELOPE: f64 = 150.0;

/// The places of the parts of the figure.
pub(super) struct Layout {
    /// Left and right end of the plate.
    pub(super) left: f64,
    pub(super) right: f64,
    /// Middle of the lines of text over the plate.
    pub(super) title: f64,
    pub(super) colours: f64,
    /// Top and bottom of the area for the plate, and its centre line.
    pub(super) plate: (f64, f64),
    pub(super) centre: f64,
    /// Top and bottom of the envelope.
    pub(super) envelope: (f64, f64),
    /// Middle of the legend.
    pub(super) legend: f64,
    /// The caption, line by line.
    pub(super) caption: Vec<String>,
    /// The boundary line of each tone.
    pub(super) lines: Vec<Line>,
    /// The plate's length in metres.
    pub(super) length_m: f64,
    /// Whether its width is drawn to the scale of its length.
    pub(super) is_to_scale: bool,
    /// Points per metre of width.
    across: f64,
}

impl Layout {
    pub(super) fn new(subject: &Subject) -> Self {
        let plate = &subject.setup.plate;
        let (left, right) = (MARGIN.0, PRINT_WIDTH - MARGIN.1);
        let along = (right - left) / plate.length_m();
        let width_m = 2.0 * plate.half_width_m(0.0);
        let room = (width_m * along + 8.0).clamp(PLATE.0, PLATE.1);
        let is_to_scale = width_m * along <= PLATE.1 - 8.0;
        let across = along.min((room - 8.0) / width_m);
        let (title, colours) = (12.0, 28.0);
        let top = colours + 24.0;
        let high = top + room + 10.0;
        let envelope = (high, high + ENVELOPE);
        let lines = lines(&subject.setup, Some(&subject.predicted));
        let caption = caption(&subject.setup, &subject.predicted, subject.full_peak_m);
        let caption = font::joined(caption.iter().map(String::as_str), "  ", TEXT, right - left);
        Self {
            left,
            right,
            title,
            colours,
            plate: (top, top + room),
            centre: top + 0.5 * room,
            envelope,
            legend: envelope.1 + Axes::bottom_room(TEXT) + 8.0,
            caption,
            lines,
            length_m: plate.length_m(),
            is_to_scale,
            across,
        }
    }

    /// Width and height of the whole.
    pub(super) fn size(&self) -> (f64, f64) {
        (PRINT_WIDTH, self.legend + (self.caption.len() as f64 + 1.0) * row_height(TEXT) + 4.0)
    }

    /// The horizontal position of a place on the plate.
    pub(super) fn x(&self, x_m: f64) -> f64 {
        self.left + x_m / self.length_m * (self.right - self.left)
    }

    /// An edge of the plate from its driven end: the upper one for a side of -1, the lower one for 1.
    pub(super) fn edge(&self, plate: &Plate, side: f64) -> impl DoubleEndedIterator<Item = Place> {
        (0..=EDGE).map(move |i| {
            let x_m = plate.length_m() * f64::from(i) / f64::from(EDGE);
            (self.x(x_m), self.centre + side * self.half_width(plate.half_width_m(x_m)))
        })
    }

    /// A half-width in metres as drawn, in points.
    pub(super) fn half_width(&self, half_width_m: f64) -> f64 {
        half_width_m * self.across
    }
}

/// The numbers of each tone and the values common to all tones, as phrases that are not broken over lines.
fn caption(setup: &Setup, predicted: &SteadyField, full_peak_m: f64) -> Vec<String> {
    let mut phrases: Vec<String> = Vec::new();
    for tone in &setup.tones {
        let hertz = setup.plate.frequency_for_boundary_hz(tone.position_m);
        let places = TonePlaces::of_wave(setup, tone, hertz, predicted.tone(tone.slot));
        phrases.push(format!(
            "Tone {}: {}, turning point at {}, {}, level {:.2}.",
            tone.slot + 1,
            places.edge_words(),
            show_place(tone.position_m),
            show_frequency(hertz),
            tone.level
        ));
    }
    phrases.push(match setup.boundary {
        BoundaryMode::TurningPoint => "Lines: at the turning points.".to_owned(),
        BoundaryMode::FeltEdge => "Lines: where a tone is just felt (illustrative).".to_owned(),
    });
    phrases.push(format!("Master level {} dB.", ticks::label(setup.master_db, 0.1)));
    phrases.push(format!("Level 1 peaks at {}.", show_length(full_peak_m)));
    phrases
}
