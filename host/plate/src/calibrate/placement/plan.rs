//! The proposed pair of places, and what a sensor at another place would miss.

use super::check::CheckPlace;
use super::information::{Information, Reached};
use super::near_limit::NearLimit;
use super::warning::PlaceWarning;
use crate::calibrate::error::CalibrateError;
use crate::calibrate::fit::acceptance::{CLAMPED_OPEN_MAX, LEVEL_MAX_DB};
use crate::calibrate::fit::pairs::MODEL_ERROR;
use crate::calibrate::fit::parameter::INTERVAL;
use crate::calibrate::fit::response::sensor_body::SensorMasses;
use crate::calibrate::fit::unknowns::{DISTANT_AIR, Priors, has_distant_air};
use crate::calibrate::measurement::band::band_hz;
use crate::calibrate::measurement::sensor::{POINTS, SensorKind};
use crate::calibrate::measurement::signal;
use crate::definition::{Air, Plate, PlateSpec, limits};
use crate::quantity::number_format::significant;
use crate::quantity::{OutOfRange, Range, WrongCount, show_place};

/// Side of the square of the sensor whose mass is stated beside a plan, metres: that of a chip.
const CHIP_M: f64 = 4e-3;
/// Noise of an answer over the root mean square of the signals over the plate and the band: 40 dB below it.
const NOISE: f64 = 0.01;
/// Half of the widest accepted interval of the level, dB.
const LEVEL_ACCEPTED_DB: f64 = INTERVAL * LEVEL_MAX_DB;
/// A plate whose level stays open by more behind the drive of its file alone, dB, is refused behind nearly all others: so is
/// `al-bending-displacement` (1.6 dB; plates that are accepted have 0.3 to 0.7).
const RESONATES_DB: f64 = 1.2;
/// Places that are tried from the nearest on, and then between the best and its neighbours.
const TRIED: usize = 14;
const BETWEEN: usize = 5;
/// Places over which the usual signal is taken.
const USUAL: usize = 24;
/// An answer of fewer times its noise shows nothing, and a sensor with a larger share of such answers cannot see. The farther
/// of a good pair sees the upper half of the band alone.
const SEEN: f64 = 3.0;
const SILENT_MAX: f64 = 0.75;
/// Share of the last boundary beyond which the first place is not moved.
const FIRST_MAX: f64 = 0.75;
/// Error of the nodes that counts as much as one of the boundary, over that one, and the weight of the level in the choice of a
/// pair: with less regard to the nodes the calibrated wave before the boundary is more than a hundredth of its height off, with
/// more the level is known less well (`tests/calibration`).
const OF_NODES: f64 = 1.5;
const OF_LEVEL: f64 = 1.5;
/// The boundary's interval of a plate whose edges are not clamped, over the one that is left if how far they give is known, behind
/// the worst of the actuators: behind the drive of its file it then loses less than a fifth. No plate is refused for more.
const OPEN_MAX: f64 = 1.3;
/// Places are proposed to a whole millimetre, of a small plate to a three-hundredth of its length.
const STEP_M: f64 = 1e-3;
const STEPS_OF_LENGTH: f64 = 300.0;

/// What is known of a measurement before the sensor is put on the plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placing {
    /// What the sensor measures.
    pub sensor: SensorKind,
    /// Number of measured frequencies (8 to 10 000).
    pub points: usize,
    /// Whether the drive acts beside the centre line: it excites the second width mode, too.
    pub off_centre: bool,
    /// How well the plate's numbers are known.
    pub priors: Priors,
}

impl Default for Placing {
    /// A displacement sensor at 60 frequencies, the drive on the centre line.
    fn default() -> Self {
        Self { sensor: SensorKind::Displacement, points: 60, off_centre: false, priors: Priors::default() }
    }
}

