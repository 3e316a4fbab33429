//! A calibration that is asked for: by measurements, or by edges that a finger felt.

use slipline_model::answer::calibrate::{
    CalibrationReport, Measured, TOUCH_LEVEL, TOUCH_TOLERANCE_M, by_touches, touch,
};
use slipline_model::field::asked_place::{AskedPlace, NoSuchTone};
use slipline_model::setup::Setup;
use slipline_plate::calibrate::{CalibrateError, Measurement, Priors, Touch, TouchedDrive, Transducer};
use slipline_plate::feeling::Feeling;
use slipline_plate::quantity::{OutOfRange, Range};
use slipline_plate::{DriveTable, Plate};
use std::borrow::Borrow;
use std::sync::Arc;
use thiserror::Error;

/// What these measurements are of a plate: the current of a drive, or one sensor at one place, at two, or at two with a third as a
/// check. `None` for another number of them.
pub fn measured<M: Borrow<Measurement>>(
    measurements: &[M],
    current: Option<Transducer>,
) -> Option<Measured<'_>> {
    match (measurements, current) {
        ([one], Some(drive)) => Some(Measured::Current(one.borrow(), drive)),
        ([one], None) => Some(Measured::OneSensor(one.borrow())),
        ([near, far], None) => Some(Measured::TwoPlaces([near.borrow(), far.borrow()])),
        ([near, far, check], None) => Some(Measured::Checked([near.borrow(), far.borrow()], check.borrow())),
        _ => None,
    }
}

/// An edge that a finger felt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeltEdgeRequest {
    /// The place or frequency by which the tone was requested.
    pub asked: AskedPlace,
    /// Where the finger felt it end, metres from the driven end.
    pub felt_m: f64,
}

/// Felt edges, and what is known of them.
#[derive(Clone, Debug, PartialEq)]
pub struct FeltEdgesRequest {
    /// The edges.
    pub edges: Vec<FeltEdgeRequest>,
    /// Level of the tones; by default [`TOUCH_LEVEL`].
    pub level: Option<f64>,
    /// Standard deviation of the felt places, metres; by default [`TOUCH_TOLERANCE_M`].
    pub tolerance_m: Option<f64>,
    /// What is known of the drive; by default what the plate's file knows.
    pub drive: Option<TouchedDrive>,
    /// The finger's feeling.
    pub feeling: Feeling,
}

/// Why an edge cannot have been felt.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FeltEdgeError {
    /// The finger was not on the plate.
    #[error(transparent)]
    Felt(OutOfRange),
    /// No tone is as asked.
    #[error(transparent)]
    Asked(NoSuchTone),
}

impl FeltEdgesRequest {
    /// The calibration of a plate with these uncertainties; `table` is that of the plate.
    ///
    /// # Errors
    /// The number of the edge that cannot have been felt, from 0, and why. Inside: why the calibration is refused.
    pub fn calibrate(
        &self,
        nominal: &Plate,
        priors: &Priors,
        table: &DriveTable,
    ) -> Result<Result<CalibrationReport, CalibrateError>, (usize, FeltEdgeError)> {
        let setup = Setup { feeling: self.feeling, ..Setup::new(Arc::new(nominal.clone())) };
        let touches = self.edges.iter().enumerate();
        let touches =
            touches.map(|(number, edge)| self.touch(edge, &setup, table).map_err(|error| (number, error)));
        let touches = touches.collect::<Result<Vec<_>, _>>()?;
        Ok(by_touches(nominal, &touches, &self.feeling, self.drive, priors))
    }

    fn touch(
        &self,
        edge: &FeltEdgeRequest,
        setup: &Setup,
        table: &DriveTable,
    ) -> Result<Touch, FeltEdgeError> {
        let on_plate = Range::new(0.0, setup.plate.length_m(), "m");
        OutOfRange::check("touch", edge.felt_m, on_plate).map_err(FeltEdgeError::Felt)?;
        let level = self.level.unwrap_or(TOUCH_LEVEL);
        let turning_point_m =
            edge.asked.turning_point_m(setup, level, table).map_err(FeltEdgeError::Asked)?;
        let felt = (edge.felt_m, self.tolerance_m.unwrap_or(TOUCH_TOLERANCE_M));
        Ok(touch(table, turning_point_m, level, felt))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use slipline_plate::calibrate::SensorKind;

    #[test]
    fn a_sensor_has_one_to_three_places_and_a_current_stands_alone() {
        let one = || Measurement::at(0.03, SensorKind::Displacement, Vec::new());
        let coil = Transducer::Coil;
        assert!(matches!(measured(&[one()], None), Some(Measured::OneSensor(_))));
        assert!(matches!(measured(&[one(), one()], None), Some(Measured::TwoPlaces(_))));
        assert!(matches!(measured(&[one()], Some(coil)), Some(Measured::Current(_, Transducer::Coil))));
        assert!(measured(&[one(), one()], Some(coil)).is_none());
        assert!(measured::<Measurement>(&[], None).is_none());
        assert!(matches!(measured(&[one(), one(), one()], None), Some(Measured::Checked(..))));
        assert!(measured(&[one(), one(), one(), one()], None).is_none());
    }

    #[test]
    fn an_edge_that_cannot_have_been_felt_is_refused_with_its_number() {
        let plate = slipline_plate::preset("membrane").unwrap();
        let table = DriveTable::build(&plate, 400e3, 65).unwrap();
        let edge = |asked_m, felt_m| FeltEdgeRequest { asked: AskedPlace::FeltEdge(asked_m), felt_m };
        let refused = |second: FeltEdgeRequest| {
            let edges = vec![edge(0.25, 0.246), second];
            let feeling = Feeling::default();
            let request = FeltEdgesRequest { edges, level: None, tolerance_m: None, drive: None, feeling };
            request.calibrate(&plate, &Priors::default(), &table).unwrap_err()
        };
        assert!(matches!(refused(edge(0.2, 9.0)), (1, FeltEdgeError::Felt(_))));
        assert!(matches!(refused(edge(0.001, 0.2)), (1, FeltEdgeError::Asked(NoSuchTone::NoFeltEdge(..)))));
    }
}
