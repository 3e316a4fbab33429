//! A drive that is to be simulated.

use super::NamedFeeling;
use slipline_link::Sounding;
use slipline_model::answer::simulate::SimulatedDrive;
use slipline_model::field::simulation::{Simulated, Simulation, SimulationError, Solver};
use slipline_model::field::tone_places::TonePlaces;
use slipline_model::setup::Setup;
use slipline_plate::{DriveTable, Finger, Plate, Progress, Sensitivity, TableError, table_sensitivity};
use std::sync::Arc;

/// The plates, the finger and the solver of a simulation.
#[derive(Clone, Debug)]
pub struct SimulateRequest {
    /// The plate of the table.
    pub plate: Arc<Plate>,
    /// The plate on which the waves run, if that is another.
    pub actual: Option<Plate>,
    /// Whether the table's gains are used.
    pub has_gains: bool,
    /// Longest drive, seconds; `None` until the plate has settled and been measured.
    pub seconds: Option<f64>,
    /// The solver.
    pub solver: Solver,
    /// A finger on the plate.
    pub finger: Option<Finger>,
}

/// A simulation and what is known before it runs.
pub struct PlannedSimulation<'a> {
    request: &'a SimulateRequest,
    table: &'a DriveTable,
    sounding: Option<Sounding>,
    /// Both places of each tone by the plate and its table.
    pub places: Vec<TonePlaces>,
    /// Gain of the chord that the tones are, in dB.
    pub chord_gain_db: Option<f64>,
    /// What the table loses on the actual plate, if that is another.
    pub sensitivity: Option<Sensitivity>,
}

impl SimulateRequest {
    /// The plate on which the waves run.
    #[must_use]
    pub fn actual(&self) -> &Plate {
        self.actual.as_ref().unwrap_or(&self.plate)
    }

    /// Plans the simulation of a setup; `table` is that of the plate. `sounding` plays the setup if it has more than
    /// its tones.
    ///
    /// # Errors
    /// [`TableError`]: the table cannot be used on the actual plate.
    pub fn plan<'a>(
        &'a self,
        setup: Setup,
        sounding: Option<Sounding>,
        table: &'a DriveTable,
    ) -> Result<PlannedSimulation<'a>, TableError> {
        let (places, chord_gain_db) = TonePlaces::as_played(setup, sounding.as_ref(), table);
        let sensitivity = self.actual.as_ref().map(|actual| table_sensitivity(table, &self.plate, actual));
        let sensitivity = sensitivity.transpose()?;
        Ok(PlannedSimulation { request: self, table, sounding, places, chord_gain_db, sensitivity })
    }
}

impl PlannedSimulation<'_> {
    /// Runs it.
    ///
    /// # Errors
    /// [`SimulationError`]: the plate, its tones or the solver are refused, or `progress` has stopped it.
    pub fn run(&self, progress: &mut Progress<'_>) -> Result<Simulated, SimulationError> {
        let tones: Vec<_> = self.places.iter().map(|tone| (tone.turning_point_m, tone.level)).collect();
        let SimulateRequest { ref plate, has_gains, seconds, solver, finger, .. } = *self.request;
        let (actual, sounding) = (self.request.actual(), self.sounding.clone());
        Simulation { plate, actual, tones: &tones, sounding, has_gains, seconds, solver, finger }
            .run(self.table, progress)
    }

    /// The drive with its result, as it is answered.
    #[must_use]
    pub fn drive<'a>(&'a self, feeling: &'a NamedFeeling, result: &'a Simulated) -> SimulatedDrive<'a> {
        let Self { request, ref places, chord_gain_db, sensitivity, .. } = *self;
        let SimulateRequest { ref plate, has_gains, solver, .. } = *request;
        let (actual, feeling) = (request.actual(), (&feeling.feeling, feeling.from.as_deref()));
        SimulatedDrive {
            plate,
            actual,
            places,
            feeling,
            has_gains,
            chord_gain_db,
            sensitivity,
            solver,
            result,
        }
    }
}
