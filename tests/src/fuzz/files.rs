//! Targets on files that a user opens.

use slipline_instrument::measured_file::Opened as Measured;
use slipline_model::setup::file::{self, Opened};
use slipline_plate::Plate;
use slipline_plate::calibrate::{Measurement, SensorKind};

/// A plate file: an error or a plate, never a panic; a plate survives being written and read again.
///
/// # Panics
/// If that does not hold.
pub fn load_plate(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    if let Ok(plate) = Plate::from_toml(text) {
        let again = Plate::from_toml(&plate.to_toml()).expect("what was written can be read");
        assert_eq!(again.to_toml(), plate.to_toml());
        let (low, high) = plate.band_hz();
        assert!(low.is_finite() && high.is_finite());
    }
}

/// A setup file: an error with a text, or a setup or a plate, never a panic; a setup survives being written and read
/// again, to the last bit.
///
/// # Panics
/// If that does not hold.
pub fn load_setup(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    match file::read(text) {
        Err(error) => assert!(!error.to_string().is_empty()),
        Ok(Opened::Plate(_)) => {}
        Ok(Opened::Setup(setup)) => match file::read(&file::write(&setup)) {
            Ok(Opened::Setup(again)) => assert_eq!(again, setup),
            other => panic!("what was written is read as {other:?}"),
        },
    }
}

/// A file of a measurement or a recording: an error with a text, rows that a report counts, or values of each channel; never a
/// panic. One of the program's own is read back from what is written of it.
///
/// # Panics
/// If that does not hold.
pub fn load_measurement(data: &[u8]) {
    const BAND_HZ: (f64, f64) = (60.0, 300.0);
    match Measured::read(data.to_vec(), &[]) {
        Err(error) => assert!(!error.to_string().is_empty()),
        Ok(Measured::Own(measurement)) => {
            assert_eq!(Measurement::from_csv(&measurement.to_csv()), Ok(measurement));
        }
        Ok(Measured::Recording(wav)) => {
            if let Ok(sound) = wav.channel(wav.channels()) {
                assert!(!sound.values.is_empty() && sound.values.iter().all(|value| value.is_finite()));
            }
        }
        Ok(Measured::Foreign(foreign)) => {
            let read = foreign.read(BAND_HZ);
            assert!(read.rows_in_band <= read.rows && !read.to_string().is_empty());
            if let Ok(measurement) = foreign.measurement(0.03, SensorKind::Velocity, 40.0, BAND_HZ) {
                assert!(measurement.points.len() <= read.rows_in_band);
            }
        }
    }
}
