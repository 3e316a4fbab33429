//! Measurements of a plate by a client.

use super::client::{BlockingLink, Client};
use super::error::ClientError;
use crate::measure::{
    CURRENT_INPUT, CheckedDrive, DriveChecking, HarmonicsPlan, KnownDrive, MeasureError, Measured, Measuring,
    MeasuringHarmonics, Plan, Sensor, SweepPlan, Sweeping,
};
use crate::requests::MeasureRequest;
use slipline_link::DeviceTable;
use slipline_link::native::Worker;
use slipline_link::protocol::listen::InputsReport;
use slipline_plate::Plate;
use std::sync::Arc;

/// The method of a measurement.
#[derive(Clone)]
enum Method {
    Steps(Plan),
    Sweep(SweepPlan),
}

/// A device that holds a plate's table, and the method of its measurements.
pub struct Measurer<'a, W = Worker> {
    client: &'a Client<W>,
    table: Arc<DeviceTable>,
    method: Method,
    /// The drive circuit, where it is stated.
    known: Option<KnownDrive>,
}

impl<'a, W: BlockingLink> Measurer<'a, W> {
    /// Plans measurements of this plate, by combs of tones or by a sweep. `table` is that of the plate, which the device must
    /// hold when it measures.
    ///
    /// # Errors
    /// [`MeasureError`]: what is wanted is out of range, does not fit the plate, or the device has no inputs.
    pub fn new(
        client: &'a Client<W>,
        plate: &Plate,
        table: &Arc<DeviceTable>,
        request: &MeasureRequest,
    ) -> Result<Self, MeasureError> {
        let rate_hz = f64::from(table.header().sample_rate_hz);
        let wanted = request.frequencies.on(plate);
        let method = if request.is_sweep {
            Method::Sweep(SweepPlan::new(plate, table, &wanted, rate_hz)?)
        } else {
            let lock_ins = inputs(client).lock_ins.into();
            Method::Steps(Plan::new(plate, &wanted, rate_hz, lock_ins)?)
        };
        let known =
            request.known.map(|known| KnownDrive { bandwidths: known.bandwidths.of_drive(plate), ..known });
        Ok(Self { client, table: Arc::clone(table), method, known })
    }

    /// The same device with one comb only, over the whole band, or with the same sweep: for repeated measurements.
    #[must_use]
    pub fn short(&self) -> Self {
        let method = match &self.method {
            Method::Steps(plan) => Method::Steps(plan.of_one_comb()),
            Method::Sweep(plan) => Method::Sweep(plan.clone()),
        };
        Self { client: self.client, table: Arc::clone(&self.table), method, known: self.known }
    }

    /// Arms the device, measures, and disarms it. `watch` receives the progress, 0 to 1.
    ///
    /// # Errors
    /// Those of [`Client::run`].
    pub fn measure(&self, sensor: Sensor, watch: impl FnMut(f64)) -> Result<Measured, ClientError> {
        let (inputs, table) = (inputs(self.client), Arc::clone(&self.table));
        let rate_hz = f64::from(table.header().sample_rate_hz);
        let mut measured = match &self.method {
            Method::Steps(plan) => {
                self.client.run(Measuring::new(plan.clone(), table, sensor, &inputs)?, watch)?
            }
            Method::Sweep(plan) => {
                self.client.run(Sweeping::new(plan.clone(), table, sensor, &inputs)?, watch)?
            }
        };
        if let (CURRENT_INPUT, Some(known), Some(last)) =
            (sensor.input, &self.known, measured.measurement.points.last())
        {
            let warning = known.bandwidths.warning(&known.circuit.load, last.frequency_hz, rate_hz);
            measured.warnings.extend(warning);
        }
        Ok(measured)
    }
}

impl<W: BlockingLink> Client<W> {
    /// The measurement of the drive's harmonics at this number of fundamentals (2 to 64) and level (0.001 to 1) by a sensor; `table` is
    /// that of the plate, which the device must hold when it measures.
    ///
    /// # Errors
    /// [`MeasureError`]: a number is out of its range, the sample rate cannot carry the harmonics, or the device has no inputs.
    pub fn measuring_harmonics(
        &self,
        plate: &Plate,
        table: &Arc<DeviceTable>,
        (points, level): (usize, f64),
        sensor: Sensor,
    ) -> Result<MeasuringHarmonics, MeasureError> {
        let plan = HarmonicsPlan::new(plate, points, level, f64::from(table.header().sample_rate_hz))?;
        MeasuringHarmonics::new(plate, plan, Arc::clone(table), sensor, &inputs(self))
    }

    /// Arms the device, checks with quiet tones that this drive is on, and disarms it. `table` is that of the plate, which the
    /// device holds. `watch` receives the progress, 0 to 1.
    ///
    /// # Errors
    /// [`ClientError::NotOn`], and those of [`Client::run`].
    pub fn check_drive(
        &self,
        plate: &Plate,
        table: &Arc<DeviceTable>,
        known: KnownDrive,
        watch: impl FnMut(f64),
    ) -> Result<CheckedDrive, ClientError> {
        let rate_hz = f64::from(table.header().sample_rate_hz);
        let checking = DriveChecking::new(plate, known, Arc::clone(table), rate_hz, &inputs(self))?;
        let found = self.run(checking, watch)?;
        if found.check.is_on() { Ok(found) } else { Err(ClientError::NotOn(Box::new(found))) }
    }
}

/// The device's report of its inputs.
fn inputs<W: BlockingLink>(client: &Client<W>) -> InputsReport {
    client.snapshot().device.inputs.unwrap_or_default()
}
