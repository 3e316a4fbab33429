//! A simulated drive.

use super::feeling::FeelingAnswer;
use super::tone::edges_m;
use super::{Complex, ToneAnswer, TwoDimensions};
use crate::field::felt::Felt;
use crate::field::simulation::{Simulated, Solver, ToneResult};
use crate::field::tone_places::TonePlaces;
use serde::Serialize;
use slipline_plate::feeling::Feeling;
use slipline_plate::{Plate, Sensitivity};

/// What was simulated, and its result.
#[derive(Clone, Copy, Debug)]
pub struct SimulatedDrive<'a> {
    /// The plate of the table.
    pub plate: &'a Plate,
    /// The plate on which the waves ran.
    pub actual: &'a Plate,
    /// Both places of each tone by the plate and its table, before anything was simulated.
    pub places: &'a [TonePlaces],
    /// The finger's feeling and its file.
    pub feeling: (&'a Feeling, Option<&'a str>),
    /// Whether the table's gains were used: without them the felt edges are not known beforehand.
    pub has_gains: bool,
    /// Gain of the chord that the tones are, in dB.
    pub chord_gain_db: Option<f64>,
    /// What the table loses on the actual plate, if that is another.
    pub sensitivity: Option<Sensitivity>,
    /// The solver.
    pub solver: Solver,
    /// The result.
    pub result: &'a Simulated,
}

/// The fields of `slipline simulate --json`: those of the first tone, and of all.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SimulateAnswer<'a> {
    /// The only tone of a drive of one.
    #[serde(flatten)]
    pub first: Option<SimulatedTone<'a>>,
    /// Name of the plate.
    pub plate: &'a str,
    /// The finger by which felt edges are computed.
    pub feeling: FeelingAnswer<'a>,
    /// JSON, text: Name of the plate on which the waves run
    pub actual_plate: &'a str,
    /// JSON, true or false: Whether the table's gains were used
    pub has_table_gains: bool,
    /// How much louder the chord is than the sum of its tones allows; `None` where it is none.
    pub chord_gain_db: Option<f64>,
    /// JSON: Samples that were limited at the end of the DAC's range
    pub clipped_samples: u32,
    /// JSON: Time that was simulated
    pub simulated_s: f64,
    /// JSON: Time at the end over which the field was measured
    pub measured_s: f64,
    /// JSON: Beat that the measured time does not resolve; null if there is none
    pub slow_beat_hz: Option<f64>,
    /// JSON: Amplitude of the peak at level 1
    pub peak_at_full_scale_m: f64,
    /// JSON: Error of the table on the actual plate; null on its own plate
    pub sensitivity_db: Option<f64>,
    /// JSON: Where the level is most sensitive
    pub sensitivity_at_m: Option<f64>,
    /// JSON: As `measured_felt_edge_m`, of all tones together; null where a beat is too slow
    pub measured_felt_edge_of_all_m: Option<f64>,
    /// JSON: As `measured_felt_edge_by_person_m`, of all tones together
    pub measured_felt_edge_of_all_by_person_m: Option<[Option<f64>; 2]>,
    /// The tones.
    pub tones: Vec<SimulatedTone<'a>>,
}

/// The fields of a simulated tone.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SimulatedTone<'a> {
    /// Level of the tone, 0 to 1 of the table's full scale.
    pub level: f64,
    /// Frequency of the tone or of each answer.
    pub frequency_hz: f64,
    /// Where the wave turns.
    pub turning_point_m: f64,
    /// Where a finger feels the tone end, by its level alone; `None` where it does not.
    pub felt_edge_m: Option<f64>,
    /// Felt edge of a dull and of a keen finger; `None` where none is felt.
    pub felt_edge_by_person_m: Option<[Option<f64>; 2]>,
    /// The felt edge as a sentence.
    pub felt: Option<String>,
    /// JSON: Where the tone's wave turns on the actual plate
    pub actual_turning_point_m: f64,
    /// Place of the peak; `None` without a peak.
    pub peak_position_m: Option<f64>,
    /// JSON: Amplitude of the peak, as predicted
    pub peak_amplitude_m: Option<f64>,
    /// From the peak to a tenth of its amplitude.
    pub edge_width_m: f64,
    /// Whether there is a peak.
    pub peak_present: bool,
    /// JSON: Turning point by the simulated field
    pub measured_turning_point_m: Option<f64>,
    /// JSON: Place of the peak, as simulated; null without a peak
    pub measured_peak_position_m: Option<f64>,
    /// JSON: Amplitude of the peak, as simulated; null without a peak
    pub measured_peak_amplitude_m: Option<f64>,
    /// JSON: As `felt_edge_m`, by the simulated field
    pub measured_felt_edge_m: Option<f64>,
    /// JSON: As `felt_edge_by_person_m`, by the simulated field
    pub measured_felt_edge_by_person_m: Option<[Option<f64>; 2]>,
    /// Places along the plate, or the turning point of a knot.
    pub position_m: &'a [f64],
    /// The response at each place, relative to the drive.
    pub amplitude: Vec<Complex>,
    /// JSON: Amplitude of the tone at each place, as simulated
    pub measured_amplitude_m: Vec<f64>,
    /// How the plate in two dimensions differs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub two_dimensions: Option<TwoDimensions>,
}

