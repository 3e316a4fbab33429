//! Actions of a person at a running rig.

use super::bench::{Bench, lock};
use super::converter::LARGEST;
use super::error::RigError;
use super::fault::RigFault;
use super::parts::Parts;
use slipline_plate::quantity::{OutOfRange, Range};
use std::sync::{Arc, Mutex};

/// A person at the rig. Clones act on the same rig, from any thread.
#[derive(Debug, Clone)]
pub struct RigHand {
    parts: Arc<Parts>,
    bench: Arc<Mutex<Bench>>,
}

impl RigHand {
    pub(super) fn new(parts: Arc<Parts>, bench: Arc<Mutex<Bench>>) -> Self {
        Self { parts, bench }
    }

    /// Puts the sensor on a mark, metres from the driven end. The computation takes some milliseconds on the
    /// calling thread, with a sensor that weighs up to a second.
    ///
    /// # Errors
    /// [`RigError`]: the mark is not on the plate. The sensor stays where it was.
    pub fn put_sensor(&self, place_m: f64) -> Result<(), RigError> {
        let fault = lock(&self.bench).fault;
        let standing = self.parts.sensor_at(place_m, fault)?;
        let mut bench = lock(&self.bench);
        (bench.place_m, bench.standing) = (place_m, standing);
        Ok(())
    }

    /// The sensor's mark, metres from the driven end.
    #[must_use]
    pub fn place_m(&self) -> f64 {
        lock(&self.bench).place_m
    }

    /// Sets a fault; `None` removes all faults.
    ///
    /// # Errors
    /// [`RigError::OutOfRange`] for the distance of a sensor from its mark, the code of a stuck converter, or
    /// the current of another motor.
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
        let standing = self.parts.sensor_at(place_m, fault)?;
        let mut bench = lock(&self.bench);
        (bench.fault, bench.standing) = (fault, standing);
        Ok(())
    }

    /// The present fault.
    #[must_use]
    pub fn fault(&self) -> Option<RigFault> {
        lock(&self.bench).fault
    }
}
