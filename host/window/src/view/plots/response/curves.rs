//! The content of the plots of responses: the shown measurements, the chosen one, the plate's model, and the ranges of the
//! axes.

use crate::scene::Scene;
use crate::view::plots::steer::Ends;
use eframe::egui::{Color32, Ui};
use slipline_model::response::{Bode, Entry, levels_db, unwrapped_deg};
use slipline_plate::Complex64;
use slipline_plate::calibrate::Comparison;

/// Levels lower than this below the highest are not drawn, dB.
const DEEPEST_DB: f64 = 100.0;
/// A range of levels or degrees begins and ends at multiples of these.
const LEVEL_STEP_DB: f64 = 5.0;
const PHASE_STEP_DEG: f64 = 90.0;
/// Largest extent of the Nyquist plot over the largest measured magnitude, for a model that exceeds the measurement.
const REACH_MAX: f64 = 4.0;
/// Possible half-ranges of the residual's axis, dB.
const RESIDUALS_DB: [f64; 5] = [1.0, 3.0, 6.0, 12.0, 24.0];
/// Frequencies from here on are written in kilohertz.
const KILOHERTZ_FROM: f64 = 5000.0;

/// The prediction of the plate's file for the chosen measurement, where it is known by now.
pub(super) struct Model<'a> {
    pub(super) comparison: &'a Comparison,
    pub(super) level_db: Vec<Option<f64>>,
    /// Unwrapped, and moved by whole turns to the measured phase.
    pub(super) phase_deg: Vec<Option<f64>>,
}

/// The curves and the axes over which they are drawn.
pub(super) struct Curves<'a> {
    pub(super) shown: Vec<&'a Entry>,
    /// The one that is chosen, if it is shown.
    pub(super) chosen: Option<&'a Entry>,
    pub(super) model: Option<Model<'a>>,
    is_linear: bool,
    /// Lowest and highest frequency, Hz.
    pub(super) hertz: Ends,
    pub(super) level_db: Ends,
    pub(super) phase_deg: Ends,
    /// Half-range of the residual's axis, around 0.
    pub(super) residual_db: f64,
    /// The largest magnitude.
    pub(super) largest: f64,
    /// The model's largest magnitude over that one, limited to 1 to [`REACH_MAX`].
    pub(super) reach: f64,
}

/// The least and the largest of some values; `None` if there are none.
fn ends(values: impl Iterator<Item = f64>) -> Option<Ends> {
    values.fold(None, |ends: Option<Ends>, value| {
        Some(ends.map_or((value, value), |(low, high)| (low.min(value), high.max(value))))
    })
}

/// A range that begins and ends at multiples of `step`, with some room.
fn rounded((low, high): Ends, step: f64) -> Ends {
    let room = 0.04 * (high - low);
    let (low, high) = (((low - room) / step).floor() * step, ((high + room) / step).ceil() * step);
    if high > low { (low, high) } else { (low - step, high + step) }
}

impl<'a> Curves<'a> {
    /// The shown curves; `None` without any.
    pub(super) fn of(scene: &Scene<'a>, is_linear: bool) -> Option<Self> {
        let shelf = scene.measure.shelf;
        let shown: Vec<&Entry> = shelf.entries().iter().filter(|entry| entry.is_shown).collect();
        let chosen = shelf.chosen().filter(|entry| entry.is_shown);
        let model = chosen.zip(scene.measure.comparison()).map(|(entry, comparison)| Model {
            comparison,
            level_db: levels_db(&comparison.predicted),
            phase_deg: beside(&entry.bode, unwrapped_deg(&comparison.predicted)),
        });
        let bodes = || shown.iter().map(|entry| &*entry.bode);
        let hertz = ends(bodes().flat_map(|bode| bode.frequency_hz.iter().copied()))?;
        let modelled = model.iter().flat_map(|model| model.level_db.iter().flatten().copied());
        let (low, high) = ends(bodes().flat_map(|bode| bode.level_db.iter().copied()).chain(modelled))?;
        let phases = bodes().flat_map(|bode| bode.phase_deg.iter().flatten().copied());
        let modelled = model.iter().flat_map(|model| model.phase_deg.iter().flatten().copied());
        let phase_deg = ends(phases.chain(modelled)).unwrap_or((-180.0, 180.0));
        let off = model.iter().flat_map(|model| model.comparison.off_db.iter().flatten());
        let largest_off = off.map(|off| off.abs()).fold(0.0, f64::max);
        let within = |most: &f64| largest_off <= *most;
        let deepest = RESIDUALS_DB[RESIDUALS_DB.len() - 1];
        let magnitudes = shown.iter().flat_map(|entry| entry.measurement.points.iter());
        let largest = magnitudes.map(|point| point.response.norm()).fold(f64::MIN_POSITIVE, f64::max);
        let predicted = model.iter().flat_map(|model| model.comparison.predicted.iter().flatten());
        let reach = predicted.map(|answer| answer.norm() / largest).fold(1.0, f64::max).min(REACH_MAX);
        Some(Self {
            hertz,
            level_db: rounded((low.max(high - DEEPEST_DB), high), LEVEL_STEP_DB),
            phase_deg: rounded(phase_deg, PHASE_STEP_DEG),
            residual_db: RESIDUALS_DB.into_iter().find(within).unwrap_or(deepest),
            largest,
            reach,
            is_linear,
            shown,
            chosen,
            model,
        })
    }