/// Where the tones of a measured field are felt to end, in metres, and the same by person.
type FeltEdges = (Option<f64>, Option<[Option<f64>; 2]>);

fn felt_edges(felt: Option<&Felt>) -> FeltEdges {
    (felt.and_then(|felt| felt.edge.place_m()), felt.map(|felt| edges_m(felt.by_person)))
}

impl<'a> SimulatedDrive<'a> {
    /// Its fields.
    #[must_use]
    pub fn answer(&self) -> SimulateAnswer<'a> {
        let result = self.result;
        let (feeling, from) = self.feeling;
        // The felt edges are computed from the measured fields, too; illustrative.
        let (felt_edge_m, by_person_m) = felt_edges(result.felt(self.actual, feeling).as_ref());
        let tones: Vec<_> =
            result.tones.iter().zip(self.places).map(|(tone, places)| self.tone(tone, places)).collect();
        SimulateAnswer {
            first: tones.first().cloned(),
            plate: self.plate.name(),
            feeling: FeelingAnswer::of(feeling, from),
            actual_plate: self.actual.name(),
            has_table_gains: self.has_gains,
            chord_gain_db: self.chord_gain_db,
            clipped_samples: result.clipped_samples,
            simulated_s: result.seconds,
            measured_s: result.window_s,
            slow_beat_hz: result.slow_beat.map(|beat| beat.between_hz.1 - beat.between_hz.0),
            peak_at_full_scale_m: result.peak_at_full_scale_m,
            sensitivity_db: self.sensitivity.map(|it| it.worst_db),
            sensitivity_at_m: self.sensitivity.map(|it| it.worst_at_m),
            measured_felt_edge_of_all_m: felt_edge_m,
            measured_felt_edge_of_all_by_person_m: by_person_m,
            tones,
        }
    }

    fn tone(&self, tone: &'a ToneResult, places: &TonePlaces) -> SimulatedTone<'a> {
        let (measured_felt_edge_m, measured_by_person_m) =
            felt_edges(tone.felt(self.actual, self.feeling.0).as_ref());
        let due = self.has_gains.then(|| ToneAnswer::of(places, places.frequency_hz));
        SimulatedTone {
            level: tone.level,
            frequency_hz: tone.frequency_hz,
            turning_point_m: places.turning_point_m,
            felt_edge_m: due.as_ref().and_then(|due| due.felt_edge_m),
            felt_edge_by_person_m: due.as_ref().map(|due| due.felt_edge_by_person_m),
            felt: due.map(|due| due.felt),
            actual_turning_point_m: tone.predicted.turning_point_m,
            peak_position_m: tone.predicted.peak.map(|peak| peak.position_m),
            peak_amplitude_m: tone.predicted_peak_m,
            edge_width_m: tone.predicted.edge_width_m,
            peak_present: tone.measured.is_some() && tone.predicted.peak.is_some(),
            measured_turning_point_m: tone.measured_turning_point_m,
            measured_peak_position_m: tone.measured.map(|peak| peak.position_m),
            measured_peak_amplitude_m: tone.measured.map(|peak| peak.amplitude),
            measured_felt_edge_m,
            measured_felt_edge_by_person_m: measured_by_person_m,
            position_m: &tone.predicted.position_m,
            amplitude: Complex::of_each(&tone.predicted.amplitude),
            measured_amplitude_m: tone.field_m.iter().map(|f| f.norm()).collect(),
            two_dimensions: match self.solver {
                Solver::Sheet { .. } => Some(TwoDimensions::of(&tone.differs)),
                Solver::Line => None,
            },
        }
    }
}
