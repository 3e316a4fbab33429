//! What a person does at a rig while it runs.

use super::bench::{Bench, lock};
use super::converter::LARGEST;
use super::error::RigError;
use super::fault::RigFault;
use super::parts::Parts;
use slipline_plate::quantity::{OutOfRange, Range};
use std::sync::{Arc, Mutex};

/// A person at the rig. Cloning is cheap; any thread may hold one.
#[derive(Debug, Clone)]
pub struct RigHand {
    parts: Arc<Parts>,
    bench: Arc<Mutex<Bench>>,
}

impl RigHand {
    pub(super) fn new(parts: Arc<Parts>, bench: Arc<Mutex<Bench>>) -> Self {
        Self { parts, bench }
    }

    /// Puts the sensor on a mark, metres from the driven end. It takes some milliseconds to compute, on the thread that
    /// calls it.
    ///
    /// # Errors
    /// [`RigError`]: the mark is not on the plate. The sensor stays where it was.
    pub fn put_sensor(&self, place_m: f64) -> Result<(), RigError> {
        let fault = lock(&self.bench).fault;
        let sensor = Arc::new(self.parts.sensor_at(place_m, fault)?);
        let mut bench = lock(&self.bench);
        (bench.place_m, bench.sensor) = (place_m, sensor);
        Ok(())
    }

    /// The sensor's mark, metres from the driven end.
    #[must_use]
    pub fn place_m(&self) -> f64 {
        lock(&self.bench).place_m
    }

    /// Breaks something, or with `None` mends everything.
    ///
    /// # Errors
    /// [`RigError::OutOfRange`] for how far a sensor is off its mark, for the code of a stuck converter, or for the current of another motor.
    pub fn set_fault(&self, fault: Option<RigFault>) -> Result<(), RigError> {
        match fault {
            Some(RigFault::OffItsMark(off_m)) => {
                OutOfRange::check("distance from the mark", off_m, RigFault::OFF)?;
            }
            Some(RigFault::Stuck(code)) => {
                let codes = Range::new(0.0, f64::from(LARGEST), "");
                OutOfRange::check("stuck code", f64::from(code), codes)?;
            }
            Some(RigFault::WrongMotor(times)) => {
                OutOfRange::check("current of the wrong motor", times, RigFault::OTHER)?;
            }
            _ => {}
        }
        let place_m = self.place_m();
        let sensor = Arc::new(self.parts.sensor_at(place_m, fault)?);
        let mut bench = lock(&self.bench);
        (bench.fault, bench.sensor) = (fault, sensor);
        Ok(())
    }

    /// What is broken.
    #[must_use]
    pub fn fault(&self) -> Option<RigFault> {
        lock(&self.bench).fault
    }
}