    /// Unit of the frequency axis, and the factor to it from hertz.
    pub(super) fn unit(&self) -> (&'static str, f64) {
        if self.hertz.1 >= KILOHERTZ_FROM { ("kHz", 1e-3) } else { ("Hz", 1.0) }
    }

    /// The factor of a logarithmic axis; `None` for a linear one.
    pub(super) fn logarithmic(&self) -> Option<f64> {
        (!self.is_linear).then_some(self.unit().1)
    }

    /// Where a frequency is on the axis.
    pub(super) fn place(&self, hertz: f64) -> f64 {
        if self.is_linear { hertz * self.unit().1 } else { hertz.log10() }
    }

    /// The frequency at a place of the axis.
    pub(super) fn hertz_at(&self, place: f64) -> f64 {
        if self.is_linear { place / self.unit().1 } else { 10f64.powf(place) }
    }

    /// The curve of values over the frequencies of a measurement, in pieces where values are absent.
    pub(super) fn pieces(
        &self,
        bode: &Bode,
        values: impl Iterator<Item = Option<f64>>,
    ) -> Vec<Vec<[f64; 2]>> {
        let mut pieces = vec![Vec::new()];
        for (&hertz, value) in bode.frequency_hz.iter().zip(values) {
            match (value, pieces.last_mut()) {
                (Some(value), Some(piece)) => piece.push([self.place(hertz), value]),
                _ => pieces.push(Vec::new()),
            }
        }
        pieces.retain(|piece| !piece.is_empty());
        pieces
    }

    /// The point of the chosen measurement nearest to a place on the axis.
    pub(super) fn nearest(&self, place: f64) -> Option<usize> {
        let bode = &self.chosen?.bode;
        let off = |hertz: f64| (self.place(hertz) - place).abs();
        (0..bode.frequency_hz.len())
            .min_by(|&a, &b| off(bode.frequency_hz[a]).total_cmp(&off(bode.frequency_hz[b])))
    }

    /// The response of the model at a point, over the largest magnitude.
    pub(super) fn of_largest(&self, response: Complex64) -> [f64; 2] {
        [response.re / self.largest, response.im / self.largest]
    }

    pub(super) fn ink(&self, ui: &Ui, entry: &Entry) -> Color32 {
        super::inks::ink(entry.number, crate::view::theme::palette(ui))
    }

    /// Width of the line of a measurement, in points.
    pub(super) fn width(&self, entry: &Entry) -> f32 {
        if self.chosen.is_some_and(|chosen| chosen.number == entry.number) { 2.0 } else { 1.0 }
    }
}

/// Phases moved by whole turns, so that they lie beside the measured ones.
fn beside(bode: &Bode, phases_deg: Vec<Option<f64>>) -> Vec<Option<f64>> {
    let mut turns: Vec<f64> = bode
        .phase_deg
        .iter()
        .zip(&phases_deg)
        .filter_map(|(measured, model)| Some((((*measured)? - (*model)?) / 360.0).round()))
        .collect();
    turns.sort_by(f64::total_cmp);
    let usual = turns.get(turns.len() / 2).copied().unwrap_or(0.0);
    phases_deg.into_iter().map(|phase| phase.map(|phase| phase + 360.0 * usual)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_has_room_and_round_ends() {
        assert_eq!(rounded((-41.0, -3.0), 5.0), (-45.0, 0.0));
        assert_eq!(rounded((-20.0, -20.0), 5.0), (-25.0, -15.0));
        assert_eq!(ends(std::iter::empty()), None);
        assert_eq!(ends([3.0, -1.0, 2.0].into_iter()), Some((-1.0, 3.0)));
    }

    #[test]
    fn the_models_phase_is_moved_by_whole_turns_to_the_measured_one() {
        let bode = Bode {
            frequency_hz: vec![1.0, 2.0, 3.0],
            level_db: vec![0.0; 3],
            noise_db: vec![-40.0; 3],
            spread_db: vec![0.1; 3],
            phase_deg: vec![Some(700.0), None, Some(730.0)],
        };
        let moved = beside(&bode, vec![Some(-10.0), Some(0.0), Some(20.0)]);
        assert_eq!(moved, [Some(710.0), Some(720.0), Some(740.0)]);
    }
}