/// What the ratio of two places would reach on the nominal plate, where the answers' noise is 40 dB below the root mean
/// square of the signals over plate and band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairReach {
    /// Both places, metres from the driven end; the nearer one first.
    pub places_m: [f64; 2],
    /// Half of the 95 % interval of the boundary, metres: the largest over the span.
    pub boundary_tolerance_m: f64,
    /// Half of the 95 % interval of the level of the peak over its mean, dB: the largest over the span. The larger of those behind the
    /// drive of the plate file and behind an actuator of a quality of 5 that resonates in the band or below it.
    pub level_tolerance_db: f64,
    /// Half of the 95 % interval of the standing wave's nodes next to the driven end, metres: the largest over the span. A pair
    /// next to the boundary knows the boundary and not the wave before it.
    pub node_tolerance_m: f64,
    /// The level's interval behind the drive of the plate file alone, dB: pairs are compared by it.
    stated_db: f64,
    /// How much wider the boundary's interval is because nobody knows how far the edges give, behind the worst of the actuators.
    by_edges: f64,
    /// The most of it of a pair that shows how far they give.
    by_edges_max: f64,
}

/// Places of the two sensors of a calibration, proposed from the nominal plate.
///
/// ```
/// use slipline_plate::calibrate::{Placing, SensorPlaces};
///
/// let plate = slipline_plate::preset("membrane").unwrap();
/// let places = SensorPlaces::of(&plate, &Placing::default()).unwrap();
/// let best = places.best;
/// assert!(best.places_m[0] >= places.nearest_m && best.places_m[1] > best.places_m[0]);
/// // A tenth of the length is within reach of the third width mode.
/// let reach = places.reach([0.032, 0.176]).unwrap();
/// assert!(places.warning(0.032).unwrap().is_some() && places.warning(best.places_m[1]).unwrap().is_none());
/// assert!(best.level_tolerance_db < reach.level_tolerance_db);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SensorPlaces {
    plate: Plate,
    placing: Placing,
    /// Standard deviations of what is known of the plate's coordinates.
    deviations: Vec<f64>,
    frequencies_hz: Vec<f64>,
    /// The places whose pairs were compared first, metres.
    grid_m: Vec<f64>,
    /// One standard deviation of an answer, in the sensor's unit.
    noise: f64,
    /// The nearest place where the wave that is calibrated is nearly alone, metres.
    pub nearest_m: f64,
    /// What sets it.
    pub limit: NearLimit,
    /// The pair with the least product of the interval of places (the boundary's, or two thirds of the nodes' where that is larger)
    /// and the level's to the power of 1.5: of those that show how far the edges give, if there is any.
    pub best: PairReach,
    /// Pairs over the plate, with what each would reach: in rising places.
    pub pairs: Vec<PairReach>,
}

