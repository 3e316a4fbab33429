//! What Python does with a device and a sensor or a recorder besides a measurement: trims, sweeps for a recorder, and self-tests.

use super::measure::{Ready, Wish, of_band};
use super::{Device, Loaded, lock, may_be_armed};
use crate::arguments::optional;
use crate::error::Failure;
use crate::plate::Plate as PyPlate;
use crate::result::kind::{BrownOut, Profile, Selftest, Sweep, Trim};
use crate::result::{Answer, fields};
use pyo3::prelude::*;
use slipline_instrument::measure::{PlayedSweep, Playing};
use slipline_instrument::native::{Client, InterruptibleLink, TRIM_S, Trimming};
use slipline_instrument::profile_file;
use slipline_instrument::requests::{BrownOutAnswer, Frequencies, SweepAnswer};
use slipline_instrument::selftest::SelftestRequest;
use slipline_link::protocol::profile::ActuatorProfile;
use slipline_link::protocol::version::Compatibility;
use slipline_model::atomic_file::{self, said};
use slipline_plate::calibrate::SpeedTrim;
use std::io::{self, Write as _};
use std::path::PathBuf;

impl Device {
    /// Measures the wave speed of the plate in use, at once and then until the duration is over.
    pub(super) fn trim_plate(
        &self,
        py: Python<'_>,
        wish: Wish,
        duration_s: Option<f64>,
    ) -> PyResult<Answer<Trim>> {
        optional("duration_s", duration_s, TRIM_S)?;
        let loaded = self.loaded()?;
        let (consent, rig) = (lock(&self.state).consent, self.rig.clone());
        let (found, trimmed) = self.call(py, move |client| {
            let plate = &*loaded.plate;
            SpeedTrim::check(plate).map_err(|error| Failure::of(&error))?;
            let Ready { sensor, measurer } = wish.ready(client, &loaded, (consent, rig.as_ref()))?;
            let first = measurer.measure(sensor, |_| ())?.measurement;
            let mut trim = Trimming::begin(plate, &first).map_err(|error| Failure::of(&error))?;
            let short = measurer.short();
            while trim.goes_on(duration_s) {
                let later = short.measure(sensor, |_| ())?.measurement;
                trim.add(&later).map_err(|error| Failure::of(&error))?;
            }
            let answer =
                client.during(|| trim.answer(plate, sensor.place_m, "time").map(|it| fields(&it)))?;
            Ok((answer.map_err(|error| Failure::of(&error))?, trim.last().plate.clone()))
        })?;
        Answer::of(py, found)?.with(py, "plate", Py::new(py, PyPlate::from(trimmed))?)
    }

    /// Plays a sweep twice and writes its description.
    pub(super) fn sweep_plate(
        &self,
        py: Python<'_>,
        path: PathBuf,
        frequencies: Frequencies,
        duration_s: f64,
    ) -> PyResult<Answer<Sweep>> {
        let Loaded { plate, on_device, .. } = self.loaded()?;
        let consent = lock(&self.state).consent;
        let found = self.call(py, move |client| {
            let rate_hz = f64::from(client.identity()?.sample_rate_hz);
            let played = PlayedSweep::new(&plate, &on_device, &frequencies.on(&plate), rate_hz, duration_s);
            let played = played.map_err(|error| of_band(&error))?;
            let playing = Playing::new(played, on_device).map_err(|error| Failure::of(&error))?;
            may_be_armed(client, consent)?;
            client.disarm()?;
            let played = client.run(playing, |_| ())?;
            let text = played.to_toml();
            let written =
                atomic_file::write(&path, |out| -> io::Result<()> { out.write_all(text.as_bytes()) });
            written.map_err(|error| Failure::bad_file(path.display(), said(&error)))?;
            Ok(fields(&SweepAnswer::of(&plate, &played)))
        })?;
        Answer::of(py, found)
    }

    /// Tests the board.
    pub(super) fn test_board(&self, py: Python<'_>, request: SelftestRequest) -> PyResult<Answer<Selftest>> {
        let consent = lock(&self.state).consent;
        let (found, passed) = self.call(py, move |client| {
            if request.is_amplifier_on {
                may_be_armed(client, consent)?;
            }
            // Each test has other drives: the index of the device's sample differs.
            let seed = client.refresh()?;
            let report = client.selftest(SelftestRequest { seed, ..request }, |_, _| ())?;
            Ok((fields(&report), report.passed()))
        })?;
        Answer::of(py, found)?.with(py, "passed", passed)
    }

    /// The level of the board's brown-out reset, which the board writes first if that is asked.
    pub(super) fn brown_out_of(&self, py: Python<'_>, is_set: bool) -> PyResult<Answer<BrownOut>> {
        let found = self.call(py, move |client| {
            let mut level = client.brown_out_level()?;
            if is_set && level.level < level.needed {
                client.disarm()?;
                let port = client.snapshot().link.port.clone();
                let port = port.ok_or_else(|| Failure::refused("the device is not connected"))?;
                level = client.raise_brown_out_level(&port)?;
            }
            Ok(fields(&BrownOutAnswer::of(&level)))
        })?;
        Answer::of(py, found)
    }

    /// Writes the profile, or erases it, and returns what the device has then.
    pub(super) fn change_profile(
        &self,
        py: Python<'_>,
        profile: Option<ActuatorProfile>,
    ) -> PyResult<Answer<Profile>> {
        let found = self.call(py, move |client| {
            client.disarm()?;
            client.write_profile(profile)?;
            // The report follows the write.
            profile_fields(client)
        })?;
        Answer::of(py, found)
    }
}

/// The profile of the board's actuator.
pub(super) fn profile_fields(
    client: &Client<InterruptibleLink>,
) -> Result<serde_json::Map<String, serde_json::Value>, Failure> {
    let report = client.refreshed()?.device.profile.clone();
    let report = report.ok_or_else(|| Failure::refused(Compatibility::DeviceOlder.sentence()))?;
    Ok(fields(&profile_file::answer(&report)))
}
