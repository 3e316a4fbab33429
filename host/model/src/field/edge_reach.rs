//! From a felt edge to the tone that has it, and the felt edges that tones of one level can have on a plate.
//!
//! ```text
//! felt edge --line--> turning point, checked --> Ok
//!                     not found: all turning points of the span, scanned --> Ok, or NoFeltEdge with the reach
//! ```
//! Nothing is played in the place of a felt edge that no tone has: the caller refuses. The window alone falls back to
//! the nearest line ([`crate::field::line::turning_point_m`]).

use crate::field::felt::NotFelt;
use crate::field::line::{Holds, Line, turning_point_m};
use crate::setup::{BoundaryMode, Setup, ToneSetup};
use slipline_plate::DriveTable;
use slipline_plate::order;
use slipline_plate::quantity::number_format::typed;
use slipline_plate::quantity::{Measure, must_be, show_range};
use std::fmt;

/// Largest error of a felt edge that counts as found, in metres.
const FOUND_M: f64 = 5e-6;
/// Number of turning points that are tried over the span.
const SCANNED: usize = 65;
/// Halvings of the interval between two of them: from some millimetres to below a nanometre.
const HALVINGS: usize = 24;
/// The unit to which the ends of the reach are rounded inwards, in metres, so that a typed end is within it.
const SHOWN_M: f64 = 1e-4;

/// No tone of this level has its felt edge at the place.
#[derive(Clone, Debug, PartialEq)]
pub struct NoFeltEdge {
    /// Name of the plate.
    pub plate: String,
    /// The level of the tone.
    pub level: f64,
    /// The felt edges that tones of this level have, as intervals in metres in rising order; empty if no tone has
    /// one.
    pub reach_m: Vec<(f64, f64)>,
    /// Why no tone is felt, if none is.
    pub not_felt: Option<NotFelt>,
}

impl NoFeltEdge {
    /// The refusal of what was `given`: what is allowed, or why nothing is.
    #[must_use]
    pub fn sentence(&self, given: impl fmt::Display) -> String {
        let (level, plate) = (typed(self.level), &self.plate);
        match (&self.reach_m[..], self.not_felt) {
            ([], Some(why)) => {
                format!("{given}: no tone of level {level} is felt on the plate {plate:?}: {}", why.reason())
            }
            ([], None) => {
                format!(
                    "{given}: every tone of level {level} that is felt on the plate {plate:?} is felt to its end"
                )
            }
            (reach_m, _) => {
                let intervals =
                    reach_m.iter().map(|&(low_m, high_m)| show_range(low_m, high_m, Measure::Length));
                let intervals = intervals.collect::<Vec<_>>().join(" or ");
                let allowed = format_args!(
                    "{intervals}, the felt edges of tones of level {level} on the plate {plate:?}"
                );
                must_be(given, allowed)
            }
        }
    }
}

/// One turning point of the scan, with its felt edge.
#[derive(Clone, Copy, Debug)]
struct Point {
    turning_point_m: f64,
    edge_m: f64,
}

/// The turning point of the tone of this level whose felt edge, alone and for the feeling of the setup, is at
/// `place_m`, in metres; `table` is that of the setup's plate.
///
/// # Errors
/// [`NoFeltEdge`]: no tone of the span has its felt edge there.
pub fn turning_point_of(
    setup: &Setup,
    level: f64,
    table: &DriveTable,
    place_m: f64,
) -> Result<f64, NoFeltEdge> {
    let (start_m, end_m) = setup.plate.span_m();
    let setup = &Setup { boundary: BoundaryMode::FeltEdge, ..setup.without_chord() };
    let tone = ToneSetup { slot: 0, position_m: 0.5 * (start_m + end_m), level, phase_turns: 0.0 };
    let line = |position_m| Line::of(setup, &ToneSetup { position_m, ..tone }, Some(table));
    let is_there = |position_m| {
        let line = line(position_m);
        line.holds == Holds::FeltEdge && (line.place_m - place_m).abs() < FOUND_M
    };
    if place_m.is_finite() {
        let found_m = turning_point_m(setup, &tone, Some(table), place_m);
        if is_there(found_m) {
            return Ok(found_m);
        }
    }
    let (runs, not_felt) = scan(line, (start_m, end_m));
    let found_m = runs.iter().find_map(|run| within(run, place_m, line)).filter(|&found_m| is_there(found_m));
    found_m.ok_or_else(|| NoFeltEdge {
        plate: setup.plate.name().to_owned(),
        level,
        reach_m: reach_m(&runs),
        not_felt: not_felt.filter(|_| runs.is_empty()),
    })
}