impl SensorPlaces {
    /// Proposes the places. Takes some hundredths of a second.
    ///
    /// # Errors
    /// [`CalibrateError`]: a number of `placing` that is out of its range, a strain sensor on a plate without bending, or a
    /// plate on which no pair serves.
    pub fn of(plate: &Plate, placing: &Placing) -> Result<Self, CalibrateError> {
        placing.priors.check()?;
        WrongCount::check("points", placing.points, POINTS)?;
        signal::check_kind(plate, placing.sensor)?;
        let (low_hz, high_hz) = band_hz(plate);
        let last = (placing.points - 1) as f64;
        let frequencies_hz: Vec<f64> =
            (0..placing.points).map(|i| low_hz * (high_hz / low_hz).powf(i as f64 / last)).collect();
        let (nearest_m, limit) = NearLimit::of(plate, (low_hz, high_hz), placing.off_centre);
        let step_m = STEP_M.min(plate.length_m() / STEPS_OF_LENGTH);
        let farthest_m = plate.span_m().1;
        // Where other waves go as far as the boundaries, the last quarter is the best available.
        let first_m = ((nearest_m / step_m).ceil() * step_m).min(FIRST_MAX * farthest_m);
        let over = |from_m: f64, to_m: f64, count: usize| -> Vec<f64> {
            let at = |i: usize| from_m + (to_m - from_m) * i as f64 / (count - 1) as f64;
            (0..count).map(|i| ((at(i) / step_m).round() * step_m).min(farthest_m)).collect()
        };
        // Without the air's pressure at a distance: a plan for a share that is neither that of a baffle nor that of a bare frame
        // serves neither.
        let mut deviations = placing.priors.deviations_of(plate.spec());
        if has_distant_air(plate.spec()) {
            deviations.remove(DISTANT_AIR);
        }
        let air = plate.spec().air.map(Air::near_alone);
        let near = if air.is_none() {
            plate.clone()
        } else {
            Plate::new(PlateSpec { air, ..plate.spec().clone() })?
        };
        let information = |places_m: &[f64]| {
            Information::new(&near, placing.sensor, deviations.clone(), places_m, &frequencies_hz)
        };
        let noise = NOISE * information(&over(0.0, farthest_m, USUAL))?.usual();
        // Pairs of the first `near` of these places with those from `far` on.
        let pairs_of = |all: &[f64], near: usize, far: usize| -> Result<Vec<PairReach>, CalibrateError> {
            let known = information(all)?;
            let mut pairs = Vec::new();
            for (a, &near_m) in all[..near].iter().enumerate() {
                for (b, &far_m) in (far..).zip(&all[far..]).filter(|(_, far_m)| **far_m > near_m + step_m) {
                    let reached = known.reached([a, b], noise);
                    pairs.extend(reached.map(|reached| PairReach::new(plate, [near_m, far_m], reached)));
                }
            }
            Ok(pairs)
        };
        let grid = over(first_m, farthest_m, TRIED);
        let pairs = pairs_of(&grid, grid.len(), 0)?;
        let coarse = best_of(&pairs).ok_or(CalibrateError::NoFit)?;
        let apart_m = grid[1] - grid[0];
        let about = |at_m: f64| -> Vec<f64> {
            let (from_m, to_m) = ((at_m - apart_m).max(first_m), (at_m + apart_m).min(farthest_m));
            over(from_m, to_m, BETWEEN)
        };
        let about = coarse.places_m.map(about);
        let finer = pairs_of(&about.concat(), about[0].len(), about[0].len())?;
        let all = [&pairs[..], &finer].concat();
        let best = best_of(&all).unwrap_or(coarse);
        let (placing, grid_m) = (*placing, grid);
        let plate = near;
        Ok(Self { plate, placing, deviations, frequencies_hz, grid_m, noise, nearest_m, limit, best, pairs })
    }

    /// The best of the pairs with the same first place, in the order of that place.
    pub fn best_of_each_first(&self) -> impl Iterator<Item = PairReach> {
        let pairs = self.pairs.chunk_by(|a, b| a.places_m[0] == b.places_m[0]);
        pairs.filter_map(best_of)
    }

    /// What a pair of other places would reach; `None` if its information is singular.
    pub fn reach(&self, places_m: [f64; 2]) -> Option<PairReach> {
        let information = self.information(&places_m).ok()?;
        information.reached([0, 1], self.noise).map(|reached| PairReach::new(&self.plate, places_m, reached))
    }

    /// Where a third place checks the best two; `None` where no place is apart from both.
    #[must_use]
    pub fn check(&self) -> Option<CheckPlace> {
        let best = (self.best.places_m, self.best.boundary_tolerance_m);
        CheckPlace::of(best, &self.grid_m, self.noise, |places_m| self.information(places_m).ok())
    }

    /// A sentence where a calibration at the proposed places may be refused, with the data that calibrate such a plate; `None` where it is
    /// accepted with noise 40 dB below the signals.
    #[must_use]
    pub fn caution(&self) -> Option<String> {
        if self.plate.spec().model.is_clamped() && !self.best.sees_edges() {
            return Some(format!(
                "two places may be refused: no two show how far the clamped edges give, which widens the boundary's interval to {} times; state edge_give_m and edge_give_tolerance_m in the plate file",
                significant(self.best.by_edges, 2)
            ));
        }
        if self.best.is_accepted() {
            return None;
        }
        let verdict = if self.best.stated_db > RESONATES_DB {
            "two places do not calibrate this plate"
        } else {
            "two places may be refused"
        };
        Some(format!(
            "{verdict}: it resonates, and behind an actuator that resonates, too, the level stays open to {} dB, where at most {} dB are accepted. Give its end a resistance, which less noise does not replace, or calibrate by felt edges (--touch), which state boundaries without levels",
            significant(self.best.level_tolerance_db, 2),
            significant(LEVEL_ACCEPTED_DB, 2)
        ))
    }

