//! Why no calibration was made.

use crate::definition::{Faces, PlateError};
use crate::quantity::number_format::significant;
use crate::quantity::{OutOfRange, WrongCount, show_frequency, show_length, show_place};
use crate::table::TableError;
use thiserror::Error;

/// Why no calibration was made. What a measurement does not carry is refused: a plate file from it would look as good as
/// any other.
#[derive(Debug, Clone, PartialEq, Error, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum CalibrateError {
    /// A number of a measurement or of what was known beforehand is outside its range.
    #[error("{0}")]
    OutOfRange(#[from] OutOfRange),
    /// A measurement has too few points or too many.
    #[error(transparent)]
    WrongCount(#[from] WrongCount),
    /// The fitted plate is refused.
    #[error("the fitted plate: {0}")]
    Plate(#[from] PlateError),
    /// The fitted plate does not answer.
    #[error("the fitted plate: {0}")]
    Table(#[from] TableError),
    /// A sensor's place is not on the plate.
    #[error("the sensor at {} is beyond the plate's end at {}", show_place(*.place_m), show_place(*.length_m))]
    BeyondPlate {
        /// The sensor's place, metres.
        place_m: f64,
        /// The plate's length, metres.
        length_m: f64,
    },
    /// A strain sensor on a membrane.
    #[error(
        "a membrane or a shear wave strains its surface only with the square of its slope: measure displacement, velocity or acceleration"
    )]
    NoStrain,
    /// An input was at its full scale.
    #[error("the sensor at {} is clipped at {count} of {of} frequencies: lower the level or the input's gain", show_place(*.place_m))]
    Clipped {
        /// The sensor's place, metres.
        place_m: f64,
        /// Clipped answers.
        count: usize,
        /// All answers.
        of: usize,
    },
    /// No answer stands out of the noise.
    #[error("the sensor at {} shows nothing but noise: is it plugged in, does the plate move, and is it before the boundary?", show_place(*.place_m))]
    NoSignal {
        /// The sensor's place, metres.
        place_m: f64,
    },
    /// The two measurements are not of one sensor.
    #[error(
        "a ratio needs the same sensor at both places: the two measurements have different kinds, scales or masses"
    )]
    DifferentSensors,
    /// A sensor too heavy for the plate.
    #[error("the sensor of {} mg at {} is too heavy for this plate: at most {} mg leave a fifth of its motion there. Use a lighter one, or one that does not touch the plate", significant(1e6 * *.mass_kg, 2), show_place(*.place_m), significant(1e6 * *.most_kg, 2))]
    HeavySensor {
        /// The sensor's place, metres.
        place_m: f64,
        /// Its stated mass, kg.
        mass_kg: f64,
        /// The largest mass that is accepted there, kg.
        most_kg: f64,
    },
    /// A sensor whose mass is another one than stated.
    #[error("the sensor seems to weigh {} mg, and {} mg are stated: weigh it again, with the part of its cable that moves", significant(1e6 * *.found_kg, 2), significant(1e6 * *.mass_kg, 2))]
    AnotherMass {
        /// Its stated mass, kg.
        mass_kg: f64,
        /// The mass that fits, kg.
        found_kg: f64,
    },
    /// The two places are one.
    #[error("both measurements are of the place {}: move the sensor between them", show_place(*.place_m))]
    SamePlace {
        /// The place of the first, metres.
        place_m: f64,
    },
    /// Too few frequencies at which a wave enters the plate, or that both of two measurements have.
    #[error(
        "{count} measured frequencies are of use, those at which a wave enters the plate and which every measurement has: at least {least} are needed"
    )]
    FewFrequencies {
        /// How many they have.
        count: usize,
        /// How many are needed.
        least: usize,
    },
    /// No wave fits at all.
    #[error(
        "no wave of such a plate fits what the sensors show: is anything on the plate, are the places right, and is it the right plate file?"
    )]
    NoFit,
    /// The plate fits in air, and only there, and the file states none.
    #[error("what the sensors show does not fit this plate, but it fits the plate in air, which moves its peaks by up to {} and is not in the plate file: add a section [air] with mounting = \"unknown\", or with how the plate stands", show_length(*.shift_m))]
    NoAir {
        /// How far the air that fits moves the peaks of the span, the most, metres.
        shift_m: f64,
    },
    /// The air carries more than a frame in the open has, as above a table that the file does not state.
    #[error("the air adds {} times the mass that it has about this mounting: if a table is near below, state its distance as gap_m in [air], or leave 50 mm free", significant(*.share, 2))]
    MoreAir {
        /// The air's mass over that of the mounting.
        share: f64,
    },
    /// The plate fits in other air than the file's much better.
    #[error("what the sensors show does not fit this plate in the air of its file (chi^2 is {} per answer), but much better {}", significant(*.chi2_per_n, 2), fitting_air(*.faces))]
    OtherAir {
        /// Sum of the squared residuals over their number, in the air of the file.
        chi2_per_n: f64,
        /// The faces in air with which it fits; `None` where it fits with a coefficient between a bare frame and a baffle.
        faces: Option<Faces>,
    },
    /// The fit is better with the two places exchanged.
    #[error("the two measurements seem to be exchanged: they fit the sensor at {} and {} the other way round", show_place(*.first_m), show_place(*.second_m))]
    Swapped {
        /// Place that the first measurement names, metres.
        first_m: f64,
        /// Place that the second one names, metres.
        second_m: f64,
    },
    /// What the sensors show is no wave of such a plate.
    #[error("what the sensors show does not fit this plate (chi^2 is {} per answer, at most {} is accepted): is a finger or anything else on the plate, is a sensor at another place, an input overloaded, or the file that of another plate?", significant(*.chi2_per_n, 2), significant(*.most, 2))]
    Unlike {
        /// Sum of the squared residuals over their number.
        chi2_per_n: f64,
        /// The most that is accepted.
        most: f64,
    },
    /// The same of one sensor within reach of other waves than the one that is calibrated.
    #[error("what the sensor at {} shows does not fit this plate (chi^2 is {} per answer, at most {} is accepted). So near to the driven end it sees other waves, too: put it at {} or beyond, and see that nothing touches the plate", show_place(*.place_m), significant(*.chi2_per_n, 2), significant(*.most, 2), show_place(*.nearest_m))]
    UnlikeNearEnd {
        /// The sensor's place, metres.
        place_m: f64,
        /// The nearest place where one wave is nearly alone, metres.
        nearest_m: f64,
        /// Sum of the squared residuals over their number.
        chi2_per_n: f64,
        /// The most that is accepted.
        most: f64,
    },
    /// What a finger felt is no wave of such a plate.
    #[error("the felt edges do not fit this plate (chi^2 is {} per edge, at most {} is accepted): are two marks exchanged, is the level another one, or does the drive's level swing more than that of other drives, which needs a sensor?", significant(*.chi2_per_n, 2), significant(*.most, 2))]
    EdgesUnlike {
        /// Sum of the squared residuals over their number.
        chi2_per_n: f64,
        /// The most that is accepted.
        most: f64,
    },
    /// The fit is good, but the plate would be another one.
    #[error("the {what} would be {} times that of the plate file: is it the right file, and are the places right?", significant(*.share, 3))]
    AnotherPlate {
        /// Which of the plate's numbers.
        #[serde(with = "crate::static_text")]
        what: crate::StaticText,
        /// The fitted value over the file's.
        share: f64,
    },
    /// The fit is good, but the edges would give more than those of any plate that is held.
    #[error("the edges give by about {} beyond the plate file: hold them more firmly, or state it in the file as edge_give_m, if it is the right file", show_length(*.by_m))]
    EdgesGive {
        /// How far they give beyond the file's `edge_give_m`, metres.
        by_m: f64,
    },
    /// The two places hardly show how far clamped edges give, and their effect saturates: no interval about the best value holds it.
    #[error("the two places leave open how far the clamped edges give ({} to {}), and with it the turning points by {}: put the sensors where the plan proposes them, or state edge_give_tolerance_m in the plate file", show_length(*.low_m), show_length(*.high_m), show_length(*.boundary_m))]
    EdgesUnseen {
        /// Ends of the 95 % interval of how far they give, metres.
        low_m: f64,
        /// The upper end.
        high_m: f64,
        /// Half of the 95 % interval of the boundary, metres.
        boundary_m: f64,
    },
    /// A third place shows another plate than the two that were calibrated.
    #[error("the sensor at {} shows another plate than the two places: with the one at {} the turning points are {} off, where both intervals explain {}{}", show_place(*.place_m), show_place(*.with_m), show_length(*.off_m), show_length(*.known_m), edges_or_places(*.give_m))]
    CheckDiffers {
        /// The third place, metres.
        place_m: f64,
        /// The other place of the pair that shows it, metres.
        with_m: f64,
        /// How far the boundaries of both results are apart, the most over the span, metres.
        off_m: f64,
        /// What their 95 % intervals explain of it, metres.
        known_m: f64,
        /// How far the edges give by that pair, metres; `None` where it does not show that they give.
        give_m: Option<f64>,
    },
    /// The fit is good, but the finger would feel like no other.
    #[error("the felt edges need a threshold of {} times the stated one, and {} to {} times are plausible: were they felt at this level, and is each beside the tone that had it?", significant(*.share, 2), significant(1.0 / *.most, 2), significant(*.most, 2))]
    ImplausibleFeeling {
        /// The fitted threshold over the stated one.
        share: f64,
        /// The largest plausible share; its inverse is the smallest.
        most: f64,
    },
    /// The fit is good, but a sensor would be at another place.
    #[error("the sensor at {} seems to be at {}: measure its place again", show_place(*.place_m), show_place(*.found_m))]
    Misplaced {
        /// The stated place, metres.
        place_m: f64,
        /// The place that fits, metres.
        found_m: f64,
    },
    /// The span of the fitted plate needs frequencies that were not measured.
    #[error("measured from {} to {}, but the boundary's span needs {} to {}", show_frequency(measured_hz.0), show_frequency(measured_hz.1), show_frequency(needed_hz.0), show_frequency(needed_hz.1))]
    NotCovered {
        /// Lowest and highest frequency that both sensors measured, Hz.
        measured_hz: (f64, f64),
        /// Frequencies of the ends of the span, Hz.
        needed_hz: (f64, f64),
    },
    /// Felt edges that are too few or too close to separate wave speed and threshold.
    #[error("{count} felt edges up to {} apart cannot separate the wave speed from the threshold: at least two are needed, {} apart", show_place(*.apart_m), show_place(*.least_m))]
    CloseMarks {
        /// Number of felt edges.
        count: usize,
        /// Distance of the nearest and the farthest mark, metres.
        apart_m: f64,
        /// Least distance that is accepted, metres.
        least_m: f64,
    },
    /// Felt edges that leave the edge open.
    #[error("the felt edges are too few for a calibration: they leave the edge open to ±{}, more than ±{}. Touch more marks, spread over the plate, or measure the drive's current first", show_place(*.edge_m), show_place(*.most_m))]
    EdgesOpen {
        /// Half of the 95 % interval of the felt edge, root of the mean square over the band, metres.
        edge_m: f64,
        /// The most that is accepted, metres.
        most_m: f64,
    },
    /// No wave speed near the file's has felt edges at such frequencies.
    #[error(
        "no such plate has a felt edge at all of these frequencies: a finger feels nothing, or everything up to the plate's end; is the level right?"
    )]
    NoEdge,
    /// The data leave open what a plate file must state.
    #[error("the measurement is too weak for a calibration: it leaves the boundary open to {} and the level to {} dB (one standard deviation); {} % of the answers of the sensor at {} are noise. Put it where the plate moves: not at a node, and before {}, the last boundary", show_place(*.boundary_m), significant(*.level_db, 2), significant(100.0 * .silent_share, 2), show_place(*.place_m), show_place(*.span_end_m))]
    NotCarried {
        /// Standard deviation of the boundary, metres.
        boundary_m: f64,
        /// Standard deviation of the level of the peak, dB.
        level_db: f64,
        /// Place of the sensor that shows least, metres.
        place_m: f64,
        /// Share of its answers that do not stand out of the noise (0 to 1).
        silent_share: f64,
        /// End of the plate's span, metres.
        span_end_m: f64,
    },
    /// The current leaves open what a plate file must state.
    #[error("the current is too weak for a calibration: it leaves the boundary open to {} and the level to {} dB (one standard deviation). The plate hardly moves the drive: measure with a sensor on it", show_place(*.boundary_m), significant(*.level_db, 2))]
    NotCarriedByCurrent {
        /// Standard deviation of the boundary, metres.
        boundary_m: f64,
        /// Standard deviation of the level of the peak, dB.
        level_db: f64,
    },
    /// A plate file without a calibration.
    #[error(
        "the plate file holds no calibration, so its widths and its loss are too uncertain to determine the wave speed: calibrate it first"
    )]
    NotCalibrated,
    /// A measurement of another sensor than that of the trim's begin.
    #[error("the sensor at {} differs from that at the beginning, which was at {}: use the same sensor at the same place", show_place(*.place_m), show_place(*.begin_m))]
    AnotherSensor {
        /// Its place, metres.
        place_m: f64,
        /// The place of the one at the beginning, metres.
        begin_m: f64,
    },
    /// Phases that no wave speed explains.
    #[error("the phases of the tones do not fit one wave speed (chi^2 is {} per phase, at most {} is accepted): has the sensor moved, is a finger on the plate, or did more than its speed change? Calibrate it again", significant(*.chi2_per_n, 2), significant(*.most, 2))]
    PhasesUnlike {
        /// Sum of the squared residuals over their number.
        chi2_per_n: f64,
        /// The most that is accepted.
        most: f64,
    },
    /// Two plates fit alike.
    #[error("two wave speeds fit what was measured, {} and {} times that of the plate file: the resonances cannot decide. Measure with a sensor on the plate", significant(shares[0], 4), significant(shares[1], 4))]
    Ambiguous {
        /// Wave speeds over the file's.
        shares: [f64; 2],
    },
}

/// Ends the message that a third place shows another plate: the likely cause and its remedy.
fn edges_or_places(give_m: Option<f64>) -> String {
    match give_m {
        Some(give_m) => format!(
            ". By that pair the edges give by about {}, which the other pair does not see: calibrate with that pair",
            show_length(give_m)
        ),
        None => ": has the sensor been moved off a mark, or has the plate changed in between?".to_owned(),
    }
}

/// The air in which a plate fits, and what to state in its file.
fn fitting_air(faces: Option<Faces>) -> &'static str {
    match faces {
        Some(Faces::One) => "with air on one face: if the other has none, state faces = 1 in [air]",
        Some(Faces::Two) => "with air on both faces: if both have it, state faces = 2 in [air]",
        None => "in another frame: state mounting = \"unknown\" in [air]",
    }
}