/// Where a felt edge is, and why the highest tone that is not felt is not. Each run has the points of one stretch of the
/// span, its ends found to below a nanometre.
fn scan(line: impl Fn(f64) -> Line, (start_m, end_m): (f64, f64)) -> (Vec<Vec<Point>>, Option<NotFelt>) {
    let edge = |turning_point_m: f64| match line(turning_point_m) {
        Line { holds: Holds::FeltEdge, place_m, .. } => Ok(Point { turning_point_m, edge_m: place_m }),
        Line { holds, .. } => Err(holds),
    };
    // The last point with an edge between one that has it and a place without.
    let last = |mut felt: Point, mut without_m: f64| {
        for _ in 0..HALVINGS {
            let middle_m = 0.5 * (felt.turning_point_m + without_m);
            match edge(middle_m) {
                Ok(point) => felt = point,
                Err(_) => without_m = middle_m,
            }
        }
        felt
    };
    let mut runs: Vec<Vec<Point>> = Vec::new();
    let mut not_felt = None;
    let mut before: Option<(f64, Option<Point>)> = None;
    for i in 0..SCANNED {
        let at_m = start_m + (end_m - start_m) * i as f64 / (SCANNED - 1) as f64;
        let point = edge(at_m);
        if let Err(Holds::Unfelt(why)) = point {
            not_felt = Some(why);
        }
        let point = point.ok();
        match (before, point) {
            (Some((_, Some(_))), Some(point)) => runs.last_mut().into_iter().for_each(|run| run.push(point)),
            (Some((before_m, None)), Some(point)) => runs.push(vec![last(point, before_m), point]),
            (None, Some(point)) => runs.push(vec![point]),
            (Some((_, Some(felt))), None) => {
                runs.last_mut().into_iter().for_each(|run| run.push(last(felt, at_m)));
            }
            (Some((_, None)) | None, None) => {}
        }
        before = Some((at_m, point));
    }
    (runs, not_felt)
}

/// The turning point within a run whose felt edge is at `place_m`.
fn within(run: &[Point], place_m: f64, line: impl Fn(f64) -> Line) -> Option<f64> {
    let is_between = |a: Point, b: Point| (a.edge_m - place_m) * (b.edge_m - place_m) <= 0.0;
    let pair = run.windows(2).find(|pair| is_between(pair[0], pair[1]))?;
    let (mut low, mut high_m) = (pair[0], pair[1].turning_point_m);
    for _ in 0..HALVINGS {
        let turning_point_m = 0.5 * (low.turning_point_m + high_m);
        let middle = Point { turning_point_m, edge_m: line(turning_point_m).place_m };
        if is_between(low, middle) { high_m = turning_point_m } else { low = middle }
    }
    Some(high_m)
}

/// The felt edges of all runs, in rising order, each interval rounded inwards.
fn reach_m(runs: &[Vec<Point>]) -> Vec<(f64, f64)> {
    let of_run = |run: &Vec<Point>| {
        let edges = || run.iter().map(|point| point.edge_m);
        (edges().fold(f64::INFINITY, f64::min), edges().fold(f64::NEG_INFINITY, f64::max))
    };
    let mut all: Vec<(f64, f64)> = runs.iter().map(of_run).collect();
    order::sort_by(&mut all, |a, b| a.0.total_cmp(&b.0));
    let mut joined: Vec<(f64, f64)> = Vec::new();
    for (low_m, high_m) in all {
        match joined.last_mut() {
            Some(before) if low_m <= before.1 => before.1 = before.1.max(high_m),
            _ => joined.push((low_m, high_m)),
        }
    }
    let inwards = |(low_m, high_m): (f64, f64)| {
        let rounded = ((low_m / SHOWN_M).ceil() * SHOWN_M, (high_m / SHOWN_M).floor() * SHOWN_M);
        if rounded.0 < rounded.1 { rounded } else { (low_m, high_m) }
    };
    joined.into_iter().map(inwards).collect()
}

#[cfg(test)]
mod tests;