    /// The largest masses of a sensor on a square of side `width_m` (0.0005 to 0.1) at a place, behind the drive of the
    /// plate file.
    ///
    /// # Errors
    /// [`CalibrateError`]: a place beyond the plate, a width out of its range, or a plate file that does not state the
    /// membrane's tension or the sheet's thickness.
    pub fn masses(&self, place_m: f64, width_m: f64) -> Result<SensorMasses, CalibrateError> {
        OutOfRange::check("place_m", place_m, Range::new(0.0, self.plate.length_m(), "m"))?;
        OutOfRange::check("sensor_width_m", width_m, limits::CONTACT)?;
        SensorMasses::at(&self.plate, place_m, width_m, &self.frequencies_hz, MODEL_ERROR)
    }

    /// The largest masses that both proposed places bear, on a square of 4 mm; `None` where the plate file does not
    /// state what they need.
    #[must_use]
    pub fn both_bear(&self) -> Option<SensorMasses> {
        let [near, far] = self.best.places_m.map(|place_m| self.masses(place_m, CHIP_M).ok());
        let (near, far) = near.zip(far)?;
        Some(SensorMasses {
            stated_kg: near.stated_kg.min(far.stated_kg),
            unstated_kg: near.unstated_kg.min(far.unstated_kg),
        })
    }

    /// The same as a sentence for a person.
    #[must_use]
    pub fn mass_note(&self) -> Option<String> {
        let SensorMasses { stated_kg, unstated_kg } = self.both_bear()?;
        Some(format!(
            "A sensor that stands on the plate may weigh at most {} mg with its mass stated, and {} mg without (on a square of {}).",
            significant(1e6 * stated_kg, 2),
            significant(1e6 * unstated_kg, 2),
            show_place(CHIP_M)
        ))
    }

    /// Why a sensor at a place would not serve; `None` if it would.
    ///
    /// # Errors
    /// [`CalibrateError`]: a place beyond the plate.
    pub fn warning(&self, place_m: f64) -> Result<Option<PlaceWarning>, CalibrateError> {
        OutOfRange::check("place_m", place_m, Range::new(0.0, self.plate.length_m(), "m"))?;
        let Self { nearest_m, limit, .. } = *self;
        if place_m < nearest_m {
            return Ok(Some(PlaceWarning::TooNear { place_m, limit, nearest_m }));
        }
        let share = self.information(&[place_m])?.silent_share(0, SEEN * self.noise);
        Ok((share > SILENT_MAX).then_some(PlaceWarning::Silent { place_m, share }))
    }

    fn information(&self, places_m: &[f64]) -> Result<Information, CalibrateError> {
        let deviations = self.deviations.clone();
        Information::new(&self.plate, self.placing.sensor, deviations, places_m, &self.frequencies_hz)
    }
}

impl PairReach {
    fn new(plate: &Plate, places_m: [f64; 2], reached: Reached) -> Self {
        let Reached { boundary_m, level_db, resonant_db, nodes_m, by_edges } = reached;
        Self {
            places_m,
            boundary_tolerance_m: boundary_m,
            level_tolerance_db: resonant_db,
            node_tolerance_m: nodes_m,
            stated_db: level_db,
            by_edges,
            by_edges_max: if plate.spec().model.is_clamped() { CLAMPED_OPEN_MAX } else { OPEN_MAX },
        }
    }

    /// Whether the two places show how far the edges give.
    fn sees_edges(&self) -> bool {
        self.by_edges <= self.by_edges_max
    }

    /// Whether a calibration there is accepted behind an actuator that resonates, too.
    fn is_accepted(&self) -> bool {
        self.level_tolerance_db <= LEVEL_ACCEPTED_DB
    }
}

/// The pair with the least product of the interval of places, that of the boundary or of the nodes, and of the level to the power
/// of [`OF_LEVEL`]: of those that show how far the edges give, and of these of those that are accepted behind an actuator that
/// resonates, or of all where there is none.
fn best_of(pairs: &[PairReach]) -> Option<PairReach> {
    let product = |it: &PairReach| {
        it.boundary_tolerance_m.max(it.node_tolerance_m / OF_NODES) * it.stated_db.powf(OF_LEVEL)
    };
    let order = |it: &PairReach| (it.sees_edges(), it.is_accepted());
    pairs.iter().copied().min_by(|a, b| order(b).cmp(&order(a)).then(product(a).total_cmp(&product(b))))
}
